"""Where to stand to see the cloth: an axonometric view chosen from the shape alone.

The projection is parallel, so that one scale bar holds for the whole picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

_CANDIDATES: Final = 600  # directions tried, some 8 degrees apart
_SAMPLE: Final = 2000  # normals they are judged by
_TILT: Final = np.radians(36.0)  # from face-on, so that curvature shows
_TURN: Final = 0.55  # tangent of the turn of a square mould; a longer one turns less and fills the frame
_UPRIGHT: Final = 0.1  # of the surface shown, that z upwards in the picture is worth
_NEAR: Final = 0.4  # of the cloth's size: how much mould is shown around it


@dataclass(frozen=True, eq=False)
class View:
    """A parallel projection on the picture.

    Attributes
    ----------
    axes : (3, 3) float64
        Rows: unit vectors to the right, up, and towards the eye.
    centre : (3,) float64, mm
        What is shown at `middle`.
    middle : (2,) float64, pixels
        From the lower left corner of the picture.
    mm_per_pixel : float
    """

    axes: FloatArray
    centre: FloatArray
    middle: FloatArray
    mm_per_pixel: float

    @property
    def toward(self) -> FloatArray:
        """Unit vector towards the eye, (3,)."""
        return np.asarray(self.axes[2])

    def pixels(self, points: ArrayLike) -> FloatArray:
        """Return where points (..., 3), mm, appear in the picture, (..., 2), pixels."""
        offset = np.asarray(points, dtype=np.float64) - self.centre
        return np.asarray(self.middle + offset @ self.axes[:2].T / self.mm_per_pixel)

    def hides(self, point: ArrayLike, corners: FloatArray, clearance: float) -> bool:
        """Tell whether one of some triangles (n, 3, 3), mm, is before a point (3,), nearer by a clearance, mm."""
        right, up, near = np.moveaxis((corners - np.asarray(point)) @ self.axes.T, 2, 0)  # each (n, 3)
        after, last = [1, 2, 0], [2, 0, 1]
        # twice the areas between the line of sight and each edge: of one sign where it passes the triangle
        area = right[:, after] * up[:, last] - right[:, last] * up[:, after]
        inside = (area >= 0).all(axis=1) | (area <= 0).all(axis=1)
        whole = area[inside].sum(axis=1)
        depth = np.einsum("nk,nk->n", area[inside], near[inside])
        return bool((depth * np.sign(whole) > clearance * np.abs(whole)).any())


def view_axes(normals: FloatArray, areas: FloatArray, points: FloatArray) -> FloatArray:
    """Return the axes of a view on the side the normals point to, rows right, up and towards the eye, (3, 3).

    The view looks against the direction from which all the surface is seen best, turned a little aside and
    tilted; the longest extent runs along the picture.

    Parameters
    ----------
    normals, areas : (n, 3) and (n,) float64
        Pieces of the surface to be seen.
    points : (m, 3) float64, mm
        What the picture must hold.
    """
    stride = max(1, len(normals) // _SAMPLE)
    normals, areas = normals[::stride], areas[::stride]
    face_on = _face_on(normals, areas)
    along = _longest(points, face_on)
    across = np.cross(face_on, along)
    if _is_down(across):
        along, across = -along, -across
    length, width = np.ptp(points @ np.stack([along, across]).T, axis=0)
    turn = np.arctan(_TURN * min(1.0, width / max(length, 1e-12 + width)))
    # four ways to turn and tilt: one that shows much and has z upwards; the first if there is nothing between
    ways = [_tilted(face_on, along, across, sign * turn, way * _TILT) for way in (1, -1) for sign in (1, -1)]
    merit = [round(_shown(axes[2], normals, areas) + _UPRIGHT * axes[1, 2], 3) for axes in ways]
    return ways[int(np.argmax(merit))]


def fitted(
    axes: FloatArray,
    subject: FloatArray,
    surroundings: FloatArray,
    corner: tuple[float, float],
    width: float,
    heights: tuple[float, float],
) -> tuple[View, float]:
    """Return the view that fits a subject and what is near it in a frame, and the height of the frame.

    Parameters
    ----------
    axes : (3, 3) float64
    subject, surroundings : (n, 3) and (m, 3) float64, mm
        Points that the frame must hold, and points it may hold: those farther from the subject than a part of
        its size are let go.
    corner : (float, float)
        Lower left corner of the frame in the picture, pixels.
    width : float
        Of the frame, pixels.
    heights : (float, float)
        Least and most height of the frame, pixels; it is as high as the points need.
    """
    flat, around = subject @ axes[:2].T, surroundings @ axes[:2].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    near = _NEAR * float((high - low).max())
    low = np.minimum(low, np.maximum(low - near, around.min(axis=0)))
    high = np.maximum(high, np.minimum(high + near, around.max(axis=0)))
    extent = np.maximum(high - low, 1e-9 * max(float(np.abs(flat).max()), 1.0))
    height = float(np.clip(width * extent[1] / extent[0], *heights))
    mm_per_pixel = float(max(extent[0] / width, extent[1] / height))
    centre = 0.5 * (low + high) @ axes[:2] + (subject[0] @ axes[2]) * axes[2]
    middle = np.array([corner[0] + 0.5 * width, corner[1] + 0.5 * height])
    return View(axes, centre, middle, mm_per_pixel), height


def _face_on(normals: FloatArray, areas: FloatArray) -> FloatArray:
    k = np.arange(_CANDIDATES)
    z = 1.0 - (2.0 * k + 1.0) / _CANDIDATES
    angle = k * np.pi * (3.0 - np.sqrt(5.0))  # a spiral: evenly spread over the sphere
    r = np.sqrt(1.0 - z * z)
    candidates = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)
    mean = areas @ normals
    size = np.linalg.norm(mean)
    if size > 0:
        candidates = np.concatenate([mean[None] / size, candidates])
    shown = [_shown(toward, normals, areas) for toward in candidates]
    # rounded off to the mean normal where it shows as much: a dome is looked at along its axis
    best = 0 if shown[0] > 0.995 * max(shown) else int(np.argmax(shown))
    return np.asarray(candidates[best])


def _shown(toward: FloatArray, normals: FloatArray, areas: FloatArray) -> float:
    """Return how well a surface is seen, 0 to 1."""
    # the root makes a little of every face worth more than all of one
    return float(areas @ np.sqrt(np.maximum(normals @ toward, 0.0)) / areas.sum())


def _longest(points: FloatArray, normal: FloatArray) -> FloatArray:
    """Return the direction of longest extent across a normal, (3,)."""
    centred = points - points.mean(axis=0)
    flat = centred - np.outer(centred @ normal, normal)
    values, vectors = np.linalg.eigh(flat.T @ flat)
    if values[2] > 1.2 * values[1]:
        return np.asarray(vectors[:, 2])
    # as long as wide: keep to x, or to the next axis across the normal
    axis = np.eye(3)[int(np.argmin(np.abs(normal) + np.array([0.0, 1e-6, 2e-6])))]
    along = axis - (axis @ normal) * normal
    return np.asarray(along / np.linalg.norm(along))


def _is_down(up: FloatArray) -> bool:
    """Tell whether a direction points down: z counts, then y, then x."""
    for value in up[::-1]:
        if abs(value) > 0.05:
            return bool(value < 0)
    return False


def _tilted(face_on: FloatArray, along: FloatArray, across: FloatArray, turn: float, tilt: float) -> FloatArray:
    """Return the axes after a turn of the object about its normal and a tilt of its upper edge away."""
    right = np.cos(turn) * along - np.sin(turn) * across
    up = np.sin(turn) * along + np.cos(turn) * across
    return np.stack([right, np.cos(tilt) * up + np.sin(tilt) * face_on, np.cos(tilt) * face_on - np.sin(tilt) * up])
