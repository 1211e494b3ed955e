"""A net ends where a fibre crosses a crease and comes back: there the sheet on both sides prescribes it.

Section 3.4 of the study group report: a ribbon that starts on the wing, goes over the edge onto the spar and crosses
back has boundary conditions at both ends, and no sheet laid undeformed on the wing meets them.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.components import connected_parts
from meshdrape.kernels.recross import MOST, returning_warps, returning_wefts
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.crease import crease_edges
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A fibre has crossed only if it goes this far beyond the crease, in spacings: what the facets of a crease do to a fibre
# that runs along it is less.
BEYOND = 0.5
# Where a crease turns by more than this at a vertex, rad, another one begins.
CORNER = np.radians(45.0)
# A mesh that falls into more parts than this has no creases but facets.
MOST_REGIONS = 2000
# Nodes of a fibre beyond a crease of which the distance from it is taken.
MOST_LOOKED_AT = 40


def creases_of(part: Surface, cad_face: IntArray, angle_tolerance: float | None) -> Creases:
    """The creases of the draped part of a mould and what lies between them, kept with it for the next drape.

    Parameters
    ----------
    part : Surface
    cad_face, angle_tolerance
        See :func:`meshdrape.weave.start.crease.crease_edges`.
    """
    kept: dict[str, Creases] = vars(part)
    if "_creases" not in kept:
        kept["_creases"] = Creases(part, crease_edges(part, cad_face, angle_tolerance))
    return kept["_creases"]


def end_where_recrossed(
    creases: Creases,
    surface: Surface,
    fabric: Fabric,
    lattice: Lattice,
    start: Start,
    threads: int = 1,
) -> int:
    """Mark RECROSSED the first node of each fibre back over a crease, NOT_REACHED what depends on it.

    Returns the number of the first. Creases that close on themselves, round a boss or a pocket, may be crossed twice:
    the cloth goes over and comes down.

    Parameters
    ----------
    creases : Creases
        Of the mould, without its collar.
    surface : Surface
        With the collar.
    """
    if not creases.returns.any():
        return 0
    region = np.full(len(surface.faces), -1, dtype=np.int64)
    region[: len(creases.region)] = creases.region
    i0, j0 = (int(v) for v in start.origin)
    n_warp, n_weft = lattice.status.shape
    tables = (lattice.face, lattice.status, region, creases.returns)
    beyond = BEYOND * fabric.longest

    def returning(search: tuple[bool, int]) -> IntArray:
        warp, sense = search
        found = np.empty((MOST * (n_weft if warp else n_warp), 3), dtype=np.int64)
        n = returning_warps(*tables, i0, sense, found) if warp else returning_wefts(*tables, j0, sense, found)
        return found[:n]

    searches = [(True, 1), (True, -1), (False, 1), (False, -1)]
    nodes = []
    with ThreadPoolExecutor(threads) as pool:
        for (warp, sense), fibres in zip(searches, pool.map(returning, searches), strict=True):
            for line, entered, back in fibres.tolist():
                along = np.unique(np.linspace(entered, back - sense, MOST_LOOKED_AT).astype(np.int64))
                across = np.full(len(along), line)
                i, j = (along, across) if warp else (across, along)
                if _depth(creases, surface, lattice, i, j) > beyond:
                    nodes.append((back, line) if warp else (line, back))
    for node in nodes:
        _cut_behind(lattice, (i0, j0), node)
    for node in nodes:
        lattice.status[node] = NodeStatus.RECROSSED
    return len(nodes)


@dataclass(frozen=True, eq=False)
class Creases:
    """The smooth regions of a mould, and which of them meet in one open crease.

    Attributes
    ----------
    surface : Surface
    crease : (m, 3) bool
        Its creases, by face and edge.
    """

    surface: Surface
    crease: NDArray[np.bool_]

    @cached_property
    def region(self) -> IntArray:
        """Number of the region of each face, (m,)."""
        face, k = np.nonzero((self.surface.face_neighbour >= 0) & ~self.crease)
        return connected_parts(face, self.surface.face_neighbour[face, k] // 3, len(self.surface.faces))

    @cached_property
    def edges(self) -> tuple[IntArray, IntArray]:
        """Crease edges between two regions: their vertices (n, 2) and the regions, the smaller first, (n, 2)."""
        surface = self.surface
        face, k = np.nonzero(self.crease)
        other = surface.face_neighbour[face, k] // 3
        once = (face < other) & (self.region[face] != self.region[other])
        face, k, other = face[once], k[once], other[once]
        ends = np.stack([surface.faces[face, k], surface.faces[face, (k + 1) % 3]], axis=1)
        return ends, np.sort(np.stack([self.region[face], self.region[other]], axis=1), axis=1)

    @cached_property
    def returns(self) -> NDArray[np.bool_]:
        """Whether two regions meet in one crease that is open, and so must not be crossed twice, (r, r)."""
        none = np.zeros((0, 0), dtype=np.bool_)
        # most moulds have no crease, and then nobody asks for their regions
        if not self.crease.any():
            return none
        n = int(self.region.max()) + 1
        ends, pairs = self.edges
        if not len(ends) or n > MOST_REGIONS:
            return none
        returns = np.zeros((n, n), dtype=np.bool_)
        for a, b in np.unique(pairs, axis=0).tolist():
            returns[a, b] = returns[b, a] = self._one_open_line(ends[(pairs == (a, b)).all(axis=1)])
        return returns

    def _one_open_line(self, ends: IntArray) -> bool:
        """Whether some edges follow one another in one line with two ends, without a corner."""
        vertices, count = np.unique(ends, return_counts=True)
        if (count > 2).any() or np.count_nonzero(count == 1) != 2:
            return False
        at = np.searchsorted(vertices, ends)
        size = len(vertices)
        if connected_parts(at[:, 0], at[:, 1], size).any():
            return False
        # at each inner vertex the two edges, both seen leaving it, run nearly opposite ways
        along = self.surface.vertices[ends[:, 1]] - self.surface.vertices[ends[:, 0]]
        along /= np.linalg.norm(along, axis=1)[:, None]
        total = np.zeros((size, 3))
        np.add.at(total, at[:, 0], along)
        np.add.at(total, at[:, 1], -along)
        inner = count == 2
        return bool((np.linalg.norm(total[inner], axis=1) <= 2 * np.sin(CORNER / 2)).all())


def _depth(creases: Creases, surface: Surface, lattice: Lattice, i: IntArray, j: IntArray) -> float:
    """How far the nodes (i, j) go from the creases of their mould, mm."""
    ends, _ = creases.edges
    # where cloth is missing on the way back there is no face to ask
    placed = lattice.status[i, j] == NodeStatus.PLACED
    i, j = i[placed], j[placed]
    frame = surface.unfolding.frame[lattice.face[i, j]]
    points = frame[:, :3] + lattice.xy[i, j, :1] * frame[:, 3:6] + lattice.xy[i, j, 1:] * frame[:, 6:9]
    tail = creases.surface.vertices[ends[:, 0]]
    along = creases.surface.vertices[ends[:, 1]] - tail
    farthest = 0.0
    for point in points:
        t = np.clip(np.einsum("ij,ij->i", point - tail, along) / np.einsum("ij,ij->i", along, along), 0.0, 1.0)
        farthest = max(farthest, float(np.linalg.norm(tail + t[:, None] * along - point, axis=1).min()))
    return farthest


def _cut_behind(lattice: Lattice, origin: tuple[int, int], node: tuple[int, int]) -> None:
    """Take back a node and all that lies beyond it, away from both generators."""
    (i0, j0), (i, j) = origin, node
    rows = slice(i, None) if i > i0 else slice(None, i + 1) if i < i0 else slice(None)
    columns = slice(j, None) if j > j0 else slice(None, j + 1) if j < j0 else slice(None)
    behind = lattice.status[rows, columns]
    behind[behind <= NodeStatus.OFF_MOULD] = NodeStatus.NOT_REACHED
