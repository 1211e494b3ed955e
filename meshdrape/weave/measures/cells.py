"""What is measured on a net: shear cell by cell, coverage, the cloth it takes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import emit
from meshdrape.kernels.shear import cell_shear
from meshdrape.weave.measures.corners import corrections
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Measures:
    """Shear of a net and what follows from it. Made by :func:`measure`.

    Attributes
    ----------
    net : Net
    cell_shear : (n_warp - 1, n_weft - 1) rad
        Signed: initial angle less the angle from +warp to +weft, positive where that angle closes. NaN where a corner
        is missing.
    cell_touches_mould : (n_warp - 1, n_weft - 1) bool
        Cells that lie on the mould, wholly or in part; all the figures below speak of these alone.
    """

    net: Net
    cell_shear: FloatArray
    cell_touches_mould: NDArray[np.bool_]

    @cached_property
    def _counted(self) -> FloatArray:
        """Absolute shear where it counts, -1 elsewhere."""
        return np.where(self.cell_touches_mould, np.abs(self.cell_shear), -1.0)

    @property
    def n_cells(self) -> int:
        """Cells that touch the mould."""
        return int(np.count_nonzero(self.cell_touches_mould))

    @property
    def max_shear(self) -> float:
        """Largest absolute shear, rad; NaN for a net without cells."""
        return float(self._counted[self.max_shear_cell]) if self.n_cells else float("nan")

    @cached_property
    def max_shear_cell(self) -> tuple[int, int]:
        """(i, j) of the cell with the largest absolute shear."""
        i, j = np.unravel_index(int(np.argmax(self._counted)), self._counted.shape) if self._counted.size else (0, 0)
        return int(i), int(j)

    @property
    def max_shear_position(self) -> FloatArray:
        """Middle of that cell, (3,) mm."""
        i, j = self.max_shear_cell
        return np.asarray(self.net.positions(i, i + 2)[:, j : j + 2].reshape(-1, 3).mean(axis=0))

    @property
    def max_shear_face(self) -> int:
        """CAD face under that cell, 0 where the mould has none."""
        i, j = self.max_shear_cell
        lattice = self.net.lattice
        for a, b in ((i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)):
            if lattice.status[a, b] == NodeStatus.PLACED:
                face = int(lattice.face[a, b])
                if face < len(self.net.surface_face):
                    return int(self.net.mould.triangle_face[self.net.surface_face[face]])
        return 0

    @cached_property
    def over_locking_fraction(self) -> float:
        """Share of the draped area, by cell, whose absolute shear is above the locking angle; 0 to 1."""
        fabric = self.net.fabric
        shear = self.cell_shear[self.cell_touches_mould]
        area = np.sin(fabric.initial_angle - shear)
        total = float(area.sum())
        return float(area[np.abs(shear) > fabric.locking_angle].sum() / total) if total > 0 else 0.0

    @cached_property
    def cloth(self) -> tuple[float, float, float]:
        """Cloth needed: length along the warp and along the weft, mm, and area of the cells that touch the mould, mm2.

        The lengths bound the net in the flat sheet; the area is that of the undeformed cells. A single ribbon has
        nodes and no cells: its length counts.
        """
        fabric = self.net.fabric
        rows, columns = (np.flatnonzero(self.cell_touches_mould.any(axis=k)) for k in (1, 0))
        if not len(rows):
            i, j = np.nonzero(self.net.node_status == NodeStatus.PLACED)
            return float(np.ptp(i)) * fabric.warp_spacing, float(np.ptp(j)) * fabric.weft_spacing, 0.0
        cell = fabric.warp_spacing * fabric.weft_spacing * float(np.sin(fabric.initial_angle))
        return (
            float(rows[-1] - rows[0] + 1) * fabric.warp_spacing,
            float(columns[-1] - columns[0] + 1) * fabric.weft_spacing,
            self.n_cells * cell,
        )

    def node_shear(self, first: int, last: int) -> FloatArray:
        """Signed shear at the nodes of the rows first <= i < last, (last - first, n_weft) rad.

        The mean of the cells around each; NaN where there is none.
        """
        n_warp, n_weft = self.net.shape
        total = np.zeros((last - first, n_weft))
        count = np.zeros((last - first, n_weft))
        low, high = max(first - 1, 0), min(last, n_warp - 1)
        cells = self.cell_shear[low:high]
        there = np.isfinite(cells)
        value = np.where(there, cells, 0.0)
        for di in (0, 1):
            # the cell row i touches the node rows i and i + 1
            a, b = max(low + di, first), min(high + di, last)
            piece = slice(a - di - low, b - di - low)
            for dj in (0, 1):
                total[a - first : b - first, dj : n_weft - 1 + dj] += value[piece]
                count[a - first : b - first, dj : n_weft - 1 + dj] += there[piece]
        out = np.full_like(total, np.nan)
        np.divide(total, count, out=out, where=count > 0)
        return out


def measure(net: Net) -> Measures:
    """Shear of every cell of a net, and the figures drawn from it."""
    n_warp, _ = net.shape
    mesh, fabric = net.surface.unfolding, net.fabric
    shear = shear_of_cells(net)
    touching = np.empty(shear.shape, dtype=np.bool_)
    if shear.size:
        net.in_threads(
            emit.touching_cells,
            [
                (mesh, net.lattice, net.start, a, fabric.warp_spacing, fabric.weft_spacing, touching[a:b])
                for a, b in net.row_blocks(0, n_warp - 1)
            ],
        )
    return Measures(net, shear, touching)


def shear_of_cells(net: Net) -> FloatArray:
    """Signed shear of every cell, (n_warp - 1, n_weft - 1) rad, whether it touches the mould or not."""
    n_warp, n_weft = net.shape
    mesh, fabric = net.surface.unfolding, net.fabric
    shear = np.empty((max(n_warp - 1, 0), max(n_weft - 1, 0)))
    if shear.size:
        net.in_threads(
            cell_shear,
            [
                (
                    mesh,
                    net.lattice,
                    net.start,
                    a,
                    fabric.initial_angle,
                    fabric.warp_spacing,
                    fabric.weft_spacing,
                    shear[a:b],
                )
                for a, b in net.row_blocks(0, n_warp - 1)
            ],
        )
        for i, j, missing in corrections(net):
            shear[i, j] += missing
    return shear
