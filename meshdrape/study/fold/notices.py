"""Question 6: what to look at, with its place."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.answer import FoldWarning, Verdict
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.lay import FoldDrape
from meshdrape.theory import grazing_rows, returning_rows, separation_of_scales
from meshdrape.weave.fabric import LEAST_LOCKING

# Rows within this of the edge's direction graze it, rad.
GRAZING = math.radians(1.0)
# psi may change by this from ribbon to ribbon, rad, before a criterion that takes it for constant misleads.
COARSE = math.radians(0.5)


def notices(design: Design, drape: FoldDrape, verdict: Verdict) -> tuple[FoldWarning, ...]:
    """Everything there is to warn of."""
    frame = drape.cloth.frame
    fold, found = frame.fold, []

    def places(kind: str, stretches: list[tuple[float, float]], text: str) -> None:
        """One warning for all stretches of a kind, in the design's coordinates."""
        if not stretches:
            return
        ends = sorted(sorted((frame.station(a), frame.station(b))) for a, b in stretches)
        where = ", ".join(f"{a:,.0f} to {b:,.0f}" for a, b in ends)
        found.append(FoldWarning(kind, f"y = {where} mm: {text}", ends[0][0], ends[-1][1]))

    second = "wing" if frame.first == "spar" else "spar"
    for back in returning_rows(fold, drape.gamma):
        if back.turn > 1e-6:
            places(
                "returning",
                [(back.start, back.end)],
                f"ribbons that left the {frame.first} come back to it from the {second}, turned by up to "
                f"{math.degrees(back.turn):.2f} deg: ill-posed, the sheet cannot lie undeformed on the {frame.first}; "
                "begin at the other end or lay the other side first",
            )
    places(
        "grazing",
        [
            (start, end)
            for start, end in _joined(grazing_rows(fold, GRAZING))
            if end - start > design.spacing and np.ptp(fold.psi(np.linspace(start, end, 65))) > 1e-3 * GRAZING
        ],
        "rows run within 1 deg of the edge: where one crosses hangs on the spacing and on where the first row lies",
    )
    scales = separation_of_scales(fold, design.spacing, COARSE)
    places(
        "coarse",
        _joined(scales.coarse),
        f"psi changes by more than 0.5 deg from one ribbon to the next, by {math.degrees(scales.turn_change):.2f} deg "
        f"at y = {frame.station(scales.y):,.0f} mm: a spacing of {design.spacing:g} mm is too coarse for condition "
        "(24), and a criterion that takes psi for constant over a cell may be out by as much there",
    )
    if (verdict.criteria["characteristics"].largest <= design.locking_angle) != verdict.feasible:
        found.append(
            FoldWarning("verdict", "too close to call: drape and characteristic construction decide differently")
        )
    if design.locking_angle < LEAST_LOCKING:
        said = math.degrees(design.locking_angle)
        found.append(
            FoldWarning(
                "locking",
                f"no cloth locks at {said:g} deg; locking_angle_deg = {math.degrees(said):.3g} if that was radians",
            )
        )
    if drape.lost:
        node = drape.node[np.isfinite(drape.node).all(axis=-1)]
        found.append(
            FoldWarning(
                "drape",
                f"the cloth folds and ends before it covers the mould, {drape.lost:,} cells wide; it was laid up to "
                f"y = {frame.station(float(node[:, 1].max())):,.0f} mm, and what lies beyond is not known",
            )
        )
    if drape.cloth.width > (design.spar_height if frame.first == "spar" else design.chord):
        found.append(
            FoldWarning(
                "mould",
                f"no row stays on the {frame.first} all along the span: for the drape it was taken "
                f"{drape.cloth.width:,.0f} mm wide",
            )
        )
    return tuple(found)


def _joined(stretches: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Stretches in order, those that overlap made one."""
    joined: list[tuple[float, float]] = []
    for start, end in stretches.tolist():
        if joined and start <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(end, joined[-1][1])
        else:
            joined.append((start, end))
    return joined
