"""The report recomputed, as a Markdown page with its pictures."""

from __future__ import annotations

import math
import os
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple

from meshdrape.output.chart import packed
from meshdrape.output.files import atomic_write, check_target
from meshdrape.output.picture.draw import draw_net
from meshdrape.output.validation.curve_figures import draw_convergence, draw_criteria
from meshdrape.output.validation.fold_figures import (
    draw_flat_spar,
    draw_flattened,
    draw_profiles,
    draw_turn,
    draw_weave,
)

if TYPE_CHECKING:
    from meshdrape.study.claims import Claim, Recomputed, Section, Views
    from meshdrape.study.claims.views import ProfileView

_WIDTH: Final = 1400  # pixels of the widest picture

_HEAD: Final = """# The study group report, recomputed

Written by `{command}`. Each number comes from a run made then: of the formulas (`meshdrape.theory`), of the net of rods
and pins on the two unrolled surfaces, and of full drapes on meshes (`meshdrape.drape`). Each verdict follows from its
numbers by a rule, whose threshold stands below it in small print, and a remark appears only with the verdict it belongs
to; `meshdrape/study/claims` holds the rules and the runs.

The report: *New Techniques for Composite Wing Manufacture*, D. Barton, H. Ockendon, B. Piette, R. Whittaker and others,
study group report for Airbus. A sheet of woven ribbons is laid on a wing, z = g_w(y), and folded over its edge onto a
spar, x = g_s(y) = g_w(y) + f(y). ψ is the turn of the net where it crosses the edge, γ that of the left-most ribbon of
the spar. Unless another mould is named it is the 14 m wing of section 2, its spar 1 m high.
"""


class _Picture(NamedTuple):
    name: str
    title: str
    caption: str
    content: bytes


def write_validation(recomputed: Recomputed, path: str | os.PathLike[str], command: str) -> list[Path]:
    """Write the page, and its pictures into a folder beside it that is named after it.

    Parameters
    ----------
    recomputed : Recomputed
    path : path-like
        Of the Markdown file; its pictures go to ``NAME/*.png``.
    command : str
        What wrote it, told on the page.

    Returns
    -------
    list of Path
        Every file written, the page first.

    Raises
    ------
    FileError
        A file cannot be written.
    """
    page = Path(path)
    check_target(page)
    folder = page.with_suffix("")
    folder.mkdir(exist_ok=True)
    pictures = list(_pictures(recomputed.views))
    written = [page]
    for picture in pictures:
        target = folder / f"{picture.name}.png"
        with atomic_write(target) as file:
            file.write(picture.content)
        written.append(target)
    with atomic_write(page) as file:
        file.write(_text(recomputed, pictures, folder.name, command).encode())
    return written


def _text(recomputed: Recomputed, pictures: list[_Picture], folder: str, command: str) -> str:
    counted = Counter(claim.verdict for claim in recomputed.claims)
    parts = [_HEAD.format(command=command), "## Summary\n", "| verdict | claims |\n|---|---|"]
    parts += [f"| {verdict.value} | {count} |" for verdict, count in counted.most_common()]
    parts.append("")
    for section in recomputed.sections:
        parts += _section(section)
    parts.append("## What the report's figures show, from these runs\n")
    for picture in pictures:
        parts += [
            f"### {picture.title}\n",
            f"![{picture.title}]({folder}/{picture.name}.png)\n",
            f"{picture.caption}\n",
        ]
    return "\n".join(parts).rstrip() + "\n"


def _section(section: Section) -> list[str]:
    rows = [f"## {section.title}\n", "| place | it says | found | error | verdict |", "|---|---|---|---|---|"]
    return [*rows, *(_row(claim) for claim in section.claims), ""]


def _row(claim: Claim) -> str:
    verdict = f"**{claim.verdict.value}**"
    if claim.remark:
        verdict += f". {claim.remark}"
    verdict += f"<br><sub>{claim.judgement.threshold}</sub>"
    cells = (claim.place, claim.says, claim.found, _error(claim), verdict)
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _error(claim: Claim) -> str:
    """The error to two digits, with its unit; 0 for what is round-off of nothing, no number for what was not found."""
    error, unit = claim.judgement.error, {"deg": "°"}.get(claim.judgement.unit, claim.judgement.unit)
    if not math.isfinite(error):
        return "none found"
    if error == 0:
        return "0"
    if 1e-3 <= abs(error) < 1e4:
        return f"{error:.3g}{unit}"
    mantissa, exponent = f"{error:.1e}".split("e")
    return f"{mantissa}·10^{int(exponent)}{unit}"


def _pictures(views: Views) -> Iterator[_Picture]:
    yield _Picture(
        "weave", "Figure 2: the weave at zero and at critical shear",
        "Above, a fabric that locks at 7°: its ribbons leave gaps of less than a hundredth of their pitch. Below, one "
        "of narrower ribbons, for the eye. Pitches along the ribbons are kept; gaps close with the cosine of "
        "the shear.",
        draw_weave(views.weaves),
    )  # fmt: skip
    yield _Picture(
        "regions", "Figure 4: wing and spar rolled out",
        "g_w = 0.2 y², g_s = 0.4 y², draped on a mesh at 50 mm, γ = 0. In region I rows start on the left-most ribbon, "
        "in region II they come from the wing. Cells across the edge, and those between the last row of one "
        "kind and the "
        "first of the other, belong to neither.",
        draw_flattened(views.figure_4),
    )  # fmt: skip
    yield _Picture(
        "wing", "Figure 5: wing with a deformed spar, draped",
        "The 14 m wing; the slope of its spar departs from the origami one by f' = 0.1 sin²(πy/14 m).",
        _wing(views.profiles),
    )  # fmt: skip
    yield _Picture(
        "profiles", "Figure 6: profiles of the spar",
        "Origami and modified, of the families of f on this page.", draw_profiles(views.profiles),
    )  # fmt: skip
    yield _Picture(
        "flat_spar", "Figure 7: the net on a flat spar",
        "g_w = y²/20, g_s = 0, draped at 100 mm; nodes numbered as in the report.", draw_flat_spar(views.flat_spar),
    )  # fmt: skip
    yield _Picture(
        "turn", "Figure 9: rotation of the cells at the edge",
        "The discrete net about a crossing of a straight edge, g_w' = 0.25, g_s' = 0.5, both sheets rolled out.",
        draw_turn(views.turn),
    )  # fmt: skip
    yield _Picture(
        "criteria", "Criteria against the largest shear",
        "By amplitude, for five families of f on the 14 m wing. (20) is unsafe where f' changes sign, since rows from "
        "the wing see the whole range of ψ, and too strict where f' does not vary or its extremes lie out of each "
        "other's reach. (29) is never below the shear found.",
        draw_criteria(views.criteria, views.locking_angle),
    )  # fmt: skip
    yield _Picture(
        "convergence", "Convergence in the spacing",
        "Largest shear of figure 4 in either region, the last column at the span's end: short of its limit by a first "
        "power of the spacing in region I, by the square root of it in region II, whose first row leaves the edge "
        "tangentially.",
        draw_convergence(views.convergence),
    )  # fmt: skip


def _wing(view: ProfileView) -> bytes:
    """The drape as `meshdrape drape` draws it."""
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "wing.png"
        draw_net(view.draped.net, view.draped.measures, target)
        return packed(target.read_bytes(), _WIDTH)
