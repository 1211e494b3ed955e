"""A closed outline, filled with triangles of its own corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Corners from which the cutting of ears is begun: from some a row of corners in line leaves an ear of no area.
MOST_TRIED = 8


def triangulate(points: FloatArray, normal: FloatArray) -> IntArray | None:
    """Triangulation (n - 2, 3) of a polygon seen along its normal; None where it overlaps itself as seen so.

    It is the same whichever corner comes first and however the polygon lies in space.
    """
    away = points - points.mean(axis=0)
    away -= np.outer(away @ normal, normal)
    reach = np.linalg.norm(away, axis=1)
    for first in np.argsort(-reach, kind="stable")[:MOST_TRIED].tolist():
        # ears are cut off from the first corner on, and found along the first axis
        across = away[first] / max(float(reach[first]), np.finfo(float).tiny)
        order = np.roll(np.arange(len(points)), -first)
        ears = _ears(np.stack([away @ across, away @ np.cross(normal, across)], axis=1)[order])
        if ears is not None:
            return order[ears]
    return None


def _ears(flat: FloatArray) -> IntArray | None:
    """Triangulation of a polygon in the plane; None where its triangles do not add up to it, or one has no area."""
    import mapbox_earcut

    corners = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], dtype=np.uint32))
    ears = np.asarray(corners, dtype=np.int64).reshape(-1, 3)
    a, b, c = (flat[ears[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    whole = float(np.sum(flat[:, 0] * np.roll(flat[:, 1], -1) - np.roll(flat[:, 0], -1) * flat[:, 1]))
    covers = len(ears) == len(flat) - 2 and np.isclose(np.abs(area).sum(), whole, rtol=1e-9)
    if not covers or np.abs(area).min() <= 1e-12 * whole:
        return None
    ears[area < 0] = ears[area < 0][:, ::-1]
    return ears
