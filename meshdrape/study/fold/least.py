"""Least distance programming: the point nearest to 0 that meets linear inequalities."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import DesignError

FloatArray = NDArray[np.float64]


def least_distance(root: FloatArray, row: FloatArray, least: FloatArray) -> FloatArray:
    """The x of least |root x| with row x >= least.

    Parameters
    ----------
    root : (n, n) float
        Upper triangular, regular.
    row : (m, n) float
    least : (m,) float

    Raises
    ------
    DesignError
        No x meets the inequalities.

    References
    ----------
    C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974, chapter 23, problem LDP: it is the residual of
    one non-negative least-squares problem.
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls

    msg = "no spar meets the locking angle within reach; raise locking_angle_deg or lower spar_height"
    # rows of unit length in z = root x; one of none asks for what no x changes
    turned = solve_triangular(root, row.T, trans="T", check_finite=False).T
    length = np.linalg.norm(turned, axis=1)
    said = length > 0
    if not np.isfinite(length).all() or (least[~said] > 0).any():
        raise DesignError(msg)
    turned, least = turned[said] / length[said, None], least[said] / length[said]
    if not len(least):
        return np.zeros(row.shape[1])
    scale = float(least.max())
    if scale <= 0:
        return np.zeros(row.shape[1])
    system = np.concatenate([turned.T, least[None] / scale])
    goal = np.zeros(len(system))
    goal[-1] = 1.0
    weight, rest = nnls(system, goal, maxiter=50 * system.shape[1])
    if rest < 1e-10:
        raise DesignError(msg)
    residual = system @ weight - goal
    z = -scale * residual[:-1] / residual[-1]
    return np.asarray(solve_triangular(root, z))
