"""Which of many things hang together."""

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
    """Fill `label` (n,): sets are linked by index and paths halved (Tarjan, van Leeuwen, J. ACM 31, 1984)."""
    for k in range(len(label)):
        label[k] = k
    for k in range(len(a)):
        p = a[k]
        while label[p] != p:
            label[p] = label[label[p]]
            p = label[p]
        q = b[k]
        while label[q] != q:
            label[q] = label[label[q]]
            q = label[q]
        # the smaller number stands for both, so that a part is known by its first thing
        if p < q:
            label[q] = p
        else:
            label[p] = q
    count = 0
    for k in range(len(label)):
        if label[k] == k:
            label[k] = count
            count += 1
        else:
            # what stands for it has a smaller number and has its part by now
            label[k] = label[label[k]]
