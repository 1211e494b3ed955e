"""Smooth nets known to high precision: sphere, pseudosphere, hypar. What a draped net must tend to.

Where the Gaussian curvature K is constant and both start fibres are geodesics that cross at right angles, the angle
between warp and weft depends on z = u v alone: z ω'' + ω' + K sin ω = 0, ω(0) = π/2 (from σ_uv = -K sin σ). Its nodes
then solve a linear equation, r_uv = -K cos(ω) r, on the sphere in space and on the hyperbolic plane in Minkowski's.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from meshdrape.errors import DesignError
from meshdrape.theory.continuum import HeightField, SmoothNet, plane_section, smooth_net
from meshdrape.theory.quadrature import FloatArray, root_between

_TERMS = 90


def _angle_series() -> tuple[FloatArray, FloatArray]:
    """Power series in t = K u v of ω and of cos ω.

    (t ω')' = -sin ω term by term, with sin ω and cos ω carried along: (sin ω)' = ω' cos ω, (cos ω)' = -ω' sin ω.
    """
    angle, sine, cosine = np.zeros((3, _TERMS + 1))
    angle[0], sine[0] = np.pi / 2, 1.0
    for n in range(_TERMS):
        angle[n + 1] = -sine[n] / (n + 1) ** 2
        k = np.arange(n + 1)
        rate = (k + 1) * angle[k + 1]
        sine[n + 1] = np.sum(rate * cosine[n - k]) / (n + 1)
        cosine[n + 1] = -np.sum(rate * sine[n - k]) / (n + 1)
    return angle, cosine


_ANGLE, _COSINE = _angle_series()
_LOCKS_AT = 1.8615917  # K u v at which the angle closes, to the digits printed; the series converges beyond


def constant_curvature_angle(kuv: ArrayLike) -> FloatArray:
    """Angle between warp and weft where K u v has a value, rad; K < 0 for the pseudosphere.

    Raises
    ------
    DesignError
        Beyond |K u v| = 1.8615917, where the net on the sphere has locked.
    """
    kuv = np.asarray(kuv, dtype=np.float64)
    if (np.abs(kuv) > _LOCKS_AT + 1e-6).any():
        msg = f"K u v = {float(np.abs(kuv).max()):g}: the net locks at {_LOCKS_AT}"
        raise DesignError(msg)
    return np.asarray(Polynomial(_ANGLE)(kuv))


def locking_extent(shear: float) -> float:
    """K u v at which the shear on a sphere reaches a value, rad; π/2: where the net locks."""
    if not 0 <= shear <= np.pi / 2:
        msg = f"shear={shear} rad: lies between 0 and π/2"
        raise DesignError(msg)
    series = Polynomial(_ANGLE)
    slope = series.deriv()
    found = root_between(lambda t: np.pi / 2 - shear - series(t), lambda t: -slope(t), [0.0], [1.9])
    return float(found[0])


def _constant_curvature_nodes(sign: int, u: FloatArray, v: FloatArray) -> FloatArray:
    """r(u, v), (n, m, 3), of r_uv = -K cos(ω(K u v)) r with K = ±1, by its double power series.

    r(u, 0) = (sin u, 0, cos u), r(0, v) = (0, sin v, cos v); hyperbolic functions for K = -1, the third then being
    Minkowski's time.
    """
    terms = 60
    n = np.arange(terms)
    factorial = np.cumprod(np.concatenate([[1.0], np.arange(1, terms)]))
    series = np.power(-float(sign), n // 2) / factorial  # + + - - for the circle, all + for the hyperbola
    a = np.zeros((terms, terms, 3))
    a[:, 0, 0], a[0, :, 1] = np.where(n % 2 == 1, series, 0), np.where(n % 2 == 1, series, 0)
    a[:, 0, 2] = a[0, :, 2] = np.where(n % 2 == 0, series, 0)
    rate = -sign * _COSINE[:terms] * np.power(float(sign), n)
    for i in range(1, terms):
        for j in range(1, terms):
            k = np.arange(min(i, j))
            a[i, j] = rate[k] @ a[i - 1 - k, j - 1 - k] / (i * j)
    powers_u, powers_v = (np.vander(t, terms, increasing=True) for t in (u, v))
    return np.asarray(np.einsum("ui,ijk,vj->uvk", powers_u, a, powers_v, optimize=True))


def sphere_net(radius: float, u: ArrayLike, v: ArrayLike) -> FloatArray:
    """Nodes (n, m, 3) on a sphere about the origin; seed (0, 0, radius), warp towards +x, weft towards +y.

    u, v : arc lengths along the two great circles; |u v| at most 1.86 radius².
    """
    u, v = (np.asarray(t, dtype=np.float64) / radius for t in (u, v))
    constant_curvature_angle(np.abs(np.outer(u, v)))
    return np.asarray(radius * _constant_curvature_nodes(1, u, v))


def pseudosphere_net(radius: float, u: ArrayLike, v: ArrayLike, seed: float = 2.0, turn: float = 0.0) -> FloatArray:
    """Nodes (n, m, 3) on the pseudosphere, K = -1 / radius², its axis along z and its rim in the plane z = 0.

    The hyperbolic plane's upper half is wrapped round: (p, q), q >= 1, at distance radius / q from the axis, azimuth p.

    Parameters
    ----------
    seed : float
        q of the seed, at azimuth 0; larger is farther out along the horn.
    turn : float
        Angle of the warp against the direction of growing azimuth, rad; the weft 90 degrees on, towards growing z.

    Raises
    ------
    DesignError
        Where the net passes the rim, q < 1, where the surface ends.
    """
    u, v = (np.asarray(t, dtype=np.float64) / radius for t in (u, v))
    constant_curvature_angle(np.abs(np.outer(u, v)))
    x, y, time = np.moveaxis(_constant_curvature_nodes(-1, u, v), -1, 0)
    x, y = x * np.cos(turn) - y * np.sin(turn), x * np.sin(turn) + y * np.cos(turn)
    p, q = seed * x / (time - y), seed / (time - y)
    if (q < 1).any():
        msg = f"the net passes the rim of the pseudosphere (q = {float(q.min()):.4g} < 1): raise seed={seed}"
        raise DesignError(msg)
    along = np.arccosh(q) - np.sqrt(q * q - 1) / q
    return np.asarray(radius * np.stack([np.cos(p) / q, np.sin(p) / q, along], axis=-1))


def hypar(k: float) -> HeightField:
    """The surface z = k x y."""
    return HeightField(lambda x, y: k * x * y, lambda x, y: (k * y, k * x), lambda x, y: (0 * x, k + 0 * x, 0 * x))


def hypar_net(k: float, extent: float, cells: int) -> SmoothNet:
    """The net on z = k x y from its two straight lines through the origin, to about 1e-10 (extrapolated four times)."""
    field = hypar(k)
    warp, weft = plane_section(field, (1, 0), extent), plane_section(field, (0, 1), extent)
    return smooth_net(field, warp, weft, (extent, extent), (cells, cells), levels=4)
