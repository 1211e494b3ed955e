"""The kinds of moulds of the reference nets with other parameters, against references made without a mesh for each.

Cylinder, cone and wing by unrolling, sphere by circles, hypar by its equations: `references.py`, which reproduces the
stored nets and the published numbers.
"""

from pathlib import Path

import numpy as np
import pytest
from creased import facets, lay
from lattice import cells_at, nodes_at, planar_lattice, shear_deg
from moulds import cone, cube_corner, cylinder, hypar, icosphere, rotation, wing_spar
from references import (
    Crease,
    CreaseNet,
    cube_corner_net,
    hypar_net,
    rolled_on_cone,
    rolled_on_cylinder,
    sphere_net,
)

import meshdrape

REFERENCE = np.load(Path(__file__).with_name("nets.npz"))


def test_references_reproduce_the_stored_nets():
    crease = Crease((lambda y: 0.2 * y**2, lambda y: 0.4 * y), (lambda y: 0.4 * y**2, lambda y: 0.8 * y), 1.35)
    rows = REFERENCE["fold_row"]
    fold = CreaseNet(crease, 0.05, 21, int(rows.min()), len(rows), 0.0)
    assert fold.node[:, ::-1] == pytest.approx(REFERENCE["fold_node"], abs=1e-12)
    assert sphere_net(1.0, 0.05, 20) == pytest.approx(REFERENCE["sphere_node"], abs=1e-12)
    # the smooth net; the stored one is the discrete one
    assert hypar_net(1.0, 1.0, 40)[0][::2, ::2] == pytest.approx(REFERENCE["hypar_node"], abs=5e-5)
    azimuth, half = np.radians([20, 25])
    assert rolled_on_cone(_square(30), half, 1.0, azimuth) == pytest.approx(REFERENCE["cone_node"], abs=1e-12)
    assert rolled_on_cylinder(_square(35), 0.5, np.radians(10)) == pytest.approx(REFERENCE["cylinder_node"], abs=1e-12)


def _square(degrees):
    i, j = np.meshgrid(np.arange(-8, 9), np.arange(-8, 9), indexing="ij")
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return 0.05 * np.stack([i * c - j * s, i * s + j * c], axis=-1)


# wing and spar as (g, g') of each, gamma = psi(0) of itself; spacing, m
WINGS = {
    "gentler": (lambda y: 0.15 * y**2, lambda y: 0.3 * y, lambda y: 0.3 * y**2, lambda y: 0.6 * y, 0.04),
    "wing bends more than spar": (
        lambda y: 0.4 * y**2,
        lambda y: 0.8 * y,
        lambda y: 0.1 * y**2,
        lambda y: 0.2 * y,
        0.05,
    ),
    "flat wing": (lambda y: 0 * y, lambda y: 0 * y, lambda y: 0.3 * y**2, lambda y: 0.6 * y, 0.03),
    "cubic spar": (lambda y: 0.2 * y**2, lambda y: 0.4 * y, lambda y: 0.3 * y**3, lambda y: 0.9 * y**2, 0.05),
    "tilted": (
        lambda y: 0.3 * y,
        lambda y: 0.3 + 0 * y,
        lambda y: 0.1 * y + 0.3 * y**2,
        lambda y: 0.1 + 0.6 * y,
        0.05,
    ),
}


@pytest.mark.parametrize("name", WINGS)
def test_fold(name):
    wing, wing_slope, spar, spar_slope, spacing = WINGS[name]
    crease = Crease((wing, wing_slope), (spar, spar_slope), 1.2)
    n = int(crease.arc[0](1.0) / spacing) + 1
    edge = float(spar(np.float64(1.2)))
    reference = CreaseNet(
        crease, spacing, n, -int(0.6 / spacing), int((0.6 + edge) / spacing) + 3, float(crease.psi(0.0))
    )
    width, kappa = 0.5e-3, 1.8
    h = kappa * width**2 / 8
    draped = lay(crease, reference, facets(1.2, width), edge + 0.3, 1.0, int(reference.x[-1] / spacing))
    y = reference.node[..., 1]
    inside = (reference.height < 1.0) & (y >= 0) & (y < 1.2)
    assert draped.node_error(inside) < 1.5 * h + 1e-12
    cells = np.all([inside[a : a - 1 or None, b : b - 1 or None] for a in (0, 1) for b in (0, 1)], axis=0)
    for region in (1, 2):
        tagged = cells & (reference.region == region)
        if tagged.any():
            assert np.degrees(draped.shear_error(tagged)) < 0.01 + np.degrees(h / spacing)
    assert (cells & (reference.region == 1)).sum() > 50


@pytest.mark.parametrize(("k", "spacing"), [(0.05, 0.031), (0.45, 0.04), (-0.2, 0.05), (1.0, 0.025)])
def test_skew(k, spacing):
    y = 1000 * np.array([0.0, 0.2, 0.9, 1.4, 2.0])
    mesh = wing_spar(lambda t: 0 * t, lambda t: k * t, y, 3000, 900)
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(1000 * spacing), (2500, 0, 0), (0, 1, 0))
    shear = shear_deg(net)
    assert np.isfinite(shear).sum() > 1500
    assert np.nanmax(np.abs(shear)) < 1e-6


@pytest.mark.parametrize(("c", "n", "spacing", "seed_y", "eta"), [
    (0.1, 300, 0.03, 0.5, 17), (0.5, 51, 0.021, 0.4, 0), (0.8, 30, 0.05, 0.31, 45), (0.3, 7, 0.03, 0.55, -30),
])  # fmt: skip
def test_origami(c, n, spacing, seed_y, eta):
    def profile(t):
        return c * t**2 / 1000

    mesh = wing_spar(profile, profile, np.linspace(0, 1000, n + 1), 2000, 800)
    seed = (1400, 1000 * seed_y, 1000 * c * seed_y**2)
    direction = (np.sin(np.radians(eta)), np.cos(np.radians(eta)), 0)
    # the seed lies off the facet by its chord height, which one spacing covers
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(1000 * spacing), seed, direction)
    shear = shear_deg(net)
    assert np.isfinite(shear).sum() > 900
    assert np.nanmax(np.abs(shear)) < 1e-6


@pytest.mark.parametrize(("radius", "spacing", "turn"), [(250.0, 12.5, 0.3), (2500.0, 62.5, 1.1), (1000.0, 80.0, 2.0)])
def test_sphere(radius, spacing, turn):
    """Seed and direction anywhere: the sphere turned under them."""
    level = 6
    turned = rotation([0.2, -0.7, 0.4], turn)
    mould = icosphere(level, radius).mould()
    n = int(0.9 * radius / spacing)
    reach = 1.05 * n * spacing
    net = meshdrape.drape(
        mould,
        meshdrape.Fabric(spacing),
        turned @ [0, 0, radius],
        turned @ [1, 0, 0],
        extent=(0, reach, 0, reach),
    )
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    off = np.linalg.norm(nodes_at(net, i, j) - sphere_net(radius, spacing, n) @ turned.T, axis=-1)
    assert off.max() < 4e-3 * radius


def test_hypar():
    """k = 0.5, and a spacing that is no multiple of the grid's."""
    k, n = 0.5, 26
    net = meshdrape.drape(hypar(k, 1.3, 200).mould(), meshdrape.Fabric(1000 / n), (0, 0, 0), (1, 0, 0))
    node, angle = hypar_net(k, 1.0, 2 * n)
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    assert np.linalg.norm(nodes_at(net, i, j) / 1000 - node[::2, ::2], axis=-1).max() < 5e-4
    cells = np.degrees(np.pi / 2 - angle[1::2, 1::2])
    assert cells_at(net, shear_deg(net), i[:-1, :-1], j[:-1, :-1]) == pytest.approx(cells, abs=0.1)


@pytest.mark.parametrize(
    ("half", "azimuth", "eta", "spacing"),
    [(15, 40, 10, (50, 50)), (45, 0, 63, (30, 55)), (70, -20, -35, (44, 44))],
)
def test_cone(half, azimuth, eta, spacing):
    half, azimuth, eta = np.radians([half, azimuth, eta])
    s, c = np.sin(half), np.cos(half)
    ruling = np.array([s * np.cos(azimuth), s * np.sin(azimuth), c])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    net = meshdrape.drape(
        cone(half_angle=half, n=2400).reversed().mould(), meshdrape.Fabric(spacing), 1000 * ruling,
        np.cos(eta) * ruling + np.sin(eta) * across, extent=(400, 400, 400, 400),
    )  # fmt: skip
    reference = rolled_on_cone(planar_lattice(net, (0, 0, 0), eta), half, 1000.0, azimuth)
    _held(net, reference, 2e-2)


@pytest.mark.parametrize(
    ("radius", "eta", "spacing"), [(300.0, 62, (41, 41)), (1000.0, 20, (20, 60)), (150.0, -45, (30, 30))]
)
def test_cylinder(radius, eta, spacing):
    eta, azimuth = np.radians([eta, 25])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    seed = radius * np.array([np.cos(azimuth), np.sin(azimuth), 0])
    net = meshdrape.drape(
        cylinder(radius=radius, n=2400).reversed().mould(), meshdrape.Fabric(spacing), seed,
        np.cos(eta) * np.array([0, 0, 1.0]) + np.sin(eta) * across, extent=(400, 400, 400, 400),
    )  # fmt: skip
    _held(net, rolled_on_cylinder(planar_lattice(net, (0, 0, 0), eta), radius, azimuth), 2e-2)


def _held(net, reference, tolerance):
    on_mould = net.node_status == meshdrape.NodeStatus.PLACED
    assert on_mould.sum() > 100
    assert np.linalg.norm(net.node_position - reference, axis=-1)[on_mould].max() < tolerance
    on_cells = meshdrape.measure(net).cell_touches_mould
    assert np.abs(shear_deg(net)[on_cells]).max() < 1e-6


@pytest.mark.parametrize(
    ("side", "spacing", "first"), [(1000.0, 61.0, 12.0), (400.0, 100.0, 44.0), (2000.0, 75.0, 80.0)]
)
def test_cube_corner(side, spacing, first):
    turn = np.radians(first)
    net = meshdrape.drape(
        cube_corner(side).mould(), meshdrape.Fabric(spacing), (0, 0, 0), (np.cos(turn), np.sin(turn), 0)
    )
    n = 3
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    assert nodes_at(net, i, j) == pytest.approx(cube_corner_net(spacing, n, turn, 0), abs=1e-9 * side)
    shear = shear_deg(net)
    assert np.abs(np.abs(shear[np.isfinite(shear)]) - 22.5).max() < 1e-6
