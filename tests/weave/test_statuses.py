"""How nodes end, each status on a mould that causes it; and no node lost for no reason."""

import numpy as np
import pytest
from cases import CASES
from lattice import cells_at, offsets
from moulds import hypar, icosphere, plate, tube

import meshdrape
from meshdrape import NodeStatus
from meshdrape.weave import read_off


def test_numbers_that_scripts_rely_on():
    assert {status.name: int(status) for status in NodeStatus} == {
        "PLACED": 0,
        "OFF_MOULD": 1,
        "OUTSIDE": 2,
        "FOLDED": 3,
        "MET_ITSELF": 4,
        "STOPPED": 5,
        "RECROSSED": 6,
        "NOT_CONVERGED": 7,
        "NOT_REACHED": 8,
    }


@pytest.mark.parametrize("name", CASES)
def test_arrays(name):
    net = CASES[name].drape()
    assert net.node_status.dtype == np.uint8
    assert net.node_position.shape == (*net.node_status.shape, 3)
    assert net.node_position.dtype == np.float64
    assert set(np.unique(net.node_status)) <= set(map(int, NodeStatus))
    i0, j0 = net.seed_index
    assert 0 <= i0 < net.shape[0]
    assert 0 <= j0 < net.shape[1]


@pytest.mark.parametrize("name", CASES)
def test_no_node_is_lost_on_the_way(name):
    """Every node that straight paths do not reach is placed all the same."""
    net = CASES[name].drape()
    assert net.count(NodeStatus.NOT_CONVERGED) == 0
    if not net.count(NodeStatus.FOLDED) and not net.count(NodeStatus.MET_ITSELF):
        assert net.count(NodeStatus.NOT_REACHED) == 0


@pytest.mark.parametrize(
    "name",
    [
        "plate",
        "needles and strips",
        "plate with a hole",
        "swept plate",
        "prism",
        "wing and spar",
        "few facets",
        "cap, cells above triangles",
        "cap, cells below triangles",
        "hills",
        "hills, long cells",
        "hills, cloth of 60 degrees",
        "steep hills",
        "double curved",
        "cube's corner, from the vertex",
        "foot of a step, from the vertex",
    ],
)
def test_the_whole_mould_is_under_cloth(name):
    """Nothing that a sheet can reach stays bare: triangles, cut down below the cell's size, under whole cells.

    (From beside the cube's corner, or the foot of the step, the sheet shears by a right angle behind it and folds.)
    """
    net = CASES[name].drape()
    field = read_off(meshdrape.measure(net))
    assert field.coverage_fraction > 0.995, f"{field.coverage_fraction:.1%} covered"


def test_folded():
    """From the corner of a deep saddle more than a right angle of curvature lies ahead: cells open until they end."""
    net = meshdrape.drape(hypar(1.0, 1.0, 40).mould(), meshdrape.Fabric(50.0), (-1000, -1000, 1000), (1, 0, -1))
    shear = np.degrees(meshdrape.measure(net).cell_shear)
    assert net.count(NodeStatus.FOLDED) > 0
    assert np.nanmin(shear) < -75
    # the fold's own limit, one degree
    assert np.nanmin(shear) > -89.5
    i, j = offsets(net)
    for a, b in np.argwhere(net.node_status == NodeStatus.FOLDED):
        # the last cell before it is nearly shut
        si, sj = np.sign(i[a, b]), np.sign(j[a, b])
        before = cells_at(net, shear, i[a, b] - si - (si > 0), j[a, b] - sj - (sj > 0))
        assert not before > -45


def test_folded_on_a_dome():
    """A sphere locks at K u v = 1.86: no cell whose nearer corner is well past that."""
    net = meshdrape.drape(icosphere(4).mould(), meshdrape.Fabric(60.0), (0, 0, 1000), (1, 0.2, 0))
    i, j = offsets(net)
    on = net.node_status == NodeStatus.PLACED
    assert net.count(NodeStatus.FOLDED) > 0
    assert np.abs(i * j * 0.0036)[on].max() < 2.1
    assert np.abs(i * j * 0.0036)[on].max() > 1.6


def test_met_itself():
    net = meshdrape.drape(tube().mould(), meshdrape.Fabric(9.0), (60, 0, 0), (0, 0.4, 1))
    assert net.count(NodeStatus.MET_ITSELF) > 0
    assert net.count(NodeStatus.FOLDED) == 0


def test_off_mould_and_outside():
    net = meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0), (3, 5, 0), (1, 0.3, 0))
    assert net.count(NodeStatus.OFF_MOULD) > 0
    assert net.count(NodeStatus.OUTSIDE) > 0
    assert (
        net.count(NodeStatus.PLACED) + net.count(NodeStatus.OFF_MOULD) + net.count(NodeStatus.OUTSIDE)
        == net.node_status.size
    )


@pytest.mark.parametrize("spacing", [20.0, 30.0, 60.0])
def test_no_cell_is_laid_that_folds_at_any_corner(spacing):
    """Past the corners of an icosahedron three corners of a cell may be open and the fourth turned over."""
    mould = icosphere(0, 100.0).mould()
    corners = mould.surface.vertices[mould.surface.faces[0]]
    for seed, direction in ((corners.mean(axis=0), corners[1] - corners[0]), (corners[:2].mean(axis=0), (0, 1, 0))):
        net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=direction)
        angle = np.pi / 2 - meshdrape.measure(net).cell_shear
        assert net.count(NodeStatus.FOLDED) > 0
        assert np.nanmin(angle) > np.radians(1)
        assert np.nanmax(angle) < np.radians(179)
        # none lies flat on itself, its opposite corners on one place
        place = net.node_position
        for across in (place[1:, 1:] - place[:-1, :-1], place[1:, :-1] - place[:-1, 1:]):
            assert not (np.linalg.norm(across, axis=2)[np.isfinite(angle)] < 1e-3 * spacing).any()


def test_cloth_folds_at_a_seed_whose_quarters_exceed_half_a_turn():
    n, steep = 8, 0.8
    azimuth, height = 2 * np.pi * np.arange(n) / n, np.where(np.arange(n) % 2, steep, -steep)
    rim = np.stack([np.cos(azimuth) * np.cos(height), np.sin(azimuth) * np.cos(height), np.sin(height)], axis=1)
    faces = [[0, 1 + k, 1 + (k + 1) % n] for k in range(n)]
    mould = meshdrape.Mould.from_arrays(np.concatenate([np.zeros((1, 3)), 100 * rim]), faces)
    assert mould.surface.vertex_angle[0] > 4 * np.pi
    net = meshdrape.drape(mould, meshdrape.Fabric(10.0), seed=(0, 0, 0), direction=rim[0])
    i, j = net.seed_index
    assert (net.node_status[[i - 1, i - 1, i + 1, i + 1], [j - 1, j + 1, j - 1, j + 1]] == NodeStatus.FOLDED).all()
