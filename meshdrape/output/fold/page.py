"""The answer of `meshdrape fold` on one page of HTML that needs nothing else: for a screen, or two sides of A4."""

from __future__ import annotations

import base64
import os
from collections.abc import Iterable
from html import escape
from math import degrees, isinf
from typing import TYPE_CHECKING, Final

from meshdrape import __version__
from meshdrape.output.files import atomic_write, check_target
from meshdrape.output.fold.charts import RULES, pictures

if TYPE_CHECKING:
    from meshdrape.study.fold import Choice, Design, FoldAnswer, FoldWarning, Limit, NearestSpar, Verdict, Where

_CRITERIA: Final = {
    "eq20": "Report (20), arctan max |f′|",
    "eq29": "Report (29), (30), range of ψ",
    "within_reach": "ψ within reach",
    "characteristics": "Characteristic net",
    "drape": "Drape on the mould",
}
_MOST_CHOICES: Final = 6
_REGIONS: Final = ("rows from the<br>first sheet", "rows from the<br>left ribbon")

_STYLE: Final = """
@page { size: A4; margin: 13mm 14mm; }
* { box-sizing: border-box; }
body { font: 10.5pt/1.4 "DejaVu Sans", "Segoe UI", Helvetica, Arial, sans-serif; color: #1c1e24; background: #fff;
       max-width: 190mm; margin: 0 auto; padding: 8mm 4mm; }
h1 { font-size: 15pt; margin: 0; }
h2 { font-size: 11.5pt; margin: 5mm 0 1.5mm; border-bottom: 0.3mm solid #c9ccd3; padding-bottom: 0.6mm;
     break-after: avoid; }
p { margin: 1mm 0 2mm; }
.sub { color: #646870; font-size: 9pt; margin: 0.5mm 0 3mm; }
.verdict { border-left: 2.4mm solid; padding: 2.5mm 4mm; margin: 0 0 3mm; }
.verdict.yes { border-color: #0072b2; background: #e6f1f8; }
.verdict.no { border-color: #d55e00; background: #fbeae0; }
.verdict strong { font-size: 14pt; display: block; }
table { border-collapse: collapse; width: 100%; font-size: 9pt; margin: 1mm 0 2mm; break-inside: avoid; }
th { text-align: left; font-weight: 600; color: #646870; border-bottom: 0.3mm solid #1c1e24; }
td, th { padding: 0.7mm 2.2mm 0.7mm 0; vertical-align: top; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tbody tr { border-bottom: 0.2mm solid #e3e5e9; }
tr.chosen td { font-weight: 600; background: #f1f6fa; }
.over { color: #b04a00; font-weight: 600; }
img { width: 100%; display: block; break-inside: avoid; }
figure { margin: 2mm 0; break-inside: avoid; }
figcaption { color: #646870; font-size: 8.5pt; }
ul.warnings { margin: 1mm 0; padding-left: 5mm; }
ul.warnings li { margin-bottom: 0.8mm; }
footer { color: #646870; font-size: 8pt; margin-top: 4mm; border-top: 0.3mm solid #c9ccd3; padding-top: 1mm; }
@media print { body { padding: 0; max-width: none; font-size: 9.5pt; -webkit-print-color-adjust: exact;
               print-color-adjust: exact; } }
"""


def write_fold_page(answer: FoldAnswer, path: str | os.PathLike[str]) -> None:
    """Write an answer as one HTML file, pictures and all.

    Raises
    ------
    FileError
        The file cannot be written.
    MissingLibraryError
        Matplotlib is not installed.
    """
    check_target(path)
    with atomic_write(path) as file:
        file.write(fold_page(answer).encode())


def fold_page(answer: FoldAnswer) -> str:
    """The text of the page."""
    drawn = pictures(answer)
    title = escape(answer.design.source.stem if answer.design.source else "Wing box")
    parts = [
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}: meshdrape fold</title>',
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><style>{_STYLE}</style></head><body>',
        f"<h1>{title}</h1>",
        f'<p class="sub">{_design(answer.design)}</p>',
        _verdict(answer),
        *_warnings(answer.warnings),
        "<h2>Criteria side by side</h2>",
        _criteria(answer.verdict),
        "<h2>Where</h2>",
        _figure(
            drawn["along"],
            "Circles: turns of the row and of the column of the drape's largest shear, where they cross the crease.",
        ),
        _pairs(answer.where),
        _figure(
            drawn["spar"],
            "Colours of shear, anchored at the locking angle; circles: the largest shear of either region.",
        ),
        "<h2>How to lay it</h2>",
        _laying(answer),
        "<h2>How far the design can go, and what to change</h2>",
        _limits(answer.limits, answer.verdict.locking_angle),
        _nearest(answer.nearest, answer.verdict.locking_angle),
        _figure(drawn["limits"], "f is the spar's deviation from the origami fold, positive into the wing."),
    ]
    if "envelope" in drawn:
        parts.append(_figure(drawn["envelope"], "Grey: no net could be laid."))
    seconds = ", ".join(f"{escape(stage)} {value:.1f} s" for stage, value in answer.seconds.items())
    parts.append(f"<footer>meshdrape {__version__}{'; ' + seconds if seconds else ''}</footer></body></html>\n")
    return "\n".join(parts)


def _design(design: Design) -> str:
    """What was asked, in a line."""
    metre = 1000.0
    spar = design.deviation or design.spar
    kind = "f" if design.deviation is not None else "g_s"
    numbers = ", ".join(
        f"{name} {value:g}" for name, value in (spar.parameters if spar else {}).items() if isinstance(value, float)
    )
    shape = f"{kind} {spar.name}" + (f" ({numbers})" if numbers else "") if spar else ""
    rule = RULES.get(design.rule, design.rule)
    return escape(
        f"span {design.span / metre:g} m, chord {design.chord / metre:g} m, spar {design.spar_height / metre:g} m; "
        f"wing {design.wing.name}, {shape}, lengths in mm; spacing {design.spacing:g} mm, locking at "
        f"{degrees(design.locking_angle):g}°; laid on the {design.first} first from the {design.end}, left-most ribbon "
        f"{rule}"
    )


def _verdict(answer: FoldAnswer) -> str:
    verdict, best = answer.verdict, answer.laying.best
    largest, lock = verdict.criteria["drape"].largest, verdict.locking_angle
    kind, words = ("yes", "Can be made") if verdict.feasible else ("no", "Cannot be made as it is")
    side = "below" if verdict.margin >= 0 else "past"
    more = ""
    if degrees(verdict.first_sheet) > 0.01:
        more = f" The sheet laid first shears by {_deg(verdict.first_sheet)}."
    if not verdict.feasible and best.largest <= lock:
        more += (
            f" Laid on the {best.first} first, from the {best.end}, it takes {_deg(best.largest)}: see How to lay it."
        )
    return (
        f'<div class="verdict {kind}"><strong>{words}: {_deg(abs(verdict.margin))} {side} locking</strong>'
        f"Largest shear of the drape {_deg(largest)}, locking at {_deg(lock)}; left-most ribbon at "
        f"γ = {_deg(verdict.gamma)}.{more}</div>"
    )


def _pairs(where: Where) -> str:
    """The stations that set the largest shear of either region."""
    said = []
    for pair, fed, row in (
        (where.worst_wing_fed, "Rows from the first sheet", "the row that crosses"),
        (where.worst_ribbon_fed, "Rows from the left ribbon", "that ribbon"),
    ):
        if pair is None:
            continue
        x, y, z = (f"{value / 1000:.2f}" for value in pair.place)
        crossing = f"{row} at y = {pair.y_row / 1000:.2f} m" if pair is where.worst_wing_fed else row
        said.append(
            f"{fed}: <b>{_deg(abs(pair.shear))}</b> at ({x}, {y}, {z}) m, where {crossing} meets the column that "
            f"crosses at y = {pair.y_column / 1000:.2f} m."
        )
    return f"<p>{'<br>'.join(said)}</p>" if said else ""


def _criteria(verdict: Verdict) -> str:
    rows = []
    for name, shear in verdict.criteria.items():
        chosen = ' class="chosen"' if name == "drape" else ""
        cells = "".join(_angle_cell(value, verdict.locking_angle) for value in (shear.wing_fed, shear.ribbon_fed))
        remark = escape(verdict.remarks.get(name, ""))
        rows.append(f"<tr{chosen}><td>{_CRITERIA.get(name, escape(name))}</td>{cells}<td>{remark}</td></tr>")
    return _table(("criterion", *_REGIONS, ""), rows, numeric=(1, 2))


def _laying(answer: FoldAnswer) -> str:
    laying, locking = answer.laying, answer.verdict.locking_angle
    best, design = laying.best, answer.design
    within = "" if best.largest <= locking else ", still past locking"
    cost = (
        ""
        if best.well_posed
        else f"; rows come back to the {best.first}, which shears by up to {_deg(best.returning)} and cannot be laid "
        "undeformed (ill-posed)"
    )
    text = (
        f"<p>Cheapest: on the <b>{best.first}</b> first, from the <b>{best.end}</b>, left-most ribbon "
        f"{RULES.get(best.rule, best.rule)} (γ = {_deg(best.gamma)}): <b>{_deg(best.largest)}</b>{within}{cost}. For "
        f"the design's own start the best γ is {_deg(laying.gamma_best)}. "
        "By the characteristic net; of ill-posed ways the best is draped.</p>"
    )
    asked = [c for c in laying.choices if (c.first, c.end, c.rule) == (design.first, design.end, design.rule)]
    shown = list(laying.choices[:_MOST_CHOICES])
    shown += [choice for choice in asked if choice not in shown]
    rows = [_choice(choice, choice == best, choice in asked, locking) for choice in shown]
    head = ("first", "from", "left-most ribbon", "γ", *_REGIONS, "rows that<br>come back", "")
    return text + _table(head, rows, numeric=(3, 4, 5, 6))


def _choice(choice: Choice, best: bool, asked: bool, locking: float) -> str:
    words = (choice.first, choice.end, RULES.get(choice.rule, choice.rule))
    cells = "".join(f"<td>{escape(word)}</td>" for word in words) + f'<td class="n">{_deg(choice.gamma)}</td>'
    for value in (choice.shear.wing_fed, choice.shear.ribbon_fed, None if choice.well_posed else choice.returning):
        cells += _angle_cell(value, locking)
    cells += f"<td>{'as designed' if asked else ''}</td>"
    return f"<tr{' class=chosen' if best else ''}>{cells}</tr>"


def _limits(limits: Iterable[Limit], locking: float) -> str:
    rows = []
    for limit in limits:
        if limit.factor is None:
            factor = "no limit" if isinf(limit.tried) else f"more than {limit.tried:.3g}"
        else:
            factor = f"{limit.factor:.3f}"
        cells = "".join(_angle_cell(value, locking) for value in (limit.shear.wing_fed, limit.shear.ribbon_fed))
        rows.append(
            f'<tr><td>{escape(RULES.get(limit.rule, limit.rule))}</td><td class="n">{factor}</td>'
            f'<td class="n">{_deg(limit.gamma)}</td>{cells}</tr>'
        )
    head = (
        "left-most ribbon",
        "largest factor on f",
        "γ",
        "rows from the<br>first sheet",
        "rows from the<br>left ribbon",
    )
    return _table(head, rows, numeric=(1, 2, 3, 4))


def _nearest(nearest: NearestSpar, locking: float) -> str:
    laid = f"γ = {_deg(nearest.gamma)}"
    if nearest.unchanged:
        return f"<p>The spar can stay as it is, laid with {laid}: {_deg(nearest.shear.largest)} in the drape.</p>"
    proof = "its drape proves it" if nearest.proven else "its drape does not bear it out"
    return (
        f"<p>Nearest spar that can be made (least squares in {escape(nearest.measure)}): at most "
        f"<b>{nearest.largest_loss:.1f} mm</b> from the wanted one, at y = {nearest.largest_loss_at / 1000:.2f} m, "
        f"{nearest.rms_loss:.1f} mm in the mean square; laid with {laid} it shears by {_deg(nearest.shear.largest)} of "
        f"{_deg(locking)}: {proof} ({nearest.drapes} drapes).</p>"
    )


def _warnings(warnings: tuple[FoldWarning, ...]) -> list[str]:
    if not warnings:
        return []
    items = "".join(f"<li>{escape(warning.text)}{_stretch(warning)}</li>" for warning in warnings)
    return ["<h2>Warnings</h2>", f'<ul class="warnings">{items}</ul>']


def _stretch(warning: FoldWarning) -> str:
    """Where, if the text does not say so itself."""
    if warning.start is None or warning.end is None or "y =" in warning.text:
        return ""
    return f" (y = {warning.start / 1000:.2f} to {warning.end / 1000:.2f} m)"


def _table(head: tuple[str, ...], rows: list[str], numeric: tuple[int, ...]) -> str:
    titles = "".join(f"<th{' class=n' if k in numeric else ''}>{word}</th>" for k, word in enumerate(head))
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _angle_cell(value: float | None, locking: float) -> str:
    if value is None:
        return '<td class="n">–</td>'
    return f'<td class="n{" over" if value > locking else ""}">{_deg(value)}</td>'


def _deg(value: float) -> str:
    """An angle in degrees, two decimals, with a minus sign where it is one."""
    text = f"{degrees(value):.2f}"
    return ("0.00" if text == "-0.00" else text).replace("-", "−") + "°"


def _figure(content: bytes, caption: str) -> str:
    data = base64.b64encode(content).decode()
    return f'<figure><img alt="" src="data:image/png;base64,{data}"><figcaption>{escape(caption)}</figcaption></figure>'
