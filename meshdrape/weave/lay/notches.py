"""Notches and slits of the border, filled before the mould is extended: strips of extension would fight over them.

Scans, decimated and torn meshes end in teeth; plates are cut open or slotted. Cloth bridges what is between, as it
bridges a hole.
"""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface
from meshdrape.weave.lay.outlines import triangulate
from meshdrape.weave.lay.slits import facing_edges

FloatArray = NDArray[np.float64]

# A border that bends inwards with a radius above this many widths is a hollow border, not a notch.
HOLLOW = 2.0
# A filling leans from the faces beside it by less than this.
LEAN_COSINE = 0.5
# Height of the lowest triangle worth adding, of its longest side; a slit may be far longer than wide.
FLATTEST, SLIVER = 1e-3, 1e-6
# Vertices at the closed end of a slit that is filled at one stroke, at most.
LONGEST_END = 12
# Round-off of lengths that are worked out in two ways.
NEARLY = 1e-9


def without_notches(surface: Surface, width: float, slit: float = 0.0) -> NDArray[np.int64]:
    """Triangles (n, 3), of the surface's vertices, that fill the notches and slits of its outer borders.

    The narrowest notch first, each between two neighbouring border edges; what is filled may leave a wider one to
    fill. Then slits, each between two border edges that face each other, and from there on to both its ends.

    Parameters
    ----------
    width : float
        Of the widest notch, mm.
    slit : float
        Of the widest slit, mm, not above `width`; 0 for none.
    """
    loops = [loop for loop in surface.border_loops if not surface.is_hole(loop)]
    narrow = [_narrow(surface, loop, width) for loop in loops]
    first = np.cumsum([0, *map(len, loops)])
    if not any(map(len, narrow)) and (slit == 0 or not _has_slits(surface, loops, slit, width)):
        return np.empty((0, 3), dtype=np.int64)
    border = _Border(surface, loops)
    border.fill(width, np.concatenate([a + b for a, b in zip(first[:-1], narrow, strict=True)]).tolist())
    # what is filled may face what did not face it before
    while border.fill_slits(width, slit):
        pass
    return np.array(border.filled, dtype=np.int64).reshape(-1, 3)


def _narrow(surface: Surface, loop: NDArray[np.int64], width: float) -> NDArray[np.int64]:
    """Places along a border at which there may be a notch: all that :meth:`_Border._offer` takes, and hardly more."""
    tail = surface.faces[loop // 3, loop % 3]
    point = surface.vertices[tail]
    across = (1 - NEARLY) * np.linalg.norm(np.roll(point, -1, axis=0) - np.roll(point, 1, axis=0), axis=1)
    hollow = (surface.vertex_angle[tail] - np.pi) * HOLLOW * width < (0.5 - NEARLY) * across
    return np.flatnonzero(~hollow & (across <= width))


def _has_slits(surface: Surface, loops: list[NDArray[np.int64]], slit: float, width: float) -> bool:
    """Whether there are any in borders as they are."""
    if not loops:
        return False
    loop = np.concatenate(loops)
    ends = np.cumsum([len(each) for each in loops])
    after = np.arange(1, len(loop) + 1)
    after[ends - 1] = ends - [len(each) for each in loops]
    tail = surface.vertices[surface.faces[loop // 3, loop % 3]]
    return bool(facing_edges(tail, surface.face_normal[loop // 3], after, slit, width))


class _Border:
    """Border loops, whose vertices drop out as notches at them are filled.

    Attributes
    ----------
    filled : list of triangles
        What was filled so far.
    """

    def __init__(self, surface: Surface, loops: list[NDArray[np.int64]]) -> None:
        from scipy.spatial import cKDTree

        self.vertices = surface.vertices
        loop = np.concatenate(loops)
        tail = surface.faces[loop // 3, loop % 3]
        self.vertex = tail.tolist()
        self.before: list[int] = []
        self.after: list[int] = []
        for n in map(len, loops):
            first = len(self.after)
            self.before += [first + (k - 1) % n for k in range(n)]
            self.after += [first + (k + 1) % n for k in range(n)]
        self.angle = surface.vertex_angle[tail].tolist()
        # of the face inside the edge that starts at each vertex
        self.normal = [surface.face_normal[face] for face in (loop // 3).tolist()]
        # whether that edge ends a stretch of slit that is filled
        self.front = [False] * len(tail)
        # a filling must not join what the mould joins already, be it elsewhere
        here = np.zeros(len(surface.vertices), dtype=bool)
        here[tail] = True
        ends = np.sort(np.stack([surface.faces, surface.faces[:, [1, 2, 0]]], axis=-1).reshape(-1, 2), axis=1)
        self.edges = set(map(tuple, ends[here[ends].all(axis=1)].tolist()))
        self.near = cKDTree(self.vertices[self.vertex])
        self.filled: list[tuple[int, int, int]] = []

    def fill(self, width: float, narrow: list[int], slit: float = 0.0) -> None:
        """Fill notches up to a width, and a slit on from where it is filled, beginning at places that may be one."""
        waiting: list[tuple[float, int, int, int]] = []
        for k in narrow:
            self._offer(waiting, k, width, slit)
        while waiting:
            _, k, u, w = heapq.heappop(waiting)
            if (self.before[k], self.after[k]) != (u, w) or self.vertex[k] < 0:
                continue
            if self._fit([(k, u, w)], FLATTEST, front=self.front[u] or self.front[k]):
                for end in (u, w):
                    self._offer(waiting, end, width, slit)

    def fill_slits(self, width: float, slit: float) -> bool:
        """Fill slits up to a width between the border edges that face each other now; whether there are any."""
        live = np.array([k for k, vertex in enumerate(self.vertex) if vertex >= 0])
        if len(live) < 4 or slit == 0:
            return False
        after = np.searchsorted(live, np.array(self.after)[live])
        tail = self.vertices[[self.vertex[k] for k in live]]
        any_filled = False
        for k, p in facing_edges(tail, np.array([self.normal[k] for k in live]), after, slit, width):
            if self._bridge(int(live[k]), int(live[p])):
                self.fill(width, self._ends_of_front(), slit)
                any_filled = True
        return any_filled

    def _bridge(self, k: int, p: int) -> bool:
        """Fill between two border edges that face each other, from k and from p on; whether there is room for that."""
        m, v = self.after[k], self.after[p]
        if min(self.vertex[k], self.vertex[p]) < 0 or len({k, m, p, v}) < 4 or self.front[k] or self.front[p]:
            return False
        # m lies across from p, and k from v; cut along the shorter diagonal
        if np.linalg.norm(self._at(v) - self._at(m)) <= np.linalg.norm(self._at(k) - self._at(p)):
            halves = [(k, v, m), (p, m, v)]
        else:
            halves = [(k, p, m), (p, k, v)]
        if self._fit(halves, SLIVER, front=True):
            return True
        # there may be vertices between the two at the slit's end
        for outline in ([k, *self._chain(m, p), v], [p, *self._chain(v, k), m]):
            if len(outline) > 4:
                # the filling runs the other way round than the border
                outline.reverse()
                ears = triangulate(self.vertices[[self.vertex[n] for n in outline]], self.normal[k])
                triangles = [] if ears is None else np.array(outline)[ears].tolist()
                if triangles and self._fit([(a, b, c) for a, b, c in triangles], SLIVER, front=True):
                    return True
        return False

    def _ends_of_front(self) -> list[int]:
        """Places at both ends of the edges that end a filled stretch of slit."""
        fronts = [k for k, front in enumerate(self.front) if front and self.vertex[k] >= 0]
        return fronts + [self.after[k] for k in fronts]

    def _chain(self, first: int, last: int) -> list[int]:
        """Places along the border from one to another, both included; none where they are many."""
        chain = [first]
        while chain[-1] != last and len(chain) < LONGEST_END:
            chain.append(self.after[chain[-1]])
        return chain if chain[-1] == last else []

    def _fit(self, triangles: list[tuple[int, int, int]], flattest: float, *, front: bool) -> bool:
        """Fill with triangles, whose corners are places on the border, if there is room for them all."""
        sides = {(t[n - 1], t[n]) for t in triangles for n in range(3)}
        outer = [(a, b) for a, b in sides if (b, a) not in sides]
        closed = [a for b, a in outer if self.after[a] == b]
        ends = sorted((a, b) for a, b in outer if self.after[b] != a)
        new = {self._ends(a, b) for a, b in sides if (a, b) not in outer} | {self._ends(a, b) for a, b in ends}
        if new & self.edges or any(a == b for a, b in new):
            return False
        normal = self._normals(triangles, flattest, [self.normal[a] for a in closed])
        if normal is None or (flattest < FLATTEST and any(self._crossed(*end) for end in ends)):
            return False
        for t in triangles:
            self.filled.append((self.vertex[t[0]], self.vertex[t[1]], self.vertex[t[2]]))
            for n in range(3):
                self.angle[t[n]] += _angle(self._at(t[n - 1]) - self._at(t[n]), self._at(t[n - 2]) - self._at(t[n]))
        self.edges |= new
        done = {a for a in closed if self.before[a] in closed} - {a for end in ends for a in end}
        for a, b in ends:
            self.after[a], self.before[b] = b, a
            self.normal[a] = next(n for n, t in zip(normal, triangles, strict=True) if a in t and b in t)
            self.front[a] = front
        for a in done:
            self.vertex[a] = -1
        return True

    def _offer(self, waiting: list[tuple[float, int, int, int]], k: int, width: float, slit: float) -> None:
        if self.vertex[k] < 0:
            return
        u, w = self.before[k], self.after[k]
        legs = [float(np.linalg.norm(self._at(end) - self._at(k))) for end in (u, w)]
        across = float(np.linalg.norm(self._at(w) - self._at(u)))
        # half the chord over the turn is the radius of the bend
        if (self.angle[k] - np.pi) * HOLLOW * width < 0.5 * across:
            return
        if across <= width:
            heapq.heappush(waiting, (across, k, u, w))
        elif (self.front[u] or self.front[k]) and across <= max(legs):
            # on along a slit, however long its edges
            height = float(np.linalg.norm(np.cross(self._at(u) - self._at(k), self._at(w) - self._at(k)))) / max(legs)
            if height <= slit:
                heapq.heappush(waiting, (height, k, u, w))

    def _at(self, k: int) -> FloatArray:
        return np.asarray(self.vertices[self.vertex[k]])

    def _ends(self, a: int, b: int) -> tuple[int, int]:
        return min(self.vertex[a], self.vertex[b]), max(self.vertex[a], self.vertex[b])

    def _normals(
        self, triangles: list[tuple[int, int, int]], flattest: float, beside: list[FloatArray]
    ) -> list[FloatArray] | None:
        """Normals of triangles that fill, between faces of the given normals; None where there should be none."""
        mine = {self.vertex[n] for t in triangles for n in t}
        normals = []
        for t in triangles:
            q, p, r = (self._at(n) for n in t)
            normal = np.cross(p - q, r - q)
            size = float(np.linalg.norm(normal))
            longest = max(float(np.linalg.norm(p - q)), float(np.linalg.norm(r - q)), float(np.linalg.norm(r - p)))
            if size < flattest * longest * longest:
                return None
            normal /= size
            if min(float(normal @ face) for face in beside) < LEAN_COSINE:
                return None
            # a tooth that reaches into the notch from elsewhere is no place for it
            sides = [np.cross(normal, e - s) for s, e in ((q, p), (p, r), (r, q))]
            for other in self.near.query_ball_point((p + q + r) / 3, longest):
                if self.vertex[other] < 0 or self.vertex[other] in mine:
                    continue
                point = self._at(other)
                if all(float(side @ (point - s)) >= 0 for side, s in zip(sides, (q, p, r), strict=True)):
                    return None
            normals.append(np.asarray(normal))
        return normals

    def _crossed(self, a: int, b: int) -> bool:
        """Whether a border edge runs across the way from a to b: seen along the normal there, and no farther off."""
        start, way = self._at(a), self._at(b) - self._at(a)
        size = float(np.linalg.norm(way))
        live = [k for k, vertex in enumerate(self.vertex) if vertex >= 0 and not {a, b} & {k, self.after[k]}]
        tail = self.vertices[[self.vertex[k] for k in live]] - start
        head = self.vertices[[self.vertex[self.after[k]] for k in live]] - start
        normal = self.normal[a]
        left = np.cross(normal, way)
        ends = [points @ left for points in (tail, head)]
        passes = ends[0] * ends[1] < 0
        at = (ends[0] / np.where(passes, ends[0] - ends[1], 1.0))[:, None]
        point = tail + at * (head - tail)
        along = point @ way / (size * size)
        return bool((passes & (along > 0) & (along < 1) & (np.abs(point @ normal) < size)).any())


def _angle(a: FloatArray, b: FloatArray) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
