"""Any fold: profiles and deviations of every kind, drawn at random, and what must hold of all of them.

The exact net is the discrete one, which `test_fold_nets` holds node by node against a search without the fold's theory.
"""

import numpy as np
import pytest

from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    discrete_net,
    named_deviation,
    named_profile,
    psi_range,
    ribbon_fed_bound,
    slope_criterion,
    wing_fed_bound,
    within_reach,
)

SEEDS = range(12)
SPACING = 0.02


def profile(random, span):
    """g of a wing or a spar, rising by no more than a slope of 0.3."""
    name = random.choice(["real", "flat", "quadratic", "arc", "table"])
    y = np.linspace(0, span, int(random.integers(4, 8)))
    parameters = {
        "real": {},
        "flat": {},
        "quadratic": {"a": random.uniform(-0.1, 0.15) / span},
        "arc": {"radius": random.uniform(3, 8) * span},
        "table": {"y": y, "g": np.append(0, np.cumsum(random.uniform(0, 0.25, len(y) - 1))) * y[1]},
    }
    return named_profile(name, span, **parameters[name])


def deviation(random, span):
    name = random.choice(["none", "linear", "parabola", "sine", "sin2_slope", "bump", "ripple", "table"])
    slope, wave = random.uniform(-0.15, 0.2), span * random.uniform(0.4, 3)
    y = np.linspace(0, span, int(random.integers(4, 8)))
    parameters = {
        "none": {},
        "linear": {"c": slope},
        "parabola": {"c": slope},
        "sin2_slope": {"c": slope},
        "sine": {"c": slope * wave / 7, "wavelength": wave},
        "ripple": {"c": slope * wave / 7, "wavelength": wave},
        "bump": {"c": slope * wave / 2, "length": wave},
        "table": {"y": y, "f": random.uniform(-0.02, 0.03, len(y)) * y[1]},
    }
    return named_deviation(name, span, **parameters[name])


def fold_of(seed):
    """A fold whose rows do not come back, seen from either side and either end; height, gamma, offset of its first row.

    It turns the net by less than 15 degrees: where it turns it by 30 within 3 m, 20 mm are out by a tenth of a degree.
    """
    random = np.random.default_rng(seed)
    while True:
        span = random.uniform(1.5, 5)
        wing = profile(random, span)
        spar = wing + deviation(random, span) if random.random() < 0.7 else profile(random, span)
        fold = Fold(wing, spar)
        if random.random() < 0.3:
            fold = fold.reversed()
        if random.random() < 0.3:
            fold = fold.swapped()
        y = np.linspace(0, span, 2001)
        if (fold.spar.slope(y) > -1e-12).all() and np.abs(fold.psi(y)).max() < np.radians(15):
            return fold, random.uniform(0.1, 0.4) * span, random.uniform(-0.15, 0.15), random.choice([0, 0.5, 0.3, 1])


@pytest.mark.parametrize("seed", SEEDS)
def test_characteristics_are_the_exact_net(seed):
    """Largest shear of either region to 0.02 degrees, at 20 mm; and below what the smooth limit allows within reach."""
    fold, height, gamma, offset = fold_of(seed)
    exact, net = (build(fold, SPACING, height, gamma, offset) for build in (discrete_net, characteristic_net))
    reach = within_reach(fold, height, gamma)
    for region, most in ((WING_FED, reach.wing_fed), (RIBBON_FED, reach.ribbon_fed)):
        found = np.degrees(net.max_shear(region).shear)
        assert found == pytest.approx(np.degrees(exact.max_shear(region).shear), abs=0.02)
        # but for the kink at the corner, which turns the first column by 0.02 of it
        kink = 0.02 * abs(np.degrees(gamma - fold.psi(0.0)))
        assert found < np.degrees(most.shear) + kink + 0.02


@pytest.mark.parametrize("seed", SEEDS)
def test_reach_lies_within_the_bounds(seed):
    fold, height, gamma, _ = fold_of(seed)
    reach = within_reach(fold, height, gamma)
    assert reach.wing_fed.shear <= wing_fed_bound(fold) + 1e-12
    assert reach.ribbon_fed.shear <= ribbon_fed_bound(fold, gamma) + 1e-12
    assert reach.ribbon_fed_best <= reach.ribbon_fed.shear + 1e-12
    # nothing hides on a spar that is higher, and the pair that sets the maximum does set it
    assert within_reach(fold, 2 * height).wing_fed.shear >= reach.wing_fed.shear - 1e-9
    pair = reach.wing_fed
    assert abs(fold.psi(pair.y1) - fold.psi(pair.y0)) == pytest.approx(pair.shear, abs=1e-9)
    assert pair.y0 <= pair.y1


@pytest.mark.parametrize("seed", SEEDS)
def test_best_gamma_is_the_best(seed):
    """By looking: no other gamma leaves the ribbon-fed rows less shear."""
    fold, height, _, _ = fold_of(seed)
    best = within_reach(fold, height).gamma_best
    least = within_reach(fold, height, best).ribbon_fed.shear
    others = [within_reach(fold, height, best + turn).ribbon_fed.shear for turn in np.radians(np.linspace(-3, 3, 13))]
    assert least <= min(others) + np.radians(1e-3)


@pytest.mark.parametrize("seed", SEEDS)
def test_angles_do_not_know_the_unit(seed):
    """All lengths a thousandfold: the same angles."""
    fold, height, gamma, offset = fold_of(seed)

    def larger(g):
        k = 1000.0
        return type(g)(
            k * g.span,
            lambda y: k * g.value(y / k),
            lambda y: g.derivative(y / k),
            lambda y: g.second_derivative(y / k) / k,
            tuple(k * y for y in g.breaks),
        )

    other = Fold(larger(fold.wing), larger(fold.spar))
    assert slope_criterion(other.spar - other.wing).value == pytest.approx(
        slope_criterion(fold.spar - fold.wing).value, abs=1e-9
    )
    one, two = within_reach(fold, height, gamma), within_reach(other, 1000 * height, gamma)
    for name in ("wing_fed", "ribbon_fed"):
        assert getattr(two, name).shear == pytest.approx(getattr(one, name).shear, abs=1e-8)
    nets = [
        characteristic_net(f, k * SPACING * 2, k * height, gamma, offset) for f, k in ((fold, 1.0), (other, 1000.0))
    ]
    for region in (WING_FED, RIBBON_FED):
        assert nets[1].max_shear(region).shear == pytest.approx(nets[0].max_shear(region).shear, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_fold_seen_twice_from_elsewhere_is_itself(seed):
    fold, height, gamma, _ = fold_of(seed)
    y = np.linspace(0, fold.span, 201)
    for twice in (fold.swapped().swapped(), fold.reversed().reversed()):
        assert twice.psi(y) == pytest.approx(fold.psi(y), abs=1e-12)
        same = within_reach(twice, height, gamma)
        assert same.wing_fed.shear == pytest.approx(within_reach(fold, height, gamma).wing_fed.shear, abs=1e-9)
    # seen from the other side or the other end the edge turns the net by as much
    least, greatest = psi_range(fold)
    for other in (fold.swapped(), fold.reversed()):
        there = psi_range(other)
        assert sorted(map(abs, (there.least.value, there.greatest.value))) == pytest.approx(
            sorted(map(abs, (least.value, greatest.value))), abs=1e-9
        )
