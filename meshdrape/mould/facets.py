"""Triangles of CAD faces in their own parameters: diagonals turned and edges split until they follow the face.

Works on plain arrays; how a CAD face looks comes in through a function that evaluates it. The measure
throughout is the face's own metric

    M = I / length^2 + III / angle^2,

the first fundamental form and the third, that of the normals: two nodes are a unit apart where the normal
turns by ``angle`` between them. A triangulation that is Delaunay in this metric runs its long edges along the
rulings of a developable face, where the normal does not turn, and spreads the nodes of a doubly curved face
evenly over its Gauss image. That is what a net asks of a mesh: a vertex carries the curvature of its
neighbourhood as angle defect and shears every cell beyond it by as much, so none should carry more than
another, however long and thin the face.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from meshdrape.mould.patch import Nodes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FLIP_GAIN = 1e-6  # rad of opposite angle a flip must gain, so that round-off cannot turn it to and fro
THINNEST = (
    1e-6  # smallest share a triangle may have of its quadrilateral in (u, v): less is a collinear corner
)
MAX_ROUNDS = 100_000


Evaluate = Callable[[Ints, Floats], Nodes]


class Facets:
    """A triangulation that can turn its diagonals and split its edges.

    Half-edge ``3 t + k`` runs from corner k to corner k + 1 of triangle t, counter-clockwise in (u, v);
    ``twin`` is the half-edge on its other side, -1 on the outline of a face.
    """

    def __init__(self, nodes: Nodes, triangles: Ints) -> None:
        self.nodes = nodes
        self.triangles = np.array(triangles, dtype=np.int64)
        self.twin = _twins(self.triangles, len(nodes.uv))

    def flip_to_delaunay(self, touched: Ints | None = None) -> None:
        """Turn diagonals until every inner edge is Delaunay in the metric, as far as (u, v) allows.

        A round turns diagonals no two of which share a triangle, the most profitable first.
        """
        if touched is None:
            touched = np.arange(len(self.triangles))
        rng = np.random.default_rng(0)
        for _ in range(MAX_ROUNDS):
            edge = self._inner_edges(touched)
            a, b, c, d = self._quad(edge)
            gain = self._gain(a, b, c, d)
            wanted = (gain > FLIP_GAIN) & self._convex(a, b, c, d)
            edge, gain = edge[wanted], gain[wanted]
            edge = edge[self._independent(edge, rng.random(len(edge)))]
            if not len(edge):
                return
            touched = self._flip(edge)

    def split_long_edges(
        self, limit: Callable[[Facets, Ints], Floats], evaluate: Evaluate, most: int
    ) -> None:
        rng = np.random.default_rng(0)
        for _ in range(MAX_ROUNDS):
            edge = self._inner_edges(np.arange(len(self.triangles)))
            size = limit(self, edge)
            wanted = size > 1
            edge, size = edge[wanted], size[wanted]
            # classes of a quarter, in random order within one: else a smooth size field lets only its peaks split
            rank = np.floor(np.log(size) / np.log(1.25)) + rng.random(len(size))
            edge = edge[self._independent(edge, rank)]
            if not len(edge):
                return
            a, b, _, _ = self._quad(edge)
            self.flip_to_delaunay(
                self._split(edge, evaluate(self.nodes.face[a], (self.nodes.uv[a] + self.nodes.uv[b]) / 2))
            )

    def _inner_edges(self, triangles: Ints) -> Ints:
        """One half-edge, the lower, of every inner edge of the triangles."""
        half = (3 * triangles[:, None] + np.arange(3)).ravel()
        twin = self.twin[half]
        return np.unique(np.minimum(half, twin)[twin >= 0])

    def _quad(self, edge: Ints) -> tuple[Ints, Ints, Ints, Ints]:
        """Ends a, b of the edges, the corner c on their left and d on their right."""
        corner = self.triangles.ravel()
        twin = self.twin[edge]
        return corner[edge], corner[_next(edge)], corner[_next(_next(edge))], corner[_next(_next(twin))]

    def _gain(self, a: Ints, b: Ints, c: Ints, d: Ints) -> Floats:
        """Sum of the angles over the edge a-b less the sum over c-d, in the mean metric of the four, rad."""
        uv, metric = self.nodes.uv, self.nodes.metric
        m = metric[a] + metric[b] + metric[c] + metric[d]
        ca, cb, da, db = uv[a] - uv[c], uv[b] - uv[c], uv[a] - uv[d], uv[b] - uv[d]
        root = np.sqrt(np.maximum(m[:, 0] * m[:, 2] - m[:, 1] ** 2, 0.0))
        return (
            _angle(m, root, ca, cb)
            + _angle(m, root, db, da)
            - _angle(m, root, -da, -ca)
            - _angle(m, root, -cb, -db)
        )

    def _convex(self, a: Ints, b: Ints, c: Ints, d: Ints) -> NDArray[np.bool_]:
        uv = self.nodes.uv
        one, two = _cross(uv[d] - uv[a], uv[c] - uv[a]), _cross(uv[c] - uv[b], uv[d] - uv[b])
        return np.minimum(one, two) > THINNEST * (one + two)

    def _independent(self, edge: Ints, value: Floats) -> NDArray[np.bool_]:
        """Edges that hold the highest value of both their triangles: no two of them share a triangle."""
        rank = np.empty(len(edge), dtype=np.int64)
        rank[np.argsort(value, kind="stable")] = np.arange(len(edge))
        left, right = edge // 3, self.twin[edge] // 3
        best = np.full(len(self.triangles), -1, dtype=np.int64)
        np.maximum.at(best, left, rank)
        np.maximum.at(best, right, rank)
        return (best[left] == rank) & (best[right] == rank)

    def _flip(self, edge: Ints) -> Ints:
        """Turn the diagonals a-b into c-d; returns the triangles touched."""
        a, b, c, d = self._quad(edge)
        twin = self.twin[edge]
        left, right = edge // 3, twin // 3
        outer = np.concatenate(
            [_next(edge), _next(_next(edge)), _next(twin), _next(_next(twin))]
        )  # bc, ca, ad, db
        moved = np.concatenate([3 * right + 1, 3 * left + 2, 3 * left, 3 * right])
        # left becomes a, d, c and right becomes b, c, d
        moved = np.concatenate([3 * right, 3 * left + 2, 3 * left, 3 * right + 2])
        self.triangles[left] = np.column_stack([a, d, c])
        self.triangles[right] = np.column_stack([b, c, d])
        self._rejoin(outer, moved)
        self.twin[3 * left + 1], self.twin[3 * right + 1] = 3 * right + 1, 3 * left + 1
        return np.concatenate([left, right])

    def _split(self, edge: Ints, middle: Nodes) -> Ints:
        """Put a node on the edges a-b; returns the triangles touched."""
        a, b, c, d = self._quad(edge)
        twin = self.twin[edge]
        left, right = edge // 3, twin // 3
        m = len(self.nodes.uv) + np.arange(len(edge))
        first = len(self.triangles)
        left_b, right_b = first + np.arange(len(edge)), first + len(edge) + np.arange(len(edge))
        outer = np.concatenate(
            [_next(edge), _next(_next(edge)), _next(twin), _next(_next(twin))]
        )  # bc, ca, ad, db
        # left = a m c, left_b = m b c, right = m a d, right_b = b m d
        moved = np.concatenate([3 * left_b + 1, 3 * left + 2, 3 * right + 1, 3 * right_b + 2])
        self.nodes = Nodes.joined([self.nodes, middle])
        self.triangles[left] = np.column_stack([a, m, c])
        self.triangles[right] = np.column_stack([m, a, d])
        self.triangles = np.vstack([self.triangles, np.column_stack([m, b, c]), np.column_stack([b, m, d])])
        self.twin = np.concatenate([self.twin, np.full(6 * len(edge), -1, dtype=np.int64)])
        self._rejoin(outer, moved)
        for one, two in (
            (3 * left, 3 * right),
            (3 * left_b, 3 * right_b),
            (3 * left + 1, 3 * left_b + 2),
            (3 * right + 2, 3 * right_b + 1),
        ):
            self.twin[one], self.twin[two] = two, one
        return np.concatenate([left, right, left_b, right_b])

    def _rejoin(self, old: Ints, new: Ints) -> None:
        """Half-edges ``old`` are now called ``new``: carry their twins over, which may be moving themselves."""
        name = np.arange(len(self.twin))
        name[old] = new
        partner = self.twin[old]
        inner = partner >= 0
        self.twin[new[~inner]] = -1
        new, partner = new[inner], name[partner[inner]]
        self.twin[new] = partner
        self.twin[partner] = new


def _twins(triangles: Ints, n_nodes: int) -> Ints:
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * n_nodes + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    twin = np.full(len(key), -1, dtype=np.int64)
    twin[order[same]], twin[order[same + 1]] = order[same + 1], order[same]
    return twin


def _next(half: Ints) -> Ints:
    return half - half % 3 + (half + 1) % 3


def _cross(a: Floats, b: Floats) -> Floats:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _angle(m: Floats, root: Floats, a: Floats, b: Floats) -> Floats:
    """Angle from a to b in the metric, rad, within (-pi, pi]."""
    dot = (
        m[:, 0] * a[:, 0] * b[:, 0]
        + m[:, 1] * (a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0])
        + m[:, 2] * a[:, 1] * b[:, 1]
    )
    return np.arctan2(root * _cross(a, b), dot)
