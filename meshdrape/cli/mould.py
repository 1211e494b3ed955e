"""meshdrape mould NAME -o FILE: a mould from one of the scripts that come with the package."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meshdrape.cli.main import DONE
from meshdrape.cli.options import add_parameters, add_tolerances, parameters_set
from meshdrape.errors import FileError

if TYPE_CHECKING:
    from meshdrape.mould.cad.library import Script


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("name", nargs="?", metavar="NAME", help="which mould; left out: list them")
    parser.add_argument("-o", "--output", metavar="FILE", help="what to write: .step, .stp, .brep, .brp or .stl")
    group = parser.add_argument_group("the mould")
    add_parameters(group)
    add_tolerances(group)
    told = parser.add_argument_group("what there is")
    told.add_argument("--list", action="store_true", help="list the moulds")
    told.add_argument("--parameters", action="store_true", help="list the parameters of the mould NAME")
    parser.add_argument("--json", action="store_true", help="print as JSON")


def run(options: argparse.Namespace, arguments: list[str]) -> int:
    """List the moulds, or the parameters of one, or make one and write it."""
    del arguments
    from meshdrape.mould.cad import library

    if options.list or options.name is None:
        if options.output or options.set or options.parameters:
            msg = f"which mould? give one of {', '.join(library.scripts())}"
            raise FileError(msg)
        moulds = {name: script.summary for name, script in library.scripts().items()}
        _say(options, moulds, _columns(moulds))
        return DONE
    script = library.script(options.name)
    if options.parameters:
        listed = [
            {"name": parameter.name, "default": parameter.default, "meaning": parameter.meaning}
            for parameter in script.parameters
        ]
        rows = {f"{one['name']}={one['default']}": one["meaning"] for one in listed}
        told = {"mould": script.name, "summary": script.summary, "parameters": listed}
        _say(options, told, [script.summary, *_columns(rows)])
        return DONE
    if options.output is None:
        msg = f"where to? give -o {script.name}.step (or .brep, .stl), or --parameters to list what can be set"
        raise FileError(msg)
    facts = _make(script, options)
    _say(options, facts, _report(facts))
    return DONE


def _make(script: Script, options: argparse.Namespace) -> dict[str, Any]:
    """Make the mould, write it, and return what there is to say of it."""
    from meshdrape.mould.cad import export
    from meshdrape.output.files import atomic_write, check_suffix, check_target

    target = Path(options.output)
    suffix = target.suffix.lower()
    check_suffix(target, export.SUFFIXES, "a mould")
    check_target(target)
    parameters = parameters_set(options)
    made = export.make(script.name, parameters, suffix, options.chord_tolerance, options.angle_tolerance)
    with atomic_write(target) as file:
        file.write(made.content)
    return {
        "mould": script.name,
        "file": str(target),
        "parameters": {one.name: one.value(parameters.get(one.name, one.default)) for one in script.parameters},
        "size_mm": list(made.size),
        "area_mm2": sum(face.area for face in made.cad_faces),
        "triangles": made.n_triangles,
        "faces": [
            {
                "id": face.id,
                "name": face.name,
                "kind": face.kind,
                "area_mm2": face.area,
                "developable": face.developable,
            }
            for face in made.cad_faces
        ],
    }


def _report(facts: dict[str, Any]) -> list[str]:
    size = " x ".join(f"{v:,.1f}" for v in facts["size_mm"])
    lines = [f"{facts['mould']}: {size} mm, area {facts['area_mm2'] / 1e6:.4g} m2"]
    if facts["triangles"] is not None:
        lines[0] += f", {facts['triangles']:,} triangles"
    lines += [
        f"  face {face['id']:>2}  {face['name'] or '':12}  {face['kind']:10}  {face['area_mm2']:>14,.1f} mm2  "
        f"{'unrolls' if face['developable'] else 'does not unroll'}"
        for face in facts["faces"]
    ]
    return [*lines, f"  wrote    {facts['file']}"]


def _columns(rows: dict[str, str]) -> list[str]:
    width = max(map(len, rows), default=0)
    return [f"  {name:{width}}  {text}" for name, text in rows.items()]


def _say(options: argparse.Namespace, facts: dict[str, Any], lines: list[str]) -> None:
    if options.json:
        from meshdrape.output import json_text

        sys.stdout.write(json_text(facts))
    else:
        sys.stdout.write("\n".join(lines) + "\n")
