"""What the summary says of fibre angles and of the curvature balance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import meshdrape
from meshdrape.output.drape_text import drape_text
from meshdrape.weave import read_off
from meshdrape.weave.balance import balance
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
def test_what_an_apex_leaves_open_is_told(spacing, direction):
    """Beside the apex's row of cells the balance counts half of it: no more than that is off, and the page says why."""
    net = meshdrape.drape(pyramid(), meshdrape.Fabric(spacing), (0, 222, -314), direction)
    measures = meshdrape.measure(net)
    foretold = balance(measures)
    summary = summarise(
        measures, read_off(measures), meshdrape.audit(net, 20), foretold, {"total": 0.0}, "meshdrape drape"
    )
    assert summary["balance_residual_deg"] > 30
    assert summary["balance_open_deg"] == pytest.approx(60.0)
    assert summary["balance_residual_deg"] <= summary["balance_open_deg"]
    (row,) = (line for line in drape_text(summary).splitlines() if line.startswith("   balance"))
    assert "agrees" not in row
    assert row.endswith("leaves 60 deg open")
    # cells of which no defect lies in the last row or column are foretold to round-off
    i, j = np.argwhere(foretold.cell_defect > 1).T
    clear = np.ones_like(foretold.residual, dtype=bool)
    clear[i], clear[:, j] = False, False
    assert np.nanmax(np.abs(foretold.residual[clear])) < 1e-11
