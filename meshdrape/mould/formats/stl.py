"""STL files of both kinds."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from meshdrape.mould.formats.polygons import Floats, Polygons

_HEADER: Final = 84  # bytes: 80 of text and the number of triangles
_FACET: Final = np.dtype([("normal", "<f4", (3,)), ("corner", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX: Final = re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", re.IGNORECASE)
_END_OF_FACET: Final = re.compile(rb"\bendfacet\b", re.IGNORECASE)


def read_stl(content: bytes) -> Polygons:
    """Return the triangles of an STL file, three vertices of its own for each.

    A file is binary when its length is what its header says, whatever the header's text: many binary files
    begin with "solid", as text files do.
    """
    count = int.from_bytes(content[80:84], "little")
    if len(content) == _HEADER + count * _FACET.itemsize:
        return _binary(content)
    if content.lstrip()[:5].lower() == b"solid" and (b"facet" in content.lower() or len(content) < _HEADER):
        return _text(content)
    if len(content) < _HEADER:
        msg = f"no STL file: {len(content)} bytes, too few even for a header"
        raise ValueError(msg)
    said = _HEADER + count * _FACET.itemsize
    state = "truncated" if len(content) < said else "damaged, or no STL file"
    msg = f"{state}: its header says {count:,} triangles, {said:,} bytes, but it has {len(content):,} bytes"
    raise ValueError(msg)


def _binary(content: bytes) -> Polygons:
    corner = np.frombuffer(content, dtype=_FACET, offset=_HEADER)["corner"]
    with np.errstate(invalid="ignore"):  # noise may hold a NaN that signals; it is reported later, as what it is
        return _of_corners(corner.reshape(-1, 3).astype(np.float64))


def _text(content: bytes) -> Polygons:
    found = _VERTEX.findall(content)
    facets = len(_END_OF_FACET.findall(content))
    if len(found) != 3 * facets or not re.search(rb"\bendsolid\b[^\n]*\s*\Z", content, re.IGNORECASE):
        msg = f"truncated or damaged: whole facets {facets:,}, vertices {len(found):,}"
        raise ValueError(msg)
    return _of_corners(np.array([[float(x) for x in row] for row in found], dtype=np.float64).reshape(-1, 3))


def _of_corners(vertices: Floats) -> Polygons:
    return Polygons.of_triangles(vertices, np.arange(len(vertices)).reshape(-1, 3))
