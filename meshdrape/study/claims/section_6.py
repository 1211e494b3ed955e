"""Section 6: parallel ribbon segments, the turn at the edge, and the criteria that follow, (24) to (32)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.judgement import (
    Verdict,
    bound,
    condition,
    equality,
    named_region,
    optimum,
    printed,
)
from meshdrape.study.claims.runs import HEIGHT, LOCKING, Runs
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    discrete_net,
    fits_everywhere,
    flat,
    middle_gamma,
    psi_range,
    ribbon_fed_bound,
    ripple_deviation,
    separation_of_scales,
    wing_fed_bound,
    within_reach,
)

FloatArray = NDArray[np.float64]


def parallel_segments(runs: Runs) -> Claim:
    """6.1: across a row all transverse segments are parallel."""
    draped = runs.draped_figure_4()
    shear, whole = draped.shear, draped.reference.region > 0
    four = whole[1:, 1:] & whole[1:, :-1] & whole[:-1, 1:] & whole[:-1, :-1]
    mixed = shear[1:, 1:] - shear[1:, :-1] - shear[:-1, 1:] + shear[:-1, :-1]
    mixed = mixed[four & np.isfinite(mixed)]
    found = (
        "Draped figure 4: shear is a number of the column less a number of the row, to "
        f"{angle(float(np.abs(mixed).max()))}"
        f" over {len(mixed):,} blocks of four cells."
    )
    return Claim(
        "6.1",
        "On a developable surface cells are parallelograms; along a row or a column all transverse "
        "segments are parallel.",
        found,
        equality(np.degrees(mixed), 1e-6, "deg"),
    )


def scales(runs: Runs) -> Claim:
    """(24): the most a slope can change between neighbouring ribbons."""
    ratio, cases = [], 0
    for wing in (runs.wing, flat(14.0)):
        for amplitude in (0.0, 0.002, 0.02):
            for spacing in (0.003, 0.02, 0.1):
                check = separation_of_scales(Fold(wing, wing + ripple_deviation(amplitude, 1.0, 14.0)), spacing)
                if check.bound > 0:
                    ratio.append(check.slope_change / check.bound)
                    cases += 1
    found = (
        f"{cases} folds and spacings, ripples of 1 m among them: the slope's change between neighbours is "
        f"{min(ratio):.3f} to {max(ratio):.3f} of the bound."
    )
    excess = np.maximum(np.array(ratio) - 1, 0)
    return Claim(
        "(24)", "Between adjacent ribbons slopes change by at most 4 sqrt(λ g''_max).", found, equality(excess, 0.0)
    )


def _edge_chords(fold: Fold) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stations, and chords of the crease in space over 1e-4 of the span about them."""
    y = np.linspace(0.05, 0.95, 19) * fold.span
    step = 5e-5 * fold.span
    before, after = (np.stack([fold.spar(at), at, fold.wing(at)], axis=-1) for at in (y - step, y + step))
    return y, before, after


def edge_on_wing(runs: Runs) -> Claim:
    """(26)."""
    fold = runs.real(0, 1)
    y, a, b = _edge_chords(fold)
    along = np.hypot(b[:, 1] - a[:, 1], b[:, 2] - a[:, 2])
    measured = np.arctan2(b[:, 0] - a[:, 0], along)
    off = np.degrees(fold.alpha(y) - measured)
    found = f"Against chords of the crease in space, real wing: off by {number(float(np.abs(off).max()), 4)}° at most."
    return Claim("(26)", "tan α = g_s' / sqrt(1 + g_w'²).", found, equality(off, 1e-4, "deg"))


def edge_on_spar(runs: Runs) -> Claim:
    """(27), its middle and its last expression."""
    fold = runs.real(0, 1)
    y, a, b = _edge_chords(fold)
    measured = np.arctan2(b[:, 2] - a[:, 2], np.hypot(b[:, 1] - a[:, 1], b[:, 0] - a[:, 0]))
    middle = np.arctan(fold.wing.slope(y) / fold.wing.stretch(y))
    off = [np.degrees(value - measured) for value in (middle, fold.beta(y))]
    found = (
        f"Against chords of the crease in space: (dg_w/dy)(dy/ds_w) is off by {np.abs(off[0]).max():.3f}°, the last "
        f"expression by {number(float(np.abs(off[1]).max()), 4)}°."
    )
    return Claim(
        "(27)",
        "tan β = (dg_w/dy)(dy/ds_w) = g_w' / sqrt(1 + g_s'²), in coordinates (s_s, x).",
        found,
        printed(off[0], off[1], 1e-4, "deg"),
        ((Verdict.MISPRINT, "dy/ds_s in the middle; the coordinates are (s_s, z) and, for α, (s_w, x)."),),
    )


def turn_at_the_edge(runs: Runs) -> Claim:
    """(28): the net's rotation where it has crossed the edge."""
    fold = runs.figure_4
    net = discrete_net(fold, 0.0025, 0.05)
    link = np.diff(net.plane, axis=0)
    on = net.sheet.on_spar[1:] & net.sheet.on_spar[:-1]
    top = on.argmax(axis=1)
    column = np.flatnonzero(on.any(axis=1))
    measured = np.angle(link[column, top[column]])
    middle = (net.sheet.y[column] + net.sheet.y[column + 1]) / 2
    off = np.degrees(measured - fold.psi(middle))
    draped = runs.draped_figure_4()
    node = draped.node
    last = draped.cells(RIBBON_FED)[-1].argmax()
    a, b = node[-2, last + 1], node[-1, last + 1]
    turn = np.arctan2(b[2] - a[2], np.diff(fold.spar.arc_length([a[1], b[1]]))[0])
    mid = float(fold.psi((draped.reference.sheet.y[-1] + draped.reference.sheet.y[-2]) / 2))
    found = (
        f"Row links of the discrete net just below the edge, figure 4 at 2.5 mm: within "
        f"{number(float(np.abs(off).max()), 3)}° of ψ in the middle of their column; the last column of the drape is "
        f"turned by {angle(float(turn))}, ψ there is {angle(mid)}."
    )
    return Claim(
        "(28)",
        "The net on the spar is turned by ψ = β - α where it crossed the edge.",
        found,
        equality([*off, float(np.degrees(turn - mid))], 0.1, "deg"),
    )


def wing_fed_maximum(runs: Runs) -> Claim:
    """(29) as the value of the largest shear."""
    return _region_maximum(runs, "(29)", WING_FED, "θ_max,I = ψ_max - ψ_min where rows come from the wing.")


def ribbon_fed_maximum(runs: Runs) -> Claim:
    """(30) as the value of the largest shear."""
    return _region_maximum(runs, "(30)", RIBBON_FED, "θ_max,II = max |ψ - γ| where rows come from the boundary.")


def _region_maximum(runs: Runs, place: str, region: int, says: str) -> Claim:
    estimate, true, words = [], [], []
    for k, family in runs.families:
        fold = runs.real(k)
        estimate.append(wing_fed_bound(fold) if region == WING_FED else ribbon_fed_bound(fold, 0.0))
        true.append(runs.draped_real(k).max_shear(region))
        words.append(f"{family.name} {angle(estimate[-1])} against {angle(true[-1])}")
    found = f"Real wing draped at {1000 * runs.spacing:.0f} mm, spar 1 m, γ = 0: " + "; ".join(words) + "."
    remarks = ((Verdict.UPPER_BOUND, "Only rows and columns that meet within the spar's height count."),)
    return Claim(place, says, found, bound(estimate, true, 0.05), remarks)


def sharper_maximum(runs: Runs) -> Claim:
    """What takes the place of (29) and (30): the pairs that meet."""
    off, finest, words = [], [], []
    for k, family in runs.families:
        fold = runs.real(k)
        reach, draped = within_reach(fold, HEIGHT), runs.draped_real(k)
        foretold = reach.wing_fed.shear, reach.ribbon_fed.shear
        true = draped.max_shear(WING_FED), draped.max_shear(RIBBON_FED)
        off.append(float(np.abs(np.subtract(foretold, true)).max()))
        # a row and a column, each known to within its distance from the next
        finest.append(2 * separation_of_scales(fold, runs.spacing).turn_change)
        both = [f"{angle(one[0])}/{angle(one[1])}" for one in (foretold, true)]
        words.append(f"{family.name} {both[0]} against {both[1]}")
    found = (
        "Wing-fed/ribbon-fed, the same drapes: "
        + "; ".join(words)
        + ". From one ribbon to the next ψ changes by up to "
        f"{angle(max(finest) / 2)}."
    )
    return Claim(
        "6.4, sharpened",
        "Shear is the difference of the rotations of a cell's ribbons: its maximum over the "
        "rows and columns that meet.",
        found,
        equality(np.degrees(off), float(np.degrees(np.max(finest))), "deg"),
    )


def region_names(runs: Runs) -> Claim:
    """Regions I and II against section 3.4."""
    fold = runs.figure_4
    gamma, foretold = middle_gamma(fold)
    draped = runs.draped_figure_4(gamma)
    one, two = draped.max_shear(RIBBON_FED), draped.max_shear(WING_FED)
    found = (
        f"Figure 4, γ = {angle(gamma)}, draped: (31) foretells {angle(foretold)} for its region II; rows from "
        "the wing, "
        f"region II of section 3.4, reach {angle(two)}, rows from the left ribbon, its region I, {angle(one)}."
    )
    return Claim(
        "(29)-(31)",
        "(29) speaks of region I, (30) and (31) of region II.",
        found,
        named_region(abs(two - foretold), abs(one - foretold), 0.05 * foretold),
        ((Verdict.SWAPPED, "Swapped against section 3.4: (29) is its region II, (30) and (31) its region I."),),
    )


def best_gamma(runs: Runs) -> Claim:
    """(31): the middle of all ψ."""
    estimate, best, words = [], [], []
    for k, family in runs.families:
        fold = runs.real(k)
        middle, _ = middle_gamma(fold)
        reach = within_reach(fold, HEIGHT)
        with_middle = runs.draped_real(k, middle).max_shear(RIBBON_FED)
        with_best = runs.draped_real(k, reach.gamma_best).max_shear(RIBBON_FED)
        estimate.append(with_middle)
        best.append(with_best)
        words.append(
            f"{family.name} {angle(with_middle)} at {angle(middle)}, {angle(with_best)} at {angle(reach.gamma_best)}"
        )
    found = "Ribbon-fed shear draped at the middle of all ψ, and of the ψ within reach: " + "; ".join(words) + "."
    return Claim(
        "(31)",
        "γ = (ψ_max + ψ_min)/2 makes the ribbon-fed shear least.",
        found,
        optimum(estimate, best, np.radians(0.1)),
        ((Verdict.NOT_BEST, "Best is the middle of the ψ of those columns that reach ribbon-fed rows."),),
    )


def effective_constraint(runs: Runs) -> Claim:
    """Whether (29) is the constraint that counts, for any gamma within the range of ψ."""
    excess, words = [], []
    for k, family in runs.families:
        fold = runs.real(k)
        least, greatest = psi_range(fold)
        for part in (0.0, 0.25, 0.5, 0.75, 1.0):
            reach = within_reach(fold, HEIGHT, least.value + part * (greatest.value - least.value))
            excess.append(max(reach.ribbon_fed.shear - reach.wing_fed.shear, 0.0))
            words.append(f"{family.name}: {angle(reach.ribbon_fed.shear)} against {angle(reach.wing_fed.shear)}")
    worst = int(np.argmax(excess))
    found = (
        f"{len(excess)} pairs of design and γ, shear within reach: the ribbon-fed one exceeds the wing-fed one "
        "by up to "
        f"{angle(excess[worst])} ({words[worst]})."
    )
    return Claim(
        "after (31)",
        "For any γ between ψ_min and ψ_max the wing-fed region is the effective constraint.",
        found,
        equality(np.degrees(excess), 0.1, "deg"),
        ((Verdict.WRONG, "True of the bounds (29) and (30), not of the shear within reach."),),
    )


def condition_32(runs: Runs) -> Claim:
    """(32) over many designs."""
    passed_but_fails = refused_but_works = designs = 0
    amplitudes = np.linspace(0.4, 2.4, 4 if runs.quick else 9)
    for _, family in runs.families:
        for part in amplitudes:
            fold = family.fold(float(part * family.amplitudes[0]))
            reach = within_reach(fold, HEIGHT)
            fits = max(reach.wing_fed.shear, reach.ribbon_fed_best) <= LOCKING
            says = fits_everywhere(fold, LOCKING)
            passed_but_fails += says and not fits
            refused_but_works += fits and not says
            designs += 1
    found = (
        f"{designs} designs of the real wing, locking at 7°, left ribbon at its best: {passed_but_fails} pass (32) and "
        f"lock all the same, {refused_but_works} fail it and can be laid."
    )
    return Claim(
        "(32)",
        "ψ_max - ψ_min <= θ* is the condition for a sheet to be laid.",
        found,
        condition(passed_but_fails, refused_but_works, designs),
        ((Verdict.SUFFICIENT, "Necessary only if the extremes of ψ lie within reach of each other."),),
    )


CLAIMS = (
    parallel_segments,
    scales,
    edge_on_wing,
    edge_on_spar,
    turn_at_the_edge,
    wing_fed_maximum,
    ribbon_fed_maximum,
    region_names,
    sharper_maximum,
    best_gamma,
    effective_constraint,
    condition_32,
)
