"""Integrals of smooth functions at many points at once, their inverses, and the largest value of a function."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
Array = NDArray[Any]  # float64 or complex128

_NODE, _WEIGHT = np.polynomial.legendre.leggauss(10)
_NODE_4, _WEIGHT_4 = np.polynomial.legendre.leggauss(4)


def distinct(*points: ArrayLike) -> FloatArray:
    """All of the points in order, those nearer to one another than round-off taken once: a table's abscissae."""
    ordered = np.unique(np.concatenate([np.atleast_1d(np.asarray(part, dtype=np.float64)) for part in points]))
    apart = np.diff(ordered) > 1e-12 * (ordered[-1] - ordered[0])
    return np.asarray(ordered[np.concatenate([[True], apart])])


class Primitive:
    """The integral of a function from 0, real or complex, to round-off; call it with any array of points.

    Gauss quadrature on panels, doubled in number until the whole integral no longer changes.

    Parameters
    ----------
    integrand : function of an array
        Smooth between the breaks.
    breaks : (m,) float, ascending
        Where a derivative of the integrand may jump; the first and last bound the panels. Beyond them the last
        panel's quadrature is stretched: exact only while the integrand stays a polynomial.
    """

    def __init__(self, integrand: Callable[[FloatArray], Array], breaks: ArrayLike) -> None:
        self.integrand = integrand
        knots = distinct(breaks)
        parts = max(1, 32 // (len(knots) - 1))
        table, whole = self._table(knots, parts)
        for _ in range(8):
            parts *= 2
            before = whole
            table, whole = self._table(knots, parts)
            if abs(whole - before) <= 1e-14 * abs(whole) + 1e-300:
                break
        self.panel, self.sum = table
        self.sum = self.sum - self(np.zeros(1))[0]

    def _table(self, knots: FloatArray, parts: int) -> tuple[tuple[FloatArray, Array], Any]:
        t = np.arange(parts) / parts
        panel = np.append((knots[:-1, None] + np.diff(knots)[:, None] * t).reshape(-1), knots[-1])
        half = np.diff(panel)[:, None] / 2
        piece = (half * self.integrand(panel[:-1, None] + half * (1 + _NODE))) @ _WEIGHT
        total = np.concatenate([[0.0], np.cumsum(piece)])
        return (panel, total), total[-1]

    def __call__(self, at: ArrayLike) -> Array:
        """The integral from 0 to each point, of the shape of the points."""
        at = np.asarray(at, dtype=np.float64)
        k = np.clip(np.searchsorted(self.panel, at, side="right") - 1, 0, len(self.panel) - 2)
        half = (at - self.panel[k]) / 2
        value = self.integrand(self.panel[k][..., None] + half[..., None] * (1 + _NODE))
        return np.asarray(self.sum[k] + half * (value @ _WEIGHT))

    def inverse(self, value: ArrayLike) -> FloatArray:
        """Where the integral of a positive function takes each value."""
        value = np.asarray(value, dtype=np.float64)
        at = np.interp(value, self.sum, self.panel)
        scale = self.panel[-1] - self.panel[0]
        for _ in range(50):
            step = (value - self(at)) / self.integrand(at)
            at = at + step
            # quadratic: a step below the square root of round-off was the last one needed
            if not step.size or np.abs(step).max() < 1e-8 * scale:
                break
        return np.asarray(at)


def running_integral(integrand: Callable[[FloatArray], Array], at: FloatArray) -> Array:
    """The integral from 0 to each of many ascending points that lie close together and have 0 among them.

    Four Gauss points a piece: an error of order 9 in its width.
    """
    half = np.diff(at)[:, None] / 2
    total = np.concatenate([[0.0], np.cumsum((half * integrand(at[:-1, None] + half * (1 + _NODE_4))) @ _WEIGHT_4)])
    return np.asarray(total - total[np.searchsorted(at, 0.0)])


def largest(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, n: int = 2001
) -> tuple[float, float]:
    """The largest value of a function on [low, high] and where it is taken.

    Sampled at n points and again, finer, about the best of them: right to round-off where the highest peak is
    wider than the first samples lie apart.
    """
    start, end, points = low, high, n
    while True:
        at = np.linspace(start, end, points)
        value = function(at)
        k = int(np.argmax(value))
        if end - start <= 1e-9 * (high - low) or not high > low:
            return float(value[k]), float(at[k])
        start, end, points = float(at[max(k - 1, 0)]), float(at[min(k + 1, points - 1)]), 41


def root_between(
    function: Callable[[FloatArray], FloatArray],
    slope: Callable[[FloatArray], FloatArray],
    low: ArrayLike,
    high: ArrayLike,
) -> FloatArray:
    """A zero of a function between each pair of bounds, where it goes from not positive to positive.

    Newton's method, halving the bracket wherever a step would leave it.
    """
    low, high = (np.array(bound, dtype=np.float64) for bound in (low, high))
    at = (low + high) / 2
    for _ in range(100):
        value = function(at)
        low, high = np.where(value <= 0, at, low), np.where(value > 0, at, high)
        rate = slope(at)
        with np.errstate(divide="ignore", invalid="ignore"):
            new = at - value / rate
        new = np.where((new > low) & (new < high), new, (low + high) / 2)
        step, at = np.abs(new - at), new
        if not at.size or (step <= 1e-15 * (1 + np.abs(at))).all():
            break
    return np.asarray(at)
