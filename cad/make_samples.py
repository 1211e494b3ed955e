"""Write every sample mould into ``samples/`` as STEP and STL, with a table of their exact facts.

Run it after changing a script of this folder::

    python cad/make_samples.py

The STEP headers carry no time of writing: with the same scripts and the same Open CASCADE a second run gives
the same bytes.
"""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass, field
from math import radians
from pathlib import Path
from types import ModuleType
from typing import Any

import blade_root
import c_spar
import cadquery as cq
import cone
import cube_corner
import cylinder
import double_dome
import hat
import hemisphere
import hypar
import joggle
import krogh_double_curved
import l_corner
import leading_edge
import pyramid
import saddle
import wing_spar
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool


@dataclass(frozen=True)
class Sample:
    """One mould to write: a script of this folder with parameters of its own."""

    name: str
    script: ModuleType
    parameters: dict[str, Any] = field(default_factory=dict)
    chord_tolerance: float = 0.0  # of the STL, mm; 0 = STEP only
    angle_tolerance_deg: float = 0.0  # of the STL


SAMPLES = (
    Sample("wing_spar", wing_spar, chord_tolerance=0.1, angle_tolerance_deg=0.5),
    Sample("wing_spar_block", wing_spar, {"block": True}),
    Sample("hemisphere", hemisphere, chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cone", cone, chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cylinder", cylinder, chord_tolerance=0.1, angle_tolerance_deg=0.5),
    Sample("hypar", hypar, chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cube_corner", cube_corner, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("krogh_double_curved", krogh_double_curved, chord_tolerance=0.1, angle_tolerance_deg=5.0),
    Sample("hat", hat),
    Sample("double_dome", double_dome, chord_tolerance=0.5, angle_tolerance_deg=9.0),
    Sample("saddle", saddle, chord_tolerance=2.0, angle_tolerance_deg=6.0),
    Sample("pyramid", pyramid, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("joggle", joggle, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("l_corner", l_corner, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("c_spar", c_spar, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("leading_edge", leading_edge, chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("blade_root", blade_root, chord_tolerance=2.0, angle_tolerance_deg=5.0),
)
FACTS = ("Area", "Gaussian curvature", "Flat length", "Shear", "Source")  # fields of each script's docstring


def main(arguments: list[str] | None = None) -> None:
    """Write all files; the command line takes another folder."""
    parser = argparse.ArgumentParser(description="Write the sample moulds as STEP and STL.")
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path(__file__).resolve().parent.parent / "samples",
        help="where to write",
    )
    folder: Path = parser.parse_args(arguments).folder
    folder.mkdir(parents=True, exist_ok=True)
    shapes = {}
    for sample in SAMPLES:
        shape = shapes[sample.name] = sample.script.build(**sample.parameters)
        write_step(shape, sample.name, folder / f"{sample.name}.step")
        if sample.chord_tolerance:
            write_stl(shape, sample, folder / f"{sample.name}.stl")
    (folder / "README.md").write_text(readme(shapes, folder), encoding="utf-8")
    print(f"{len(SAMPLES)} moulds written to {folder}")


def write_step(shape: cq.Workplane, name: str, path: Path) -> None:
    """Write the shape as one STEP part of that name, its tagged faces under their tags, in mm."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    part = tool.AddShape(shape.val().wrapped, False)
    TDataStd_Name.Set_s(part, TCollection_ExtendedString(name))
    for tag, tagged in shape.ctx.tags.items():
        for face in tagged.vals():
            TDataStd_Name.Set_s(tool.AddSubShape(part, face.wrapped), TCollection_ExtendedString(tag))

    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    writer.Transfer(document)
    header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    header.SetName(TCollection_HAsciiString(path.name))
    header.SetTimeStamp(TCollection_HAsciiString("2000-01-01T00:00:00"))
    if writer.Write(str(path)) != IFSelect_ReturnStatus.IFSelect_RetDone:
        msg = f"{path} cannot be written"
        raise OSError(msg)


def write_stl(shape: cq.Workplane, sample: Sample, path: Path) -> None:
    """Write the shape's triangles as binary STL; the chord tolerance is absolute, in mm."""
    shape.val().exportStl(
        str(path),
        tolerance=sample.chord_tolerance,
        angularTolerance=radians(sample.angle_tolerance_deg),
        relative=False,
        parallel=False,
    )


def facts(docstring: str) -> dict[str, str]:
    """Field list of a script's docstring: area, Gaussian curvature, flat length, shear, source."""
    return {
        name: " ".join(text.split())
        for name, text in re.findall(r"^:([A-Z][^:]*):((?:.*\n)(?:    .*\n)*)", docstring, re.MULTILINE)
    }


def readme(shapes: dict[str, cq.Workplane], folder: Path) -> str:
    """Text of the tables beside the samples."""
    lines = [
        "# Sample moulds",
        "",
        "Written by `python cad/make_samples.py`: change the scripts in `cad/`, not the files here.",
        "Millimetres throughout. Each is the open tool surface, drapable as it is, its normals on the",
        "cloth's side; only `wing_spar_block.step` is a solid, to choose faces from.",
        "",
        "By hand: `designs/`, wings and spars for `meshdrape fold`; `fibres/`, a start fibre drawn on a mould.",
        "",
        "## Exact facts",
        "",
        "Of the shapes as designed; a tessellation comes as near as its tolerances allow.",
        "",
        f"| Mould | {' | '.join(FACTS)} |",
        "|---|" + "---|" * len(FACTS),
    ]
    for script in dict.fromkeys(sample.script for sample in SAMPLES):
        known = facts(script.__doc__ or "")
        cells = [f"[{script.__name__}](../cad/{script.__name__}.py)", *(known[name] for name in FACTS)]
        lines.append(f"| {' | '.join(cells)} |")
    lines += [
        "",
        "## Files",
        "",
        "Ids count the faces in the order of the STEP file, from 1; named faces have their name there.",
        "The areas are those Open CASCADE integrates over the faces. STL files are binary, in single",
        "precision.",
        "",
        "| STEP | CAD faces: id, name, kind, area in mm² | STL | Chord, angle tolerance | Triangles |",
        "|---|---|---|---|---|",
    ]
    for sample in SAMPLES:
        step = folder / f"{sample.name}.step"
        cells = [step.name, face_list(step, shapes[sample.name]), "", "", ""]
        if sample.chord_tolerance:
            stl = folder / f"{sample.name}.stl"
            triangles = int.from_bytes(stl.read_bytes()[80:84], "little")
            tolerances = f"{sample.chord_tolerance:g} mm, {sample.angle_tolerance_deg:g}°"
            cells[2:] = [stl.name, tolerances, str(triangles)]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def face_list(step: Path, shape: cq.Workplane) -> str:
    """Faces of a STEP file, read back: id, name where the shape written has a tag, kind, area."""
    tags = {face: f" {name}" for name, tagged in shape.ctx.tags.items() for face in tagged.vals()}
    names = [tags.get(face, "") for face in shape.val().Faces()]
    found = cq.importers.importStep(str(step)).faces().vals()
    return "; ".join(
        f"{id_}{name} {face.geomType()} {face.Area():.1f}"
        for id_, (name, face) in enumerate(zip(names, found, strict=True), start=1)
    )


if __name__ == "__main__":
    main()
