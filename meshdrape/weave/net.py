"""A draped net: the lattice on the surface, and its nodes in space on first use."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import emit
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.prescribed import StartFibres
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.mould import Mould

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Request:
    """What a drape was asked besides fabric, start and start fibres; as for :func:`meshdrape.drape`.

    Attributes
    ----------
    engine : str
    extent : (warp-, warp+, weft-, weft+), mm, or None
    stop_at : float or None
        rad
    recrossing : bool
    """

    engine: str = "fast"
    extent: tuple[float, float, float, float] | None = None
    stop_at: float | None = None
    recrossing: bool = False


@dataclass(frozen=True, eq=False)
class Net:
    """The nodes of a sheet laid on a mould. i counts along the warp, j along the weft.

    Attributes
    ----------
    mould : Mould
    fabric : Fabric
    surface : Surface
        The draped part of the mould with its collar; the mould's faces come first.
    surface_face : (m,) int64
        Triangle of the mould behind each face of the draped part.
    lattice, start
        Places and edges as the kernels keep them.
    seed : (3,) mm, on the mould
    seed_distance : float
        How far the seed asked for lay from the mould, mm.
    direction : (3,) unit warp direction at the seed
    collar_depth : float
        How far the surface goes on past the mould's border, mm.
    start_fibres : StartFibres
        What was prescribed of the generators.
    request : Request
        What else was asked; its defaults of a net read back from a file, which does not hold it.
    notes : tuple of str
        What the user should know of how the net was laid.
    settled_by_libigl : int
        Nodes placed from libigl's distances.
    libigl_seconds : float
        What these took, and judging nodes near convex vertices, added up over the threads.
    threads : int
    """

    mould: Mould
    fabric: Fabric
    surface: Surface
    surface_face: NDArray[np.int64]
    lattice: Lattice
    start: Start
    seed: FloatArray
    seed_distance: float
    direction: FloatArray
    collar_depth: float = 0.0
    start_fibres: StartFibres = field(default_factory=StartFibres)
    request: Request = Request()
    notes: tuple[str, ...] = ()
    settled_by_libigl: int = 0
    libigl_seconds: float = 0.0
    threads: int = field(default=1, repr=False)

    @property
    def shape(self) -> tuple[int, int]:
        """(n_warp, n_weft)."""
        n_warp, n_weft = self.lattice.status.shape
        return n_warp, n_weft

    @property
    def seed_index(self) -> tuple[int, int]:
        """(i, j) of the seed node."""
        return int(self.start.origin[0]), int(self.start.origin[1])

    @property
    def generator_nodes(self) -> list[int]:
        """Nodes on +warp, +weft, -warp, -weft."""
        return [int(n) for n in self.start.n_nodes]

    @property
    def node_status(self) -> NDArray[np.uint8]:
        """NodeStatus of each node, (n_warp, n_weft) uint8."""
        return self.lattice.status

    @cached_property
    def node_position(self) -> FloatArray:
        """Nodes in space, (n_warp, n_weft, 3) mm; NaN where there is no node."""
        return self.positions(0, self.shape[0])

    @cached_property
    def _directions(self) -> tuple[FloatArray, FloatArray]:
        return self.directions(0, self.shape[0])

    @property
    def warp_direction(self) -> FloatArray:
        """Unit tangents of the warp towards larger i, (n_warp, n_weft, 3); NaN where there is no node."""
        return self._directions[0]

    @property
    def weft_direction(self) -> FloatArray:
        """Unit tangents of the weft towards larger j, (n_warp, n_weft, 3); NaN where there is no node."""
        return self._directions[1]

    def positions(self, first: int, last: int) -> FloatArray:
        """Nodes in space of the rows first <= i < last, (last - first, n_weft, 3) mm."""
        out = np.empty((last - first, self.shape[1], 3))
        for a, b in self.row_blocks(first, last):
            emit.positions(self.surface.unfolding, self.lattice, a, out[a - first : b - first])
        return out

    def directions(self, first: int, last: int) -> tuple[FloatArray, FloatArray]:
        """Unit tangents of warp and weft at the nodes of the rows first <= i < last, each (last - first, n_weft, 3).

        The mean of the edges on both sides of the node: second order in the spacing. A fibre without an edge at the
        node, of a single ribbon say, lies at the initial angle to the other, as one that nothing crosses leaves it.
        """
        warp = np.empty((last - first, self.shape[1], 3))
        weft = np.empty_like(warp)
        tasks = [
            (self.surface.unfolding, self.lattice, self.start, a, self.fabric.warp_spacing, self.fabric.weft_spacing,
             warp[a - first : b - first], weft[a - first : b - first])
            for a, b in self.row_blocks(first, last)
        ]  # fmt: skip
        self.in_threads(emit.directions, tasks)
        self._complete_directions(first, warp, weft)
        return warp, weft

    def _complete_directions(self, first: int, warp: FloatArray, weft: FloatArray) -> None:
        """Give the fibres that have no edge at a node a direction, in place."""
        placed = self.lattice.status[first : first + len(warp)] <= NodeStatus.OFF_MOULD
        for missing, other, angle in (
            (warp, weft, -self.fabric.initial_angle),
            (weft, warp, self.fabric.initial_angle),
        ):
            i, j = np.nonzero(placed & np.isnan(missing[..., 0]) & ~np.isnan(other[..., 0]))
            normal = self.surface.face_normal[self.lattice.face[first + i, j]]
            along = other[i, j]
            missing[i, j] = np.cos(angle) * along + np.sin(angle) * np.cross(normal, along)

    def row_blocks(self, first: int, last: int) -> Iterator[tuple[int, int]]:
        """Pieces (a, b) of the rows first <= i < last, small enough to balance over the threads."""
        rows = max(1, min(256, -(-(last - first) // max(1, 4 * self.threads))))
        for a in range(first, last, rows):
            yield a, min(a + rows, last)

    def in_threads(self, kernel: Callable[..., Any], tasks: Sequence[tuple[Any, ...]]) -> None:
        """Call a kernel that releases the lock with each argument tuple, on the net's threads."""
        run_kernel(kernel, tasks, self.threads)

    def count(self, status: NodeStatus) -> int:
        """Number of nodes of one status."""
        return int(np.count_nonzero(self.lattice.status == status))

    def __repr__(self) -> str:
        n_warp, n_weft = self.shape
        placed = self.count(NodeStatus.PLACED)
        return f"Net({n_warp} x {n_weft}, {placed} nodes on the mould, spacing {self.fabric.spacing} mm)"


def run_kernel(kernel: Callable[..., Any], tasks: Sequence[tuple[Any, ...]], threads: int) -> None:
    """Call a kernel with each argument tuple, on up to `threads` threads."""
    if threads == 1 or len(tasks) == 1:
        for task in tasks:
            kernel(*task)
        return
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(kernel, *task) for task in tasks]:
            done.result()
