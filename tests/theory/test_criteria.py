"""The report's criteria (20), (29) to (32) and the sharper maximum over pairs that meet within the spar's height.

Source: Barton et al., New Techniques for Composite Wing Manufacture, sections 4 and 6.4; its errata in the docstrings.
"""

import numpy as np
import pytest

from meshdrape.errors import DesignError
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    fits_everywhere,
    flat,
    linear_deviation,
    middle_gamma,
    named_deviation,
    psi_range,
    quadratic,
    real_wing,
    ribbon_fed_bound,
    ribbon_reach,
    ripple_deviation,
    slope_criterion,
    turning_points,
    wing_fed_bound,
    within_reach,
)

WING = real_wing()
# f: (29), (20), and the maximum within reach sampled at stations less than 0.1 apart, wing-fed and ribbon-fed
REAL = {
    "parabola": (5.688, 5.711, 3.037, 2.219),
    "linear": (0.238, 5.711, 0.168, 5.623),
    "sin2_slope": (5.670, 5.711, 5.669, 4.556),
}
SINE = {"c": 0.05, "wavelength": 3.5}


def deviation(name):
    return named_deviation(name, 14.0, **(SINE if name == "sine" else {"c": 0.1}))


def fold_of(name):
    return Fold(WING, WING + deviation(name))


@pytest.mark.parametrize("name", REAL)
def test_bounds_of_the_real_wing(name):
    assert np.degrees(wing_fed_bound(fold_of(name))) == pytest.approx(REAL[name][0], abs=6e-4)
    assert np.degrees(slope_criterion(deviation(name)).value) == pytest.approx(REAL[name][1], abs=6e-4)


@pytest.mark.parametrize("name", REAL)
def test_within_reach_of_the_real_wing(name):
    """Never below the sampled maximum, and above it by no more than ψ changes between two samples of 0.1."""
    reach = within_reach(fold_of(name), 1.0)
    y = np.linspace(0, 14, 2001)
    slack = np.degrees(np.abs(fold_of(name).psi_slope(y)).max()) * 0.1
    for found, sampled in zip((reach.wing_fed, reach.ribbon_fed), REAL[name][2:], strict=True):
        assert -6e-4 < np.degrees(found.shear) - sampled < slack


@pytest.mark.parametrize("name", [*REAL, "sine"])
@pytest.mark.parametrize("gamma", [0.0, -0.05, 0.03])
def test_what_hangs_on_gamma_may_be_asked_alone(name, gamma):
    fold = fold_of(name)
    reach = within_reach(fold, 0.7, gamma)
    for alone in (ribbon_reach(fold, 0.7, gamma), ribbon_reach(fold, 0.7, gamma, turning_points(fold))):
        assert (reach.ribbon_fed, reach.gamma_best, reach.ribbon_fed_best) == alone
    assert reach.wing_fed == within_reach(fold, 0.7).wing_fed


@pytest.mark.parametrize("name", REAL)
def test_ribbon_fed_at_stations_of_a_twentieth(name):
    """The published ribbon-fed figures, digit by digit: columns at 280 equal arcs of the wing, the deepest in reach."""
    fold = fold_of(name)
    last = within_reach(fold, 1.0).ribbon_fed.y1
    step = WING.length / 280
    column = WING.at_arc_length(np.floor(WING.arc_length(last) / step) * step)
    assert np.degrees(abs(fold.psi(column))) == pytest.approx(REAL[name][3], abs=6e-4)


@pytest.mark.parametrize("name", [*REAL, "sine"])
@pytest.mark.parametrize("height", [0.3, 1.0])
def test_within_reach_is_the_limit_of_the_net(name, height):
    """The characteristic net's own largest shear comes up to it from below as the spacing falls, first order."""
    if name == "sine":
        fold = Fold(quadratic(0.03, 14.0), quadratic(0.03, 14.0) + 0.3 * deviation("sine"))
    else:
        fold = fold_of(name)
    reach = within_reach(fold, height)
    short = []
    for spacing in (0.04, 0.02, 0.01):
        net = characteristic_net(fold, spacing, height)
        # the first column is turned by the kink of the ribbon at the corner, which is no matter of spacing
        fed = (net.region == RIBBON_FED) & net.within
        fed[0] = False
        found = net.max_shear(WING_FED).shear, np.abs(net.shear[fed]).max()
        short.append([reach.wing_fed.shear - found[0], reach.ribbon_fed.shear - found[1]])
    short = np.degrees(short)
    assert (short > -1e-9).all(), short
    # a few spacings' change of ψ: rows are this far apart along a shallow crease
    assert (short[-1] < 0.65 * short[0] + 1e-6).all(), short
    assert (short[-1] < 0.12).all(), short


@pytest.mark.parametrize("name", [*REAL, "sine"])
def test_pairs_against_trying_all_of_them(name):
    fold, height = fold_of(name), 0.7
    y = np.linspace(0, 14, 561)
    shear = np.abs(fold.psi(y)[None] - fold.psi(y)[:, None])
    drift = fold.drift(y)
    place = (fold.spar_edge(y) - drift)[:, None] + drift[None]
    depth = fold.depth(np.stack([place.real, place.imag], axis=-1))
    # the row of y0 has stayed on the spar up to y1
    x = fold.spar(y)
    stays = np.array([np.minimum.accumulate(np.where(y > y0, x, np.inf)) > g for y0, g in zip(y, x, strict=True)])
    meets = (y[None] > y[:, None]) & (depth <= height) & stays & (place.real <= fold.spar.length)
    brute = np.where(meets, shear, 0).max()
    pair = within_reach(fold, height).wing_fed
    change = np.abs(fold.psi_slope(y)).max() * (y[1] - y[0])
    assert 0 <= pair.shear - brute < 2 * change
    assert abs(fold.psi(pair.y1) - fold.psi(pair.y0)) == pytest.approx(pair.shear, abs=1e-14)


def test_within_reach_of_a_high_spar_is_the_bound():
    """(29), (30) and (31) are exact where all pairs y0 < y1 meet and ψ falls all the way."""
    fold = Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0))
    reach = within_reach(fold, 3.0, -0.1)
    assert reach.wing_fed == pytest.approx((wing_fed_bound(fold), 0.0, 1.0), abs=1e-8)
    gamma, bound = middle_gamma(fold)
    assert (reach.gamma_best, reach.ribbon_fed_best) == pytest.approx((gamma, bound), abs=1e-12)
    assert reach.ribbon_fed.shear == pytest.approx(ribbon_fed_bound(fold, -0.1), abs=1e-12)


@pytest.mark.parametrize("name", REAL)
def test_best_gamma(name):
    fold = fold_of(name)
    reach = within_reach(fold, 1.0)
    best = within_reach(fold, 1.0, reach.gamma_best)
    assert best.ribbon_fed.shear == pytest.approx(reach.ribbon_fed_best, abs=1e-12)
    assert best.wing_fed == reach.wing_fed
    for off in (-1e-4, 1e-4):
        worse = within_reach(fold, 1.0, reach.gamma_best + off)
        assert worse.ribbon_fed.shear == pytest.approx(reach.ribbon_fed_best + 1e-4, abs=1e-9)
    # no gamma of (31), which looks at the whole crease, does better
    assert within_reach(fold, 1.0, middle_gamma(fold)[0]).ribbon_fed.shear >= reach.ribbon_fed_best


def test_tilted_spar():
    """What (20) calls 5.711 degrees nearly vanishes with the left ribbon turned along."""
    fold = fold_of("linear")
    reach = within_reach(fold, 1.0)
    assert np.degrees(reach.ribbon_fed_best) < 0.09
    assert np.degrees(reach.wing_fed.shear) < 0.18


def test_slope_criterion_is_unsafe_where_the_slope_changes_sign():
    """Up to twice too small: the wing-fed cells see the range of ψ."""
    reach = within_reach(fold_of("sine"), 1.0)
    ratio = reach.wing_fed.shear / slope_criterion(deviation("sine")).value
    assert 1.9 < ratio < 2.05


def test_slope_criterion_is_exact_for_a_flat_wing_or_spar():
    """Upright left ribbon; (21)."""
    f = quadratic(0.03, 2.0)
    for fold in (Fold(flat(2.0), f), Fold(-f, flat(2.0))):
        assert within_reach(fold, 1.0).ribbon_fed.shear == pytest.approx(slope_criterion(f).value, abs=1e-12)


def test_psi_range_and_turning_points():
    fold = Fold(flat(4.0), ripple_deviation(0.02, 2.0, 4.0))
    assert turning_points(fold) == pytest.approx([0.5, 1.5, 2.5, 3.5], abs=1e-9)
    least, greatest = psi_range(fold)
    steep = np.arctan(0.02 * np.pi)
    assert (least.value, greatest.value) == pytest.approx((-steep, steep), abs=1e-14)
    assert min(abs(least.y - np.array([0.5, 2.5]))) < 1e-6
    assert fits_everywhere(fold, 2 * steep + 1e-12)
    assert not fits_everywhere(fold, 2 * steep - 1e-12)


def test_a_spar_no_row_comes_onto():
    """A crease that falls away takes rows back at once: no wing-fed pair at all."""
    fold = Fold(flat(2.0), linear_deviation(-0.1, 2.0))
    assert within_reach(fold, 0.5).wing_fed.shear == 0


def test_refused():
    with pytest.raises(DesignError, match=r"height=-1.0"):
        within_reach(fold_of("parabola"), -1.0)
