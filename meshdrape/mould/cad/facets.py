"""Triangles of CAD faces in their own parameters, whose diagonals can be turned and whose edges can be split.

The measure throughout is a metric of the faces,

    M = I / length^2 + III / angle^2,

the first fundamental form and the third, that of the normals: two nodes are a unit apart where the normal
turns by ``angle`` between them. A triangulation that is Delaunay in this metric runs its long edges along the
rulings of a developable face, where the normal does not turn, and spreads the nodes of a doubly curved face
evenly over its Gauss image. That is what a net asks of a mesh: a vertex carries the curvature of its
neighbourhood as angle defect and shears every cell beyond it by as much, so none should carry more than
another, however long and thin the face.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from meshdrape.mould.apart import step
from meshdrape.mould.cad.patch import Bools, Floats, Ints, Nodes

# rad of opposite angles that a flip must gain, so that round-off cannot turn a diagonal to and fro.
FLIP_GAIN: Final = 1e-6
# Share of a facet's tilt that a flip must gain.
TILT_GAIN: Final = 1e-3
# Smallest share a triangle may have of its quadrilateral in (u, v): less is three nodes in line.
THINNEST: Final = 1e-6
# Rounds of flips, beyond one for each diagonal of a fan over a straight side, which turns over one by one. The two
# rules for a flip, shape and tilt, may chase each other round a handful of diagonals.
MOST_ROUNDS: Final = 100


class Facets:
    """A triangulation of one or more CAD faces, each a component of its own.

    Half-edge 3 t + k runs from corner k to corner k + 1 of triangle t, counter-clockwise in (u, v).

    Attributes
    ----------
    nodes : Nodes
    triangles : (t, 3) int64
    face_angle : (n_faces,) float64
        What the normal of a facet may differ by from those of the face at its corners, rad.
    twin : (3 t,) int64
        The half-edge on the other side of each, -1 on the outline.
    """

    def __init__(self, nodes: Nodes, triangles: Ints, face_angle: Floats) -> None:
        self.nodes = nodes
        self.triangles = triangles.copy()
        self.face_angle = face_angle
        self.twin = _twins(triangles, len(nodes))
        self._random = np.random.default_rng(0)

    def inner_edges(self, triangles: Ints | None = None) -> Ints:
        """Return one half-edge of each edge between two triangles; only of the given triangles, if any."""
        if triangles is None:
            half = np.arange(len(self.twin))
            return half[half < self.twin]
        half = (3 * triangles[:, None] + np.arange(3)).ravel()
        twin = self.twin[half]
        return np.unique(np.minimum(half, twin)[twin >= 0])

    def quads(self, edge: Ints) -> tuple[Ints, Ints, Ints, Ints]:
        """Return the ends a, b of inner edges, the corner c on their left and d on their right."""
        corner, twin = self.triangles.ravel(), self.twin[edge]
        return corner[edge], corner[_next(edge)], corner[_previous(edge)], corner[_previous(twin)]

    def apart(self, edge: Ints, priority: Floats) -> Bools:
        """Whether an edge comes first in both its triangles: no two such edges share a triangle."""
        rank = np.empty(len(edge), dtype=np.int64)
        rank[np.argsort(priority, kind="stable")] = np.arange(len(edge))
        left, right = edge // 3, self.twin[edge] // 3
        best = np.full(len(self.triangles), -1, dtype=np.int64)
        np.maximum.at(best, left, rank)
        np.maximum.at(best, right, rank)
        return np.asarray((best[left] == rank) & (best[right] == rank))

    def make_delaunay(self, touched: Ints | None = None) -> None:
        """Turn diagonals until all edges of the touched triangles are Delaunay, as far as (u, v) allows."""
        fan = len(self.triangles) if touched is None else 0
        for _ in range(MOST_ROUNDS + fan):
            step()
            edge = self.inner_edges(touched)
            edge = edge[self._gains(edge)]
            edge = edge[self.apart(edge, self._random.random(len(edge)))]
            if not len(edge):
                return
            touched = self._flip(edge)

    def split(self, edge: Ints, middle: Nodes) -> Ints:
        """Put the given nodes on edges that are apart; returns the triangles touched."""
        a, b, c, d = self.quads(edge)
        twin, n = self.twin[edge], len(edge)
        m = len(self.nodes) + np.arange(n)
        left, right = edge // 3, twin // 3
        left_b = len(self.triangles) + np.arange(n)
        right_b = left_b + n
        self.nodes = Nodes.joined([self.nodes, middle])
        self.triangles[left], self.triangles[right] = np.column_stack([a, m, c]), np.column_stack([m, a, d])
        self.triangles = np.vstack([self.triangles, np.column_stack([m, b, c]), np.column_stack([b, m, d])])
        self.twin = np.concatenate([self.twin, np.full(6 * n, -1, dtype=np.int64)])
        self._rename(
            [_next(edge), _previous(edge), _next(twin), _previous(twin)],  # b-c, c-a, a-d, d-b
            [3 * left_b + 1, 3 * left + 2, 3 * right + 1, 3 * right_b + 2],
        )
        self._pair(3 * left, 3 * right)
        self._pair(3 * left_b, 3 * right_b)
        self._pair(3 * left + 1, 3 * left_b + 2)
        self._pair(3 * right + 2, 3 * right_b + 1)
        return np.concatenate([left, right, left_b, right_b])

    def _flip(self, edge: Ints) -> Ints:
        """Turn the diagonals a-b, which are apart, into c-d; returns the triangles touched."""
        a, b, c, d = self.quads(edge)
        twin = self.twin[edge]
        left, right = edge // 3, twin // 3
        self.triangles[left], self.triangles[right] = np.column_stack([a, d, c]), np.column_stack([b, c, d])
        self._rename(
            [_next(edge), _previous(edge), _next(twin), _previous(twin)],  # b-c, c-a, a-d, d-b
            [3 * right, 3 * left + 2, 3 * left, 3 * right + 2],
        )
        self._pair(3 * left + 1, 3 * right + 1)
        return np.concatenate([left, right])

    def tilt(self, a: Ints, b: Ints, c: Ints) -> Floats:
        """Return how far facets tilt from their face, as a multiple of what they may, (k,).

        That is the angle between the normal of the facet and those of the face at its corners. A pole has no
        normal of its own, and a facet on two nodes of one pole will not be there.
        """
        position, normal = self.nodes.position, self.nodes.normal
        across = np.cross(position[b] - position[a], position[c] - position[a])
        least = np.full(len(a), np.inf)
        for corner in (a, b, c):
            along = np.einsum("ki,ki->k", across, normal[corner])
            least = np.minimum(least, np.where(self.nodes.pole[corner], np.inf, along))
        cosine = least / np.maximum(np.linalg.norm(across, axis=1), np.finfo(float).tiny)
        pole = self.nodes.pole
        known = np.isfinite(least) & (pole[a].astype(int) + pole[b] + pole[c] < 2)
        angle = np.arccos(np.clip(np.where(known, cosine, 1.0), -1.0, 1.0))
        return np.asarray(angle / self.face_angle[self.nodes.face[a]])

    def _gains(self, edge: Ints) -> Bools:
        """Whether a diagonal is better turned and may be.

        Better is Delaunay in the mean metric of the quadrilateral, so long as neither facet tilts too far for its
        size, and less tilt by a shorter diagonal where one does.
        """
        a, b, c, d = self.quads(edge)
        da, ca, cb, db = ((self.nodes.uv[q] - self.nodes.uv[p]).T for p, q in ((d, a), (c, a), (c, b), (d, b)))
        at_a, at_b = _cross(da, ca), _cross(cb, db)
        convex = np.minimum(at_a, at_b) > THINNEST * (at_a + at_b)
        m = self.nodes.metric[np.stack([a, b, c, d])].sum(axis=0).T
        root = np.sqrt(np.maximum(m[0] * m[2] - m[1] ** 2, 0.0))
        now = _angle(m, root, ca, cb) + _angle(m, root, db, da)
        then = _angle(m, root, -da, -ca) + _angle(m, root, -cb, -db)
        # while edges are still longer than a unit their facets tilt by as much more
        long = np.sqrt(np.maximum(np.maximum(_square(m, ca - cb), _square(m, ca - da)) / 4, 1.0))
        tilt = np.maximum(self.tilt(a, b, c), self.tilt(b, a, d)) / long
        place = self.nodes.position
        shorter = np.linalg.norm(place[c] - place[d], axis=1) < np.linalg.norm(place[a] - place[b], axis=1)
        may_be = convex & np.where(tilt > 1.0, shorter, now - then > FLIP_GAIN)
        turned = np.full(len(edge), np.inf)
        a, b, c, d = a[may_be], b[may_be], c[may_be], d[may_be]
        turned[may_be] = np.maximum(self.tilt(a, d, c), self.tilt(b, c, d)) / long[may_be]
        return np.asarray(np.where(tilt > 1.0, turned < (1 - TILT_GAIN) * tilt, may_be & (turned <= 1.0)))

    def _rename(self, old: list[Ints], new: list[Ints]) -> None:
        """Half-edges have new numbers: hand their twins over, which may have new numbers themselves."""
        was, now = np.concatenate(old), np.concatenate(new)
        number = np.arange(len(self.twin))
        number[was] = now
        twin = self.twin[was]
        self.twin[now[twin < 0]] = -1
        self._pair(now[twin >= 0], number[twin[twin >= 0]])

    def _pair(self, one: Ints, two: Ints) -> None:
        self.twin[one], self.twin[two] = two, one


def _twins(triangles: Ints, n_nodes: int) -> Ints:
    tail, head = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
    key = np.minimum(tail, head) * n_nodes + np.maximum(tail, head)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    twin = np.full(len(key), -1, dtype=np.int64)
    twin[order[same]], twin[order[same + 1]] = order[same + 1], order[same]
    return twin


def _next(half: Ints) -> Ints:
    return np.asarray(half + np.where(half % 3 == 2, -2, 1))


def _previous(half: Ints) -> Ints:
    return np.asarray(half + np.where(half % 3 == 0, 2, -1))


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _square(m: Floats, a: Floats) -> Floats:
    """Square of a length in the metric."""
    return np.asarray(m[0] * a[0] ** 2 + 2 * m[1] * a[0] * a[1] + m[2] * a[1] ** 2)


def _angle(m: Floats, root: Floats, a: Floats, b: Floats) -> Floats:
    """Angle from a to b in the metric, rad, positive counter-clockwise."""
    dot = m[0] * a[0] * b[0] + m[1] * (a[0] * b[1] + a[1] * b[0]) + m[2] * a[1] * b[1]
    return np.asarray(np.arctan2(root * _cross(a, b), dot))
