"""What keeps a triangle mesh from being draped, with counts and places, and what is only worth knowing."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import MouldError
from meshdrape.mould.mesh.topology import (
    edge_joints,
    edge_keys,
    fans,
    misfacing,
    relative_height,
    repeats_triangle,
    repeats_vertex,
)
from meshdrape.surface import Surface

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Place = tuple[float, float, float]

# A triangle lower than this share of its longest edge has no normal: round-off of its corners makes it up.
FLATTEST: Final = 1e-12
# mm; further out squares of lengths lose all meaning, and no unit makes it a mould.
FARTHEST: Final = 1e12
# Components listed one by one; more are summed up.
MOST_LISTED: Final = 4


class FaultKind(StrEnum):
    """What no net can be laid over, in the singular."""

    REPEATED_VERTEX = "repeated-vertex triangle"
    ZERO_AREA = "zero-area triangle"
    DUPLICATE = "duplicate triangle"
    NON_MANIFOLD_EDGE = "non-manifold edge"
    BOW_TIE = "non-manifold vertex"
    MIXED_ORIENTATION = "reversed triangle"
    ONE_SIDED = "one-sided component"


@dataclass(frozen=True)
class Fault:
    """All faults of one kind in a mesh.

    Attributes
    ----------
    kind : FaultKind
    count : int
    place : (x, y, z), mm
        Where the first of them is: the middle of the triangle or edge, or the vertex.
    """

    kind: FaultKind
    count: int
    place: Place

    def __str__(self) -> str:
        first = "the first " if self.count > 1 else ""
        return f"{counted(self.count, self.kind)}, {first}at {at(self.place)}"


@dataclass(frozen=True)
class MeshReport:
    """What a mesh is like.

    Attributes
    ----------
    n_vertices, n_triangles : int
    n_unreferenced : int
        Vertices of no triangle.
    faults : tuple of Fault
        What keeps it from being draped, one of a kind; empty for a mesh that can be.
    """

    n_vertices: int
    n_triangles: int
    n_unreferenced: int
    faults: tuple[Fault, ...]

    def count(self, kind: FaultKind) -> int:
        """How many faults of one kind there are."""
        return sum(fault.count for fault in self.faults if fault.kind is kind)

    def require_drapable(self, way_out: str = "repair it with --heal, or in CAD") -> None:
        """Raise MouldError, one line with every fault and the way out, unless there is none."""
        if not self.faults:
            return
        if any(fault.kind is FaultKind.ONE_SIDED for fault in self.faults):
            way_out = "a one-sided surface has no normal side to lay cloth on: cut it in CAD"
        msg = f"the mesh cannot be draped: {'; '.join(map(str, self.faults))}; {way_out}"
        raise MouldError(msg)


def as_arrays(vertices: ArrayLike, triangles: ArrayLike, factor: float = 1.0) -> tuple[Floats, Ints]:
    """Return copies as (n, 3) float64, times `factor`, and (m, 3) int64: all finite, every index in range.

    Raises
    ------
    MouldError
        A shape or type is wrong, there are no triangles, an index is out of range, or a coordinate is NaN,
        infinite or beyond ``FARTHEST``.
    """
    points = _numeric(vertices, "vertices", "numbers", "fiu")
    corners = _numeric(triangles, "triangles", "integers", "iu")
    if not len(corners):
        msg = "the mesh has no triangles; a mould needs at least one"
        raise MouldError(msg)
    outside = np.flatnonzero(((corners < 0) | (corners >= len(points))).any(axis=1))
    if len(outside):
        first = int(outside[0])
        index = next(int(i) for i in corners[first] if not 0 <= i < len(points))
        msg = (
            f"triangles[{first}] uses vertex {index} but there are {len(points)} vertices; "
            f"indices start at 0 ({counted(len(outside), 'triangle')} out of range)"
        )
        raise MouldError(msg)
    coordinates = np.array(points, dtype=np.float64)
    # NaN fails the comparison too
    bad = np.flatnonzero(~(np.abs(coordinates) <= FARTHEST / factor).all(axis=1))
    if len(bad):
        first = int(bad[0])
        msg = (
            f"vertices[{first}] is {at(coordinates[first])}: {counted(len(bad), 'vertex')} not finite "
            f"or farther out than {FARTHEST:g} mm; export the mesh anew"
        )
        raise MouldError(msg)
    return factor * coordinates, np.array(corners, dtype=np.int64)


def examine(vertices: Floats, triangles: Ints) -> MeshReport:
    """Find what is wrong with a mesh whose arrays :func:`as_arrays` has passed. O(m log m)."""
    repeated = repeats_vertex(triangles)
    flat = (relative_height(vertices, triangles) <= FLATTEST) & ~repeated
    twice = repeats_triangle(triangles) & ~repeated
    # what is named once need not be named again by its edges
    whole = triangles[~(repeated | twice)]
    faults = [
        _faces_at(FaultKind.REPEATED_VERTEX, repeated, vertices, triangles),
        _faces_at(FaultKind.ZERO_AREA, flat, vertices, triangles),
        _faces_at(FaultKind.DUPLICATE, twice, vertices, triangles),
        *_faults_of_edges(vertices, whole),
    ]
    used = np.zeros(len(vertices), dtype=bool)
    used[triangles] = True
    return MeshReport(
        n_vertices=len(vertices),
        n_triangles=len(triangles),
        n_unreferenced=int(np.count_nonzero(~used)),
        faults=tuple(fault for fault in faults if fault.count),
    )


def without_unreferenced(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Return the same triangles with only the vertices they use, in their order."""
    used = np.zeros(len(vertices), dtype=bool)
    used[triangles] = True
    return vertices[used], (np.cumsum(used) - 1)[triangles]


def notes_on(surface: Surface) -> tuple[str, ...]:
    """Return what the reader should be told of a drapable mesh, one line each: several components, holes."""
    notes = []
    sizes = np.bincount(surface.face_component)
    if len(sizes) > 1:
        notes.append(_components_note(surface, sizes))
    holes = [loop for loop in surface.border_loops if surface.is_hole(loop)]
    if holes:
        # loops come longest first
        rim = surface.faces[holes[0] // 3, holes[0] % 3]
        length = float(surface.half_edge_length(holes[0]).sum())
        longest = "its border" if len(holes) == 1 else "the longest border"
        place = at(surface.vertices[rim].mean(axis=0))
        notes.append(f"{counted(len(holes), 'hole')}, {longest} {length:.4g} mm long about {place}")
    return tuple(notes)


def counted(count: int, thing: str) -> str:
    """Return a number with its noun, as in "1 vertex" and "2,000 vertices"."""
    if count == 1:
        return f"1 {thing}"
    return f"{count:,} {thing[:-2]}ices" if thing.endswith("vertex") else f"{count:,} {thing}s"


def at(place: ArrayLike) -> str:
    """Return a place, mm, as it stands in a message."""
    return "({})".format(", ".join(f"{x:.6g}" for x in np.asarray(place, dtype=np.float64)))


def _components_note(surface: Surface, sizes: Ints) -> str:
    order = np.argsort(-sizes, kind="stable")
    if len(sizes) <= MOST_LISTED:
        listed = ", ".join(f"{sizes[i]:,}" for i in order[:-1]) + f" and {sizes[order[-1]]:,} triangles"
    else:
        listed = f"{sizes[order[0]]:,} triangles down to {sizes[order[-1]]:,}"
    stray = surface.faces[surface.face_component == order[-1]]
    place = surface.vertices[np.unique(stray)].mean(axis=0)
    return f"{len(sizes):,} components, of {listed}, the smallest about {at(place)}; the seed's is draped"


def _numeric(values: ArrayLike, name: str, wanted: str, kinds: str) -> NDArray[Any]:
    """Return the values as an array of shape (k, 3) whose dtype is of one of the kinds."""
    try:
        array = np.asarray(values)
    except ValueError as error:  # rows of different lengths
        msg = f"{name} must be an array of {wanted} of shape (k, 3), got rows of different lengths"
        raise MouldError(msg) from error
    if array.size == 0 and array.ndim <= 2:
        return np.empty((0, 3), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 3:
        split = "; split polygons into triangles first" if name == "triangles" and array.ndim == 2 else ""
        msg = f"{name} must be an array of {wanted} of shape (k, 3), got shape {array.shape}{split}"
        raise MouldError(msg)
    if array.dtype.kind not in kinds:
        msg = f"{name} must be an array of {wanted}, got {array.dtype}"
        raise MouldError(msg)
    return array


def _faults_of_edges(vertices: Floats, triangles: Ints) -> list[Fault]:
    """Find edges of more than two triangles, vertices of more than one fan, triangles wound unlike others."""
    joints = edge_joints(triangles, len(vertices))
    crowded = joints.crowded()
    _, first = np.unique(edge_keys(triangles, len(vertices))[crowded], return_index=True)
    crowded = np.sort(crowded[first])
    ends = [triangles[h // 3, (h + k) % 3] for h in crowded[:1] for k in (0, 1)]
    faults = [_fault(FaultKind.NON_MANIFOLD_EDGE, len(crowded), vertices[ends])]
    corner_vertex = triangles.ravel()
    _, corner = np.unique(fans(triangles, joints), return_index=True)
    shared = np.flatnonzero(np.bincount(corner_vertex[corner], minlength=1) > 1)
    faults.append(_fault(FaultKind.BOW_TIE, len(shared), vertices[shared[:1]]))
    # where three triangles meet no side is the right one
    if not len(crowded) and joints.alike.any():
        wrong, one_sided, component = misfacing(triangles, joints)
        first_face = triangles[np.flatnonzero(one_sided)[:1]].ravel()
        faults.append(_faces_at(FaultKind.MIXED_ORIENTATION, wrong, vertices, triangles))
        faults.append(_fault(FaultKind.ONE_SIDED, len(np.unique(component[one_sided])), vertices[first_face]))
    return faults


def _faces_at(kind: FaultKind, found: NDArray[np.bool_], vertices: Floats, triangles: Ints) -> Fault:
    return _fault(kind, int(np.count_nonzero(found)), vertices[triangles[found][:1].ravel()])


def _fault(kind: FaultKind, count: int, points: Floats) -> Fault:
    """Return a fault whose first place is in the middle of the points."""
    x, y, z = points.mean(axis=0).tolist() if count else (0.0, 0.0, 0.0)
    return Fault(kind, count, (x, y, z))
