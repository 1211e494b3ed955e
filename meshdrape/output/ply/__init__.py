"""PLY files for MeshLab, and a net read back from its own."""
