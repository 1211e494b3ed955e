"""Mesh files written as plainly as their formats, for the readers to read: bytes, nothing on the disk."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
from moulds import Mesh
from numpy.typing import NDArray

# two triangles about one diagonal, and its vertices as the text formats have them
SQUARE = Mesh(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))
OBJ_SQUARE = b"v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvn 0 0 1\nvt 0 0\n"
OFF_SQUARE = b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n"


def binary_stl(mesh: Mesh, header: bytes = b"made by hand") -> bytes:
    corners = mesh.vertices[mesh.triangles].astype("<f4")
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + corner.tobytes() + b"\0\0" for corner in corners)
    return header.ljust(80, b" ") + struct.pack("<I", len(corners)) + facets


def text_stl(mesh: Mesh, name: str = "mould") -> bytes:
    lines = [f"solid {name}"]
    for triangle in mesh.vertices[mesh.triangles].tolist():
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x!r} {y!r} {z!r}" for x, y, z in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, f"endsolid {name}\n"]).encode()


def obj(mesh: Mesh) -> bytes:
    lines = [f"v {row}" for row in _rows(mesh.vertices)] + [f"f {row}" for row in _rows(mesh.triangles + 1)]
    return "\n".join([*lines, ""]).encode()


def off(mesh: Mesh) -> bytes:
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.triangles)} 0", *_vertices_and_faces(mesh)]
    return "\n".join([*lines, ""]).encode()


def text_ply(mesh: Mesh) -> bytes:
    head = ply_header("ascii", len(mesh.vertices), len(mesh.triangles))
    return head + "\n".join([*_vertices_and_faces(mesh), ""]).encode()


def binary_ply(mesh: Mesh, order: str = "<") -> bytes:
    """Little endian, or big with `order` ">"."""
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    faces = b"".join(struct.pack(f"{order}B3i", 3, *triangle) for triangle in mesh.triangles.tolist())
    head = ply_header(form, len(mesh.vertices), len(mesh.triangles))
    return head + mesh.vertices.astype(f"{order}f8").tobytes() + faces


def ply_header(
    form: str,
    n_vertices: int,
    n_faces: int,
    real: str = "double",
    vertex_more: str = "",
    face_before: str = "",
    face_after: str = "",
) -> bytes:
    """A header with further lines behind the vertices' coordinates, before and behind the faces' corners."""
    return (
        f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {n_vertices}\n"
        f"property {real} x\nproperty {real} y\nproperty {real} z\n{vertex_more}element face {n_faces}\n"
        f"{face_before}property list uchar int vertex_indices\n{face_after}end_header\n"
    ).encode()


def polygons_ply(order: str) -> tuple[list[list[float]], list[list[int]], bytes]:
    """Vertices with a colour, faces of 4, 3 and 5 corners with a colour before and texture coordinates behind.

    Both lists and the file: binary of that byte order, text for "".
    """
    vertices = [*SQUARE.vertices.tolist(), [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 2, 0]]
    faces = [[0, 1, 2, 3], [1, 4, 2], [4, 5, 6, 7, 2]]
    head = ply_header(
        {"<": "binary_little_endian", ">": "binary_big_endian", "": "ascii"}[order],
        len(vertices), len(faces), "float", "property uchar red\n",
        "property uchar red\n", "property list uchar float texcoord\nelement edge 1\nproperty int vertex1\n",
    )  # fmt: skip
    if not order:
        rows = [" ".join(map(repr, [*map(float, v), 7])) for v in vertices]
        rows += [" ".join(map(str, [9, len(f), *f, 2, 0.5, 0.25])) for f in faces]
        return vertices, faces, head + "\n".join([*rows, "3", ""]).encode()
    body = b"".join(struct.pack(f"{order}3fB", *v, 7) for v in vertices)
    body += b"".join(struct.pack(f"{order}BB{len(f)}iB2f", 9, len(f), *f, 2, 0.5, 0.25) for f in faces)
    return vertices, faces, head + body + struct.pack(f"{order}i", 3)


def stored(folder: Path, name: str, content: bytes) -> Path:
    path = folder / name
    path.write_bytes(content)
    return path


def same_triangles(mesh: Mesh, vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> bool:
    """Whether both have the same corners, triangle by triangle, to the last bit."""
    return np.array_equal(vertices[triangles], mesh.vertices[mesh.triangles])


def _rows(values: NDArray[np.float64] | NDArray[np.int64]) -> list[str]:
    """Rows of numbers with all their digits."""
    return [" ".join(map(repr, row)) for row in values.tolist()]


def _vertices_and_faces(mesh: Mesh) -> list[str]:
    return [*_rows(mesh.vertices), *(f"3 {row}" for row in _rows(mesh.triangles))]
