"""OBJ files: vertices and faces; all else in them is left aside."""

from __future__ import annotations

import numpy as np

from meshdrape.mould.formats.polygons import Polygons


def read_obj(content: bytes) -> Polygons:
    """Return the polygons of an OBJ file, of all its objects and groups together."""
    vertices: list[list[float]] = []
    corner: list[int] = []
    size: list[int] = []
    for number, line in enumerate(content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines(), start=1):
        words = line.partition(b"#")[0].split()
        try:
            if words[:1] == [b"v"]:
                x, y, z = words[1:4]
                vertices.append([float(x), float(y), float(z)])
            elif words[:1] == [b"f"]:
                ends = [word.partition(b"/")[0] for word in words[1:]]
                corner.extend(_index(int(end), len(vertices)) for end in ends)
                size.append(len(ends))
        except ValueError as error:
            msg = f"line {number} is not a {'vertex' if words[0] == b'v' else 'face'}: {_shown(line)}"
            raise ValueError(msg) from error
    if not vertices and not size:
        msg = "no OBJ file: it has neither vertices nor faces"
        raise ValueError(msg)
    return Polygons(
        np.array(vertices, dtype=np.float64).reshape(-1, 3),
        np.array(corner, dtype=np.int64),
        np.array(size, dtype=np.int64),
    )


def _index(number: int, n_vertices: int) -> int:
    """Return the vertex, from 0, of a number that counts from 1, or back from the last so far from -1."""
    if number == 0 or number < -n_vertices or number > 1 << 60:
        msg = f"no vertex {number}"
        raise ValueError(msg)
    return number - 1 if number > 0 else n_vertices + number


def _shown(line: bytes) -> str:
    return ascii(line[:40].decode("latin-1"))
