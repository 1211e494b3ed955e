"""A B-rep as the bytes of a file: STEP and BREP as it is, STL by our own tessellation."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from meshdrape.errors import FileError, MouldError
from meshdrape.mould.cad import library
from meshdrape.mould.cad.brep import brep_mould, cad_faces
from meshdrape.mould.cad.quiet import quiet
from meshdrape.mould.cad.reader import with_script
from meshdrape.mould.cad.shape import NamedShape
from meshdrape.mould.mould import CadFace, Mould

SUFFIXES: Final = (".step", ".stp", ".brep", ".brp", ".stl")
_FACET: Final = np.dtype([("normal", "<f4", (3,)), ("corner", "<f4", (3, 3)), ("attribute", "<u2")])


@dataclass(frozen=True, eq=False)
class Made:
    """A mould by one of the scripts that come with meshdrape, ready to be written.

    Attributes
    ----------
    content : bytes
        Of its file.
    size : (x, y, z), mm
    cad_faces : tuple of CadFace
    n_triangles : int or None
        Of an STL file.
    """

    content: bytes
    size: tuple[float, float, float]
    cad_faces: tuple[CadFace, ...]
    n_triangles: int | None


def make(
    name: str,
    parameters: Mapping[str, Any],
    suffix: str,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> Made:
    """The file of a mould, of one of ``SUFFIXES``, in a process of its own.

    Raises
    ------
    FileError
        See :func:`meshdrape.mould.cad.library.build_shape`; or the shape cannot be written.
    MouldError
        It cannot be cut into triangles, or a tolerance is out of range.
    """
    called = f"mould {name}"

    def work(shape: NamedShape) -> Made:
        n_triangles = None
        if suffix == ".stl":
            try:
                mould = tessellated(shape, called, chord_tolerance, angle_tolerance)
            except MouldError as error:
                msg = f"{called}: {error}"
                raise MouldError(msg) from error
            content, n_triangles = stl_bytes(mould, name), len(mould.triangles)
        else:
            content = brep_bytes(shape) if suffix in (".brep", ".brp") else step_bytes(shape, name)
        return Made(content, extents(shape), cad_faces(shape), n_triangles)

    return with_script(library.script(name).path, library.checked_parameters(name, parameters), called, work)


def tessellated(
    shape: NamedShape, origin: str, chord_tolerance: float | None = None, angle_tolerance: float | None = None
) -> Mould:
    """The mould of every face of a shape, of a closed solid too."""
    everything = list(range(1, len(shape.faces) + 1))
    return brep_mould(shape, origin, everything, chord_tolerance, angle_tolerance)


def step_bytes(shape: NamedShape, name: str) -> bytes:
    """A STEP file in mm with one part of that name; named faces keep their names.

    Raises
    ------
    FileError
        Open CASCADE cannot write the shape.
    """
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Writer
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("XmlXCAF"))
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    part = tool.AddShape(shape.shape.wrapped, False)
    TDataStd_Name.Set_s(part, TCollection_ExtendedString(name))
    for face, face_name in zip(shape.faces, shape.names, strict=True):
        if face_name is not None:
            TDataStd_Name.Set_s(tool.AddSubShape(part, face.wrapped), TCollection_ExtendedString(face_name))
    content = io.BytesIO()
    with quiet():
        writer = STEPCAFControl_Writer()
        writer.SetNameMode(True)
        Interface_Static.SetIVal_s("write.stepcaf.subshapes.name", 1)
        Interface_Static.SetCVal_s("write.step.unit", "MM")
        writer.Transfer(document)
        written = writer.WriteStream(content) == IFSelect_ReturnStatus.IFSelect_RetDone
    if not written:
        msg = f"{name} cannot be written as STEP; try .brep"
        raise FileError(msg)
    return content.getvalue()


def brep_bytes(shape: NamedShape) -> bytes:
    """A BREP file of Open CASCADE, which knows no names."""
    content = io.BytesIO()
    shape.shape.exportBrep(content)
    return content.getvalue()


def stl_bytes(mould: Mould, name: str) -> bytes:
    """A binary STL file, in single precision; common vertices stay common to the last bit."""
    facets = np.zeros(len(mould.triangles), dtype=_FACET)
    facets["corner"] = mould.vertices[mould.triangles]
    a, b, c = np.moveaxis(mould.vertices[mould.triangles], 1, 0)
    normal = np.cross(b - a, c - a)
    facets["normal"] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    head = f"meshdrape mould {name}, mm".encode("ascii", "replace")[:80].ljust(80)
    return head + len(facets).to_bytes(4, "little") + facets.tobytes()


def extents(shape: NamedShape) -> tuple[float, float, float]:
    """Sides of the bounding box, mm."""
    box = shape.shape.BoundingBox()
    return float(box.xlen), float(box.ylen), float(box.zlen)
