"""Developable moulds facetted along their rulings: the polyhedron unrolls, so there is no shear at any mesh size.

Source: Barton et al., New Techniques for Composite Wing Manufacture, section 7.1. Erratum to its last sentence, which
allows only a cylinder with fibres along its generators: any developable is covered without shear from two geodesics
at right angles. The cone's nodes are closed forms by unrolling.
"""

import numpy as np
import pytest
from lattice import nodes_at, placed, planar_lattice, shear_deg
from moulds import cone, cylinder
from references import rolled_on_cone, rolled_on_cylinder

import meshdrape

HALF_ANGLE, SLANT, AZIMUTH, ETA = np.radians(25), 1000.0, np.radians(20), np.radians(30)
# spacing 50, fibre 1 at 30 degrees from the ruling; metres
PUBLISHED_NODES = {(8, 0): (0.440725, 0.369711, 1.233651), (0, 8): (0.092867, 0.356534, 0.790101)}


def cone_directions(half_angle, azimuth):
    """Unit vectors at an azimuth: down the ruling and round the axis."""
    s, c = np.sin(half_angle), np.cos(half_angle)
    return (
        np.array([s * np.cos(azimuth), s * np.sin(azimuth), c]),
        np.array([-np.sin(azimuth), np.cos(azimuth), 0.0]),
    )


def drape_cone(half_angle=HALF_ANGLE, azimuth=AZIMUTH, eta=ETA, spacing=50.0, n=2400):
    # normals towards the axis, so that the weft runs towards larger azimuth
    mould = cone(half_angle=half_angle, n=n).reversed().mould()
    ruling, across = cone_directions(half_angle, azimuth)
    return meshdrape.drape(
        mould, meshdrape.Fabric(spacing), SLANT * ruling, np.cos(eta) * ruling + np.sin(eta) * across
    )


def on_smooth(net, reference, extent):
    """Largest distance, mm, from a reference over the nodes on the mould no farther than `extent` from the seed."""
    near = (net.node_status == 0) & (np.linalg.norm(net.node_position - net.seed, axis=-1) < extent)
    assert near.sum() > 100
    return np.linalg.norm(net.node_position - reference, axis=-1)[near].max()


def test_nodes_of_the_cone_are_the_published_ones():
    """Tolerance 2 h + (h / R) L: h chord tolerance, R radius, L distance from the seed; and the digits given."""
    net = drape_cone()
    h = 1900 * np.sin(HALF_ANGLE) * (4.2 / 2400) ** 2 / 8
    for (i, j), node in PUBLISHED_NODES.items():
        assert np.linalg.norm(nodes_at(net, i, j) - 1000 * np.array(node)) < 2 * h + 0.4 * h / 0.4 + 1e-3


@pytest.mark.parametrize(
    ("half_angle", "azimuth", "eta"), [(25, 20, 30), (25, -40, 0), (40, 15, 75), (10, 30, -50), (60, 10, 45)]
)
def test_cone(half_angle, azimuth, eta):
    half_angle, azimuth, eta = np.radians([half_angle, azimuth, eta])
    net = drape_cone(half_angle, azimuth, eta)
    h = 1900 * np.sin(half_angle) * (4.2 / 2400) ** 2 / 8
    radius = 300 * np.sin(half_angle)
    reference = rolled_on_cone(planar_lattice(net, (0, 0, 0), eta), half_angle, SLANT, azimuth)
    assert on_smooth(net, reference, 500) < 2 * h + h / radius * 500
    assert np.nanmax(np.abs(shear_deg(net))) < 1e-7


@pytest.mark.parametrize("eta", [0, 35, 45, 90, -20])
@pytest.mark.parametrize("radius", [500.0, 200.0])
def test_cylinder(radius, eta):
    eta, azimuth, n = np.radians(eta), np.radians(10), 2400
    mould = cylinder(radius=radius, n=n).reversed().mould()
    seed = radius * np.array([np.cos(azimuth), np.sin(azimuth), 0])
    warp = np.cos(eta) * np.array([0, 0, 1.0]) + np.sin(eta) * np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), seed, warp)
    h = radius * (3.6 / n) ** 2 / 8
    reference = rolled_on_cylinder(planar_lattice(net, (0, 0, 0), eta), radius, azimuth)
    assert on_smooth(net, reference, 500) < 2 * h + h / radius * 500
    assert np.nanmax(np.abs(shear_deg(net))) < 1e-4


@pytest.mark.parametrize("n", [7, 40, 333])
@pytest.mark.parametrize("spacing", [7.0, 50.0, 160.0])
def test_no_shear_at_any_mesh_size(n, spacing):
    """Spacing from far below to far above a facet's width, prism and pyramid alike."""
    for mesh, seed, direction in (
        (cylinder(n=n, half_length=400), (490.0, 60.0, 11.0), (0.2, 0.5, 0.9)),
        (cone(n=n), (430.0, 10.0, 880.0), (0.4, 0.5, 0.6)),
    ):
        distance = mesh.mould().surface.closest_point(seed)[1]
        fabric = meshdrape.Fabric(max(spacing, distance))
        net = meshdrape.drape(mesh.mould(), fabric, seed, direction, extent=(600, 600, 600, 600))
        on_mould = meshdrape.measure(net).cell_touches_mould
        assert on_mould.sum() > 10
        assert np.abs(shear_deg(net)[on_mould]).max() < 1e-7
        assert not (placed(net) & ~np.isfinite(net.node_position).all(axis=-1)).any()
