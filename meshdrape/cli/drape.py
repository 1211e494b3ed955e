"""meshdrape drape MOULD -o NET.ply: the main job."""

from __future__ import annotations

import argparse
import os
import shlex
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from meshdrape.cli.main import DONE, FABRIC_MISSING
from meshdrape.cli.options import (
    add_cloth_options,
    add_mould_options,
    add_start_options,
    axis,
    count,
    degrees,
    read_mould,
    read_path,
)
from meshdrape.cli.progress import Progress, compilation_told
from meshdrape.errors import FileError, StartError

# What is written beside NET.ply.
MOULD, FIBRES, PICTURE, SUMMARY = ".mould.ply", ".fibres.ply", ".png", ".json"
COMPANIONS = (MOULD, FIBRES, PICTURE, SUMMARY)
# libigl's audit may take this long, s, and stops at this many edges.
AUDIT_SECONDS, AUDIT_EDGES = 0.5, 1000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_mould_options(parser)
    parser.add_argument("-o", "--output", required=True, metavar="NET.ply", help="the net; its companions go beside it")
    add_cloth_options(parser, spacing_required=True)
    start = add_start_options(parser)
    for name in ("warp", "weft"):
        start.add_argument(
            f"--{name}-turn-deg", type=degrees, metavar="DEG",
            help=f"turn of the {name} start fibre at the first crease it meets, right-handed about the normal",
        )  # fmt: skip
    for name in ("warp", "weft"):
        start.add_argument(
            f"--{name}-path",
            metavar="FILE",
            help=f"points of the {name} start fibre in mm: x y z a line, or an OBJ line",
        )
    start.add_argument(
        "--stop-at", type=degrees, metavar="DEG", help="end the cloth before the first cell sheared by more"
    )
    start.add_argument(
        "--recrossing", action="store_true", help="go on where a fibre comes back over a crease that it crossed"
    )
    start.add_argument("--flip-normal", action="store_true", help="lay the cloth on the other side of the tool")
    out = parser.add_argument_group("the results")
    out.add_argument(
        "--reference",
        type=axis,
        default=(1.0, 0.0, 0.0),
        metavar="X,Y,Z",
        help="zero of fibre angles (x)",
    )
    out.add_argument("--json", action="store_true", help="print the summary as JSON")
    out.add_argument("--quiet", action="store_true", help="print nothing but errors")
    out.add_argument("--no-picture", action="store_true", help="do not draw NET.png")
    out.add_argument(
        "--refine", action="store_true", help="drape on two coarser tessellations too: an error bar for the shear"
    )
    out.add_argument("--engine", choices=("fast", "libigl"), default="fast", help="libigl: every node by it; slow")
    out.add_argument("--threads", type=count, metavar="N", help="default: all cores; the net does not depend on it")


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """Drape, write every file, print the summary."""
    from meshdrape.output.files import check_target
    from meshdrape.weave.fabric import Fabric

    net_path = Path(options.output)
    check_target(net_path)
    if net_path.suffix.lower() != ".ply":
        # its companions have others, and would take its place
        msg = f"{net_path} has the suffix {net_path.suffix or '(none)'}; a net is written as .ply"
        raise FileError(msg)
    companions = [net_path.with_suffix(suffix) for suffix in COMPANIONS if suffix != PICTURE or not options.no_picture]
    for companion in companions:
        check_target(companion)
    _require_own_files([net_path, *companions], [options.mould, options.warp_path, options.weft_path])
    fabric = Fabric(options.spacing, options.initial_angle, options.locking_angle)
    warp_path, weft_path = read_path(options.warp_path), read_path(options.weft_path)
    clock = _Clock()
    with Progress(options.quiet) as progress:
        progress.stage("reading the mould")
        mould = read_mould(options)
        if options.flip_normal:
            mould = mould.flipped()
        if options.refine:
            from meshdrape.study.convergence import require_refinable

            require_refinable(mould)
        clock.lap("mould")

        from meshdrape.geodesic.guarded import prepare
        from meshdrape.weave import audit, drape, measure, read_off
        from meshdrape.weave.balance import balance
        from meshdrape.weave.summary import fabric_missing, summarise

        clock.lap("imports")
        progress.stage("draping")
        prepare()
        with compilation_told(options.quiet), _paths_named(options):
            net = drape(
                mould,
                fabric,
                options.seed,
                options.direction,
                engine=options.engine,
                extent=options.extent,
                warp_turn=options.warp_turn_deg,
                weft_turn=options.weft_turn_deg,
                warp_path=warp_path,
                weft_path=weft_path,
                stop_at=options.stop_at,
                recrossing=options.recrossing,
                threads=options.threads,
                progress=progress.step,
            )
        clock.lap("drape")
        progress.stage("measuring")
        measures = measure(net)
        progress.step(0)
        field = read_off(measures, options.reference)
        foretold = balance(measures)
        clock.lap("measures")
        audited = audit(net, AUDIT_EDGES, seconds=AUDIT_SECONDS)
        clock.lap("audit")
        refined = None
        if options.refine:
            from meshdrape.study import refine

            progress.stage("draping on coarser facets")
            refined = refine(mould, fabric, extent=options.extent, net=net, threads=options.threads)
            clock.lap("refinement")
        progress.stage("writing")
        progress.step(0)
        files = _write(net, measures, field, foretold, net_path, picture=not options.no_picture)
        clock.lap("files")
        command = shlex.join(["meshdrape", *arguments])
        summary = summarise(measures, field, audited, foretold, clock.stages(), command)

        if refined is not None:
            summary["refinement"] = refined.facts()
        from meshdrape.output import json_text, write_json

        json_path = net_path.with_suffix(SUMMARY)
        write_json(summary, json_path)
    if options.json:
        sys.stdout.write(json_text(summary))
    elif not options.quiet:
        sys.stdout.write(_report(summary, [*files, json_path]))
    return FABRIC_MISSING if fabric_missing(net) else DONE


def _require_own_files(targets: list[Path], given: list[str | None]) -> None:
    """Raise FileError where a file of the results would take the place of one that is read."""
    inputs = {os.path.realpath(name) for name in given if name is not None}
    for target in targets:
        if os.path.realpath(target) in inputs:
            msg = f"{target} is read and would be overwritten by the net; give the net another name than {targets[0]}"
            raise FileError(msg)


@contextmanager
def _paths_named(options: argparse.Namespace) -> Iterator[None]:
    """Errors of a path told of the file it is in, by which its user knows it."""
    try:
        yield
    except StartError as error:
        text = str(error)
        for name in ("warp", "weft"):
            text = text.replace(f"{name}_turn", f"--{name}-turn-deg")
            text = text.replace(f"{name}_path", getattr(options, f"{name}_path") or f"--{name}-path")
        raise StartError(text) from error


class _Clock:
    """Time by stage."""

    def __init__(self) -> None:
        self._begun = self._last = time.perf_counter()
        self._laps: dict[str, float] = {}

    def lap(self, stage: str) -> None:
        """End a stage."""
        now = time.perf_counter()
        self._laps[stage] = now - self._last
        self._last = now

    def stages(self) -> dict[str, float]:
        """Seconds by stage, and in all."""
        return {**self._laps, "total": time.perf_counter() - self._begun}


def _write(net: Any, measures: Any, field: Any, foretold: Any, net_path: Path, picture: bool) -> list[Path]:
    from meshdrape.output import draw_net, write_fibres_ply, write_mould_ply, write_ply

    mould_path, fibres_path, picture_path = (net_path.with_suffix(suffix) for suffix in (MOULD, FIBRES, PICTURE))
    write_ply(net, net_path, measures, foretold)
    write_mould_ply(field, mould_path, net.fabric.locking_angle)
    write_fibres_ply(net, fibres_path)
    written = [net_path, mould_path, fibres_path]
    if picture:
        draw_net(net, measures, picture_path)
        written.append(picture_path)
    return written


def _balance_text(summary: dict[str, Any]) -> str:
    at = summary["balance_residual_at"]
    where = "" if at is None else f", worst at ({', '.join(f'{v:.1f}' for v in at)})"
    return f"shear agrees with the enclosed curvature to {summary['balance_residual_deg']:.2g} deg{where}"


def _report(summary: dict[str, Any], files: list[Path]) -> str:
    """The summary for people."""
    mould, fabric, cloth, checked = summary["mould"], summary["fabric"], summary["cloth_mm"], summary["audit"]
    size = " x ".join(f"{v:,.0f}" for v in mould["size_mm"])
    tolerances = (
        ""
        if mould["angle_tolerance_deg"] is None
        else f" at {mould['angle_tolerance_deg']:g} deg and {mould['chord_tolerance_mm']:g} mm"
    )
    spacing_mm = fabric["spacing_mm"]
    woven = f"{spacing_mm[0]:g}" if spacing_mm[0] == spacing_mm[1] else f"{spacing_mm[0]:g} x {spacing_mm[1]:g}"
    at = summary["max_shear_at"]
    where = "" if at is None else f" at ({', '.join(f'{v:.1f}' for v in at)})"
    if summary["max_shear_face"]:
        where += f", face {summary['max_shear_face']}"
    error = summary["audit_max_relative_error"]
    rows = [
        ("mould", f"{mould['file']}, {size} mm, {mould['triangles']:,} triangles{tolerances}"),
        ("seed", f"({', '.join(f'{v:.3f}' for v in summary['seed'])})"),
        ("net", f"{summary['nodes']:,} nodes, {summary['cells']:,} cells, spacing {woven} mm"),
        ("cloth", f"{cloth['warp']:,.0f} x {cloth['weft']:,.0f} mm, {cloth['area_mm2'] / 1e6:.3f} m2"),
        ("coverage", f"{summary['coverage_percent']:.2f} % of the mould"),
        ("max shear", f"{summary['max_shear_deg']:.3f} deg{where}"),
        (
            "locking",
            f"{summary['over_locking_percent']:.2f} % of the area above {fabric['locking_angle_deg']:g} deg",
        ),
        ("mesh noise", f"{summary['mesh_noise_deg']:.3f} deg"),
        ("balance", _balance_text(summary)),
        ("audit", f"{checked['n_edges']:,} edges by libigl, largest relative error {error:.1e}"),
        ("time", ", ".join(f"{stage} {value:.2f} s" for stage, value in summary["seconds"].items())),
    ]
    if "refinement" in summary:
        bar = summary["refinement"]
        tried = " / ".join(f"{value:.3f}" for value in bar["max_shear_deg"])
        rows.insert(
            6,
            (
                "refined",
                f"max shear +- {bar['error_bar_deg']:.2g} deg ({tried} on {bar['triangles'][0]:,} to "
                f"{bar['triangles'][2]:,} triangles); +- {bar['spacing_error_deg']:.2g} deg for the spacing",
            ),
        )
    if summary["warp_angle_deg"]:
        angle = summary["warp_angle_deg"]
        rows.insert(
            next(n for n, (name, _) in enumerate(rows) if name == "mesh noise"),
            (
                "warp angle",
                f"{angle['min']:.2f} to {angle['max']:.2f} deg from the reference, mean {angle['mean']:.2f}",
            ),
        )
    for name, fibre in summary["start_fibres"].items():
        if fibre["turn_deg"] is not None:
            rows.insert(2, (f"{name} fibre", f"turned by {fibre['turn_deg']:g} deg at the crease"))
        if fibre["path_points"] is not None:
            rows.insert(2, (f"{name} fibre", f"drawn through {fibre['path_points']} points"))
    lines = [f"{name:>10}  {text}" for name, text in rows]
    lines += [
        f"{'face ' + str(face['id']):>10}  {face['name'] or ''} covered {face['coverage_percent']:.1f} %, "
        f"max shear {face['max_shear_deg'] or 0:.3f} deg, {face['over_locking_percent']:.1f} % above locking"
        for face in summary["faces"]
    ]
    lines += [f"{'note':>10}  {note}" for note in summary["notes"]]
    lines += [f"{'WARNING':>10}  {warning}" for warning in summary["warnings"]]
    lines += [f"{'wrote':>10}  {path}" for path in files]
    return "\n".join(lines) + "\n"
