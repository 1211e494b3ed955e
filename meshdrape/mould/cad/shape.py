"""A STEP or BREP file as a B-rep shape with named faces."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshdrape.errors import FileError, missing_library
from meshdrape.mould.cad.quiet import quiet, uninterrupted


@dataclass(frozen=True, eq=False)
class NamedShape:
    """A B-rep, in mm, and its faces in the order of the file.

    Attributes
    ----------
    shape : cadquery.Shape
    faces : tuple of cadquery.Face
    names : tuple of str or None
        Of each face.
    """

    shape: Any
    faces: tuple[Any, ...]
    names: tuple[str | None, ...]


def cadquery_module() -> Any:
    """The cadquery package; MissingLibraryError if the system lacks a library it needs."""
    try:
        with quiet(), uninterrupted():
            import cadquery
    except ImportError as error:
        raise missing_library(error) from error
    return cadquery


def read_step(path: Path) -> NamedShape:
    """The shape in a STEP file; lengths are converted to mm from the file's own unit.

    Raises
    ------
    FileError
        If it is no STEP file or holds no faces.
    """
    cq = cadquery_module()
    from OCP.IFSelect import IFSelect_ReturnStatus
    from OCP.STEPControl import STEPControl_Reader

    shape = None
    with quiet():
        reader = STEPControl_Reader()
        try:
            if reader.ReadFile(str(path)) == IFSelect_ReturnStatus.IFSelect_RetDone:
                reader.TransferRoots()
                shape = reader.OneShape()
        except Exception as error:  # whatever Open CASCADE throws at noise, the file is at fault
            msg = f"{path} cannot be read as STEP ({type(error).__name__}); export it anew"
            raise FileError(msg) from error
    if shape is None:
        msg = f"{path} is not a STEP file, or is cut short; export it anew"
        raise FileError(msg)
    if shape.IsNull():
        msg = f"{path} holds no shape; export the part itself"
        raise FileError(msg)
    faces = _faces(cq.Shape.cast(shape), path)
    transferred = reader.WS().TransferReader()
    return NamedShape(cq.Shape.cast(shape), faces, tuple(_step_name(transferred, face.wrapped) for face in faces))


def read_brep(path: Path) -> NamedShape:
    """The shape in an Open CASCADE BREP file, mm.

    Raises
    ------
    FileError
        If it is no BREP file or holds no faces.
    """
    cq = cadquery_module()
    content = path.read_bytes()
    if b"CASCADE Topology" not in content[:200]:
        msg = f"{path} is not a BREP file of Open CASCADE; export it anew, or as STEP"
        raise FileError(msg)
    if not _is_whole(content):
        msg = f"{path} is cut short; export it anew"
        raise FileError(msg)
    try:
        with quiet():
            whole = cq.Shape.importBrep(str(path))
    except Exception as error:
        msg = f"{path} cannot be read as BREP ({type(error).__name__}); export it anew"
        raise FileError(msg) from error
    return of_shape(whole, path)


def _is_whole(brep: bytes) -> bool:
    """Whether a BREP file goes on to its end; Open CASCADE crashes on one that does not.

    The last section counts its shapes, each of which ends in a star, and then names the one that is all of it by
    two numbers.
    """
    words = brep.partition(b"\nTShapes ")[2].split()
    return len(words) > 3 and words[0] == b"%d" % words.count(b"*") and words[-3] == b"*"


def of_shape(whole: Any, origin: Path) -> NamedShape:
    """A shape at hand, its faces without names.

    Raises
    ------
    FileError
        If it has no faces.
    """
    faces = _faces(whole, origin)
    return NamedShape(whole, faces, (None,) * len(faces))


def _faces(whole: Any, path: Path) -> tuple[Any, ...]:
    faces = tuple(whole.Faces()) if whole is not None and whole.wrapped is not None else ()
    if not faces:
        msg = f"{path} has no faces, only curves or points; export surfaces or a solid"
        raise FileError(msg)
    return faces


def _step_name(transferred: Any, face: Any) -> str | None:
    """The name a STEP file gives a face, if it gives one."""
    item = transferred.EntityFromShapeResult(face, 1)
    name = item.Name() if item is not None and hasattr(item, "Name") else None
    return (name.ToCString().strip() or None) if name is not None else None
