"""Draping a wing and its spar from a row that stays on the wing, and reading it in the numbering of `CreaseNet`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from lattice import cells_at, nodes_at
from moulds import wing_spar
from numpy.typing import NDArray
from references import Crease, CreaseNet

import meshdrape

FloatArray = NDArray[np.float64]


class DrapedCrease(NamedTuple):
    """A drape beside its reference: nodes (n, rows, 3) in metres and signed cell shear (n - 1, rows - 1), rad."""

    net: meshdrape.Net
    reference: CreaseNet
    node: FloatArray
    shear: FloatArray

    def node_error(self, on_mould: NDArray[np.bool_] | None = None) -> float:
        off = np.linalg.norm(self.node - self.reference.node, axis=-1)
        return float(off.max() if on_mould is None else off[on_mould].max())

    def shear_error(self, cells: NDArray[np.bool_]) -> float:
        return float(np.abs(self.shear - self.reference.shear)[cells].max())


def facets(span: float, width: float) -> FloatArray:
    """Facet boundaries from half a facet before 0 to past `span`: the first chord is tangent to the crease at 0."""
    return (np.arange(int(np.ceil(span / width)) + 2) - 0.5) * width


def lay(
    crease: Crease,
    reference: CreaseNet,
    y: FloatArray,
    chord: float,
    height: float,
    seed_row: int,
    turn: float | None = None,
) -> DrapedCrease:
    """Drape along row `seed_row` from y = 0. Lengths in metres; facet boundaries at `y`; turn of the weft, rad."""
    mesh = wing_spar(
        lambda t: 1000 * crease.profile[0](t / 1000),
        lambda t: 1000 * crease.profile[1](t / 1000),
        1000 * y,
        1000 * chord,
        1000 * height,
    )
    spacing = reference.spacing
    net = meshdrape.drape(
        mesh.mould(),
        meshdrape.Fabric(1000 * spacing),
        (1000 * (seed_row + 0.5) * spacing, 0, 0),
        (0, 1, 0),
        weft_turn=turn,
    )
    return read(net, reference, seed_row)


def read(net: meshdrape.Net, reference: CreaseNet, seed_row: int, seed_column: int = 0) -> DrapedCrease:
    """The net's nodes and cells where the reference has them. The weft runs from larger x to smaller."""
    n, rows = reference.side.shape
    first = round(float(reference.x[0] / reference.spacing - 0.5))
    i = np.arange(n)[:, None] - seed_column
    j = seed_row - (first + np.arange(rows))[None]
    return DrapedCrease(
        net,
        reference,
        nodes_at(net, i, j) / 1000,
        # the cell of rows k and k + 1 lies between wefts j(k + 1) = j(k) - 1 and j(k)
        cells_at(net, meshdrape.measure(net).cell_shear, i[:-1], j[:, :-1] - 1),
    )
