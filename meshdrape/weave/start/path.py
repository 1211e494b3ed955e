"""A curve drawn on a mould, as a start fibre follows it: straight pieces from triangle to triangle."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import StartError
from meshdrape.geodesic.shortest import Piece, shortest_path
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]

# Points nearer than this share of the spacing are one.
SAME_POINT = 1e-9
# Pieces shorter than this share of it are round-off.
NOTHING = 1e-11


@dataclass(frozen=True, eq=False)
class SurfacePath:
    """A curve on a surface.

    Attributes
    ----------
    surface : Surface
    face : (n,) int64
        Triangle of each straight piece.
    tail, head : (n,) complex128
        Its ends in the frame of that triangle, x + iy, mm.
    bend : (n,) bool
        Whether the curve may bend where the piece begins.
    """

    surface: Surface
    face: NDArray[np.int64]
    tail: NDArray[np.complex128]
    head: NDArray[np.complex128]
    bend: NDArray[np.bool_]

    @cached_property
    def knot(self) -> FloatArray:
        """Arc length at which each piece begins, and the last ends, (n + 1,) mm."""
        return np.concatenate([[0.0], np.cumsum(np.abs(self.head - self.tail))])

    @property
    def length(self) -> float:
        """Arc length, mm."""
        return float(self.knot[-1])

    @cached_property
    def direction(self) -> NDArray[np.complex128]:
        """Unit direction of each piece in the frame of its triangle, (n,)."""
        along = self.head - self.tail
        return np.asarray(along / np.abs(along))

    def reversed(self) -> SurfacePath:
        """The same curve run the other way."""
        bend = np.concatenate([[True], self.bend[:0:-1]])
        return SurfacePath(self.surface, self.face[::-1], self.head[::-1], self.tail[::-1], bend)

    def piece_at(self, length: float) -> int:
        """The piece at an arc length: at a joint the one that follows."""
        return int(np.clip(np.searchsorted(self.knot, length, side="right") - 1, 0, len(self.face) - 1))

    def place_at(self, length: float) -> tuple[int, complex, complex]:
        """Face, place and direction at an arc length, in the frame of that face."""
        n = self.piece_at(length)
        return (
            int(self.face[n]),
            complex(self.tail[n] + (length - self.knot[n]) * self.direction[n]),
            complex(self.direction[n]),
        )

    def point_at(self, length: float) -> SurfacePoint:
        """The point at an arc length."""
        face, place, _ = self.place_at(length)
        return SurfacePoint.from_frame(self.surface, face, place.real, place.imag)

    def bends_between(self, low: float, high: float) -> bool:
        """Whether the curve may bend strictly between two arc lengths."""
        a, b = np.searchsorted(self.knot[:-1], [low, high], side="right")
        inner = np.arange(a, b)
        inner = inner[(self.knot[inner] > low) & (self.knot[inner] < high)]
        return bool(self.bend[inner].any())

    @cached_property
    def ends_in_space(self) -> tuple[FloatArray, FloatArray]:
        """Both ends of every piece in space, each (n, 3) mm."""
        frame = self.surface.unfolding.frame[self.face]

        def place(z: NDArray[np.complex128]) -> FloatArray:
            return np.asarray(frame[:, :3] + z.real[:, None] * frame[:, 3:6] + z.imag[:, None] * frame[:, 6:9])

        return place(self.tail), place(self.head)

    def nearest(self, position: ArrayLike) -> tuple[float, float]:
        """Arc length of the point of the curve nearest to a position (3,), and its distance, mm."""
        p = np.asarray(position, dtype=np.float64)
        tail, head = self.ends_in_space
        along = head - tail
        t = np.clip(np.einsum("ij,ij->i", p - tail, along) / np.einsum("ij,ij->i", along, along), 0, 1)
        distance = np.linalg.norm(tail + t[:, None] * along - p, axis=1)
        n = int(np.argmin(distance))
        return float(self.knot[n] + t[n] * (self.knot[n + 1] - self.knot[n])), float(distance[n])


def draw(surface: Surface, points: FloatArray, spacing: float, name: str, called: str = "the mould") -> SurfacePath:
    """The curve through the given points: each projected on the surface, joined in their order by geodesics.

    Parameters
    ----------
    surface : Surface
        Connected.
    points : (n, 3) float, mm
    spacing : float
        Farthest a point may lie from the surface, mm.
    name, called : str
        What errors call the curve and the surface.

    Raises
    ------
    StartError
        If no two points are apart, or one is too far off.
    """
    on: list[SurfacePoint] = []
    for n, position in enumerate(points):
        point, distance = surface.closest_point(position)
        if distance > spacing:
            msg = (
                f"{name}: point {n + 1} at ({', '.join(f'{v:g}' for v in position)}) lies {distance:.6g} mm from "
                f"{called}, farther than one spacing ({spacing:g} mm); draw it on {called}"
            )
            raise StartError(msg)
        apart = not on or float(np.linalg.norm(point.position(surface) - on[-1].position(surface)))
        if apart > SAME_POINT * spacing:
            on.append(point)
    if len(on) < 2:
        msg = f"{name} has {len(points)} points and no two of them apart on the mould; give at least two"
        raise StartError(msg)
    pieces: list[Piece] = []
    bend: list[bool] = []
    for a, b in pairwise(on):
        joined = [piece for piece in shortest_path(surface, a, b) if abs(piece.head - piece.tail) > NOTHING * spacing]
        pieces += joined
        bend += [k == 0 or _touches_vertex(surface, piece) for k, piece in enumerate(joined)]
    return SurfacePath(
        surface,
        np.array([piece.face for piece in pieces]),
        np.array([piece.tail for piece in pieces]),
        np.array([piece.head for piece in pieces]),
        np.array(bend),
    )


def _touches_vertex(surface: Surface, piece: Piece) -> bool:
    """Whether a piece begins at a vertex, where the shortest path may bend."""
    point = SurfacePoint.from_frame(surface, piece.face, piece.tail.real, piece.tail.imag)
    return bool(point.barycentric.max() >= 1 - SAME_POINT)


def crossings(a: SurfacePath, b: SurfacePath, within: float) -> tuple[list[tuple[float, float]], float, FloatArray]:
    """Where two curves cross: arc lengths on both, how near they come, and where that is.

    Parameters
    ----------
    within : float
        Curves that come this near meet, mm.

    Returns
    -------
    found : list of (float, float)
        Arc length on a and on b of each crossing, in order along a.
    distance : float
        Least distance between the curves, mm.
    place : (3,)
        Where they are that near.
    """
    tails, heads = b.ends_in_space
    found: list[tuple[float, float]] = []
    least, where = np.inf, np.zeros(3)
    low_b, high_b = np.minimum(tails, heads), np.maximum(tails, heads)
    for n, (tail, head) in enumerate(zip(*a.ends_in_space, strict=True)):
        low, high = np.minimum(tail, head), np.maximum(tail, head)
        gap = np.linalg.norm(np.maximum(np.maximum(low_b - high, low - high_b), 0.0), axis=1)
        near = np.flatnonzero(gap <= max(within, least))
        if not len(near):
            continue
        s, t, distance = _closest_on_segments(tail, head, tails[near], heads[near])
        for k in np.flatnonzero(distance <= within):
            m = int(near[k])
            at = (float(a.knot[n] + s[k] * (a.knot[n + 1] - a.knot[n])),
                  float(b.knot[m] + t[k] * (b.knot[m + 1] - b.knot[m])))  # fmt: skip
            if not any(abs(at[0] - old[0]) <= 10 * within for old in found):
                found.append(at)
        best = int(np.argmin(distance))
        if distance[best] < least:
            least, where = float(distance[best]), tail + s[best] * (head - tail)
    return found, least, where


def _closest_on_segments(
    tail: FloatArray, head: FloatArray, tails: FloatArray, heads: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Parameters s on one segment and t on each of many (n,), in [0, 1], where they are nearest, and the distance."""
    u, v, w = head - tail, heads - tails, tail - tails
    uu, vv = float(u @ u), np.einsum("ij,ij->i", v, v)
    uv, uw, vw = v @ u, w @ u, np.einsum("ij,ij->i", v, w)
    determinant = uu * vv - uv * uv
    safe = np.where(determinant > 1e-14 * uu * vv, determinant, 1.0)
    s = np.where(determinant > 1e-14 * uu * vv, (uv * vw - vv * uw) / safe, 0.0)
    s = np.clip(s, 0.0, 1.0)
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    gap = np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1)
    return s, t, gap
