"""Section 5 of the study group report: the flat spar and its sensitivity to placing."""

import numpy as np
import pytest

from meshdrape.errors import DesignError
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    flat,
    flat_spar_shear,
    linear_deviation,
    quadratic,
    random_placements,
    real_wing,
    slope_criterion,
    within_reach,
)

WING = quadratic(0.05, 2.0)


def test_flat_spar_is_the_ribbon_fed_region():
    """(21) with f = -g_w, exact, at gamma = 0."""
    fold = Fold(WING, flat(2.0))
    y = np.linspace(0, 2, 21)
    assert flat_spar_shear(WING, y) == pytest.approx(np.abs(fold.psi(y)), abs=1e-15)
    reach = within_reach(fold, 0.5)
    assert reach.ribbon_fed.shear == pytest.approx(slope_criterion(-WING).value, abs=1e-14)
    assert reach.wing_fed.shear == 0


def test_placed_without_error():
    placed = random_placements(WING, 0.005, 0.5, 0.0, trials=5)
    assert placed.spar == pytest.approx(np.full(5, placed.exact), abs=1e-15)
    assert (placed.wing == 0).all()
    assert placed.exact == pytest.approx(np.arctan(0.2), abs=1e-15)


def test_small_errors_move_the_spar_s_shear_by_as_much_and_the_wing_s_by_all_of_it():
    sigma = 0.01
    placed = random_placements(WING, 0.005, 0.5, sigma, trials=1000, seed=3)
    off = np.abs(placed.spar - placed.exact)
    assert (off <= np.abs(placed.tilt) + np.abs(placed.gamma) + 1e-12).all()
    spread, sheared = placed.spread()
    # where the edge falls the steepest station shears by tilt - gamma more; where it rises wing-fed cells hold it up
    falls = placed.tilt > 0
    assert (placed.spar - placed.exact)[falls] == pytest.approx((placed.tilt - placed.gamma)[falls], abs=1e-12)
    assert sigma < spread < np.sqrt(2) * sigma
    # half of all tilts let the edge fall; those of more than about half a spacing over the span bring rows up
    assert 0.3 < sheared < 0.5
    assert (placed.wing[placed.tilt <= 0] == 0).all()
    assert placed.wing[placed.wing > 0].min() > 0.5 * placed.exact


def test_placements_are_seeded():
    first, again, other = (random_placements(WING, 0.01, 0.5, 0.02, trials=50, seed=k) for k in (4, 4, 5))
    assert np.array_equal(first.spar, again.spar)
    assert not np.array_equal(first.spar, other.spar)


def test_tilted_sheet_against_the_characteristics_of_a_tilted_fold():
    """A flat wing and a straight edge seen tilted are the skew spar: the same ψ, the same shear."""
    placed = random_placements(flat(2.0), 0.02, 0.5, 0.1, trials=16, seed=1)
    for tilt, gamma, spar in zip(placed.tilt, placed.gamma, placed.spar, strict=True):
        if tilt < 0:  # the edge rises in the sheet's frame like x = -tan(tilt) s
            net = characteristic_net(Fold(flat(2.0), linear_deviation(-np.tan(tilt), 2.0)), 0.02, 0.5, gamma)
            fed = net.region == RIBBON_FED
            fed[0] = False  # turned by the kink at the corner
            assert np.abs(net.shear[fed]).max() == pytest.approx(spar, abs=1e-9)
            assert net.max_shear(WING_FED).shear == pytest.approx(0, abs=1e-9)


def test_real_wing_with_a_flat_spar():
    placed = random_placements(real_wing(), 0.02, 1.0, np.radians(0.1), trials=200)
    assert np.degrees(placed.exact) == pytest.approx(15, abs=1e-5)


def test_refused():
    with pytest.raises(DesignError, match=r"sigma=0.3"):
        random_placements(WING, 0.01, 0.5, 0.3)
