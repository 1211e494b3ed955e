"""The four quadrants between the generators, filled tile by tile on all threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.sweep import FREE_WARP, FREE_WEFT, UNSURE, WARP, WEFT, edge_key, keep_edge, sweep
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.kernels.walk import off_mould
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.generators import border_slack
from meshdrape.weave.scan import scan
from meshdrape.weave.settle import NodeSearch, Place, shortest
from meshdrape.weave.status import NodeStatus

# A tile is large enough that handing it out costs nothing, small enough to keep both threads busy to the end.
TILE = 192


@dataclass(frozen=True)
class _Tile:
    si: int
    sj: int
    a: int
    b: int


def gap_tolerance(surface: Surface, fabric: Fabric) -> float:
    """Largest gap left between the ends of a node's two edges, mm: the round-off of places on the largest face."""
    round_off = 32 * float(np.finfo(float).eps) * surface.longest_edge
    return 1e-11 * min(fabric.warp_spacing, fabric.weft_spacing) + round_off


def fill(
    surface: Surface,
    fabric: Fabric,
    lattice: Lattice,
    start: Start,
    threads: int,
    progress: Callable[[int], None] | None = None,
    *,
    settle_every: bool = False,
) -> tuple[Start, int]:
    """Place every node that its parents allow, outward from both generators.

    Each node depends on its parents alone, so the tiles' order, and with it the number of threads, changes nothing.

    Parameters
    ----------
    settle_every : bool
        Have libigl place every node, not only those that straight paths do not reach.

    Returns
    -------
    start : Start
        With the bent edges of the nodes that libigl settled.
    settled : int
        Their number.
    """
    bent = BentEdges(start)
    i0, j0 = (int(v) for v in start.origin)
    n_warp, n_weft = lattice.status.shape
    spans = {1: (n_warp - 1 - i0, n_weft - 1 - j0), -1: (i0, j0)}
    tolerance = gap_tolerance(surface, fabric)
    slack = border_slack(fabric)
    mesh = surface.unfolding

    def run(tile: _Tile) -> tuple[int, int]:
        span_i, span_j = spans[tile.si][0], spans[tile.sj][1]
        report = np.zeros(5, dtype=np.int64)
        first_i = i0 + tile.si * (1 + tile.a * TILE)
        first_j = j0 + tile.sj * (1 + tile.b * TILE)
        count_i, count_j = min(TILE, span_i - tile.a * TILE), min(TILE, span_j - tile.b * TILE)
        settled = 0
        while not sweep(
            mesh, surface.detours, lattice, bent.start, tile.si, tile.sj, first_i, count_i, first_j, count_j,
            fabric.warp_spacing, fabric.weft_spacing, tolerance, slack, settle_every, report,
        ):  # fmt: skip
            i, j, why = (int(v) for v in report[2:])
            if why in (FREE_WARP, FREE_WEFT):
                _judge_free(surface, fabric, lattice, i, j, tile, slack, WARP if why == FREE_WARP else WEFT)
                continue
            unsure = why == UNSURE and not settle_every
            settled += _settle_node(surface, fabric, lattice, bent, i, j, tile, slack, unsure=unsure)
        return int(report[0]), settled

    waiting: dict[_Tile, int] = {}
    for si in (1, -1):
        for sj in (1, -1):
            for a in range(-(-spans[si][0] // TILE)):
                for b in range(-(-spans[sj][1] // TILE)):
                    waiting[_Tile(si, sj, a, b)] = (a > 0) + (b > 0)
    placed = settled = 0
    with ThreadPoolExecutor(threads) as pool:
        running: dict[Future[tuple[int, int]], _Tile] = {}
        for tile in [tile for tile, parents in waiting.items() if parents == 0]:
            running[pool.submit(run, tile)] = tile
        while running:
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                tile = running.pop(future)
                placed, settled = placed + future.result()[0], settled + future.result()[1]
                for child in (
                    _Tile(tile.si, tile.sj, tile.a + 1, tile.b),
                    _Tile(tile.si, tile.sj, tile.a, tile.b + 1),
                ):
                    if child in waiting:
                        waiting[child] -= 1
                        if waiting[child] == 0:
                            running[pool.submit(run, child)] = child
            if progress is not None:
                progress(placed)
    return bent.start, settled


class BentEdges:
    """The bent edges found so far, kept sorted in a `Start` that sweeps read.

    A sweep reads only edges of its own tile and of tiles done before it, so it does not matter that the table is
    replaced while another sweep runs.
    """

    def __init__(self, start: Start) -> None:
        self.start = start
        self._lock = Lock()

    def add(self, key: int, ends: NDArray[np.float64]) -> None:
        """Keep an edge's directions at both ends, (4,)."""
        with self._lock:
            at = int(np.searchsorted(self.start.bent_key, key))
            self.start = self.start._replace(
                bent_key=np.insert(self.start.bent_key, at, key),
                bent_ends=np.insert(self.start.bent_ends, at, ends, axis=0),
            )


def _judge_free(
    surface: Surface, fabric: Fabric, lattice: Lattice, i: int, j: int, tile: _Tile, slack: float, family: int
) -> None:
    """Keep a node that one fibre alone holds, straight on, if libigl has no shorter way to it; else it ends there."""
    parent = (i - tile.si, j) if family == WARP else (i, j - tile.sj)
    length = fabric.warp_spacing if family == WARP else fabric.weft_spacing
    if shortest(surface, _place(lattice, parent), _place(lattice, (i, j)), length):
        _set_status(surface, lattice, (i, j), slack)
    else:
        lattice.status[i, j] = NodeStatus.OUTSIDE


def _place(lattice: Lattice, at: tuple[int, int]) -> Place:
    return int(lattice.face[at]), float(lattice.xy[at][0]), float(lattice.xy[at][1])


def _set_status(surface: Surface, lattice: Lattice, at: tuple[int, int], slack: float) -> None:
    off = off_mould(surface.unfolding, *_place(lattice, at), slack)
    lattice.status[at] = NodeStatus.OFF_MOULD if off else NodeStatus.PLACED


def _settle_node(
    surface: Surface,
    fabric: Fabric,
    lattice: Lattice,
    bent: BentEdges,
    i: int,
    j: int,
    tile: _Tile,
    slack: float,
    *,
    unsure: bool,
) -> bool:
    """Have libigl place a node that straight paths did not close on, or judge one that it may reach by shorter ways.

    Returns whether the node is now where libigl put it.
    """
    a, b = (i - tile.si, j), (i, j - tile.sj)
    # where the sweep gave up, it left the end of the warp edge's path
    guess = _place(lattice, (i, j))
    ends = (_place(lattice, a), _place(lattice, b))
    length = (fabric.warp_spacing, fabric.weft_spacing)
    side = float(tile.si * tile.sj)
    found = None
    if unsure:
        if all(shortest(surface, tail, guess, size) for tail, size in zip(ends, length, strict=True)):
            _set_status(surface, lattice, (i, j), slack)
            return False
        found = NodeSearch(surface, *ends, *length, guess, narrow=True).run(guess, side)
    if found is None:
        search = NodeSearch(surface, *ends, *length, guess)
        found = search.run(guess, side)
        beyond = lattice.status[a] == NodeStatus.OFF_MOULD and lattice.status[b] == NodeStatus.OFF_MOULD
        if found is None and not beyond:
            found = scan(search, _place(lattice, (i - tile.si, j - tile.sj)), guess, side)
    if found is None:
        # the extension is no mould: what fails on it is lost to it, not to the cloth
        lattice.status[i, j] = NodeStatus.OUTSIDE if beyond else NodeStatus.FOLDED
        return False
    lattice.face[i, j], lattice.xy[i, j] = found.place[0], found.place[1:]
    for family, edge, parent, step in (
        (WARP, found.warp_edge, a, tile.si),
        (WEFT, found.weft_edge, b, tile.sj),
    ):
        keep_edge(lattice, bent.start, family, *parent, step, *edge.leave, *edge.arrive)
        if edge.bent:
            at = (min(i, parent[0]), min(j, parent[1]))
            kept = (lattice.warp_out, lattice.weft_out)[family]
            kept[at] *= 2.0 / np.linalg.norm(kept[at])
            bent.add(int(edge_key(lattice, family, *at)), np.concatenate([edge.leave, edge.arrive]))
    _set_status(surface, lattice, (i, j), slack)
    return True
