"""Triangles that libigl cannot stand, taken out of a mesh before it sees them.

Its exact solver may hang where a triangle is lower than about 1e-8 of its longest side, or has a side as short as
that. Such a triangle is as good as none: a short side is drawn together into one vertex, and of a flat one the vertex
that lies on the side opposite is made to split that side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Lowest height of a triangle, in longest sides, that goes to libigl: at 1e-7 it was never seen to hang.
LOWEST = 1e-7


@dataclass(frozen=True, eq=False)
class Screened:
    """A mesh without flat triangles.

    Attributes
    ----------
    faces : (m, 3) int64
        None flat; their vertices keep their numbers.
    image : (n,) int64
        The vertex that each vertex was drawn into; itself for most.
    moved : float
        How much longer or shorter a path can have become, mm.
    """

    faces: IntArray
    image: IntArray
    moved: float


def screened(vertices: FloatArray, faces: IntArray) -> Screened | None:
    """The mesh without its flat triangles; None where they cannot be taken out of it.

    Parameters
    ----------
    vertices : (n, 3), mm
    faces : (m, 3)
        Manifold, oriented.
    """
    image = np.arange(len(vertices))
    if not (relative_heights(vertices, faces) < LOWEST).any():
        return Screened(faces, image, 0.0)
    moved = 0.0
    # each step takes a triangle away or lets one vertex less lie on a side
    for _ in range(4 * len(faces)):
        heights = relative_heights(vertices, faces)
        if not len(faces) or heights.min() >= LOWEST:
            return Screened(faces, image, moved) if len(faces) and _is_manifold(faces) else None
        flat = int(np.argmin(heights))
        corners = vertices[faces[flat]]
        sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
        longest, shortest = int(np.argmax(sides)), int(np.argmin(sides))
        # a vertex as near to a corner as that splits off another flat triangle
        if sides[shortest] <= 2 * LOWEST * sides[longest]:
            gone, kept = int(faces[flat, (shortest + 1) % 3]), int(faces[flat, shortest])
            faces = np.where(faces == gone, kept, faces)
            faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
            image[image == gone] = kept
            moved += 2 * float(sides[shortest])
        else:
            faces = _flipped(faces, flat, longest)
            moved += 2 * float(heights[flat] * sides[longest])
    return None


def relative_heights(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Height of each triangle above its longest side, in longest sides, (m,)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    u, v, w = b - a, c - a, c - b
    longest2 = np.maximum(np.maximum(_squares(u), _squares(v)), _squares(w))
    double2 = _squares(np.cross(u, v))
    return np.sqrt(np.divide(double2, longest2 * longest2, out=np.zeros_like(double2), where=longest2 > 0))


def _squares(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", vectors, vectors))


def _flipped(faces: IntArray, flat: int, side: int) -> IntArray:
    """The faces with a flat one given up: the face across its longest side is split by the vertex that lies on it."""
    a, b, top = (int(faces[flat, (side + k) % 3]) for k in range(3))
    others = np.delete(faces, flat, axis=0)
    for k in range(3):
        across = np.flatnonzero((others[:, k] == b) & (others[:, (k + 1) % 3] == a))
        if len(across):
            far = int(others[across[0], (k + 2) % 3])
            others = np.delete(others, across[0], axis=0)
            return np.vstack([others, [[top, a, far], [top, far, b]]])
    return others


def _is_manifold(faces: IntArray) -> bool:
    """Whether no edge is run through twice in the same sense."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return len(np.unique(sides, axis=0)) == len(sides)
