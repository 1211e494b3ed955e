"""A sheet laid on one connected mould: collar, generators, quadrants, and room for all of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.kernels import emit
from meshdrape.kernels.complete import has_bays
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.bays import fill_bays
from meshdrape.weave.lay.collar import extended
from meshdrape.weave.lay.judge import Judge
from meshdrape.weave.lay.quadrants import fill
from meshdrape.weave.lay.slits import SLIT
from meshdrape.weave.net import run_kernel
from meshdrape.weave.start.fibre import STRAIGHT, Courses
from meshdrape.weave.start.generators import (
    MOST_NODES,
    Extent,
    check_memory,
    empty_lattice,
    free_memory,
    generator_counts,
    lay_generators,
    start_fibres,
)
from meshdrape.weave.status import NodeStatus

# Depth of the collar in spacings. A cell's diagonal is shorter than two, so the parents of every node on the mould
# find a place on it; two more carry the hem.
COLLAR_DEPTH = 4.0
# A fibre turned at a crease may leave the mould sideways while its rows still lie on it: the collar is then as deep as
# this share of the longest way the fibre may run, whatever its turn: rows it does not feed keep their every bit.
STRAY = 0.2
# A drape of one spacing needs two collars at most: its own, and that of the coarse net which tells how far it reaches.
COLLARS_KEPT = 2
# Cells of cloth kept past the last that touches the mould.
HEM = 2
# A net of more nodes than this is first laid coarsely, with about that many nodes, to learn how far it reaches:
# room for a large lattice is costly to add afterwards.
SCOUT_FROM, SCOUT_NODES = 150_000, 8_000


@dataclass(frozen=True, eq=False)
class Laid:
    """A sheet as it was laid: the extended surface, how deep its collar is (mm), and the lattice on it.

    With the number of nodes that libigl placed and the seconds it took over those and over judging others.
    """

    surface: Surface
    collar_depth: float
    lattice: Lattice
    start: Start
    settled: int
    seconds: float


def lay(
    part: Surface,
    fabric: Fabric,
    point: SurfacePoint,
    direction: ArrayLike,
    extent: Extent | None,
    threads: int,
    progress: Callable[[int], None] | None = None,
    *,
    courses: Courses = STRAIGHT,
    stop_at: float = np.pi,
    settle_every: bool = False,
) -> Laid:
    """Lay a sheet from a seed point of a connected surface, without an end where it meets itself, untrimmed.

    Parameters
    ----------
    part : Surface
    point : SurfacePoint
        The seed, on `part`.
    direction : (3,)
        Of the warp.
    courses : (warp, weft)
        How the start fibres run.
    stop_at : float
        Shear of a cell at which the cloth ends, rad.
    settle_every : bool
        Have libigl place every node.
    extent : (warp-, warp+, weft-, weft+), mm, optional

    Raises
    ------
    NetError
        If the net would not fit in the memory.
    StartError
        If a start fibre cannot run as asked.
    """
    depth = _collar_depth(part, fabric, extent, courses)
    surface = _with_collar(part, depth, SLIT * fabric.longest)
    counts = generator_counts(part, fabric, extent)
    memory = free_memory()
    bounded = part.area if extent is None else min(part.area, (extent[0] + extent[1]) * (extent[2] + extent[3]))
    cells = min(bounded / fabric.warp_spacing / fabric.weft_spacing, MOST_NODES)
    reach = None
    if cells > SCOUT_FROM:
        check_memory(int(cells), 1, fabric, memory)
        scale = float(np.sqrt(cells / SCOUT_NODES))
        coarse = Fabric((scale * fabric.warp_spacing, scale * fabric.weft_spacing), fabric.initial_angle)
        reach = _reach(lay(part, coarse, point, direction, extent, threads, courses=courses, stop_at=stop_at), coarse)
    star, halves = start_fibres(surface, fabric, point, direction, counts, memory, courses)
    lattice, start = lay_generators(surface, fabric, star, halves, counts, memory, reach)
    settled, seconds = 0, 0.0
    while True:
        judge = Judge(surface, fabric, lattice, start, stop_at=stop_at, settle_every=settle_every)
        fill(surface, fabric, lattice, judge, threads, progress, settle_every=settle_every)
        start, settled, seconds = judge.start, settled + judge.settled, seconds + judge.seconds
        grow = _room_wanted(lattice, start, counts)
        if not any(grow):
            break
        lattice, start = _grown(lattice, start, grow, fabric, memory)
    if has_bays(lattice.status):
        judge = Judge(surface, fabric, lattice, start, stop_at=stop_at, settle_every=settle_every)
        covered = _with_bays(surface, fabric, lattice, judge, counts, memory, threads)
        if covered is not None:
            lattice, judge = covered
            start = judge.start
        settled, seconds = settled + judge.settled, seconds + judge.seconds
    return Laid(surface, depth, lattice, start, settled, seconds)


def _with_bays(
    surface: Surface, fabric: Fabric, lattice: Lattice, judge: Judge, counts: list[int], memory: int, threads: int
) -> tuple[Lattice, Judge] | None:
    """The lattice with cloth on arms that lie back towards the seed; None where there are none."""
    n_placed = np.count_nonzero(lattice.status == NodeStatus.PLACED)
    work = Lattice._make(array.copy() for array in lattice)
    # cloth beside the mould must not take the place, in the lattice, of cloth on an arm beyond
    trim(surface, fabric, work, judge.start, threads, hem=0)
    start = _generators_cut(work, judge.start)
    while True:
        judge = judge.on(work, start)
        fill_bays(surface, fabric, work, judge)
        start = judge.start
        grow = _room_wanted(work, start, counts)
        if not any(grow):
            break
        work, start = _grown(work, start, grow, fabric, memory)
        work.status[work.status == NodeStatus.NOT_REACHED] = NodeStatus.OUTSIDE
    return (work, judge) if np.count_nonzero(work.status == NodeStatus.PLACED) > n_placed else None


def _collar_depth(part: Surface, fabric: Fabric, extent: Extent | None, courses: Courses) -> float:
    """Depth of the collar, mm."""
    depth = COLLAR_DEPTH * fabric.longest
    for course, sides in zip(courses, ((0, 1), (2, 3)), strict=True):
        if course.turn is not None:
            longest = part.diagonal if extent is None else min(part.diagonal, max(extent[k] for k in sides))
            depth = max(depth, STRAY * longest)
    return depth


def _with_collar(part: Surface, depth: float, slit: float) -> Surface:
    """The surface with a collar; the last ones used are kept with it for the next drape of the same spacing."""
    kept: dict[tuple[float, float], Surface] = vars(part).setdefault("_collars", {})
    surface = kept.pop((depth, slit), None)
    if surface is None:
        surface = extended(part, depth, slit)
        while len(kept) >= COLLARS_KEPT:
            kept.pop(next(iter(kept)))
    kept[depth, slit] = surface
    return surface


def _reach(laid: Laid, fabric: Fabric) -> Extent:
    """How far the nodes on the mould reach from the seed (warp-, warp+, weft-, weft+), mm, and two cells more."""
    i, j = np.nonzero(laid.lattice.status == NodeStatus.PLACED)
    i0, j0 = (int(v) for v in laid.start.origin)
    return (
        (i0 - int(i.min()) + 2) * fabric.warp_spacing,
        (int(i.max()) - i0 + 2) * fabric.warp_spacing,
        (j0 - int(j.min()) + 2) * fabric.weft_spacing,
        (int(j.max()) - j0 + 2) * fabric.weft_spacing,
    )


def _room_wanted(lattice: Lattice, start: Start, counts: list[int]) -> tuple[int, int, int, int]:
    """Rows to add before and after, columns before and after: where a side has nodes on the mould, a quarter more."""
    status = lattice.status
    n_warp, n_weft = status.shape
    i0, j0 = (int(v) for v in start.origin)
    have = (i0, n_warp - 1 - i0, j0, n_weft - 1 - j0)
    most = (counts[2], counts[0], counts[3], counts[1])
    sides = (status[0], status[-1], status[:, 0], status[:, -1])
    length = (n_warp, n_warp, n_weft, n_weft)
    before_i, after_i, before_j, after_j = (
        min(max(8, n // 4), limit - got) if (side == NodeStatus.PLACED).any() else 0
        for side, n, limit, got in zip(sides, length, most, have, strict=True)
    )
    return before_i, after_i, before_j, after_j


def _grown(
    lattice: Lattice, start: Start, grow: tuple[int, int, int, int], fabric: Fabric, memory: int
) -> tuple[Lattice, Start]:
    before_i, after_i, before_j, after_j = grow
    n_warp, n_weft = lattice.status.shape
    shape = (n_warp + before_i + after_i, n_weft + before_j + after_j)
    check_memory(*shape, fabric, memory)
    larger = empty_lattice(shape)
    window = (slice(before_i, before_i + n_warp), slice(before_j, before_j + n_weft))
    larger.face[window], larger.status[window] = lattice.face, lattice.status
    larger.xy[window], larger.warp_out[window], larger.weft_out[window] = lattice.xy, lattice.warp_out, lattice.weft_out
    i0, j0 = start.origin[0] + before_i, start.origin[1] + before_j
    # nothing beyond a generator's end is ever on that generator
    larger.status[:, j0][np.r_[0:before_i, before_i + n_warp : shape[0]]] = NodeStatus.OUTSIDE
    larger.status[i0, :][np.r_[0:before_j, before_j + n_weft : shape[1]]] = NodeStatus.OUTSIDE
    # bent edges are known by their place in the lattice
    cell, family = start.bent_key // 2, start.bent_key % 2
    i, j = cell // n_weft + before_i, cell % n_weft + before_j
    moved = start._replace(origin=np.array([i0, j0]), bent_key=2 * (i * shape[1] + j) + family)
    return larger, moved


def _generators_cut(lattice: Lattice, start: Start) -> Start:
    """The start with generators that end where their nodes were taken back."""
    i0, j0 = (int(v) for v in start.origin)
    status = lattice.status
    halves = (status[i0 + 1 :, j0], status[i0, j0 + 1 :], status[:i0, j0][::-1], status[i0, :j0][::-1])
    ends = [np.flatnonzero(half > NodeStatus.OFF_MOULD) for half in halves]
    lengths = [int(end[0]) if len(end) else len(half) for end, half in zip(ends, halves, strict=True)]
    return start._replace(n_nodes=np.minimum(start.n_nodes, lengths))


def trim(surface: Surface, fabric: Fabric, lattice: Lattice, start: Start, threads: int, hem: int = HEM) -> None:
    """Take back the nodes on the extension farther than `hem` cells from one that touches the mould."""
    n_warp, n_weft = lattice.status.shape
    touching = np.empty((max(n_warp - 1, 0), max(n_weft - 1, 0)), dtype=np.bool_)
    rows = max(1, -(-(n_warp - 1) // (4 * threads)))
    run_kernel(
        emit.touching_cells,
        [
            (
                surface.unfolding,
                lattice,
                start,
                a,
                fabric.warp_spacing,
                fabric.weft_spacing,
                touching[a : a + rows],
            )
            for a in range(0, n_warp - 1, rows)
        ],
        threads,
    )
    emit.trim(lattice, touching, hem)
