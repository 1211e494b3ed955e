"""The samples' STEP files, tessellated at the default tolerances, against the published numbers of the shapes.

Source: Barton et al., New Techniques for Composite Wing Manufacture, sections 3.4, 7 and 7.3; the numbers and the
references are those of the tests beside this one, which build their meshes themselves. Tolerances follow from the
chord tolerance h that each mould was read at.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from creased import read
from lattice import cells_at, nodes_at, planar_lattice, shear_deg
from references import (
    Crease,
    CreaseNet,
    cube_corner_net,
    hypar_net,
    rolled_on_cone,
    rolled_on_cylinder,
    sphere_angle,
    sphere_net,
)
from test_real_wing import DEVIATIONS, HEIGHT, PUBLISHED, SPACING, SPAN, nodes_inside, wing, wing_slope

import meshdrape

SAMPLES = Path(__file__).parents[2] / "samples"
NAMES = ["cone", "cube_corner", "cylinder", "hemisphere", "hypar", "krogh_double_curved", "wing_spar"]


@cache
def sample(name, **tolerances):
    return meshdrape.read_mould(SAMPLES / f"{name}.step", **tolerances)


def seed_on(mould, near):
    return mould.surface.closest_point(near)[0].position(mould.surface)


def outward(mould, seed):
    """The mould's normal at a seed."""
    return mould.surface.face_normal[mould.surface.closest_point(seed)[0].face]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_every_edge_is_exact_and_no_node_is_lost(name):
    mould = sample(name)
    spacing = float(np.linalg.norm(mould.size)) / 60
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing))
    found = meshdrape.audit(net, edges=150)
    assert found.n_edges + found.n_through_vertex > 100
    assert found.max_relative_error < 1e-9
    assert net.count(meshdrape.NodeStatus.NOT_CONVERGED) == 0


# --- wing and spar ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("h", [None, 0.002])
def test_real_wing_with_its_parabola(h):
    """Crease of two curved cylinders: nodes to 1.5 h, shear to min(sqrt(2 kappa h), h / spacing) rad + 0.01 degrees.

    The seed's column runs down the very end of the spar, where the first facet's direction may be off by as much.
    """
    mould = (
        sample("wing_spar") if h is None else sample("wing_spar", chord_tolerance=h, angle_tolerance=np.radians(0.02))
    )
    h = mould.chord_tolerance
    f, slope = DEVIATIONS["parabola"]
    crease = Crease((wing, wing_slope), (lambda y: wing(y) + f(y), lambda y: wing_slope(y) + slope(y)), SPAN)
    edge = float(crease.profile[1](np.float64(SPAN)))
    n = int(crease.arc[0](SPAN) / SPACING) + 1
    reference = CreaseNet(crease, SPACING, n, -int(1.2 / SPACING), int((1.2 + edge) / SPACING) + 4, 0.0)
    row = int(reference.x[-1] / SPACING)
    net = meshdrape.drape(
        mould, meshdrape.Fabric(1000 * SPACING), (1000 * (row + 0.5) * SPACING, 0, 0), (0, 1, wing_slope(0))
    )
    draped = read(net, reference, row)
    kappa = (0.059 + 0.1 / 14) / 1000
    slack = min(np.sqrt(2 * kappa * h), h / (1000 * SPACING)) + np.radians(0.01)
    inside = nodes_inside(reference)
    assert draped.node_error(inside) * 1000 < 1.5 * h + slack * 1000 * HEIGHT
    within = np.all([inside[a : a - 1 or None, b : b - 1 or None] for a in (0, 1) for b in (0, 1)], axis=0)
    for region, published in ((2, PUBLISHED["parabola"][2]), (1, PUBLISHED["parabola"][3])):
        cells = within & (reference.region == region)
        assert draped.shear_error(cells) < slack
        assert np.degrees(np.abs(draped.shear[cells]).max()) == pytest.approx(published, abs=np.degrees(slack))


def test_largest_shear_is_told_by_its_face():
    """Of the draped wing it lies on the spar, face 2 of the file, or over the crease."""
    mould = sample("wing_spar")
    assert [(face.id, face.name) for face in mould.cad_faces] == [(1, "wing"), (2, "spar")]
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), (2500, 30, 8), (0, 1, 0.2))
    measures = meshdrape.measure(net)
    assert measures.max_shear_face in (1, 2)
    _, y, z = measures.max_shear_position
    assert z < 1000 * float(wing(y / 1000)) + 50 or measures.max_shear_face == 1


# --- developable -----------------------------------------------------------------------------------------------------


def unrolled_held(net, reference, extent, tolerance):
    near = (net.node_status == 0) & (np.linalg.norm(net.node_position - net.seed, axis=-1) < extent)
    assert near.sum() > 100
    assert np.linalg.norm(net.node_position - reference, axis=-1)[near].max() < tolerance
    on_mould = meshdrape.measure(net).cell_touches_mould
    assert np.abs(shear_deg(net)[on_mould]).max() < 0.01


def test_cylinder():
    """Nodes 2 h + (h / R) L, shear 0.01 degrees."""
    mould, radius, eta = sample("cylinder"), 500.0, np.radians(35)
    x, y, _ = seed = seed_on(mould, mould.vertices.mean(axis=0))
    azimuth = np.arctan2(y, x)
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    warp = np.cos(eta) * np.array([0, 0, 1.0]) + np.sin(eta) * across
    net = meshdrape.drape(mould, meshdrape.Fabric(25.0), seed, warp)
    side = -1 if outward(mould, seed) @ [x, y, 0] > 0 else 1
    reference = rolled_on_cylinder(planar_lattice(net, (0, 0, 0), eta, side * np.pi / 2), radius, azimuth)
    reference = reference + np.array([0, 0, seed[2]])
    h = mould.chord_tolerance
    unrolled_held(net, reference, 400, 2 * h + h / radius * 400)


def test_cone():
    mould, half, eta = sample("cone"), np.radians(25), np.radians(30)
    seed = seed_on(mould, mould.vertices.mean(axis=0))
    azimuth, slant = np.arctan2(seed[1], seed[0]), float(np.linalg.norm(seed))
    s, c = np.sin(half), np.cos(half)
    ruling = np.array([s * np.cos(azimuth), s * np.sin(azimuth), c])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    net = meshdrape.drape(mould, meshdrape.Fabric(25.0), seed, np.cos(eta) * ruling + np.sin(eta) * across)
    side = -1 if outward(mould, seed) @ np.cross(across, ruling) > 0 else 1
    reference = rolled_on_cone(planar_lattice(net, (0, 0, 0), eta, side * np.pi / 2), half, slant, azimuth)
    h = mould.chord_tolerance
    unrolled_held(net, reference, 400, 2 * h + h / (300 * s) * 400 + h)


# --- doubly curved ---------------------------------------------------------------------------------------------------


def test_hemisphere():
    """Nodes 3 h + 3 (h / R)^0.75 L; shear max 10, rms 2 (h / R)^0.75 rad; the discrete net's own 0.0141 degrees."""
    mould, radius, n = sample("hemisphere"), 500.0, 20
    net = meshdrape.drape(mould, meshdrape.Fabric(0.05 * radius), (0, 0, radius), (1, 0, 0))
    noise = (mould.chord_tolerance / radius) ** 0.75
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    reference = sphere_net(radius, 0.05 * radius, n)
    placed = nodes_at(net, *np.indices((n + 1, n + 1)))
    there = reference[..., 2] > 0
    off = np.linalg.norm(placed - reference, axis=-1)[there]
    assert off.max() < 3 * mould.chord_tolerance + 3 * noise * 1.5 * radius
    smooth = np.pi / 2 - sphere_angle((i + 0.5) * (j + 0.5) * 0.0025)
    cells = there[:-1, :-1] & there[1:, 1:]
    wrong = (cells_at(net, meshdrape.measure(net).cell_shear, i, j) - smooth)[cells]
    assert np.abs(wrong).max() < 10 * noise + np.radians(0.0141)
    assert np.sqrt(np.mean(wrong**2)) < 2 * noise + np.radians(0.0141)


def test_hypar():
    mould = sample("hypar")
    seed = seed_on(mould, (0, 0, 0))
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), seed, (1, 0, 0))
    node, angle = hypar_net(1.0, 1.0, 40)
    noise = (mould.chord_tolerance / 1000) ** 0.75
    i, j = np.meshgrid(np.arange(21), np.arange(21), indexing="ij")
    off = np.linalg.norm(nodes_at(net, i, j) / 1000 - node[::2, ::2], axis=-1)
    assert off.max() < 3 * mould.chord_tolerance / 1000 + 3 * noise * np.sqrt(2) + 1.1e-4
    cells = cells_at(net, meshdrape.measure(net).cell_shear, i[:-1, :-1], j[:-1, :-1])
    wrong = cells - (np.pi / 2 - angle[1::2, 1::2])
    assert np.abs(wrong).max() < 10 * noise + np.radians(0.0141)
    assert np.sqrt(np.mean(wrong**2)) < 2 * noise + np.radians(0.0141)
    assert np.degrees(cells[-1, -1]) == pytest.approx(-26.66743, abs=2.0)


@pytest.mark.parametrize("degrees", [0, 33])
def test_cube_corner(degrees):
    """The polyhedron is exact: nodes to 1e-9 of the extent, shear to 1e-6 degrees."""
    turn = np.radians(degrees)
    net = meshdrape.drape(sample("cube_corner"), meshdrape.Fabric(100.0), (0, 0, 0), (np.cos(turn), np.sin(turn), 0))
    shear = shear_deg(net)
    assert np.abs(np.abs(shear[np.isfinite(shear)]) - 22.5).max() < 1e-6
    i, j = np.meshgrid(np.arange(7), np.arange(7), indexing="ij")
    into_octant = outward(sample("cube_corner"), (500, 500, 0))[2] > 0
    # seen from inside the cube the unfolded angle about the corner runs the other way
    quadrant, si, sj = (0, 1, 1) if into_octant else (3, 1, 1)
    node = cube_corner_net(100.0, 6, turn, quadrant)
    found = nodes_at(net, si * i, sj * j) if into_octant else nodes_at(net, j, i)
    assert found == pytest.approx(node, abs=1e-6)
