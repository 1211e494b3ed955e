"""A finished net checked again from what its file says, without the solver: one verdict."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshdrape.weave.measures.balance import Balance, balance
from meshdrape.weave.measures.cells import Measures, measure
from meshdrape.weave.recheck.edges import WARP, Audit, audit_edges, count_edges, sample_edges
from meshdrape.weave.recheck.rebuild import STRAIGHT, Rebuilt, rebuild
from meshdrape.weave.start.generators import BORDER_SLACK
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from typing import Protocol

    from meshdrape.mould import Mould
    from meshdrape.weave.recheck.rebuild import StoredNodes

    class StoredCells(StoredNodes, Protocol):
        """What a net's file says of its cells too."""

        @property
        def cell_shear(self) -> FloatArray:
            """(n_warp - 1, n_weft - 1) rad."""

        @property
        def predicted_shear(self) -> FloatArray:
            """Likewise, by the curvature balance."""


FloatArray = NDArray[np.float64]

# A node this far off the mould, in spacings, lies elsewhere: so near to the border it still counts as on it. So does a
# generator's node off the path traced anew, for the round-off of a direction grows along the fibre.
OFF, OFF_GENERATOR = 1.01 * BORDER_SLACK, 1e-7
# An edge this far from the shortest distance, relative, is not one: a second route round a vertex is nearer than that.
EDGE = 1e-7
# Shear that differs by this, rad, is not that of these nodes.
SHEAR = 1e-7
# Edges libigl measures in a second, at the most.
EDGES_PER_SECOND = 20_000


@dataclass(frozen=True)
class Recheck:
    """What was found.

    Attributes
    ----------
    n_nodes, n_off_mould : int
        Nodes on the mould, and on its extension.
    off_mould : float
        Largest distance of a node from the mould, in spacings.
    off_generator : float
        Largest distance of a generator's node from the straightest path traced anew, in spacings.
    n_edges : int
        Edges between nodes on the mould.
    n_straight : int
        Those off the generators that a straight path of one spacing joins; libigl has to vouch for the others.
    n_unchecked : int
        Edges with an end off the mould: they lie on its extension, which is not in the file.
    edges : Audit
        libigl's measures: of all edges that are not straight, then of a random sample.
    n_shear : int
        Cells on the mould whose shear was measured again.
    shear_error : float
        Its largest difference from the file's, rad.
    balance_error : float
        Largest difference from the file's predicted shear, rad.
    balance_residual : float
        Largest difference of measured and predicted shear, rad.
    failures : tuple of str
        What does not hold.
    seconds : float
    """

    n_nodes: int
    n_off_mould: int
    off_mould: float
    off_generator: float
    n_edges: int
    n_straight: int
    n_unchecked: int
    edges: Audit
    n_shear: int
    shear_error: float
    balance_error: float
    balance_residual: float
    failures: tuple[str, ...]
    seconds: float


def recheck(
    mould: Mould,
    stored: StoredCells,
    edges: int | None = None,
    seconds: float = math.inf,
    seed: int = 0,
    threads: int = 1,
) -> Recheck:
    """Check a stored net against the mould it was laid on.

    Every node's place on the mould, every generator's node on the straightest path, every other edge by a straight
    path aimed from node to node, edges by libigl, the shear of every cell on the mould and the curvature balance.

    Parameters
    ----------
    mould : Mould
    stored : StoredNet
        See :func:`meshdrape.read_net`.
    edges : int, optional
        How many libigl measures; default all that the time allows.
    seconds : float
        libigl stops after this long.
    seed : int
        Of the random sample.
    threads : int
        For the kernels; the answer does not depend on it.

    Returns
    -------
    Recheck
        Its ``failures`` are empty where the net holds.

    Raises
    ------
    StartError
        If the stored direction is none.
    """
    begun = time.perf_counter()
    rebuilt = rebuild(mould, stored, threads)
    net = rebuilt.net
    spacing = net.fabric.shortest
    status = stored.node_status
    on = status == NodeStatus.PLACED
    population = count_edges(on)
    failures = []

    off = _largest(rebuilt.off_surface[on]) / spacing
    if off > OFF:
        where = _where(rebuilt.off_surface, on, net.seed_index)
        failures.append(f"node {where} lies {off * spacing:.3g} mm off the mould")
    off_generator = _largest(rebuilt.off_generator) / spacing
    if off_generator > OFF_GENERATOR:
        where = _where(rebuilt.off_generator, np.isfinite(stored.node_position[..., 0]), net.seed_index)
        failures.append(f"generator node {where} lies {off_generator * spacing:.3g} mm off the straightest path")

    crooked, n_straight = _crooked(rebuilt, on)
    wanted = population if edges is None else edges
    sample = sample_edges(on, int(min(wanted, max(1.0, min(seconds, 1e6) * EDGES_PER_SECOND))),
                          np.random.default_rng(seed))  # fmt: skip
    first = [tuple(int(v) for v in edge) for edge in crooked]
    known = set(first)
    audited = audit_edges(net, [(f, i, j) for f, i, j in first] + [e for e in sample if e not in known],
                          population, seconds)  # fmt: skip
    if audited.max_relative_error > EDGE:
        failures.append(_edge_failure(audited, net.seed_index))
    if audited.n_edges + audited.n_through_vertex + audited.n_skipped < len(first):
        failures.append(f"{len(first):,} edges are not straight, more than libigl could measure in the time")

    measures = measure(net)
    checkable = _sure_cells(rebuilt, on)
    difference = np.where(checkable, np.abs(measures.cell_shear - stored.cell_shear), np.nan)
    # a cell the file has no shear for, or the net none
    difference[checkable & (np.isnan(measures.cell_shear) != np.isnan(stored.cell_shear))] = np.inf
    shear_error = _largest(difference)
    if shear_error > SHEAR:
        where = _where(difference, checkable, net.seed_index)
        failures.append(f"the shear of cell {where} is off by {math.degrees(shear_error):.3g} degrees")
    foretold, balance_error = _balance(measures, stored, checkable & ~_behind_crooked(rebuilt))
    if balance_error > SHEAR:
        failures.append(f"the predicted shear is off by {math.degrees(balance_error):.3g} degrees")
    every = count_edges(status <= NodeStatus.OFF_MOULD)
    return Recheck(
        n_nodes=int(np.count_nonzero(on)),
        n_off_mould=int(np.count_nonzero(status == NodeStatus.OFF_MOULD)),
        off_mould=off,
        off_generator=off_generator,
        n_edges=population,
        n_straight=n_straight,
        n_unchecked=every - population,
        edges=audited,
        n_shear=int(np.count_nonzero(np.isfinite(difference))),
        shear_error=shear_error,
        balance_error=balance_error,
        balance_residual=foretold.worst,
        failures=tuple(failures),
        seconds=time.perf_counter() - begun,
    )


def _largest(values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(known.max()) if len(known) else 0.0


def _where(values: FloatArray, among: NDArray[np.bool_], origin: tuple[int, int]) -> str:
    """The (i, j) of the largest value, counted from the seed."""
    i, j = np.unravel_index(int(np.argmax(np.where(among & ~np.isnan(values), values, -1.0))), values.shape)
    return f"({int(i) - origin[0]}, {int(j) - origin[1]})"


def _crooked(rebuilt: Rebuilt, on: NDArray[np.bool_]) -> tuple[NDArray[np.int64], int]:
    """Edges on the mould that no straight path of one spacing joins, (k, 3), and the number of the others."""
    fabric = rebuilt.net.fabric
    crooked, straight = [], 0
    for family, spacing in enumerate((fabric.warp_spacing, fabric.weft_spacing)):
        gap = rebuilt.edge_gap[family]
        head = np.zeros_like(on)
        if family == WARP:
            head[:-1] = on[1:]
        else:
            head[:, :-1] = on[:, 1:]
        there = on & head & ~np.isnan(gap)
        bad = there & ~(gap <= STRAIGHT * spacing)
        straight += int(np.count_nonzero(there & ~bad))
        crooked.append(np.column_stack([np.full(int(bad.sum()), family), *np.nonzero(bad)]))
    return np.concatenate(crooked), straight


def _sure_cells(rebuilt: Rebuilt, on: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells with all corners on the mould and no edge whose directions are unknown for its not being straight."""
    whole = on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:]
    fabric = rebuilt.net.fabric
    warp = ~(rebuilt.edge_gap[0] > STRAIGHT * fabric.warp_spacing)
    weft = ~(rebuilt.edge_gap[1] > STRAIGHT * fabric.weft_spacing)
    return np.asarray(whole & warp[:-1, :-1] & warp[:-1, 1:] & weft[:-1, :-1] & weft[1:, :-1])


def _behind_crooked(rebuilt: Rebuilt) -> NDArray[np.bool_]:
    """Cells whose rectangle from the seed holds an edge of unknown outline: what it encloses is not known."""
    net, gap = rebuilt.net, rebuilt.edge_gap
    i0, j0 = net.seed_index
    warp = gap[0] > STRAIGHT * net.fabric.warp_spacing
    weft = gap[1] > STRAIGHT * net.fabric.weft_spacing
    behind = warp[:-1, :-1] | warp[:-1, 1:] | weft[:-1, :-1] | weft[1:, :-1]
    for rows in (behind[i0:], behind[:i0][::-1]):
        for quadrant in (rows[:, j0:], rows[:, :j0][:, ::-1]):
            quadrant[:] = np.logical_or.accumulate(np.logical_or.accumulate(quadrant, axis=0), axis=1)
    return np.asarray(behind)


def _edge_failure(audited: Audit, origin: tuple[int, int]) -> str:
    family, i, j = audited.worst
    i, j = i - origin[0], j - origin[1]
    head = (i + 1, j) if family == WARP else (i, j + 1)
    return f"the edge ({i}, {j})-{head} is off by {audited.max_relative_error:.2g} of a spacing"


def _balance(measures: Measures, stored: StoredCells, checkable: NDArray[np.bool_]) -> tuple[Balance, float]:
    """The balance anew, and its largest difference from the stored one."""
    foretold = balance(measures)
    off = np.abs(foretold.predicted - stored.predicted_shear)
    return foretold, _largest(off[checkable])
