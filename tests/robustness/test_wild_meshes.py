"""Whatever the mesh, spacing and start: no crash, no hang, exact edges, the same net on any number of threads."""

import faulthandler
import json
import time
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from wild import KINDS, WildDrape

import meshdrape
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.measures.field import read_off
from meshdrape.weave.summary import summarise

SECONDS = 30.0


@pytest.fixture(autouse=True)
def ends() -> Iterator[None]:
    """A hang within compiled code ends the run and says where."""
    faulthandler.dump_traceback_later(20 * SECONDS, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=5)
@given(number=st.integers(0, 10**6))
def test_drape(kind, number):
    case = WildDrape.drawn(kind, number, most_nodes=900)
    begun = time.perf_counter()
    net = case.drape(threads=1)
    assert_sound(net)
    assert_same(net, case.drape(threads=2))
    assert_measured(net)
    assert_edges_exact(net, case)
    assert time.perf_counter() - begun < SECONDS, case


def assert_sound(net: meshdrape.Net) -> None:
    """Places exactly where the statuses say, on the mould or its extension, neighbours no farther than a spacing."""
    here = net.node_status <= meshdrape.NodeStatus.OFF_MOULD
    assert net.node_status.max() <= max(meshdrape.NodeStatus)
    assert net.node_status[net.seed_index] == meshdrape.NodeStatus.PLACED
    assert np.array_equal(here, np.isfinite(net.node_position).all(axis=-1))
    assert np.array_equal(here, np.isfinite(net.node_position).any(axis=-1))
    assert net.node_position[net.seed_index] == pytest.approx(net.seed, abs=1e-9 * net.mould.surface.diagonal)
    face = net.lattice.face[here]
    assert face.min() >= 0
    assert face.max() < len(net.surface.faces)
    on_mould = net.lattice.face[net.node_status == meshdrape.NodeStatus.PLACED]
    beyond = on_mould[net.surface.face_rim[on_mould] >= 0]
    # on the extension a node is on the mould only within round-off of the border
    assert (net.surface.face_rim[beyond] > 0).all()
    for axis, spacing in ((0, net.fabric.warp_spacing), (1, net.fabric.weft_spacing)):
        chord = np.linalg.norm(np.diff(net.node_position, axis=axis), axis=-1)
        assert not (chord > spacing * (1 + 1e-9) + 1e-12 * net.surface.diagonal).any()


def assert_same(net: meshdrape.Net, other: meshdrape.Net) -> None:
    """Equal to the last bit."""
    assert net.shape == other.shape
    for name in ("node_status", "node_position", "warp_direction", "weft_direction"):
        assert np.array_equal(getattr(net, name), getattr(other, name), equal_nan=True), name
    first, second = meshdrape.measure(net), meshdrape.measure(other)
    assert np.array_equal(first.cell_shear, second.cell_shear, equal_nan=True)


def assert_measured(net: meshdrape.Net) -> None:
    """Figures that can be, and a summary without a number that is none but where nothing was measured."""
    measures = meshdrape.measure(net)
    field = read_off(measures)
    assert 0 <= field.coverage_fraction <= 1 + 1e-12
    assert 0 <= measures.over_locking_fraction <= 1
    assert measures.n_cells == 0 or 0 <= measures.max_shear < np.pi
    covered = float(field.area[field.covered].sum())
    cell = measures.cloth[2] / max(measures.n_cells, 1)
    # a cell sheared has less area than in the flat; pieces of the mould are counted by their centres, and each can
    # stick out of the cells at the rim
    piece = float(field.area.max())
    rim = 4 * (net.shape[0] + net.shape[1]) + np.count_nonzero(net.node_status > 0)
    if net.fabric.initial_angle == np.pi / 2 and piece < cell:
        assert covered <= measures.cloth[2] + rim * piece
    audit = meshdrape.audit(net, 10)
    summary = summarise(measures, field, audit, balance(measures), {"total": 0.0}, "")
    for where in summary["first_places"].values():
        assert np.isfinite(where["near"]).all()
    assert json.loads(json.dumps(summary))["nodes"] == net.count(meshdrape.NodeStatus.PLACED)


def assert_edges_exact(net: meshdrape.Net, case: WildDrape) -> None:
    """To 1e-9 of the spacing as libigl measures; generators alone may pass a vertex straight and not be shortest."""
    found = meshdrape.audit(net, 60, seconds=SECONDS / 3)
    assert not found.n_edges or found.max_relative_error < 1e-9, (case, found)
    assert not found.n_second_routes, (case, found)
