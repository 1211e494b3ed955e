"""A closed outline, filled with triangles of its own corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def triangulate(points: FloatArray, normal: FloatArray) -> IntArray | None:
    """Triangulation (n - 2, 3) of a polygon seen along its normal; None where it overlaps itself as seen so.

    It is the same whichever corner comes first and however the polygon lies in space.
    """
    import mapbox_earcut

    # ears are cut off from the first corner on, and found along the first axis
    away = points - points.mean(axis=0)
    away -= np.outer(away @ normal, normal)
    first = int(np.argmax(np.einsum("ni,ni->n", away, away)))
    across = away[first] / max(float(np.linalg.norm(away[first])), np.finfo(float).tiny)
    order = np.roll(np.arange(len(points)), -first)
    flat = np.stack([away @ across, away @ np.cross(normal, across)], axis=1)[order]
    corners = mapbox_earcut.triangulate_float64(flat, np.array([len(flat)], dtype=np.uint32))
    ears = np.asarray(corners, dtype=np.int64).reshape(-1, 3)
    a, b, c = (flat[ears[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    whole = float(np.sum(flat[:, 0] * np.roll(flat[:, 1], -1) - np.roll(flat[:, 0], -1) * flat[:, 1]))
    covers = len(ears) == len(flat) - 2 and np.isclose(np.abs(area).sum(), whole, rtol=1e-9)
    if not covers or np.abs(area).min() <= 1e-12 * whole:
        return None
    ears[area < 0] = ears[area < 0][:, ::-1]
    return order[ears]
