"""Sections 7.1 and 7.2: formulas for surfaces that are nearly flat and edges that are nearly straight, to O(ε).

Each function is the report's own formula; beside it stands what it was expanded from, where that has a closed form.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.theory.continuum import HeightField
from meshdrape.theory.quadrature import FloatArray


def weak_surface(a: float, b: float, c: float, epsilon: float) -> HeightField:
    """The surface z = -sqrt(ε) (a x² + 2 b x y + c y²) of (36); ac > b² is not needed."""
    root = float(np.sqrt(epsilon))

    def constant(x: FloatArray, value: float) -> FloatArray:
        return np.asarray(-2 * root * value + 0 * x)

    return HeightField(
        lambda x, y: -root * (a * x * x + 2 * b * x * y + c * y * y),
        lambda x, y: (-2 * root * (a * x + b * y), -2 * root * (b * x + c * y)),
        lambda x, y: (constant(x, a), constant(x, b), constant(x, c)),
    )


def weak_nodes(a: float, b: float, c: float, epsilon: float, u: ArrayLike, v: ArrayLike) -> FloatArray:
    """Nodes (x, y) to O(ε), (38); (..., 2).

    The start fibres are the plane sections x = 0 and y = 0, which are geodesics only for b = 0.
    """
    u, v = np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64)
    k = 2 / 3 * epsilon
    x = u - k * (a * a * u**3 + 3 * a * b * u * u * v + 3 * b * b * u * v * v)
    y = v - k * (3 * b * b * u * u * v + 3 * b * c * u * v * v + c * c * v**3)
    return np.stack(np.broadcast_arrays(x, y), axis=-1)


def weak_sine(a: float, b: float, c: float, epsilon: float, u: ArrayLike, v: ArrayLike) -> FloatArray:
    """Sine of the shear to O(ε), (39), from plane sections.

    Erratum: the report concludes that a cylinder laid askew (ac = b², b ≠ 0) must shear. That is the start fibres'
    doing: from geodesics any developable surface is covered without shear, `weak_sine_geodesic`.
    """
    u, v = np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64)
    return np.asarray(2 * epsilon * (a * b * u * u + 2 * (a * c - b * b) * u * v + b * c * v * v))


def weak_sine_geodesic(a: float, b: float, c: float, epsilon: float, u: ArrayLike, v: ArrayLike) -> FloatArray:
    """Sine of the shear to O(ε) from two geodesics through the seed: K u v, K = 4 ε (ac - b²) (Hazzidakis)."""
    return np.asarray(4 * epsilon * (a * c - b * b) * np.asarray(u, dtype=np.float64) * np.asarray(v, dtype=np.float64))


def weak_origami_surface(k: float, c: float, epsilon: float) -> HeightField:
    """The surface z = sqrt(ε) (k x + c y²), (40)."""
    root = float(np.sqrt(epsilon))
    return HeightField(
        lambda x, y: root * (k * x + c * y * y),
        lambda x, y: (root * k + 0 * x, 2 * root * c * y),
        lambda x, y: (0 * x, 0 * x, 2 * root * c + 0 * x),
    )


def weak_origami_sine(k: float, c: float, epsilon: float, v: ArrayLike) -> FloatArray:
    """Sine of the shear 2 ε c k v, after (40), from the plane sections x = 0 and y = 0.

    Erratum: "the only surface which can be covered with no shear at all" is the only one under these start fibres.
    """
    return np.asarray(2 * epsilon * c * k * np.asarray(v, dtype=np.float64))


def straight_edge_node(u: ArrayLike, v: ArrayLike, f: ArrayLike, m: float, epsilon: float) -> FloatArray:
    """Nodes (x, y) beyond the nearly straight edge x = ε f(y), to O(ε), (42) solved; (..., 2), f taken at y = v."""
    root = np.sqrt(1 + m * m)
    x = np.asarray(u, dtype=np.float64) / root + epsilon * np.asarray(f, dtype=np.float64) * (1 - 1 / root)
    return np.stack(np.broadcast_arrays(x, np.asarray(v, dtype=np.float64)), axis=-1)


def straight_edge_sine(slope: ArrayLike, m: float) -> FloatArray:
    """Sine of the shear |ε f'| (1 - 1 / sqrt(1 + m²)), (43); `slope` is ε f', m the slope of the spar, may be infinite.

    Holds for rows that start left of the bend; not in the strip where rows come from the wing. For m -> infinity the
    report equates it with (20): sin θ = ε f' and tan θ = f' differ at third order; exact is `straight_edge_turn`.
    """
    slope = np.asarray(slope, dtype=np.float64)
    return np.asarray(np.abs(slope) * (1 - 1 / np.sqrt(1 + m * m)))


def straight_edge_turn(slope: ArrayLike, m: float) -> FloatArray:
    """Exact turn of the net over the edge between the plane z = 0 and z = -m (x - ε f(y)), (41), rad.

    The crease leaves the cross-wise direction by π/2 - arcsin(s / n) on the wing and π/2 - arcsin(s / (n sqrt(1 + m²)))
    on the spar, s = ε f', n = sqrt(1 + s²). For m -> infinity that is arctan s.
    """
    slope = np.asarray(slope, dtype=np.float64)
    unit = slope / np.sqrt(1 + slope**2)
    return np.asarray(np.arcsin(unit) - np.arcsin(unit / np.sqrt(1 + m * m)))
