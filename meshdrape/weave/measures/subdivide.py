"""Triangles split until none is coarser than a given length, neighbours alike."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def subdivided(
    vertices: FloatArray, triangles: IntArray, longest: float, most: int
) -> tuple[FloatArray, IntArray, IntArray]:
    """The same surface in triangles whose edges are no longer than `longest`, conforming.

    Every edge that is too long is halved, in both triangles that share it, round after round, so long thin triangles
    are cut across, not into slivers.

    Parameters
    ----------
    vertices : (n, 3) mm
    triangles : (m, 3)
    longest : float
        mm.
    most : int
        No round is begun that could end with more triangles than this.

    Returns
    -------
    vertices, triangles
    parent : (k,) int64
        The given triangle each one came from.
    """
    parent = np.arange(len(triangles))
    # triangles without a long edge, of each round: they stay as they are
    done: list[tuple[IntArray, IntArray]] = []
    n_done = 0
    while True:
        tail, head = triangles, np.roll(triangles, -1, axis=1)
        length = np.linalg.norm(vertices[head] - vertices[tail], axis=2)
        marked = length > longest
        count = int(marked.sum())
        if count == 0 or n_done + len(triangles) + count > most:
            found, parents = zip(*done, (triangles, parent), strict=True)
            return vertices, np.concatenate(found), np.concatenate(parents)
        cut = marked.any(axis=1)
        done.append((triangles[~cut], parent[~cut]))
        n_done += len(triangles) - int(cut.sum())
        triangles, parent, length, marked = triangles[cut], parent[cut], length[cut], marked[cut]
        tail, head = tail[cut], head[cut]
        key = np.minimum(tail, head)[marked] * len(vertices) + np.maximum(tail, head)[marked]
        split, number = np.unique(key, return_inverse=True)
        middle = np.zeros_like(triangles)
        middle[marked] = len(vertices) + number
        u, v = split // len(vertices), split % len(vertices)
        vertices = np.concatenate([vertices, 0.5 * (vertices[u] + vertices[v])])
        triangles, parent = _split(triangles, parent, marked, np.argmax(length, axis=1), middle)


def _split(
    triangles: IntArray, parent: IntArray, marked: NDArray[np.bool_], wanted: IntArray, middle: IntArray
) -> tuple[IntArray, IntArray]:
    """The pieces of triangles that have at least one edge marked, which is halved at its vertex in `middle`."""
    rows = np.arange(len(triangles))
    pieces, parents = [], []
    # turned so that the longest edge runs from a to b; m halves it, n halves b-c and o halves c-a where marked
    order = (wanted[:, None] + np.arange(3)) % 3
    a, b, c = (triangles[rows, order[:, k]] for k in range(3))
    m, n, o = (middle[rows, order[:, k]] for k in range(3))
    has_n, has_o = marked[rows, order[:, 1]], marked[rows, order[:, 2]]
    for choose, triple in (
        (~has_n, (m, b, c)),
        (has_n, (m, b, n)),
        (has_n, (m, n, c)),
        (~has_o, (m, c, a)),
        (has_o, (m, c, o)),
        (has_o, (m, o, a)),
    ):
        pieces.append(np.stack(triple, axis=1)[choose])
        parents.append(parent[choose])
    return np.concatenate(pieces), np.concatenate(parents)
