"""The curvature balance: shear foretold from the angle defects that a cell's fabric rectangle encloses.

It shares no code with the solver but the finding of cells, so where the two agree both are right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import locate
from meshdrape.weave.measures import Measures
from meshdrape.weave.net import Net
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]

# A vertex this near to a start fibre, in spacings, lies on it and counts half to each side.
ON_FIBRE = 1e-3


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

    @property
    def worst(self) -> float:
        """Largest absolute residual of the cells that touch the mould, rad; 0 if there is none."""
        off = np.abs(self.residual[self.measures.cell_touches_mould])
        off = off[np.isfinite(off)]
        return float(off.max()) if len(off) else 0.0


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
    defect, cell, on_warp, on_weft = _vertex_cells(measures)
    predicted = np.full((n_i, n_j), np.nan)
    inside = np.zeros((n_i, n_j))
    np.add.at(inside, (cell[:, 0], cell[:, 1]), defect)
    initial = net.fabric.initial_angle
    whole = np.isfinite(measures.cell_shear)
    for si, sj, half in ((1, 1, 0), (-1, 1, 1), (-1, -1, 2), (1, -1, 3)):
        rows = slice(i0, n_i) if si > 0 else slice(0, i0)
        columns = slice(j0, n_j) if sj > 0 else slice(0, j0)
        n, m = len(range(*rows.indices(n_i))), len(range(*columns.indices(n_j)))
        if not n or not m:
            continue
        # row and column 0 hold what lies on the start fibres; the seed is in both
        held = np.zeros((n + 1, m + 1))
        a = cell[:, 0] - i0 + 1 if si > 0 else i0 - cell[:, 0]
        b = cell[:, 1] - j0 + 1 if sj > 0 else j0 - cell[:, 1]
        a_at, b_at = np.where(on_weft, 0, a), np.where(on_warp, 0, b)
        here = ((a > 0) | on_weft) & ((b > 0) | on_warp) & (a_at <= n) & (b_at <= m)
        weight = np.where(on_warp | on_weft, 0.5, 1.0)
        np.add.at(held, (np.maximum(a_at, 0)[here], np.maximum(b_at, 0)[here]), (weight * defect)[here])
        # what the sector at the seed lacks: its share of the seed's defect, or an angle drawn otherwise
        held[0, 0] += (initial if si == sj else np.pi - initial) - float(net.start.sector[half])
        total = held.cumsum(axis=0).cumsum(axis=1)
        quadrant = 0.25 * (total[1:, 1:] + total[:-1, 1:] + total[1:, :-1] + total[:-1, :-1])
        gaps = ~whole[rows, columns][::si, ::sj]
        quadrant[gaps.cumsum(axis=0).cumsum(axis=1) > 0] = np.nan
        predicted[rows, columns] = si * sj * quadrant[::si, ::sj]
    if net.start_fibres:
        warp, weft = (_turned(net, family) for family in (0, 1))
        predicted += warp[:, None] - weft[None, :]
    return Balance(predicted, inside, measures)


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


def _vertex_cells(
    measures: Measures,
) -> tuple[FloatArray, NDArray[np.int64], NDArray[np.bool_], NDArray[np.bool_]]:
    """Defects of the vertices under the net, the cell over each, and whether it lies on the warp or weft generator."""
    net = measures.net
    surface, fabric = net.surface, net.fabric
    i0, j0 = net.seed_index
    curved = np.flatnonzero(~surface.border_vertex & (np.abs(surface.vertex_defect) > 1e-14))
    face = np.zeros(len(surface.vertices), dtype=np.int64)
    # any face of the star will do; the mould's own come first in the list and so win over the collar's
    face[surface.faces[::-1].ravel()] = np.repeat(np.arange(len(surface.faces))[::-1], 3)
    curved = curved[np.argsort(face[curved], kind="stable")]
    n = len(curved)
    first = np.empty((len(surface.faces), 2), dtype=np.int64)
    locate.first_nodes(surface.unfolding, net.lattice, first)
    cell = np.full((n, 2), -1)
    unwanted = np.empty((0, 3))
    at = face[curved]
    locate.read_cells(
        surface.unfolding, net.lattice, net.start, fabric.warp_spacing, fabric.weft_spacing, np.empty((2, 0, 0, 3)), at,
        surface.vertices[curved], surface.face_normal[at], first, cell, unwanted, unwanted,
    )  # fmt: skip
    seed_distance = np.linalg.norm(surface.vertices[curved] - net.seed, axis=1)
    kept = (cell[:, 0] >= 0) & (seed_distance > 1e-9 * fabric.warp_spacing)
    curved, cell = curved[kept], cell[kept]
    position = surface.vertices[curved]
    n_warp, n_weft = net.shape
    warp_fibre = net.positions_at(np.arange(n_warp), np.full(n_warp, j0))
    weft_fibre = net.positions_at(np.full(n_weft, i0), np.arange(n_weft))
    on_warp = _on_fibre(position, warp_fibre, fabric.warp_spacing)
    on_weft = _on_fibre(position, weft_fibre, fabric.weft_spacing)
    return surface.vertex_defect[curved], cell, on_warp, on_weft


def _on_fibre(points: FloatArray, fibre: FloatArray, spacing: float) -> NDArray[np.bool_]:
    """Whether each point lies on the chain of chords through a fibre's nodes."""
    from scipy.spatial import cKDTree

    nodes = fibre[np.isfinite(fibre).all(axis=1)]
    if not len(points) or len(nodes) < 2:
        return np.zeros(len(points), dtype=np.bool_)
    # the nearest node, then the chords on both sides of it
    _, at = cKDTree(nodes).query(points)
    nearest = np.full(len(points), np.inf)
    for step in (-1, 1):
        other = nodes[np.clip(at + step, 0, len(nodes) - 1)]
        along = other - nodes[at]
        length2 = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
        t = np.clip(np.einsum("ij,ij->i", points - nodes[at], along) / length2, 0, 1)
        nearest = np.minimum(nearest, np.linalg.norm(points - nodes[at] - t[:, None] * along, axis=1))
    return np.asarray(nearest < ON_FIBRE * spacing)
