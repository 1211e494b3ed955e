"""OFF files, in text."""

from __future__ import annotations

import re
from typing import Final

import numpy as np

from meshdrape.mould.formats.polygons import Polygons

# NOFF, COFF, NCOFF, STOFF, ...: what comes besides x, y and z follows them; 4OFF and nOFF have other dimensions
_KEYWORD: Final = re.compile(rb"\s*(?:ST)?(?:CN?|NC?)?OFF\b(.*)", re.DOTALL)


def read_off(content: bytes) -> Polygons:
    """Return the polygons of an OFF file; comments, colours and normals are left aside."""
    lines = [line.partition(b"#")[0].split() for line in content.splitlines()]
    lines = [words for words in lines if words]
    keyword = _KEYWORD.fullmatch(lines[0][0]) if lines else None
    if keyword is None:
        msg = "no OFF file: it does not begin with OFF, or is of another dimension than 3"
        raise ValueError(msg)
    lines[0] = lines[0][1:]
    if not lines[0]:
        lines = lines[1:]
    if not lines or b"BINARY" in lines[0]:
        msg = "binary or without counts; save it as text"
        raise ValueError(msg)
    n_vertices, n_faces = int(lines[0][0]), int(lines[0][1] if len(lines[0]) > 1 else b"")
    rows = lines[1:]
    if min(n_vertices, n_faces) < 0 or len(rows) < n_vertices + n_faces:
        msg = f"truncated: {n_vertices:,} vertices and {n_faces:,} faces announced, {len(rows):,} lines there"
        raise ValueError(msg)
    vertices = np.empty((n_vertices, 3))
    for i, words in enumerate(rows[:n_vertices]):
        if len(words) < 3:
            msg = f"vertex {i} has {len(words)} coordinates"
            raise ValueError(msg)
        vertices[i] = float(words[0]), float(words[1]), float(words[2])
    corner: list[int] = []
    size = np.empty(n_faces, dtype=np.int64)
    for i, words in enumerate(rows[n_vertices : n_vertices + n_faces]):
        k = int(words[0])
        if not 0 <= k < len(words):
            msg = f"face {i} announces {k} corners and has {len(words) - 1}"
            raise ValueError(msg)
        corner.extend(map(int, words[1 : k + 1]))
        size[i] = k
    return Polygons(vertices, np.array(corner, dtype=np.int64), size)
