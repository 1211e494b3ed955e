"""Edges that two cells share are walked once: what is found of a cell does not hang on its neighbours."""

import numpy as np
import pytest

import meshdrape
from meshdrape.kernels import emit
from meshdrape.kernels.shear import cell_shear, shear_of
from meshdrape.weave.status import NodeStatus

SPACING = 10.0


def strip(degrees):
    """A net on a strip narrower than a cell, whose fibres cross it at an angle."""
    half = np.array([150.0, 1.5])
    corners = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]]) * half
    mould = meshdrape.Mould.from_arrays(np.c_[corners, np.zeros(4)], [[0, 1, 2], [0, 2, 3]])
    angle = np.radians(degrees)
    fabric = meshdrape.Fabric(SPACING)
    net = meshdrape.drape(mould, fabric, seed=(0, 0, 0), direction=(np.cos(angle), np.sin(angle), 0))
    return net, half


@pytest.mark.parametrize("degrees", [20.0, 38.0, 75.0])
def test_cells_that_touch_a_strip_by_an_edge_alone(degrees):
    """In the plane it is plain which edges cross the strip."""
    net, half = strip(degrees)
    place, status = net.node_position[..., :2], net.node_status
    whole = status <= NodeStatus.OFF_MOULD
    whole = whole[:-1, :-1] & whole[1:, :-1] & whole[:-1, 1:] & whole[1:, 1:]
    share = np.linspace(0.0, 1.0, 2001)[:, None, None, None]

    def crosses(a, b):
        return (np.abs(a + share * (b - a)) <= half).all(axis=-1).any(axis=0)

    along, across = crosses(place[:-1], place[1:]), crosses(place[:, :-1], place[:, 1:])
    expected = whole & (along[:, :-1] | along[:, 1:] | across[:-1] | across[1:])
    found = meshdrape.measure(net).cell_touches_mould
    assert np.array_equal(found, expected)
    on = status == NodeStatus.PLACED
    by_edge_alone = found & ~(on[:-1, :-1] | on[1:, :-1] | on[:-1, 1:] | on[1:, 1:])
    assert np.count_nonzero(by_edge_alone) > 5
    # a row by itself has nothing of the row before it
    one_by_one = np.empty_like(found)
    for i in range(len(found)):
        emit.touching_cells(net.surface.unfolding, net.lattice, net.start, i, SPACING, SPACING, one_by_one[i : i + 1])
    assert np.array_equal(one_by_one, found)


def test_shear_is_that_of_each_cell_by_itself():
    """To the last digit, and with cells missing in between: the net has holes where nodes are taken out."""
    x, y = (part.ravel() for part in np.meshgrid(*[np.linspace(0.0, 200.0, 21)] * 2, indexing="ij"))
    q = (np.arange(20)[:, None] * 21 + np.arange(20)).ravel()
    faces = np.concatenate([np.stack([q, q + 21, q + 22], 1), np.stack([q, q + 22, q + 1], 1)])
    mould = meshdrape.Mould.from_arrays(np.stack([x, y, 15 * np.sin(x / 60) * np.cos(y / 50)], axis=1), faces)
    net = meshdrape.drape(mould, meshdrape.Fabric(3.0), seed=(95, 105, -7), direction=(1, 0.3, 0))
    status = net.node_status.copy()
    status[np.random.default_rng(3).random(status.shape) < 0.03] = NodeStatus.FOLDED
    lattice = net.lattice._replace(status=status)
    mesh, start, angle = net.surface.unfolding, net.start, np.pi / 2
    found = np.empty((status.shape[0] - 1, status.shape[1] - 1))
    cell_shear(mesh, lattice, start, 0, angle, 3.0, 3.0, found)
    whole = status <= NodeStatus.OFF_MOULD
    whole = whole[:-1, :-1] & whole[1:, :-1] & whole[:-1, 1:] & whole[1:, 1:]
    assert np.array_equal(np.isfinite(found), whole)
    by_itself = np.array([shear_of(mesh, lattice, start, i, j, angle, 3.0, 3.0) for i, j in np.argwhere(whole)])
    # a cell inside one triangle is measured by its sides, without walking
    assert np.abs(found[whole] - by_itself).max() < 1e-13
    face = lattice.face
    one = (face[:-1, :-1] == face[1:, :-1]) & (face[:-1, :-1] == face[:-1, 1:]) & (face[:-1, :-1] == face[1:, 1:])
    assert np.array_equal(found[whole][~one[whole]], by_itself[~one[whole]])
