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

# Lowest height of a triangle, in longest sides, that goes to libigl as it is.
LOWEST = 1e-6
# Below this libigl may go on for ever: of 10,000 meshes with a triangle as low as 1e-4 to 1e-6 twelve made it, of those
# with one of 1e-7 one in seventy, of those above 1e-4 none.
DOUBTFUL = 1e-3
# Where it did, a mesh without triangles as low as this is the next best.
SAFE = 1e-5


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
    lowest : float
        Least height of a triangle that is left, in its longest sides.
    """

    faces: IntArray
    image: IntArray
    moved: float
    lowest: float


def screened(vertices: FloatArray, faces: IntArray, lowest: float = LOWEST) -> Screened | None:
    """The mesh without its flat triangles; None where they cannot be taken out of it.

    Parameters
    ----------
    vertices : (n, 3), mm
    faces : (m, 3)
        Manifold, oriented.
    lowest : float
        Height, in longest sides, from which on a triangle may stay.
    """
    image = np.arange(len(vertices))
    moved = 0.0
    # each step takes a triangle away or lets one vertex less lie on a side
    for _ in range(4 * len(faces)):
        if not len(faces):
            return None
        heights = relative_heights(vertices, faces)
        flat = int(np.argmin(heights))
        if heights[flat] >= lowest:
            whole = moved == 0.0 or _is_manifold(faces)
            return Screened(faces, image, moved, float(heights[flat])) if whole else None
        corners = vertices[faces[flat]]
        sides = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
        longest, shortest = int(np.argmax(sides)), int(np.argmin(sides))
        # a vertex as near to a corner as that splits off another flat triangle
        if sides[shortest] <= 2 * lowest * sides[longest]:
            gone, kept = int(faces[flat, (shortest + 1) % 3]), int(faces[flat, shortest])
            faces = np.where(faces == gone, kept, faces)
            faces = faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)]
            image[image == gone] = kept
            moved += 2 * float(sides[shortest])
        else:
            height = float(heights[flat] * sides[longest])
            faces, cosine = _flipped(vertices, faces, flat, longest)
            # what lay in the flat one's plane now lies in its neighbour's: where these are one nothing changes
            moved += 2 * height * (1 - cosine) + 2 * height * float(heights[flat])
    return None


def relative_heights(vertices: FloatArray, faces: IntArray) -> FloatArray:
    """Height of each triangle above its longest side, in longest sides, (m,)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    u, v, w = b - a, c - a, c - b
    longest2 = np.maximum(np.maximum(_squares(u), _squares(v)), _squares(w))
    double2 = _squares(np.cross(u, v))
    squared = np.divide(double2, longest2 * longest2, out=np.zeros_like(double2), where=longest2 > 0)
    return np.asarray(np.sqrt(squared))


def _squares(vectors: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->i", vectors, vectors))


def _flipped(vertices: FloatArray, faces: IntArray, flat: int, side: int) -> tuple[IntArray, float]:
    """The faces with a flat one given up, and the cosine of its angle with the face across its longest side.

    That face is split by the vertex that lies on the side.
    """
    a, b, top = (int(faces[flat, (side + k) % 3]) for k in range(3))
    others = np.delete(faces, flat, axis=0)
    for k in range(3):
        across = np.flatnonzero((others[:, k] == b) & (others[:, (k + 1) % 3] == a))
        if len(across):
            far = int(others[across[0], (k + 2) % 3])
            others = np.delete(others, across[0], axis=0)
            along = vertices[b] - vertices[a]
            up, down = (np.cross(along, vertices[v] - vertices[a]) for v in (top, far))
            cosine = -float(up @ down) / float(np.linalg.norm(up) * np.linalg.norm(down) or np.inf)
            return np.vstack([others, [[top, a, far], [top, far, b]]]), cosine
    # on a border it is left out, and its vertex with it unless other faces have it
    return others, 0.0


def _is_manifold(faces: IntArray) -> bool:
    """Whether no edge is run through twice in the same sense."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    return len(np.unique(sides, axis=0)) == len(sides)
