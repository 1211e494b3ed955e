"""Question 2: where the shear is, along the edge and over the spar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.answer import Pair, SparMap, Where
from meshdrape.study.fold.lay import FoldDrape
from meshdrape.theory import RIBBON_FED, WING_FED, Fold, last_column

FloatArray = NDArray[np.float64]

STATIONS = 401


def where(drape: FoldDrape, locking_angle: float) -> Where:
    """Turn of the edge, shear along it, the cells that set the maxima, and the map of the spar."""
    frame = drape.cloth.frame
    fold = frame.fold
    y = np.linspace(0.0, fold.span, STATIONS)
    psi = fold.psi(y)
    crease = frame.to_design(np.stack([fold.spar(y), y, fold.wing(y)], axis=1))
    order = np.argsort(crease[:, 1])
    return Where(
        y=crease[order, 1],
        crease=crease[order],
        psi=psi[order],
        wing_fed=_wing_fed(fold, frame.height, y, psi)[order],
        ribbon_fed=_ribbon_fed(fold, frame.height, y, psi, drape.gamma)[order],
        worst_wing_fed=_pair(drape, WING_FED),
        worst_ribbon_fed=_pair(drape, RIBBON_FED),
        spar=_spar_map(drape, locking_angle),
    )


def _wing_fed(fold: Fold, height: float, y: FloatArray, psi: FloatArray) -> FloatArray:
    """Largest |ψ(y1) - ψ(y0)| over the rows y0 < y1 that the column of y1 meets within the height."""
    last = last_column(fold, height, y)
    rises = fold.spar.slope(y) > 0
    meets = (y[:, None] <= y[None]) & (y[None] <= last[:, None]) & rises[:, None]
    shear = np.where(meets, np.abs(psi[None] - psi[:, None]), -1.0).max(axis=0)
    return np.where(shear >= 0, shear, np.nan)


def _ribbon_fed(fold: Fold, height: float, y: FloatArray, psi: FloatArray, gamma: float) -> FloatArray:
    """|ψ - γ| where the column comes down to rows of the left-most ribbon within the height."""
    x = fold.spar(y)
    # where the crease has been lower before, the uppermost such row starts that far down the ribbon
    start = np.maximum(x[0] - np.minimum.accumulate(x), 0.0)
    place = fold.spar_edge(0.0) - 1j * np.exp(1j * gamma) * start + fold.tables.drift(y)
    depth = fold.depth(np.stack([place.real, place.imag], axis=-1))
    met = (depth <= height) & (place.real <= fold.spar.length * (1 + 1e-9))
    return np.where(met, np.abs(psi - gamma), np.nan)


def _pair(drape: FoldDrape, region: int) -> Pair | None:
    _, (i, r) = drape.worst(region)
    if i < 0:
        return None
    cloth = drape.cloth
    frame, fold = cloth.frame, cloth.frame.fold
    y_column = float(fold.wing.at_arc_length((i + 0.5) * cloth.spacing))
    y_row = 0.0
    if region == WING_FED:
        # the two rows' latest crossings before the cell, by the nodes on either side of the crease
        crossed = []
        for row in (r, r + 1):
            on = drape.on_spar[: i + 1, row]
            k = int(np.flatnonzero(~on).max()) if (~on).any() else 0
            ends = fold.wing.at_arc_length(cloth.spacing * np.array([k, k + 1]))
            x = fold.spar(ends)
            part = 0.5 if x[1] == x[0] else float(np.clip((cloth.x[row] - x[0]) / (x[1] - x[0]), 0, 1))
            crossed.append(float(ends[0] + part * (ends[1] - ends[0])))
        y_row = sum(crossed) / 2
    middle = drape.node[i : i + 2, r : r + 2].reshape(-1, 3).mean(axis=0)
    return Pair(
        float(drape.shear[i, r]), frame.station(y_row), frame.station(y_column), np.asarray(frame.to_design(middle))
    )


def _spar_map(drape: FoldDrape, locking_angle: float) -> SparMap:
    """Rows from the first that comes near the spar, so that the map is no larger than it has to be."""
    frame, fold = drape.cloth.frame, drape.cloth.frame.fold
    top = int(np.argmax(drape.on_spar.any(axis=0)))
    on = drape.on_spar[:, top:]
    node = np.where(on[..., None], drape.node[:, top:], np.nan)
    y = np.where(np.isfinite(node[..., 1]), node[..., 1], 0.0)
    flat = np.stack([np.where(np.isfinite(node[..., 1]), fold.spar.arc_length(y), np.nan), node[..., 2]], axis=-1)
    whole = on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:] & drape.within[:, top:]
    shear = np.where(whole, drape.shear[:, top:], np.nan)
    region = np.where(whole, drape.region[:, top:], 0).astype(np.int8)
    started = drape.on_spar[0]
    boundary = drape.node[:, int(np.argmax(started))] if started.any() else np.empty((0, 3))
    deep = drape.on_spar[:, int(np.argmax(started))] if started.any() else np.empty(0, dtype=np.bool_)
    boundary = boundary[np.isfinite(boundary).all(axis=1) & deep]
    return SparMap(
        node=frame.to_design(node),
        flat=flat,
        shear=shear,
        margin=locking_angle - np.abs(shear),
        region=region,
        boundary=frame.to_design(boundary),
    )
