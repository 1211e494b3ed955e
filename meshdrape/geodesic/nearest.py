"""Which face of a surface a point in space lies on, for many points at once, through libigl's tree of boxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def nearest_faces(vertices: FloatArray, faces: IntArray, points: FloatArray) -> tuple[IntArray, FloatArray]:
    """The face nearest to each point and its distance: (k,) int64 and (k,) mm. O(k log n_faces).

    A point that is not finite is infinitely far from face 0.

    Parameters
    ----------
    vertices : (n, 3), faces : (m, 3), points : (k, 3)
    """
    if not len(points) or not len(faces):
        return np.zeros(len(points), dtype=np.int64), np.full(len(points), np.inf)
    import igl

    known = np.asarray(np.isfinite(points).all(axis=1))
    _, face, foot = igl.point_mesh_squared_distance(
        np.where(known[:, None], points, 0.0), np.ascontiguousarray(vertices), np.ascontiguousarray(faces)
    )
    # its squared distance loses half of the digits
    distance = np.where(known, np.linalg.norm(foot - points, axis=1), np.inf)
    return np.where(known, face, 0).astype(np.int64), distance
