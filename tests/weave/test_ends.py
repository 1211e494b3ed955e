"""Where a sheet ends, and why: past the shear it may have, back over a crease, where it folds."""

import math

import numpy as np
import pytest
from moulds import icosphere, wing_spar

import meshdrape
from meshdrape import NodeStatus
from meshdrape.errors import StartError

SPAN, HEIGHT = 2000.0, 500.0
# of the ball: short of where the sheet folds
EXTENT = (900, 900, 900, 900)


def wavy(amplitude, waves=1):
    """A flat wing and a spar that waves: rows beside the edge go over it and come back."""
    y = np.linspace(0, SPAN, 401)
    return wing_spar(
        lambda t: 0 * t, lambda t: amplitude * np.sin(2 * np.pi * waves * t / SPAN), y, 1200.0, HEIGHT
    ).mould()


def drape(mould, **options):
    return meshdrape.drape(mould, meshdrape.Fabric(20.0), seed=(700, 0, 0), direction=(0, 1, 0), **options)


@pytest.fixture(scope="module")
def bay():
    return wavy(60.0)


@pytest.fixture(scope="module")
def ball():
    return icosphere(5, 1000.0).mould()


@pytest.mark.parametrize("degrees", [3.0, 7.0, 15.0, 30.0])
def test_no_cell_is_sheared_past_the_stop(ball, degrees):
    """What is left is what the whole net has of it; each STOPPED node would have made a cell past the stop."""
    stop = math.radians(degrees)
    whole = meshdrape.drape(ball, meshdrape.Fabric(50.0), seed=(0, 0, 1000), direction=(1, 0.2, 0), extent=EXTENT)
    net = meshdrape.drape(
        ball, meshdrape.Fabric(50.0), seed=(0, 0, 1000), direction=(1, 0.2, 0), extent=EXTENT, stop_at=stop
    )
    shear = meshdrape.measure(net).cell_shear
    assert np.nanmax(np.abs(shear)) <= stop
    assert net.count(NodeStatus.STOPPED) > 0
    assert net.count(NodeStatus.NOT_REACHED) > 0
    # of the whole net, the same nodes, and the cells of the stopped ones
    offset = np.array(whole.seed_index) - net.seed_index
    there = np.argwhere(net.node_status == NodeStatus.PLACED)
    np.testing.assert_array_equal(whole.node_position[tuple((there + offset).T)], net.node_position[tuple(there.T)])
    unstopped = meshdrape.measure(whole).cell_shear
    for i, j in np.argwhere(net.node_status == NodeStatus.STOPPED) - net.seed_index:
        cell = np.add(whole.seed_index, (i - (i > 0), j - (j > 0)))
        assert abs(unstopped[tuple(cell)]) > stop


def test_a_stop_beyond_all_shear_changes_nothing(ball):
    free = meshdrape.drape(ball, meshdrape.Fabric(80.0), seed=(0, 0, 1000), extent=(400, 400, 400, 400))
    net = meshdrape.drape(ball, meshdrape.Fabric(80.0), seed=(0, 0, 1000), extent=(400, 400, 400, 400), stop_at=1.5)
    np.testing.assert_array_equal(net.node_position, free.node_position)
    np.testing.assert_array_equal(net.node_status, free.node_status)


def test_a_stop_holds_for_nodes_that_libigl_places(ball):
    stop = math.radians(10)
    extent = (500, 500, 500, 500)
    nets = [
        meshdrape.drape(ball, meshdrape.Fabric(50.0), seed=(0, 0, 1000), extent=extent, stop_at=stop, engine=engine)
        for engine in ("fast", "libigl")
    ]
    np.testing.assert_array_equal(nets[0].node_status, nets[1].node_status)


@pytest.mark.parametrize("degrees", [0.0, -3.0, math.nan])
def test_a_stop_that_is_none_is_refused(ball, degrees):
    with pytest.raises(StartError, match="stop at a shear of"):
        meshdrape.drape(ball, meshdrape.Fabric(50.0), stop_at=math.radians(degrees))


def test_a_row_that_comes_back_over_the_crease_ends_there(bay):
    """On y < 1000 the edge bulges into the wing, on y > 1000 away from it: rows go over it and return."""
    net, whole = drape(bay), drape(bay, recrossing=True)
    assert whole.count(NodeStatus.RECROSSED) == 0
    i, j = np.nonzero(net.node_status == NodeStatus.RECROSSED)
    assert len(i) > 0
    offset = np.array(whole.seed_index) - net.seed_index
    for a, b in zip(i + offset[0], j + offset[1], strict=True):
        # from the left end on: on one side of the edge, at least half a spacing beyond it, back
        on_mould = whole.node_status[: a + 1, b] == NodeStatus.PLACED
        down = whole.node_position[: a + 1, b, 2][on_mould] < -1e-9
        assert np.count_nonzero(np.diff(down)) == 2
        assert down[0] == down[-1]
    # nodes before them are those of the sheet that goes on
    there = np.argwhere(net.node_status == NodeStatus.PLACED)
    np.testing.assert_array_equal(whole.node_position[tuple((there + offset).T)], net.node_position[tuple(there.T)])


def test_ripples_less_deep_than_half_a_spacing_are_no_return():
    net = drape(wavy(4.0, waves=3))
    assert net.count(NodeStatus.RECROSSED) == 0


def test_rows_that_go_over_once_are_none():
    y = np.linspace(0, SPAN, 201)
    net = drape(wing_spar(lambda t: 0 * t, lambda t: 5e-5 * t * t, y, 1200.0, HEIGHT).mould())
    assert net.count(NodeStatus.RECROSSED) == 0
    assert net.count(NodeStatus.NOT_REACHED) == 0


def test_a_boss_may_be_gone_over():
    """A crease that closes on itself: up on one side, down on the other."""
    turns = np.linspace(0, 2 * np.pi, 97)[:-1]
    rings = [(0.0, 60.0), (150.0, 60.0), (300.0, 0.0), (700.0, 0.0)]
    vertices = [(0.0, 0.0, 60.0)]
    for radius, height in rings[1:]:
        vertices += [(radius * np.cos(t), radius * np.sin(t), height) for t in turns]
    n, faces = len(turns), []
    for k in range(n):
        faces.append((0, 1 + k, 1 + (k + 1) % n))
        for ring in range(len(rings) - 2):
            a, b = 1 + ring * n + k, 1 + ring * n + (k + 1) % n
            faces += [(a, a + n, b + n), (a, b + n, b)]
    mould = meshdrape.Mould.from_arrays(np.array(vertices), np.array(faces))
    net = meshdrape.drape(mould, meshdrape.Fabric(20.0), seed=(-500, 3, 0), direction=(1, 0, 0))
    assert net.count(NodeStatus.RECROSSED) == 0


def test_mirrored_the_same_rows_end(bay):
    vertices, triangles = bay.vertices * (1, -1, 1), bay.triangles[:, ::-1]
    mirrored = meshdrape.drape(
        meshdrape.Mould.from_arrays(vertices, triangles),
        meshdrape.Fabric(20.0),
        seed=(700, 0, 0),
        direction=(0, -1, 0),
    )
    net = drape(bay)
    assert sorted((np.argwhere(net.node_status == NodeStatus.RECROSSED) - net.seed_index).tolist()) == sorted(
        ((np.argwhere(mirrored.node_status == NodeStatus.RECROSSED) - mirrored.seed_index) * (1, -1)).tolist()
    )
