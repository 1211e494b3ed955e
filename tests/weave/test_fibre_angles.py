"""What the summary says of fibre angles and of the curvature balance."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import meshdrape
from meshdrape.output import json_text
from meshdrape.output.drape_text import drape_text
from meshdrape.weave import read_off
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.summary import shortest_arc, summarise

RAD = np.radians


@pytest.mark.parametrize(("angles", "arc"), [
    ([85, -85], (85, 95)), ([90, -90], (90, 90)), ([-90], (90, 90)), ([-89, -91], (89, 91)), ([10, 20], (10, 20)),
    ([-60], (-60, -60)), ([-80, 80, 89], (80, 100)), ([-70, -80], (-80, -70)), ([-89.9999999999, 90.0], (90, 90)),
    ([-50, -90], (-90, -50)), ([30, 30, 30], (30, 30)), ([0, 60, -60], (-60, 60)),
])  # fmt: skip
def test_arcs(angles, arc):
    assert np.degrees(shortest_arc(RAD(angles))) == pytest.approx(arc, abs=1e-6)


@given(st.lists(st.floats(-90, 90), min_size=1, max_size=12), st.floats(-400, 400))
def test_the_shortest_arc_holds_all(degrees, turn):
    """Against every arc that begins at one of the angles; and it turns with them."""
    angles = RAD(degrees)
    low, high = shortest_arc(angles)
    assert np.mod(angles - low + 1e-9, np.pi).max() <= high - low + 2e-9
    every = [np.mod(angles - first + 1e-12, np.pi).max() for first in angles]
    assert high - low == pytest.approx(min(every), abs=1e-9)
    assert -np.pi / 2 - 1e-8 < (low + high) / 2 <= np.pi / 2 + 1e-8
    turned = shortest_arc(angles + RAD(turn))
    assert turned[1] - turned[0] == pytest.approx(high - low, abs=1e-9)


def pyramid():
    """Four equilateral triangles about an apex with an angle defect of 120 degrees."""
    corners = 1000 / np.sqrt(2) * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)]) / np.sqrt(2)
    vertices = np.vstack([[0.0, 0.0, 0.0], np.column_stack([corners, np.full(4, -1000 / np.sqrt(2))])])
    return meshdrape.Mould.from_arrays(vertices, np.array([(0, k + 1, (k + 1) % 4 + 1) for k in range(4)]))


@pytest.mark.parametrize(("spacing", "direction"), [(20.0, (0.05, 1, 0)), (20.0, (0.2, 1, 0)), (40.0, (-0.07, 1, 0))])
def test_an_apex_leaves_nothing_open(spacing, direction):
    """In its row and column of cells too, where it counts by the part beyond which each lies, shear is foretold."""
    net = meshdrape.drape(pyramid(), meshdrape.Fabric(spacing), (0, 222, -314), direction)
    measures = meshdrape.measure(net)
    foretold = balance(measures)
    summary = summary_of(measures, foretold)
    # half of the apex's 120 degrees would be 60 off in the worst cell
    assert summary["max_shear_deg"] > 30
    assert np.degrees(np.abs(foretold.cell_defect).max()) == pytest.approx(120)
    assert summary["balance_residual_deg"] < 1e-9
    (row,) = (line for line in drape_text(summary).splitlines() if line.startswith("   balance"))
    assert "open" not in row


def summary_of(measures, foretold):
    return summarise(
        measures, read_off(measures), meshdrape.audit(measures.net, 20), foretold, {"total": 0.0}, "meshdrape drape"
    )


def test_a_shear_that_is_not_foretold_is_told():
    """A net whose shear is not that of the curvature under it: more than its vertices leave open."""
    net = meshdrape.drape(pyramid(), meshdrape.Fabric(40.0), (0, 222, -314), (-0.07, 1, 0))
    measures = meshdrape.measure(net)
    shear = measures.cell_shear.copy()
    i, j = np.argwhere(measures.cell_touches_mould)[7]
    shear[i, j] += RAD(9.0)
    wrong = replace(measures, cell_shear=shear)
    summary = summary_of(wrong, balance(wrong))
    assert summary["balance_residual_deg"] == pytest.approx(9.0, abs=1e-9)
    (row,) = (line for line in drape_text(summary).splitlines() if line.startswith("   balance"))
    assert "shear within 9 deg" in row
    assert row.endswith("that this leaves open")


def test_a_net_without_cells_says_so_in_words():
    """Cloth of less than a cell: no number where there is none, and null in JSON."""
    net = meshdrape.drape(pyramid(), meshdrape.Fabric(40.0), (0, 222, -314), (0.1, 1, 0), extent=(100, 100, 0, 0))
    measures = meshdrape.measure(net)
    assert measures.n_cells == 0
    summary = summary_of(measures, balance(measures))
    page = drape_text(summary)
    assert "max shear  none: no whole cell lies on the mould\n" in page
    assert "  balance  no cell whose shear could be foretold\n" in page
    assert "nan" not in page.lower().replace("meshdrape", "")
    told = json.loads(json_text(summary))
    for name in ("max_shear_deg", "max_shear_at", "balance_residual_deg", "balance_residual_at"):
        assert told[name] is None, name
