"""Repair of a mesh that cannot be draped, with an account of what it changed and how far the surface moved."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import missing_library
from meshdrape.mould.check import (
    Fault,
    as_arrays,
    counted,
    edge_joints,
    examine,
    reversed_triangles,
    without_unreferenced,
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


def heal(vertices: ArrayLike, triangles: ArrayLike) -> tuple[Floats, Ints, HealReport]:
    """Return a mesh that can be draped, made of one that need not be, and what that changed.

    Close vertices are merged, duplicate and degenerate triangles removed, fins and other non-manifold parts taken
    off, vertices where parts only touch split, and triangles turned to face as most of their component does. Holes
    are left open, and those that a removed triangle leaves too.

    Parameters
    ----------
    vertices : (n, 3) float, mm
    triangles : (m, 3) int

    Raises
    ------
    MouldError
        An array is wrong (see :func:`~meshdrape.mould.check.as_arrays`), or faults are left; it says which.
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
        left = examine(bench.vertices, bench.triangles)
        if not left.faults or not len(bench.triangles):
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
        before = len(self.vertices)
        self._apply("meshing_merge_close_vertices", threshold=_pymeshlab().PureValue(threshold))
        self.vertices_merged += before - len(self.vertices)

    def remove_degenerate(self) -> None:
        before = len(self.triangles)
        self._keep(~self._repeated())
        self._apply("meshing_remove_duplicate_faces")
        self.triangles_removed += before - len(self.triangles)
        needles = self._needles()
        if needles:
            self._apply("meshing_remove_t_vertices", method="Edge Flip", threshold=NEEDLE, repeat=True)
            self.edges_turned += needles - self._needles()
            before = len(self.triangles)
            self._apply("meshing_remove_null_faces")
            self.triangles_removed += before - len(self.triangles)
