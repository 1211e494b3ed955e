"""The curvature balance: shear foretold from the angle defects that a cell's fabric rectangle encloses.

It shares no code with the solver, so where the two agree both are right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.weave.measures.cells import Measures
from meshdrape.weave.measures.curvature import Curvature, enclosed_curvature
from meshdrape.weave.measures.excess import Sides, corner_excess, laid_flat
from meshdrape.weave.measures.turning import turning
from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]

# Share of the defects in a cell's last row and column that may be put on the wrong side of its middle: their vertices
# are placed by straight distances, as if the cell were flat but for them, and the parts of several are added up. On
# meshes of every kind it is below a hundredth; a fifteenth where the cloth folds.
OPEN_SHARE = 0.1
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
    def open(self) -> float:
        """What the balance leaves open at that cell, rad: as much as where defects lie in their cells may be off."""
        if self.worst_cell is None:
            return 0.0
        (i, j), (i0, j0) = self.worst_cell, self.measures.net.seed_index
        rows, columns = slice(min(i, i0), max(i + 1, i0)), slice(min(j, j0), max(j + 1, j0))
        beside = np.abs(self.cell_defect[i, columns]).sum() + np.abs(self.cell_defect[rows, j]).sum()
        return OPEN_SHARE * float(beside) / 2

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
    a polyhedron the defects in the rectangle, in full inside; of those in its last row and column the part beyond
    which the cell lies, on the average one half, and of those in the cell itself one quarter; those on a start fibre
    half to each side, the seed's in proportion to the four sectors. The sign is that of the quadrant.

    Notes
    -----
    Gauss and Bonnet's theorem says what the four corners of each cell are off in all, and that those about each node
    make 2 pi less its defect. So the angle at a cell's first corner, the one nearest to the seed, is exactly what the
    seed's was, less all that the rectangle before it holds, less the excess of one corner of every cell before it in
    its row, and of another in its column (:func:`meshdrape.weave.measures.excess.corner_excess`), less the turns of the
    start fibres. Where two vertices lie in one cell their parts are added up, to the product of their defects.
    """
    net = measures.net
    n_i, n_j = measures.cell_shear.shape
    i0, j0 = net.seed_index
    curvature = enclosed_curvature(net)
    by_cell = curvature.by_cell
    predicted = np.full((n_i, n_j), np.nan)
    whole = np.isfinite(measures.cell_shear)
    turn = [turning(net, half) for half in range(4)]
    side = _generator_sides(net, curvature)
    for half, (si, sj) in enumerate(QUADRANTS):
        rows = slice(i0, n_i) if si > 0 else slice(0, i0)
        columns = slice(j0, n_j) if sj > 0 else slice(0, j0)
        gaps = ~whole[rows, columns][::si, ::sj]
        if not gaps.size:
            continue
        along, up = (0 if si > 0 else 2), (1 if sj > 0 else 3)
        # what the sector at the seed lacks: its share of the seed's defect, or an angle drawn otherwise
        square = net.fabric.initial_angle if si * sj > 0 else np.pi - net.fabric.initial_angle
        lacks = square - float(net.start.sector[half])
        # the quadrant lies to the left of one of its half-fibres and to the right of the other
        left = 0 if si * sj > 0 else 1
        along_warp = lacks + _so_far(turn[along][:, left], gaps.shape[0])
        along_weft = lacks + _so_far(turn[up][:, 1 - left], gaps.shape[1])
        own = side[along], side[up]
        row, column = _excess(net, curvature, (si, sj), own, ~gaps)
        _add_short_sides(net, own, square, along_warp, along_weft, row, column)
        held = by_cell[rows, columns][::si, ::sj]
        first = along_warp[:, None] + along_weft[None, :] - lacks
        first[1:, 1:] += held.cumsum(axis=0).cumsum(axis=1)[:-1, :-1]
        first[1:] += row.cumsum(axis=0)[:-1]
        first[:, 1:] += column.cumsum(axis=1)[:, :-1]
        # from the first corner to the mean of all four
        quadrant = first + 0.5 * (row + column) - 0.25 * held
        quadrant[np.logical_or.accumulate(np.logical_or.accumulate(gaps, axis=0), axis=1)] = np.nan
        predicted[rows, columns] = si * sj * quadrant[::si, ::sj]
    return Balance(predicted, by_cell, measures)


def _so_far(turn: FloatArray, n: int) -> FloatArray:
    """Sum of a half-fibre's turns up to the first corner of each cell beside it, (n,) rad."""
    every = np.zeros(n)
    known = turn[: n - 1].cumsum()
    every[1 : len(known) + 1] = known
    every[len(known) + 1 :] = known[-1] if len(known) else 0.0
    return every


def _generator_sides(net: Net, curvature: Curvature) -> list[FloatArray]:
    """Length of each edge of the four half-fibres, mm: one spacing, but of a bent one the chord's."""
    fabric = net.fabric
    sides = [np.full(max(net.shape), (fabric.warp_spacing, fabric.weft_spacing)[half % 2]) for half in range(4)]
    for chord in curvature.chords:
        sides[chord.half][chord.order] = chord.length
    return sides


def _excess(
    net: Net,
    curvature: Curvature,
    sense: tuple[int, int],
    side: tuple[FloatArray, FloatArray],
    whole: NDArray[np.bool_],
) -> tuple[FloatArray, FloatArray]:
    """Excess of the two corners beside the first of each cell of a quadrant for what lies in it, each (n, m) rad.

    Parameters
    ----------
    side : (n,), (m,) mm
        Edges of the quadrant's warp and weft half-fibre.
    whole : (n, m) bool
        Cells of the quadrant that have all their corners.
    """
    fabric, surface, lattice = net.fabric, net.surface, net.lattice
    at = np.stack(
        [
            (cell - origin) if step > 0 else (origin - 1 - cell)
            for cell, origin, step in zip(curvature.cell.T, net.seed_index, sense, strict=True)
        ],
        axis=1,
    )
    mine = np.flatnonzero(((at >= 0) & (at < whole.shape)).all(axis=1))
    mine = mine[whole[tuple(at[mine].T)]]
    at, vertex, part = at[mine], curvature.vertex[mine], curvature.part[mine]
    corner = np.array(net.seed_index) + at * sense
    place = surface.vertices[vertex]
    frame = surface.unfolding.frame

    def distance(di: int, dj: int) -> FloatArray:
        i, j = (corner + np.array([di, dj]) * sense).T
        face, xy = frame[lattice.face[i, j]], lattice.xy[i, j]
        node = face[:, :3] + xy[:, :1] * face[:, 3:6] + xy[:, 1:] * face[:, 6:9]
        return np.asarray(np.linalg.norm(place - node, axis=1))

    warp, weft = fabric.warp_spacing, fabric.weft_spacing
    sides = Sides(
        np.where(at[:, 1] == 0, side[0][at[:, 0]], warp), np.where(at[:, 0] == 0, side[1][at[:, 1]], weft), warp, weft
    )
    where, angle = laid_flat(sides, distance(0, 0), distance(1, 0), distance(0, 1))
    row, column = np.zeros(whole.shape), np.zeros(whole.shape)
    for total, excess, flat in zip(
        (row, column), corner_excess(sides, angle, part, where), corner_excess(sides, angle), strict=True
    ):
        np.add.at(total, tuple(at.T), excess - flat)
    return row, column


def _add_short_sides(
    net: Net,
    side: tuple[FloatArray, FloatArray],
    square: float,
    along_warp: FloatArray,
    along_weft: FloatArray,
    row: FloatArray,
    column: FloatArray,
) -> None:
    """Add what the cells beside a start fibre have for a bent edge that is shorter than the one across.

    Parameters
    ----------
    side : (n,), (m,) mm
        Edges of the warp and of the weft half-fibre.
    square : float
        Angle of the quadrant's unsheared cells, rad.
    along_warp, along_weft : (n,), (m,) rad
        Shear at the first corners of the cells beside them, but for what `row` and `column` hold.
    row, column : (n, m)
        Changed in place.
    """
    warp, weft = net.fabric.warp_spacing, net.fabric.weft_spacing
    cells = [((k, 0), side[0][k], side[1][0] if k == 0 else weft) for k in range(len(row))]
    cells += [((0, k), warp, side[1][k]) for k in range(1, row.shape[1])]
    for (i, j), own_warp, own_weft in cells:
        if (own_warp, own_weft) == (warp, weft):
            continue
        shear = along_warp[i] + row[:i, 0].sum() if j == 0 else along_weft[j] + column[0, :j].sum()
        excess = corner_excess(Sides(own_warp, own_weft, warp, weft), square - shear)
        row[i, j] += excess[0]
        column[i, j] += excess[1]
