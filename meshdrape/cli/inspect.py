"""meshdrape inspect MOULD: what is in the file, before anything is draped."""

from __future__ import annotations

import argparse
import math
import sys
from typing import TYPE_CHECKING, Any

from meshdrape.cli.main import BAD_INPUT, DONE
from meshdrape.cli.options import (
    add_cloth_options,
    add_faces_option,
    add_reading_options,
    add_start_options,
    read_mould,
    reading,
)
from meshdrape.cli.progress import compilation_told

if TYPE_CHECKING:
    from meshdrape.mould.inspect import Inspection


# Any of these asks for a forecast.
START = ("seed", "direction", "spacing", "extent")
# Spacing of the cloth where none is given: the mould's diagonal holds so many.
SPACINGS = 300


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    group = add_reading_options(parser)
    add_faces_option(group)
    add_cloth_options(parser, spacing_required=False)
    add_start_options(parser)
    parser.epilog = f"Any of {', '.join(f'--{name}' for name in START)} asks what shear the start would need."
    parser.add_argument("--json", action="store_true", help="print as JSON")


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """List faces and faults; a mesh with faults is bad input."""
    del arguments
    from meshdrape.mould.inspect import inspect_mould

    found = inspect_mould(options.mould, **reading(options))
    facts = _facts(found)
    if not found.faults and any(getattr(options, name) is not None for name in START):
        facts |= _forecast(options, found)
    if options.json:
        from meshdrape.output import json_text

        sys.stdout.write(json_text(facts))
    else:
        sys.stdout.write(_report(facts))
    if found.faults:
        sys.stderr.write(f"meshdrape: {found.path} cannot be draped as it is: repair it with --heal, or in CAD\n")
        return BAD_INPUT
    return DONE


def _forecast(options: argparse.Namespace, found: Inspection) -> dict[str, Any]:
    """The shear that a start would need, and a warning where the cloth locks before."""
    from meshdrape.study import forecast
    from meshdrape.weave.fabric import Fabric

    mould = found.mould
    if options.faces is not None or found.closed or mould is None:
        options.heal = False
        mould = read_mould(options)
    spacing = options.spacing or mould.surface.diagonal / SPACINGS
    fabric = Fabric(spacing, options.initial_angle, options.locking_angle)
    with compilation_told(options.json):
        told = forecast(mould, fabric, options.seed, options.direction, options.extent)
    shear, lock = math.degrees(told.max_shear), math.degrees(fabric.locking_angle)
    warnings = []
    if told.max_shear > fabric.locking_angle:
        warnings.append(
            f"this start needs about {shear:.1f} degrees of shear where the cloth locks at {lock:g}; try another seed "
            f"or direction, or a smaller --extent"
        )
    return {
        "forecast": {
            "max_shear_deg": shear,
            "max_shear_at": told.position.tolist(),
            "complete": told.complete,
            "locking_angle_deg": lock,
            "seconds": told.seconds,
        },
        "warnings": warnings,
    }


def _facts(found: Inspection) -> dict[str, Any]:
    mould = found.mould
    facts: dict[str, Any] = {
        "file": str(found.path),
        "closed_solid": found.closed,
        "faces": [
            {
                "id": face.id,
                "name": face.name,
                "kind": face.kind,
                "area_mm2": face.area,
                "centre": face.centre.tolist(),
                "normal": face.normal.tolist(),
                "neighbours": list(face.neighbours),
                "developable": face.developable,
            }
            for face in found.cad_faces
        ],
        "faults": [
            {"kind": str(fault.kind), "count": fault.count, "first_at": list(fault.place)} for fault in found.faults
        ],
        "notes": [] if mould is None else list(mould.notes),
    }
    if mould is not None:
        from meshdrape.weave.measures.noise import mesh_noise

        facts |= {
            "size_mm": mould.size.tolist(),
            "area_mm2": mould.surface.area,
            "triangles": len(mould.triangles),
            "chord_tolerance_mm": mould.chord_tolerance,
            "angle_tolerance_deg": None if mould.angle_tolerance is None else math.degrees(mould.angle_tolerance),
            "mesh_noise_deg": math.degrees(mesh_noise(mould.surface)),
        }
    return facts


def _forecast_lines(facts: dict[str, Any]) -> list[str]:
    if "forecast" not in facts:
        return []
    told = facts["forecast"]
    at = ", ".join(f"{v:.1f}" for v in told["max_shear_at"])
    least = "about" if told["complete"] else "at least about"
    lines = [
        f"  forecast    {least} {told['max_shear_deg']:.1f} deg of shear, largest near ({at}), "
        f"by the enclosed curvature ({1000 * told['seconds']:.0f} ms)"
    ]
    return lines + [f"  WARNING     {warning}" for warning in facts["warnings"]]


def _report(facts: dict[str, Any]) -> str:
    lines = [facts["file"]]
    if "size_mm" in facts:
        size = " x ".join(f"{v:,.1f}" for v in facts["size_mm"])
        lines.append(f"  size        {size} mm, area {facts['area_mm2'] / 1e6:.4g} m2")
        told = f"{facts['triangles']:,}"
        if facts["angle_tolerance_deg"] is not None:
            told += f" at {facts['angle_tolerance_deg']:g} deg and {facts['chord_tolerance_mm']:g} mm"
        lines.append(f"  triangles   {told}")
        lines.append(f"  mesh noise  {facts['mesh_noise_deg']:.3f} deg of shear")
    lines += _forecast_lines(facts)
    lines += [f"  note        {note}" for note in facts["notes"]]
    lines += [
        f"  FAULT       {fault['count']} x {fault['kind']}, first at "
        + ", ".join(f"{v:.6g}" for v in fault["first_at"])
        for fault in facts["faults"]
    ]
    if facts["faces"]:
        if facts["closed_solid"]:
            lines.append('  a closed solid: choose the faces the cloth lies on, --faces 1,2 or --faces ">Z"')
        lines.append(
            f"  {'face':>4}  {'name':12}  {'type':10}  {'area mm2':>12}  {'normal at centre':24}  "
            f"{'neighbours':14}  unrolls"
        )
        for face in facts["faces"]:
            normal = ", ".join(f"{v:.3f}" for v in face["normal"])
            beside = ",".join(map(str, face["neighbours"]))
            lines.append(
                f"  {face['id']:>4}  {face['name'] or '':12}  {face['kind']:10}  {face['area_mm2']:>12,.0f}  "
                f"({normal + ')':23}  {beside:14}  {'yes' if face['developable'] else 'no'}"
            )
    return "\n".join(lines) + "\n"
