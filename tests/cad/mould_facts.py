"""What is known of a mould without looking at its B-rep."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from tessellated import Tessellation


@dataclass(frozen=True)
class Fact:
    """The mould of a script at its defaults."""

    script: ModuleType
    areas: tuple[float, ...]  # as the docstring lists them, mm²; their sum is the mould
    off: Callable[[Tessellation], np.ndarray]  # distance of each vertex from the surface, mm
    outward: Callable[[np.ndarray], np.ndarray]  # (m, 3) points on the mould -> direction on the cloth's side
    curvature: Callable[[np.ndarray], np.ndarray] = lambda p: np.zeros(len(p))
    largest_curvature: float = 0.0  # of the surface in any direction, 1/mm


def over_square(low: float, high: float, integrand: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """Gauss-Legendre integral over a square, to round-off for the smooth integrands here."""
    node, weight = np.polynomial.legendre.leggauss(60)
    at = (low + high) / 2 + (high - low) / 2 * node
    x, y = np.meshgrid(at, at, indexing="ij")
    return float(weight @ integrand(x, y) @ weight) * ((high - low) / 2) ** 2
