"""Drapes asked of meshdrape through its public names alone, held against nets computed without any mesh.

`nets.npz` holds reference nodes in metres: closed forms on the sphere, the cone, the cylinder and the cube's
corner; the unrolled wing and spar of section 3.4 of Barton et al., New Techniques for Composite Wing Manufacture; a
high-precision solution on the hypar. None of them was made by this program. The wing's cells are tagged 1 where rows
start on the left ribbon and 2 where they come from the wing.
"""

from pathlib import Path

import numpy as np
import pytest
from moulds import Mesh, cone, cube_corner, cylinder, hypar, icosphere, wing_spar

import meshdrape

METRE = 1000.0  # references are in metres, meshdrape works in millimetres
REFERENCE = np.load(Path(__file__).with_name("nets.npz"))


def drape(mesh: Mesh, spacing, seed, direction):
    """Lengths in metres but for the mesh."""
    return meshdrape.drape(
        mesh.mould(),
        meshdrape.Fabric(spacing=spacing * METRE),
        seed=tuple(np.multiply(seed, METRE)),
        direction=direction,
    )


def off_reference(net, reference, origin):
    """Largest distance of the net's nodes from a reference lattice, m, and the share of it that the net has.

    The lattice may be run through in any of its eight senses: which way the weft goes depends on the mould's normal.
    """
    best = (np.inf, None)
    i0, j0 = net.seed_index
    position = net.node_position / METRE
    a = np.arange(reference.shape[0]) - origin[0]
    b = np.arange(reference.shape[1]) - origin[1]
    for swap in (False, True):
        for sa in (1, -1):
            for sb in (1, -1):
                i, j = np.meshgrid(sa * a, sb * b, indexing="ij")
                i, j = (i0 + j, j0 + i) if swap else (i0 + i, j0 + j)
                inside = (i >= 0) & (j >= 0) & (i < position.shape[0]) & (j < position.shape[1])
                found = np.full(reference.shape, np.nan)
                found[inside] = position[i[inside], j[inside]]
                off = np.linalg.norm(found - reference, axis=-1)
                score = np.nanmedian(off) if np.isfinite(off).any() else np.inf
                if score < best[0]:
                    best = (score, off)
    assert best[1] is not None
    return np.nanmax(best[1]), np.isfinite(best[1]).mean()


def shear_deg(net):
    return np.degrees(np.abs(meshdrape.measure(net).cell_shear))


def test_fold():
    """The sheet is started on a row that stays on the wing; nodes to 0.1 mm, shear to 0.05 degrees."""
    y = np.linspace(0, 1350, 2001)
    mesh = wing_spar(lambda t: 0.2 * t**2 / METRE, lambda t: 0.4 * t**2 / METRE, y, 3000, 1200)
    row = REFERENCE["fold_row"][0]
    net = drape(mesh, 0.05, ((row + 0.5) * 0.05, 0, 0), (0, 1, 0))
    worst, present = off_reference(net, REFERENCE["fold_node"], (0, 0))
    assert worst < 1e-4
    assert present == 1.0
    shear, region, (i0, j0) = shear_deg(net), REFERENCE["fold_region"], net.seed_index
    tagged = (region == 1) | (region == 2)
    off = []
    for sense, first in ((1, 0), (-1, -1)):
        i, j = np.meshgrid(
            i0 + np.arange(region.shape[0]), j0 + first + sense * np.arange(region.shape[1]), indexing="ij"
        )
        if ((i < shear.shape[0]) & (j >= 0) & (j < shear.shape[1]))[tagged].all():
            off.append(np.abs(shear[i[tagged], j[tagged]] - np.degrees(np.abs(REFERENCE["fold_shear"][tagged]))).max())
    assert min(off) < 0.05


def test_skew():
    y = 1000 * np.array([0.0, 0.31, 0.77, 1.3, 2.0])
    net = drape(wing_spar(lambda t: 0 * t, lambda t: 0.12 * t, y, 2500, 900), 0.04, (1.62, 0, 0), (0, 1, 0))
    shear = shear_deg(net)
    assert np.nanmax(shear) < 1e-6
    assert np.isfinite(shear).sum() > 1500


def test_origami():
    def profile(t):
        return 0.3 * t**2 / METRE

    net = drape(
        wing_spar(profile, profile, np.linspace(0, 1000, 301), 2000, 800),
        0.03,
        (1.2, 0.5, 0.075),
        (0, 1, 0.3),
    )
    shear = shear_deg(net)
    assert np.nanmax(shear) < 1e-4
    assert np.isfinite(shear).sum() > 1500


def test_sphere():
    net = drape(icosphere(6), 0.05, (0, 0, 1), (1, 0, 0))
    worst, present = off_reference(net, REFERENCE["sphere_node"], (0, 0))
    assert worst < 4e-3
    assert present == 1.0
    i0, j0 = net.seed_index
    want = 90 - np.degrees(REFERENCE["sphere_corner_angle"].mean(-1))[19, 19]
    assert shear_deg(net)[i0 + 19, j0 + 19] == pytest.approx(want, abs=0.7)


@pytest.mark.slow
@pytest.mark.parametrize("n", [399, 400], ids=["across_triangles", "through_vertices"])
def test_hypar(n):
    """With an even number of cells the start fibres run along mesh edges and through vertices."""
    net = drape(hypar(1.0, 1.3, n), 0.05, (0, 0, 0), (1, 0, 0))
    worst, present = off_reference(net, REFERENCE["hypar_node"], (0, 0))
    assert worst < 5e-4
    assert present == 1.0


def test_cone():
    azimuth, eta, half = np.radians([20, 30, 25])
    ruling = np.array([np.sin(half) * np.cos(azimuth), np.sin(half) * np.sin(azimuth), np.cos(half)])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    net = drape(cone(n=2400).reversed(), 0.05, ruling, np.cos(eta) * ruling + np.sin(eta) * across)
    worst, present = off_reference(net, REFERENCE["cone_node"], (8, 8))
    assert worst < 2e-5
    assert present == 1.0
    assert np.nanmax(shear_deg(net)) < 0.01


def test_cylinder():
    azimuth, eta = np.radians([10, 35])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    seed = 0.5 * np.array([np.cos(azimuth), np.sin(azimuth), 0])
    net = drape(cylinder(n=2400), 0.05, seed, np.cos(eta) * np.array([0, 0, 1.0]) + np.sin(eta) * across)
    worst, present = off_reference(net, REFERENCE["cylinder_node"], (8, 8))
    assert worst < 2e-5
    assert present == 1.0
    assert np.nanmax(shear_deg(net)) < 0.01


def test_cube_corner():
    net = drape(cube_corner(), 0.1, (0, 0, 0), (1, 0, 0))
    shear = shear_deg(net)
    cells = shear[np.isfinite(shear)]
    assert len(cells) > 100
    assert np.abs(cells - 22.5).max() < 1e-6
    placed = net.node_position[np.isfinite(net.node_position).all(-1)] / METRE
    far = [np.linalg.norm(placed - node, axis=-1).min() for node in REFERENCE["cube_node"].reshape(-1, 3)]
    assert max(far) < 1e-8
