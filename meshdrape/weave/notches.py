"""Notches of a ragged border, filled before the mould is extended: strips of extension would fight over them.

Scans, decimated and torn meshes end in teeth. Cloth bridges what is between them, as it bridges a hole.
"""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]

# A border that bends inwards with a radius above this many widths is a hollow border, not a notch.
HOLLOW = 2.0
# A filling leans from the faces beside it by less than this.
LEAN_COSINE = 0.5
# Height of the lowest triangle worth adding, of its longest side.
FLATTEST = 1e-3
# Round-off of lengths that are worked out in two ways.
NEARLY = 1e-9


def without_notches(surface: Surface, width: float) -> NDArray[np.int64]:
    """Triangles (n, 3), of the surface's vertices, that fill the notches of its outer borders no wider than `width` mm.

    The narrowest first, each between two neighbouring border edges; what is filled may leave a wider notch to fill.
    """
    filled: list[tuple[int, int, int]] = []
    for loop in surface.border_loops:
        if not surface.is_hole(loop):
            narrow = _narrow(surface, loop, width)
            if len(narrow):
                filled += _Border(surface, loop).fill(width, narrow.tolist())
    return np.array(filled, dtype=np.int64).reshape(-1, 3)


def _narrow(surface: Surface, loop: NDArray[np.int64], width: float) -> NDArray[np.int64]:
    """Places along a border at which there may be a notch: all that :meth:`_Border._offer` takes, and hardly more."""
    tail = surface.faces[loop // 3, loop % 3]
    point = surface.vertices[tail]
    across = (1 - NEARLY) * np.linalg.norm(np.roll(point, -1, axis=0) - np.roll(point, 1, axis=0), axis=1)
    hollow = (surface.vertex_angle[tail] - np.pi) * HOLLOW * width < (0.5 - NEARLY) * across
    return np.flatnonzero(~hollow & (across <= width))


class _Border:
    """One border loop, whose vertices drop out as notches at them are filled."""

    def __init__(self, surface: Surface, loop: NDArray[np.int64]) -> None:
        self.vertices = surface.vertices
        tail = surface.faces[loop // 3, loop % 3]
        n = len(tail)
        self.vertex = tail.tolist()
        self.before = [(k - 1) % n for k in range(n)]
        self.after = [(k + 1) % n for k in range(n)]
        self.angle = surface.vertex_angle[tail].tolist()
        # of the face inside the edge that starts at each vertex
        self.normal = [surface.face_normal[face] for face in (loop // 3).tolist()]
        self.left = n
        # a filling must not join what the mould joins already, be it elsewhere
        here = np.zeros(len(surface.vertices), dtype=bool)
        here[tail] = True
        ends = np.sort(np.stack([surface.faces, surface.faces[:, [1, 2, 0]]], axis=-1).reshape(-1, 2), axis=1)
        self.edges = set(map(tuple, ends[here[ends].all(axis=1)].tolist()))

    def fill(self, width: float, narrow: list[int]) -> list[tuple[int, int, int]]:
        """Fill notches up to a width, beginning at places that may have one; the triangles."""
        from scipy.spatial import cKDTree

        points = self.vertices[self.vertex]
        self.near = cKDTree(points)
        waiting: list[tuple[float, int, int, int]] = []
        for k in narrow:
            self._offer(waiting, k, width)
        filled = []
        while waiting and self.left > 3:
            _, k, u, w = heapq.heappop(waiting)
            if (self.before[k], self.after[k]) != (u, w) or self.vertex[k] < 0:
                continue
            normal = self._filling(k)
            if normal is None:
                continue
            filled.append((self.vertex[k], self.vertex[u], self.vertex[w]))
            a, b = self._corners(u, k, w)
            self.angle[u] += a
            self.angle[w] += b
            self.edges.add((min(self.vertex[u], self.vertex[w]), max(self.vertex[u], self.vertex[w])))
            self.after[u], self.before[w] = w, u
            self.normal[u] = normal
            self.vertex[k] = -1
            self.left -= 1
            for end in (u, w):
                self._offer(waiting, end, width)
        return filled

    def _offer(self, waiting: list[tuple[float, int, int, int]], k: int, width: float) -> None:
        u, w = self.before[k], self.after[k]
        across = float(np.linalg.norm(self._at(w) - self._at(u)))
        # half the chord over the turn is the radius of the bend
        if (self.angle[k] - np.pi) * HOLLOW * width < 0.5 * across:
            return
        if across <= width:
            heapq.heappush(waiting, (across, k, u, w))

    def _at(self, k: int) -> FloatArray:
        return np.asarray(self.vertices[self.vertex[k]])

    def _corners(self, u: int, k: int, w: int) -> tuple[float, float]:
        """Angles of the triangle at u and at w."""
        p, q, r = self._at(u), self._at(k), self._at(w)
        return _angle(q - p, r - p), _angle(p - r, q - r)

    def _filling(self, k: int) -> FloatArray | None:
        """Normal of the triangle that fills the notch at k; None where there should be none."""
        u, w = self.before[k], self.after[k]
        ends = (min(self.vertex[u], self.vertex[w]), max(self.vertex[u], self.vertex[w]))
        if ends in self.edges or self.vertex[u] == self.vertex[w]:
            return None
        q, p, r = self._at(k), self._at(u), self._at(w)
        normal = np.cross(p - q, r - q)
        size = float(np.linalg.norm(normal))
        longest = max(float(np.linalg.norm(p - q)), float(np.linalg.norm(r - q)), float(np.linalg.norm(r - p)))
        if size < FLATTEST * longest * longest:
            return None
        normal /= size
        if min(float(normal @ self.normal[u]), float(normal @ self.normal[k])) < LEAN_COSINE:
            return None
        # a tooth that reaches into the notch from elsewhere is no place for it
        sides = [np.cross(normal, e - s) for s, e in ((q, p), (p, r), (r, q))]
        for other in self.near.query_ball_point((p + q + r) / 3, longest):
            if other in (u, k, w) or self.vertex[other] < 0:
                continue
            point = self._at(other)
            if all(float(side @ (point - s)) >= 0 for side, s in zip(sides, (q, p, r), strict=True)):
                return None
        return np.asarray(normal)


def _angle(a: FloatArray, b: FloatArray) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
