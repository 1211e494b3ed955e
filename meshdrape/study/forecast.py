"""How much shear a start would need, from the mould's curvature alone and before anything is draped."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.measures.cells import measure
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.mould import Mould

FloatArray = NDArray[np.float64]

# Fabric rectangles are told apart to this many over the cloth; shear at its ends changes by about one part in 30 then.
RECTANGLES = 900
# A mould across a spacing fewer times than this has no rectangles to speak of.
FEWEST = 8.0
# Nor does one this many times as long as its rectangles are wide: a thread, of whatever length, takes no longer.
MOST = 2000.0


@dataclass(frozen=True)
class Forecast:
    """The shear that the curvature between the start fibres asks for.

    Attributes
    ----------
    max_shear : float
        Largest absolute value, rad; pi / 2 or more where the cloth folds, 0 where no cell lies on the mould.
    position : (3,) mm
        Where.
    complete : bool
        Whether it could be told for every rectangle; no where the cloth folds before it gets there.
    seconds : float
        What the forecast took.
    """

    max_shear: float
    position: FloatArray
    complete: bool
    seconds: float


def forecast(
    mould: Mould,
    fabric: Fabric,
    seed: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    extent: tuple[float, float, float, float] | None = None,
) -> Forecast:
    """The largest shear that a start would need.

    The shear of a cell is the Gaussian curvature that its fabric rectangle encloses between the start fibres
    (Hazzidakis 1879). A wide lattice of some 900 rectangles, whatever the fabric's own spacing, tells which angle
    defects lie in which, and for cells whose rectangle has gaps their own shear.

    Parameters
    ----------
    mould, fabric, seed, direction, extent
        As for :func:`meshdrape.drape`.

    Raises
    ------
    StartError, FabricError
        As for :func:`meshdrape.drape`.
    """
    begun = time.perf_counter()
    bounded = mould.surface.area
    if extent is not None:
        bounded = min(bounded, (extent[0] + extent[1]) * (extent[2] + extent[3]))
    wide = min(float(np.sqrt(bounded / RECTANGLES)), mould.surface.diagonal / FEWEST)
    wide = max(wide, mould.surface.diagonal / MOST)
    spacing = (max(wide, fabric.warp_spacing), max(wide, fabric.weft_spacing))
    net = drape(mould, Fabric(spacing, fabric.initial_angle, fabric.locking_angle), seed, direction, extent=extent,
                threads=1)  # fmt: skip
    measures = measure(net)
    foretold = balance(measures)
    # where a rectangle has gaps, past a border or where the cloth folds, the wide cell itself tells the least there is
    told = np.where(np.isfinite(foretold.predicted), foretold.predicted, measures.cell_shear)
    counted = np.where(measures.cell_touches_mould, np.abs(told), np.nan)
    known = np.isfinite(counted)
    folded = np.argwhere(net.node_status == NodeStatus.FOLDED)
    if len(folded):
        # whatever was told before: the cells at these nodes would close
        first = folded[np.argmin(np.abs(folded - net.seed_index).sum(axis=1))]
        there = np.argwhere(net.node_status <= NodeStatus.OFF_MOULD)
        i, j = there[np.argmin(np.abs(there - first).sum(axis=1))].tolist()
        most = float(counted[known].max()) if known.any() else 0.0
        return Forecast(max(np.pi / 2, most), net.positions(i, i + 1)[0, j], False, time.perf_counter() - begun)
    if not known.any():
        return Forecast(0.0, net.seed, False, time.perf_counter() - begun)
    i, j = np.unravel_index(int(np.nanargmax(counted)), counted.shape)
    position = net.positions(int(i), int(i) + 2)[:, int(j) : int(j) + 2].reshape(-1, 3).mean(axis=0)
    missing = measures.cell_touches_mould & ~np.isfinite(foretold.predicted)
    return Forecast(
        max_shear=float(counted[i, j]),
        position=np.asarray(position),
        complete=not missing.any(),
        seconds=time.perf_counter() - begun,
    )
