"""The report's criteria: the largest shear a fold asks of the sheet, by each of its formulas. Angles in radians.

The report numbers its regions differently in sections 3.4 and 6.4: its (29) speaks of the rows that come from the wing
(region II of section 3.4), its (30) and (31) of those that start on the left-most ribbon (region I). Here they are
called wing-fed and ribbon-fed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meshdrape.theory.fold import Fold
from meshdrape.theory.profiles import Profile
from meshdrape.theory.quadrature import FloatArray, largest


class Station(NamedTuple):
    """A value along the crease and the y it is taken at."""

    value: float
    y: float


class PsiRange(NamedTuple):
    """The least and the greatest turn ψ over the whole crease, rad."""

    least: Station
    greatest: Station


def psi_range(fold: Fold) -> PsiRange:
    """ψ_min and ψ_max of section 6.4, and where they are."""
    low, at_low = largest(lambda y: -fold.psi(y), 0.0, fold.span)
    high, at_high = largest(fold.psi, 0.0, fold.span)
    return PsiRange(Station(-low, at_low), Station(high, at_high))


def slope_criterion(deviation: Profile) -> Station:
    """arctan(max |f'|), equations (20) and (21), and where.

    The report prints max f' without the modulus. It is the shear of ribbon-fed cells with gamma = 0 alone, to first
    order, and exact where g_w' = 0 or g_s' = 0. It is unsafe where f' changes sign (wing-fed cells see the whole range
    of ψ, up to twice as much) and far too strict for a spar that is merely tilted.
    """
    steepest = largest(lambda y: np.abs(deviation.slope(y)), 0.0, deviation.span)
    return Station(float(np.arctan(steepest[0])), steepest[1])


def wing_fed_bound(fold: Fold) -> float:
    """ψ_max - ψ_min, equation (29): an upper bound for wing-fed cells.

    The report gives it as their maximum; only pairs y0 < y1 that meet within the spar's height occur, so the maximum
    is that of `within_reach`.
    """
    least, greatest = psi_range(fold)
    return greatest.value - least.value


def ribbon_fed_bound(fold: Fold, gamma: float) -> float:
    """The largest |ψ - γ|, (30): an upper bound for ribbon-fed cells, the left-most ribbon turned by gamma."""
    least, greatest = psi_range(fold)
    return max(greatest.value - gamma, gamma - least.value)


def middle_gamma(fold: Fold) -> tuple[float, float]:
    """γ = (ψ_max + ψ_min) / 2 and the bound it gives, (ψ_max - ψ_min) / 2, equation (31).

    The best gamma only if every column reaches the ribbon-fed cells; see `within_reach` for a spar of finite height.
    """
    least, greatest = psi_range(fold)
    return (greatest.value + least.value) / 2, (greatest.value - least.value) / 2


def fits_everywhere(fold: Fold, locking_angle: float) -> bool:
    """Whether ψ_max - ψ_min <= locking angle, (32): sufficient; necessary only if the extremes lie within reach."""
    return wing_fed_bound(fold) <= locking_angle


def turning_points(fold: Fold, samples: int = 2001) -> FloatArray:
    """Stations within the span where ψ has a local extreme, to round-off."""
    from meshdrape.theory.quadrature import root_between

    y = np.linspace(0.0, fold.span, samples)
    slope = fold.psi_slope(y)
    k = np.flatnonzero(slope[:-1] * slope[1:] < 0)
    sign = np.sign(slope[k + 1])

    def rate(at: FloatArray) -> FloatArray:
        step = 1e-6 * fold.span
        return sign * (fold.psi_slope(at + step) - fold.psi_slope(at - step)) / (2 * step)

    return root_between(lambda at: sign * fold.psi_slope(at), rate, y[k], y[k + 1])
