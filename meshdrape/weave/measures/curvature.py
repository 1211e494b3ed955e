"""The angle defects under a net, each in the cell whose outline of straight geodesics encloses its vertex."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import crossings
from meshdrape.kernels.components import join_uncrossed
from meshdrape.kernels.edges import WARP
from meshdrape.surface import Surface
from meshdrape.weave.measures.chords import SENSE, Chord, chords, generator_nodes, passed
from meshdrape.weave.measures.turning import FLAT, vertices_at
from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
    seed, nodes : float
        At the seed, and at the other nodes of the generators: in no cell, for each is a corner of four.
    vertex : (k,) int64
        Vertices of the mesh with a defect, one by one...
    cell : (k, 2) int64
        ... the cells they fall to, those on a fibre to the ones on both sides...
    part : (k,)
        ... and how much of their defect does.
    chords : list of Chord
        The generators' edges that bend, as they were followed.
    """

    inside: FloatArray
    beside_warp: FloatArray
    beside_weft: FloatArray
    seed: float
    nodes: float
    vertex: IntArray
    cell: IntArray
    part: FloatArray
    chords: list[Chord]

    @property
    def by_cell(self) -> FloatArray:
        """All that falls to each cell, (n_warp - 1, n_weft - 1): Gauss and Bonnet's interior angles less 2 pi."""
        total = np.zeros(self.inside.shape)
        np.add.at(total, tuple(self.cell.T), self.part)
        return total


class _Marks(NamedTuple):
    """Vertices on edges of the net: (vertex, family, i, j), and the share of its defect to the edge's left."""

    at: IntArray
    share: FloatArray


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
    nearest, cell, marks = _crossings(net)
    bent = chords(net)
    marks = _along_chords(net, bent, nearest, cell, marks)
    seed_vertex = _seed_vertex(net)
    corners = _corner_vertices(net, seed_vertex)
    on_fibre = np.zeros(len(surface.vertices), dtype=np.bool_)
    on_fibre[marks.at[:, 0]] = True
    on_fibre[corners] = True
    if seed_vertex >= 0:
        on_fibre[seed_vertex] = True
    shape = (max(n_warp - 1, 0), max(n_weft - 1, 0))
    inside = np.zeros(shape)
    home = _vertex_cells(surface, nearest, cell, on_fibre)
    within = np.flatnonzero((home >= 0).all(axis=1) & (home < shape).all(axis=1) & (defect != 0))
    np.add.at(inside, tuple(home[within].T), defect[within])

    vertex, family, i, j = marks.at.T
    generator = np.where(family == WARP, j == j0, i == i0)
    # a vertex met by several edges is a node: its defect is shared among them, on a generator among its edges alone
    on_generator = np.zeros(len(surface.vertices), dtype=np.bool_)
    on_generator[vertex[generator]] = True
    corner = np.isin(vertex, corners) | (vertex == seed_vertex)
    counted = (generator | ~on_generator[vertex]) & ~corner
    times = np.bincount(vertex[counted], minlength=len(surface.vertices))
    vertex, family, i, j, generator = (values[counted] for values in (vertex, family, i, j, generator))
    part = defect[vertex] / np.maximum(times[vertex], 1)
    left, right = marks.share[counted] * part, (1 - marks.share[counted]) * part
    # to the left of the weft lie the smaller i
    along = family == WARP
    beside_warp, beside_weft = np.zeros((2, shape[0])), np.zeros((2, shape[1]))
    for beside, own, at, sides in (
        (beside_warp, generator & along, i, (left, right)),
        (beside_weft, generator & ~along, j, (right, left)),
    ):
        for side in (0, 1):
            np.add.at(beside[side], at[own], sides[side][own])
    left_cell = np.stack([np.where(along, i, i - 1), j], axis=1)
    right_cell = np.stack([i, np.where(along, j - 1, j)], axis=1)
    on_cell = np.concatenate([left_cell, right_cell])
    on_part, on_vertex, own = np.concatenate([left, right]), np.tile(vertex, 2), np.tile(generator, 2)
    there = ((on_cell >= 0) & (on_cell < shape)).all(axis=1) & (on_part != 0)
    np.add.at(inside, tuple(on_cell[there & ~own].T), on_part[there & ~own])
    return Curvature(
        inside,
        beside_warp,
        beside_weft,
        seed=float(defect[seed_vertex]) if seed_vertex >= 0 else 0.0,
        nodes=float(defect[corners].sum()),
        vertex=np.concatenate([within, on_vertex[there]]),
        cell=np.concatenate([home[within], on_cell[there]]),
        part=np.concatenate([defect[within], on_part[there]]),
        chords=bent,
    )


def _crossings(net: Net) -> tuple[FloatArray, IntArray, _Marks]:
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
            return nearest, cell, _Marks(mark[:n], share[:n])
        room = n


def _along_chords(net: Net, bent: list[Chord], nearest: FloatArray, cell: IntArray, marks: _Marks) -> _Marks:
    """The marks with those of the edges that the kernel leaves out; their crossings are noted as it notes others."""
    neighbour = net.surface.face_neighbour.ravel()
    at, share = [], []
    for chord in bent:
        family, forward = chord.half % 2, chord.half < 2
        nodes = np.array(net.seed_index) + np.array([[chord.order], [chord.order + 1]]) * SENSE[chord.half]
        i, j = nodes.min(axis=0).tolist()
        towards_larger = ((i, j), (i, j - 1)) if family == WARP else ((i - 1, j), (i, j))
        left, right = towards_larger if forward else towards_larger[::-1]
        for over in passed(net.surface, chord):
            if over.at < 0:
                at.append((over.vertex, family, i, j))
                share.append(over.t if forward else 1 - over.t)
                continue
            for half, t, side in ((over.at, over.t, right), (int(neighbour[over.at]), 1 - over.t, left)):
                if t < nearest[half]:
                    nearest[half] = t
                    cell[half] = side
    if not at:
        return marks
    return _Marks(np.concatenate([marks.at, np.array(at)]), np.concatenate([marks.share, np.array(share)]))


def _corner_vertices(net: Net, seed_vertex: int) -> IntArray:
    """Vertices at the nodes of the generators but the seed, each once."""
    on = np.concatenate([vertices_at(net, generator_nodes(net, half)[1:]) for half in range(4)])
    return np.setdiff1d(on, [-1, seed_vertex])


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
    # a region and a cell as one number; what most of a region's crossings say: an edge through a node may be first by
    # round-off alone
    low = cell.min(axis=0)
    i, j = (cell[told] - low).T
    n_i, n_j = (cell.max(axis=0) - low + 1).tolist()
    votes, count = np.unique((region[tail] * n_i + i) * n_j + j, return_counts=True)
    of_region = votes // (n_i * n_j)
    order = np.lexsort((-count, of_region))
    first = order[np.unique(of_region[order], return_index=True)[1]]
    found[of_region[first], 0] = votes[first] // n_j % n_i + low[0]
    found[of_region[first], 1] = votes[first] % n_j + low[1]
    home = found[region]
    home[on_fibre] = -1
    return np.asarray(home)
