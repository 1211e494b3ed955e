"""Where a net meets itself: known to the node where the mould unrolls, and nowhere for want of a way between layers."""

import numpy as np
import pytest
from moulds import Mesh
from numpy.typing import NDArray
from prisms import Prism, roll, tube_of

import meshdrape
from meshdrape import NodeStatus
from meshdrape.weave import read_off

# mould, spacings, seed and turn of a cloth that goes round more than once
LAID = {
    "cells like triangles": (tube_of(25, 3, 400), (7.0, 7.0), (2.0, 197.0), 38.0, 130.0),
    "cells far below triangles": (tube_of(9, 2, 400), (2.9, 2.9), (4.0, 197.0), 17.0, 95.0),
    "cells far above triangles": (tube_of(96, 160, 800), (31.0, 31.0), (2.0, 397.0), 63.0, 250.0),
    "cells bent over two creases": (tube_of(5, 4, 600), (23.0, 23.0), (9.0, 297.0), 28.0, 180.0),
    "long cells": (tube_of(25, 3, 400), (24.0, 3.0), (2.0, 197.0), 38.0, 120.0),
    "wide cells, far above triangles": (tube_of(96, 60, 600), (5.0, 41.0), (2.0, 297.0), 71.0, 210.0),
}


def expected_met(
    prism: Prism, spacing: tuple[float, float], seed: tuple[float, float], turn: float, net: meshdrape.Net
) -> NDArray[np.bool_]:
    """Nodes that lie on a cell laid before them, unrolled, and those behind them."""
    i0, j0 = net.seed_index
    i, j = (index.ravel() for index in np.indices(net.shape))
    ring = abs(i - i0) + abs(j - j0)
    c, s = np.cos(turn), np.sin(turn)
    offset = np.stack([i - i0, j - j0], axis=1) * spacing
    unrolled = offset @ np.array([[c, s], [-s, c]]) + seed
    on = prism.in_cloth(spacing, seed, turn, unrolled)
    # one's own place is none of another lap
    on = on[abs(on - (i - i0)[None, :, None] * (1, 0) - (j - j0)[None, :, None] * (0, 1)).max(axis=(1, 2)) > 1e-6]
    assert abs(on - np.round(on)).min() > 1e-6, "a node on a side of a cell would prove nothing"
    cell = np.floor(on).astype(int) + net.seed_index
    kept, cut = np.zeros(net.shape, bool), np.zeros(net.shape, bool)
    for n in np.lexsort((j, i, ring)):
        a, b = i[n], j[n]
        behind = (a != i0 and cut[a - np.sign(a - i0), b]) or (b != j0 and cut[a, b - np.sign(b - j0)])
        inside = (cell[:, n] >= 0).all(axis=1) & (cell[:, n] < np.subtract(net.shape, 1)).all(axis=1)
        met = any(kept[p : p + 2, q : q + 2].all() for p, q in cell[inside, n])
        cut[a, b] = behind or met
        kept[a, b] = not cut[a, b]
    return cut


@pytest.mark.parametrize("name", LAID)
def test_nodes_that_met_the_net_are_those_on_a_cell_once_unrolled(name):
    prism, spacing, seed, degrees, reach = LAID[name]
    turn = np.radians(degrees)
    net = prism.drape(spacing, seed, turn, extent=(reach,) * 4)
    met = expected_met(prism, spacing, seed, turn, net)
    # inside the mould all round: no other reason to end
    assert set(np.unique(net.node_status)) == {NodeStatus.PLACED, NodeStatus.MET_ITSELF}
    np.testing.assert_array_equal(net.node_status == NodeStatus.MET_ITSELF, met)


@pytest.mark.parametrize("spacing", [(30.0, 30.0), (30.0, 9.0), (6.0, 25.0)])
def test_layers_of_a_roll_do_not_meet(spacing):
    """They lie a tenth of a spacing apart, and the mesh's noise does not rule out that the net comes round."""
    net = roll(noise=0.3).drape(spacing, (5.0, 75.0), np.pi / 2)
    assert np.abs(net.mould.surface.vertex_defect[~net.mould.surface.border_vertex]).sum() > np.pi
    assert net.count(NodeStatus.MET_ITSELF) == 0
    assert net.count(NodeStatus.PLACED) > 100


@pytest.mark.parametrize(
    ("corners", "steep", "seed", "direction", "spacing"),
    [
        (8, 0.51, (3.34, -53.6, -25.26), (-1.16, 0.83, -0.59), (35.4, 2.5)),
        (10, 0.44, (31.94, -7.36, -4.39), (-0.13, -0.07, 0.11), (2.1, 25.1)),
        (6, 0.86, (-25.28, -25.68, -22.49), (-0.46, 1.23, 0.96), (2.5, 24.3)),
    ],
)
def test_no_rows_meet_on_a_saddle(corners, steep, seed, direction, spacing):
    """Fibres part on a pyramid whose corners go up and down, though its long cells bend over many edges."""
    azimuth = 2 * np.pi / corners * np.arange(corners)
    height = np.where(np.arange(corners) % 2, steep, -steep)
    rim = np.stack([np.cos(azimuth) * np.cos(height), np.sin(azimuth) * np.cos(height), np.sin(height)], axis=1)
    faces = np.array([[0, 1 + k, 1 + (k + 1) % corners] for k in range(corners)])
    mould = Mesh(np.concatenate([np.zeros((1, 3)), 100 * rim]), faces).mould()
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=direction)
    assert net.count(NodeStatus.MET_ITSELF) == 0


@pytest.mark.parametrize("name", ["cells like triangles", "long cells"])
def test_meeting_does_not_depend_on_the_threads(name):
    prism, spacing, seed, degrees, reach = LAID[name]
    nets = [prism.drape(spacing, seed, np.radians(degrees), extent=(reach,) * 4, threads=n) for n in (1, 3)]
    np.testing.assert_array_equal(nets[0].node_status, nets[1].node_status)
    fields = [read_off(meshdrape.measure(net)) for net in nets]
    for values in ("covered", "warp_angle", "weft_angle", "shear"):
        np.testing.assert_array_equal(getattr(fields[0], values), getattr(fields[1], values))


# --- coverage --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("prism", "spacing", "seed", "degrees", "extent"),
    [
        (tube_of(15, 3, 100), (8.3, 8.3), (3.1, 47.0), 147.0, None),
        (tube_of(28, 3, 100), (31.4, 31.4), (1.7, 47.0), 2.0, None),
        (tube_of(23, 3, 100), (33.3, 33.3), (2.0, 47.0), 248.0, None),
        (tube_of(12, 3, 100), (16.7, 16.7), (3.9, 47.0), 33.0, None),
        (tube_of(96, 60, 200), (9.0, 31.0), (1.3, 97.0), 33.0, None),
        (tube_of(25, 3, 400), (24.0, 3.0), (2.0, 197.0), 38.0, (120.0,) * 4),
        # a quarter of a roll under cloth, and no layer above or below it
        (roll(9), (11.0, 11.0), (90.0, 71.0), 10.0, (60.0, 60.0, 300.0, 300.0)),
        (roll(9), (30.0, 7.0), (90.0, 71.0), 55.0, (100.0, 60.0, 80.0, 90.0)),
    ],
)
def test_covered_are_the_centres_on_whole_cells_once_unrolled(prism, spacing, seed, degrees, extent):
    turn = np.radians(degrees)
    net = prism.drape(spacing, seed, turn, extent=extent)
    field = read_off(meshdrape.measure(net))
    here = net.node_status <= NodeStatus.OFF_MOULD
    whole = here[1:, 1:] & here[:-1, 1:] & here[1:, :-1] & here[:-1, :-1]
    centre = field.vertices[field.triangles].mean(axis=1)
    on = prism.in_cloth(spacing, seed, turn, prism.unrolled(field.parent, centre))
    # a centre on a side of a cell proves nothing
    clear = (abs(on - np.round(on)) > 1e-6).all(axis=(0, 2))
    cell = np.floor(on).astype(int) + net.seed_index
    inside = (cell >= 0).all(axis=2) & (cell < whole.shape).all(axis=2)
    cell[~inside] = 0
    covered = (inside & whole[cell[..., 0], cell[..., 1]]).any(axis=0)
    assert 0 < np.count_nonzero(covered) < len(covered)
    np.testing.assert_array_equal(field.covered[clear], covered[clear])
    # and the fibres run there as on the flat sheet
    assert np.abs(field.shear[field.covered]).max() < 1e-9
