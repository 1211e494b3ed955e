"""Mesh files read, welded, checked and, on request, healed: STL, OBJ, PLY and OFF."""

from __future__ import annotations

import codecs
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import FileError, MouldError
from meshdrape.mould.files import brief, existing_file, file_sha256
from meshdrape.mould.formats.obj import read_obj
from meshdrape.mould.formats.off import read_off
from meshdrape.mould.formats.ply import read_ply
from meshdrape.mould.formats.polygons import Polygons
from meshdrape.mould.formats.stl import read_stl
from meshdrape.mould.formats.weld import welded, welded_along_borders
from meshdrape.mould.mesh.check import counted
from meshdrape.mould.mould import Mould
from meshdrape.mould.units import millimetres

if TYPE_CHECKING:
    from meshdrape.mould.mesh.heal import HealReport

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_READERS: Final[dict[str, Callable[[bytes], Polygons]]] = {
    ".stl": read_stl,
    ".obj": read_obj,
    ".ply": read_ply,
    ".off": read_off,
}
MESH_SUFFIXES: Final = tuple(_READERS)


@dataclass(frozen=True, eq=False)
class MeshFile:
    """The triangles of a mesh file, welded, unchecked.

    Attributes
    ----------
    vertices : (n, 3) float64
        In the unit of the file, which does not say what it is.
    triangles : (m, 3) int64
    notes : tuple of str
        What reading changed, one line each.
    """

    vertices: Floats
    triangles: Ints
    notes: tuple[str, ...]


def read_mesh(path: str | os.PathLike[str]) -> MeshFile:
    """Return the triangles of an STL, OBJ, PLY or OFF file.

    Vertices of equal coordinates are made one; in an STL file, which has no common vertices, also corners on
    an open edge that differ by round-off of single precision. Polygons are cut into triangles.

    Raises
    ------
    FileError
        The file is missing, empty, truncated, of another suffix or not what its suffix says.
    MouldError
        It has no triangles, or a face uses a vertex that is not there.
    """
    file = existing_file(path)
    suffix = file.suffix.lower()
    if suffix not in _READERS:
        msg = f"{file} is no mesh file; its suffix must be one of {' '.join(MESH_SUFFIXES)}"
        raise FileError(msg)
    polygons = _polygons(file, _READERS[suffix])
    outside = (polygons.corner < 0) | (polygons.corner >= len(polygons.vertices))
    if outside.any():
        corner = int(np.argmax(outside))
        face = int(np.searchsorted(np.cumsum(polygons.size), corner, side="right"))
        # OBJ counts from 1, and so do the people who look into one
        start = 1 if suffix == ".obj" else 0
        msg = (
            f"{file}: face {face + start} uses vertex {polygons.corner[corner] + start} but there are "
            f"{len(polygons.vertices)} vertices; indices start at {start}"
        )
        raise MouldError(msg)
    raw = polygons.triangles()
    if not len(raw):
        msg = f"{file} has no triangles; a mould needs at least one"
        raise MouldError(msg)
    notes = []
    vertices, triangles = welded(polygons.vertices, raw)
    if suffix == ".stl":
        loose = len(vertices)
        vertices, triangles = welded_along_borders(vertices, triangles)
        if loose > len(vertices):
            notes.append(f"{counted(loose - len(vertices), 'vertex')} apart by round-off of the file welded")
    elif len(vertices) < len(polygons.vertices):
        n_welded = len(polygons.vertices) - len(vertices)
        notes.append(f"{counted(n_welded, 'vertex')} with the coordinates of another welded to it")
    for number, kind, done in (
        (np.count_nonzero(polygons.size > 3), "polygon", "cut into triangles"),
        (np.count_nonzero(polygons.size < 3), "face", "of fewer than three corners left out"),
    ):
        if number:
            notes.append(f"{counted(int(number), kind)} {done}")
    return MeshFile(vertices, triangles, tuple(notes))


def read_mesh_mould(path: str | os.PathLike[str], unit: str | None = None, heal: bool = False) -> Mould:
    """Return the mould in a mesh file.

    Parameters
    ----------
    path : path
    unit : str, optional
        What its numbers are, for a mesh file does not say: mm unless told otherwise.
    heal : bool
        Whether to repair what keeps it from being draped; ``Mould.healing`` says what that changed.

    Raises
    ------
    FileError
        See :func:`read_mesh`.
    MouldError
        The mesh cannot be draped.
    MissingLibraryError
        Healing needs a library of the system that is not there.
    """
    mesh = read_mesh(path)
    vertices, triangles = mesh.vertices, mesh.triangles
    healing: HealReport | None = None
    try:
        if heal:
            from meshdrape.mould.mesh.heal import heal_apart

            factor = millimetres(unit or "mm")
            vertices, triangles, healing = heal_apart(factor * vertices, triangles)
            mould = replace(Mould.from_arrays(vertices, triangles), unit=unit or "mm")
        else:
            mould = Mould.from_arrays(vertices, triangles, unit or "mm")
    except MouldError as error:
        msg = f"{path}: {error}"
        raise MouldError(msg) from error
    return replace(mould, source=Path(path), sha256=file_sha256(path), notes=mesh.notes + mould.notes, healing=healing)


def _polygons(file: Path, read: Callable[[bytes], Polygons]) -> Polygons:
    kind = file.suffix[1:].upper()
    try:
        return read(_without_mark(file.read_bytes()))
    except OSError as error:
        msg = f"{file} cannot be read: {error.strerror}"
        raise FileError(msg) from error
    except (ValueError, OverflowError) as error:
        msg = f"{file} is not a whole {kind} file ({brief(error)}); export it anew"
        raise FileError(msg) from error


def _without_mark(content: bytes) -> bytes:
    """The content without the byte order mark that some editors put before text; ValueError for text of UTF-16."""
    # the header of a binary STL file may begin with anything, but holds no text of two bytes a letter
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) and content[2:80].count(0) > 30:
        msg = "it is text in UTF-16; save it in UTF-8 or ASCII"
        raise ValueError(msg)
    return content.removeprefix(codecs.BOM_UTF8)
