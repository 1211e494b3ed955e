"""Section 4 of the study group report, its range of validity, and (24)."""

import numpy as np
import pytest
from rates import orders

from meshdrape.theory import (
    Fold,
    expanded_psi,
    flat,
    lateral_approach,
    lateral_approach_linear,
    named_deviation,
    origami_advance,
    quadratic,
    real_wing,
    ripple_deviation,
    separation_of_scales,
    slope_shear,
    slope_validity,
)

WING = real_wing()


def test_approach_solves_the_link_it_comes_from():
    """(12) with z = f and (9), (16): the link is one spacing long. Held to round-off; (10) without its root is not."""
    rng = np.random.default_rng(1)
    g, f = rng.uniform(-0.5, 0.5, (2, 100))
    spacing = 0.02
    dy = origami_advance(g, spacing) + lateral_approach(g, f, spacing)
    assert np.sqrt((g * dy + f * dy) ** 2 + dy**2 + (f * dy) ** 2) == pytest.approx(spacing, rel=1e-13)
    assert origami_advance(g, spacing) * np.sqrt(1 + g**2) == pytest.approx(spacing, rel=1e-14)


def test_expanded_root_is_of_second_order_and_errs_at_fourth():
    """S is quadratic in f' and g' together, as the text after (18) says."""
    scale = np.array([0.2, 0.1, 0.05])
    exact, linear = lateral_approach(0.5 * scale, scale, 1.0), lateral_approach_linear(0.5 * scale, scale, 1.0)
    assert orders(np.abs(exact))[-1] == pytest.approx(2, abs=0.1)
    assert orders(np.abs(exact - linear))[-1] == pytest.approx(4, abs=0.2)


def test_turn_expanded_about_the_origami_fold():
    """The error of the expansion is of third order in f'; that of (19) of first order, g_w'² / 2 of it."""
    y = np.linspace(0, 14, 29)
    error, first = [], []
    for c in (0.2, 0.1, 0.05):
        f = named_deviation("parabola", 14.0, c=c)
        psi = Fold(WING, WING + f).psi(y)
        error.append(np.abs(psi - expanded_psi(WING, f, y)).max())
        tilt = named_deviation("linear", 14.0, c=c / 10)
        first.append((slope_shear(tilt, 0.0) - np.abs(Fold(WING, WING + tilt).psi(0.0))).max())
    assert orders(error)[-1] == pytest.approx(3, abs=0.15)
    assert orders(first)[-1] == pytest.approx(1, abs=0.05)


def test_slope_criterion_is_safe_by_the_wing_s_slope_only_to_first_order():
    f = named_deviation("linear", 14.0, c=0.01)
    validity = slope_validity(WING, f, 1.0)
    missing = validity.estimate - validity.exact
    explained = validity.from_wing_slope + validity.from_second_order
    assert missing == pytest.approx(explained, abs=2e-7)
    # 3.5 % at 15 degrees
    assert missing[0] / validity.estimate[0] == pytest.approx(1 - np.cos(np.radians(15)), rel=0.05)


def test_validity_of_the_parabola():
    """It speaks of columns up to y = 5.49, and of no wing-fed cell: there 3.04 degrees are reached."""
    validity = slope_validity(WING, named_deviation("parabola", 14.0, c=0.1), 1.0)
    assert validity.y[validity.reached].max() == pytest.approx(5.49, abs=0.07)
    assert np.degrees(validity.wing_fed) == pytest.approx(3.0416, abs=1e-3)
    assert (validity.exact <= validity.estimate).all()


@pytest.mark.parametrize("spacing", [0.003, 0.02, 0.1])
@pytest.mark.parametrize("amplitude", [0.0, 0.002, 0.02])
def test_scale_bound_holds(spacing, amplitude):
    """(24): D <= 4 sqrt(λ g'') bounds what the slopes do between neighbouring ribbons, whatever the profile."""
    for wing in (WING, quadratic(0.01, 14.0), flat(14.0)):
        fold = Fold(wing, wing + ripple_deviation(amplitude, 1.0, 14.0))
        check = separation_of_scales(fold, spacing)
        assert check.slope_change <= check.bound
        assert check.bound == pytest.approx(4 * np.sqrt(check.bend))
        # the turn changes by no more than both slopes together
        assert check.turn_change <= 2 * check.slope_change + 1e-12


def test_too_coarse_a_spacing_is_found_where_the_crease_bends():
    bump = named_deviation("bump", 14.0, c=0.02, length=0.3)
    fold = Fold(WING, WING + bump)
    check = separation_of_scales(fold, 0.05, np.radians(0.5))
    assert len(check.coarse) >= 1
    assert check.coarse[:, 0].min() < 0.3
    assert check.coarse[:, 1].max() < 1.5
    assert check.y < 1
    assert len(separation_of_scales(fold, 0.0005, np.radians(0.5)).coarse) == 0
    assert len(separation_of_scales(Fold(WING, WING), 0.05).coarse) == 0


def test_rows_nearly_parallel_to_the_edge_lie_farther_apart_than_columns():
    """A crease that leaves the rows tangentially: between the first two rows ψ changes like the root of the spacing."""
    fold = Fold(flat(1.0), quadratic(0.4, 1.0))
    change = [separation_of_scales(fold, h).turn_change for h in (0.04, 0.01)]
    assert np.log(change[0] / change[1]) / np.log(4) == pytest.approx(0.5, abs=0.05)
