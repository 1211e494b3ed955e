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
        """Measured less predicted shear, rad; NaN where there is no prediction."""
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
        held[0, 0] = curvature.seed * float(net.start.sector[half] / net.start.sector.sum())
        total = held.cumsum(axis=0).cumsum(axis=1)
        quadrant = 0.25 * (total[1:, 1:] + total[:-1, 1:] + total[1:, :-1] + total[:-1, :-1])
        gaps = ~whole[rows, columns][::si, ::sj]
        quadrant[np.logical_or.accumulate(np.logical_or.accumulate(gaps, axis=0), axis=1)] = np.nan
        predicted[rows, columns] = si * sj * quadrant[::si, ::sj]
    return Balance(predicted, curvature.by_cell, measures)
