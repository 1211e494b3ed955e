"""Write every sample mould into ``samples/`` as STEP and STL, with a table of their exact facts.

Run it after changing a script of this folder::

    python cad/make_samples.py

The files depend on the scripts alone: the STEP header carries no time of writing, so a second run gives the same bytes.
"""

from __future__ import annotations

import argparse
import importlib
import re
import sys
from dataclasses import dataclass, field
from math import radians
from pathlib import Path
from typing import Any

import cadquery as cq
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.XCAFDoc import XCAFDoc_DocumentTool

HERE = Path(__file__).resolve().parent


@dataclass(frozen=True)
class Sample:
    """One mould to write: a script of this folder with parameters of its own."""

    name: str
    script: str
    parameters: dict[str, Any] = field(default_factory=dict)
    chord_tolerance: float = 0.0  # of the STL, mm; 0 = STEP only
    angle_tolerance_deg: float = 0.0  # of the STL

    def build(self) -> cq.Workplane:
        """The shape, its faces tagged by name where the script names them."""
        return self.module.build(**self.parameters)

    @property
    def module(self) -> Any:
        """The script, imported."""
        if str(HERE) not in sys.path:
            sys.path.insert(0, str(HERE))
        return importlib.import_module(self.script)


SAMPLES = (
    Sample("wing_spar", "wing_spar", chord_tolerance=0.1, angle_tolerance_deg=0.5),
    Sample("wing_spar_block", "wing_spar", {"block": True}),
    Sample("hemisphere", "hemisphere", chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cone", "cone", chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cylinder", "cylinder", chord_tolerance=0.1, angle_tolerance_deg=0.5),
    Sample("hypar", "hypar", chord_tolerance=0.5, angle_tolerance_deg=3.0),
    Sample("cube_corner", "cube_corner", chord_tolerance=0.1, angle_tolerance_deg=1.0),
    Sample("krogh_double_curved", "krogh_double_curved", chord_tolerance=0.05, angle_tolerance_deg=2.0),
)


def main(arguments: list[str] | None = None) -> None:
    """Write all files; the command line takes another folder."""
    parser = argparse.ArgumentParser(description="Write the sample moulds as STEP and STL.")
    parser.add_argument("--folder", type=Path, default=HERE.parent / "samples", help="where to write")
    folder: Path = parser.parse_args(arguments).folder
    folder.mkdir(parents=True, exist_ok=True)
    shapes = {}
    for sample in SAMPLES:
        shape = shapes[sample.name] = sample.build()
        write_step(shape, sample.name, folder / f"{sample.name}.step")
        if sample.chord_tolerance:
            write_stl(shape, sample, folder / f"{sample.name}.stl")
    (folder / "README.md").write_text(readme(shapes, folder), encoding="utf-8")
    print(f"{len(SAMPLES)} moulds written to {folder}")


def write_step(shape: cq.Workplane, name: str, path: Path) -> None:
    """Write the shape as one STEP part of that name, its tagged faces under the names of their tags, in mm."""
    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    part = tool.AddShape(shape.val().wrapped, False)
    TDataStd_Name.Set_s(part, TCollection_ExtendedString(name))
    for tag, tagged in shape.ctx.tags.items():
        label = tool.AddSubShape(part, tagged.val().wrapped)
        TDataStd_Name.Set_s(label, TCollection_ExtendedString(tag))

    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
    Interface_Static.SetCVal_s("write.step.unit", "MM")
    writer.Transfer(document)
    header = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    header.SetName(TCollection_HAsciiString(path.name))
    header.SetTimeStamp(TCollection_HAsciiString("2000-01-01T00:00:00"))
    writer.Write(str(path))


def write_stl(shape: cq.Workplane, sample: Sample, path: Path) -> None:
    """Write the shape's triangles as binary STL."""
    shape.val().exportStl(
        str(path), tolerance=sample.chord_tolerance, angularTolerance=radians(sample.angle_tolerance_deg)
    )


def facts(docstring: str) -> dict[str, str]:
    """Field list of a script's docstring: area, Gaussian curvature, flat length, shear, source."""
    return {
        name: " ".join(text.split())
        for name, text in re.findall(r"^:([A-Z][^:]*):((?:.*\n)(?:    .*\n)*)", docstring, re.MULTILINE)
    }


def readme(shapes: dict[str, cq.Workplane], folder: Path) -> str:
    """Text of the table beside the samples."""
    lines = [
        "# Sample moulds",
        "",
        "Written by `python cad/make_samples.py`; change the scripts in `cad/`, not the files here. Millimetres",
        "throughout. Each is the open tool surface, drapable as it is, its normals on the cloth's side; only",
        "`wing_spar_block.step` is a solid, to choose faces from.",
        "",
        "## Exact facts",
        "",
        "| mould | area | Gaussian curvature | flat length | shear | source |",
        "|---|---|---|---|---|---|",
    ]
    scripts = {sample.script: sample for sample in SAMPLES}
    for script, sample in scripts.items():
        known = facts(sample.module.__doc__)
        fields = ("Area", "Gaussian curvature", "Flat length", "Shear", "Source")
        lines.append(f"| [{script}](../cad/{script}.py) | " + " | ".join(known[field] for field in fields) + " |")
    lines += [
        "",
        "## Files",
        "",
        "STEP faces carry the names given here; ids count the faces in the order of the file, from 1.",
        "",
        "| STEP | CAD faces: id, name, kind, area in mm² | STL | chord, angle tolerance | triangles |",
        "|---|---|---|---|---|",
    ]
    for sample in SAMPLES:
        shape = shapes[sample.name]
        name_of = {tagged.val(): tag for tag, tagged in shape.ctx.tags.items()}
        faces = "; ".join(
            " ".join([str(id_), *([name_of[face]] if face in name_of else []), face.geomType().lower(), f"{face.Area():.1f}"])
            for id_, face in enumerate(shape.val().Faces(), start=1)
        )
        row = [f"{sample.name}.step", faces, "-", "-", "-"]
        if sample.chord_tolerance:
            stl = folder / f"{sample.name}.stl"
            row[2:] = [
                stl.name,
                f"{sample.chord_tolerance:g} mm, {sample.angle_tolerance_deg:g}°",
                str(int.from_bytes(stl.read_bytes()[80:84], "little")),
            ]
        lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
