"""(38) to (43) of the study group report, sections 7.1 and 7.2: what they are worth, by their observed order in ε."""

import numpy as np
import pytest
from rates import orders

from meshdrape.theory import (
    Fold,
    flat,
    geodesic,
    linear_deviation,
    plane_section,
    smooth_net,
    straight_edge_node,
    straight_edge_sine,
    straight_edge_turn,
    weak_nodes,
    weak_origami_sine,
    weak_origami_surface,
    weak_sine,
    weak_sine_geodesic,
    weak_surface,
)

EPSILON = (0.01, 0.005, 0.0025)
SHAPES = [(1, 0, 1), (1, 1, 1), (1, 0.5, 0.7), (0.4, -0.6, 0.3)]


def solved(field, make):
    return smooth_net(field, make(field, (1, 0), 1.0), make(field, (0, 1), 1.0), (1.0, 1.0), (12, 12), levels=3)


@pytest.mark.parametrize("shape", SHAPES)
def test_nodes_and_shear_from_plane_sections_are_right_to_first_order(shape):
    """What (38) and (39) leave out is of order ε²."""
    node_error, sine_error = [], []
    for epsilon in EPSILON:
        net = solved(weak_surface(*shape, epsilon), plane_section)
        u, v = np.meshgrid(net.u, net.v, indexing="ij")
        node_error.append(np.abs(net.plane - weak_nodes(*shape, epsilon, u, v)).max())
        sine_error.append(np.abs(net.sine - weak_sine(*shape, epsilon, u, v)).max())
    assert orders(node_error)[-1] == pytest.approx(2, abs=0.15), node_error
    assert orders(sine_error)[-1] == pytest.approx(2, abs=0.15), sine_error


@pytest.mark.parametrize("shape", SHAPES)
def test_from_geodesics_only_curvature_shears(shape):
    error = []
    for epsilon in EPSILON:
        net = solved(weak_surface(*shape, epsilon), geodesic)
        u, v = np.meshgrid(net.u, net.v, indexing="ij")
        error.append(np.abs(net.sine - weak_sine_geodesic(*shape, epsilon, u, v)).max())
    if shape == (1, 1, 1):
        assert max(error) < 1e-9
    else:
        # a term of second order, but for the angle at which geodesics leave where the axes are not principal
        assert orders(error)[-1] == pytest.approx(2, abs=0.15), error


@pytest.mark.parametrize(("epsilon", "sine"), [(0.01, 0.0379821), (0.000625, 0.00249170)])
def test_published_corner(epsilon, sine):
    """Goursat solution, corner u = v = 1; (39) gives 0.04 and 0.0025. Erratum: a, b, c = 1, 1, 1 is a cylinder."""
    assert solved(weak_surface(1, 0, 1, epsilon), plane_section).sine[-1, -1] == pytest.approx(sine, rel=3e-6)
    askew = weak_surface(1, 1, 1, epsilon)
    assert solved(askew, plane_section).sine[-1, -1] == pytest.approx(sine, rel=3e-6)
    assert abs(solved(askew, geodesic).sine[-1, -1]) < 1e-9
    assert weak_sine(1, 0, 1, epsilon, 1, 1) == weak_sine(1, 1, 1, epsilon, 1, 1) == pytest.approx(4 * epsilon)


def test_origami_surface():
    """(40), from plane sections; and none at all from geodesics, since the surface is developable."""
    error = []
    for epsilon in EPSILON:
        field = weak_origami_surface(0.8, 0.6, epsilon)
        net = solved(field, plane_section)
        error.append(np.abs(net.sine - weak_origami_sine(0.8, 0.6, epsilon, net.v)[None]).max())
    assert orders(error)[-1] == pytest.approx(2, abs=0.15), error


def test_published_edge():
    """f = -y², y = 0.99, m = 1, ε = 0.1: exact 3.30570 degrees, (43) 3.32461."""
    slope = -0.1 * 2 * 0.99
    assert np.degrees(abs(straight_edge_turn(slope, 1.0))) == pytest.approx(3.30570, abs=6e-6)
    assert np.degrees(np.arcsin(straight_edge_sine(slope, 1.0))) == pytest.approx(3.32461, abs=6e-6)


@pytest.mark.parametrize("m", [0.3, 1.0, 5.0, np.inf])
def test_edge_formula_errs_at_third_order(m):
    slope = 0.2 / 2.0 ** np.arange(4)
    error = np.abs(straight_edge_sine(slope, m) - np.sin(straight_edge_turn(slope, m)))
    assert orders(error)[-1] == pytest.approx(3, abs=0.1)


def test_upright_spar_is_the_skew_one():
    """m -> infinity: arctan, as (20) has it, not arcsin as (43)."""
    fold = Fold(flat(1.0), linear_deviation(0.3, 1.0))
    assert straight_edge_turn(0.3, np.inf) == pytest.approx(-fold.psi(0.5), abs=1e-15)
    assert straight_edge_turn(0.3, 1e9) == pytest.approx(np.arctan(0.3), abs=1e-9)


def test_nodes_beyond_the_edge_keep_their_distances_to_first_order():
    """(42) in (33): speeds of the solution err at ε², its angle is (43)."""
    m, step = 1.3, 1e-5
    error = []
    for epsilon in (0.02, 0.01, 0.005):

        def place(u, v, epsilon=epsilon):
            x, y = straight_edge_node(u, v, np.sin(v), m, epsilon)
            return np.array([x, y, -m * (x - epsilon * np.sin(v))])

        along_u = (place(1 + step, 0.4) - place(1 - step, 0.4)) / (2 * step)
        along_v = (place(1.0, 0.4 + step) - place(1.0, 0.4 - step)) / (2 * step)
        assert np.linalg.norm(along_u) == pytest.approx(1, abs=1e-10)
        error.append(abs(np.linalg.norm(along_v) - 1))
        assert abs(along_u @ along_v) == pytest.approx(straight_edge_sine(epsilon * np.cos(0.4), m), rel=1e-7)
    assert orders(error)[-1] == pytest.approx(2, abs=0.05)
