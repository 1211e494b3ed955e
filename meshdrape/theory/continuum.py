"""Section 7: the smooth net on a height field z(x, y) from two start fibres, by the method of characteristics.

Fibres u = const and v = const of unit speed, (33) and (34), are the characteristics; prescribed on one of each they
determine the net. With g the metric of the surface, (34) is g(r_u, r_u) = g(r_v, r_v) = 1; differentiated along the
other family it says that r_uv has no component in the surface,

    x^k_uv = -Γ^k_ab x^a_u x^b_v,   Γ^k_ab = z_k z_ab / (1 + |grad z|²),

which keeps both speeds at 1. A box scheme integrates it, cell by cell from the known three corners, all cells of an
anti-diagonal at once: second order. Its error is a series in even powers of the step, so nets of halved steps are
extrapolated (Richardson) to fourth, sixth, ... order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import DesignError, NetError
from meshdrape.theory.quadrature import FloatArray

Height = Callable[[FloatArray, FloatArray], FloatArray]
Derivatives = Callable[[FloatArray, FloatArray], tuple[FloatArray, ...]]


@dataclass(frozen=True, eq=False)
class HeightField:
    """A smooth surface z(x, y).

    Attributes
    ----------
    z : function of two arrays
    gradient : function of two arrays -> (z_x, z_y)
    hessian : function of two arrays -> (z_xx, z_xy, z_yy)
    accuracy : float
        How well the derivatives are known; start fibres are followed no more finely.
    """

    z: Height
    gradient: Derivatives
    hessian: Derivatives
    accuracy: float = 1e-13

    @classmethod
    def numerical(cls, z: Height, step: float = 1e-3) -> HeightField:
        """A surface of which only z is known; derivatives by central differences of fourth order.

        Parameters
        ----------
        step : float
            About a thousandth of the lengths over which z changes: first derivatives are then good to 1e-12 of a
            slope of 1, second ones to 1e-9.
        """
        near = np.array([-2, -1, 1, 2]) * step
        first = np.array([1, -8, 8, -1]) / (12 * step)
        second = np.array([-1, 16, 16, -1]) / (12 * step**2)

        def gradient(x: FloatArray, y: FloatArray) -> tuple[FloatArray, ...]:
            return (
                sum(w * z(x + d, y) for w, d in zip(first, near, strict=True)),
                sum(w * z(x, y + d) for w, d in zip(first, near, strict=True)),
            )

        def hessian(x: FloatArray, y: FloatArray) -> tuple[FloatArray, ...]:
            middle = -30 / (12 * step**2) * z(x, y)
            return (
                middle + sum(w * z(x + d, y) for w, d in zip(second, near, strict=True)),
                sum(
                    w * v * z(x + d, y + e)
                    for w, d in zip(first, near, strict=True)
                    for v, e in zip(first, near, strict=True)
                ),
                middle + sum(w * z(x, y + d) for w, d in zip(second, near, strict=True)),
            )

        return cls(z, gradient, hessian, accuracy=1e-9)

    def curvature(self, x: ArrayLike, y: ArrayLike) -> FloatArray:
        """Gaussian curvature."""
        x, y = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
        (p, q), (r, s, t) = self.gradient(x, y), self.hessian(x, y)
        return np.asarray((r * t - s * s) / (1 + p * p + q * q) ** 2)

    def speed(self, at: FloatArray, step: FloatArray) -> FloatArray:
        """Length on the surface per step (..., 2) of the plane at points (..., 2)."""
        p, q = self.gradient(at[..., 0], at[..., 1])
        return np.asarray(np.sqrt(np.sum(step**2, axis=-1) + (p * step[..., 0] + q * step[..., 1]) ** 2))


# --- start fibres: functions of arc length -> (x, y), of shape (..., 2) -----------------------------------------------

Fibre = Callable[[FloatArray], FloatArray]


def _follow(
    field: HeightField, rate: Callable[[float, FloatArray], FloatArray], length: float, start: ArrayLike
) -> Callable[[FloatArray], FloatArray]:
    """Solve an ordinary differential equation by arc length; returns the solution as a function of it."""
    from scipy.integrate import solve_ivp

    run = solve_ivp(
        rate, (0.0, length), start, method="DOP853", rtol=field.accuracy, atol=field.accuracy / 10, dense_output=True
    )
    if not run.success:
        msg = f"the start fibre cannot be followed past {run.t[-1]:.6g} of {length:g}: {run.message}"
        raise NetError(msg)
    solution = run.sol
    return lambda s: np.asarray(solution(np.asarray(s, dtype=np.float64)))


def curve_fibre(field: HeightField, curve: Fibre, tangent: Fibre, length: float, start: float = 0.0) -> Fibre:
    """Any curve of the (x, y) plane, laid on the surface, by arc length.

    Parameters
    ----------
    curve, tangent : functions of a parameter t -> (..., 2)
        The curve and its derivative by t.
    length : float
        How much of it is wanted, on the surface.
    start : float
        Parameter of the seed.
    """

    def rate(_: float, t: FloatArray) -> FloatArray:
        return 1 / field.speed(curve(t), tangent(t))

    parameter = _follow(field, rate, length, [start])
    return lambda s: curve(parameter(s)[0])


def plane_section(field: HeightField, direction: tuple[float, float], length: float) -> Fibre:
    """The section of the surface with the upright plane through the origin, as (38) has it for x = 0 and y = 0."""
    d = np.asarray(direction, dtype=np.float64) / np.hypot(*direction)
    return curve_fibre(
        field, lambda t: np.asarray(t)[..., None] * d, lambda t: np.broadcast_to(d, (*np.shape(t), 2)), length
    )


def geodesic(
    field: HeightField, direction: tuple[float, float], length: float, seed: tuple[float, float] = (0.0, 0.0)
) -> Fibre:
    """The geodesic from a seed; `direction` is that of its projection on the (x, y) plane."""
    at, d = np.asarray(seed, dtype=np.float64), np.asarray(direction, dtype=np.float64)
    d = d / field.speed(at, d)

    def rate(_: float, state: FloatArray) -> FloatArray:
        x, y, u, v = state
        (p, q), (r, s, t) = field.gradient(x, y), field.hessian(x, y)
        pull = -(r * u * u + 2 * s * u * v + t * v * v) / (1 + p * p + q * q)
        return np.array([u, v, pull * p, pull * q])

    path = _follow(field, rate, length, [*at, *d])
    return lambda s: np.moveaxis(path(s)[:2], 0, -1)


# --- the net ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class SmoothNet:
    """A smooth net at equal steps of u and v.

    Attributes
    ----------
    field : HeightField
    u, v : (n + 1,), (m + 1,) arc lengths along warp and weft
    plane : (n + 1, m + 1, 2) x and y of the nodes
    """

    field: HeightField
    u: FloatArray
    v: FloatArray
    plane: FloatArray

    @cached_property
    def node(self) -> FloatArray:
        """Nodes in space, (n + 1, m + 1, 3)."""
        x, y = self.plane[..., 0], self.plane[..., 1]
        return np.stack([x, y, self.field.z(x, y)], axis=-1)

    @cached_property
    def tangents(self) -> tuple[FloatArray, FloatArray]:
        """r_u and r_v at the nodes in space, (n + 1, m + 1, 3) each; differentiated through a spline of degree 7."""
        from scipy.interpolate import make_interp_spline

        found: list[Any] = []
        for axis, at in ((0, self.u), (1, self.v)):
            degree = min(7, (len(at) - 1) // 2 * 2 - 1)
            found.append(make_interp_spline(at, self.node, k=degree, axis=axis).derivative()(at))
        return found[0], found[1]

    @cached_property
    def speeds(self) -> tuple[FloatArray, FloatArray]:
        """|r_u| and |r_v|, which (33) wants to be 1."""
        u, v = self.tangents
        return np.linalg.norm(u, axis=-1), np.linalg.norm(v, axis=-1)

    @cached_property
    def sine(self) -> FloatArray:
        """Signed sin θ = r_u · r_v at the nodes, (35), which prints x_u · y_v. Positive where the angle closes."""
        u, v = self.tangents
        return np.asarray(np.sum(u * v, axis=-1) / (self.speeds[0] * self.speeds[1]))

    @property
    def shear(self) -> FloatArray:
        """Signed shear π/2 - σ at the nodes, rad."""
        return np.arcsin(np.clip(self.sine, -1, 1))

    def over(self, locking_angle: float) -> NDArray[np.bool_]:
        """Nodes at which (35) fails, |sin θ| > sin θ_max."""
        return np.asarray(np.abs(self.sine) > np.sin(locking_angle))


def smooth_net(
    field: HeightField, warp: Fibre, weft: Fibre, extent: tuple[float, float], cells: tuple[int, int], levels: int = 1
) -> SmoothNet:
    """The net from two start fibres that leave one seed.

    Parameters
    ----------
    field : HeightField
    warp, weft : functions of arc length -> (..., 2)
        Start fibres; `plane_section`, `geodesic` and `curve_fibre` make them.
    extent : (float, float)
        How far u and v run.
    cells : (int, int)
        Steps of u and v at which nodes are wanted.
    levels : int
        Nets of 1, 2, 4, ... times as many cells are extrapolated: order 2 * levels in the step.

    Raises
    ------
    NetError
        If a cell cannot be closed: the net has locked before the end of the extent.
    """
    if min(cells) < 4 or levels < 1:
        msg = f"cells={cells}, levels={levels}: at least 4 cells each way and 1 level"
        raise DesignError(msg)
    n, m = cells
    table: list[FloatArray] = []
    for level in range(levels):
        k = 1 << level
        u, v = (np.linspace(0.0, end, count * k + 1) for end, count in zip(extent, cells, strict=True))
        row = [_box_scheme(field, warp(u), weft(v))[::k, ::k]]
        for order, coarser in enumerate(table, start=1):
            row.append(row[-1] + (row[-1] - coarser) / (4**order - 1))
        table = row
    return SmoothNet(field, np.linspace(0.0, extent[0], n + 1), np.linspace(0.0, extent[1], m + 1), table[-1])


def _box_scheme(field: HeightField, warp: FloatArray, weft: FloatArray) -> FloatArray:
    if not np.allclose(warp[0], weft[0], rtol=0, atol=1e-10):
        msg = f"the start fibres begin at {warp[0].tolist()} and {weft[0].tolist()}: they must leave one seed"
        raise DesignError(msg)
    n, m = len(warp), len(weft)
    node = np.empty((n, m, 2))
    node[:, 0], node[0] = warp, weft
    scale = np.abs(warp[1] - warp[0]).max() + np.abs(weft[1] - weft[0]).max()
    for diagonal in range(2, n + m - 1):
        i = np.arange(max(1, diagonal - m + 1), min(diagonal, n))
        j = diagonal - i
        a, b, d = node[i - 1, j], node[i, j - 1], node[i - 1, j - 1]
        flat = a + b - d
        c = flat
        for _ in range(60):
            with np.errstate(invalid="ignore", over="ignore"):  # off the surface: seen below
                new = flat - _pull(field, (a + b + c + d) / 4, (b - d + c - a) / 2, (a - d + c - b) / 2)
            moved = np.abs(new - c).max()
            c = new
            if moved < 1e-15 * scale:
                break
        if not moved < 1e-9 * scale:
            k = int(np.argmax(~np.isfinite(c).all(axis=1)))
            msg = f"the net cannot be continued at cell ({i[k]}, {j[k]}) of ({n - 1}, {m - 1}): lower the extent"
            raise NetError(msg)
        node[i, j] = c
    return node


def _pull(field: HeightField, at: FloatArray, u: FloatArray, v: FloatArray) -> FloatArray:
    """Γ^k_ab u^a v^b at points (n, 2)."""
    x, y = at.T
    (p, q), (r, s, t) = field.gradient(x, y), field.hessian(x, y)
    bend = r * u[:, 0] * v[:, 0] + s * (u[:, 0] * v[:, 1] + u[:, 1] * v[:, 0]) + t * u[:, 1] * v[:, 1]
    slope = np.stack(np.broadcast_arrays(p, q), axis=-1)
    return np.asarray((bend / (1 + p * p + q * q))[:, None] * slope)
