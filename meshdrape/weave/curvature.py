"""The angle defects under a net, each in the cell whose outline of straight geodesics encloses its vertex."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import crossings
from meshdrape.kernels.components import join_uncrossed
from meshdrape.kernels.edges import WARP
from meshdrape.surface import Surface
from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A defect below this is the round-off of a flat vertex, rad.
FLAT = 1e-14
# Barycentric coordinate above which the seed is a vertex.
AT_VERTEX = 1 - 1e-9


@dataclass(frozen=True, eq=False)
class Curvature:
    """Angle defects, rad, by where they lie.

    Attributes
    ----------
    inside : (n_warp - 1, n_weft - 1)
        Inside each cell; of a vertex on a fibre the part that falls to the cell's side of it. What lies on the
        generators is not in it.
    beside_warp : (2, n_warp - 1)
        On each edge of the warp generator: the part towards larger j, then the other.
    beside_weft : (2, n_weft - 1)
        On each edge of the weft generator: the part towards larger i, then the other.
    seed : float
        At the seed: in no cell, for it is a corner of four.
    origin : (int, int)
        Index of the seed node.
    """

    inside: FloatArray
    beside_warp: FloatArray
    beside_weft: FloatArray
    seed: float
    origin: tuple[int, int]

    @property
    def by_cell(self) -> FloatArray:
        """All that falls to each cell, (n_warp - 1, n_weft - 1): Gauss and Bonnet's interior angles less 2 pi."""
        i0, j0 = self.origin
        n_i, n_j = self.inside.shape
        total = self.inside.copy()
        for side, at in ((0, j0), (1, j0 - 1)):
            if 0 <= at < n_j:
                total[:, at] += self.beside_warp[side]
        for side, at in ((0, i0), (1, i0 - 1)):
            if 0 <= at < n_i:
                total[at] += self.beside_weft[side]
        return total


def enclosed_curvature(net: Net) -> Curvature:
    """The defects of the vertices under a net, each counted once.

    Every edge of the net is followed over the mesh. The first one that crosses a mesh edge, seen from a vertex, tells
    the cell the vertex lies in; vertices joined by mesh edges that nothing crosses lie in the same cell. O(n_faces)
    and the crossings.
    """
    surface = net.surface
    n_warp, n_weft = net.shape
    i0, j0 = net.seed_index
    defect = np.where(surface.border_vertex | (np.abs(surface.vertex_defect) < FLAT), 0.0, surface.vertex_defect)
    nearest, cell, mark, mark_share = _crossings(net)
    seed_vertex = _seed_vertex(net)
    on_fibre = np.zeros(len(surface.vertices), dtype=np.bool_)
    on_fibre[mark[:, 0]] = True
    seed = 0.0
    if seed_vertex >= 0:
        on_fibre[seed_vertex] = True
        seed = float(defect[seed_vertex])
    inside = np.zeros((max(n_warp - 1, 0), max(n_weft - 1, 0)))
    home = _vertex_cells(surface, nearest, cell, on_fibre)
    within = (home >= 0).all(axis=1) & (home < inside.shape).all(axis=1)
    np.add.at(inside, tuple(home[within].T), defect[within])

    beside_warp, beside_weft = np.zeros((2, max(n_warp - 1, 0))), np.zeros((2, max(n_weft - 1, 0)))
    vertex, family, i, j = mark.T
    generator = np.where(family == WARP, j == j0, i == i0)
    # a vertex met by several edges is a node: its defect is shared among them, on a generator among its edges alone
    on_generator = np.zeros(len(surface.vertices), dtype=np.bool_)
    on_generator[vertex[generator]] = True
    counted = (generator | ~on_generator[vertex]) & (vertex != seed_vertex)
    times = np.bincount(vertex[counted], minlength=len(surface.vertices))
    for v, along, a, b, share, own in zip(
        *(values[counted].tolist() for values in (vertex, family, i, j, mark_share, generator)), strict=True
    ):
        part = float(defect[v]) / int(times[v])
        if own and along == WARP:
            beside_warp[:, a] += (share * part, (1 - share) * part)
        elif own:
            # to the left of the weft lie the smaller i
            beside_weft[:, b] += ((1 - share) * part, share * part)
        else:
            left, right = ((a, b), (a, b - 1)) if along == WARP else ((a - 1, b), (a, b))
            for (c, d), weight in ((left, share), (right, 1 - share)):
                if 0 <= c < inside.shape[0] and 0 <= d < inside.shape[1]:
                    inside[c, d] += weight * part
    return Curvature(inside, beside_warp, beside_weft, seed, (i0, j0))


def _crossings(net: Net) -> tuple[FloatArray, IntArray, IntArray, FloatArray]:
    """What the kernel notes of the net's edges; see :func:`meshdrape.kernels.crossings.cross`."""
    fabric, mesh = net.fabric, net.surface.unfolding
    room = 1024
    while True:
        nearest = np.full(3 * len(net.surface.faces), np.inf)
        cell = np.full((len(nearest), 2), -1)
        mark, share = np.empty((room, 4), dtype=np.int64), np.empty(room)
        n = crossings.cross(
            mesh, net.lattice, net.start, fabric.warp_spacing, fabric.weft_spacing, nearest, cell, mark, share
        )
        if n <= room:
            return nearest, cell, mark[:n], share[:n]
        room = n


def _seed_vertex(net: Net) -> int:
    """The vertex the seed lies on, -1 where it lies on none."""
    surface, start = net.surface, net.start
    x1, x2, y2 = surface.unfolding.corner[start.face[0]]
    c = start.xy[0, 1] / y2
    b = (start.xy[0, 0] - c * x2) / x1
    weight = (1 - b - c, b, c)
    corner = int(np.argmax(weight))
    return int(surface.faces[start.face[0], corner]) if weight[corner] >= AT_VERTEX else -1


def _vertex_cells(surface: Surface, nearest: FloatArray, cell: IntArray, on_fibre: NDArray[np.bool_]) -> IntArray:
    """Cell (i, j) each vertex lies in, (n, 2); -1 where it lies on a fibre or under no cloth."""
    region = np.empty(len(surface.vertices), dtype=np.int64)
    join_uncrossed(surface.faces, nearest, on_fibre, region)
    told = np.flatnonzero(np.isfinite(nearest))
    tail = surface.faces.ravel()[told]
    told, tail = told[~on_fibre[tail]], tail[~on_fibre[tail]]
    found = np.full((int(region.max()) + 1, 2), -1)
    if len(told):
        # a region and a cell as one number, in the order of both; a cell may lie one before the first
        rows, columns = (cell[told].max(axis=0) + 2).tolist()
        vote = (region[tail] * rows + cell[told, 0] + 1) * columns + cell[told, 1] + 1
        votes, count = np.unique(vote, return_counts=True)
        of, voted = np.divmod(votes, rows * columns)
        begins = np.flatnonzero(np.diff(of, prepend=-1))
        # what most of a region's crossings say: an edge through a node may be first by round-off alone
        most = np.repeat(np.maximum.reduceat(count, begins), np.diff(begins, append=len(of)))
        elected = np.minimum.reduceat(np.where(count == most, np.arange(len(of)), len(of)), begins)
        found[of[begins]] = np.stack(np.divmod(voted[elected], columns), axis=1) - 1
    home = found[region]
    home[on_fibre] = -1
    return np.asarray(home)
