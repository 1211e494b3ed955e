"""meshdrape validate: the study group report recomputed, claim by claim."""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdrape.cli.main import DONE, UNJUDGED
from meshdrape.cli.progress import Progress, compilation_told

if TYPE_CHECKING:
    from meshdrape.study.claims import Recomputed

PAGE, SUFFIXES = "docs/validation.md", (".md", ".markdown")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("-o", "--output", default=PAGE, metavar="PAGE.md",
                        help=f"the page, Markdown; its pictures go into a folder PAGE beside it ({PAGE})")  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="coarser drapes and fewer of them, for a first look")
    parser.add_argument("--json", action="store_true", help="print the claims as JSON")


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """Recompute, write the page and its pictures, print the verdicts."""
    del arguments
    from meshdrape.output.files import check_suffix, check_target

    begun = time.perf_counter()
    page = Path(options.output)
    check_suffix(page, SUFFIXES, "the page")
    check_target(page)
    with Progress(options.json) as progress:
        progress.stage("importing")
        from meshdrape.output.validation import write_validation
        from meshdrape.study.claims import n_steps, recompute

        progress.stage("recomputing the report", n_steps())
        with compilation_told(options.json):
            recomputed = recompute(quick=options.quick, progress=progress.step)
        progress.stage("drawing")
        progress.step(0)
        command = "meshdrape validate" + (" --quick" if options.quick else "")
        files = write_validation(recomputed, page, command)
    seconds = time.perf_counter() - begun
    if options.json:
        from meshdrape.output import json_text

        sys.stdout.write(json_text(_facts(recomputed, files, seconds)))
    else:
        sys.stdout.write(_report(recomputed, files, seconds))
    return UNJUDGED if _unjudged(recomputed) else DONE


def _unjudged(recomputed: Recomputed) -> list[str]:
    """Places of the claims for which a number was missing."""
    from meshdrape.study.claims import Verdict

    return [claim.place for claim in recomputed.claims if claim.verdict is Verdict.NOT_FOUND]


def _facts(recomputed: Recomputed, files: list[Path], seconds: float) -> dict[str, Any]:
    return {
        "claims": [
            {
                "place": claim.place,
                "says": claim.says,
                "found": claim.found,
                "error": claim.judgement.error,
                "unit": claim.judgement.unit,
                "threshold": claim.judgement.threshold,
                "verdict": claim.verdict.value,
                "remark": claim.remark,
            }
            for claim in recomputed.claims
        ],
        "quick": recomputed.quick,
        "files": files,
        "seconds": seconds,
    }


def _report(recomputed: Recomputed, files: list[Path], seconds: float) -> str:
    width = max(len(claim.place) for claim in recomputed.claims)
    lines = [f"{claim.place:>{width}}  {claim.verdict.value}" for claim in recomputed.claims]
    counted = Counter(claim.verdict.value for claim in recomputed.claims).most_common()
    lines.append(
        f"{len(recomputed.claims)} claims in {seconds:.0f} s: " + ", ".join(f"{n} {name}" for name, n in counted)
    )
    if missing := _unjudged(recomputed):
        lines.append(f"WARNING  no verdict for want of numbers: {', '.join(missing)}")
    lines.append(f"wrote {files[0]} and {len(files) - 1} pictures beside it")
    return "\n".join(lines) + "\n"
