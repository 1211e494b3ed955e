"""What a mould file holds, whether or not it can be draped."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meshdrape.errors import MouldError, SelectionError
from meshdrape.mould.files import existing_file
from meshdrape.mould.formats.reader import read_mesh
from meshdrape.mould.mesh.check import Fault, as_arrays, examine
from meshdrape.mould.mould import CadFace, Mould
from meshdrape.mould.read import MESH, read_mould, refuse_tolerances
from meshdrape.mould.units import millimetres


@dataclass(frozen=True, eq=False)
class Inspection:
    """What :func:`inspect_mould` found.

    Attributes
    ----------
    path : Path
    mould : Mould or None
        The mould as it would be draped: all faces of a B-rep, closed or not; None for a mesh with faults.
    cad_faces : tuple of CadFace
        Every face of a B-rep; none for a mesh.
    closed : bool
        Whether the file holds a closed solid, of which faces have to be chosen.
    faults : tuple of Fault
        What keeps a mesh from being draped.
    """

    path: Path
    mould: Mould | None
    cad_faces: tuple[CadFace, ...]
    closed: bool
    faults: tuple[Fault, ...]


def inspect_mould(
    path: str | os.PathLike[str],
    unit: str | None = None,
    parameters: Mapping[str, Any] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> Inspection:
    """Look into a mould file: its faces, its mesh and what is wrong with that.

    Parameters
    ----------
    path, unit, parameters, chord_tolerance, angle_tolerance
        As for :func:`meshdrape.read_mould`.

    Raises
    ------
    FileError
        As for :func:`meshdrape.read_mould`.
    MouldError
        A mesh has a coordinate that is not finite, or the unit is unknown.
    """
    file = Path(path)
    if file.suffix.lower() in MESH:
        refuse_tolerances(file, chord_tolerance, angle_tolerance)
        factor = millimetres(unit or "mm")
        mesh = read_mesh(existing_file(file))
        try:
            vertices, triangles = as_arrays(mesh.vertices, mesh.triangles, factor)
        except MouldError as error:
            msg = f"{file}: {error}"
            raise MouldError(msg) from error
        report = examine(vertices, triangles)
        mould = None if report.faults else read_mould(file, unit=unit)
        return Inspection(file, mould, (), False, report.faults)
    closed = False
    try:
        mould = read_mould(file, None, unit, chord_tolerance, angle_tolerance, parameters=parameters)
    except SelectionError as error:
        closed = True
        everything = [face.id for face in error.faces if isinstance(face, CadFace)]
        mould = read_mould(file, everything, None, chord_tolerance, angle_tolerance, parameters=parameters)
    return Inspection(file, mould, mould.cad_faces, closed, ())
