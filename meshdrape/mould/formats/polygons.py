"""Polygons of any number of corners, and the triangles they are cut into."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Polygons:
    """What a mesh file holds.

    Attributes
    ----------
    vertices : (n, 3) float64
        In the unit of the file.
    corner : (k,) int64
        Vertices of all polygons, one polygon after the other, from 0.
    size : (m,) int64
        Number of corners of each polygon.
    """

    vertices: Floats
    corner: Ints
    size: Ints

    @classmethod
    def of_triangles(cls, vertices: Floats, triangles: Ints) -> Polygons:
        """Return the given triangles (m, 3) as polygons."""
        return cls(vertices, triangles.reshape(-1), np.full(len(triangles), 3, dtype=np.int64))

    def triangles(self) -> Ints:
        """Return the polygons cut into triangles, (m, 3), in the order of the polygons.

        A quadrilateral is cut along the diagonal that keeps both halves on one side, the shorter where both
        do; a larger polygon as seen along its normal. Polygons of fewer than three corners have no area and
        are left out. Every index must be in range.
        """
        first = np.cumsum(self.size) - self.size
        threes, fours = np.flatnonzero(self.size == 3), np.flatnonzero(self.size == 4)
        more = np.flatnonzero(self.size > 4)
        pieces = [self.corner[first[threes, None] + np.arange(3)]]
        owners = [threes]
        if len(fours):
            pieces.append(_halves(self.vertices, self.corner[first[fours, None] + np.arange(4)]))
            owners.append(np.repeat(fours, 2))
        for polygon in more.tolist():
            pieces.append(_ears(self.vertices, self.corner[first[polygon] : first[polygon] + self.size[polygon]]))
            owners.append(np.full(len(pieces[-1]), polygon))
        order = np.argsort(np.concatenate(owners), kind="stable")
        return np.asarray(np.concatenate(pieces)[order])


def _halves(vertices: Floats, quads: Ints) -> Ints:
    """Two triangles for each quadrilateral (m, 4), side by side, (2 m, 3)."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    with np.errstate(invalid="ignore", over="ignore"):  # what is not finite is reported later, as such
        first = np.einsum("ij,ij->i", np.cross(b - a, c - a), np.cross(c - a, d - a))
        second = np.einsum("ij,ij->i", np.cross(b - a, d - a), np.cross(c - b, d - b))
        longer = np.einsum("ij,ij->i", c - a, c - a) > np.einsum("ij,ij->i", d - b, d - b)
        turned = (second > 0) & ((first <= 0) | longer)
    cut = np.where(turned[:, None], [0, 1, 3, 1, 2, 3], [0, 1, 2, 0, 2, 3])
    return np.asarray(np.take_along_axis(quads, cut, axis=1).reshape(-1, 3))


def _ears(vertices: Floats, polygon: Ints) -> Ints:
    """Triangles of one polygon (k,) as seen along its normal; a fan where it overlaps itself as seen so."""
    import mapbox_earcut

    k = len(polygon)
    fan = np.stack([np.zeros(k - 2, dtype=np.int64), np.arange(1, k - 1), np.arange(2, k)], axis=1)
    with np.errstate(invalid="ignore", over="ignore"):
        points = vertices[polygon] - vertices[polygon].mean(axis=0)
        normal = np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
        size = float(np.linalg.norm(normal))
    if not np.isfinite(size) or size == 0:
        return polygon[fan]
    across = np.cross(normal / size, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    flat = np.stack([points @ across, points @ np.cross(normal / size, across)], axis=1)
    ears = mapbox_earcut.triangulate_float64(flat, np.array([k], dtype=np.uint32)).reshape(-1, 3).astype(np.int64)
    if len(ears) != k - 2:
        return polygon[fan]
    return np.asarray(polygon[ears])
