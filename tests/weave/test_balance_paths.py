"""The balance with start fibres that bend, at curved vertices and elsewhere, on moulds whose curvature lies in few."""

import numpy as np
import pytest
from moulds import Mesh, bumpy, cube_corner, grid, step_corner
from test_balance_cells import interior_angles

import meshdrape
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.measures.chords import chords, passed
from meshdrape.weave.measures.turning import turning
from meshdrape.weave.recheck.rebuild import rebuild


def pyramid(sides, depth, radius=1000.0):
    """Triangles about an apex at the origin."""
    turn = np.arange(sides) * 2 * np.pi / sides + 0.1
    foot = np.stack([radius * np.cos(turn), radius * np.sin(turn), np.full(sides, -depth)], axis=1)
    return Mesh(np.vstack([np.zeros(3), foot]), np.array([(0, k + 1, (k + 1) % sides + 1) for k in range(sides)]))


def about_the_vertex(mesh, spokes):
    """Points about the vertex at the origin by turn and distance along the surface; its faces lie between spokes."""
    spokes = np.asarray(spokes, dtype=float)
    spokes = spokes / np.linalg.norm(spokes, axis=1)[:, None]
    after = np.roll(spokes, -1, axis=0)
    sector = np.arccos(np.clip(np.einsum("ij,ij->i", spokes, after), -1, 1))
    begin = np.concatenate([[0.0], np.cumsum(sector)])

    def place(turn, distance):
        turn %= begin[-1]
        k = min(int(np.searchsorted(begin, turn, side="right")) - 1, len(spokes) - 1)
        across = after[k] - (after[k] @ spokes[k]) * spokes[k]
        across /= np.linalg.norm(across)
        return distance * (np.cos(turn - begin[k]) * spokes[k] + np.sin(turn - begin[k]) * across)

    return mesh, place, begin[-1]


X, Y, Z = np.eye(3)
BLUNT, STEEP = pyramid(5, 300.0), pyramid(4, 900.0)
MOULDS = {
    "blunt pyramid": about_the_vertex(BLUNT, BLUNT.vertices[1:]),
    "steep pyramid": about_the_vertex(STEEP, STEEP.vertices[1:]),
    "cube's corner": about_the_vertex(cube_corner(1000), [X, Y, Z]),
    "foot of a step": about_the_vertex(step_corner(1000), [X, Y, -X, Z, -Y]),
}


def bent_at_the_vertex(name, number):
    """A net on a random path that bends at the vertex, as much to one side as half a turn, and once before it."""
    mesh, place, total = MOULDS[name]
    rng = np.random.default_rng(number)
    come = rng.uniform(0, total)
    # neither side of it is sharp: else the fibre would lie upon itself
    go = come + rng.uniform(0.35, 0.65) * total
    points = [place(come + 0.1, 420), place(come, 210), place(0, 0), place(go, 400)]
    family = ("warp_path", "weft_path")[number % 2]
    spacing = rng.uniform(25, 60)
    seed = points[0] + (points[1] - points[0]) * rng.uniform(0.2, 0.8)
    mould = mesh.mould()
    seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    return meshdrape.drape(mould, meshdrape.Fabric(spacing), seed, extent=(450,) * 4, **{family: np.array(points)})


@pytest.mark.parametrize("number", range(6))
@pytest.mark.parametrize("name", MOULDS)
def test_shear_is_foretold_to_round_off_where_a_fibre_bends_at_the_vertex(name, number):
    """Angle defects of up to 120 degrees: the apex lies beside the fibre's chord, in a cell or on it."""
    net = bent_at_the_vertex(name, number)
    found = balance(meshdrape.measure(net))
    known = np.isfinite(found.residual)
    assert len(chords(net)) >= 1
    assert known.sum() > 50
    assert np.abs(found.residual[known]).max() < 1e-9
    angles = interior_angles(net)
    whole = np.isfinite(angles)
    np.testing.assert_allclose(found.cell_defect[whole], angles[whole], atol=1e-9)


@pytest.mark.parametrize("number", range(8))
def test_random_paths_over_hills(number):
    """A path through points and vertices of an irregular mesh: Gauss and Bonnet to round-off in every cell."""
    rng = np.random.default_rng(number)
    mould = bumpy(number, n=int(rng.integers(8, 26))).mould()
    surface = mould.surface
    x = np.linspace(-65, 65, 9)
    y = rng.uniform(-30, 30) + 10 * np.sin(x / rng.uniform(15, 40)) + rng.uniform(-4, 4, 9)
    points = [surface.closest_point((a, b, 0))[0].position(surface) for a, b in zip(x, y, strict=True)]
    vertex = surface.vertices[np.argmin(np.linalg.norm(surface.vertices[:, :2] - (x[4], y[4]), axis=1))]
    points[4] = vertex
    family = ("warp_path", "weft_path")[number % 2]
    net = meshdrape.drape(mould, meshdrape.Fabric(rng.uniform(3, 9)), **{family: np.array(points)})
    found = balance(meshdrape.measure(net))
    angles = interior_angles(net)
    whole = np.isfinite(angles)
    assert len(chords(net)) > 5
    np.testing.assert_allclose(found.cell_defect[whole], angles[whole], atol=1e-9)
    on = np.isfinite(found.residual) & found.measures.cell_touches_mould
    assert on.sum() > 200
    assert np.degrees(np.sqrt(np.mean(found.residual[on] ** 2))) < 0.005
    assert np.degrees(found.worst) < 0.05 < found.measures.max_shear


@pytest.mark.parametrize("name", MOULDS)
def test_turns_on_both_sides_of_a_node_add_up_to_its_defect(name):
    """A node of a bent fibre on the vertex itself."""
    mesh, place, total = MOULDS[name]
    points = np.array([place(0.3, 300), place(0, 0), place(0.3 + 0.4 * total, 300)])
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(30.0), points[0], warp_path=points, extent=(0, 580, 90, 90))
    turn = turning(net, 0)
    at = np.flatnonzero(np.abs(turn.sum(axis=1)) > 1e-9).tolist()
    assert at == [9]
    assert turn[9].sum() == pytest.approx(2 * np.pi - total, abs=1e-9)
    assert sorted(np.pi - turn[9]) == pytest.approx([0.4 * total, 0.6 * total], abs=1e-9)
    others = np.delete(turn, 9, axis=0)
    assert np.abs(others).max() < 1e-7
    found = balance(meshdrape.measure(net))
    assert np.isfinite(found.residual).sum() > 50
    assert np.nanmax(np.abs(found.residual)) < 1e-9


@pytest.mark.parametrize("half", range(4))
@pytest.mark.parametrize("name", MOULDS)
def test_shear_about_a_node_on_the_vertex(name, half):
    """A straight fibre with its tenth node on it: cells before are as they were, each beyond has half of the defect."""
    mesh, place, total = MOULDS[name]
    seed = place(0.4, 300)
    fabric = meshdrape.Fabric(30.0)
    mould = mesh.mould()
    normal = mould.surface.face_normal[mould.surface.closest_point(seed)[0].face]
    along = (-seed, np.cross(normal, seed), seed, -np.cross(normal, seed))[half]
    net = meshdrape.drape(mould, fabric, seed, along, extent=(500, 500, 500, 500))
    measures = meshdrape.measure(net)
    found = balance(measures)
    assert np.nanmax(np.abs(found.residual)) < 1e-9
    i0, j0 = net.seed_index
    k = np.array([9, 10])
    i, j = ((i0 + k, j0), (i0, j0 + k), (i0 - 1 - k, j0), (i0, j0 - 1 - k))[half]
    before, beyond = measures.cell_shear[i, j]
    assert abs(before) < 1e-9
    assert abs(beyond) == pytest.approx(abs(np.pi - total / 2), abs=1e-9)


def test_a_fibre_turns_nowhere_on_its_own():
    net = meshdrape.drape(bumpy(3).mould(), meshdrape.Fabric(7.0), direction=(1, 0.3, 0))
    for half in range(4):
        assert not turning(net, half).any()


def test_what_a_chord_passes():
    """Over edges in their order, each by how far from its tail; shorter than the path that bends there."""
    side = np.linspace(-100, 100, 9)
    mould = grid(side, side, lambda x, y: (x, y, 0)).mould()
    path = np.array([[-90, -20.0, 0], [3.0, 4.0, 0], [90, -30.0, 0]])
    net = meshdrape.drape(mould, meshdrape.Fabric(40.0), path[0], warp_path=path, extent=(0, 160, 40, 40))
    (chord,) = chords(net)
    assert 0.95 * 40 < chord.length < 40
    surface = net.surface
    places = []
    for over in passed(surface, chord):
        face, k = divmod(over.at, 3)
        tail, head = surface.vertices[surface.faces[face, [k, (k + 1) % 3]]]
        places.append(tail + over.t * (head - tail))
    i = net.seed_index[0] + chord.order
    ends = net.node_position[i : i + 2, net.seed_index[1]]
    line = np.vstack([ends[0], places, ends[1]])
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    assert len(places) > 2
    assert steps.sum() == pytest.approx(chord.length, abs=1e-9)
    assert chord.length == pytest.approx(np.linalg.norm(ends[1] - ends[0]), abs=1e-9)


@pytest.mark.parametrize("name", MOULDS)
def test_a_net_read_again_is_foretold_the_same(name, tmp_path):
    """The vertex lies on the very start fibre, amid an edge: no place of it hangs on the root of round-off."""
    mesh, place, _ = MOULDS[name]
    mould, seed = mesh.mould(), place(1.3, 307)
    net = meshdrape.drape(mould, meshdrape.Fabric(30.0), seed, -seed, extent=(500, 500, 500, 500))
    meshdrape.write_ply(net, tmp_path / "net.ply")
    again = rebuild(mould, meshdrape.read_net(tmp_path / "net.ply")).net
    first, second = balance(meshdrape.measure(net)), balance(meshdrape.measure(again))
    assert net.start.through.any()
    np.testing.assert_allclose(second.predicted, first.predicted, atol=1e-12)
    assert np.nanmax(np.abs(first.residual)) < 1e-12
