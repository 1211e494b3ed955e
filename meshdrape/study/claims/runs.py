"""The runs that several claims and pictures speak of, each made once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from meshdrape.study.claims.drapes import DrapedFold, drape_fold
from meshdrape.theory import (
    Fold,
    Profile,
    bump_deviation,
    flat,
    linear_deviation,
    parabola_deviation,
    quadratic,
    real_wing,
    sin2_slope_deviation,
    sine_deviation,
)

SPAN = 14.0
HEIGHT = 1.0  # of the real wing's spar, m
LOCKING = float(np.radians(7.0))


class Family(NamedTuple):
    """Deviations f of one form for the real wing: a name for people, f for an amplitude, and amplitudes to look at."""

    name: str
    make: Callable[[float], Profile]
    amplitudes: tuple[float, float]

    def fold(self, amplitude: float) -> Fold:
        """The real wing over a spar that deviates by f."""
        wing = real_wing(SPAN)
        return Fold(wing, wing + self.make(amplitude))


# amplitudes up to where the crease begins to fall and rows come back
FAMILIES = (
    Family("tilt, c y", lambda c: linear_deviation(c, SPAN), (0.1, 0.15)),
    Family("parabola, c y²/28", lambda c: parabola_deviation(c, SPAN), (0.1, 0.15)),
    Family("f' = c sin²(πy/14)", lambda c: sin2_slope_deviation(c, SPAN), (0.1, 0.15)),
    Family("bump at 2.5 m", lambda c: bump_deviation(c, 2.5, SPAN), (0.1, 0.15)),
    Family("sine, 7 m", lambda c: sine_deviation(c, 7.0, SPAN), (0.02, 0.04)),
)


@dataclass
class Runs:
    """Nets and drapes, coarser where it has to be quick.

    Attributes
    ----------
    quick : bool
    """

    quick: bool = False
    _drapes: dict[Any, DrapedFold] = field(default_factory=dict)

    @property
    def spacing(self) -> float:
        """Of drapes on the real wing, m."""
        return 0.05 if self.quick else 0.02

    @property
    def families(self) -> tuple[tuple[int, Family], ...]:
        """The `FAMILIES` to look at, with their numbers: quick, one of each kind."""
        return tuple((k, family) for k, family in enumerate(FAMILIES) if not self.quick or k in (0, 1, 3))

    @property
    def facet(self) -> float:
        """Width of the facets of the real wing, m."""
        return 7e-3 if self.quick else 3.5e-3

    @cached_property
    def wing(self) -> Profile:
        """The 14 m wing of section 2."""
        return real_wing(SPAN)

    @cached_property
    def figure_4(self) -> Fold:
        """g_w = 0.2 y², g_s = 0.4 y², 0 <= y <= 1."""
        return Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0))

    @cached_property
    def origami(self) -> Fold:
        """The real wing over its origami spar."""
        return Fold(self.wing, self.wing)

    @cached_property
    def flat_spar(self) -> Fold:
        """Section 5: a curved wing over a flat spar."""
        return Fold(quadratic(0.05, 2.0), flat(2.0))

    def real(self, family: int, amplitude: int = 0) -> Fold:
        """The real wing with one of the `FAMILIES`, at the first or second of its amplitudes."""
        chosen = FAMILIES[family]
        return chosen.fold(chosen.amplitudes[amplitude])

    def draped_figure_4(self, gamma: float = 0.0) -> DrapedFold:
        """Figure 4 draped on facets of half a millimetre in a metre, spacing 20 mm, spar 0.6 m high."""
        return self._draped(("figure 4", gamma), self.figure_4, 0.02, 0.6, 5e-4, gamma)

    def draped_real(self, family: int, gamma: float | str = 0.0) -> DrapedFold:
        """The real wing with one of the `FAMILIES` draped, spar 1 m high."""
        return self._draped((family, gamma), self.real(family), self.spacing, HEIGHT, self.facet, gamma)

    def draped_origami(self) -> DrapedFold:
        """The origami fold draped."""
        return self._draped("origami", self.origami, self.spacing, HEIGHT, self.facet, 0.0)

    def draped_flat_spar(self) -> DrapedFold:
        """Section 5 draped, spacing 20 mm, spar half a metre high."""
        return self._draped("flat spar", self.flat_spar, 0.02, 0.5, 1e-3, 0.0)

    def _draped(self, key: Any, fold: Fold, spacing: float, height: float, facet: float, gamma: Any) -> DrapedFold:
        if key not in self._drapes:
            self._drapes[key] = drape_fold(fold, spacing, height, facet, gamma)
        return self._drapes[key]
