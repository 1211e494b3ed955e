"""What must not change a net, or change it in a known way."""

from dataclasses import replace

import numpy as np
import pytest
from cases import CASES, Case
from hypothesis import given, settings
from hypothesis import strategies as st
from lattice import cells_at, nodes_at, offsets, planar_lattice, shear_deg, statuses_at
from moulds import Mesh, cube_corner, grid_triangles, hypar, icosphere, plate, rotation, tube

import meshdrape

# hills and valleys, a crease, a dome, a saddle vertex, a corner with the seed on it, cells far larger than triangles
NAMES = [
    "hills", "hills, long cells", "wing and spar", "cap, cells above triangles", "cap, cells far above triangles",
    "foot of a step, from the floor", "cube's corner, from beside it", "plate with a hole", "double curved",
]  # fmt: skip
FINE = 1e-9  # of the spacing


def compare(net, other, place=lambda p: p, index=lambda i, j: (i, j), tolerance=FINE, scale=1.0):
    """Assert that `other` has the nodes and statuses of `net`, moved by `place`, at the indices `index` gives."""
    i, j = offsets(net)
    oi, oj = index(i, j)
    assert np.array_equal(statuses_at(other, oi, oj), net.node_status)
    assert np.count_nonzero(other.node_status <= 1) == np.count_nonzero(net.node_status <= 1)
    off = np.linalg.norm(nodes_at(other, oi, oj) - place(net.node_position), axis=-1)
    there = np.isfinite(off)
    assert np.array_equal(there, net.node_status <= 1)
    assert off[there].max() < tolerance * scale * net.fabric.shortest


def compare_shear(net, other, sign=1, index=lambda i, j: (i, j)):
    i, j = offsets(net)
    found = cells_at(other, shear_deg(other), *index(i[:-1, :-1], j[:-1, :-1]))
    assert found == pytest.approx(sign * shear_deg(net), abs=1e-6, nan_ok=True)


DRAPED = {}


def draped(name):
    if name not in DRAPED:
        DRAPED[name] = CASES[name].drape()
    return DRAPED[name]


UNIT = st.floats(-1, 1)


@settings(max_examples=15)
@given(st.sampled_from(NAMES), st.tuples(UNIT, UNIT, UNIT), st.floats(0.1, 6), st.tuples(UNIT, UNIT, UNIT))
def test_rigid_motion(name, axis, angle, shift):
    turn = rotation(np.add(axis, [0, 0, 2]), angle)
    shift = 500 * np.array(shift)
    case = CASES[name]
    moved = replace(
        case,
        mesh=case.mesh.moved(turn, shift),
        seed=tuple(turn @ case.seed + shift),
        direction=tuple(turn @ case.direction),
    )
    compare(draped(name), moved.drape(), place=lambda p: p @ turn.T + shift)


@pytest.mark.parametrize("scale", [1e-3, 0.37, 1000.0])
@pytest.mark.parametrize("name", NAMES)
def test_scale(name, scale):
    case = CASES[name]
    spacing = tuple(scale * s for s in case.spacing) if isinstance(case.spacing, tuple) else scale * case.spacing
    larger = replace(
        case,
        mesh=case.mesh.moved(np.eye(3), scale=scale),
        spacing=spacing,
        seed=tuple(scale * v for v in case.seed),
    )
    net, other = draped(name), larger.drape()
    compare(net, other, place=lambda p: scale * p, scale=scale)
    compare_shear(net, other)


@pytest.mark.parametrize("name", NAMES)
def test_numbering_of_vertices_and_of_triangles_and_their_corners(name):
    case, rng = CASES[name], np.random.default_rng(7)
    vertices, triangles = case.mesh
    order = rng.permutation(len(vertices))
    where = np.argsort(order)
    turned = triangles[
        np.arange(len(triangles))[:, None], (np.arange(3) + rng.integers(3, size=(len(triangles), 1))) % 3
    ]
    compare(draped(name), case.with_mesh(Mesh(vertices[order], where[triangles])).drape())
    compare(draped(name), case.with_mesh(Mesh(vertices, triangles[rng.permutation(len(triangles))])).drape())
    compare(draped(name), case.with_mesh(Mesh(vertices, turned)).drape())


MIRROR = np.diag([1.0, -1.0, 1.0])


def mirrored(case: Case, flip: bool) -> Case:
    mesh = case.mesh.moved(MIRROR)
    return replace(
        case,
        mesh=mesh.reversed() if flip else mesh,
        seed=tuple(MIRROR @ case.seed),
        direction=tuple(MIRROR @ case.direction),
    )


@pytest.mark.parametrize("name", NAMES)
def test_mirrored_with_its_winding_flipped_it_reverses_the_weft(name):
    """Outside stays outside; the right-handed weft goes the other way, and shear changes its sign."""
    net, other = draped(name), mirrored(CASES[name], flip=True).drape()
    compare(net, other, place=lambda p: p @ MIRROR, index=lambda i, j: (i, -j))
    # the cell (i, j) is now that between the nodes -j and -j - 1
    compare_shear(net, other, sign=-1, index=lambda i, j: (i, -1 - j))


@pytest.mark.parametrize("name", NAMES)
def test_mirrored_vertices_alone_change_neither(name):
    """The normal turns inward, and the two changes cancel."""
    net, other = draped(name), mirrored(CASES[name], flip=False).drape()
    compare(net, other, place=lambda p: p @ MIRROR)
    compare_shear(net, other)


# where the sheet ends at a corner it encloses, the search that fails there need not fail alike from both sides
@pytest.mark.parametrize("name", NAMES)
def test_warp_and_weft_swapped(name):
    """Warp along the old weft: the old node (i, j) is the new (j, -i), and shear changes its sign (square cloth)."""
    net, case = draped(name), CASES[name]
    weft = np.cross(net.surface.face_normal[net.start.face[0]], net.direction)
    spacing = case.spacing[::-1] if isinstance(case.spacing, tuple) else case.spacing
    other = replace(case, direction=tuple(weft), spacing=spacing).drape()
    compare(net, other, index=lambda i, j: (j, -i), tolerance=1e-8)
    compare_shear(net, other, sign=-1, index=lambda i, j: (j, -1 - i))


@pytest.mark.parametrize("name", CASES)
def test_threads_change_not_a_bit(name):
    one, many = CASES[name].drape(threads=1), CASES[name].drape(threads=5)
    assert np.array_equal(one.node_status, many.node_status)
    assert np.array_equal(one.node_position, many.node_position, equal_nan=True)
    assert np.array_equal(one.warp_direction, many.warp_direction, equal_nan=True)
    assert np.array_equal(one.weft_direction, many.weft_direction, equal_nan=True)
    assert np.array_equal(meshdrape.measure(one).cell_shear, meshdrape.measure(many).cell_shear, equal_nan=True)


def test_threads_change_not_a_bit_of_a_net_of_many_tiles():
    case = Case(hypar(0.8, 1.0, 41), 3.0, CASES["hypar"].seed, (1, 0.3, 0))
    case = replace(
        case,
        seed=tuple(case.mesh.mould().surface.closest_point((120, -90, -9))[0].position(case.mesh.mould().surface)),
    )
    one, many = case.drape(threads=1), case.drape(threads=4)
    assert one.node_status.size > 300_000
    assert np.array_equal(one.node_status, many.node_status)
    assert np.array_equal(one.node_position, many.node_position, equal_nan=True)


def test_twice_the_same_is_the_same():
    for name in ("steep hills", "closed sphere", "foot of a step, from the vertex"):
        first, second = CASES[name].drape(), CASES[name].drape()
        assert np.array_equal(first.node_position, second.node_position, equal_nan=True)
        assert np.array_equal(first.node_status, second.node_status)


@pytest.mark.parametrize(("spacing", "degrees"), [
    ((5.0, 5.0), 90), ((11.0, 4.0), 90), ((3.0, 10.0), 90), ((7.0, 7.0), 60), ((7.0, 7.0), 120), ((8.0, 5.0), 75),
])  # fmt: skip
@pytest.mark.parametrize("warp_at", [0.0, 0.4, -2.0])
def test_plane_carries_the_lattice_of_the_fabric(spacing, degrees, warp_at):
    """Any spacings, any initial angle: no shear, every node where the flat sheet has it."""
    fabric = meshdrape.Fabric(spacing, initial_angle=np.radians(degrees))
    seed = (12.3, -7.7, 0)
    net = meshdrape.drape(plate().mould(), fabric, seed, (np.cos(warp_at), np.sin(warp_at), 0))
    expected = planar_lattice(net, seed, warp_at, np.radians(degrees))
    here = net.node_status == meshdrape.NodeStatus.PLACED
    assert here.sum() > 200
    assert net.node_position[here] == pytest.approx(expected[here], abs=1e-9)
    inside = (np.abs(expected[..., 0]) < 99.999) & (np.abs(expected[..., 1]) < 69.999)
    assert np.array_equal(inside, here)
    assert np.nanmax(np.abs(shear_deg(net))) < 1e-9


@pytest.mark.parametrize("degrees", [60, 110])
def test_cloth_that_is_not_square_on_a_sphere(degrees):
    """Edges exact; shear counted from the initial angle, so next to none near the seed, of both signs far out."""
    fabric = meshdrape.Fabric(60.0, initial_angle=np.radians(degrees))
    net = meshdrape.drape(icosphere(4).mould(), fabric, (0, 0, 1000), (1, 0.2, 0), extent=(700, 700, 700, 700))
    found = meshdrape.audit(net, edges=200)
    assert found.max_relative_error < 1e-9
    shear = shear_deg(net)
    i0, j0 = net.seed_index
    assert np.abs(shear[i0 - 1 : i0 + 1, j0 - 1 : j0 + 1]).max() < 0.6
    assert shear[i0 + 8, j0 + 8] > 5
    assert shear[i0 - 9, j0 + 8] < -5


def test_symmetric_mould_gives_a_symmetric_net_node_for_node():
    """Fibres along edges through vertices. The hypar is its own image under a half turn about either ruling."""
    net = meshdrape.drape(hypar(1.0, 1.0, 24, symmetric=True).mould(), meshdrape.Fabric(70.0), (0, 0, 0), (1, 0, 0))
    i, j = offsets(net)
    for flip, index in (
        (np.diag([1, -1, -1]), (i, -j)),
        (np.diag([-1, 1, -1]), (-i, j)),
        (np.diag([-1, -1, 1]), (-i, -j)),
    ):
        assert np.array_equal(statuses_at(net, *index), net.node_status)
        assert nodes_at(net, *index) == pytest.approx(net.node_position @ flip, abs=1e-9 * 70, nan_ok=True)
    # and under swapping the two
    assert nodes_at(net, j, i) == pytest.approx(net.node_position[..., [1, 0, 2]], abs=1e-9 * 70, nan_ok=True)


def test_symmetric_corner_gives_a_symmetric_net():
    """From the cube's corner along the diagonal of a face: mirrored in the plane through it and the far edge."""
    net = meshdrape.drape(cube_corner(300, 2).mould(), meshdrape.Fabric(23.0), (0, 0, 0), (1, 1, 0))
    i, j = offsets(net)
    assert nodes_at(net, i, -j) == pytest.approx(net.node_position[..., [1, 0, 2]], abs=1e-8, nan_ok=True)


def test_tube_from_every_facet():
    """Turned by whole facets under the seed, a prism is the same mould."""
    mesh, step = tube(60, 200, 24), 2 * np.pi / 24
    start = 60 * np.cos(step / 2) * np.array([np.cos(step / 2), np.sin(step / 2), 0])
    first = meshdrape.drape(mesh.mould(), meshdrape.Fabric(9.0), start, (0, 0.4, 1))
    for facets in (1, 7, 12):
        turn = rotation([0, 0, 1], facets * step)
        other = meshdrape.drape(mesh.mould(), meshdrape.Fabric(9.0), turn @ start, turn @ [0, 0.4, 1])
        compare(first, other, place=lambda p, turn=turn: p @ turn.T)


def test_cloth_over_a_crooked_hole_does_not_hang_on_numbers_or_place():
    """A hole in hills that is seen whole from nowhere within: what fills it is the same triangles."""
    rng = np.random.default_rng(3)
    side = np.linspace(0, 600, 15)
    vertices = np.stack([*np.meshgrid(side, side, indexing="ij"), np.zeros((15, 15))], axis=-1).reshape(-1, 3)
    vertices += rng.normal(size=vertices.shape) * [6, 6, 5]
    triangles = grid_triangles(14, 14)
    x, y = np.abs(vertices[triangles].mean(axis=1)[:, :2] - [300, 300]).T
    x2, y2 = np.abs(vertices[triangles].mean(axis=1)[:, :2] - [400, 360]).T
    triangles = triangles[~((x < 140) & (y < 40) | (x2 < 40) & (y2 < 110))]
    used, triangles = np.unique(triangles, return_inverse=True)
    case = Case(Mesh(vertices[used], triangles.reshape(-1, 3)), 15.0, (150, 140, 0), (1, 0.3, 0))
    net = case.drape()
    for _ in range(3):
        order = rng.permutation(len(case.mesh.triangles))
        compare(net, replace(case, mesh=Mesh(case.mesh.vertices, case.mesh.triangles[order])).drape())
    turn = rotation([0.3, -0.5, 0.8], 2.1)
    moved = replace(
        case, mesh=Mesh(case.mesh.vertices @ turn.T, case.mesh.triangles), seed=turn @ case.seed,
        direction=turn @ case.direction,
    )  # fmt: skip
    compare(net, moved.drape(), place=lambda p: p @ turn.T)
