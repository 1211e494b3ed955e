"""Section 4: a spar that deviates a little from the origami fold, to first order in f, and how far that holds.

The report's result is tan θ = f', (19). It is the shear of ribbon-fed cells under an upright left ribbon; expanded
about the origami fold, g_s = g_w + f, the exact turn of such a cell is

    ψ = -f' / p + g_w' f'² / (2 p³) + O(f'³),   p = sqrt(1 + g_w'²),

so (19) leaves out a factor 1 / p already at first order (it divides by dy where the cloth is ds_w long: 3.5 % at a
slope of 15 degrees, on the safe side), then a term of second order whose sign depends on that of f'.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.theory.fold import Fold
from meshdrape.theory.profiles import Profile
from meshdrape.theory.quadrature import FloatArray
from meshdrape.theory.reach import last_column, within_reach


def origami_advance(wing_slope: ArrayLike, spacing: float) -> FloatArray:
    """How far along y a row advances in one link of the origami fold: l = λ / sqrt(1 + g'²).

    (10) prints λ / (1 + g'²); (8) and (9) give the root.
    """
    return np.asarray(spacing / np.sqrt(1 + np.asarray(wing_slope, dtype=np.float64) ** 2))


def lateral_approach(wing_slope: ArrayLike, deviation_slope: ArrayLike, spacing: float) -> FloatArray:
    """S of (18), by how much more a link advances along y than on the origami fold; first line, with the root.

    Errata: the line before (17) has 2 l_i s_i for 2 l_i S_i, and the first line of (17) g'(S² + 2lS) for
    g'²(S² + 2lS); its second line and (18) are right. (11) has z = -f where the row's slope is +f' in (19); only its
    square enters here.
    """
    g, f = np.asarray(wing_slope, dtype=np.float64), np.asarray(deviation_slope, dtype=np.float64)
    length = origami_advance(g, spacing)
    return np.asarray(length * (np.sqrt(1 - 2 * (f * f + f * g) / (1 + (g + f) ** 2 + f * f)) - 1))


def lateral_approach_linear(wing_slope: ArrayLike, deviation_slope: ArrayLike, spacing: float) -> FloatArray:
    """The second line of (18), the root expanded: quadratic in the slopes f' and g'."""
    g, f = np.asarray(wing_slope, dtype=np.float64), np.asarray(deviation_slope, dtype=np.float64)
    return np.asarray(-origami_advance(g, spacing) * (f * f + f * g) / (1 + (g + f) ** 2 + f * f))


def slope_shear(deviation: Profile, y: ArrayLike) -> FloatArray:
    """θ = arctan |f'| at stations y, (19) with the modulus that is meant, rad."""
    return np.asarray(np.arctan(np.abs(deviation.slope(y))))


def expanded_psi(wing: Profile, deviation: Profile, y: ArrayLike) -> FloatArray:
    """ψ to second order in f': -f' / p + g_w' f'² / (2 p³), rad."""
    f, g = deviation.slope(y), wing.slope(y)
    p = np.sqrt(1 + g * g)
    return np.asarray(-f / p + g * f * f / (2 * p**3))


class SlopeValidity(NamedTuple):
    """Where (19) holds and what it leaves out, per station.

    Attributes
    ----------
    y : (n,) stations
    estimate : (n,) arctan |f'|, rad
    exact : (n,) |ψ|, the shear of a ribbon-fed cell under an upright left ribbon, rad
    from_wing_slope : (n,) what the missing factor 1 / sqrt(1 + g_w'²) adds to the estimate, rad
    from_second_order : (n,) what the term of second order adds, rad; negative: the estimate is too small
    reached : (n,) bool
        Whether the column comes down to ribbon-fed cells within the spar's height; elsewhere (19) speaks of no cell.
    wing_fed : float
        Largest shear of the wing-fed cells, of which (19) does not speak at all, rad.
    """

    y: FloatArray
    estimate: FloatArray
    exact: FloatArray
    from_wing_slope: FloatArray
    from_second_order: FloatArray
    reached: FloatArray
    wing_fed: float


def slope_validity(wing: Profile, deviation: Profile, height: float, stations: int = 201) -> SlopeValidity:
    """Compare (19) with the exact turn and with what it does not see; see `SlopeValidity`."""
    fold = Fold(wing, wing + deviation)
    y = np.linspace(0.0, fold.span, stations)
    f, g = deviation.slope(y), wing.slope(y)
    p = np.sqrt(1 + g * g)
    return SlopeValidity(
        y,
        slope_shear(deviation, y),
        np.abs(fold.psi(y)),
        np.abs(f) * (1 - 1 / p),
        np.sign(f) * g * f * f / (2 * p**3),
        y <= last_column(fold, height, np.zeros(1))[0],
        within_reach(fold, height).wing_fed.shear,
    )


class ScaleCheck(NamedTuple):
    """Condition (24): whether ribbons lie close enough for the crease to be straight between two of them.

    Attributes
    ----------
    bend : float
        λ g''_max, without unit; section 6.2 asks for << 1.
    bound : float
        4 sqrt(λ g''_max), the most a profile's slope can change between adjacent ribbons, (24).
    slope_change : float
        The most g_w' or g_s' does change between adjacent ribbons.
    turn_change : float
        The most ψ does change, rad: how far a criterion that takes ψ for constant over a cell may be out.
    y : float
        Where that is.
    coarse : (k, 2) float
        Stretches of the crease over which ψ changes by more than the tolerance from ribbon to ribbon.
    """

    bend: float
    bound: float
    slope_change: float
    turn_change: float
    y: float
    coarse: FloatArray


def separation_of_scales(fold: Fold, spacing: float, tolerance: float = np.radians(0.5)) -> ScaleCheck:
    """Check (24) and what it stands for, along the whole crease.

    Adjacent ribbons cross the crease one spacing apart in s_w (columns), or at values of g_s one spacing apart (rows):
    the farther of the two counts, as in (22) and (23).

    Parameters
    ----------
    tolerance : float
        Change of ψ from ribbon to ribbon up to which the spacing is fine enough, rad.
    """
    y = np.linspace(0.0, fold.span, 1025)
    s, x = fold.wing.arc_length(y), fold.spar(y)
    beside = np.minimum(fold.wing.at_arc_length(s + spacing), fold.span)
    away = np.where(y[None] > y[:, None], np.abs(x[None] - x[:, None]), 0.0)
    crossed = away >= spacing
    k, i = np.maximum(crossed.argmax(axis=1), 1), np.arange(len(y))
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (spacing - away[i, k - 1]) / (away[i, k] - away[i, k - 1])
    below = np.where(crossed.any(axis=1), y[k - 1] + part * (y[k] - y[k - 1]), fold.span)
    ahead = np.maximum(beside, below)
    between = (y[None] >= y[:, None]) & (y[None] <= ahead[:, None])

    def change(function: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Greatest less least value from each station up to the next ribbon."""
        here, there = function(y), function(ahead)
        most = np.maximum(np.where(between, here, -np.inf).max(axis=1), there)
        return np.asarray(most - np.minimum(np.where(between, here, np.inf).min(axis=1), there))

    turn = change(fold.psi)
    bend = spacing * max(fold.wing.largest_bend, fold.spar.largest_bend)
    over = np.concatenate([[False], turn > tolerance, [False]])
    start, end = np.flatnonzero(~over[:-1] & over[1:]), np.flatnonzero(over[:-1] & ~over[1:]) - 1
    worst = int(np.argmax(turn))
    return ScaleCheck(
        bend,
        4 * float(np.sqrt(bend)),
        float(max(change(fold.wing.slope).max(), change(fold.spar.slope).max())),
        float(turn[worst]),
        float(y[worst]),
        np.stack([y[start], ahead[end]], axis=-1),
    )
