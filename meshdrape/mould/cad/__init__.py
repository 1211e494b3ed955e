"""CAD files and scripts in, triangles that remember their faces out."""
