"""Profiles of wing and spar along the span: a smooth function of y with its derivatives and its arc length.

Lengths are pure numbers of any one unit; slopes have none. Every profile lives on 0 <= y <= span and goes on straight
beyond both ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import DesignError
from meshdrape.theory.quadrature import FloatArray, Primitive, distinct, largest, running_integral

Function = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Profile:
    """A function g(y) on [0, span] with its first two derivatives, continued straight beyond both ends.

    Call it for g. Profiles add, subtract and scale: ``real_wing() + 2 * parabola_deviation(0.1, 14)``.

    Attributes
    ----------
    span : float
    value, derivative, second_derivative : functions of an array, used within [0, span] only
    breaks : tuple of float
        Stations inside the span where a higher derivative jumps: the knots of a spline.
    """

    span: float
    value: Function
    derivative: Function
    second_derivative: Function
    breaks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not (np.isfinite(self.span) and self.span > 0):
            msg = f"span={self.span}: must be positive"
            raise DesignError(msg)

    def _inside(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        y = np.asarray(y, dtype=np.float64)
        return y, np.minimum(np.maximum(y, 0.0), self.span)

    def __call__(self, y: ArrayLike) -> FloatArray:
        """g, of the shape of y."""
        y, inside = self._inside(y)
        return np.asarray(self.value(inside) + self.derivative(inside) * (y - inside))

    def slope(self, y: ArrayLike) -> FloatArray:
        """dg/dy, of the shape of y."""
        return np.asarray(self.derivative(self._inside(y)[1]))

    def bend(self, y: ArrayLike) -> FloatArray:
        """d²g/dy², of the shape of y; 0 beyond the ends."""
        y, inside = self._inside(y)
        return np.asarray(np.where(y == inside, self.second_derivative(inside), 0.0))

    def stretch(self, y: ArrayLike) -> FloatArray:
        """ds/dy = sqrt(1 + g'²), equation (25) of the study group report."""
        return np.asarray(np.sqrt(1 + self.slope(y) ** 2))

    @property
    def knots(self) -> tuple[float, ...]:
        """Bounds of the pieces on which the profile is smooth, a straight piece before and one after the span."""
        return (-self.span, 0.0, *self.breaks, self.span, 2 * self.span)

    @cached_property
    def _arc(self) -> Primitive:
        return Primitive(self.stretch, self.knots)

    @cached_property
    def _arc_table(self) -> Any:
        from scipy.interpolate import CubicHermiteSpline

        fine = np.linspace(0.0, self.span, 4097)
        y = distinct(-self.span, fine, self.breaks, 2 * self.span)
        return CubicHermiteSpline(running_integral(self.stretch, y), y, 1 / self.stretch(y))

    def arc_length(self, y: ArrayLike) -> FloatArray:
        """Arc length from y = 0 to each y, to round-off."""
        return np.asarray(self._arc(y), dtype=np.float64)

    def at_arc_length(self, s: ArrayLike) -> FloatArray:
        """The y at each arc length: the inverse of `arc_length`, to round-off."""
        return self._arc.inverse(s)

    def near_arc_length(self, s: ArrayLike) -> FloatArray:
        """`at_arc_length` from a table of 4096 pieces, to 1e-11 of the span: for drawing and for whole nets."""
        return np.asarray(self._arc_table(np.asarray(s, dtype=np.float64)))

    @cached_property
    def length(self) -> float:
        """Arc length of the whole span."""
        return float(self._arc(np.array([self.span]))[0])

    @cached_property
    def largest_bend(self) -> float:
        """Largest |d²g/dy²| over the span."""
        return largest(lambda y: np.abs(self.bend(y)), 0.0, self.span)[0]

    def reversed(self) -> Profile:
        """The profile seen from the other end: g(span - y) - g(span), so that it starts at 0 again."""
        top = float(self(self.span))
        return Profile(
            self.span,
            lambda y: self.value(self.span - y) - top,
            lambda y: -self.derivative(self.span - y),
            lambda y: self.second_derivative(self.span - y),
            tuple(self.span - b for b in reversed(self.breaks)),
        )

    def __add__(self, other: Profile) -> Profile:
        if self.span != other.span:
            msg = f"profiles of span {self.span} and {other.span} do not add: give both the same span"
            raise DesignError(msg)
        return Profile(
            self.span,
            lambda y: self.value(y) + other.value(y),
            lambda y: self.derivative(y) + other.derivative(y),
            lambda y: self.second_derivative(y) + other.second_derivative(y),
            tuple(sorted({*self.breaks, *other.breaks})),
        )

    def __mul__(self, factor: float) -> Profile:
        return Profile(
            self.span,
            lambda y: factor * self.value(y),
            lambda y: factor * self.derivative(y),
            lambda y: factor * self.second_derivative(y),
            self.breaks,
        )

    __rmul__ = __mul__

    def __neg__(self) -> Profile:
        return -1.0 * self

    def __sub__(self, other: Profile) -> Profile:
        return self + -other


# --- profiles that stand by themselves ------------------------------------------------------------------------------


def flat(span: float) -> Profile:
    """The profile g = 0."""
    return Profile(span, lambda y: 0 * y, lambda y: 0 * y, lambda y: 0 * y)


def quadratic(a: float, span: float) -> Profile:
    """The profile g = a y², a in 1/length."""
    _finite(a=a)
    return Profile(span, lambda y: a * y * y, lambda y: 2 * a * y, lambda y: 2 * a + 0 * y)


def real_wing(span: float = 14.0, metre: float = 1.0) -> Profile:
    """The 14 m wing: g' = A + B exp(-y / L), slopes of 15, 7 and 3 degrees at 0, 4 and 14 m; g(0) = 0.

    Study group report, section 2, gives the three slopes; A, B, L are the ones that meet them with the gentlest
    monotone curve of this form.

    Parameters
    ----------
    span : float
    metre : float
        How many of the caller's units make a metre: 1000 where lengths are millimetres.
    """
    a, b, decay = 0.047227544, 0.220721648, 3.731291642 * metre

    def fading(y: FloatArray) -> FloatArray:
        return np.asarray(b * np.exp(-y / decay))

    return Profile(
        span, lambda y: a * y - b * decay * np.expm1(-y / decay), lambda y: a + fading(y), lambda y: -fading(y) / decay
    )


def arc(radius: float, span: float) -> Profile:
    """A circle that leaves y = 0 level: g = radius - sqrt(radius² - y²)."""
    if not radius > span:
        msg = f"radius={radius}: must be larger than the span, {span}"
        raise DesignError(msg)

    def drop(y: FloatArray) -> FloatArray:
        return np.asarray(np.sqrt((radius - y) * (radius + y)))

    return Profile(
        span, lambda y: y * y / (radius + drop(y)), lambda y: y / drop(y), lambda y: radius**2 / drop(y) ** 3
    )


def table(y: ArrayLike, g: ArrayLike, span: float | None = None) -> Profile:
    """A cubic spline through points (y, g), twice continuously differentiable.

    Parameters
    ----------
    y, g : (n,) float, n >= 4
        y strictly increasing, from 0 (or less) to the span (or more).
    span : float, optional
        The last y unless given.
    """
    return _spline("g", y, g, span)


def _spline(column: str, y: ArrayLike, values: ArrayLike, span: float | None) -> Profile:
    """The spline of a table whose second column goes by a name."""
    from scipy.interpolate import CubicSpline

    y, g = np.asarray(y, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if y.ndim != 1 or y.shape != g.shape or len(y) < 4:
        msg = f"a table needs two equal lists of at least 4 numbers; got {y.size} for y and {g.size} for {column}"
        raise DesignError(msg)
    for name, numbers in (("y", y), (column, g)):
        if not np.isfinite(numbers).all():
            k = int(np.flatnonzero(~np.isfinite(numbers))[0])
            msg = f"table: {name}[{k}] = {numbers[k]} is not a number"
            raise DesignError(msg)
    back = np.flatnonzero(np.diff(y) <= 0)
    if len(back):
        k = int(back[0])
        msg = f"table: y must increase, but y[{k + 1}] = {y[k + 1]} comes after y[{k}] = {y[k]}; sort the table"
        raise DesignError(msg)
    span = float(y[-1]) if span is None else span
    if y[0] > 0 or y[-1] < span * (1 - 1e-12):
        msg = f"table: y runs from {y[0]} to {y[-1]} and does not cover 0 to {span}; add points at the ends"
        raise DesignError(msg)
    spline = CubicSpline(y, g)
    first, second = spline.derivative(), spline.derivative(2)
    return Profile(
        span,
        lambda at: np.asarray(spline(at)),
        lambda at: np.asarray(first(at)),
        lambda at: np.asarray(second(at)),
        tuple(float(k) for k in y if 0 < k < span),
    )


# --- deviations f of the spar from the origami fold, g_s = g_w + f ---------------------------------------------------


def no_deviation(span: float) -> Profile:
    """No deviation, f = 0: the origami fold, equation (3) of the study group report."""
    return flat(span)


def linear_deviation(c: float, span: float) -> Profile:
    """A spar that is tilted, f = c y."""
    _finite(c=c)
    return Profile(span, lambda y: c * y, lambda y: c + 0 * y, lambda y: 0 * y)


def parabola_deviation(c: float, span: float) -> Profile:
    """A slope that grows to c at the tip, f = c y² / (2 span)."""
    return quadratic(c / (2 * span), span)


def sine_deviation(c: float, wavelength: float, span: float) -> Profile:
    """A sine, f = c sin(2π y / wavelength)."""
    k = _wave_number(c, wavelength)
    return Profile(
        span, lambda y: c * np.sin(k * y), lambda y: c * k * np.cos(k * y), lambda y: -c * k * k * np.sin(k * y)
    )


def sin2_slope_deviation(c: float, span: float) -> Profile:
    """A slope that comes and goes once, f' = c sin²(π y / span)."""
    k = _wave_number(c, span)
    return Profile(
        span,
        lambda y: c / 2 * (y - np.sin(k * y) / k),
        lambda y: c * np.sin(k * y / 2) ** 2,
        lambda y: c * k / 2 * np.sin(k * y),
    )


def bump_deviation(c: float, length: float, span: float) -> Profile:
    """A bump of height c at y = length: f = c r² exp(1 - r²), r = y / length."""
    if not length > 0:
        msg = f"length={length}: must be positive"
        raise DesignError(msg)
    _finite(c=c)

    def peak(y: FloatArray) -> FloatArray:
        return np.asarray(c * np.exp(1 - (y / length) ** 2))

    def second(y: FloatArray) -> FloatArray:
        q = (y / length) ** 2
        return np.asarray(peak(y) * 2 * (1 - 5 * q + 2 * q * q) / length**2)

    return Profile(
        span,
        lambda y: peak(y) * (y / length) ** 2,
        lambda y: peak(y) * 2 * (y / length) * (1 - (y / length) ** 2) / length,
        second,
    )


def ripple_deviation(c: float, wavelength: float, span: float) -> Profile:
    """Waves that start level, f = c (1 - cos(2π y / wavelength))."""
    k = _wave_number(c, wavelength)
    return Profile(
        span,
        lambda y: 2 * c * np.sin(k * y / 2) ** 2,
        lambda y: c * k * np.sin(k * y),
        lambda y: c * k * k * np.cos(k * y),
    )


def table_deviation(y: ArrayLike, f: ArrayLike, span: float | None = None) -> Profile:
    """A cubic spline through points (y, f); as `table`."""
    return _spline("f", y, f, span)


def _wave_number(c: float, wavelength: float) -> float:
    _finite(c=c)
    if not wavelength > 0:
        msg = f"wavelength={wavelength}: must be positive"
        raise DesignError(msg)
    return 2 * np.pi / wavelength


def _finite(**parameters: float) -> None:
    for name, value in parameters.items():
        if not np.isfinite(value):
            msg = f"{name}={value}: must be a number"
            raise DesignError(msg)


# --- by name --------------------------------------------------------------------------------------------------------

PROFILES: dict[str, Callable[..., Profile]] = {
    "real": real_wing,
    "flat": flat,
    "quadratic": quadratic,
    "arc": arc,
    "table": table,
}
DEVIATIONS: dict[str, Callable[..., Profile]] = {
    "none": no_deviation,
    "linear": linear_deviation,
    "parabola": parabola_deviation,
    "sine": sine_deviation,
    "sin2_slope": sin2_slope_deviation,
    "bump": bump_deviation,
    "ripple": ripple_deviation,
    "table": table_deviation,
}


def named_profile(name: str, span: float, **parameters: float | NDArray[np.float64]) -> Profile:
    """A profile by its name: ``real``, ``flat``, ``quadratic`` (a), ``arc`` (radius), ``table`` (y, g)."""
    return _named(PROFILES, "profile", name, span, parameters)


def named_deviation(name: str, span: float, **parameters: float | NDArray[np.float64]) -> Profile:
    """A deviation by its name.

    ``none``, ``linear`` (c), ``parabola`` (c), ``sine`` (c, wavelength), ``sin2_slope`` (c), ``bump`` (c, length),
    ``ripple`` (c, wavelength), ``table`` (y, f).
    """
    return _named(DEVIATIONS, "deviation", name, span, parameters)


def _named(known: dict[str, Callable[..., Profile]], kind: str, name: str, span: float, parameters: Any) -> Profile:
    from inspect import signature

    if name not in known:
        msg = f"{kind} {name!r} is not known: {', '.join(known)}"
        raise DesignError(msg)
    wanted = signature(known[name]).parameters
    for extra in parameters.keys() - wanted.keys():
        own = ", ".join(key for key in wanted if key != "span") or "no parameter"
        msg = f"{kind} {name!r} does not take {extra!r}; it takes {own}"
        raise DesignError(msg)
    for key, parameter in wanted.items():
        if key != "span" and key not in parameters and parameter.default is parameter.empty:
            msg = f"{kind} {name!r} needs {key}"
            raise DesignError(msg)
    return known[name](**parameters, span=span)
