"""Numba without BLAS, which no kernel uses and which takes longer to load than all of them.

Numba looks for it in scipy with the first kernel. A program that imports the package may want it there; a command does
not, and says so before it imports a kernel.
"""

import sys

PLACE = "scipy.linalg.cython_blas"

unwanted = False


def leave_out_if_unwanted():
    """Have numba not look for BLAS, unless it is loaded anyhow."""
    if not unwanted or PLACE in sys.modules:
        return
    sys.modules[PLACE] = None
    try:
        import numba.np.arraymath  # noqa: F401 - here it looks
    finally:
        del sys.modules[PLACE]
