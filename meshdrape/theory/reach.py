"""The sharper criterion: the largest shear over the rows and columns that meet on the spar, in the smooth limit.

Equations (29) to (31) compare all of ψ with all of ψ. But a row that crosses the crease at y0 and a column that
crosses at y1 meet, if at all, at ``spar_edge(y0) + drift(y1) - drift(y0)``; on a spar of finite height only pairs
y0 < y1 count whose meeting place lies no deeper than the spar is high.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meshdrape.errors import DesignError
from meshdrape.theory.criteria import turning_points
from meshdrape.theory.fold import ComplexArray, Fold
from meshdrape.theory.quadrature import FloatArray, largest

_LOOKS = 33  # samples between a row's crossing and its end: a meeting place deeper than the spar cannot hide between


class Pair(NamedTuple):
    """The largest shear of a region, rad, and where row and column that set it cross the crease.

    `y0` of a ribbon-fed row is 0, the left-most ribbon.
    """

    shear: float
    y0: float
    y1: float


class RibbonReach(NamedTuple):
    """Largest shear within the spar's height where rows start on the left-most ribbon.

    Attributes
    ----------
    ribbon_fed : Pair
        max |ψ(y1) - γ|.
    gamma_best : float
        The γ that makes it least: middle of the ψ of the columns that reach such rows.
    ribbon_fed_best : float
        The shear it leaves, half the range of that ψ.
    """

    ribbon_fed: Pair
    gamma_best: float
    ribbon_fed_best: float


class Reach(NamedTuple):
    """Largest shear within the spar's height.

    Attributes
    ----------
    wing_fed : Pair
        max |ψ(y1) - ψ(y0)| where rows come from the wing; no choice of gamma changes it.
    ribbon_fed : Pair
        max |ψ(y1) - γ| where rows start on the left-most ribbon.
    gamma_best : float
        The γ that makes the latter least: middle of the ψ of the columns that reach such rows.
    ribbon_fed_best : float
        The ribbon-fed shear it leaves, half the range of that ψ.
    """

    wing_fed: Pair
    ribbon_fed: Pair
    gamma_best: float
    ribbon_fed_best: float


def within_reach(fold: Fold, height: float, gamma: float = 0.0) -> Reach:
    """Largest shear over the pairs of stations that meet within the spar's height, exact in the smooth limit.

    Parameters
    ----------
    fold : Fold
    height : float
        Of the spar, along z, in the unit of the fold.
    gamma : float
        Turn of the left-most spar ribbon, rad.
    """
    if not height > 0:
        msg = f"height={height}: must be positive"
        raise DesignError(msg)
    turns = turning_points(fold)
    return Reach(_wing_fed(fold, height, turns), *ribbon_reach(fold, height, gamma, turns))


def ribbon_reach(fold: Fold, height: float, gamma: float, turns: FloatArray | None = None) -> RibbonReach:
    """The part of `within_reach` that hangs on gamma, for those who try several.

    Parameters
    ----------
    fold, height, gamma
        As there.
    turns : (n,) float, optional
        `turning_points` of the fold, where they are known.
    """
    stations = _ribbon_columns(fold, height, gamma, turning_points(fold) if turns is None else turns)
    psi = fold.psi(stations)
    worst = int(np.argmax(np.abs(psi - gamma)))
    return RibbonReach(
        Pair(float(abs(psi[worst] - gamma)), 0.0, float(stations[worst])),
        float(psi.max() + psi.min()) / 2,
        float(psi.max() - psi.min()) / 2,
    )


def last_column(fold: Fold, height: float, y0: FloatArray) -> FloatArray:
    """The last y1 whose column meets the row of each y0 on the spar: y0 itself where the row leaves it at once."""
    y0 = np.asarray(y0, dtype=np.float64)
    drift = fold.tables.drift
    origin = fold.spar_edge(y0) - drift(y0)
    end = _first_return(fold, y0)
    t = np.linspace(0.0, 1.0, _LOOKS)[1:]
    y = y0[:, None] + (end - y0)[:, None] * t
    beyond = _excess(fold, height, origin[:, None] + drift(y)) > 0
    k = np.where(beyond.any(axis=1), beyond.argmax(axis=1), _LOOKS - 1)
    edges = np.concatenate([y0[:, None], y, end[:, None]], axis=1)
    rows = np.arange(len(y0))
    low, high = edges[rows, k], edges[rows, k + 1]
    at = low
    for _ in range(20):  # Newton's method, kept between its bounds: the excess is smooth but for a corner at the tip
        place, rate = origin + drift(at), fold.drift_rate(at)
        below = fold.tables.crease_height(place.real) - place.imag - height
        beside = place.real - fold.spar.length
        slope = np.where(below > beside, fold.tables.crease_slope(place.real) * rate.real - rate.imag, rate.real)
        with np.errstate(divide="ignore", invalid="ignore"):
            new = at - np.maximum(below, beside) / slope
        new = np.where(np.isfinite(new), np.minimum(np.maximum(new, low), high), at)
        step, at = np.abs(new - at), new
        if not at.size or step.max() < 1e-8 * fold.span:  # quadratic: the next one would be round-off
            break
    return np.where(beyond.any(axis=1), np.minimum(at, end), end)


def _excess(fold: Fold, height: float, place: ComplexArray) -> FloatArray:
    """How far a place of the flat spar lies outside it, below its lower border or past the tip; negative inside."""
    below = fold.tables.crease_height(place.real) - place.imag - height
    return np.maximum(below, place.real - fold.spar.length)


def _first_return(fold: Fold, y0: FloatArray) -> FloatArray:
    """Where the row of each y0 comes back to the crease (section 3.4: ill-posed there), or the tip."""
    fine = np.linspace(0.0, fold.span, 2049)
    x = fold.spar(fine)
    if (np.diff(x) > 0).all():
        return np.full(len(y0), fold.span)
    level = fold.spar(y0)
    back = (fine > y0[:, None]) & (x <= level[:, None])
    k = back.argmax(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (level - x[k - 1]) / (x[k] - x[k - 1])
    found = np.maximum(fine[k - 1] + np.clip(np.nan_to_num(t), 0, 1) * (fine[k] - fine[k - 1]), y0)
    found = np.where(fold.spar.slope(y0) <= 0, y0, found)
    return np.where(back.any(axis=1), found, fold.span)


def _wing_fed(fold: Fold, height: float, turns: FloatArray) -> Pair:
    psi_turns = fold.psi(turns)

    def candidates(y0: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Shear with the row's last column and with every column at which ψ turns, and those columns."""
        last = last_column(fold, height, y0)
        y1 = np.concatenate([last[:, None], np.broadcast_to(turns, (len(y0), len(turns)))], axis=1)
        psi = np.concatenate([fold.psi(last)[:, None], np.broadcast_to(psi_turns, (len(y0), len(turns)))], axis=1)
        meets = (y1 >= y0[:, None]) & (y1 <= last[:, None])
        return np.where(meets, np.abs(psi - fold.psi(y0)[:, None]), 0.0), y1

    samples = 201 + 10 * len(turns)
    shear, y0 = largest(lambda y: candidates(y)[0].max(axis=1), 0.0, fold.span, samples)
    if len(turns):  # the row of a turning point is a corner of that function
        best, _ = candidates(turns)
        k = int(np.argmax(best.max(axis=1)))
        if best[k].max() > shear:
            y0 = float(turns[k])
    value, y1 = candidates(np.array([y0]))
    column = int(np.argmax(value[0]))
    return Pair(float(value[0, column]), y0, float(y1[0, column]))


def _ribbon_columns(fold: Fold, height: float, gamma: float, turns: FloatArray) -> FloatArray:
    """Columns that can set the ribbon-fed maximum: the ends of those that reach ribbon-fed rows, and turning points."""
    y = np.linspace(0.0, fold.span, 2049)
    x = fold.spar(y)
    # a ribbon-fed row is still on the spar at y if the crease has not been lower before: start that far down
    start = np.maximum(x[0] - np.minimum.accumulate(x), 0.0)
    origin = fold.spar_edge(np.zeros(1))[0] - 1j * np.exp(1j * gamma) * start
    excess = _excess(fold, height, origin + fold.tables.drift(y))
    inside = excess <= 0
    change = np.flatnonzero(inside[1:] != inside[:-1])
    border = y[change] - excess[change] * (y[change + 1] - y[change]) / (excess[change + 1] - excess[change])
    for _ in range(3):  # secant steps on the smooth function; from a piece of 1/2048 of the span
        at = np.interp(border, y, start)
        place = fold.spar_edge(np.zeros(1))[0] - 1j * np.exp(1j * gamma) * at + fold.tables.drift(border)
        rate = (excess[change + 1] - excess[change]) / (y[change + 1] - y[change])
        border = border - _excess(fold, height, place) / rate
    border = np.minimum(np.maximum(border, y[change]), y[change + 1])
    inner = turns[inside[np.searchsorted(y, turns, side="right") - 1]] if len(turns) else turns
    ends = y[[0, -1]][inside[[0, -1]]]
    return np.concatenate([ends, border, inner])
