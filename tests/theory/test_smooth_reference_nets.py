"""Smooth nets on sphere, pseudosphere and hypar.

Figures: closed forms and Goursat solutions (z ω'' + ω' + K sin ω = 0; power series), computed apart from this package.
"""

import numpy as np
import pytest
import references
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline

from meshdrape.errors import DesignError
from meshdrape.theory import constant_curvature_angle, hypar_net, locking_extent, pseudosphere_net, sphere_net

SPHERE_DEG = {0.2: 2.29163, 0.4: 9.15431, 0.5: 14.27443, 0.6: 20.47930, 0.8: 35.85800, 1.0: 54.31828}
REACHED_DEG = {7: 0.1222745, 15: 0.2628029, 30: 0.5317924, 45: 0.8140509, 60: 1.1188336, 90: 1.8615917}
# spacing: largest node error, mean of the four corners less centre (degrees), of the exact discrete net, unit sphere
DISCRETE = {0.1: (4.39e-4, 0.0551), 0.05: (1.09e-4, 0.0141), 0.025: (2.74e-5, 0.0036)}


def test_shear_on_the_sphere():
    for u, shear in SPHERE_DEG.items():
        assert 90 - np.degrees(constant_curvature_angle(u * u)) == pytest.approx(shear, abs=6e-6)
    for shear, extent in REACHED_DEG.items():
        assert locking_extent(np.radians(shear)) == pytest.approx(extent, abs=6e-8)


@pytest.mark.parametrize("sign", [1, -1])
def test_angle_solves_its_equation(sign):
    """Against a step-by-step solution from ω(0) = π/2, ω'(0) = -K."""
    run = solve_ivp(
        lambda z, w: [w[1], -(w[1] + sign * np.sin(w[0])) / z],
        (1e-8, 1.5), [np.pi / 2 - sign * 1e-8, -sign], rtol=1e-11, atol=1e-12,
    )  # fmt: skip
    assert constant_curvature_angle(sign * 1.5) == pytest.approx(run.y[0, -1], abs=1e-8)


def tangents(node, t):
    return [make_interp_spline(t, node, k=9, axis=axis).derivative()(t) for axis in (0, 1)]


def check_net(node, t, curvature):
    """Both families of unit speed, and the angle between them that of the curvature."""
    u, v = tangents(node, t)
    for family in (u, v):
        assert np.linalg.norm(family, axis=-1) == pytest.approx(1, abs=1e-8)
    angle = constant_curvature_angle(curvature * np.outer(t, t))
    assert np.sum(u * v, axis=-1) == pytest.approx(np.cos(angle), abs=1e-8)


def test_sphere_net():
    t = np.linspace(0, 1.2, 41)
    for radius in (1.0, 2.5):
        node = sphere_net(radius, radius * t, radius * t)
        assert np.linalg.norm(node, axis=-1) == pytest.approx(radius, rel=1e-13)
    check_net(sphere_net(2.0, t, t), t, 0.25)
    check_net(sphere_net(1.0, t, t), t, 1.0)
    assert sphere_net(1.0, [0, 1], [0, 1])[1, 1] == pytest.approx([0.7066225, 0.7066225, -0.0370027], abs=6e-8)


def test_pseudosphere_net():
    t = np.linspace(0, 0.6, 41)
    for seed, turn in ((3.0, 0.0), (4.0, 1.0), (5.0, 0.8)):
        node = pseudosphere_net(1.0, t, t, seed, turn)
        check_net(node, t, -1.0)
        # on the surface: radius ρ from the axis, z the tractrix
        rho = np.hypot(node[..., 0], node[..., 1])
        assert node[..., 2] == pytest.approx(np.arccosh(1 / rho) - np.sqrt(1 - rho**2), abs=1e-12)
    assert pseudosphere_net(2.0, 2 * t, 2 * t, 4.0) == pytest.approx(2 * pseudosphere_net(1.0, t, t, 4.0), abs=1e-12)
    # cells open
    assert constant_curvature_angle(-0.36) > np.pi / 2


def test_exact_discrete_net_tends_to_the_smooth_one():
    """Second order: nodes, and the mean of a cell's corners against its centre."""
    for spacing, (node_error, corner_error) in DISCRETE.items():
        n = round(1 / spacing)
        exact = references.sphere_net(1.0, spacing, n)
        t = spacing * np.arange(n + 1)
        assert np.linalg.norm(exact - sphere_net(1.0, t, t), axis=-1).max() == pytest.approx(node_error, rel=0.01)
        a, b, c, d = exact[-2, -2], exact[-1, -2], exact[-1, -1], exact[-2, -1]

        def corner(at, one, other):
            sides = [k - (k @ at) * at for k in (one, other)]
            return np.arccos(sides[0] @ sides[1] / np.linalg.norm(sides[0]) / np.linalg.norm(sides[1]))

        mean = (corner(a, b, d) + corner(c, b, d) + 2 * np.pi - corner(b, a, c) - corner(d, a, c)) / 4
        centre = constant_curvature_angle((1 - spacing / 2) ** 2)
        assert abs(np.degrees(mean - centre)) == pytest.approx(corner_error, abs=6e-5)


@pytest.mark.parametrize(("k", "shear"), [(0.5, -10.91200), (1.0, -26.66743)])
def test_hypar(k, shear):
    net = hypar_net(k, 1.0, 20)
    assert np.degrees(net.shear[-1, -1]) == pytest.approx(shear, abs=6e-6)
    if k == 1:
        assert net.node[-1, -1] == pytest.approx([0.7626122, 0.7626122, 0.5815774], abs=6e-8)
    # the start fibres are the surface's own straight lines
    assert net.plane[:, 0] == pytest.approx(np.stack([net.u, 0 * net.u], axis=1), abs=1e-14)
    coarse = hypar_net(k, 1.0, 10)
    assert net.node[::2, ::2] == pytest.approx(coarse.node, abs=2e-9)


def test_refused():
    with pytest.raises(DesignError, match=r"locks at 1.8615917"):
        constant_curvature_angle(1.9)
    with pytest.raises(DesignError, match="the net locks"):
        sphere_net(1.0, [1.5], [1.5])
    with pytest.raises(DesignError, match="passes the rim"):
        pseudosphere_net(1.0, [0.5], [0.0], seed=1.05)
    with pytest.raises(DesignError, match="shear=2"):
        locking_extent(2.0)
