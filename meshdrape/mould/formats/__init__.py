"""Readers of mesh files: bytes in, vertices and polygons out.

Each raises ValueError where the bytes are not what the format promises; :mod:`meshdrape.mould.meshfile` adds the
name of the file. General mesh libraries do not serve here: they read a truncated file as a smaller one, or take
an index that is out of range from the other end, or split the file into parts.
"""
