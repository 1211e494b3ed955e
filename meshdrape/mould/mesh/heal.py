"""Repair of a mesh that cannot be draped, with an account of what changed and how far the surface moved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import MouldError, missing_library
from meshdrape.mould.apart import DiedError, apart
from meshdrape.mould.mesh.check import Fault, as_arrays, counted, examine, without_unreferenced
from meshdrape.mould.mesh.topology import (
    edge_joints,
    edge_keys,
    misfacing,
    relative_height,
    repeats_triangle,
    repeats_vertex,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Vertices closer than this share of the bounding box's diagonal are one, unless the triangles are as small.
CLOSE: Final = 1e-5
# ... that is, unless it is more than this share of the median edge.
CLOSE_TO_EDGE: Final = 0.1
# A triangle this many times longer than high has a corner on its longest edge: that edge is turned.
NEEDLE: Final = 1e10
# Removing a triangle can bare another fault; twice has always been enough.
MOST_ROUNDS: Final = 8
# Points to a side of a changed triangle where the way to the other surface is measured.
PROBES: Final = 5
# MeshLab heals a thousand triangles in a hundredth of a second; with one far off its search may have no end.
SECONDS, SECONDS_A_TRIANGLE = 20.0, 1e-3
MEMORY: Final = 8 * 2**30


@dataclass(frozen=True)
class HealReport:
    """What healing changed.

    Attributes
    ----------
    faults : tuple of Fault
        What was wrong.
    vertices_merged : int
        Vertices made one with another.
    vertices_split : int
        Vertices added where parts of the surface hung together at a point or edge only.
    edges_turned : int
        Zero-area triangles taken out by turning the edge their corner lay on.
    triangles_removed : int
        Duplicate, collapsed and non-manifold triangles.
    triangles_reversed : int
    moved : float, mm
        Largest distance from the old surface to the new one or back, at the corners of the triangles that are
        not in both and at points evenly spread over them.
    """

    faults: tuple[Fault, ...]
    vertices_merged: int
    vertices_split: int
    edges_turned: int
    triangles_removed: int
    triangles_reversed: int
    moved: float

    def __str__(self) -> str:
        changes = [
            f"{counted(number, thing)} {done}"
            for number, thing, done in (
                (self.vertices_merged, "vertex", "merged"),
                (self.vertices_split, "vertex", "split off"),
                (self.edges_turned, "edge", "turned"),
                (self.triangles_removed, "triangle", "removed"),
                (self.triangles_reversed, "triangle", "reversed"),
            )
            if number
        ]
        if not changes:
            return "healing found nothing to repair"
        return f"healed: {', '.join(changes)}; the surface moved by {self.moved:.3g} mm at most"


def heal_apart(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints, HealReport]:
    """The same as :func:`heal`, in a process of its own: MeshLab crashes on some meshes, or searches for hours.

    Raises
    ------
    MouldError
        That too.
    """
    _pymeshlab()
    try:
        return apart(lambda: heal(vertices, triangles), SECONDS + SECONDS_A_TRIANGLE * len(triangles), MEMORY)
    except DiedError as died:
        msg = f"MeshLab {died.how} healing it; repair it in CAD, or leave out the triangles that lie far off"
        raise MouldError(msg) from None


def heal(vertices: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Ints, HealReport]:
    """Return a mesh that can be draped, made of one that need not be, and what that changed.

    Close vertices are merged, duplicate and degenerate triangles removed, fins and other non-manifold parts
    taken off, vertices where parts only touch split, and triangles turned to face as most of their component
    does. Holes are left open, those that a removed triangle leaves too.

    Parameters
    ----------
    vertices : (n, 3) float, mm
    triangles : (m, 3) int

    Raises
    ------
    MouldError
        An array is wrong (see :func:`~meshdrape.mould.mesh.check.as_arrays`), or faults are left; it says which.
    MissingLibraryError
        pymeshlab cannot be loaded.
    """
    old_vertices, old_triangles = as_arrays(vertices, triangles)
    faults = examine(old_vertices, old_triangles).faults
    bench = _Bench(*without_unreferenced(old_vertices, old_triangles))
    bench.merge_close_vertices()
    for _ in range(MOST_ROUNDS):
        bench.remove_degenerate()
        bench.remove_non_manifold()
        bench.reverse()
        if not len(bench.triangles):
            msg = "nothing is left after healing; repair the mesh in CAD"
            raise MouldError(msg)
        left = examine(bench.vertices, bench.triangles)
        if not left.faults:
            break
    left.require_drapable("that is left after healing: repair it in CAD")
    report = HealReport(
        faults=faults,
        vertices_merged=bench.vertices_merged,
        vertices_split=bench.vertices_split,
        edges_turned=bench.edges_turned,
        triangles_removed=bench.triangles_removed,
        triangles_reversed=bench.triangles_reversed,
        moved=_moved(old_vertices, old_triangles, bench.vertices, bench.triangles),
    )
    return bench.vertices, bench.triangles, report


class _Bench:
    """A mesh under repair and the tally of what was done to it."""

    def __init__(self, vertices: Floats, triangles: Ints) -> None:
        self.vertices = vertices
        self.triangles = triangles
        self.vertices_merged = 0
        self.vertices_split = 0
        self.edges_turned = 0
        self.triangles_removed = 0
        self.triangles_reversed = 0

    def merge_close_vertices(self) -> None:
        corners = self.vertices[self.triangles]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        diagonal = float(np.linalg.norm(np.ptp(self.vertices, axis=0)))
        threshold = min(CLOSE * diagonal, CLOSE_TO_EDGE * float(np.median(edges)))
        self._keep(~repeats_vertex(self.triangles))
        before = len(self.vertices)
        self._filter("meshing_merge_close_vertices", threshold=_pymeshlab().PureValue(threshold))
        self.vertices_merged = before - len(self.vertices)

    def remove_degenerate(self) -> None:
        self._keep(~repeats_vertex(self.triangles))
        self._keep(~repeats_triangle(self.triangles))
        needles = self._needles()
        if needles.any():
            # a hole as thin as the needle would be left if it were removed
            self._filter("meshing_remove_t_vertices", method="Edge Flip", threshold=NEEDLE, repeat=True)
            left = self._needles()
            self.edges_turned += int(np.count_nonzero(needles) - np.count_nonzero(left))
            self._keep(~left)

    def remove_non_manifold(self) -> None:
        """Take off fins first, else the filter might cut the sheet that a fin stands on."""
        while (fins := self._fins()).any():
            self._keep(~fins)
        before = len(self.triangles)
        self._filter("meshing_repair_non_manifold_edges", method="Remove Faces")
        self.triangles_removed += before - len(self.triangles)
        vertices = len(self.vertices)
        self._filter("meshing_repair_non_manifold_vertices")
        self.vertices_split += len(self.vertices) - vertices
        self.vertices, self.triangles = without_unreferenced(self.vertices, self.triangles)

    def reverse(self) -> None:
        wrong, _, _ = misfacing(self.triangles, edge_joints(self.triangles, len(self.vertices)))
        self.triangles = np.where(wrong[:, None], self.triangles[:, ::-1], self.triangles)
        self.triangles_reversed += int(np.count_nonzero(wrong))

    def _needles(self) -> NDArray[np.bool_]:
        return np.asarray(relative_height(self.vertices, self.triangles) <= 1 / NEEDLE)

    def _fins(self) -> NDArray[np.bool_]:
        """Whether each triangle hangs on nothing but an edge that two others lie on that do not so hang."""
        keys = edge_keys(self.triangles, len(self.vertices))
        _, edge, count = np.unique(keys, return_inverse=True, return_counts=True)
        edge = edge.reshape(-1, 3)
        hangs = ((count[edge] == 1).sum(axis=1) == 2) & (count[edge] > 2).any(axis=1)
        sheet = np.bincount(edge[~hangs].ravel(), minlength=len(count))
        return np.asarray(hangs & (sheet[edge] == 2).any(axis=1))

    def _keep(self, wanted: NDArray[np.bool_]) -> None:
        self.triangles_removed += int(np.count_nonzero(~wanted))
        self.triangles = self.triangles[wanted]

    def _filter(self, name: str, **parameters: Any) -> None:
        """Put the mesh through a filter of MeshLab."""
        if not len(self.triangles):
            return
        workshop = _pymeshlab().MeshSet(verbose=False)
        workshop.add_mesh(_pymeshlab().Mesh(vertex_matrix=self.vertices, face_matrix=self.triangles))
        workshop.apply_filter(name, **parameters)
        mesh = workshop.current_mesh()
        self.vertices = np.array(mesh.vertex_matrix(), dtype=np.float64)
        self.triangles = np.array(mesh.face_matrix(), dtype=np.int64).reshape(-1, 3)


def _moved(old_vertices: Floats, old_triangles: Ints, vertices: Floats, triangles: Ints) -> float:
    """Largest distance found from either surface to the other, mm."""
    old, new = old_vertices[old_triangles], vertices[triangles]
    return max(
        _farthest(_probes(old[~_found_in(old, new)]), vertices, triangles),
        _farthest(_probes(new[~_found_in(new, old)]), old_vertices, old_triangles),
    )


def _found_in(corners: Floats, others: Floats) -> NDArray[np.bool_]:
    """Whether each triangle (m, 3, 3) is among the others, to the last bit and wound either way."""
    rows = np.concatenate([corners, others])
    order = np.lexsort(np.moveaxis(rows, 2, 0)[::-1], axis=1)
    rows = np.take_along_axis(rows, order[..., None], axis=1).reshape(len(rows), 9)
    _, number = np.unique(rows, axis=0, return_inverse=True)
    return np.isin(number[: len(corners)], number[len(corners) :])


def _probes(corners: Floats) -> Floats:
    """Points evenly spread over triangles (m, 3, 3), corners and edges among them."""
    steps = np.arange(PROBES)
    weights = np.array([(a, b, PROBES - 1 - a - b) for a in steps for b in steps[: PROBES - a]]) / (PROBES - 1)
    return np.asarray(np.einsum("pk,mkd->mpd", weights, corners).reshape(-1, 3))


def _farthest(points: Floats, vertices: Floats, triangles: Ints) -> float:
    """Largest distance of a point from a surface, mm; 0 for no point."""
    if not len(points):
        return 0.0
    pymeshlab = _pymeshlab()
    workshop = pymeshlab.MeshSet(verbose=False)
    workshop.add_mesh(pymeshlab.Mesh(vertex_matrix=points))
    workshop.add_mesh(pymeshlab.Mesh(vertex_matrix=vertices, face_matrix=triangles))
    reach = float(np.linalg.norm(np.ptp(np.concatenate([points, vertices]), axis=0)))
    found = workshop.get_hausdorff_distance(
        sampledmesh=0,
        targetmesh=1,
        samplevert=True,
        sampleedge=False,
        sampleface=False,
        samplenum=len(points),
        maxdist=pymeshlab.PureValue(reach),
    )
    return float(found["max"])


def _pymeshlab() -> Any:
    try:
        import pymeshlab
    except ImportError as error:
        raise missing_library(error) from error
    return pymeshlab
