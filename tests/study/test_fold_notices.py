"""Warnings that name places: where rows come back, graze the edge, or lie too far apart."""

import numpy as np
import pytest
from fold_designs import FIGURE_4, design, draped

from meshdrape.study.fold.criteria import verdict
from meshdrape.study.fold.notices import notices
from meshdrape.study.fold.ways import ways


def warned(of):
    drape = draped(of)
    said = verdict(of, drape)
    return said, {one.kind: one for one in notices(of, drape, said)}


def test_the_real_wing_needs_no_warning():
    said, found = warned(design())
    assert found == {}
    assert said.feasible


def test_rows_that_come_back():
    """A bump steep enough for g_s to fall: the stretch of the fall, and the wing's cells in the drape shear there."""
    said, found = warned(design(spar={"deviation": "bump", "c": 0.6, "length": 4.0}, spacing=0.05))
    y = np.linspace(0, 14, 14001)
    r = y / 4
    rise = 0.6 * 2 * r * (1 - r * r) * np.exp(1 - r * r) / 4 + 0.047227544 + 0.220721648 * np.exp(-y / 3.731291642)
    falls = 1000 * y[rise < 0]
    back = found["returning"]
    assert "ill-posed" in back.text
    assert (back.start, back.end) == pytest.approx((falls[0], falls[-1]), abs=10)
    assert f"y = {back.start:,.0f} to {back.end:,.0f} mm" in back.text
    assert np.degrees(said.first_sheet) > 1
    assert "rows come back" in said.remarks["drape"]


def test_rows_that_graze_and_ribbons_too_far_apart():
    """Figure 4 starts level: within a degree of the edge while 0.8 y < tan 1°, and ψ runs away between two rows."""
    _, found = warned(design(FIGURE_4))
    assert found["grazing"].start == 0
    assert found["grazing"].end == pytest.approx(1000 * np.tan(np.radians(1)) / 0.8, abs=0.5)
    assert "condition (24)" in found["coarse"].text
    assert found["coarse"].start == 0


def test_narrow_wing_is_told():
    _, found = warned(design(chord=1.2, spacing=0.1))
    assert "no row stays on the wing" in found["mould"].text


def test_ways_to_lay_the_real_wing():
    """It rises from the root: well-posed from there on the wing, from the tip on the spar; best is psi's middle."""
    laying = ways(design())
    assert {(one.first, one.end) for one in laying.choices if one.well_posed} == {("wing", "root"), ("spar", "tip")}
    assert laying.best == laying.choices[0]
    largest = [one.largest for one in laying.choices if one.well_posed]
    assert largest == sorted(largest) or np.diff(largest).min() > -1e-6
    own = {one.rule: one.shear for one in laying.choices if (one.first, one.end) == ("wing", "root")}
    assert own["best"].ribbon_fed < 0.53 * own["gamma 0"].ribbon_fed
    assert own["best"].wing_fed == own["gamma 0"].wing_fed


def test_a_locking_angle_in_radians_is_noticed():
    """7 degrees are 0.122 radians; as degrees that is no cloth's locking angle."""
    _, found = warned(design(locking_angle_deg=0.122, spacing=0.2))
    assert "6.99 if that was radians" in found["locking"].text
    assert "locking" not in warned(design(spacing=0.2))[1]
