"""Where a sheet laid on the wing from y = 0 is ill-posed on the spar, or nearly so: the end of section 3.4.

A row comes over the crease where g_s rises past it and comes back where g_s falls below it again. A row that has been
on the spar meets the wing with the turn of its own crossing, where the sheet is already laid with none: the wing would
have to shear. Section 6.3 needs g_s' > 0 throughout, which the report does not say.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.theory.fold import Fold
from meshdrape.theory.quadrature import FloatArray


class Return(NamedTuple):
    """A stretch of the crease over which rows come back from the spar to the wing.

    Attributes
    ----------
    start, end : float
        y, from the top of the crease's rise to where it rises again.
    drop : float
        g_s lost in between: drop / spacing rows come back.
    turn : float
        Largest |ψ(y) - ψ(y0)| between the crossings of one of those rows, back at y and over at y0, or γ for those from
        the left-most ribbon, rad: what the wing's cells would have to shear by.
    """

    start: float
    end: float
    drop: float
    turn: float


def returning_rows(fold: Fold, gamma: float = 0.0, stations: int = 4097) -> list[Return]:
    """Stretches of the crease, from y = 0 on, over which rows come back to the wing; none if g_s never falls."""
    y = np.linspace(0.0, fold.span, stations)
    x, psi = fold.spar(y), fold.psi(y)
    falls = np.concatenate([[False], np.diff(x) < -1e-14 * fold.span, [False]])
    starts, ends = np.flatnonzero(~falls[:-1] & falls[1:]), np.flatnonzero(falls[:-1] & ~falls[1:])
    if not len(starts):
        return []
    before = _last_lower(x)  # there the row came over
    turn = np.abs(psi - np.where(before < 0, gamma, psi[before]))
    return [
        Return(float(y[i]), float(y[j]), float(x[i] - x[j]), float(turn[i + 1 : j + 1].max()))
        for i, j in zip(starts.tolist(), ends.tolist(), strict=True)
    ]


def _last_lower(x: FloatArray) -> NDArray[np.int64]:
    """For each number the last one before it that is lower, (n,); -1 where there is none."""
    found = np.full(len(x), -1)
    rising: list[tuple[float, int]] = []  # those that can still be the last lower one
    for k, value in enumerate(x.tolist()):
        while rising and rising[-1][0] >= value:
            rising.pop()
        if rising:
            found[k] = rising[-1][1]
        rising.append((value, k))
    return found


def grazing_rows(fold: Fold, angle: float, stations: int = 4097) -> FloatArray:
    """Stretches (k, 2) of the crease over which it runs within an angle, rad, of the rows of the wing: |α| < angle.

    There one row's crossing tells little of the next one's: the net depends on the spacing to its square root.
    """
    y = np.linspace(0.0, fold.span, stations)
    near = np.concatenate([[False], np.abs(fold.alpha(y)) < angle, [False]])
    start, end = np.flatnonzero(~near[:-1] & near[1:]), np.flatnonzero(near[:-1] & ~near[1:]) - 1
    return np.stack([y[start], y[end]], axis=-1)
