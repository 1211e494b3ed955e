"""The net made light enough to draw: blocks of cells, and some fibres."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.fibres import every_nth, round_step, warp_fibres, weft_fibres
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.weave.measures.cells import Measures
    from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]

_MOST_QUADS: Final = 300_000


@dataclass(frozen=True, eq=False)
class DrawnCells:
    """Quads that stand for the cells of a net.

    Attributes
    ----------
    corners : (n, 4, 3) float64, mm
        Counter-clockwise about the mould's normal.
    shear : (n,) float64, rad
        The largest absolute shear of the cells behind each, NaN where none is known.
    block : int
        A quad stands for up to block x block cells.
    """

    corners: FloatArray
    shear: FloatArray
    block: int

    @property
    def normals(self) -> FloatArray:
        """Unit normals, (n, 3)."""
        size = np.linalg.norm(self._twice_area, axis=1)[:, None]
        return np.asarray(self._twice_area / np.maximum(size, 1e-300))  # a cell folded flat has none

    @property
    def areas(self) -> FloatArray:
        """Areas, (n,), mm2."""
        return np.asarray(0.5 * np.linalg.norm(self._twice_area, axis=1))

    @property
    def _twice_area(self) -> FloatArray:
        c = self.corners
        return np.cross(c[:, 2] - c[:, 0], c[:, 3] - c[:, 1])


def drawn_cells(net: Net, measures: Measures, most: int = _MOST_QUADS) -> DrawnCells:
    """Return at most `most` quads that show a net.

    Up to that many cells are drawn one by one. Of a larger net a quad shows a block, by its largest shear, so
    that no peak is lost; blocks at the net's outline that are not full are drawn cell by cell, as long as
    they are few.
    """
    there = net.node_status <= NodeStatus.OFF_MOULD
    whole = there[:-1, :-1] & there[1:, :-1] & there[1:, 1:] & there[:-1, 1:]
    n_cells = int(whole.sum())
    block = 1 if n_cells <= most else int(np.ceil(np.sqrt(n_cells / (0.8 * most))))
    shear = np.where(whole & np.isfinite(measures.cell_shear), np.abs(measures.cell_shear), -1.0)
    full = np.asarray(_in_blocks(whole, block, True).all(axis=(1, 3)))
    worst = _in_blocks(shear, block, -1.0).max(axis=(1, 3))
    alone = whole & ~full.repeat(block, axis=0).repeat(block, axis=1)[: len(whole), : whole.shape[1]]
    if alone.sum() > 0.2 * most:
        alone[:] = False
    corners, values = [], []
    for row in range(len(full)):
        i0, i1 = row * block, min((row + 1) * block, len(whole))
        points = net.positions(i0, i1 + 1)
        j0 = np.flatnonzero(full[row]) * block
        j1 = np.minimum(j0 + block, whole.shape[1])
        corners.append(np.stack([points[0, j0], points[-1, j0], points[-1, j1], points[0, j1]], axis=1))
        values.append(worst[row, full[row]])
        i, j = np.nonzero(alone[i0:i1])
        corners.append(np.stack([points[i, j], points[i + 1, j], points[i + 1, j + 1], points[i, j + 1]], axis=1))
        values.append(shear[i0 + i, j])
    drawn = np.concatenate([*values, np.empty(0)])
    return DrawnCells(np.concatenate([*corners, np.empty((0, 4, 3))]), np.where(drawn < 0, np.nan, drawn), block)


def drawn_fibres(net: Net, gap: float, block: int) -> tuple[FloatArray, FloatArray, tuple[int, int]]:
    """Return segments of warp and of weft fibres, (n, 2, 3) each, mm, and the step from fibre to fibre.

    The fibres run along the edges of the drawn quads.

    Parameters
    ----------
    net : Net
    gap : float
        Least distance from fibre to fibre, mm.
    block : int
        Of the drawn cells.
    """
    fabric, shape, seed = net.fabric, net.node_status.shape, net.seed_index
    between_warp = block * round_step(gap / fabric.weft_spacing / block)
    between_weft = block * round_step(gap / fabric.warp_spacing / block)
    # the seed's fibre, or the block edge next to it
    j = every_nth(shape[1], between_warp, seed[1] // block * block)
    i = every_nth(shape[0], between_weft, seed[0] // block * block)
    warp = _segments(warp_fibres(net, j)[:, ::block])
    weft = _segments(weft_fibres(net, i)[:, ::block])
    return warp, weft, (between_warp, between_weft)


def _segments(position: FloatArray) -> FloatArray:
    """Return the steps along fibres (n_fibres, n_nodes, 3) whose two ends are there, (n, 2, 3)."""
    there = ~np.isnan(position[..., 0])
    joined = there[:, :-1] & there[:, 1:]
    return np.stack([position[:, :-1][joined], position[:, 1:][joined]], axis=1)


def _in_blocks(cells: NDArray[Any], block: int, fill: float) -> NDArray[Any]:
    """Return cells (n, m) cut into blocks, filled up to whole ones, (blocks, block, blocks, block)."""
    missing = [(0, -size % block) for size in cells.shape]
    padded = np.pad(cells, missing, constant_values=fill)
    return padded.reshape(padded.shape[0] // block, block, padded.shape[1] // block, block)
