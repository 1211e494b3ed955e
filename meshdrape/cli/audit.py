"""meshdrape audit NET.ply: a finished net checked again, from its file and the mould's."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdrape.cli.main import DONE, FABRIC_MISSING
from meshdrape.cli.options import count, positive
from meshdrape.cli.progress import compilation_told
from meshdrape.errors import FabricError, FileError, NetError, StartError

if TYPE_CHECKING:
    from meshdrape.mould import Mould
    from meshdrape.output import StoredNet
    from meshdrape.weave.recheck.verdict import Recheck

# libigl measures edges for this long, s, unless told otherwise.
SECONDS = 10.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("net", metavar="NET.ply", help="a net that meshdrape wrote")
    parser.add_argument("--mould", metavar="FILE", help="the mould's file, where it is not where the net says")
    sample = parser.add_mutually_exclusive_group()
    sample.add_argument(
        "--edges", type=count, metavar="N", help="let libigl measure N edges, chosen at random, however long it takes"
    )
    sample.add_argument(
        "--seconds",
        type=positive,
        metavar="S",
        help=f"let libigl measure edges for S seconds, all of them if that suffices ({SECONDS:g})",
    )
    parser.add_argument("--json", action="store_true", help="print as JSON")


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """Check the net; one line of verdict."""
    del arguments
    from meshdrape.output import json_text, read_net
    from meshdrape.weave.recheck.verdict import recheck

    path = Path(options.net)
    stored = read_net(path)
    mould = _mould(path, stored, options.mould)
    seconds = math.inf if options.edges else options.seconds or SECONDS
    try:
        with compilation_told(options.json):
            found = recheck(mould, stored, options.edges, seconds)
    except (StartError, FabricError) as error:
        # of a net that was laid neither would have come
        msg = f"{path} is not the net that was laid on {mould.source}: {error}; drape anew"
        raise NetError(msg) from error
    failures = list(found.failures)
    if not stored.sealed:
        failures.insert(0, "the file was changed after it was written")
    verdict = "holds" if not failures else "does not hold: " + "; ".join(failures)
    if options.json:
        sys.stdout.write(json_text(_facts(path, stored, found, failures, verdict)))
    else:
        sys.stdout.write(_report(stored, found) + f"{path} {verdict}\n")
    return FABRIC_MISSING if failures else DONE


def _mould(path: Path, stored: StoredNet, given: str | None) -> Mould:
    """The mould the net was laid on, read as it was then."""
    from meshdrape.mould import read_mould
    from meshdrape.mould.files import existing_file, file_sha256

    file = Path(given) if given else stored.mould_file
    if file is None:
        msg = f"{path} names no mould file: it was laid on arrays; write them to a file and give it with --mould"
        raise NetError(msg)
    if not given and not file.exists():
        msg = f"the mould of {path} is not at {file}; say where it is with --mould FILE"
        raise FileError(msg)
    existing_file(file)
    digest = file_sha256(file)
    if stored.mould_sha256 is not None and digest != stored.mould_sha256:
        msg = (
            f"{file} is not the file {path} was laid on: its SHA-256 begins with {digest[:12]}, the net's with "
            f"{stored.mould_sha256[:12]}; give that file with --mould, or drape anew"
        )
        raise FileError(msg)
    is_brep = stored.angle_tolerance is not None
    mould = read_mould(
        file,
        faces=list(stored.mould_faces) if is_brep else None,
        unit=None if is_brep else stored.mould_unit,
        chord_tolerance=stored.chord_tolerance,
        angle_tolerance=stored.angle_tolerance,
        heal=stored.mould_healed,
        parameters=dict(stored.mould_parameters) or None,
    )
    return mould.flipped() if stored.mould_turned else mould


def _facts(path: Path, stored: StoredNet, found: Recheck, failures: list[str], verdict: str) -> dict[str, Any]:
    return {
        "net": str(path),
        "version": stored.version,
        "verdict": verdict,
        "holds": not failures,
        "failures": failures,
        "unchanged_since_written": stored.sealed,
        "nodes": found.n_nodes,
        "nodes_off_mould": found.n_off_mould,
        "off_mould_spacings": found.off_mould,
        "off_generator_spacings": found.off_generator,
        "edges": found.n_edges,
        "edges_straight": found.n_straight,
        "edges_off_mould_unchecked": found.n_unchecked,
        "audit": asdict(found.edges),
        "audit_max_relative_error": found.edges.max_relative_error,
        "cells_checked": found.n_shear,
        "shear_error_deg": math.degrees(found.shear_error),
        "balance_error_deg": math.degrees(found.balance_error),
        "balance_residual_deg": math.degrees(found.balance_residual),
        "seconds": found.seconds,
    }


def _report(stored: StoredNet, found: Recheck) -> str:
    edges = found.edges
    rows = [
        ("file", "as it was written" if stored.sealed else "changed after it was written"),
        (
            "nodes",
            f"{found.n_nodes:,} on the mould to {found.off_mould:.1e} of a spacing, {found.n_off_mould:,} beyond",
        ),
        ("generators", f"straightest to {found.off_generator:.1e} of a spacing"),
        ("edges", f"{found.n_edges:,} on the mould, {found.n_straight:,} off the generators straight and one spacing"),
        ("", f"long; {found.n_unchecked:,} with an end off the mould not checked"),
        ("libigl", f"{edges.n_edges:,} measured, largest relative error {edges.max_relative_error:.1e}"),
        ("shear", f"{found.n_shear:,} cells measured again, to {math.degrees(found.shear_error):.1e} deg"),
        ("balance", f"shear within {math.degrees(found.balance_residual):.2g} deg of the enclosed curvature's"),
    ]
    return "".join(f"{name:>10}  {text}\n" for name, text in rows)
