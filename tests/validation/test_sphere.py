"""A sphere covered from two great circles at right angles.

Source: Barton et al., New Techniques for Composite Wing Manufacture, section 7 (the continuum model; equation (33)
with two crossing fibres as data). On a sphere it reduces to (t W')' = -sin W for the warp-weft angle W as a function
of t = K u v alone, W(0) = pi / 2. The numbers below are that equation's, to seven digits, and those of the exact
discrete net, whose nodes are intersections of circles on the sphere.
"""

import numpy as np
import pytest
from lattice import cells_at, nodes_at, shear_deg
from moulds import icosphere
from references import sphere_angle, sphere_net

import meshdrape

# u = v and the shear there, degrees
SHEAR_ON_DIAGONAL = {0.2: 2.29163, 0.4: 9.15431, 0.5: 14.27443, 0.6: 20.47930, 0.8: 35.85800, 1.0: 54.31828}
# shear, degrees, and the K u v at which it is reached
REACHED_AT = {7: 0.1222745, 15: 0.2628029, 30: 0.5317924, 45: 0.8140509, 60: 1.1188336}
LOCKS_AT = 1.8615917
# spacing: largest distance of the discrete net's nodes from the smooth one's, mean of a cell's corners less the smooth
# angle at its centre, corner angles of the last cell
DISCRETE = {0.1: (4.39e-4, 0.0551, (49.4564, 49.6426)), 0.05: (1.09e-4, 0.0141, (51.8851, 51.9293)),
            0.025: (2.74e-5, 0.0036, (53.1008, 53.1115))}  # fmt: skip
CORNER = np.array([0.7066225, 0.7066225, -0.0370027])  # u = v = 1
RADIUS = 1000.0
LEVEL = 6


@pytest.mark.parametrize(("u", "shear"), SHEAR_ON_DIAGONAL.items())
def test_closed_form_reproduces_the_published_shear(u, shear):
    assert np.degrees(np.pi / 2 - sphere_angle(u * u)) == pytest.approx(shear, abs=5e-6)


@pytest.mark.parametrize(("shear", "kuv"), REACHED_AT.items())
def test_closed_form_reproduces_where_a_shear_is_reached(shear, kuv):
    assert np.degrees(np.pi / 2 - sphere_angle(kuv)) == pytest.approx(shear, abs=1e-5)


def test_closed_form_locks_where_published():
    assert sphere_angle(LOCKS_AT) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("spacing", "published"), DISCRETE.items())
def test_circles_reproduce_the_published_discrete_net(spacing, published):
    n = round(1 / spacing)
    node = sphere_net(1.0, spacing, n)
    d, a, b, c = node[:-1, :-1], node[:-1, 1:], node[1:, :-1], node[1:, 1:]
    corners = [_corner(d, b, a), _corner(c, a, b), np.pi - _corner(b, c, d), np.pi - _corner(a, d, c)]
    shear = np.degrees(np.pi / 2 - np.array(corners))
    assert sorted(shear[::2, -1, -1]) == pytest.approx(published[2], abs=6e-5)
    at = (np.arange(n) + 0.5) * spacing
    smooth = np.degrees(np.pi / 2 - sphere_angle(np.outer(at, at)))
    assert np.abs(shear.mean(axis=0) - smooth).max() == pytest.approx(published[1], abs=6e-5)
    assert np.linalg.norm(node[-1, -1] - CORNER) == pytest.approx(published[0], rel=0.01)


def _corner(at, p, q):
    """Angle between the arcs from a point of the unit sphere to two others, (n, m)."""
    u, v = (w - np.sum(w * at, axis=-1, keepdims=True) * at for w in (p, q))
    return np.arccos(np.sum(u * v, axis=-1) / np.linalg.norm(u, axis=-1) / np.linalg.norm(v, axis=-1))


@pytest.fixture(scope="module")
def mould():
    return icosphere(LEVEL, RADIUS).mould()


@pytest.fixture(scope="module", params=sorted(DISCRETE))
def draped(request, mould):
    net = meshdrape.drape(
        mould,
        meshdrape.Fabric(request.param * RADIUS),
        (0, 0, RADIUS),
        (1, 0, 0),
        extent=(0.0, 1050.0, 0.0, 1050.0),
    )
    return request.param, net, meshdrape.measure(net).cell_shear


def _noise(mould):
    """(h / R)^0.75 of the icosphere: what a mesh of chord tolerance h is held to in units of rad."""
    centre = mould.vertices[mould.triangles].mean(axis=1)
    return float((1 - np.linalg.norm(centre, axis=1).min() / RADIUS) ** 0.75)


def test_nodes_lie_on_the_exact_discrete_net(draped, mould):
    """Tolerance 3 h + 3 (h / R)^0.75 L for chord tolerance h, radius R and extent L."""
    spacing, net, _ = draped
    n = round(1 / spacing)
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    reference = sphere_net(RADIUS, spacing * RADIUS, n)
    off = np.linalg.norm(nodes_at(net, i, j) - reference, axis=-1)
    h = RADIUS * _noise(mould) ** (4 / 3)
    assert off.max() < 3 * h + 3 * _noise(mould) * 1.5 * RADIUS


def test_shear_of_cells_is_the_smooth_nets_at_their_centres(draped, mould):
    """Mean of the four corners against W: tolerance max 10 (h / R)^0.75 rad, rms 2 (h / R)^0.75 rad.

    The discrete net's own difference from the smooth one is published; the mesh's noise comes on top.
    """
    spacing, net, shear = draped
    n = round(1 / spacing)
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    smooth = np.pi / 2 - sphere_angle((i + 0.5) * (j + 0.5) * spacing**2)
    off = cells_at(net, shear, i, j) - smooth
    own = np.radians(DISCRETE[spacing][1])
    assert np.abs(off).max() < 10 * _noise(mould) + own
    assert np.sqrt(np.mean(off**2)) < 2 * _noise(mould) + own


def test_shear_on_the_diagonal(draped, mould):
    """The published table at whole cells: u = v at a node, so the mean of the two cells that meet there."""
    spacing, net, shear = draped
    for u, published in SHEAR_ON_DIAGONAL.items():
        n = u / spacing
        if abs(n - round(n)) < 1e-9 and u < 1:
            k = round(n) + np.array([-1, 0])
            here = np.degrees(cells_at(net, shear, k, k)).mean()
            # the diagonal's curvature over half a cell, and the noise of the mesh in rms
            curvature = np.degrees(0.25 * spacing**2 * 2.5)
            assert abs(here - published) < curvature + np.degrees(2 * _noise(mould)) + DISCRETE[spacing][1]


def test_corner_of_the_unit_square_of_cloth(draped, mould):
    """Node (u, v) = (1, 1) of the smooth net: (0.7066225, 0.7066225, -0.0370027); tolerances as above."""
    spacing, net, _ = draped
    n = round(1 / spacing)
    h = RADIUS * _noise(mould) ** (4 / 3)
    slack = 3 * h + 3 * _noise(mould) * 1.5 * RADIUS + DISCRETE[spacing][0] * RADIUS
    assert np.linalg.norm(nodes_at(net, n, n) - RADIUS * CORNER) < slack


def test_shear_closes_the_first_quadrant_of_a_dome_and_opens_its_neighbours(mould):
    """Signed shear = initial angle less angle(+warp, +weft); its sign is the quadrant's, sign(i) sign(j)."""
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), (0, 0, RADIUS), (1, 0, 0), extent=(500, 500, 500, 500))
    i, j = np.meshgrid(np.arange(-10, 10), np.arange(-10, 10), indexing="ij")
    cells = cells_at(net, shear_deg(net), i, j)
    away = (np.abs(i + 0.5) > 3) & (np.abs(j + 0.5) > 3)
    sign = np.sign(i + 0.5) * np.sign(j + 0.5)
    assert (cells * sign)[away].min() > 0
