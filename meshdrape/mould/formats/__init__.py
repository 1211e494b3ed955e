"""Readers of mesh files: bytes in, vertices and polygons out.

Each raises ValueError where the bytes are not what the format promises; :mod:`meshdrape.mould.formats.reader` adds
the name of the file. They are our own because the general mesh libraries read a truncated file as a smaller
one, take an index that is out of range from the other end of the list, or split one file into several meshes.
"""
