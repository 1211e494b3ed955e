"""From the faces of a B-rep to a mould: chosen, sewn if need be, tessellated, each triangle remembering its face."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from meshdrape.errors import MouldError, SelectionError
from meshdrape.mould.apart import step
from meshdrape.mould.cad.patch import Patch, Tolerances
from meshdrape.mould.cad.shape import NamedShape
from meshdrape.mould.cad.tessellate import Tessellation, tessellate
from meshdrape.mould.mould import CadFace, Mould

# A facetted crease errs in direction by half the turn of a facet, and the net's shear by as much: this keeps it a
# thirtieth of a locking angle of 7 degrees.
ANGLE_TOLERANCE = math.radians(0.2)
CHORD_TOLERANCE = 0.1


@dataclass(frozen=True, eq=False)
class CutFaces:
    """The chosen faces of a B-rep cut into triangles: nothing of Open CASCADE is left in it.

    Attributes
    ----------
    mesh : Tessellation
    cad_faces : tuple of CadFace
        The chosen ones.
    tolerances : Tolerances
    notes : tuple of str
        What was done to them, one line each.
    """

    mesh: Tessellation
    cad_faces: tuple[CadFace, ...]
    tolerances: Tolerances
    notes: tuple[str, ...]

    def mould(self) -> Mould:
        """The mould they make.

        Raises
        ------
        MouldError
            The triangles make no surface that can be draped.
        """
        mould = Mould.from_arrays(self.mesh.vertices, self.mesh.triangles)
        return replace(
            mould,
            triangle_face=self.mesh.triangle_face,
            cad_faces=self.cad_faces,
            chord_tolerance=self.tolerances.chord,
            angle_tolerance=self.tolerances.angle,
            notes=(*self.notes, *(note for note in mould.notes if "no triangle" not in note)),
        )


def cad_faces(shape: NamedShape) -> tuple[CadFace, ...]:
    """Every face of a shape, ids from 1 in the order of the file."""
    from OCP.TopTools import TopTools_IndexedMapOfShape

    edges = TopTools_IndexedMapOfShape()
    touching: dict[int, list[int]] = {}
    for number, face in enumerate(shape.faces, start=1):
        for edge in face.Edges():
            touching.setdefault(edges.Add(edge.wrapped), []).append(number)
    neighbours: dict[int, set[int]] = {number: set() for number in range(1, len(shape.faces) + 1)}
    for numbers in touching.values():
        for number in numbers:
            neighbours[number].update(other for other in numbers if other != number)
    listed = []
    for number, (face, name) in enumerate(zip(shape.faces, shape.names, strict=True), start=1):
        step()
        patch = Patch(face.wrapped)
        middle = patch.middle
        listed.append(
            CadFace(
                id=number,
                name=name,
                kind=face.geomType(),
                area=float(face.Area()),
                normal=middle.normal[0] * (-1.0 if patch.reversed else 1.0),
                centre=middle.position[0],
                neighbours=tuple(sorted(neighbours[number])),
                developable=patch.developable,
            )
        )
    return tuple(listed)


def cut_faces(
    shape: NamedShape,
    origin: str,
    faces: str | Sequence[int] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> CutFaces:
    """The chosen faces of a B-rep, cut into triangles.

    Parameters
    ----------
    shape : NamedShape
    origin : str
        What messages call it.
    faces : str or sequence of int, optional
        A CadQuery selector (``">Z"``), or ids, also as the words ``"1,3"``. Default: all, unless the shape is a
        closed solid, of which one side has to be chosen.
    chord_tolerance : float, mm
        Largest distance of a facet from its face.
    angle_tolerance : float, rad
        Largest angle between facets at a crease or across a developable face; on a doubly curved face that which
        makes the same error of shear (:class:`~meshdrape.mould.cad.patch.Tolerances`).

    Raises
    ------
    SelectionError
        If a choice is needed and none was made, or what was chosen is not there; ``faces`` lists what is.
    MouldError
        If a tolerance is out of range or the faces cannot be tessellated.
    """
    chord = CHORD_TOLERANCE if chord_tolerance is None else chord_tolerance
    angle = ANGLE_TOLERANCE if angle_tolerance is None else angle_tolerance
    if not (math.isfinite(chord) and chord > 0):
        msg = f"chord tolerance {chord:g} mm must be a positive length"
        raise MouldError(msg)
    if not math.radians(0.001) <= angle <= math.radians(60):
        msg = f"angle tolerance {math.degrees(angle):g} degrees must lie between 0.001 and 60"
        raise MouldError(msg)
    listed = cad_faces(shape)
    chosen = select(shape, listed, faces, origin)
    picked, notes = _sewn([shape.faces[number - 1] for number in chosen])
    tolerances = Tolerances(chord, angle)
    mesh = tessellate([face.wrapped for face in picked], chosen, tolerances)
    return CutFaces(mesh, tuple(listed[number - 1] for number in chosen), tolerances, notes)


def brep_mould(
    shape: NamedShape,
    origin: str,
    faces: str | Sequence[int] | None = None,
    chord_tolerance: float | None = None,
    angle_tolerance: float | None = None,
) -> Mould:
    """The mould of the chosen faces of a B-rep; see :func:`cut_faces`."""
    return cut_faces(shape, origin, faces, chord_tolerance, angle_tolerance).mould()


def select(
    shape: NamedShape, listed: tuple[CadFace, ...], faces: str | Sequence[int] | None, origin: str
) -> tuple[int, ...]:
    """Ids of the chosen faces, ascending.

    Raises
    ------
    SelectionError
        See :func:`cut_faces`.
    """
    way_out = f"meshdrape inspect {origin} lists them"
    if faces is None:
        solids = [solid for solid in shape.shape.Solids() if solid.isValid()]
        if solids:
            msg = (
                f"{origin} is a closed solid of {len(listed)} faces, and cloth lies on some of them: choose with "
                f'--faces, such as --faces ">Z" or --faces 1,2; {way_out}'
            )
            raise SelectionError(msg, listed)
        return tuple(face.id for face in listed)
    ids = _as_ids(faces)
    if ids is not None:
        unknown = [number for number in ids if not 1 <= number <= len(listed)]
        if unknown or not ids:
            its_faces = f"its faces are 1 to {len(listed)}" if len(listed) > 1 else "its only face is 1"
            what = f"has no face {', '.join(map(str, unknown))}" if unknown else "was given no face to choose"
            msg = f"{origin} {what}: {its_faces}; {way_out}"
            raise SelectionError(msg, listed)
        return tuple(sorted(set(ids)))
    return _by_selector(shape, listed, str(faces), origin, way_out)


def _as_ids(faces: str | Sequence[int]) -> list[int] | None:
    """The ids, if it is ids that were given."""
    parts = [part for part in faces.split(",") if part.strip()] if isinstance(faces, str) else list(faces)
    try:
        return [int(part) for part in parts]
    except ValueError:
        return None


def _by_selector(
    shape: NamedShape, listed: tuple[CadFace, ...], selector: str, origin: str, way_out: str
) -> tuple[int, ...]:
    import cadquery

    named = [face.id for face in listed if face.name is not None and face.name in selector.split(",")]
    if named:
        return tuple(named)
    try:
        found = cadquery.Workplane(obj=shape.shape).newObject([shape.shape]).faces(selector).vals()
    except Exception as error:  # pyparsing's own, and whatever a selector runs into
        msg = f"{selector!r} is no CadQuery selector such as >Z, nor ids such as 1,3, nor names of faces; {way_out}"
        raise SelectionError(msg, listed) from error
    chosen = tuple(
        number
        for number, face in enumerate(shape.faces, start=1)
        if any(face.wrapped.IsSame(other.wrapped) for other in found)
    )
    if not chosen:
        msg = f"the selector {selector!r} matches none of the {len(listed)} faces of {origin}; {way_out}"
        raise SelectionError(msg, listed)
    return chosen


def _sewn(faces: list[Any]) -> tuple[list[Any], tuple[str, ...]]:
    """The faces with edges made common where loose faces lie edge to edge, and a note where that was done."""
    from OCP.TopTools import TopTools_IndexedMapOfShape

    edges = TopTools_IndexedMapOfShape()
    uses: dict[int, int] = {}
    for face in faces:
        for edge in face.Edges():
            key = edges.Add(edge.wrapped)
            uses[key] = uses.get(key, 0) + 1
    if len(faces) < 2 or any(count > 1 for count in uses.values()):
        return faces, ()
    import cadquery
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing
    from OCP.TopoDS import TopoDS

    sewing = BRepBuilderAPI_Sewing(1e-4)
    for face in faces:
        sewing.Add(face.wrapped)
    sewing.Perform()
    if sewing.NbContigousEdges() == 0:
        return faces, ()
    # a sewn shell also turns its faces alike; each keeps its place in the list
    shell = cadquery.Shape.cast(sewing.SewedShape())
    ordered = []
    for face in faces:
        modified = sewing.ModifiedSubShape(face.wrapped)
        ordered.append(
            next(
                (f for f in shell.Faces() if f.wrapped.IsSame(modified)),
                cadquery.Face(TopoDS.Face_s(modified)),
            )
        )
    return ordered, (f"{len(faces)} loose faces sewn along {sewing.NbContigousEdges()} edges",)
