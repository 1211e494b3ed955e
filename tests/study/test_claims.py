"""The report recomputed: verdicts come out of numbers, and change when a formula does."""

from __future__ import annotations

import numpy as np
import pytest

from meshdrape.study.claims import (
    Runs,
    Verdict,
    section_4,
    section_5,
    section_6,
    section_7,
    section_7_edges,
    sections_2_3,
)
from meshdrape.study.claims import judgement as rule
from meshdrape.study.claims.claim import angle
from meshdrape.study.claims.drapes import drape_fold
from meshdrape.theory import RIBBON_FED, WING_FED, Fold, quadratic, within_reach
from meshdrape.theory import fold as fold_module


@pytest.fixture(scope="module")
def runs():
    return Runs(quick=True)


# --- rules -----------------------------------------------------------------------------------------------------------


def test_rules_turn_on_their_thresholds():
    for judged, verdict in (
        (rule.equality([0.5, -1.0], 1.0), Verdict.HOLDS),
        (rule.equality([0.5, -1.1], 1.0), Verdict.WRONG),
        (rule.printed(0.9, 2.0, 1.0), Verdict.HOLDS),
        (rule.printed(1.1, 0.9, 1.0), Verdict.MISPRINT),
        (rule.printed(1.1, 1.1, 1.0), Verdict.WRONG),
        (rule.signed(2.0, 0.0, 0.1), Verdict.SIGN),
        (rule.signed(2.0, 0.2, 0.1), Verdict.WRONG),
        (rule.first_order([4e-2, 1e-2], 1.9), Verdict.FIRST_ORDER),
        (rule.first_order([4e-2, 2e-2], 1.9), Verdict.WRONG),
        (rule.first_order([1e-12, 1e-12], 1.9), Verdict.HOLDS),
        (rule.criterion([1.0, 1.0], [0.99, 1.0], 0.05), Verdict.HOLDS),
        (rule.criterion([1.0, 1.0], [1.0, 0.5], 0.05), Verdict.TOO_STRICT),
        (rule.criterion([1.0, 1.0], [1.0, 1.5], 0.05), Verdict.UNSAFE),
        (rule.criterion([1.0, 1.0], [0.5, 1.5], 0.05), Verdict.UNSAFE_AND_STRICT),
        (rule.bound([1.0, 1.0], [1.0, 0.5], 0.05), Verdict.UPPER_BOUND),
        (rule.bound([1.0, 1.0], [0.5, 1.5], 0.05), Verdict.UNSAFE),
        (rule.optimum([0.2], [0.1], 0.05), Verdict.NOT_BEST),
        (rule.optimum([0.1], [0.1], 0.05), Verdict.HOLDS),
        (rule.condition(0, 0, 9), Verdict.HOLDS),
        (rule.condition(0, 3, 9), Verdict.SUFFICIENT),
        (rule.condition(3, 0, 9), Verdict.NECESSARY),
        (rule.condition(1, 1, 9), Verdict.WRONG),
        (rule.named_region(0.0, 1.0, 0.1), Verdict.HOLDS),
        (rule.named_region(1.0, 0.0, 0.1), Verdict.SWAPPED),
        (rule.named_region(1.0, 1.0, 0.1), Verdict.WRONG),
        (rule.conditional(0.0, 0.0, 0.1), Verdict.HOLDS),
        (rule.conditional(0.0, 1.0, 0.1), Verdict.CONDITIONAL),
        (rule.conditional(1.0, 0.0, 0.1), Verdict.WRONG),
        (rule.occurs(0.2, 0.1), Verdict.HOLDS),
        (rule.occurs(0.0, 0.1), Verdict.WRONG),
        (rule.counterexample(0.0, 0.1), Verdict.WRONG),
        (rule.counterexample(1.0, 0.1), Verdict.HOLDS),
    ):
        assert judged.verdict is verdict, judged


# What each rule judges true, as many numbers as it takes.
TRUE = {
    rule.equality: ([0.0, 0.0], 1.0),
    rule.printed: ([0.0, 0.0], [0.0, 0.0], 1.0),
    rule.signed: ([0.0, 0.0], [0.0, 0.0], 1.0),
    rule.first_order: ([4e-12, 1e-12], 1.9),
    rule.criterion: ([1.0, 1.0], [1.0, 1.0], 0.05),
    rule.optimum: ([1.0, 1.0], [1.0, 1.0], 0.05),
    rule.bound: ([1.0, 1.0], [1.0, 1.0], 0.05),
    rule.condition: (0, 0, 9),
    rule.named_region: (0.0, 0.0, 0.1),
    rule.conditional: ([0.0, 0.0], [0.0, 0.0], 0.1),
    rule.occurs: (1.0, 0.5),
    rule.counterexample: ([1.0, 1.0], 0.1),
}


@pytest.mark.parametrize("judge", TRUE, ids=lambda judge: judge.__name__)
def test_nothing_is_judged_for_want_of_numbers(judge):
    """Whichever of its numbers a rule is not given: NaN, infinite, or none at all, it gives no verdict of the claim."""
    given = TRUE[judge]
    assert judge(*given).verdict is Verdict.HOLDS
    for which, value in enumerate(given):
        several = isinstance(value, list)
        missing = [np.nan, np.inf, *([[]] if several else [])]
        missing += [[*value[:at], bad, *value[at + 1 :]] for bad in (np.nan, np.inf) for at in range(2) if several]
        for nothing in missing:
            judged = judge(*given[:which], nothing, *given[which + 1 :])
            assert judged.verdict is Verdict.NOT_FOUND, (which, nothing)
            assert np.isnan(judged.error)


def test_every_rule_is_asked():
    rules = {
        value for value in vars(rule).values() if getattr(value, "__annotations__", {}).get("return") == "Judgement"
    }
    assert rules == set(TRUE)


def test_every_exception_must_be_found_to_contradict():
    assert rule.counterexample([0.0, 1.0], 0.1).verdict is Verdict.HOLDS
    assert rule.counterexample([0.0, -0.05], 0.1).verdict is Verdict.WRONG


def test_a_claim_can_say_that_a_number_is_missing():
    assert angle(np.nan) == "nan°"
    assert angle(np.inf) == "inf°"


def test_errors_are_in_degrees():
    assert rule.criterion([0.0], [np.radians(3.0)], 0.05).error == pytest.approx(3.0)
    assert rule.optimum([np.radians(3.0)], [0.0], 0.05).error == pytest.approx(3.0)
    assert rule.named_region(np.radians(3.0), 0.0, 0.001).error == pytest.approx(3.0)


# --- what the drapes and the formulas say ----------------------------------------------------------------------------

EXPECTED = (
    (sections_2_3.origami_fold, Verdict.HOLDS),
    (sections_2_3.region_2_determined, Verdict.HOLDS),
    (sections_2_3.left_shear_helps, Verdict.SWAPPED),
    (sections_2_3.continuum, Verdict.CONDITIONAL),
    (section_4.origami_link, Verdict.MISPRINT),
    (section_4.equation_17, Verdict.MISPRINT),
    (section_4.equation_18, Verdict.HOLDS),
    (section_4.rows_follow_f, Verdict.SIGN),
    (section_4.equation_20_sign, Verdict.SIGN),
    (section_4.equation_20_upright, Verdict.UNSAFE_AND_STRICT),
    (section_4.shear_of_the_wing, Verdict.WRONG),
    (section_5.equation_21, Verdict.HOLDS),
    (section_5.sensitivity_wing, Verdict.CONDITIONAL),
    (section_6.edge_on_wing, Verdict.HOLDS),
    (section_6.edge_on_spar, Verdict.MISPRINT),
    (section_6.turn_at_the_edge, Verdict.HOLDS),
    (section_6.wing_fed_maximum, Verdict.UPPER_BOUND),
    (section_6.region_names, Verdict.SWAPPED),
    (section_6.condition_32, Verdict.SUFFICIENT),
    (section_7.shear_limit, Verdict.MISPRINT),
    (section_7.equation_39, Verdict.FIRST_ORDER),
    (section_7.cylinder_askew, Verdict.CONDITIONAL),
    (section_7.only_cylinders, Verdict.WRONG),
    (section_7_edges.equation_43_strip, Verdict.WRONG),
    (section_7_edges.cube_corner, Verdict.HOLDS),
)


@pytest.mark.parametrize(("make", "verdict"), EXPECTED, ids=lambda value: getattr(value, "__name__", None))
def test_verdicts(runs, make, verdict):
    """As worked out by hand in the checks of the report, from coarse runs already."""
    claim = make(runs)
    assert claim.verdict is verdict, claim
    assert np.isfinite(claim.judgement.error)
    assert claim.found.endswith(".")


# --- break one formula, see the verdict change -----------------------------------------------------------------------


def test_equation_10_without_its_root_does_not_hold(monkeypatch, runs):
    monkeypatch.setattr(section_4, "origami_advance", lambda slope, spacing: spacing / (1 + np.asarray(slope) ** 2))
    assert section_4.origami_link(runs).verdict is Verdict.WRONG


def test_wrong_alpha_is_seen(monkeypatch, runs):
    monkeypatch.setattr(fold_module.Fold, "alpha", lambda self, y: np.arctan(self.spar.slope(y) / self.spar.stretch(y)))
    claim = section_6.edge_on_wing(runs)
    assert claim.verdict is Verdict.WRONG
    assert claim.judgement.error > 0.1


def test_wrong_psi_is_seen(monkeypatch, runs):
    """A turn one part in a hundred too large."""
    right = fold_module.Fold.psi
    net = runs.draped_figure_4()
    assert net.shear_error < 1e-4
    monkeypatch.setattr(fold_module.Fold, "psi", lambda self, y: 1.01 * right(self, y))
    assert section_6.turn_at_the_edge(runs).verdict is Verdict.WRONG


def test_wrong_weak_formula_is_seen(monkeypatch, runs):
    right = section_7.weak_sine
    monkeypatch.setattr(section_7, "weak_sine", lambda *given: 1.05 * right(*given))
    assert section_7.equation_39(runs).verdict is Verdict.WRONG


def test_right_slope_criterion_would_hold(monkeypatch, runs):
    """Were (20) the shear within reach, the verdict would be a better one."""

    def true(deviation):
        wing = runs.wing
        reach = within_reach(Fold(wing, wing + deviation), 1.0)
        return type("Station", (), {"value": max(reach.wing_fed.shear, reach.ribbon_fed.shear)})

    monkeypatch.setattr(section_4, "slope_criterion", true)
    assert section_4.equation_20_upright(runs).verdict is Verdict.HOLDS


# --- drapes in lattice numbers ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("gamma", [0.0, -0.1])
def test_drape_of_a_fold_is_its_discrete_net(gamma):
    """Nodes to one and a half times the facets' chord tolerance, shear to what that does to the crease's direction."""
    fold, facet = Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0)), 1e-3
    h = 0.8 * facet**2 / 8
    draped = drape_fold(fold, 0.05, 0.6, facet, gamma)
    assert draped.node_error < 1.5 * h + 1e-12
    assert draped.shear_error < min(np.sqrt(2 * 0.8 * h), h / 0.05) + np.radians(0.01)
    for region in (RIBBON_FED, WING_FED):
        assert draped.cells(region).sum() > 10
        assert draped.max_shear(region) == pytest.approx(draped.reference.max_shear(region).shear, abs=2e-4)
    assert np.abs(draped.on_wing).max() < 1e-9


def test_chord_only_makes_the_mould_wider():
    fold = Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0))
    narrow, wide = (drape_fold(fold, 0.1, 0.5, 5e-3, chord=chord) for chord in (0.0, 1.5))
    assert wide.net.mould.surface.vertices[:, 0].max() == pytest.approx(1500.0)
    assert narrow.net.mould.size[0] < 1000.0
    both = np.isfinite(narrow.shear) & np.isfinite(wide.shear)
    assert np.abs(narrow.shear - wide.shear)[both].max() < 1e-9
