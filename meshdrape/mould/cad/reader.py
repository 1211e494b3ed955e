"""CAD files and scripts read, and their faces cut into triangles, where Open CASCADE can do no harm."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Final, TypeVar

import numpy as np

from meshdrape.errors import FileError, MouldError
from meshdrape.mould.apart import DiedError, allow, apart
from meshdrape.mould.cad.brep import CutFaces, cut_faces
from meshdrape.mould.cad.quiet import quiet
from meshdrape.mould.cad.script import run_script
from meshdrape.mould.cad.shape import NamedShape, cadquery_module, read_brep, read_step
from meshdrape.mould.files import brief
from meshdrape.mould.mould import Mould

T = TypeVar("T")

STEP, BREP = (".step", ".stp"), (".brep", ".brp")
GIB: Final = 2**30
# A file that takes longer than this to read, and so much longer a byte, is taken to hang; memory in bytes likewise.
SECONDS_TO_READ, SECONDS_A_BYTE = 8.0, 1e-5
MEMORY_TO_READ, MEMORY_A_BYTE = GIB, 1000
# A script may compute for so long, a face or a round of refinement for so long: far longer than they take.
SECONDS_TO_BUILD: Final = 600.0
SECONDS_A_STEP: Final = 15.0
# Two million triangles, the most there may be, take three gigabytes.
MEMORY: Final = 8 * GIB


def file_mould(
    file: Path,
    faces: str | Sequence[int] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> Mould:
    """The mould in a STEP or BREP file.

    Raises
    ------
    FileError, SelectionError, MouldError
        See :func:`meshdrape.read_mould`.
    """
    _import_for_both()
    read = read_step if file.suffix.lower() in STEP else read_brep

    def work() -> CutFaces:
        return _cut(read(file), str(file), faces, chord_tolerance, angle_tolerance)

    size = file.stat().st_size
    try:
        cut = apart(work, SECONDS_TO_READ + SECONDS_A_BYTE * size, MEMORY_TO_READ + MEMORY_A_BYTE * size)
    except DiedError as died:
        msg = f"{file} is damaged: Open CASCADE {died.how} on it; export it anew"
        raise FileError(msg) from None
    return _mould(cut, str(file))


def script_mould(
    path: Path,
    parameters: Mapping[str, Any] | None = None,
    faces: str | Sequence[int] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
    origin: str | None = None,
) -> Mould:
    """The mould that a CadQuery script makes.

    Parameters
    ----------
    path, parameters, origin
        See :func:`~meshdrape.mould.cad.script.run_script`.

    Raises
    ------
    FileError, SelectionError, MouldError
        See :func:`meshdrape.read_mould`.
    """
    called = origin or str(path)
    _import_for_both()

    def work(shape: NamedShape) -> CutFaces:
        return _cut(shape, called, faces, chord_tolerance, angle_tolerance)

    return _mould(with_script(path, parameters, origin, work), called)


def with_script(
    path: Path, parameters: Mapping[str, Any] | None, origin: str | None, work: Callable[[NamedShape], T]
) -> T:
    """What a function makes of the shape that a CadQuery script shows: something that can be pickled.

    Raises
    ------
    FileError
        The script fails, crashes, or does not come to an end.
    """
    cadquery_module()

    def run() -> T:
        shape = run_script(path, parameters, origin)
        allow(SECONDS_A_STEP, MEMORY)
        return work(shape)

    try:
        return apart(run, SECONDS_TO_BUILD, MEMORY)
    except DiedError as died:
        if died.how == "hangs":
            msg = f"{origin or path} does not come to an end in {SECONDS_TO_BUILD / 60:g} minutes; simplify it"
        else:
            msg = (
                f"{origin or path} brings Python or Open CASCADE down: its shape cannot be made, or an expression is "
                f"nested too deeply; change it"
            )
        raise FileError(msg) from None


def _import_for_both() -> None:
    """Import what cuts the faces in a process of its own and makes a mould of them in this one: once for both."""
    cadquery_module()
    import scipy.sparse.csgraph  # noqa: F401 - takes as long as all else that is done there for a small file


def _cut(
    shape: NamedShape,
    origin: str,
    faces: str | Sequence[int] | None,
    chord_tolerance: float | None,
    angle_tolerance: float | None,
) -> CutFaces:
    """The chosen faces cut into triangles, whatever else goes wrong on the way a MouldError."""
    allow(SECONDS_A_STEP, MEMORY)
    try:
        # numbers beyond all measure are found by what they lead to
        with quiet(), np.errstate(all="ignore"):
            return cut_faces(shape, origin, faces, chord_tolerance, angle_tolerance)
    except MouldError as error:
        msg = f"{origin}: {error}"
        raise MouldError(msg) from error
    except (ValueError, ArithmeticError, LookupError, MemoryError) as error:
        # what a damaged file holds in place of geometry nobody foresees
        msg = f"{origin}: its faces cannot be cut into triangles ({brief(error)}); mend them in CAD"
        raise MouldError(msg) from error
    except Exception as error:
        if not type(error).__module__.startswith("OCP"):  # Open CASCADE's own have no base class in common
            raise
        msg = f"{origin}: Open CASCADE cannot work out its faces ({type(error).__name__}); mend them in CAD"
        raise MouldError(msg) from error


def _mould(cut: CutFaces, origin: str) -> Mould:
    try:
        return cut.mould()
    except MouldError as error:
        msg = f"{origin}: {error}"
        raise MouldError(msg) from error
