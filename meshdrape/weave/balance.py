"""The curvature balance: shear foretold from the angle defects that a cell's fabric rectangle encloses.

It shares no code with the solver, so where the two agree both are right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.weave.curvature import enclosed_curvature
from meshdrape.weave.measures import Measures
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]

# Senses along warp and weft of the quadrant behind each of the four half-fibres, counter-clockwise.
QUADRANTS = ((1, 1), (-1, 1), (-1, -1), (1, -1))


@dataclass(frozen=True, eq=False)
class Balance:
    """Shear foretold and shear measured, cell by cell.

    Attributes
    ----------
    predicted : (n_warp - 1, n_weft - 1) rad
        Signed; NaN where the rectangle between the start fibres and the cell has missing cells.
    cell_defect : (n_warp - 1, n_weft - 1) rad
        Sum of the angle defects inside each cell.
    measures : Measures
    """

    predicted: FloatArray
    cell_defect: FloatArray
    measures: Measures

    @cached_property
    def residual(self) -> FloatArray:
        """Measured less predicted shear, (n_warp - 1, n_weft - 1) rad; NaN where there is no prediction."""
        return np.asarray(self.measures.cell_shear - self.predicted)

    @cached_property
    def worst_cell(self) -> tuple[int, int] | None:
        """(i, j) of the cell that touches the mould with the largest absolute residual; None if there is none."""
        off = np.abs(self.residual)
        off[~self.measures.cell_touches_mould] = -1.0
        off[np.isnan(off)] = -1.0
        if not off.size or off.max() < 0:
            return None
        i, j = np.unravel_index(int(np.argmax(off)), off.shape)
        return int(i), int(j)

    @property
    def worst(self) -> float:
        """Largest absolute residual of the cells that touch the mould, rad; 0 if there is none."""
        return 0.0 if self.worst_cell is None else float(abs(self.residual[self.worst_cell]))

    @property
    def worst_position(self) -> FloatArray | None:
        """Middle of that cell, (3,) mm."""
        if self.worst_cell is None:
            return None
        i, j = self.worst_cell
        return np.asarray(self.measures.net.positions(i, i + 2)[:, j : j + 2].reshape(-1, 3).mean(axis=0))


def balance(measures: Measures) -> Balance:
    """Predict the shear of every cell from angle defects alone.

    With geodesic start fibres the shear of a cell is the curvature between them and its centre (Hazzidakis 1879): on
    a polyhedron the defects in the rectangle, in full inside, one half in its last row and column, one quarter in the
    cell itself; those on a start fibre half to each side, the seed's in proportion to the four sectors. The sign is
    that of the quadrant.
    """
    net = measures.net
    n_i, n_j = measures.cell_shear.shape
    i0, j0 = net.seed_index
    curvature = enclosed_curvature(net)
    predicted = np.full((n_i, n_j), np.nan)
    initial = net.fabric.initial_angle
    whole = np.isfinite(measures.cell_shear)
    for half, (si, sj) in enumerate(QUADRANTS):
        rows = slice(i0, n_i) if si > 0 else slice(0, i0)
        columns = slice(j0, n_j) if sj > 0 else slice(0, j0)
        inner = curvature.inside[rows, columns][::si, ::sj]
        n, m = inner.shape
        if not n or not m:
            continue
        # row and column 0 hold what lies on the start fibres, before any cell of the quadrant
        held = np.zeros((n + 1, m + 1))
        held[1:, 1:] = inner
        held[1:, 0] = curvature.beside_warp[0 if sj > 0 else 1, rows][::si]
        held[0, 1:] = curvature.beside_weft[0 if si > 0 else 1, columns][::sj]
        # what the sector at the seed lacks: its share of the seed's defect, or an angle drawn otherwise
        held[0, 0] = (initial if si * sj > 0 else np.pi - initial) - float(net.start.sector[half])
        total = held.cumsum(axis=0).cumsum(axis=1)
        quadrant = 0.25 * (total[1:, 1:] + total[:-1, 1:] + total[1:, :-1] + total[:-1, :-1])
        gaps = ~whole[rows, columns][::si, ::sj]
        quadrant[np.logical_or.accumulate(np.logical_or.accumulate(gaps, axis=0), axis=1)] = np.nan
        predicted[rows, columns] = si * sj * quadrant[::si, ::sj]
    if net.start_fibres:
        warp, weft = (_turned(net, family) for family in (0, 1))
        predicted += warp[:, None] - weft[None, :]
    return Balance(predicted, curvature.by_cell, measures)


def _turned(net: Net, family: int) -> FloatArray:
    """Turn of a generator from its first edge on that side of the seed to each edge, (n_warp - 1,) or (n_weft - 1,)."""
    start, lattice = net.start, net.lattice
    i0, j0 = net.seed_index
    out = (lattice.warp_out[:, j0], lattice.weft_out[i0])[family]
    status = (lattice.status[:, j0], lattice.status[i0])[family]
    at = net.seed_index[family]
    turned = np.full(len(status) - 1, np.nan)
    for half, sense in ((family, 1), (family + 2, -1)):
        total = 0.0
        for k in range(len(status) - 1 - at if sense > 0 else at):
            edge = at + k if sense > 0 else at - k - 1
            if status[at + sense * (k + 1)] > NodeStatus.OFF_MOULD:
                break
            if k:
                total += _angle(start.arrival[half, k - 1], out[edge])
            turned[edge] = total
    return turned


def _angle(a: FloatArray, b: FloatArray) -> float:
    """From one plane direction to another, counter-clockwise, rad."""
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]))
