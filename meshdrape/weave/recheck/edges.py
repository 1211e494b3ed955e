"""Edges of a finished net measured again by libigl, which shares no code with the drape."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.distance import surface_distance
from meshdrape.surface import SurfacePoint
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

WARP, WEFT = 0, 1
# Ends that had to be moved by more than this share of the spacing to become vertices say nothing of the edge.
MOVED = 1e-11
# A shortest distance below the spacing by more than this share is a second route, not round-off.
SECOND_ROUTE = 1e-9

# So many edges are measured whatever the time, of at most so many tried: fewer are no sample.
LEAST, MOST_TRIED = 100, 200


@dataclass(frozen=True)
class Audit:
    """What libigl found.

    Attributes
    ----------
    n_edges : int
        Edges measured, the ones apart not counted.
    max_relative_error : float
        Largest |distance - spacing| / spacing among them; NaN if none was measured.
    worst : (family, i, j)
        That edge: 0 a warp edge (i, j)-(i + 1, j), 1 a weft edge (i, j)-(i, j + 1).
    n_second_routes : int
        Edges with a shorter way round a convex vertex, by more than 1e-9 of the spacing.
    n_through_vertex : int
        Generator edges in the sample that run through a vertex, or beside one with a shorter way round it. A
        straightest path need not be the shortest there, so they are kept apart.
    max_through_vertex : float
        Largest relative error among those.
    n_arcs : int
        Edges in the sample on which a start fibre bends as prescribed: one spacing along the fibre, less from end to
        end. There is nothing to measure.
    n_skipped : int
        Edges with an end too near to a triangle's side to be measured.
    n_population : int
        Edges the net has.
    seconds : float
        What measuring took; libigl and the kernels it needs were loaded before.
    """

    n_edges: int
    max_relative_error: float
    worst: tuple[int, int, int]
    n_second_routes: int
    n_through_vertex: int
    max_through_vertex: float
    n_arcs: int
    n_skipped: int
    n_population: int
    seconds: float


def audit(net: Net, edges: int = 1000, seed: int = 0, seconds: float = float("inf")) -> Audit:
    """Measure a random sample of a net's edges with libigl's exact geodesics.

    Parameters
    ----------
    net : Net
    edges : int
        Size of the sample; all edges if the net has no more.
    seed : int
        Of the random choice.
    seconds : float
        Stop after this long, with what has been measured, yet not below a hundred edges.
    """
    placed = net.node_status <= NodeStatus.OFF_MOULD
    sample = sample_edges(placed, edges, np.random.default_rng(seed))
    return audit_edges(net, sample, count_edges(placed), seconds)


def audit_edges(net: Net, sample: list[tuple[int, int, int]], population: int, seconds: float) -> Audit:
    """Measure given edges (family, i, j) of a net with libigl; stop after so many seconds, yet not below `LEAST`."""
    # the first question loads libigl, compiles what it needs and builds the mould's tables: before the clock runs
    for edge in sample[:1]:
        _length(net, *edge)
    begun = time.perf_counter()
    worst, worst_edge = float("nan"), (0, 0, 0)
    tried = measured = second = through = arcs = skipped = 0
    worst_through = 0.0
    for family, i, j in sample:
        generator = _generator_edge(net, family, i, j)
        if generator and net.start.arc[generator]:
            arcs += 1
            continue
        enough = measured >= LEAST or tried >= MOST_TRIED
        if enough and time.perf_counter() - begun > seconds:
            break
        tried += 1
        spacing = _spacing(net, family)
        distance, moved = _length(net, family, i, j)
        if moved > MOVED * spacing or not np.isfinite(distance):
            skipped += 1
            continue
        error = abs(distance - spacing) / spacing
        if generator and (net.start.through[generator] or distance < spacing * (1 - SECOND_ROUTE)):
            through += 1
            worst_through = max(worst_through, error)
            continue
        measured += 1
        second += distance < spacing * (1 - SECOND_ROUTE)
        if not error <= worst:
            worst, worst_edge = error, (family, i, j)
    return Audit(
        n_edges=measured,
        max_relative_error=worst,
        worst=worst_edge,
        n_second_routes=int(second),
        n_through_vertex=through,
        max_through_vertex=worst_through,
        n_arcs=arcs,
        n_skipped=skipped,
        n_population=population,
        seconds=time.perf_counter() - begun,
    )


def count_edges(placed: NDArray[np.bool_]) -> int:
    """Number of edges between nodes, (n_warp, n_weft), that are there."""
    return int(np.count_nonzero(placed[:-1] & placed[1:]) + np.count_nonzero(placed[:, :-1] & placed[:, 1:]))


def sample_edges(placed: NDArray[np.bool_], edges: int, rng: np.random.Generator) -> list[tuple[int, int, int]]:
    """Distinct edges (family, i, j) in random order, without ever listing all edges of a large net."""
    population = count_edges(placed)
    if population <= 4 * edges:
        warp = np.argwhere(placed[:-1] & placed[1:])
        weft = np.argwhere(placed[:, :-1] & placed[:, 1:])
        every = [(WARP, int(i), int(j)) for i, j in warp] + [(WEFT, int(i), int(j)) for i, j in weft]
        return [every[k] for k in rng.permutation(len(every))[:edges]]
    found: dict[tuple[int, int, int], None] = {}
    n_warp, n_weft = placed.shape
    while len(found) < edges:
        family = int(rng.integers(2))
        i = int(rng.integers(n_warp - (family == WARP)))
        j = int(rng.integers(n_weft - (family == WEFT)))
        if placed[i, j] and placed[i + (family == WARP), j + (family == WEFT)]:
            found[family, i, j] = None
    return list(found)


def _spacing(net: Net, family: int) -> float:
    return net.fabric.warp_spacing if family == WARP else net.fabric.weft_spacing


def _length(net: Net, family: int, i: int, j: int) -> tuple[float, float]:
    """Shortest distance between the ends of an edge, and how far they had to be moved to become vertices, mm."""
    tail, head = _point(net, i, j), _point(net, i + (family == WARP), j + (family == WEFT))
    return surface_distance(net.surface, tail, head, bound=_spacing(net, family))


def _point(net: Net, i: int, j: int) -> SurfacePoint:
    x, y = net.lattice.xy[i, j]
    return SurfacePoint.from_frame(net.surface, int(net.lattice.face[i, j]), float(x), float(y))


def _generator_edge(net: Net, family: int, i: int, j: int) -> tuple[int, int] | None:
    """Half-fibre and number of a generator's edge; None for any other edge."""
    i0, j0 = net.seed_index
    if family == WARP and j == j0:
        half, order = (0, i - i0) if i >= i0 else (2, i0 - i - 1)
    elif family == WEFT and i == i0:
        half, order = (1, j - j0) if j >= j0 else (3, j0 - j - 1)
    else:
        return None
    return (half, order) if order < net.start.n_nodes[half] else None
