"""Question 1: can it be made. Every criterion of the report beside the drape that decides, and why they differ."""

from __future__ import annotations

import math

from meshdrape.study.fold.answer import Shear, Verdict
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.lay import FoldDrape
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    FoldNet,
    characteristic_net,
    psi_range,
    slope_criterion,
    wing_fed_bound,
    within_reach,
)

# Two figures this near, rad, say the same.
ALIKE = math.radians(0.1)


def characteristics(drape: FoldDrape) -> FoldNet:
    """The net of the characteristic construction with the drape's own lattice and gamma."""
    cloth = drape.cloth
    return characteristic_net(cloth.frame.fold, cloth.spacing, cloth.frame.height, drape.gamma, cloth.row_offset)


def verdict(design: Design, drape: FoldDrape) -> Verdict:
    """Whether a design can be made, by a drape of it, and what the criteria say."""
    frame = drape.cloth.frame
    reach = within_reach(frame.fold, frame.height, drape.gamma)
    net = characteristics(drape)
    criteria = {
        "eq20": Shear(None, slope_criterion(design.deviation_profile).value),
        "eq29": Shear(wing_fed_bound(frame.fold), None),
        "within_reach": Shear(reach.wing_fed.shear, reach.ribbon_fed.shear),
        "characteristics": Shear(net.max_shear(WING_FED).shear, net.max_shear(RIBBON_FED).shear),
        "drape": drape.largest,
    }
    margin = design.locking_angle - drape.asked
    return Verdict(
        feasible=margin >= 0,
        margin=margin,
        locking_angle=design.locking_angle,
        gamma=drape.gamma,
        criteria=criteria,
        remarks=_remarks(design, drape, criteria),
        first_sheet=drape.first_sheet,
    )


def _remarks(design: Design, drape: FoldDrape, criteria: dict[str, Shear]) -> dict[str, str]:
    draped, locking = drape.largest, design.locking_angle
    wing_fed, ribbon_fed = draped.wing_fed or 0.0, draped.ribbon_fed or 0.0
    return {
        "eq20": _eq20(criteria["eq20"].largest, drape, locking),
        "eq29": _eq29(criteria["eq29"].largest, criteria["within_reach"].wing_fed or 0.0, drape, locking),
        "within_reach": _compared(
            max(criteria["within_reach"].largest, 0.0), draped.largest, locking, "the limit of ever finer ribbons"
        ),
        "characteristics": _compared(
            criteria["characteristics"].largest, draped.largest, locking, "rows and columns in closed form"
        ),
        "drape": (
            f"decides: {_deg(max(wing_fed, ribbon_fed))} against {_deg(locking)}"
            if drape.first_sheet < ALIKE
            else f"decides; the side laid first shears too, by {_deg(drape.first_sheet)}: rows come back to it"
        ),
    }


def _eq20(value: float, drape: FoldDrape, locking: float) -> str:
    draped = drape.largest
    asked, wing_fed = draped.largest, draped.wing_fed or 0.0
    if value < asked - ALIKE:
        why = (
            "the rows that come over the edge see the whole range of psi, of which it does not speak"
            if wing_fed > value
            else f"the left-most ribbon lies at gamma = {_deg(drape.gamma)}, not at 0"
        )
        return f"unsafe here, {_deg(asked - value)} too low{_wrong(value, asked, locking)}: {why}"
    if value > asked + ALIKE:
        why = (
            "turning the left-most ribbon takes the common part of psi away"
            if abs(drape.gamma) > ALIKE
            else "where f' is largest no column comes down to rows of the left-most ribbon"
        )
        return f"too strict here by {_deg(value - asked)}{_wrong(value, asked, locking)}: {why}"
    return "right here"


def _eq29(value: float, reached: float, drape: FoldDrape, locking: float) -> str:
    wing_fed = drape.largest.wing_fed or 0.0
    silent = (
        "" if drape.largest.largest <= value + ALIKE else "; it does not speak of ribbon-fed rows, which shear more"
    )
    if value > wing_fed + ALIKE:
        least, greatest = psi_range(drape.cloth.frame.fold)
        at = sorted(drape.cloth.frame.station(y) for y in (least.y, greatest.y))
        why = (
            f"the extremes of psi, at y = {at[0]:,.0f} and {at[1]:,.0f} mm, do not meet on the spar"
            if reached < value - ALIKE
            else "they meet, but ribbons this far apart miss the very extremes"
        )
        return f"too strict here by {_deg(value - wing_fed)}{_wrong(value, wing_fed, locking)}: {why}{silent}"
    if value < wing_fed - ALIKE:
        return f"unsafe here, {_deg(wing_fed - value)} too low: rows come back to the side laid first{silent}"
    return f"right here{silent}"


def _compared(value: float, draped: float, locking: float, what: str) -> str:
    off = value - draped
    if abs(off) < ALIKE:
        return f"right here, {what}"
    return f"{_deg(abs(off))} {'above' if off > 0 else 'below'} the drape{_wrong(value, draped, locking)}: {what}"


def _wrong(value: float, asked: float, locking: float) -> str:
    """Where a criterion decides otherwise than the drape."""
    if value <= locking < asked:
        return ", and passes what locks"
    if asked <= locking < value:
        return ", and refuses what drapes"
    return ""


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.2f} deg"
