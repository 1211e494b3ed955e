"""A small clean mesh cut out of a surface, with points inserted as vertices: all that libigl ever sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.kernels.flood import flood
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# libigl's solver may hang on a height below 1e-8 of a triangle's sides; at 1e-7 it never did. A point nearer than this
# to a vertex or an edge, relative to the triangle, becomes that vertex or splits that edge.
SNAP = 1e-7


class Patch:
    """Triangles of a surface on which shortest paths are asked for.

    Parameters
    ----------
    surface : Surface
    faces : (n,) int
        Connected faces of it, as :func:`faces_between` finds them.
    """

    def __init__(self, surface: Surface, faces: IntArray) -> None:
        used, compact = np.unique(surface.faces[faces], return_inverse=True)
        self._vertices: list[FloatArray] = list(surface.vertices[used])
        self._faces: list[tuple[int, int, int]] = [(int(a), int(b), int(c)) for a, b, c in compact.reshape(-1, 3)]
        self._pieces: dict[int, list[int]] = {int(face): [n] for n, face in enumerate(faces)}
        self._parent: list[int] = [int(face) for face in faces]

    def copy(self) -> Patch:
        """A patch of its own, to insert a trial point into."""
        other = object.__new__(Patch)
        other._vertices = list(self._vertices)
        other._faces = list(self._faces)
        other._pieces = {face: list(pieces) for face, pieces in self._pieces.items()}
        other._parent = list(self._parent)
        return other

    @property
    def n_faces(self) -> int:
        """Number of triangles."""
        return len(self._faces)

    def arrays(self) -> tuple[FloatArray, IntArray]:
        """Vertices (n, 3) float64 and faces (m, 3) int64."""
        return np.array(self._vertices), np.array(self._faces, dtype=np.int64)

    def insert(self, face: int, position: ArrayLike) -> tuple[int, float]:
        """Make a point of a face of the surface a vertex of the patch.

        Returns
        -------
        vertex : int
        moved : float
            How far the vertex lies from the point, mm: more than round-off only where the point had to be snapped.

        Raises
        ------
        KeyError
            If the patch does not hold the face.
        """
        p = np.asarray(position, dtype=np.float64)
        best = -np.inf
        piece, weight = -1, np.zeros(3)
        for n in self._pieces[face]:
            found = self._barycentric(n, p)
            if found.min() > best:
                best, piece, weight = float(found.min()), n, found
        a, b, c = self._faces[piece]
        corner = int(np.argmax(weight))
        if 1 - weight[corner] <= SNAP:
            vertex = (a, b, c)[corner]
            return vertex, float(np.linalg.norm(self._vertices[vertex] - p))
        new = len(self._vertices)
        opposite = int(np.argmin(weight))
        if weight[opposite] <= SNAP:
            edge = (opposite + 1) % 3
            u, v = self._faces[piece][edge], self._faces[piece][(edge + 1) % 3]
            along = self._vertices[v] - self._vertices[u]
            t = float((p - self._vertices[u]) @ along / (along @ along))
            foot = self._vertices[u] + t * along
            self._vertices.append(foot)
            for n in [n for n, f in enumerate(self._faces) if u in f and v in f]:
                self._split_edge(n, u, v, new)
            return new, float(np.linalg.norm(foot - p))
        self._vertices.append(p)
        self._replace(piece, [(a, b, new), (b, c, new), (c, a, new)])
        return new, 0.0

    def _barycentric(self, n: int, p: FloatArray) -> FloatArray:
        a, b, c = (self._vertices[v] for v in self._faces[n])
        u, v, w = b - a, c - a, p - a
        uu, uv, vv, wu, wv = u @ u, u @ v, v @ v, w @ u, w @ v
        area2 = uu * vv - uv * uv
        beta, gamma = (vv * wu - uv * wv) / area2, (uu * wv - uv * wu) / area2
        return np.array([1 - beta - gamma, beta, gamma])

    def _split_edge(self, n: int, u: int, v: int, new: int) -> None:
        face = self._faces[n]
        self._replace(n, [tuple(new if w == v else w for w in face), tuple(new if w == u else w for w in face)])  # type: ignore[list-item]

    def _replace(self, n: int, pieces: list[tuple[int, int, int]]) -> None:
        self._faces[n] = pieces[0]
        parent = self._parent[n]
        for piece in pieces[1:]:
            self._pieces[parent].append(len(self._faces))
            self._faces.append(piece)
            self._parent.append(parent)


def faces_between(surface: Surface, a: SurfacePoint, b: SurfacePoint, bound: float) -> IntArray:
    """Faces that a path from a to b no longer than `bound` (mm) can touch; empty if b's face is not among them."""
    faces = flood(surface.unfolding, a.face, a.position(surface), b.position(surface), bound)
    return faces if b.face in faces else np.empty(0, dtype=np.int64)
