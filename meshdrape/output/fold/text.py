"""The answer of `meshdrape fold` on one page of text: the verdict first, then what an engineer asks next."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshdrape.study.fold import Choice, Envelope, FoldAnswer, NearestSpar, Pair, Shear

WIDTH = 118
NAMES = {
    "eq20": "(20) arctan max|f'|",
    "eq29": "(29) psi_max - psi_min",
    "within_reach": "within reach",
    "characteristics": "characteristics",
    "drape": "drape on the CAD mould",
}


def fold_text(answer: FoldAnswer, written: Sequence[Path] = ()) -> str:
    """The page."""
    parts = [
        _verdict(answer),
        _criteria(answer),
        _where(answer),
        _laying(answer),
        _limits(answer),
        _nearest(answer.nearest),
    ]
    if answer.envelope is not None:
        parts.append(_envelope(answer.envelope))
    parts.append(_warnings(answer))
    took = ", ".join(f"{name} {value:.1f} s" for name, value in answer.seconds.items())
    parts.append([f"time     {took}", *(f"wrote    {path}" for path in written)])
    return "\n\n".join("\n".join(part) for part in parts if part) + "\n"


def _verdict(answer: FoldAnswer) -> list[str]:
    verdict, design = answer.verdict, answer.design
    says = "CAN BE MADE" if verdict.feasible else "CANNOT BE MADE as laid here"
    margin = math.degrees(verdict.margin)
    spar = f"g_s {design.spar.name}" if design.spar else f"f {design.deviation.name if design.deviation else 'none'}"
    return [
        f"{says}: the cloth shears by {_deg(verdict.locking_angle - verdict.margin)} and locks at "
        f"{_deg(verdict.locking_angle)}, {abs(margin):.2f} deg {'to spare' if margin >= 0 else 'too much'}",
        f"  wing {design.wing.name}, {spar}; {design.span:,.0f} x {design.chord:,.0f} mm, spar "
        f"{design.spar_height:,.0f} mm high; ribbons {design.spacing:g} mm",
        f"  sheet first on the {design.first} from the {design.end}, left-most ribbon at gamma = {_deg(verdict.gamma)}",
    ]


def _criteria(answer: FoldAnswer) -> list[str]:
    lines = [f"{'largest shear, deg':26}{'wing-fed':>9}{'ribbon-fed':>12}"]
    for name, shear in answer.verdict.criteria.items():
        head = f"  {NAMES[name]:24}{_cell(shear.wing_fed):>9}{_cell(shear.ribbon_fed):>12}   "
        lines += textwrap.wrap(answer.verdict.remarks[name], WIDTH, initial_indent=head, subsequent_indent=" " * 50)
    return lines


def _where(answer: FoldAnswer) -> list[str]:
    where = answer.where
    psi = [math.degrees(value) for value in (where.psi.min(), where.psi.max())]
    return [
        f"where    the edge turns the cloth by psi = {psi[0]:.2f} to {psi[1]:.2f} deg",
        f"         wing-fed: {_pair(where.worst_wing_fed)}",
        f"         ribbon-fed: {_pair(where.worst_ribbon_fed)}",
    ]


def _pair(pair: Pair | None) -> str:
    if pair is None:
        return "no such cells"
    place = ", ".join(f"{value:,.0f}" for value in pair.place)
    return (
        f"{math.degrees(pair.shear):+.2f} deg at ({place}) mm, its row over the edge at y = {pair.y_row:,.0f}, "
        f"its column at {pair.y_column:,.0f} mm"
    )


def _laying(answer: FoldAnswer) -> list[str]:
    laying, locking = answer.laying, answer.verdict.locking_angle
    best, own = laying.best, answer.design
    says = f"first on the {best.first}, from the {best.end}, gamma = {_deg(best.gamma)}: {_cost(best, locking)}"
    if not answer.verdict.feasible and best.largest <= locking and (best.first, best.end) != (own.first, own.end):
        says += "; so it can be made, though not as laid in the design"
    lines = textwrap.wrap(says, WIDTH, initial_indent="lay it   ", subsequent_indent=" " * 9)
    head = f"         {'first':7}{'from':6}{'ribbon':9}{'gamma':>8}{'wing-fed':>10}{'ribbon-fed':>12}"
    lines.append(f"{head}   deg, by characteristics")
    return lines + [_choice(choice) for choice in laying.choices]


def _cost(choice: Choice, locking: float) -> str:
    """What a way to lay the sheet takes, in words."""
    cost = f"{_deg(choice.largest)}, "
    cost += (
        f"{math.degrees(abs(locking - choice.largest)):.2f} {'to spare' if choice.largest <= locking else 'too much'}"
    )
    if choice.well_posed:
        return cost
    return f"{cost}; ill-posed, rows come back to the {choice.first}, which shears by up to {_deg(choice.returning)}"


def _choice(choice: Choice) -> str:
    ill = "" if choice.well_posed else f"   ill-posed: rows come back turned by {_deg(choice.returning)}"
    return (
        f"         {choice.first:7}{choice.end:6}{choice.rule:9}{math.degrees(choice.gamma):8.2f}"
        f"{_cell(choice.shear.wing_fed):>10}{_cell(choice.shear.ribbon_fed):>12}{ill}"
    )


def _limits(answer: FoldAnswer) -> list[str]:
    lines = ["how far  largest factor on f that drapes"]
    for limit in answer.limits:
        if limit.factor is None:
            reach = "none up to any" if math.isinf(limit.tried) else f"none up to {limit.tried:.3g}"
            lines.append(f"         {limit.rule:9} no limit found, {reach}")
        elif limit.factor == 0:
            lines.append(f"         {limit.rule:9} none: a ribbon at {_deg(limit.gamma)} locks for every f")
        else:
            lines.append(
                f"         {limit.rule:9} {limit.factor:.4f}, at gamma = {_deg(limit.gamma)}: {_both(limit.shear)}"
            )
    return lines


def _nearest(nearest: NearestSpar) -> list[str]:
    if nearest.unchanged:
        return [f"change   nothing: f drapes as it is with gamma = {_deg(nearest.gamma)}: {_both(nearest.shear)}"]
    proof = "draped" if nearest.proven else "NOT proven by its drape"
    lines = [
        f"change   nearest f in {nearest.measure}, {proof}: {_both(nearest.shear)} at gamma = {_deg(nearest.gamma)}",
        f"         loss {nearest.rms_loss:.1f} mm rms, at most {nearest.largest_loss:.1f} mm at y = "
        f"{nearest.largest_loss_at:,.0f} mm",
    ]
    every = max((len(nearest.y) - 1) // 7, 1)
    return lines + _rows({
        "y, mm": nearest.y[::every], "f wanted": nearest.wanted[::every], "f nearest": nearest.nearest[::every],
        "loss": nearest.loss[::every],
    })  # fmt: skip


def _rows(table: dict[str, Iterable[float]]) -> list[str]:
    return [f"         {name:10}" + "".join(f"{value:11,.1f}" for value in values) for name, values in table.items()]


def _envelope(envelope: Envelope) -> list[str]:
    count = envelope.largest.size
    lines = [
        f"chart    {count:,} designs of the family {envelope.family} draped at {envelope.spacing:g} mm in "
        f"{envelope.seconds:.0f} s, ribbon {envelope.rule}: allowed amplitude, mm"
    ]
    every = max(math.ceil(len(envelope.wavelength) / 8), 1)
    return lines + _rows({"wave, mm": envelope.wavelength[::every], "allowed": envelope.allowed[::every]})


def _warnings(answer: FoldAnswer) -> list[str]:
    lines: list[str] = []
    for warning in answer.warnings:
        lines += textwrap.wrap(warning.text, WIDTH, initial_indent="WARNING  ", subsequent_indent=" " * 9)
    return lines


def _both(shear: Shear) -> str:
    return f"wing-fed {_cell(shear.wing_fed)}, ribbon-fed {_cell(shear.ribbon_fed)} deg"


def _cell(angle: float | None) -> str:
    return "-" if angle is None else f"{math.degrees(angle):.2f}"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.2f} deg"
