"""meshdrape fold DESIGN.toml: how far may the spar leave the origami fold."""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from meshdrape.cli.main import DONE
from meshdrape.cli.progress import Progress, compilation_told
from meshdrape.errors import DesignError

if TYPE_CHECKING:
    from meshdrape.study.fold import FoldAnswer

SUFFIXES = (".html", ".json")
FAMILY = "sine"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("design", metavar="DESIGN.toml", help="wing, spar, fabric and start; see samples/designs")
    parser.add_argument(
        "-o",
        "--output",
        action="append",
        default=[],
        metavar="FILE",
        help="the answer as a page with pictures, .html, or .json; repeatable",
    )
    parser.add_argument(
        "--nearest",
        choices=("slope", "position"),
        default="slope",
        help="whether the nearest spar that drapes is nearest in f' or in f (slope)",
    )
    chart = parser.add_argument_group("the chart of allowable deviations")
    chart.add_argument(
        "--chart", nargs="?", const=(20, 20), type=_grid, metavar="AxB",
        help="drape A amplitudes x B wavelengths of a family of f (20x20); takes half a minute or more",
    )  # fmt: skip
    chart.add_argument("--family", choices=("sine", "ripple", "bump"), help="the family of f (sine)")
    parser.add_argument("--json", action="store_true", help="print the answer as JSON")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")


def _grid(text: str) -> tuple[int, int]:
    """Two counts, 20x20."""
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    if not found or min(int(found[1]), int(found[2])) < 2 or int(found[1]) * int(found[2]) > 10_000:
        msg = f"{text!r} is no chart: give 20x20, both at least 2 and at most 10,000 designs in all"
        raise argparse.ArgumentTypeError(msg)
    return int(found[1]), int(found[2])


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """Answer, write, print."""
    del arguments
    from meshdrape.output.files import check_suffix, check_target
    from meshdrape.study.fold.design import read_design

    if options.family and not options.chart:
        msg = f"--family {options.family} is the family of f that a chart varies: ask for one with --chart"
        raise DesignError(msg)
    targets = [Path(name) for name in options.output]
    for target in targets:
        check_suffix(target, SUFFIXES, "an answer")
        check_target(target)
    design = read_design(options.design)
    with Progress(options.quiet) as progress:
        progress.stage("reading the design")
        from meshdrape.study.fold import facts, fold_answer

        with compilation_told(options.quiet):
            answer = fold_answer(
                design,
                nearest=options.nearest,
                chart=options.chart,
                family=options.family or FAMILY,
                stage=progress.stage,
                step=progress.step,
            )
        progress.stage("writing")
        for target in targets:
            _write(answer, target)
    if options.json:
        from meshdrape.output import json_text

        sys.stdout.write(json_text(facts(answer)))
    elif not options.quiet:
        from meshdrape.output.fold.text import fold_text

        sys.stdout.write(fold_text(answer, targets))
    return DONE


def _write(answer: FoldAnswer, target: Path) -> None:
    if target.suffix.lower() == ".html":
        from meshdrape.output.fold.page import write_fold_page

        write_fold_page(answer, target)
        return
    from meshdrape.output import write_json
    from meshdrape.study.fold import facts

    write_json(facts(answer), target)
