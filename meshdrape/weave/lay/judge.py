"""Nodes on which the kernels cannot be relied: placed or judged by libigl, one at a time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from copy import copy
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.field import Place
from meshdrape.kernels.edges import WARP, WEFT, edge_ends, edge_key, keep_edge
from meshdrape.kernels.place import FOLD_SINE
from meshdrape.kernels.shear import past_stop
from meshdrape.kernels.sweep import FREE_WARP, FREE_WEFT, UNSURE, half_fibre
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.kernels.walk import off_mould
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.scan import scan
from meshdrape.weave.lay.settle import Edge, NodeSearch, Settled, shortest, step_from
from meshdrape.weave.start.generators import border_slack
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]

Sense = tuple[int, int]
"""Which way a kernel went through the lattice, +1 or -1 along warp and weft: a node's parents lie one step back."""


# How much longer than its edges the paths are among which a node is looked for: one judged is all but right, one
# that straight paths nearly reached is not far.
JUDGED, NEARLY = 0.02, 0.3


class Judge:
    """Decides the nodes at which a kernel stopped.

    Attributes
    ----------
    start : Start
        With the edges found so far that bend at a vertex. A kernel reads only edges it was itself given or that were
        done before it began, so it does not matter that the table is replaced while another runs.
    settled : int
        Nodes that libigl placed.
    seconds : float
        Spent on these nodes, added up over the threads.
    stop_at : float
        Shear at which the cloth stops, rad; pi for never.
    """

    def __init__(
        self,
        surface: Surface,
        fabric: Fabric,
        lattice: Lattice,
        start: Start,
        *,
        stop_at: float = np.pi,
        settle_every: bool = False,
    ) -> None:
        self.start = start
        self.settled = 0
        self.seconds = 0.0
        self.stop_at = stop_at
        self._surface, self._fabric, self._lattice = surface, fabric, lattice
        self._settle_every = settle_every
        self._slack = border_slack(fabric)
        self._lock = Lock()

    def on(self, lattice: Lattice, start: Start) -> Judge:
        """The same judge, and what it has counted, for another lattice."""
        other = copy(self)
        other.start, other._lattice, other._lock = start, lattice, Lock()
        return other

    def decide(self, node: tuple[int, int], why: int, sense: Sense) -> None:
        """Give a node (i, j) a place and its status for good; `why` is what the kernel reported."""
        i, j = node
        begun = time.perf_counter()
        if why in (FREE_WARP, FREE_WEFT):
            self._judge_free(i, j, sense, WARP if why == FREE_WARP else WEFT)
        elif why == UNSURE and not self._settle_every:
            self._judge(i, j, sense)
        else:
            self._settle(i, j, sense)
        with self._lock:
            self.seconds += time.perf_counter() - begun

    def _judge_free(self, i: int, j: int, sense: Sense, family: int) -> None:
        """Keep a node that one fibre alone holds, straight on, if there is no shorter way to it; else end it there."""
        parent = (i - sense[0], j) if family == WARP else (i, j - sense[1])
        length = self._fabric.warp_spacing if family == WARP else self._fabric.weft_spacing
        if shortest(self._surface, self._place(parent), self._place((i, j)), length):
            self._keep(i, j)
        else:
            self._lattice.status[i, j] = NodeStatus.OUTSIDE

    def _judge(self, i: int, j: int, sense: Sense) -> None:
        """Keep a node if there is no shorter way from either parent; else find the one that has none."""
        node = self._place((i, j))
        warp_parent, weft_parent = self._place((i - sense[0], j)), self._place((i, j - sense[1]))
        if shortest(self._surface, warp_parent, node, self._fabric.warp_spacing) and shortest(
            self._surface, weft_parent, node, self._fabric.weft_spacing
        ):
            self._keep_cell(i, j, sense)
            return
        found = self._search(i, j, sense, JUDGED).run(node, float(sense[0] * sense[1]))
        if found is None or self._folded(i, j, sense, found):
            self._settle(i, j, sense)
        else:
            self._write(i, j, sense, found)

    def _settle(self, i: int, j: int, sense: Sense) -> None:
        """Find a node that straight paths did not close on; without one the cloth folds there."""
        lattice, side = self._lattice, float(sense[0] * sense[1])
        guess = self._place((i, j))
        found = self._search(i, j, sense, NEARLY).run(guess, side)
        if found is None:
            search = self._search(i, j, sense)
            found = search.run(guess, side)
        beyond = self._beside_the_mould(i, j, sense)
        if found is None and not beyond:
            found = scan(search, self._place((i - sense[0], j - sense[1])), guess, side)
        if found is not None and self._round_the_border(found):
            found, beyond = None, True
        if found is None or self._folded(i, j, sense, found):
            # the extension is no mould: what fails on it is lost to it, not to the cloth
            lattice.status[i, j] = NodeStatus.OUTSIDE if beyond else NodeStatus.FOLDED
        else:
            self._write(i, j, sense, found)

    def _beside_the_mould(self, i: int, j: int, sense: Sense) -> bool:
        """Whether a node not found would lie on the extension: both parents do, or one and the ends of both its edges.

        There sheets of the extension may part, at a corner of the border.
        """
        status = self._lattice.status
        parents = [(i - sense[0], j), (i, j - sense[1])]
        off = [status[parent] == NodeStatus.OFF_MOULD for parent in parents]
        if all(off) or not any(off):
            return all(off)
        lengths = (self._fabric.warp_spacing, self._fabric.weft_spacing)
        mesh = self._surface.unfolding
        for family, parent, length in zip((WARP, WEFT), parents, lengths, strict=True):
            leave = edge_ends(mesh, self._lattice, self.start, family, *parent, sense[family], length)[:2]
            end = step_from(self._surface, self._place(parent), length * np.array(leave))
            if end is not None and not off_mould(mesh, *end, self._slack):
                return False
        return True

    def _round_the_border(self, found: Settled) -> bool:
        """Whether a node lies beside the mould, and the way to it goes round the end of the extension.

        At a corner of the mould's border sheets of the extension part, which no cloth goes round.
        """
        bends = [edge.bend for edge in (found.warp_edge, found.weft_edge) if edge.bend >= 0]
        ends_there = bool(self._surface.border_vertex[bends].any()) if bends else False
        return ends_there and bool(off_mould(self._surface.unfolding, *found.place, self._slack))

    def _folded(self, i: int, j: int, sense: Sense, found: Settled) -> bool:
        """Whether the cell of a node found folds at one of its corners."""
        mesh, lattice, fabric, side = self._surface.unfolding, self._lattice, self._fabric, sense[0] * sense[1]
        corner = (i - sense[0], j - sense[1])
        if lattice.status[corner] > NodeStatus.OFF_MOULD:
            return False
        tables = (mesh, lattice, self.start)
        to_a = edge_ends(*tables, WEFT, *corner, sense[1], fabric.weft_spacing)
        to_b = edge_ends(*tables, WARP, *corner, sense[0], fabric.warp_spacing)
        turns = [
            _cross(to_b[:2], to_a[:2]),
            _cross(found.warp_edge.leave, to_a[2:]),
            _cross(to_b[2:], found.weft_edge.leave),
            _cross(found.warp_edge.arrive, found.weft_edge.arrive),
        ]
        if corner == tuple(self.start.origin):
            turns[0] = side * float(np.sin(self.start.sector[half_fibre(*sense)]))
        return min(side * turn for turn in turns) < FOLD_SINE

    def _search(self, i: int, j: int, sense: Sense, slack: float | None = None) -> NodeSearch:
        fabric = self._fabric
        a, b = self._place((i - sense[0], j)), self._place((i, j - sense[1]))
        # where a kernel gave up, it left the end of the warp edge's path
        guess = self._place((i, j))
        return NodeSearch(self._surface, a, b, fabric.warp_spacing, fabric.weft_spacing, guess, slack=slack)

    def _place(self, at: tuple[int, int]) -> Place:
        x, y = self._lattice.xy[at]
        return int(self._lattice.face[at]), float(x), float(y)

    def _keep(self, i: int, j: int) -> None:
        off = off_mould(self._surface.unfolding, *self._place((i, j)), self._slack)
        self._lattice.status[i, j] = NodeStatus.OFF_MOULD if off else NodeStatus.PLACED

    def _keep_cell(self, i: int, j: int, sense: Sense) -> None:
        """Keep a node unless the cloth stops at its cell."""
        fabric, mesh = self._fabric, self._surface.unfolding
        self._keep(i, j)
        if self.stop_at < np.pi and past_stop(
            mesh, self._lattice, self.start, *sense, i, j,
            fabric.initial_angle, self.stop_at, fabric.warp_spacing, fabric.weft_spacing,
        ):  # fmt: skip
            self._lattice.status[i, j] = NodeStatus.STOPPED

    def _write(self, i: int, j: int, sense: Sense, found: Settled) -> None:
        lattice = self._lattice
        lattice.face[i, j], lattice.xy[i, j] = found.place[0], found.place[1:]
        for family, edge, parent, step in (
            (WARP, found.warp_edge, (i - sense[0], j), sense[0]),
            (WEFT, found.weft_edge, (i, j - sense[1]), sense[1]),
        ):
            keep_edge(lattice, self.start, family, *parent, step, *edge.leave, *edge.arrive)
            if edge.bent:
                self._keep_bent(family, (i, j), parent, edge)
        self._keep_cell(i, j, sense)
        with self._lock:
            self.settled += 1

    def _keep_bent(self, family: int, node: tuple[int, int], parent: tuple[int, int], edge: Edge) -> None:
        """Mark an edge, and keep its directions at both ends, in a table sorted by its number."""
        at = (min(node[0], parent[0]), min(node[1], parent[1]))
        kept = (self._lattice.warp_out, self._lattice.weft_out)[family]
        kept[at] *= 2.0 / np.linalg.norm(kept[at])
        axis, origin = (0, int(self.start.origin[0])) if family == WARP else (1, int(self.start.origin[1]))
        outward = abs(node[axis] - origin) > abs(parent[axis] - origin)
        ends = np.concatenate([edge.leave, edge.arrive] if outward else [-edge.arrive, -edge.leave])
        key = int(edge_key(self._lattice, family, *at))
        with self._lock:
            row = int(np.searchsorted(self.start.bent_key, key))
            self.start = self.start._replace(
                bent_key=np.insert(self.start.bent_key, row, key),
                bent_ends=np.insert(self.start.bent_ends, row, ends, axis=0),
            )


def _cross(u: Sequence[float] | FloatArray, v: Sequence[float] | FloatArray) -> float:
    return float(u[0] * v[1] - u[1] * v[0])
