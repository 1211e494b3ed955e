"""The fold of section 3.1: two developable sheets that meet in a crease, and how far it turns what crosses it.

Wing: z = g_w(y) for x > g_s(y); spar: x = g_s(y) for z < g_w(y); the crease is (g_s(y), y, g_w(y)). Rolled out flat,
a point of the wing has the coordinates (s_w, x) and a point of the spar (s_s, z), with s the arc lengths along y.
Lengths are pure numbers of any one unit, angles radians.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import DesignError
from meshdrape.theory.profiles import Profile
from meshdrape.theory.quadrature import FloatArray, Primitive, distinct, running_integral

ComplexArray = NDArray[np.complex128]


class Tables(NamedTuple):
    """Smooth functions from 2048 pieces, to about 1e-11 of the span, where thousands of values are wanted at once.

    Attributes
    ----------
    drift : function of y
        `Fold.drift`, complex.
    crease_height : function of s_s
        g_w above a place of the flat spar.
    crease_slope : function of s_s
        Its derivative.
    """

    drift: Callable[[FloatArray], ComplexArray]
    crease_height: Callable[[FloatArray], FloatArray]
    crease_slope: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Fold:
    """A wing of profile g_w and a spar of profile g_s.

    Attributes
    ----------
    wing : Profile
        g_w, equation (1) of the study group report.
    spar : Profile
        g_s, equation (2); g_w + f for a spar that deviates by f, equation (5).
    """

    wing: Profile
    spar: Profile

    def __post_init__(self) -> None:
        if self.wing.span != self.spar.span:
            msg = f"wing and spar have spans {self.wing.span} and {self.spar.span}: give both the same"
            raise DesignError(msg)

    @property
    def span(self) -> float:
        """Where y ends; it starts at 0."""
        return self.wing.span

    def alpha(self, y: ArrayLike) -> FloatArray:
        """Angle of the crease against s_w on the flat wing (s_w, x): tan α = g_s' / sqrt(1 + g_w'²), (26)."""
        return np.asarray(np.arctan(self.spar.slope(y) / self.wing.stretch(y)))

    def beta(self, y: ArrayLike) -> FloatArray:
        """Angle of the crease against s_s on the flat spar (s_s, z): tan β = g_w' / sqrt(1 + g_s'²), (27).

        The middle expression of (27) has dy/ds_w for dy/ds_s, and the text before it the pairs of coordinates
        (s_s, x) and (s_w, z) for (s_s, z) and (s_w, x); its last expression is right.
        """
        return np.asarray(np.arctan(self.wing.slope(y) / self.spar.stretch(y)))

    def psi(self, y: ArrayLike) -> FloatArray:
        """Turn of the net where it crosses the crease at y, ψ = β - α, (28); counter-clockwise in (s, x) and (s, z)."""
        w, s = self.wing.slope(y), self.spar.slope(y)
        # one arctan of the two, since |psi| < pi
        p, q = np.sqrt(1 + w * w), np.sqrt(1 + s * s)
        return np.asarray(np.arctan2(w * p - s * q, p * q + w * s))

    def psi_slope(self, y: ArrayLike) -> FloatArray:
        """dψ/dy: with t = tan β etc., each angle's derivative is t' / (1 + t²)."""
        w, s, ww, ss = self.wing.slope(y), self.spar.slope(y), self.wing.bend(y), self.spar.bend(y)
        p2, q2 = 1 + w * w, 1 + s * s
        # 1 + tan² beta = (q2 + w²) / q2, and likewise for alpha: the sum is the same, |crease tangent|²
        both = 1 + w * w + s * s
        return np.asarray(((ww * q2 - w * s * ss) / np.sqrt(q2) - (ss * p2 - w * s * ww) / np.sqrt(p2)) / both)

    # --- the two flat sheets as complex planes: s + i x and s + i z -------------------------------------------------

    def wing_edge(self, y: ArrayLike) -> ComplexArray:
        """The crease on the flat wing, s_w + i x."""
        return np.asarray(self.wing.arc_length(y) + 1j * self.spar(y))

    def spar_edge(self, y: ArrayLike) -> ComplexArray:
        """The crease on the flat spar, s_s + i z."""
        return np.asarray(self.spar.arc_length(y) + 1j * self.wing(y))

    def edge_rate(self, y: ArrayLike) -> ComplexArray:
        """Derivative of `wing_edge` by y; that of `spar_edge` is this turned by ψ."""
        return np.asarray(self.wing.stretch(y) + 1j * self.spar.slope(y))

    @cached_property
    def _drift(self) -> Primitive:
        breaks = sorted({*self.wing.knots, *self.spar.knots})
        return Primitive(self.drift_rate, breaks)

    def drift_rate(self, y: ArrayLike) -> ComplexArray:
        """dH/dy = exp(i ψ) ds_w/dy."""
        return np.asarray(np.exp(1j * self.psi(y)) * self.wing.stretch(y))

    def drift(self, y: ArrayLike) -> ComplexArray:
        """The shape of every row on the spar: H(y) = ∫ exp(i ψ) ds_w from 0.

        The cells between two columns turn with the columns, whatever row they lie in (section 6.4), so all rows are
        this one curve, shifted: a row that came over the crease at y0 meets the column of y1 at
        ``spar_edge(y0) + drift(y1) - drift(y0)``.
        """
        return np.asarray(self._drift(y), dtype=np.complex128)

    @cached_property
    def tables(self) -> Tables:
        """The drift and the height of the crease as tables."""
        from scipy.interpolate import CubicHermiteSpline

        fine = np.linspace(0.0, self.span, 2049)
        y = distinct(-self.span, fine, self.wing.breaks, self.spar.breaks, 2 * self.span)
        rate = self.drift_rate(y)
        height = CubicHermiteSpline(
            running_integral(self.spar.stretch, y), self.wing(y), self.wing.slope(y) / self.spar.stretch(y)
        )
        return Tables(CubicHermiteSpline(y, running_integral(self.drift_rate, y), rate), height, height.derivative())

    # --- into space -------------------------------------------------------------------------------------------------

    def wing_to_space(self, flat: ArrayLike) -> FloatArray:
        """Points (..., 2) of the flat wing (s_w, x) as (..., 3) points x, y, z."""
        s, x = np.moveaxis(np.asarray(flat, dtype=np.float64), -1, 0)
        y = self.wing.near_arc_length(s)
        return np.stack([x, y, self.wing(y)], axis=-1)

    def spar_to_space(self, flat: ArrayLike) -> FloatArray:
        """Points (..., 2) of the flat spar (s_s, z) as (..., 3) points x, y, z."""
        s, z = np.moveaxis(np.asarray(flat, dtype=np.float64), -1, 0)
        y = self.spar.near_arc_length(s)
        return np.stack([self.spar(y), y, z], axis=-1)

    def depth(self, flat: ArrayLike) -> FloatArray:
        """How far below the crease points (..., 2) of the flat spar lie, along z."""
        s, z = np.moveaxis(np.asarray(flat, dtype=np.float64), -1, 0)
        return np.asarray(self.wing(self.spar.near_arc_length(s)) - z)

    # --- the same mould seen otherwise ------------------------------------------------------------------------------

    def swapped(self) -> Fold:
        """The mould with the roles of wing and spar exchanged, for a sheet that is laid on the spar first.

        In the coordinates x' = -z, z' = -x the spar is a wing of profile -g_s and the wing a spar of profile -g_w.
        """
        return Fold(-self.spar, -self.wing)

    def reversed(self) -> Fold:
        """The mould with y' = span - y, for a sheet whose rows start at the tip; both profiles 0 there."""
        return Fold(self.wing.reversed(), self.spar.reversed())

    def from_swapped(self, points: ArrayLike) -> FloatArray:
        """Points (..., 3) of `swapped` in this fold's coordinates."""
        x, y, z = np.moveaxis(np.asarray(points, dtype=np.float64), -1, 0)
        return np.stack([-z, y, -x], axis=-1)

    def from_reversed(self, points: ArrayLike) -> FloatArray:
        """Points (..., 3) of `reversed` in this fold's coordinates."""
        x, y, z = np.moveaxis(np.asarray(points, dtype=np.float64), -1, 0)
        return np.stack([x + self.spar(self.span), self.span - y, z + self.wing(self.span)], axis=-1)
