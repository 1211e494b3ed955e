"""Sections 2 and 3: the wing, the weave, the origami fold, the numerical method, and what figure 4 shows."""

from __future__ import annotations

import numpy as np

from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.judgement import Verdict, conditional, equality, named_region
from meshdrape.study.claims.runs import LOCKING, Runs
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    discrete_net,
    gap,
    locking_angle,
    quadratic,
    real_wing,
    returning_rows,
    sine_deviation,
    within_reach,
)
from meshdrape.weave.recheck.edges import audit

ROUND_OFF_DEG = 1e-6  # of angles carried along a net over metres of facets


def wing_of_section_2(runs: Runs) -> Claim:
    """Whether the wing's radius of 65 m agrees with its three slopes."""
    slopes = np.radians([15.0, 7.0, 3.0])
    turn, length = slopes[0] - slopes[-1], runs.wing.length
    radius = length / turn
    least = 1 / np.max(np.abs(runs.wing.bend(np.linspace(0, 14, 1401))))
    found = (
        f"A curve through the three slopes turns {angle(turn, 0)} over {length:.2f} m, a mean radius of {radius:.1f} m;"
        f" at the root of the wing used here it is {least:.0f} m."
    )
    return Claim(
        "2",
        "A 14 m wing of slopes 15°, 7°, 3° at 0, 4, 14 m has a radius of the order of 65 m.",
        found,
        equality(radius / 65 - 1, 0.1),
    )


def critical_shear(runs: Runs) -> Claim:
    """Figure 2: ribbons touch at the critical shear."""
    del runs
    pitch = 5.0
    width = pitch * np.cos(LOCKING)
    left, error = gap(width, pitch, LOCKING), locking_angle(width, pitch) - LOCKING
    found = (
        f"Ribbons keep their pitch p along the crossing ones; the gap p cos θ - w closes at arccos(w/p). To lock at 7° "
        f"they must fill {100 * width / pitch:.2f} % of the pitch; the gap left there is {number(left / pitch, 3)} p."
    )
    return Claim(
        "fig. 2",
        "Shear reduces the gaps between ribbons; at the critical angle (about 7°) they touch.",
        found,
        equality([error, left / pitch], 1e-12),
    )


def origami_fold(runs: Runs) -> Claim:
    """(3): no deformation on an origami fold."""
    fold = Fold(quadratic(0.3, 1.0), quadratic(0.3, 1.0))
    alone = float(np.nanmax(np.abs(discrete_net(fold, 0.03, 0.8).shear)))
    draped = runs.draped_origami()
    y = np.linspace(0, runs.origami.span, 101)
    plane = np.abs(runs.origami.spar(y) - runs.origami.wing(y)).max()
    worst = float(np.max([alone, np.degrees(draped.measures.max_shear)]))
    found = (
        f"Crease off the plane x = z by {number(plane, 0)} m. Largest shear {angle(alone)} on g = 0.3 y² without a "
        f"mesh, {angle(draped.measures.max_shear)} in {draped.measures.n_cells:,} cells draped on the real wing."
    )
    return Claim(
        "(3)",
        "If g_w = g_s the crease is plane and a sheet covers both surfaces without any deformation.",
        found,
        equality([worst, plane], ROUND_OFF_DEG, "deg"),
    )


def numerical_method(runs: Runs) -> Claim:
    """Section 3.3: a node is one spacing from both its neighbours, and that determines the net."""
    draped = runs.draped_figure_4()
    checked = audit(draped.net, edges=30 if runs.quick else 400, seconds=3.0)
    found = (
        f"{checked.n_edges} edges of the drape of figure 4 measured by libigl's exact geodesics: largest relative error"
        f" {checked.max_relative_error:.0e}. Its nodes lie within {1e6 * draped.node_error:.2f} µm of the net that was "
        "found on the unrolled surfaces, without a mesh."
    )
    return Claim(
        "3.3",
        "Two start fibres and the weave size determine all nodes, each one spacing from two others.",
        found,
        equality(checked.max_relative_error, 1e-9),
    )


def region_1_rows(runs: Runs) -> Claim:
    """Region I: cross-wise ribbons vertical, rows one shape."""
    draped = runs.draped_figure_4()
    net = draped.reference
    fed = draped.cells(RIBBON_FED)
    node = draped.node
    across = node[:, 1:] - node[:, :-1]  # down the columns
    lean = np.degrees(np.abs(np.arctan2(across[..., 1], -across[..., 2])))
    vertical = float(np.nanmax(np.maximum(lean[:-1], lean[1:])[fed]))
    z = node[..., 2]
    shape = z[1:] - z[:-1]
    change = np.abs(shape[:, 1:] - shape[:, :-1])[fed].max() / net.sheet.spacing
    found = (
        f"In {fed.sum():,} draped cells fed by the left ribbon, γ = 0, cross-wise ribbons lean by at most "
        f"{number(vertical, 4)}°; rows differ in shape by at most {number(float(change), 4)} of a spacing a link."
    )
    return Claim(
        "3.4",
        "In region I the cross-wise ribbons are vertical and all rows have one shape, shifted down.",
        found,
        equality([vertical, float(np.degrees(change))], 0.01, "deg"),
    )


def region_1_spacing(runs: Runs) -> Claim:
    """Region I: columns draw together to the right; top of the spar: they draw apart."""
    net = runs.draped_figure_4().reference
    h = net.sheet.spacing
    width = np.diff(net.plane.real, axis=0)
    fed = net.region == RIBBON_FED
    columns = [width[i, 1:][fed[i]].mean() / h for i in range(len(fed)) if fed[i].any()]
    top = np.diff(runs.figure_4.spar.arc_length(net.sheet.y)) / h
    apart = np.concatenate([np.maximum(np.diff(columns), 0), np.maximum(1 - top[1:], 0)])
    found = (
        f"Distance of the columns in region I falls from {columns[0]:.3f} to {columns[-1]:.3f} spacings; along the "
        f"crease, at the top of the spar, it grows from {top[0]:.3f} to {top[-1]:.3f}."
    )
    return Claim(
        "3.4",
        "Cross-wise ribbons lie closer together to the right in region I, and farther apart at the top.",
        found,
        equality(apart, 1e-9),
    )


def region_2_determined(runs: Runs) -> Claim:
    """Region II does not know of the left ribbon."""
    turned = float(runs.figure_4.psi(1.0)) / 2
    first, second = runs.draped_figure_4(), runs.draped_figure_4(turned)
    m = min(first.shear.shape[1], second.shear.shape[1])
    both = first.cells(WING_FED)[:, :m] & second.cells(WING_FED)[:, :m]
    change = float(np.abs(first.shear[:, :m] - second.shear[:, :m])[both].max())
    same = int((first.shear[:, :m][both] == second.shear[:, :m][both]).sum())
    found = (
        f"Left ribbon at γ = 0 and at γ = {angle(turned)}, both draped: shear of {same:,} of {both.sum():,} cells fed "
        f"by the wing is the same to the last bit, the largest change {angle(change)}."
    )
    return Claim(
        "3.4",
        "The solution in region II is completely determined by the sheet on the wing.",
        found,
        equality(np.degrees(change), 0.0, "deg"),
    )


def left_shear_helps(runs: Runs) -> Claim:
    """Which region a shear at the left end relieves."""
    turned = float(runs.figure_4.psi(1.0)) / 2
    first, second = runs.draped_figure_4(), runs.draped_figure_4(turned)
    one, two = ((first.max_shear(k), second.max_shear(k)) for k in (RIBBON_FED, WING_FED))
    # a relief is at least a tenth of the largest shear: what is missing of that is the error
    missing = [max(0.1 * before - (before - after), 0.0) for before, after in (two, one)]
    found = (
        f"Left ribbon turned by {angle(turned)}: largest shear in region I goes from {angle(one[0])} to "
        f"{angle(one[1])}, in region II from {angle(two[0])} to {angle(two[1])}."
    )
    return Claim(
        "3.4",
        "A small shear at the left end reduces the maximum shear in region II.",
        found,
        named_region(missing[0], missing[1], 1e-3),
        ((Verdict.SWAPPED, "True of region I; nothing done at the spar's left end can change region II."),),
    )


def returning(runs: Runs) -> Claim:
    """The ill-posed case."""
    del runs
    wing = real_wing(14.0)
    fold, gentle = (Fold(wing, wing + sine_deviation(c, 7.0, 14.0)) for c in (0.15, 0.02))
    back = returning_rows(fold)
    net = characteristic_net(fold, 0.02, 1.0)
    sheet = net.sheet
    i, r = sheet.exit_column, sheet.exit_row
    off = np.abs(np.linalg.norm(net.node[i, r] - net.node[i - 1, r], axis=-1) / sheet.spacing - 1)
    need = max((stretch.turn for stretch in back), default=0.0)
    found = (
        f"f = 0.15 m sin(2πy/7 m) on the real wing: the crease falls over {len(back)} stretches, {len(i)} rows come "
        f"back at 20 mm; their links to the undeformed wing miss the spacing by up to {100 * off.max():.1f} %, and the "
        f"wing would have to shear by {angle(need)}. At 0.02 m: {len(returning_rows(gentle))}."
    )
    # links that fit would contradict it, and so would rows that come back where the crease does not fall
    contradiction = 0.0 if off.max() > 1e-3 and need > 1e-3 and not returning_rows(gentle) else 1.0
    return Claim(
        "3.4",
        "A row that goes over the edge and comes back is ill-posed: the wing would have to shear.",
        found,
        equality(contradiction, 0.0),
    )


def continuum(runs: Runs) -> Claim:
    """Section 3.2: the weave is so much smaller than the wing that a continuum will do; how fast it does."""
    limit = within_reach(runs.figure_4, 0.6)
    # whole columns to the span's end, so that the last one always lies there
    spacing = runs.figure_4.wing.length / np.array([50, 100, 200, 400])
    nets = [characteristic_net(runs.figure_4, float(h), 0.6) for h in spacing]
    ribbon, wing = (
        region.shear - np.array([net.max_shear(k).shear for net in nets])
        for k, region in ((RIBBON_FED, limit.ribbon_fed), (WING_FED, limit.wing_fed))
    )
    order = [float(np.polyfit(np.log(spacing), np.log(np.abs(short)), 1)[0]) for short in (ribbon, wing)]
    found = (
        f"Figure 4 at spacings of {1000 * spacing[0]:.1f} to {1000 * spacing[-1]:.1f} mm: the largest shear tends to "
        f"its limit with a power {order[0]:.2f} of the spacing where the left ribbon feeds the rows, {order[1]:.2f} "
        f"where the wing does, whose first row leaves the edge tangentially; at the last it is still "
        f"{angle(float(wing[-1]))} short."
    )
    return Claim(
        "3.2",
        "The weave is so fine that a continuum may be used (an error of first order in the spacing).",
        found,
        conditional(min(order[0] - 0.7, 0.0), min(order[1] - 0.7, 0.0), 0.0),
        ((Verdict.CONDITIONAL, "Only where the left ribbon feeds the rows; else an error like the root."),),
    )


CLAIMS = (
    wing_of_section_2,
    critical_shear,
    origami_fold,
    continuum,
    numerical_method,
    region_1_rows,
    region_1_spacing,
    region_2_determined,
    left_shear_helps,
    returning,
)
