"""Start fibres that turn at a crease."""

import re

import numpy as np
import pytest
from lattice import nodes_at, offsets, placed
from moulds import Mesh, cube_corner, cylinder, grid, hypar, plate, wing_spar

import meshdrape
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.start.crease import crease_edges


def roof(angle, n=6):
    """Two planes that meet at x = 0 in a ridge whose normals are `angle` apart; the left one level."""
    x, y = np.linspace(-300, 300, 2 * n + 1), np.linspace(-200, 200, n + 1)
    return grid(x, y, lambda x, y: (np.where(x < 0, x, x * np.cos(angle)), y, np.where(x < 0, 0.0, -x * np.sin(angle))))


def drape(mesh, *args, **options):
    return meshdrape.drape(mesh.mould(), meshdrape.Fabric(20.0), *args, **options)


def unfolded(position):
    """A place on a roof, of any angle, in the plane of its level side."""
    x, y, z = np.moveaxis(position, -1, 0)
    return np.stack([np.where(x <= 0, x, np.hypot(x, z)), y], axis=-1)


@pytest.mark.parametrize("angle", [np.pi / 2, np.pi / 6, -np.pi / 3])
@pytest.mark.parametrize("turn", [0.0, 0.3, -0.2, 1.2])
def test_it_runs_straight_but_for_the_turn(angle, turn):
    """Unfolded, the warp is two straight pieces at that angle, positive to its left; nodes one spacing along them."""
    seed, heading = np.array([-110.0, 10.0]), np.radians(20)
    net = drape(roof(angle), (*seed, 0), (np.cos(heading), np.sin(heading), 0), warp_turn=turn)
    start = np.array([np.cos(heading), np.sin(heading)])
    run = 110.0 / start[0]
    beyond = np.array([np.cos(heading + turn), np.sin(heading + turn)])
    length = 20.0 * np.arange(-8, 10)
    found = unfolded(nodes_at(net, np.arange(-8, 10), 0))
    expected = np.where(
        (length < run)[:, None],
        seed + length[:, None] * start,
        seed + run * start + (length - run)[:, None] * beyond,
    )
    here = np.isfinite(found[:, 0])
    assert here.sum() >= 12
    assert found[here] == pytest.approx(expected[here], abs=1e-9)
    if abs(turn) < 1:
        # shear beyond the ridge is the turn, but for what the bent edge lacks of a spacing
        assert balance(meshdrape.measure(net)).worst < 1.5 * (1 - np.cos(turn / 2)) + 1e-9


def test_node_on_the_crease_is_reached_and_left_in_its_own_directions():
    """A crossing at a node: every edge is straight, and the cells on both sides of it are rhombi."""
    net = drape(roof(np.pi / 2), (-120, 3, 0), (1, 0, 0), warp_turn=0.25)
    assert not net.start.arc.any()
    shear = meshdrape.measure(net).cell_shear
    i, _ = offsets(net)
    before, beyond = i[:-1, :-1] < 6, i[:-1, :-1] >= 6
    assert np.nanmax(np.abs(shear[before])) < 1e-9
    assert np.nanmax(np.abs(shear[beyond] - 0.25)) < 1e-9
    assert meshdrape.audit(net).n_arcs == 0


def test_bent_edge_is_told_apart_from_those_of_one_spacing():
    net = drape(roof(np.pi / 2), (-110, 3, 0), (1, 0, 0), warp_turn=0.25)
    half, edge = np.nonzero(net.start.arc)
    assert half.tolist() == [0]
    assert edge.tolist() == [5]
    found = meshdrape.audit(net, edges=10**6)
    assert found.n_arcs == 1
    assert found.max_relative_error < 1e-9
    # the chord of two legs of half a spacing
    a, b = unfolded(nodes_at(net, np.array([5, 6]), 0))
    assert np.linalg.norm(b - a) == pytest.approx(20 * np.cos(0.125), abs=1e-9)


def test_crease_within_the_first_edge():
    """The seed lies nearer to the ridge than one spacing: its star is that of the bent edge."""
    net = drape(roof(np.pi / 2), (-7, 3, 0), (1, 0, 0), warp_turn=0.25)
    found = unfolded(nodes_at(net, np.arange(1, 6), 0))
    length = 20.0 * np.arange(1, 6) - 7
    assert found == pytest.approx(np.stack([length * np.cos(0.25), 3 + length * np.sin(0.25)], axis=1), abs=1e-9)
    assert net.direction == pytest.approx([1, 0, 0], abs=1e-12)
    assert balance(meshdrape.measure(net)).worst < 1.5 * (1 - np.cos(0.125))
    assert net.start.sector.sum() == pytest.approx(2 * np.pi, abs=1e-12)


def test_over_a_vertex_of_the_crease():
    """The ridge's vertices lie every 66.7 mm: through one of them the same net as beside it, shifted."""
    mesh = roof(np.pi / 2)
    ridge = mesh.vertices[np.abs(mesh.vertices[:, 0]) < 1e-9][:, 1]
    through = drape(mesh, (-110, ridge[3], 0), (1, 0, 0), warp_turn=-0.3)
    beside = drape(mesh, (-110, ridge[3] + 7, 0), (1, 0, 0), warp_turn=-0.3)
    i, j = np.meshgrid(np.arange(-4, 12), np.arange(-4, 5), indexing="ij")
    shift = nodes_at(beside, i, j) - nodes_at(through, i, j)
    both = np.isfinite(shift[..., 0])
    assert both.sum() > 100
    assert shift[both] == pytest.approx(np.broadcast_to([0.0, 7.0, 0.0], shift[both].shape), abs=1e-9)


def test_both_halves_turn_at_their_own_crease_and_only_at_the_first():
    """A channel with three folds: -warp meets one, +warp two, of which the first turns it."""
    x = np.array([-300.0, -100, 100, 220, 300])
    z = np.array([0.0, 150, 150, 40, 40])
    mesh = grid(np.arange(5), np.linspace(-200, 200, 5), lambda k, y: (x[k.astype(int)], y, z[k.astype(int)]))
    net = drape(mesh, (3, 0, 150), (1, 0, 0), warp_turn=0.2)
    unrolled = np.concatenate([[0], np.cumsum(np.hypot(np.diff(x), np.diff(z)))])
    unrolled -= unrolled[1] + 103  # from the seed
    ahead, back = unrolled[2], unrolled[1]
    length = 20.0 * np.arange(-12, 13)
    node = nodes_at(net, np.arange(-12, 13), 0)
    across = np.where(
        length > ahead, (length - ahead) * np.sin(0.2), np.where(length < back, (length - back) * np.sin(0.2), 0)
    )
    here = placed(net)[net.seed_index[0] + np.arange(-12, 13), net.seed_index[1]]
    assert here.sum() > 20
    assert node[here, 1] == pytest.approx(across[here], abs=1e-9)


def test_positive_is_to_the_left_on_the_side_the_cloth_lies_on():
    """Right-handed about the normal: on the other side of the tool the same turn goes the other way."""
    seed, direction = (-110, 3, 0), (1, 0, 0)
    mesh = roof(np.pi / 6)
    over = nodes_at(drape(mesh, seed, direction, warp_turn=0.2), 8, 0)
    under = nodes_at(drape(mesh.reversed(), seed, direction, warp_turn=0.2), 8, 0)
    assert over[1] > 3 + 5
    assert under == pytest.approx(over * [1, -1, 1] + [0, 6, 0], abs=1e-9)


def test_engines_agree():
    options = {"extent": (40, 100, 40, 40), "warp_turn": 0.25}
    fast, reference = (
        drape(roof(np.pi / 2), (-50, 3, 0), (1, 0.2, 0), engine=engine, **options) for engine in ("fast", "libigl")
    )
    assert np.array_equal(fast.node_status, reference.node_status)
    assert placed(fast).sum() > 30
    assert np.nanmax(np.linalg.norm(fast.node_position - reference.node_position, axis=-1)) < 1e-8


# --- what a crease is ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("angle", "found"), [(15.0, False), (25.0, True), (-80.0, True)])
def test_crease_of_a_mesh_is_an_edge_of_more_than_20_degrees(angle, found):
    mesh = roof(np.radians(angle))
    surface = mesh.mould().surface
    crease = crease_edges(surface, np.zeros(len(mesh.triangles), dtype=np.int64))
    on_ridge = np.abs(surface.vertices[surface.faces][..., 0]) < 1e-9
    edge = np.stack([on_ridge[:, k] & on_ridge[:, (k + 1) % 3] for k in range(3)], axis=1)
    assert np.array_equal(crease, edge & found)


def test_between_cad_faces_less_is_enough_and_smooth_joints_are_none():
    mesh = roof(np.radians(5.0))
    surface = mesh.mould().surface
    side = (surface.vertices[surface.faces].mean(axis=1)[:, 0] > 0).astype(np.int64) + 1
    assert crease_edges(surface, side).sum() == 2 * 6
    # a tessellation that coarse cannot tell
    assert not crease_edges(surface, side, np.radians(3.0)).any()
    assert not crease_edges(surface, np.ones_like(side)).any()
    assert not crease_edges(cylinder().mould().surface, np.zeros(600 * 2, dtype=np.int64)).any()
    flat = roof(0.0).mould().surface
    assert not crease_edges(flat, side).any()


def test_sharp_edge_from_step(tmp_path):
    """A block's top and side, read from STEP: the weft goes over the edge between them and turns there."""
    cadquery = pytest.importorskip("cadquery")
    file = tmp_path / "block.step"
    cadquery.exporters.export(cadquery.Workplane().box(400, 300, 200, centered=False), str(file))
    mould = meshdrape.read_mould(file, faces=">Z or <X")
    net = meshdrape.drape(mould, meshdrape.Fabric(20.0), (110, 150, 200), (0, 1, 0), weft_turn=-0.3)
    # the weft runs to smaller x; right-handed about the side's normal, -x, a negative turn leads it to larger y
    node = nodes_at(net, 0, np.arange(6, 12))
    down = 20.0 * np.arange(6, 12) - 110
    expected = np.stack([0 * down, 150 + down * np.sin(0.3), 200 - down * np.cos(0.3)], axis=1)
    assert node == pytest.approx(expected, abs=1e-6)


# --- what cannot be --------------------------------------------------------------------------------------------------

REFUSED = {
    "no crease on the mould": (plate(), (0, 0, 0), (1, 0, 0), {"warp_turn": 0.1}, "the warp meets no crease"),
    "smooth mould": (hypar(), (0, 0, 0), (1, 0, 0), {"weft_turn": 0.1}, "the weft meets no crease"),
    "along the crease": (roof(1.0), (-50, 0, 0), (0, 1, 0), {"warp_turn": 0.1}, "the warp meets no crease"),
    "back over it": (cube_corner(300), (150, 150, 0), (-1, 0, 0), {"warp_turn": 1.7}, "leads the warp back"),
    "no angle": (roof(1.0), (-50, 0, 0), (1, 0, 0), {"warp_turn": np.nan}, "warp_turn is nan"),
    "more than half a turn": (roof(1.0), (-50, 0, 0), (1, 0, 0), {"weft_turn": 4.0}, "weft_turn is 4.0"),
    "cloth that ends before it": (
        roof(1.0), (-150, 0, 0), (1, 0, 0), {"warp_turn": 0.1, "extent": (50, 50, 50, 50)}, "the warp meets no crease",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_one_line(name):
    mesh, seed, direction, options, message = REFUSED[name]
    with pytest.raises(meshdrape.MeshdrapeError, match=re.escape(message)) as caught:
        drape(mesh, seed, direction, **options)
    assert "\n" not in str(caught.value)


def test_mould_of_two_parts_turns_on_the_seeds():
    mesh = wing_spar(lambda t: 0 * t, lambda t: 0.12 * t, np.array([-700.0, 2000.0]), 900, 900)
    apart = mesh.joined(Mesh(mesh.vertices + np.array([5000.0, 0, 0]), mesh.triangles))
    one, two = (drape(m, (200, 0, 0), (0, 1, 0), weft_turn=0.1) for m in (mesh, apart))
    assert np.array_equal(one.node_position, two.node_position, equal_nan=True)
