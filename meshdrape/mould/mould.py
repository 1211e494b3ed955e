"""The mould: a triangle mesh in millimetres that remembers the CAD faces and the file it comes from."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.mould.mesh.check import as_arrays, counted, examine, notes_on, without_unreferenced
from meshdrape.mould.units import millimetres
from meshdrape.surface import Surface

if TYPE_CHECKING:
    from meshdrape.mould.mesh.heal import HealReport

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CadFace:
    """A face of a B-rep.

    Attributes
    ----------
    id : int
        From 1, in the order of the file.
    name : str or None
        The face's name in the STEP file.
    kind : str
        The kind of surface: "PLANE", "CYLINDER", "BSPLINE", ...
    area : float, mm2
    normal : (3,) float
        Unit normal at the centre.
    centre : (3,) float, mm
    neighbours : tuple of int
        Ids of the faces that share an edge with it.
    developable : bool
        Whether it unrolls flat without stretching.
    """

    id: int
    name: str | None
    kind: str
    area: float
    normal: Floats
    centre: Floats
    neighbours: tuple[int, ...]
    developable: bool


@dataclass(frozen=True, eq=False, repr=False)
class Mould:
    """The tool surface cloth is draped over, on the side its triangles run counter-clockwise about.

    Read one from a file with :func:`meshdrape.read_mould`, or make one with :meth:`from_arrays`, which checks
    the mesh. The arrays are read-only.

    Attributes
    ----------
    vertices : (n, 3) float64, mm
    triangles : (m, 3) int64
    triangle_face : (m,) int64
        Id of the CAD face each triangle lies on, 0 where the mould has none.
    cad_faces : tuple of CadFace
        The faces chosen; none for a mesh.
    source : Path or None
        The file it was read from.
    sha256 : str or None
        Of that file.
    unit : str
        What the numbers of the file were taken for.
    chord_tolerance, angle_tolerance : float or None
        Of the tessellation, mm and rad; None for a mesh.
    notes : tuple of str
        What the reader should be told: several components, holes, corners welded. One line each.
    parameters : tuple of (name, value)
        That a script was run with, where they were not its own.
    turned : bool
        Whether it is the other side of the one that was read (:meth:`flipped`).
    healing : HealReport or None
        What was repaired, where that was asked for.
    """

    vertices: Floats
    triangles: Ints
    triangle_face: Ints
    cad_faces: tuple[CadFace, ...] = ()
    source: Path | None = None
    sha256: str | None = None
    unit: str = "mm"
    chord_tolerance: float | None = None
    angle_tolerance: float | None = None
    notes: tuple[str, ...] = ()
    healing: HealReport | None = None
    parameters: tuple[tuple[str, Any], ...] = ()
    turned: bool = False

    def __post_init__(self) -> None:
        for name, dtype in (("vertices", np.float64), ("triangles", np.int64), ("triangle_face", np.int64)):
            array = np.ascontiguousarray(getattr(self, name), dtype=dtype)
            if array.flags.writeable:
                array = array.copy()
                array.setflags(write=False)
            object.__setattr__(self, name, array)

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, triangles: ArrayLike, unit: str = "mm") -> Mould:
        """Return the mould of the given triangles, in their order; vertices of no triangle are dropped.

        Parameters
        ----------
        vertices : (n, 3) float
        triangles : (m, 3) int
            Counter-clockwise seen from the side the cloth lies on.
        unit : str
            What the vertices are in: mm, cm, m, um, in, inch or ft.

        Raises
        ------
        MouldError
            The arrays are of the wrong shape or type, an index is out of range, a coordinate is not finite,
            there are no triangles, or the mesh has faults no net can be laid over
            (:class:`~meshdrape.mould.mesh.check.FaultKind`).
        """
        factor = millimetres(unit)
        checked, corners = as_arrays(vertices, triangles, factor)
        report = examine(checked, corners)
        report.require_drapable()
        notes: tuple[str, ...] = ()
        if report.n_unreferenced:
            checked, corners = without_unreferenced(checked, corners)
            notes = (f"{counted(report.n_unreferenced, 'vertex')} of no triangle dropped",)
        surface = Surface.from_arrays(checked, corners)
        mould = cls(
            vertices=surface.vertices,
            triangles=surface.faces,
            triangle_face=np.zeros(len(corners), dtype=np.int64),
            unit=unit,
            notes=notes + notes_on(surface),
        )
        vars(mould)["surface"] = surface  # the notes needed it: no need to build it again
        return mould

    @cached_property
    def surface(self) -> Surface:
        """The mould as a surface to walk on."""
        return Surface.from_arrays(self.vertices, self.triangles)

    @cached_property
    def bounds(self) -> Floats:
        """Lowest and highest corner of the bounding box, (2, 3), mm."""
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)])

    @property
    def size(self) -> Floats:
        """Extents of the bounding box, (3,), mm."""
        return np.asarray(self.bounds[1] - self.bounds[0])

    def flipped(self) -> Mould:
        """Return the other side of the tool: the same mould with every triangle run round the other way."""
        return replace(self, triangles=self.triangles[:, ::-1], turned=not self.turned)

    def __repr__(self) -> str:
        name = f"{self.source.name}: " if self.source else ""
        extents = " x ".join(f"{x:.4g}" for x in self.size)
        faces = f" on {counted(len(self.cad_faces), 'CAD face')}" if self.cad_faces else ""
        return f"<Mould {name}{counted(len(self.triangles), 'triangle')}{faces}, {extents} mm>"
