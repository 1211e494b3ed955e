"""Which of many things hang together."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.kernels.cache import kernel


def connected_parts(a: ArrayLike, b: ArrayLike, n: int) -> NDArray[np.int64]:
    """Number of the connected part each of n things is in, (n,), parts in the order of their first thing.

    Parameters
    ----------
    a, b : (k,) int
        The things that are joined, in pairs.
    n : int
    """
    label = np.empty(n, dtype=np.int64)
    _join(np.ascontiguousarray(a, dtype=np.int64), np.ascontiguousarray(b, dtype=np.int64), label)
    return label


@kernel
def _join(a, b, label):
    """Fill `label` (n,)."""
    for k in range(len(label)):
        label[k] = k
    for k in range(len(a)):
        _link(label, a[k], b[k])
    _number(label)


@kernel
def join_uncrossed(faces, nearest, on_fibre, label):
    """Number the parts in which the vertices of a mesh hang together by edges that no net edge crosses.

    Parameters
    ----------
    nearest : (3 m,) float
        Of each half-edge 3 f + k, infinite where nothing crosses it: see `crossings.cross`.
    on_fibre : (n,) bool
        Vertices that are joined to none.
    label : (n,) int64
        Gets the part of each, parts in the order of their first vertex.
    """
    for v in range(len(label)):
        label[v] = v
    for f in range(len(faces)):
        for k in range(3):
            a = faces[f, k]
            b = faces[f, (k + 1) % 3]
            if math.isinf(nearest[3 * f + k]) and not on_fibre[a] and not on_fibre[b]:
                _link(label, a, b)
    _number(label)


@kernel(inline="always")
def _link(label, a, b):
    """Join the sets of two things: they are linked by index, and paths to what stands for a set are halved.

    Tarjan, van Leeuwen, Worst-case analysis of set union algorithms, J. ACM 31, 1984.
    """
    while label[a] != a:
        label[a] = label[label[a]]
        a = label[a]
    while label[b] != b:
        label[b] = label[label[b]]
        b = label[b]
    # the smaller number stands for both, so that a part is known by its first thing
    if a < b:
        label[b] = a
    else:
        label[a] = b


@kernel(inline="always")
def _number(label):
    """From what stands for each set to the number of the set."""
    count = 0
    for k in range(len(label)):
        if label[k] == k:
            label[k] = count
            count += 1
        else:
            # what stands for it has a smaller number and has its part by now
            label[k] = label[label[k]]
