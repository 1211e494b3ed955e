"""Section 4: the perturbation of the origami fold, (10) to (20)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.judgement import (
    Verdict,
    criterion,
    equality,
    first_order,
    occurs,
    order_of,
    printed,
    signed,
)
from meshdrape.study.claims.runs import FAMILIES, HEIGHT, SPAN, Runs
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    flat,
    lateral_approach,
    lateral_approach_linear,
    linear_deviation,
    origami_advance,
    parabola_deviation,
    quadratic,
    slope_criterion,
    slope_shear,
    within_reach,
)

FloatArray = NDArray[np.float64]

SLOPES = np.tan(np.radians([3.0, 7.0, 15.0]))  # of the real wing


def origami_link(runs: Runs) -> Claim:
    """(10): how far a link advances along the span."""
    spacing = 1e-4
    at = runs.wing.at_arc_length(np.array([0.0, 5.0, 14.0]))
    slope = runs.wing.slope(at)
    true = runs.wing.at_arc_length(runs.wing.arc_length(at) + spacing) - at
    as_printed = spacing / (1 + slope**2) / true - 1
    with_root = origami_advance(slope, spacing) / true - 1
    found = (
        f"Along the curve g_w itself, from its arc length: as printed off by {100 * np.abs(as_printed).max():.2f} % at "
        f"the root of the real wing, with the square root by {number(100 * np.abs(with_root).max(), 3)} %."
    )
    return Claim(
        "(10)",
        "l = λ / (1 + g'²).",
        found,
        printed(as_printed, with_root, 1e-4),
        ((Verdict.MISPRINT, "l = λ / sqrt(1 + g'²), as (8) and (9) have it."),),
    )


def _slopes() -> tuple[FloatArray, FloatArray]:
    g, f = np.meshgrid(SLOPES, [-0.1, -0.03, 0.05, 0.1])
    return g.ravel(), f.ravel()


def link_equation(runs: Runs) -> Claim:
    """The line before (17)."""
    del runs
    g, f = _slopes()
    length, s = origami_advance(g, 1.0), lateral_approach(g, f, 1.0)
    rest = (g * (length + s)) ** 2 + 2 * (f * (length + s)) ** 2 + 2 * g * f * (length + s) ** 2 + length**2 + s**2
    # s_i is defined nowhere; Δy_i is the only other small length at hand, and it is 0 at the first link
    as_printed, corrected = rest - 1, rest + 2 * length * s - 1
    found = (
        f"With S from (18), λ = 1, slopes of the real wing: the last term left out the line is off by "
        f"{np.abs(as_printed).max():.3f}, read as 2 l S by {np.abs(corrected).max():.0e}."
    )
    return Claim(
        "before (17)",
        "λ² ≈ ... + l² + S² + 2 l s, with an s that is defined nowhere.",
        found,
        printed(as_printed, corrected, 1e-12),
        ((Verdict.MISPRINT, "2 l S."),),
    )


def equation_17(runs: Runs) -> Claim:
    """(17), both lines."""
    del runs
    g, f = _slopes()
    length, s = origami_advance(g, 1.0), lateral_approach(g, f, 1.0)
    grown = s * s + 2 * length * s
    rest = 2 * (f * f + g * f) * (length * length + grown) + grown
    first, corrected = g * grown + rest, g * g * grown + rest
    second = grown * (1 + (g + f) ** 2 + f * f) + 2 * length**2 * (f * f + f * g)
    found = (
        f"First line with g' as printed: {np.abs(first).max():.4f} where 0 is meant; with g'²: "
        f"{np.abs(corrected).max():.0e}; second line: {np.abs(second).max():.0e}."
    )
    return Claim(
        "(17)",
        "0 = g'(S² + 2 l S) + ...",
        found,
        printed(first, [*corrected, *second], 1e-12),
        ((Verdict.MISPRINT, "g'²; the second line is right."),),
    )


def equation_18(runs: Runs) -> Claim:
    """(18), first line."""
    del runs
    g, f = _slopes()
    dy = origami_advance(g, 1.0) + lateral_approach(g, f, 1.0)
    off = np.sqrt(((g + f) * dy) ** 2 + dy**2 + (f * dy) ** 2) - 1
    worst = np.abs(off).max()
    found = f"A link that advances by l + S and rises by f' and g' + f' times that is one spacing long to {worst:.0e}."
    return Claim(
        "(18), root", "S = -l + l sqrt(1 - 2 (f'² + f' g') / (1 + (g' + f')² + f'²)).", found, equality(off, 1e-12)
    )


def equation_18_expanded(runs: Runs) -> Claim:
    """(18), second line, and the remark that S may be neglected."""
    del runs
    scale = 0.2 / 2.0 ** np.arange(4)
    exact = lateral_approach(scale, 0.5 * scale, 1.0)
    error = exact - lateral_approach_linear(scale, 0.5 * scale, 1.0)
    order = order_of(exact), order_of(error)
    at_root = float(lateral_approach(SLOPES[-1], 0.1, 1.0))
    found = (
        f"S falls with a power {order[0]:.2f} of both slopes together, the expansion's error with {order[1]:.2f}. With "
        f"the wing's own slope kept, S is {100 * abs(at_root):.1f} % of l at its root for f' = 0.1."
    )
    return Claim(
        "(18), expanded",
        "S is quadratic in the slopes of f and g and can be neglected to first order.",
        found,
        first_order(exact, 1.9),
    )


def rows_follow_f(runs: Runs) -> Claim:
    """(11) and (19): z = -f and tan θ = +f'."""
    draped = runs.draped_real(1)
    deviation = FAMILIES[1].make(FAMILIES[1].amplitudes[0])
    rows = draped.node
    fed = draped.cells(RIBBON_FED)
    step = rows[1:, 1:] - rows[:-1, 1:]
    y = (rows[1:, 1:, 1] + rows[:-1, 1:, 1]) / 2
    steep = fed & (deviation.slope(np.nan_to_num(y)) > 0.005)
    f = deviation.slope(y[steep])
    slope = step[..., 2][steep] / step[..., 1][steep]
    ratio = slope / f
    found = (
        f"Slope dz/dy of the draped rows over f', {steep.sum():,} cells of the real wing, parabola: "
        f"{ratio.min():.3f} to {ratio.max():.3f}."
    )
    return Claim(
        "(11), (19)",
        "Rows are shifted by z = -f, and yet tan θ = dz/dy = +f'.",
        found,
        signed(ratio - 1, np.abs(ratio) - 1, 0.05),
        ((Verdict.SIGN, "Only the modulus is meant."),),
    )


def equation_19(runs: Runs) -> Claim:
    """(19) as an expansion."""
    errors = []
    for scale in 0.2 / 2.0 ** np.arange(4):
        wing, f = quadratic(scale, 1.0), linear_deviation(scale, 1.0)
        psi = np.abs(Fold(wing, wing + f).psi(0.3))
        errors.append(float(slope_shear(f, 0.3) - psi))
    real = Fold(runs.wing, runs.wing + linear_deviation(1e-4, SPAN))
    missing = 1 - float(np.abs(real.psi(0.0)) / slope_shear(linear_deviation(1e-4, SPAN), 0.0))
    found = (
        f"Against ψ at the edge, all slopes made small together, the error falls with a power "
        f"{order_of(errors):.2f}. On the real wing, f alone made small, {100 * missing:.1f} % too large remain at the "
        f"root: a factor sqrt(1 + g_w'²)."
    )
    return Claim(
        "(19)",
        "To first order the horizontal ribbons are shifted by f, and tan θ = f'.",
        found,
        first_order(np.degrees(errors), 1.9, "deg"),
    )


def equation_20_sign(runs: Runs) -> Claim:
    """(20): max f' or max |f'|."""
    wing = flat(1.0)
    estimates, moduli, true = [], [], []
    for f in (linear_deviation(-0.1, 1.0), parabola_deviation(-0.1, 1.0), linear_deviation(0.1, 1.0)):
        y = np.linspace(0, 1, 201)
        estimates.append(float(np.arctan(f.slope(y).max())))
        moduli.append(slope_criterion(f).value)
        true.append(float(np.abs(Fold(wing, f).psi(y)).max()))  # one region: rows from the left ribbon, γ = 0
    del runs
    found = (
        f"Flat wing, f = -0.1 y: foretold {angle(estimates[0])}, found {angle(true[0])}; f = -y²/20: "
        f"{angle(estimates[1])}"
        f" and {angle(true[1])}. With |f'|: {angle(moduli[0])} and {angle(moduli[1])}."
    )
    error = [np.degrees(np.subtract(values, true)) for values in (estimates, moduli)]
    return Claim(
        "(20), sign",
        "θ_max = arctan(max f').",
        found,
        signed(error[0], error[1], 1e-6, "deg"),
        ((Verdict.SIGN, "arctan(max |f'|)."),),
    )


def equation_20_flat(runs: Runs) -> Claim:
    """(20) where one surface is flat, γ = 0."""
    del runs
    f = parabola_deviation(0.2, 2.0)
    wing = quadratic(0.05, 2.0)
    off = []
    for fold, deviation in ((Fold(flat(2.0), f), f), (Fold(wing, flat(2.0)), -wing)):
        estimate = slope_criterion(deviation).value
        off.append(within_reach(fold, 1.0).ribbon_fed.shear - estimate)
    found = (
        f"Rows from the left ribbon, γ = 0: off by {angle(abs(off[0]))} over a flat wing, {angle(abs(off[1]))} over a "
        f"flat spar."
    )
    return Claim(
        "(20), one side flat",
        "θ_max = arctan(max |f'|), where g_w' = 0 or g_s' = 0 and the rows start on the left ribbon, upright.",
        found,
        equality(np.degrees(off), 1e-9, "deg"),
    )


def equation_20_upright(runs: Runs) -> Claim:
    """(20) as the largest shear of the sheet laid as the report lays it, γ = 0."""
    return _slope_criterion(runs, "(20), γ = 0", upright=True)


def equation_20_best(runs: Runs) -> Claim:
    """(20) as a limit of design, where the left ribbon may be laid at its best."""
    return _slope_criterion(runs, "(20), best γ", upright=False)


def _slope_criterion(runs: Runs, place: str, *, upright: bool) -> Claim:
    estimate, true, words = [], [], []
    for k, family in runs.families:
        fold, height = runs.real(k), HEIGHT
        gamma = 0.0 if upright else within_reach(fold, height).gamma_best
        draped = runs.draped_real(k, gamma)
        estimate.append(slope_criterion(family.make(family.amplitudes[0])).value)
        true.append(float(np.max([draped.max_shear(WING_FED), draped.max_shear(RIBBON_FED)])))
        words.append(f"{family.name} {angle(estimate[-1])} against {angle(true[-1])}")
    laid = "left ribbon upright" if upright else "left ribbon at its best"
    found = f"Real wing draped at {1000 * runs.spacing:.0f} mm, spar 1 m, {laid}: " + "; ".join(words) + "."
    says = "θ_max = arctan(max |f'|), confirmed by the numerical solutions, is a good estimate"
    says += ", the sheet laid as in the report." if upright else " for a designer, who may turn the left ribbon."
    remarks = (
        (Verdict.UNSAFE, "Unsafe where f' changes sign: wing-fed rows see the whole range of ψ."),
        (Verdict.TOO_STRICT, "It is variation of f' that costs shear, not f' itself."),
        (Verdict.UNSAFE_AND_STRICT, "Unsafe where f' changes sign; too strict where it does not, a tilt needing none."),
    )
    return Claim(place, says, found, criterion(estimate, true, 0.05), remarks)


def shear_of_the_wing(runs: Runs) -> Claim:
    """The end of section 4: extra shear on the wing cover."""
    drapes = [runs.draped_real(k) for k, _ in runs.families]
    on_wing = float(np.max([np.abs(one.on_wing).max() for one in drapes]))
    astride = max(float(np.abs(one.astride).max()) for one in drapes)
    most = max(max(one.max_shear(k) for k in (RIBBON_FED, WING_FED)) for one in drapes)
    count = sum(len(one.on_wing) for one in drapes)
    found = (
        f"Sheet laid undeformed on the wing, {len(drapes)} drapes: at most {angle(on_wing)} in {count:,} cells of the "
        "wing, up "
        f"to {angle(astride)} in cells that straddle the edge, {angle(most)} on the spar."
    )
    return Claim(
        "4, end",
        "There is some extra shear on the wing cover, smaller than that on the spar.",
        found,
        occurs(float(np.degrees(on_wing)), 0.01, "deg"),
        ((Verdict.WRONG, "None, but for the cells that straddle the edge."),),
    )


CLAIMS = (
    origami_link,
    link_equation,
    equation_17,
    equation_18,
    equation_18_expanded,
    rows_follow_f,
    equation_19,
    equation_20_sign,
    equation_20_flat,
    equation_20_upright,
    equation_20_best,
    shear_of_the_wing,
)
