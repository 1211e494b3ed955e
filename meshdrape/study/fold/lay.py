"""One drape of a fold, and which of its cells belong to which region."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.answer import Shear
from meshdrape.study.fold.frame import Cloth
from meshdrape.study.fold.mould import FoldMould
from meshdrape.theory import NEITHER, RIBBON_FED, WING_FED
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import shear_of_cells
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]

# Where the cloth folds, warp and weft are within a degree of parallel: it has sheared by that much at least, rad.
FOLDED = math.radians(89.0)
# A node this near to the crease, in spacings, is on the spar.
ON_CREASE = 1e-6


@dataclass(frozen=True, eq=False)
class FoldDrape:
    """A draped fold, in the frame's coordinates. Rows run along the first index, from row 0 on the wing down the spar.

    Attributes
    ----------
    cloth : Cloth
    gamma : float, rad
    net : Net
    node : (columns, rows, 3) mm
        NaN where there is none.
    shear : (columns - 1, rows - 1) rad
        Signed.
    on_spar : (columns, rows) bool
        Nodes on the side laid second; where there is no node, as the row's last one before.
    region : (columns - 1, rows - 1) int8
        By each row's own history: 1 both rows of the cell start on the left-most ribbon, 2 both came over the crease,
        0 neither: on the wing, across the crease, or between a row of either kind.
    within : (columns - 1, rows - 1) bool
        Cells all of whose corners lie on the mould, within the height.
    lost : int
        Cells that lie on the mould with one corner and miss another: the cloth folds there, and ends.
    """

    cloth: Cloth
    gamma: float
    net: Net
    node: FloatArray
    shear: FloatArray
    on_spar: NDArray[np.bool_]
    region: NDArray[np.int8]
    within: NDArray[np.bool_]
    lost: int = 0

    def worst(self, region: int) -> tuple[float, tuple[int, int]]:
        """The largest |shear| of a region and its cell; 0 and (-1, -1) of a region without cells."""
        return _largest(self.shear, (self.region == region) & self.within)

    @cached_property
    def largest(self) -> Shear:
        """Of both regions."""
        return Shear(self.worst(WING_FED)[0], self.worst(RIBBON_FED)[0])

    @cached_property
    def first_sheet(self) -> float:
        """The largest |shear| of cells that lie wholly on the side laid first, rad."""
        on = self.on_spar
        clear = ~(on[:-1, :-1] | on[1:, :-1] | on[:-1, 1:] | on[1:, 1:])
        return _largest(self.shear, clear & self.within)[0]

    @property
    def asked(self) -> float:
        """What the cloth shears by anywhere but in cells that straddle the crease, rad; `FOLDED` where it folds."""
        return max(self.largest.largest, self.first_sheet, FOLDED if self.lost else 0.0)


def _largest(shear: FloatArray, cells: NDArray[np.bool_]) -> tuple[float, tuple[int, int]]:
    value = np.where(cells & np.isfinite(shear), np.abs(shear), -1.0)
    if not value.size or value.max() < 0:
        return 0.0, (-1, -1)
    i, r = np.unravel_index(int(np.argmax(value)), value.shape)
    return float(value[i, r]), (int(i), int(r))


def lay(cloth: Cloth, mould: FoldMould, gamma: float, locking_angle: float, threads: int | None = None) -> FoldDrape:
    """Drape from row 0, which stays on the wing, the left-most ribbon turned to `gamma` where it meets the crease.

    Turned right-handed about the spar's normal the ribbon leads, as it runs down, towards smaller y; gamma is counted
    towards larger y. Straight on it would run at the first facet's own ψ.
    """
    fabric = Fabric(cloth.spacing, locking_angle=locking_angle)
    turn = mould.psi_at_start() - gamma
    # rows that come back over the edge are told of by name; the net goes on, for all of it to be measured
    net = drape(
        mould.mould,
        fabric,
        cloth.seed,
        cloth.direction,
        extent=cloth.extent,
        weft_turn=turn,
        recrossing=True,
        threads=threads,
    )
    return read(cloth, mould, gamma, net)


def read(cloth: Cloth, mould: FoldMould, gamma: float, net: Net) -> FoldDrape:
    """The net in the numbering of the cloth, every cell with its region."""
    i, j = net.seed_index
    shape = (cloth.columns, cloth.rows)
    node = _window(net.node_position, i, j, (*shape, 3), np.nan)
    status = _window(net.node_status, i, j, shape, np.uint8(NodeStatus.OUTSIDE))
    shear = _window(shear_of_cells(net), i, j, (shape[0] - 1, shape[1] - 1), np.nan)
    on = _on_spar(cloth, mould, node)
    crease_z = np.interp(node[..., 1], mould.crease[:, 1], mould.crease[:, 2])
    frame = cloth.frame
    deep = on & ~(crease_z - node[..., 2] <= frame.height * (1 + 1e-9))
    kept = (status == NodeStatus.PLACED) & ~deep
    within = kept[:-1, :-1] & kept[1:, :-1] & kept[:-1, 1:] & kept[1:, 1:]
    ends = status >= NodeStatus.FOLDED
    ends, begun = (part[:-1, :-1] | part[1:, :-1] | part[:-1, 1:] | part[1:, 1:] for part in (ends, kept))
    lost = int(np.count_nonzero(ends & begun))
    return FoldDrape(cloth, gamma, net, node, shear, on, regions(on), within, lost)


def _window(values: NDArray[Any], i: int, j: int, shape: tuple[int, ...], missing: object) -> NDArray[Any]:
    out = np.full(shape, missing, dtype=values.dtype)
    part = values[i : i + shape[0], j : j + shape[1]]
    out[: part.shape[0], : part.shape[1]] = part
    return out


def _on_spar(cloth: Cloth, mould: FoldMould, node: FloatArray) -> NDArray[np.bool_]:
    x, y, z = node[..., 0], node[..., 1], node[..., 2]
    there = np.isfinite(x)
    beside = x - np.interp(y, mould.crease[:, 1], mould.crease[:, 0])
    below = np.interp(y, mould.crease[:, 1], mould.crease[:, 2]) - z
    # a node of the wing is beside the crease at its height, one of the spar below it; facets are off by 1e-4 mm
    here = beside - below < ON_CREASE * cloth.spacing
    # a row begins on the spar if it lies beyond the corner, whether its first node is on the mould or not
    corner = float(cloth.frame.fold.spar(0.0))
    here[0] = cloth.x < corner + ON_CREASE * cloth.spacing
    there[0] = True
    last = np.maximum.accumulate(np.where(there, np.arange(len(x))[:, None], 0), axis=0)
    return np.asarray(np.take_along_axis(here, last, axis=0))


def regions(on: NDArray[np.bool_]) -> NDArray[np.int8]:
    """Region of each cell, (n - 1, rows - 1), from which nodes lie on the spar, (n, rows).

    A row's present stretch on the spar began at its latest entry: at column 0 on the left-most ribbon, later over the
    crease. Cells beside a row that has been back on the wing since the row below it came over are torn: they belong to
    neither region.
    """
    column = np.arange(len(on))[:, None]
    new, left = on.copy(), np.zeros_like(on)
    new[1:] &= ~on[:-1]
    left[1:] = on[:-1] & ~on[1:]
    entry = np.maximum.accumulate(np.where(new, column, 0), axis=0)
    last_exit = np.maximum.accumulate(np.where(left, column, 0), axis=0)
    whole = on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:]
    upper, lower = entry[:-1, :-1] == 0, entry[:-1, 1:] == 0
    fed = np.where(upper & lower, RIBBON_FED, np.where(upper | lower, NEITHER, WING_FED))
    torn = last_exit[:-1, :-1] > entry[:-1, 1:]
    torn[np.nonzero(left)[0] - 1] = True
    return np.where(whole & ~torn, fed, NEITHER).astype(np.int8)
