"""Rows that come back to the wing and rows nearly parallel to the edge: the end of section 3.4 of the report."""

import numpy as np
import pytest

from meshdrape.theory import (
    Fold,
    characteristic_net,
    flat,
    grazing_rows,
    linear_deviation,
    quadratic,
    real_wing,
    returning_rows,
    ripple_deviation,
    sine_deviation,
)
from meshdrape.theory.posedness import _last_lower


def test_a_crease_that_only_rises_returns_nothing():
    wing = real_wing()
    assert returning_rows(Fold(wing, wing + linear_deviation(0.1, 14.0))) == []


def test_ripple():
    """Two waves: rows come over at one flank and back at the other, with twice the turn of the steepest slope."""
    fold = Fold(flat(4.0), ripple_deviation(0.05, 2.0, 4.0))
    found = returning_rows(fold)
    assert np.array([(k.start, k.end) for k in found]) == pytest.approx(np.array([(1, 2), (3, 4)]), abs=2e-3)
    for stretch in found:
        assert stretch.drop == pytest.approx(0.1, rel=1e-6)
        assert stretch.turn == pytest.approx(2 * np.arctan(0.05 * np.pi), rel=1e-3)


def test_rows_of_the_left_ribbon_come_back_with_its_own_turn():
    fold = Fold(flat(2.0), linear_deviation(-0.1, 2.0))
    for gamma in (0.0, 0.05, float(fold.psi(0.0))):
        (stretch,) = returning_rows(fold, gamma)
        assert stretch.turn == pytest.approx(abs(np.arctan(0.1) - gamma), abs=1e-12)


def test_as_many_rows_come_back_as_the_net_has_exits():
    wing = real_wing()
    for amplitude in (0.05, 0.08):
        fold = Fold(wing, wing + sine_deviation(amplitude, 3.5, 14.0))
        sheet = characteristic_net(fold, 0.005, 0.3).sheet
        drops = sum(k.drop for k in returning_rows(fold))
        assert abs(len(sheet.exit_row) - drops / 0.005) <= len(returning_rows(fold))
        for y in sheet.y[sheet.exit_column]:
            assert any(k.start - 0.01 <= y <= k.end + 0.01 for k in returning_rows(fold))


@pytest.mark.parametrize(
    "values", [[0.0], [1.0, 1.0, 1.0], np.sin(np.arange(60) ** 2), np.round(np.cos(np.arange(80)), 1)]
)
def test_last_lower_is_found_by_looking_back(values):
    x = np.asarray(values)
    looked = [max((i for i in range(k) if x[i] < x[k]), default=-1) for k in range(len(x))]
    assert _last_lower(x).tolist() == looked


def test_grazing_rows():
    fold = Fold(flat(1.0), quadratic(0.4, 1.0))
    found = grazing_rows(fold, 0.1)
    assert found == pytest.approx(np.array([[0.0, np.tan(0.1) / 0.8]]), abs=1e-3)
    assert len(grazing_rows(Fold(flat(1.0), linear_deviation(0.2, 1.0)), 0.1)) == 0
