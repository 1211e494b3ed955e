"""Triangles of CAD faces: outlines cut into triangles, then diagonals turned and edges split.

Works on plain arrays; what a CAD face looks like comes in through :class:`Patches` and a function that
evaluates it. The measure throughout is the distance in the joint space of positions and normals,

    q = (position / length, normal / angle),

one scale pair for each face: two nodes are one unit apart where the normal turns by ``angle``. A Delaunay
triangulation in that space runs its long edges along the rulings of a developable face, where the normal does
not turn, and spreads the nodes of a doubly curved face evenly over its Gauss image. That is what a net asks of
a mesh: a vertex carries the curvature of its neighbourhood as angle defect and shears every cell beyond it by
as much, so no vertex should carry more than another.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Evaluate = Callable[[Ints, Floats], tuple[Floats, Floats]]

FLIP_GAIN = 1e-6  # radians of opposite angle a flip must gain, so that round-off cannot flip to and fro
THINNEST = 1e-6  # smallest share a new triangle may have of its quadrilateral, in (u, v)
MAX_FLIP_ROUNDS = 200


@dataclass
class Patches:
    """Triangulated CAD faces in their own parameters, one mesh component for each face.

    A node belongs to one patch: a CAD edge between two patches, or a seam within one, has its nodes once for
    each side, and ``node_id`` says which are the same point.

    Attributes
    ----------
    uv : (k, 2) float
        Parameters, scaled so that both are roughly lengths.
    position, normal : (k, 3) float
        Point in mm and unit normal.
    node_patch : (k,) int
    triangles : (t, 3) int
        Counter-clockwise in (u, v).
    length, angle : (n_patches,) float
        Scales of the joint space of positions and normals, mm and rad.
    """

    uv: Floats
    position: Floats
    normal: Floats
    node_patch: Ints
    triangles: Ints
    length: Floats
    angle: Floats

    @property
    def joint(self) -> Floats:
        """Coordinates in the joint space of positions and normals, shape (k, 6)."""
        return np.hstack(
            [self.position / self.length[self.node_patch, None], self.normal / self.angle[self.node_patch, None]]
        )


def inner_edges(triangles: Ints, n_nodes: int) -> tuple[Ints, Ints]:
    """Both half-edges of every edge with a triangle on each side, shapes (e,), (e,).

    Half-edge ``3 * t + k`` runs from corner k to corner k + 1 of triangle t.
    """
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    key = np.minimum(start, end) * n_nodes + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    twin = np.flatnonzero(key[order][1:] == key[order][:-1])
    return order[twin], order[twin + 1]


def flip_to_delaunay(patches: Patches) -> None:
    """Turn diagonals until every inner edge is Delaunay in the joint space, as far as (u, v) allows.

    A round turns a set of diagonals that share no triangle, the most profitable first.
    """
    joint, uv = patches.joint, patches.uv
    triangles = patches.triangles
    for _ in range(MAX_FLIP_ROUNDS):
        one, two = inner_edges(triangles, len(uv))
        a, b, c, d = _quad(triangles, one, two)
        gain = _opposite(joint, a, b, c) + _opposite(joint, a, b, d) - _opposite(joint, c, d, a) - _opposite(joint, c, d, b)
        wanted = np.flatnonzero(gain > FLIP_GAIN)
        a, b, c, d = a[wanted], b[wanted], c[wanted], d[wanted]
        upper, lower = _area(uv, a, d, c), _area(uv, d, b, c)
        convex = np.minimum(upper, lower) > THINNEST * (upper + lower)
        wanted = wanted[convex]
        chosen = wanted[_independent(gain[wanted], one[wanted] // 3, two[wanted] // 3, len(triangles))]
        if not len(chosen):
            return
        a, b, c, d = _quad(triangles, one[chosen], two[chosen])
        triangles[one[chosen] // 3] = np.column_stack([a, d, c])
        triangles[two[chosen] // 3] = np.column_stack([d, b, c])


def split_long_edges(patches: Patches, evaluate: Evaluate, chord: float, curved: NDArray[np.bool_], limit: int) -> None:
    for _ in range(100):
        joint = patches.joint
        one, two = inner_edges(patches.triangles, len(patches.uv))
        a, b, c, d = _quad(patches.triangles, one, two)
        mine = curved[patches.node_patch[a]]
        size = np.linalg.norm(joint[a] - joint[b], axis=1)
        turn = np.linalg.norm(patches.normal[a] - patches.normal[b], axis=1)
        span = np.linalg.norm(patches.position[a] - patches.position[b], axis=1)
        size = np.maximum(size, np.sqrt(span * turn / 8 / chord)) * mine
        wanted = np.flatnonzero(size > 1)
        chosen = wanted[_independent(size[wanted], one[wanted] // 3, two[wanted] // 3, len(patches.triangles))]
        if not len(chosen):
            return
        a, b, c, d = a[chosen], b[chosen], c[chosen], d[chosen]
        middle = (patches.uv[a] + patches.uv[b]) / 2
        patch = patches.node_patch[a]
        position, normal = evaluate(patch, middle)
        m = len(patches.uv) + np.arange(len(chosen))
        patches.uv = np.vstack([patches.uv, middle])
        patches.position = np.vstack([patches.position, position])
        patches.normal = np.vstack([patches.normal, normal])
        patches.node_patch = np.concatenate([patches.node_patch, patch])
        t = patches.triangles
        t[one[chosen] // 3] = np.column_stack([a, m, c])
        t[two[chosen] // 3] = np.column_stack([b, m, d])
        patches.triangles = np.vstack([t, np.column_stack([m, b, c]), np.column_stack([m, a, d])])
        flip_to_delaunay(patches)


def _quad(triangles: Ints, one: Ints, two: Ints) -> tuple[Ints, Ints, Ints, Ints]:
    """Edge a-b as half-edge ``one`` runs, the corner c left of it and the corner d right of it."""
    flat = triangles.ravel()
    after_one = one - one % 3 + (one + 1) % 3
    return (flat[one], flat[after_one], flat[one - one % 3 + (one + 2) % 3], flat[two - two % 3 + (two + 2) % 3])


def _opposite(joint: Floats, a: Ints, b: Ints, c: Ints) -> Floats:
    """Angle at c over the edge a-b, rad; a right angle where c falls on an end of it."""
    to_a, to_b = joint[a] - joint[c], joint[b] - joint[c]
    dot = np.einsum("ij,ij->i", to_a, to_b)
    square = np.einsum("ij,ij->i", to_a, to_a) * np.einsum("ij,ij->i", to_b, to_b)
    return np.arctan2(np.sqrt(np.maximum(square - dot * dot, 0.0)), dot)


def _area(uv: Floats, a: Ints, b: Ints, c: Ints) -> Floats:
    ab, ac = uv[b] - uv[a], uv[c] - uv[a]
    return (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) / 2


def _independent(value: Floats, left: Ints, right: Ints, n_triangles: int) -> NDArray[np.bool_]:
    """Edges that hold the highest value of both their triangles: no two of them share a triangle."""
    rank = np.empty(len(value), dtype=np.int64)
    rank[np.argsort(value, kind="stable")] = np.arange(len(value))
    best = np.full(n_triangles, -1, dtype=np.int64)
    np.maximum.at(best, left, rank)
    np.maximum.at(best, right, rank)
    return (best[left] == rank) & (best[right] == rank)
