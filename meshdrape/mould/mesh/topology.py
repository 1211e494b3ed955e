"""How the triangles of a mesh hang together, however badly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class Joints(NamedTuple):
    """Pairs of half-edges 3 f + k that lie on one edge: one pair for an edge of two triangles, n - 1 for n.

    Attributes
    ----------
    one, other : (j,) int64
        Side by side in a list where the half-edges of an edge follow one another.
    alike : (j,) bool
        Whether both run the same way, so that one of the triangles faces the wrong way.
    """

    one: Ints
    other: Ints
    alike: Bools

    def crowded(self) -> Ints:
        """Return the third half-edge of each edge of more than two triangles, and any further ones."""
        return np.asarray(self.other[1:][self.one[1:] == self.other[:-1]])


def edge_keys(triangles: Ints, n_vertices: int) -> Ints:
    """Return a number for each half-edge 3 f + k, (3 m,), that is the same for all half-edges of an edge."""
    tail = triangles.ravel()
    head = triangles[:, [1, 2, 0]].ravel()
    return np.asarray(np.minimum(tail, head) * n_vertices + np.maximum(tail, head))


def edge_joints(triangles: Ints, n_vertices: int) -> Joints:
    """Return the joints of a mesh whose triangles have three different vertices each."""
    key = edge_keys(triangles, n_vertices)
    half = np.argsort(key, kind="stable")
    ordered = key[half]
    joined = ordered[1:] == ordered[:-1]
    one, other = half[:-1][joined], half[1:][joined]
    tail = triangles.ravel()
    return Joints(one, other, tail[one] == tail[other])


def repeats_vertex(triangles: Ints) -> Bools:
    """Whether each triangle has the same vertex twice, (m,)."""
    a, b, c = triangles.T
    return np.asarray((a == b) | (b == c) | (c == a))


def repeats_triangle(triangles: Ints) -> Bools:
    """Whether each triangle has the same vertices as an earlier one, in whatever order, (m,)."""
    rows = np.sort(triangles, axis=1)
    order = np.lexsort(rows.T)
    same = (rows[order[1:]] == rows[order[:-1]]).all(axis=1)
    later = np.zeros(len(rows), dtype=bool)
    later[order[1:][same]] = True
    return later


def relative_height(vertices: Floats, triangles: Ints) -> Floats:
    """Return the height of each triangle over its longest edge, as a share of that edge, (m,)."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    u, v, w = b - a, c - a, c - b
    doubled = np.cross(u, v)
    longest2 = np.maximum(np.maximum(_dot(u, u), _dot(v, v)), _dot(w, w))
    return np.asarray(np.sqrt(_dot(doubled, doubled)) / np.where(longest2 > 0, longest2, 1.0))


def fans(triangles: Ints, joints: Joints) -> Ints:
    """Return a number for each corner 3 f + k, the same where corners of a vertex hang together by edges."""
    one, other, alike = joints
    following = np.arange(triangles.size).reshape(-1, 3)[:, [1, 2, 0]].ravel()
    # across an edge the corners at either of its ends belong to one fan
    start, end = np.where(alike, other, following[other]), np.where(alike, following[other], other)
    return _parts(np.concatenate([one, following[one]]), np.concatenate([start, end]), triangles.size)


def misfacing(triangles: Ints, joints: Joints) -> tuple[Bools, Bools, Ints]:
    """Find the fewest triangles to turn over so that those of a component face one way.

    Every triangle is taken twice, as it is (f) and turned over (m + f), and joined to its neighbours' copies
    of the same side. A two-sided component then falls into two halves; a one-sided one, like a Möbius strip,
    stays whole.

    Returns
    -------
    reversed : (m,) bool
        The lesser half of each component; of two alike the one without the first triangle.
    one_sided : (m,) bool
        Whether the triangle's component has only one side, so that no turning helps.
    half : (m,) int64
        The part each triangle is in, as it is; of a one-sided component, the component.
    """
    m = len(triangles)
    face, neighbour = joints.one // 3, joints.other // 3
    across = np.where(joints.alike, m + neighbour, neighbour)
    back = np.where(joints.alike, neighbour, m + neighbour)
    part = _parts(np.concatenate([face, m + face]), np.concatenate([across, back]), 2 * m)
    half, turned = part[:m], part[m:]
    one_sided = half == turned
    size = np.bincount(half, minlength=2 * m)
    # numbers of parts go up with their first member
    lesser = (size[half] < size[turned]) | ((size[half] == size[turned]) & (half > turned))
    return lesser, one_sided, half


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _parts(a: Ints, b: Ints, n: int) -> Ints:
    """As :func:`meshdrape.kernels.components.connected_parts`, which is imported when it is needed."""
    from meshdrape.kernels.components import connected_parts

    return connected_parts(a, b, n)
