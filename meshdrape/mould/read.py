"""read_mould(): any mould file by its suffix."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from meshdrape.errors import FileError
from meshdrape.mould.cad.reader import BREP, STEP, file_mould, script_mould
from meshdrape.mould.files import existing_file, file_sha256
from meshdrape.mould.formats.reader import read_mesh_mould
from meshdrape.mould.mould import Mould

SCRIPT = (".py",)
MESH = (".stl", ".obj", ".ply", ".off")


def read_mould(
    path: str | os.PathLike[str],
    faces: str | Sequence[int] | None = None,
    unit: str | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
    heal: bool = False,
    parameters: Mapping[str, Any] | None = None,
) -> Mould:
    """The mould in a STEP, BREP, STL, OBJ, PLY or OFF file, or one that a CadQuery script makes.

    Parameters
    ----------
    path : path
    faces : str or sequence of int, optional
        CAD faces: a CadQuery selector (``">Z"``), ids (``"1,3"`` or ``[1, 3]``), or names from the STEP file.
    unit : str, optional
        Unit of a mesh file, default mm. A CAD file states its own.
    chord_tolerance : float, mm, optional
        Default 0.1.
    angle_tolerance : float, rad, optional
        Default 0.2 degrees; see :func:`meshdrape.mould.cad.brep.cut_faces`.
    heal : bool
        Repair a mesh file; ``Mould.healing`` says what that changed.
    parameters : mapping, optional
        Of a CadQuery script.

    Raises
    ------
    FileError
        The file is missing, empty, truncated, noise, of an unknown kind, or has no faces; or an option does not go
        with its kind.
    SelectionError
        The faces asked for are not there, or a closed solid was given without a choice.
    MouldError
        The surface cannot be draped.
    """
    file = Path(path)
    suffix = file.suffix.lower()
    if suffix not in STEP + BREP + SCRIPT + MESH:
        known = " ".join(STEP + BREP + MESH + SCRIPT)
        msg = f"{file} has the suffix {suffix or '(none)'}; a mould is one of {known}"
        raise FileError(msg)
    existing_file(file)
    if suffix not in SCRIPT and parameters:
        msg = f"{file} has no parameters: --set goes with a CadQuery script (.py)"
        raise FileError(msg)
    if suffix in MESH:
        if faces is not None:
            msg = f"{file} is a mesh and has no CAD faces: --faces goes with STEP, BREP or a CadQuery script"
            raise FileError(msg)
        refuse_tolerances(file, chord_tolerance, angle_tolerance)
        return read_mesh_mould(file, unit, heal)
    if unit not in (None, "mm"):
        msg = f"{file} states its own unit and is read in mm: --unit goes with mesh files"
        raise FileError(msg)
    if heal:
        msg = f"{file} is no mesh file: --heal repairs meshes; mend a B-rep in CAD"
        raise FileError(msg)

    if suffix in SCRIPT:
        mould = script_mould(file, parameters, faces, chord_tolerance, angle_tolerance)
    else:
        mould = file_mould(file, faces, chord_tolerance, angle_tolerance)
    given = tuple((parameters or {}).items())
    return replace(mould, source=file, sha256=file_sha256(file), parameters=given)


def refuse_tolerances(file: Path, chord_tolerance: float | None, angle_tolerance: float | None) -> None:
    """Raise FileError if tolerances were given for a mesh file, which is its own tessellation."""
    for name, given in (("--chord-tolerance", chord_tolerance), ("--angle-tolerance", angle_tolerance)):
        if given is not None:
            msg = (
                f"{file} is a mesh and is draped as it is: {name} goes with STEP, BREP or a CadQuery script; "
                f"export the mesh finer"
            )
            raise FileError(msg)
