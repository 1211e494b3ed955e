"""Section 5: the flat spar, its simple solution, and how sensitive that is."""

from __future__ import annotations

import numpy as np

from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.judgement import Verdict, conditional, equality, first_order, occurs, order_of
from meshdrape.study.claims.runs import Runs
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    discrete_net,
    flat,
    quadratic,
    random_placements,
    slope_criterion,
    within_reach,
)


def equation_21(runs: Runs) -> Claim:
    """(21): exact, and nothing but region I with γ = 0."""
    fold = runs.flat_spar
    estimate = slope_criterion(-fold.wing).value
    reach = within_reach(fold, 0.5)
    draped = runs.draped_flat_spar()
    # the last column's middle lies half a spacing before the end, where the slope is largest
    sheet = draped.reference.sheet
    last = float(fold.wing.slope((sheet.y[-1] + sheet.y[-2]) / 2))
    shear = np.abs(draped.shear[-1][draped.cells(RIBBON_FED)[-1]]).max()
    found = (
        f"g_w = y²/20, span 2: (21) gives {angle(estimate, 4)}, region I with γ = 0 "
        f"{angle(reach.ribbon_fed.shear, 4)}; "
        f"draped, the last column {angle(float(shear), 4)} where the edge's own slope there has "
        f"{angle(float(np.arctan(last)), 4)}. Cells fed by the wing: {(draped.reference.region == WING_FED).sum()}."
    )
    error = [np.degrees(reach.ribbon_fed.shear - estimate), np.degrees(shear - np.arctan(last))]
    return Claim(
        "(21)",
        "A flat spar has a special solution; its largest shear is arctan(max |f'|).",
        found,
        equality(error, 0.02, "deg"),
        ((Verdict.HOLDS, "Exact; and not a separate solution: it is region I with γ = 0 and g_s' = 0."),),
    )


def parallel_rows(runs: Runs) -> Claim:
    """Rows parallel to the edge."""
    draped = runs.draped_flat_spar()
    node, spacing = draped.node, draped.reference.sheet.spacing
    rows = np.flatnonzero(draped.reference.within.all(axis=0))
    rows = rows[draped.reference.sheet.row[rows] < 0]
    depth = runs.flat_spar.wing(node[:, rows, 1]) - node[:, rows, 2]
    spread = float(np.ptp(depth, axis=0).max() / spacing)
    found = f"Depth of each of {len(rows)} draped rows below the edge: constant to {number(spread, 4)} spacings."
    return Claim("5", "On the spar the nodes lie on curves parallel to the edge.", found, equality(spread, 0.01))


def first_nodes(runs: Runs) -> Claim:
    """Nodes at λ - b below the edge."""
    del runs
    errors = []
    for slope in (0.2, 0.1, 0.05):
        fold = Fold(quadratic(slope / 2, 1.0), flat(1.0))
        net = discrete_net(fold, 0.01, 0.1)
        r = int(np.flatnonzero(net.sheet.row == -1)[0])
        errors.append(float(np.abs(net.depth[:, r] / net.sheet.spacing - 0.5).max()))
    found = (
        f"b = λ/2: the discrete net's first row lies off λ - b by up to {errors[0]:.4f}, {errors[1]:.4f}, "
        f"{errors[2]:.5f} λ at edge slopes of 0.2, 0.1, 0.05: a power {order_of(errors):.2f}. A link that hangs "
        f"upright on both sides of a slanting edge is bent, not straight."
    )
    return Claim(
        "5", "The first nodes on the spar are at a distance a = λ - b from the edge.", found, first_order(errors, 1.8)
    )


def sensitivity_spar(runs: Runs) -> Claim:
    """Whether a small deviation leads to large shear on the spar."""
    wing = runs.flat_spar.wing
    sigma = np.radians(0.5)
    placed = random_placements(wing, 0.005, 0.5, float(sigma), trials=500 if runs.quick else 2000)
    change = np.abs(placed.spar - placed.exact)
    given = np.abs(placed.tilt) + np.abs(placed.gamma)
    ratio = float((change / given).max())
    spread, _ = placed.spread()
    found = (
        f"{len(change)} random placements, tilt and left ribbon off by 0.5° (one σ): the spar's largest shear, "
        f"{angle(placed.exact)}, changes by {angle(spread)} (one σ), never by more than {ratio:.2f} times the errors."
    )
    # large: several times the error that caused it
    return Claim(
        "5",
        "Any small deviation leads to large shear on the spar.",
        found,
        occurs(ratio, 3.0),
        ((Verdict.WRONG, "The spar's shear changes by no more than the errors of placing."),),
    )


def sensitivity_wing(runs: Runs) -> Claim:
    """Whether a small deviation leads to large shear on the wing."""
    wing = runs.flat_spar.wing
    placed = random_placements(wing, 0.005, 0.5, float(np.radians(0.5)), trials=500 if runs.quick else 2000)
    _, share = placed.spread()
    falls = placed.tilt > np.radians(0.2)  # enough for a row to come up
    # where the edge falls: shear on the wing as large as on the spar; where it rises: none
    lacking = [1 - float((placed.wing[chosen] > 0.5 * placed.exact).mean()) for chosen in (falls, placed.tilt < 0)]
    sheared = placed.wing[placed.wing > 0]
    found = (
        f"{100 * share:.0f} % of the placements shear the wing, by {angle(float(sheared.min()))} to "
        f"{angle(float(sheared.max()))}, of the order of the spar's own: tilts under which the edge falls away "
        "from the "
        f"rows ({100 * (1 - lacking[0]):.0f} % of those over 0.2°); under the others {100 * (1 - lacking[1]):.0f} %."
    )
    return Claim(
        "5",
        "Any small deviation leads to large shear on the wing cover.",
        found,
        conditional(lacking[0], lacking[1], 0.0),
        ((Verdict.CONDITIONAL, "Only for a tilt under which rows of the spar come up onto the wing."),),
    )


def straightness(runs: Runs) -> Claim:
    """The flat-spar net is that of section 6."""
    fold = runs.flat_spar
    closed, exact = characteristic_net(fold, 0.02, 0.5), discrete_net(fold, 0.02, 0.5)
    off = np.degrees(np.abs(closed.shear - exact.shear)[exact.region > 0].max())
    found = (
        f"Characteristics of section 6 against the discrete net of section 5: cell by cell to {number(float(off), 4)}°."
    )
    return Claim(
        "5, 6",
        "The flat-spar solution and the rotations of section 6 are the same net.",
        found,
        equality(off, 0.02, "deg"),
    )


CLAIMS = (equation_21, parallel_rows, first_nodes, sensitivity_spar, sensitivity_wing, straightness)
