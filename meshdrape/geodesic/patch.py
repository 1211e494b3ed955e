"""A small clean mesh cut out of a surface, with points inserted as vertices: all that libigl ever sees."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.kernels.flood import flood
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A point nearer than this to a vertex or an edge, relative to the triangle, is on it but for round-off. Triangles that
# come out flat all the same are seen to by :mod:`meshdrape.geodesic.screen`.
SNAP = 1e-12


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
        self._vertices: list[list[float]] = surface.vertices[used].tolist()
        self._faces: list[list[int]] = compact.reshape(-1, 3).tolist()
        self._parent: list[int] = faces.tolist()
        self._pieces: dict[int, list[int]] = {face: [n] for n, face in enumerate(self._parent)}

    @classmethod
    def around(cls, surface: Surface, faces: IntArray, a: SurfacePoint, b: SurfacePoint, reach: float) -> Patch:
        """A patch that holds all paths from a to b no longer than `reach` (mm), cut out of the faces around them.

        Of triangles much larger than the paths only the part near them is kept: libigl drops what is below a
        millionth of an edge, and that must be small beside the path, not beside the mould.
        """
        ends = (a, b)
        places = [end.position(surface) for end in ends]
        centre, radius = 0.5 * (places[0] + places[1]), 0.55 * reach
        corners = surface.vertices[surface.faces[faces]]
        if float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()) <= 8 * radius:
            return cls(surface, faces)
        return _cut(cls(surface, np.empty(0, dtype=np.int64)), surface, faces, ends, centre, radius)

    def _add(self, face: int, triangle: list[int]) -> None:
        self._pieces.setdefault(face, []).append(len(self._faces))
        self._faces.append(triangle)
        self._parent.append(face)

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
            If the patch does not hold the point.
        """
        p: list[float] = np.asarray(position, dtype=np.float64).tolist()
        # a point on the edge of a face that was cut away belongs to the face beyond as well
        pieces = self._pieces.get(face) or range(len(self._faces))
        if not pieces:
            raise KeyError(face)
        weights = [_barycentric(p, *(self._vertices[v] for v in self._faces[n])) for n in pieces]
        best = max(range(len(pieces)), key=lambda n: min(weights[n]))
        piece, weight = pieces[best], weights[best]
        if not min(weight) >= -1e-6:
            raise KeyError(face)
        a, b, c = self._faces[piece]
        corner = weight.index(max(weight))
        if 1 - weight[corner] <= SNAP:
            vertex = self._faces[piece][corner]
            return vertex, math.dist(self._vertices[vertex], p)
        new = len(self._vertices)
        opposite = weight.index(min(weight))
        if weight[opposite] <= SNAP:
            edge = (opposite + 1) % 3
            u, v = self._faces[piece][edge], self._faces[piece][(edge + 1) % 3]
            tail, along = self._vertices[u], _less(self._vertices[v], self._vertices[u])
            t = _dot(_less(p, tail), along) / _dot(along, along)
            foot = [x + t * dx for x, dx in zip(tail, along, strict=True)]
            self._vertices.append(foot)
            for n in [n for n, f in enumerate(self._faces) if u in f and v in f]:
                self._split_edge(n, u, v, new)
            return new, math.dist(foot, p)
        self._vertices.append(p)
        self._replace(piece, [[a, b, new], [b, c, new], [c, a, new]])
        return new, 0.0

    def _split_edge(self, n: int, u: int, v: int, new: int) -> None:
        self._replace(n, [[new if w == gone else w for w in self._faces[n]] for gone in (v, u)])

    def _replace(self, n: int, pieces: list[list[int]]) -> None:
        self._faces[n] = pieces[0]
        for piece in pieces[1:]:
            self._add(self._parent[n], piece)


def _barycentric(p: list[float], a: list[float], b: list[float], c: list[float]) -> list[float]:
    """Barycentric coordinates (3,) of a point in a triangle.

    By cross products: of a needle, products of lengths would leave nothing but round-off. One of no area holds nothing.
    """
    u, v, w = _less(b, a), _less(c, a), _less(p, a)
    normal = _cross(u, v)
    double2 = _dot(normal, normal)
    if double2 == 0:
        return [-math.inf] * 3
    beta, gamma = _dot(_cross(w, v), normal) / double2, _dot(_cross(u, w), normal) / double2
    return [1 - beta - gamma, beta, gamma]


# numpy takes longer to begin than these to be done
def _less(a: list[float], b: list[float]) -> list[float]:
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def _dot(a: list[float], b: list[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _cut(
    patch: Patch,
    surface: Surface,
    faces: IntArray,
    ends: tuple[SurfacePoint, ...],
    centre: FloatArray,
    radius: float,
) -> Patch:
    """Fill an empty patch with the hull, face by face, of what a ball keeps of the edges, and of the end points.

    A path inside the ball crosses a face between two kept pieces of its edges, or from an end: the hull holds it.
    Where a face has none of its edges in the ball, what of it lies there is held.
    """
    number: dict[tuple[int, int, int], int] = {}

    def vertex(key: tuple[int, int, int], position: list[float]) -> int:
        if key not in number:
            number[key] = len(patch._vertices)
            patch._vertices.append(position)
        return number[key]

    pieces = _kept_pieces(surface, faces, centre, radius)
    for face in faces.tolist():
        ring: list[int] = []
        for k in range(3):
            u, v = sorted((int(surface.faces[face, k]), int(surface.faces[face, (k + 1) % 3])))
            kept = pieces[u, v]
            if kept is None:
                continue
            piece = []
            for side, t in enumerate(kept):
                position = (surface.vertices[u] + t * (surface.vertices[v] - surface.vertices[u])).tolist()
                # a piece that goes to the corner ends in the mesh's own vertex
                key = (u, u, 0) if t == 0 else (v, v, 0) if t == 1 else (u, v, side)
                piece.append(vertex(key, position))
            ring += piece if u == surface.faces[face, k] else piece[::-1]
        inside = [end.position(surface) for end in ends if end.face == face and end.barycentric.min() > SNAP]
        first = len(patch._vertices)
        frame = surface.unfolding.frame[face]
        if not ring:
            inside += _ball_outline(surface, face, centre, radius)
        # an end on an edge gives the face some depth, lest nothing be left of it but that edge
        middle = surface.vertices[surface.faces[face]].mean(axis=0)
        for end in ends:
            inward = middle - end.position(surface)
            if end.face == face and inward.any():
                inside.append(end.position(surface) + min(0.5, radius / float(np.linalg.norm(inward))) * inward)
        patch._vertices += [place.tolist() for place in inside]
        points = list(dict.fromkeys(ring)) + list(range(first, first + len(inside)))
        flat = {n: ((p := np.array(patch._vertices[n]) - frame[:3]) @ frame[3:6], p @ frame[6:9]) for n in points}
        hull = _hull(points, flat)
        for n in range(1, len(hull) - 1):
            patch._add(face, [hull[0], hull[n], hull[n + 1]])
    return patch


def _ball_outline(surface: Surface, face: int, centre: FloatArray, radius: float) -> list[FloatArray]:
    """Points, sixteen at most, in which the plane of a face cuts the surface of a ball, well inside the face."""
    frame = surface.unfolding.frame[face]
    off = centre - frame[:3]
    foot = frame[:3] + off @ frame[3:6] * frame[3:6] + off @ frame[6:9] * frame[6:9]
    across2 = radius * radius - float((centre - foot) @ (centre - foot))
    if across2 <= 0:
        return []
    turns = np.arange(16) * (np.pi / 8)
    rim = foot + np.sqrt(across2) * (np.outer(np.cos(turns), frame[3:6]) + np.outer(np.sin(turns), frame[6:9]))
    a, b, c = surface.vertices[surface.faces[face]]
    normal = np.cross(b - a, c - a)
    size = float(np.linalg.norm(normal))
    heights = [np.cross(e - s, rim - s) @ normal / size / np.linalg.norm(e - s) for s, e in ((a, b), (b, c), (c, a))]
    return list(rim[np.min(heights, axis=0) > 0.05 * radius])


def _kept_pieces(
    surface: Surface, faces: IntArray, centre: FloatArray, radius: float
) -> dict[tuple[int, int], tuple[float, float] | None]:
    """Part of each edge u-v, u < v, of the faces that is kept.

    Where an edge keeps an end, all edges there do: a hull with a corner in it runs along the whole of the edges at that
    corner, and the face beyond must have the same vertices on them.
    """
    corners = surface.faces[faces]
    edges = np.unique(np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2), axis=1), axis=0)
    pieces: dict[tuple[int, int], tuple[float, float] | None] = {}
    kept_ends: set[int] = set()
    for u, v in edges.tolist():
        piece = pieces[u, v] = _kept_piece(surface.vertices[u], surface.vertices[v], centre, radius)
        if piece is not None:
            kept_ends.update(end for end, t in zip((u, v), piece, strict=True) if t in (0.0, 1.0))
    for (u, v), piece in pieces.items():
        if piece is not None:
            pieces[u, v] = (0.0 if u in kept_ends else piece[0], 1.0 if v in kept_ends else piece[1])
    return pieces


def _kept_piece(u: FloatArray, v: FloatArray, centre: FloatArray, radius: float) -> tuple[float, float] | None:
    """Part of the edge u-v, as parameters in [0, 1], that lies in a ball; never a sliver of it; None outside."""
    along = v - u
    length = float(np.linalg.norm(along))
    middle = float((centre - u) @ along) / length
    off = centre - u - (middle / length) * along
    off2 = float(off @ off)
    if off2 >= radius * radius:
        return None
    half = max(float(np.sqrt(radius * radius - off2)), 0.3 * radius)
    low, high = (middle - half) / length, (middle + half) / length
    if high <= 0 or low >= 1:
        return None
    margin = 0.1 * radius / length
    return (0.0 if low < margin else low, 1.0 if high > 1 - margin else high)


def _hull(points: list[int], flat: dict[int, tuple[float, float]]) -> list[int]:
    """Convex hull, counter-clockwise, of points in a plane (Andrew's monotone chain)."""
    if len(points) < 3:
        return []
    ordered = sorted(points, key=lambda n: flat[n])
    size = max(abs(x - flat[ordered[0]][k]) for n in points for k, x in enumerate(flat[n]))
    chains = []
    for sequence in (ordered, ordered[::-1]):
        chain: list[int] = []
        for n in sequence:
            while len(chain) > 1:
                (ax, ay), (bx, by), (cx, cy) = flat[chain[-2]], flat[chain[-1]], flat[n]
                if (bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 1e-12 * size * size:
                    break
                chain.pop()
            chain.append(n)
        chains.append(chain[:-1])
    hull = chains[0] + chains[1]
    return hull if len(hull) > 2 else []


def faces_between(surface: Surface, a: SurfacePoint, b: SurfacePoint, bound: float) -> IntArray:
    """Faces that a path from a to b no longer than `bound` (mm) can touch; empty if b's face is not among them."""
    faces = flood(surface.unfolding, a.face, a.position(surface), b.position(surface), bound)
    return faces if b.face in faces else np.empty(0, dtype=np.int64)
