"""The four quadrants between the generators, filled tile by tile on all threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from meshdrape.geodesic.detours import detours
from meshdrape.kernels.sweep import sweep
from meshdrape.kernels.tables import Lattice
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.judge import Judge
from meshdrape.weave.start.generators import border_slack

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
    return 1e-11 * fabric.shortest + round_off


def fill(
    surface: Surface,
    fabric: Fabric,
    lattice: Lattice,
    judge: Judge,
    threads: int,
    progress: Callable[[int], None] | None = None,
    *,
    settle_every: bool = False,
) -> None:
    """Place every node that its parents allow, outward from both generators.

    Each node depends on its parents alone, so the tiles' order, and with it the number of threads, changes nothing.

    Parameters
    ----------
    judge : Judge
        For the nodes that straight paths do not reach, or not surely.
    settle_every : bool
        Leave every node to it.
    """
    i0, j0 = (int(v) for v in judge.start.origin)
    n_warp, n_weft = lattice.status.shape
    spans = {1: (n_warp - 1 - i0, n_weft - 1 - j0), -1: (i0, j0)}
    tolerance = gap_tolerance(surface, fabric)
    slack = border_slack(fabric)
    mesh = surface.unfolding
    table = detours(surface, fabric.longest)

    def run(tile: _Tile) -> int:
        span_i, span_j = spans[tile.si][0], spans[tile.sj][1]
        report = np.zeros(5, dtype=np.int64)
        first_i = i0 + tile.si * (1 + tile.a * TILE)
        first_j = j0 + tile.sj * (1 + tile.b * TILE)
        count_i, count_j = min(TILE, span_i - tile.a * TILE), min(TILE, span_j - tile.b * TILE)
        while not sweep(
            mesh, table, lattice, judge.start, tile.si, tile.sj, first_i, count_i, first_j, count_j,
            fabric.warp_spacing, fabric.weft_spacing, fabric.initial_angle, judge.stop_at,
            tolerance, slack, settle_every, np.zeros((count_j, 2)), report,
        ):  # fmt: skip
            i, j, why = (int(v) for v in report[2:])
            judge.decide((i, j), why, (tile.si, tile.sj))
        return int(report[0])

    waiting: dict[_Tile, int] = {}
    for si in (1, -1):
        for sj in (1, -1):
            for a in range(-(-spans[si][0] // TILE)):
                for b in range(-(-spans[sj][1] // TILE)):
                    waiting[_Tile(si, sj, a, b)] = (a > 0) + (b > 0)
    placed = 0
    if threads == 1:
        for tile in waiting:  # after their parents, as they are listed
            placed += run(tile)
            if progress is not None:
                progress(placed)
        return
    with ThreadPoolExecutor(threads) as pool:
        running: dict[Future[int], _Tile] = {}
        for tile in [tile for tile, parents in waiting.items() if parents == 0]:
            running[pool.submit(run, tile)] = tile
        while running:
            finished, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in finished:
                tile = running.pop(future)
                placed += future.result()
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
