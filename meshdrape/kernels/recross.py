"""Fibres that cross from one side of a crease to the other and come back."""

import numpy as np

from meshdrape.kernels.cache import kernel

PLACED = 0
# Candidates told of each fibre and half.
MOST = 4


@kernel(nogil=True)
def returning_wefts(face, status, region, returns, j0, sense, found):
    """Where weft fibres, followed from column j0 in one sense, come back to a region over the crease they left it by.

    Parameters
    ----------
    face, status : (n_warp, n_weft)
        Of `Lattice`.
    region : (m,)
        Region of each face; -1 on the extension.
    returns : (r, r) bool
        Whether two regions meet in a crease that a fibre must not cross twice.
    sense : int
        +1 or -1.
    found : (n, 3) int64
        Gets i, the j of the first node beyond the crease, the j of the first one back.

    Returns
    -------
    int
        How many there are; those beyond the length of `found` are not told.
    """
    n_warp, n_weft = status.shape
    n = 0
    for i in range(n_warp):
        here = -1
        before = -1
        entered = j0
        j = j0
        while 0 <= j < n_weft:
            if status[i, j] == PLACED:
                r = region[face[i, j]]
                if r != here and r >= 0:
                    if r == before and returns[r, here]:
                        if n < len(found):
                            found[n, 0] = i
                            found[n, 1] = entered
                            found[n, 2] = j
                        n += 1
                    before = here
                    here = r
                    entered = j
            j += sense
    return n


@kernel(nogil=True, makes_arrays=True)
def returning_warps(face, status, region, returns, i0, sense, found):
    """The same of the warp fibres, from row i0: j, the i of the first node beyond, the i of the first one back."""
    n_warp, n_weft = status.shape
    here = np.full(n_weft, -1)
    before = np.full(n_weft, -1)
    entered = np.full(n_weft, i0)
    n = 0
    i = i0
    while 0 <= i < n_warp:
        for j in range(n_weft):
            if status[i, j] == PLACED:
                r = region[face[i, j]]
                if r != here[j] and r >= 0:
                    if r == before[j] and returns[r, here[j]]:
                        if n < len(found):
                            found[n, 0] = j
                            found[n, 1] = entered[j]
                            found[n, 2] = i
                        n += 1
                    before[j] = here[j]
                    here[j] = r
                    entered[j] = i
        i += sense
    return n
