"""Nets computed without any mesh, to hold draped ones against.

Each takes its mould as a formula: unfolding where the surface is developable, circles on the sphere, the equations of
a Chebyshev net (characteristic initial values on both generators) where there is no closed form. Any consistent unit.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


# --- sphere ---------------------------------------------------------------------------------------------------------


def sphere_angle(kuv: FloatArray | float) -> FloatArray:
    """Warp-weft angle W(K u v) of the smooth net on a sphere from two great circles at right angles, rad.

    (t W')' = -sin W, W(0) = pi / 2. With W = pi / 2 + f and the auxiliary pair (sin W, cos W) the power series of f
    follows term by term; it converges beyond K u v = 1.86, where the net locks.
    """
    terms = 80
    w, s, c = np.zeros(terms + 1), np.zeros(terms + 1), np.zeros(terms + 1)
    w[0], s[0], c[0] = np.pi / 2, 1.0, 0.0
    for n in range(terms):
        w[n + 1] = -s[n] / (n + 1) ** 2
        k = np.arange(n + 1)
        # s' = c w', c' = -s w'
        s[n + 1] = np.sum((k + 1) * w[k + 1] * c[n - k]) / (n + 1)
        c[n + 1] = -np.sum((k + 1) * w[k + 1] * s[n - k]) / (n + 1)
    return np.asarray(Polynomial(w)(np.asarray(kuv, dtype=np.float64)))


def sphere_net(radius: float, spacing: float, n: int) -> FloatArray:
    """Exact discrete net, (n + 1, n + 1, 3), on a sphere about the origin.

    Seed at (0, 0, radius), warp towards +x, weft towards +y; every edge an arc of one spacing.
    """
    turn = spacing / radius * np.arange(n + 1)
    node = np.zeros((n + 1, n + 1, 3))
    node[:, 0] = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], axis=1)
    node[0] = np.stack([0 * turn, np.sin(turn), np.cos(turn)], axis=1)
    cosine = np.cos(spacing / radius)
    for i in range(1, n + 1):
        for j in range(1, n + 1):
            a, b = node[i - 1, j], node[i, j - 1]
            across = np.cross(b, a)
            middle = (a + b) * cosine / (1 + a @ b)
            height = np.sqrt((1 - middle @ middle) / (across @ across))
            # the known corner of the cell is the other intersection of the two circles
            side = np.sign(across @ node[i - 1, j - 1])
            node[i, j] = middle - side * height * across
    return radius * node


def sphere_net_of(
    radius: float, spacing: tuple[float, float], initial_angle: float, extent: float
) -> dict[tuple[int, int], FloatArray]:
    """Exact discrete net of any fabric on a sphere about the origin, all four quadrants: nodes (3,) by (i, j).

    Seed at (0, 0, radius), warp towards +x, weft at the initial angle counter-clockwise; spacing along warp and weft.
    The lattice goes to `extent` along both; a node is missing where the net has folded.
    """
    node: dict[tuple[int, int], FloatArray] = {}
    for at, step, azimuth in ((0, spacing[0], 0.0), (1, spacing[1], initial_angle)):
        for k in range(-int(extent / step), int(extent / step) + 1):
            turn = k * step / radius
            place = [np.sin(turn) * np.cos(azimuth), np.sin(turn) * np.sin(azimuth), np.cos(turn)]
            node[(k, 0) if at == 0 else (0, k)] = np.array(place)
    cosine = np.cos(np.array(spacing) / radius)
    for si in (1, -1):
        for sj in (1, -1):
            for i in range(1, int(extent / spacing[0]) + 1):
                for j in range(1, int(extent / spacing[1]) + 1):
                    a, b, known = (node.get((si * p, sj * q)) for p, q in ((i - 1, j), (i, j - 1), (i - 1, j - 1)))
                    if a is None or b is None or known is None:
                        continue
                    across = np.cross(a, b)
                    share = np.linalg.solve([[1.0, a @ b], [a @ b, 1.0]], cosine)
                    middle = share[0] * a + share[1] * b
                    height2 = (1 - middle @ middle) / (across @ across)
                    if height2 > 0:
                        # the known corner is the other intersection of the two circles
                        side = np.sign(across @ known)
                        node[si * i, sj * j] = middle - side * np.sqrt(height2) * across
    return {at: radius * place for at, place in node.items()}


def sphere_cell_shear(node: dict[tuple[int, int], FloatArray], initial_angle: float) -> dict[tuple[int, int], float]:
    """Signed shear of every whole cell of a net on a sphere: initial angle less the mean of the four corners, rad."""
    shear = {}
    for i, j in node:
        ring = [node.get(at) for at in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))]
        if any(place is None for place in ring):
            continue
        angles = []
        for k in range(4):
            normal = ring[k] / np.linalg.norm(ring[k])
            u, v = (other - (other @ normal) * normal for other in (ring[(k + 1) % 4], ring[k - 1]))
            angles.append(np.arctan2(np.cross(u, v) @ normal, u @ v))
        shear[i, j] = float(initial_angle - (angles[0] + angles[2] + 2 * np.pi - angles[1] - angles[3]) / 4)
    return shear


# --- any graph surface ----------------------------------------------------------------------------------------------


def chebyshev_net(
    christoffel: Callable[[FloatArray], FloatArray],
    warp: FloatArray,
    weft: FloatArray,
    metric: Callable[[FloatArray], FloatArray],
) -> tuple[FloatArray, FloatArray]:
    """Smooth net in parameter space from its generators, (n + 1, n + 1, 2), and the warp-weft angle at its nodes.

    r_uv is normal to the surface, so x^k_uv = -Gamma^k_ab x^a_u x^b_v. A box scheme, second order, sharpened by one
    Richardson step from half the points.

    Parameters
    ----------
    christoffel : (2,) -> (2, 2, 2), metric : (2,) -> (2, 2)
    warp, weft : (n + 1, 2), n even
        The generators at equal steps of arc length.
    """
    from scipy.interpolate import make_interp_spline

    fine = _box_scheme(christoffel, warp, weft)
    coarse = _box_scheme(christoffel, warp[::2], weft[::2])
    node = fine[::2, ::2] + (fine[::2, ::2] - coarse) / 3
    t = np.arange(len(node))
    warp_step, weft_step = (make_interp_spline(t, node, k=5, axis=axis).derivative()(t) for axis in (0, 1))
    angle = np.empty(node.shape[:2])
    for at in np.ndindex(angle.shape):
        u, v, g = warp_step[at], weft_step[at], metric(node[at])
        angle[at] = np.arccos(u @ g @ v / np.sqrt((u @ g @ u) * (v @ g @ v)))
    return node, angle


def _box_scheme(christoffel: Callable[[FloatArray], FloatArray], warp: FloatArray, weft: FloatArray) -> FloatArray:
    node = np.empty((len(warp), len(weft), 2))
    node[:, 0], node[0] = warp, weft
    for i in range(1, len(warp)):
        for j in range(1, len(weft)):
            d, a, b = node[i - 1, j - 1], node[i - 1, j], node[i, j - 1]
            c = a + b - d
            for _ in range(3):
                u, v = (b - d + c - a) / 2, (a - d + c - b) / 2
                c = a + b - d - np.einsum("kab,a,b->k", christoffel((a + b + c + d) / 4), u, v)
            node[i, j] = c
    return node


def hypar_net(k: float, length: float, n: int) -> tuple[FloatArray, FloatArray]:
    """Smooth net on z = k x y from its two straight lines through the origin: nodes (n + 1, n + 1, 3) and angles.

    Nodes at u, v = 0 ... length; the shear is pi / 2 less the angle.
    """

    def christoffel(p: FloatArray) -> FloatArray:
        x, y = p
        bend = k * k / (1 + k * k * (x * x + y * y))
        gamma = np.zeros((2, 2, 2))
        gamma[0, 0, 1] = gamma[0, 1, 0] = bend * y
        gamma[1, 0, 1] = gamma[1, 1, 0] = bend * x
        return gamma

    def metric(p: FloatArray) -> FloatArray:
        slope = k * p[::-1]
        return np.eye(2) + np.outer(slope, slope)

    t = np.linspace(0, length, 2 * n + 1)
    node, angle = chebyshev_net(christoffel, np.stack([t, 0 * t], axis=1), np.stack([0 * t, t], axis=1), metric)
    x, y = node[..., 0], node[..., 1]
    return np.stack([x, y, k * x * y], axis=-1), angle


# --- developable ----------------------------------------------------------------------------------------------------


def rolled_on_cylinder(flat: FloatArray, radius: float, azimuth: float) -> FloatArray:
    """Points (..., 2) of the plane on a cylinder about z, (..., 3): x along the axis, y towards larger azimuth.

    Seen against the axis's direction the plane's normal points at the axis.
    """
    p = azimuth + flat[..., 1] / radius
    return np.stack([radius * np.cos(p), radius * np.sin(p), flat[..., 0]], axis=-1)


def rolled_on_cone(flat: FloatArray, half_angle: float, slant: float, azimuth: float) -> FloatArray:
    """Points (..., 2) of the plane on a cone about z with its apex at the origin, (..., 3).

    x runs down the ruling from the seed at `slant` from the apex, y towards larger azimuth. Unrolled, the cone is a
    sector of the plane with polar angle azimuth x sin(half_angle).
    """
    x, y = flat[..., 0] + slant, flat[..., 1]
    rho, turn = np.hypot(x, y), np.arctan2(y, x)
    s, c = np.sin(half_angle), np.cos(half_angle)
    p = azimuth + turn / s
    return np.stack([rho * s * np.cos(p), rho * s * np.sin(p), rho * c], axis=-1)


# --- pyramid --------------------------------------------------------------------------------------------------------


def cube_corner_net(spacing: float, n: int, first: float, quadrant: int) -> FloatArray:
    """One quadrant, (n + 1, n + 1, 3), of the net whose seed is the corner of a cube, as `moulds.cube_corner` has it.

    The half-fibres leave 67.5 degrees apart, the first at the angle `first` from the x axis counter-clockwise about
    the outward diagonal; `quadrant` lies between half-fibre `quadrant` and the next. Its first index counts along the
    half-fibre it starts with. Each quadrant is a plane sheared lattice, folded over the cube's edges.
    """
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    sector = 3 * np.pi / 8
    place = spacing * (i + j * np.exp(1j * sector))
    turn = np.mod(first + quadrant * sector + np.angle(place), 3 * np.pi / 2)
    face = np.minimum((turn / (np.pi / 2) + 1e-12).astype(int), 2)
    within = turn - face * np.pi / 2
    axis = np.eye(3)
    flat = np.abs(place)[..., None] * np.stack([np.cos(within), np.sin(within)], axis=-1)
    return flat[..., :1] * axis[face] + flat[..., 1:] * axis[(face + 1) % 3]


# --- wing and spar --------------------------------------------------------------------------------------------------

WING, SPAR = 0, 1
Slope = Callable[[FloatArray], FloatArray]


class Crease:
    """A wing z = wing(y) and a spar x = spar(y) that meet in a crease; both unroll, to (x, arc) and (z, arc).

    Parameters
    ----------
    wing, spar : (function of y, its derivative)
        Zero at y = 0.
    span : float
        The crease runs over 0 <= y <= span, and a little beyond at both ends.
    """

    def __init__(self, wing: tuple[Slope, Slope], spar: tuple[Slope, Slope], span: float) -> None:
        from scipy.interpolate import CubicSpline

        self.profile, self.slope = (wing[0], spar[0]), (wing[1], spar[1])
        self.y = np.linspace(-0.1 * span, 1.1 * span, 6001)
        x, weight = np.polynomial.legendre.leggauss(4)
        half = np.diff(self.y)[:, None] / 2
        at = self.y[:-1, None] + half * (1 + x)
        self.arc, self.y_at_arc = [], []
        for slope in self.slope:
            piece = (half * weight * np.sqrt(1 + slope(at) ** 2)).sum(axis=1)
            total = np.concatenate([[0.0], np.cumsum(piece)])
            total -= CubicSpline(self.y, total)(0.0)
            self.arc.append(CubicSpline(self.y, total))
            self.y_at_arc.append(CubicSpline(total, self.y))

    def psi(self, y: FloatArray | float) -> FloatArray:
        """Turn of the net where it crosses at y (equation 28 of the report), rad."""
        b, a = (slope(np.asarray(y)) for slope in self.slope)
        return np.asarray(np.arctan(b / np.sqrt(1 + a * a)) - np.arctan(a / np.sqrt(1 + b * b)))

    def crossing(self, side: int, y: float) -> FloatArray:
        """The crease at y in the plane of one side."""
        return np.array([self.profile[1 - side](np.float64(y)), self.arc[side](y)])

    def tangent(self, side: int, y: float) -> FloatArray:
        """Derivative of `crossing` by y; of one length on both sides."""
        return np.array([self.slope[1 - side](np.float64(y)), np.sqrt(1 + self.slope[side](np.float64(y)) ** 2)])

    def unfolded(self, p: FloatArray, y: float) -> FloatArray:
        """A place of the wing's plane in the spar's, unfolded about the crease's tangent at y."""
        a, b = self.tangent(WING, y), self.tangent(SPAR, y)
        c, s = np.array([a @ b, a[0] * b[1] - a[1] * b[0]]) / (a @ a)
        return self.crossing(SPAR, y) + np.array([[c, -s], [s, c]]) @ (p - self.crossing(WING, y))

    def path(self, p: FloatArray, q: FloatArray) -> tuple[float, FloatArray, float]:
        """Shortest way from p on the wing to q on the spar: length, direction of arrival at q, y of its crossing."""
        from scipy.optimize import brentq

        def slope(y: float) -> float:
            legs = self.crossing(WING, y) - p, self.crossing(SPAR, y) - q
            return float(sum(leg @ self.tangent(side, y) / np.hypot(*leg) for side, leg in enumerate(legs)))

        ends = float(self.y_at_arc[WING](p[1])), float(self.y_at_arc[SPAR](q[1]))
        pad = abs(p[0] - self.crossing(WING, ends[0])[0]) + abs(q[0] - self.crossing(SPAR, ends[1])[0])
        low, high = max(min(ends) - pad, self.y[0]), min(max(ends) + pad, self.y[-1])
        y = float(brentq(slope, low, high, xtol=1e-15, rtol=1e-14))
        legs = self.crossing(WING, y) - p, q - self.crossing(SPAR, y)
        return float(np.hypot(*legs[0]) + np.hypot(*legs[1])), legs[1] / np.hypot(*legs[1]), y


class CreaseNet:
    """Exact discrete net laid undeformed on the wing, columns at wing arcs i spacing, rows at x = (j + 1/2) spacing.

    The left-most column runs down the spar at the angle gamma from the vertical, towards larger y where positive.
    Rows are numbered from `first_row`. On the wing nodes are the plane lattice; on the spar a cell is a rhombus; nodes
    of cells that straddle the crease are found from their distances to both parents.

    Attributes
    ----------
    side : (n, rows) 0 on the wing, 1 on the spar
    place : (n, rows, 2) in that side's plane
    shear : (n - 1, rows - 1) rad, warp along the rows, weft from larger x to smaller and down the spar; NaN on cells
        that straddle the crease
    region : 0 on the wing, 1 where rows come from the left ribbon, 2 where they come from the wing, -1 for cells that
        straddle and for the row whose left link crosses the corner
    """

    def __init__(self, crease: Crease, spacing: float, n: int, first_row: int, rows: int, gamma: float) -> None:
        self.crease, self.spacing = crease, spacing
        self.x = (first_row + np.arange(rows) + 0.5) * spacing
        self.side = np.zeros((n, rows), dtype=np.int64)
        self.place = np.empty((n, rows, 2))
        from_wing = self.x > 0
        for k in reversed(range(rows)):
            if from_wing[k]:
                self.place[0, k] = self.x[k], 0.0
            else:
                self.side[0, k] = SPAR
                self.place[0, k] = -self.x[k] * np.array([-np.cos(gamma), np.sin(gamma)])
        y = crease.y_at_arc[WING](np.arange(n) * spacing)
        on_wing = self.x >= crease.profile[SPAR](y)[:, None]
        for i in range(1, n):
            self.place[i] = np.stack([self.x, np.full(rows, i * spacing)], axis=1)
            for k in reversed(range(rows)):
                if not on_wing[i, k]:
                    self._put(i, k, float(y[i]))
        self._measure(from_wing)

    def _put(self, i: int, k: int, y: float) -> None:
        """Place a node of the spar; y is where its column would cross the crease."""
        self.side[i, k] = SPAR
        a, b, d = (i - 1, k), (i, k + 1), (i - 1, k + 1)
        if self.side[a] and self.side[b] and self.side[d]:
            self.place[i, k] = self.place[a] + self.place[b] - self.place[d]
            return
        flat = [self.place[m] if self.side[m] else self.crease.unfolded(self.place[m], y) for m in (a, b)]
        middle, half = (flat[0] + flat[1]) / 2, (flat[1] - flat[0]) / 2
        # larger i and smaller k lie clockwise of a to b in the plane (x, arc)
        q = middle + np.array([-half[1], half[0]]) * np.sqrt(self.spacing**2 / (half @ half) - 1)
        for _ in range(50):
            miss, slopes = np.empty(2), np.empty((2, 2))
            for row, parent in enumerate((a, b)):
                if self.side[parent]:
                    off = q - self.place[parent]
                    length, arrive = np.hypot(*off), off / np.hypot(*off)
                else:
                    length, arrive, _ = self.crease.path(self.place[parent], q)
                miss[row], slopes[row] = length - self.spacing, arrive
            q = q - np.linalg.solve(slopes, miss)
            if np.abs(miss).max() < 1e-13 * self.spacing:
                break
        else:
            raise ArithmeticError((i, k, miss))
        self.place[i, k] = q

    def _measure(self, from_wing: NDArray[np.bool_]) -> None:
        d, a, b = self.place[:-1, 1:], self.place[:-1, :-1], self.place[1:, 1:]
        count = self.side[:-1, 1:] + self.side[:-1, :-1] + self.side[1:, 1:] + self.side[1:, :-1]
        row, column = b - d, a - d
        angle = np.arctan2(row[..., 0] * column[..., 1] - row[..., 1] * column[..., 0], (row * column).sum(axis=-1))
        self.shear = np.where(count % 4 == 0, np.pi / 2 - angle, np.nan)
        fed = np.where(from_wing[:-1] & from_wing[1:], 2, np.where(from_wing[:-1] | from_wing[1:], -1, 1))
        self.region = np.where(count == 0, 0, np.where(count == 4, fed[None, :], -1))

    @cached_property
    def node(self) -> FloatArray:
        """Nodes in space, (n, rows, 3)."""
        sides = []
        for side, (u, v) in ((WING, (0, 2)), (SPAR, (2, 0))):
            y = self.crease.y_at_arc[side](self.place[..., 1])
            out = np.stack([y, y, y], axis=-1)
            out[..., u], out[..., v] = self.place[..., 0], self.crease.profile[side](y)
            sides.append(out)
        return np.where((self.side == WING)[..., None], *sides)

    @cached_property
    def height(self) -> FloatArray:
        """How far below the crease each node of the spar lies, (n, rows); negative on the wing."""
        y = self.crease.y_at_arc[SPAR](self.place[..., 1])
        return np.where(self.side == SPAR, self.crease.profile[0](y) - self.place[..., 0], -1.0)
