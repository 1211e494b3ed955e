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
    parser.add_argument(
        "-o",
        "--output",
        required=True,
        metavar="NET.ply",
        help="the net; NET.mould.ply, NET.fibres.ply, NET.json and NET.png go beside it",
    )
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
        "--stop-at",
        type=degrees,
        metavar="DEG",
        help="end the cloth, cell by cell, before the first that would shear by more",
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
        help="axis that fibre angles count from, projected on the mould (1,0,0)",
    )
    out.add_argument("--json", action="store_true", help="print the summary as JSON")
    out.add_argument("--quiet", action="store_true", help="print nothing but errors")
    out.add_argument("--no-picture", action="store_true", help="do not draw NET.png")
    out.add_argument(
        "--refine",
        action="store_true",
        help="drape on two coarser tessellations too, for an error bar of the maximum shear; not of a mesh file "
        "nor with --stop-at",
    )
    out.add_argument(
        "--engine",
        choices=("fast", "libigl"),
        default="fast",
        help="libigl: every node from its exact distances, slow, to check by (fast)",
    )
    out.add_argument(
        "--threads", type=count, metavar="N", help="threads to drape on (all cores); the net does not depend on it"
    )


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """Drape, write every file, print the summary."""
    from meshdrape.output.files import check_suffix, check_target
    from meshdrape.weave.fabric import Fabric

    net_path = Path(options.output)
    check_target(net_path)
    # the other files take its name with their own suffixes: one of these would be written over it
    check_suffix(net_path, (".ply",), "a net")
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

            require_refinable(mould, options.stop_at)
        clock.lap("mould")

        from meshdrape.geodesic.guarded import prepare
        from meshdrape.weave import audit, drape, measure, read_off
        from meshdrape.weave.measures.balance import balance
        from meshdrape.weave.summary import fabric_missing, summarise

        clock.lap("imports")
        progress.stage("draping")
        prepare()
        # each of these may compile kernels of its own on the first run
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
            refined = refine(mould, fabric, net=net, threads=options.threads)
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
        from meshdrape.output.drape_text import drape_text

        sys.stdout.write(drape_text(summary, [*files, json_path]))
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
