"""Straight lines between two points of a surface by laying out every triangle they can see: slow, and no kernel's."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]


class StraightLine(NamedTuple):
    """A straight line: its length, its unit direction (3,) where it starts, its crossings in space (k, 3)."""

    length: float
    direction: FloatArray
    crossings: FloatArray


def straight_line(
    surface: Surface, face: int, start: FloatArray, target_face: int, target: FloatArray, reach: float
) -> StraightLine | None:
    """The shortest straight line from `start` in `face` to `target` in `target_face`; none: None.

    From the start the eye looks out over the edges of its face; behind each it lays the next triangle flat into the
    same plane, and looks on through what it sees of that one's edges.
    """
    corners = surface.vertices[surface.faces[face]]
    u = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
    v = np.cross(surface.face_normal[face], u)
    weights = _barycentric(surface, target_face, target)
    found: list[StraightLine] = []

    def look(
        f: int,
        flat: FloatArray,
        gates: list[tuple[int, int]],
        laid: list[FloatArray],
        right: FloatArray,
        left: FloatArray,
    ) -> None:
        """Lay out what is behind face f, its corners at `flat` (3, 2) as seen from the start, between two rays."""
        if f == target_face:
            end = weights @ flat
            if _turn(right, end) >= -1e-12 * reach**2 and _turn(end, left) >= -1e-12 * reach**2:
                found.append(_line(surface, end, gates, laid, u, v))
        for k in range(3):
            code = int(surface.face_neighbour[f, k])
            a, b = flat[k], flat[(k + 1) % 3]
            # an edge run through counter-clockwise about the start is looked at from inside
            if code < 0 or (gates and code // 3 == gates[-1][0]) or _turn(a, b) <= 0 or _nearest(a, b) > reach:
                continue
            low, high = (a if _turn(right, a) > 0 else right), (b if _turn(b, left) > 0 else left)
            if _turn(low, high) > 0:
                look(
                    code // 3,
                    _laid(surface, code, b, a),
                    [*gates, (f, k)],
                    [*laid, np.stack([a, b])],
                    low,
                    high,
                )

    flat = np.stack([(corners - start) @ u, (corners - start) @ v], axis=1)
    if face == target_face:
        found.append(_line(surface, weights @ flat, [], [], u, v))
    for k in range(3):
        code = int(surface.face_neighbour[face, k])
        a, b = flat[k], flat[(k + 1) % 3]
        if code >= 0 and _turn(a, b) > 0 and _nearest(a, b) <= reach:
            look(code // 3, _laid(surface, code, b, a), [(face, k)], [np.stack([a, b])], a, b)
    return min(found, key=lambda line: line.length, default=None)


def _turn(a: FloatArray, b: FloatArray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _nearest(a: FloatArray, b: FloatArray) -> float:
    """Distance of the segment a-b from the origin."""
    t = min(max(float(-a @ (b - a)) / float((b - a) @ (b - a)), 0.0), 1.0)
    return float(np.hypot(*(a + t * (b - a))))


def _barycentric(surface: Surface, face: int, point: FloatArray) -> FloatArray:
    corners = surface.vertices[surface.faces[face]]
    b, c = np.linalg.lstsq((corners[1:] - corners[0]).T, point - corners[0], rcond=None)[0]
    return np.array([1 - b - c, b, c])


def _laid(surface: Surface, code: int, tail: FloatArray, head: FloatArray) -> FloatArray:
    """Corners (3, 2) of the face across an edge, whose own edge runs from `tail` to `head`, on the left of it."""
    f, k = code // 3, code % 3
    p, q, r = (surface.vertices[surface.faces[f, (k + s) % 3]] for s in range(3))
    along = (r - p) @ (q - p) / ((q - p) @ (q - p))
    height = np.linalg.norm((r - p) - along * (q - p)) / np.linalg.norm(q - p)
    out = np.empty((3, 2))
    out[k], out[(k + 1) % 3] = tail, head
    out[(k + 2) % 3] = tail + along * (head - tail) + height * np.array([tail[1] - head[1], head[0] - tail[0]])
    return out


def _line(
    surface: Surface,
    end: FloatArray,
    gates: list[tuple[int, int]],
    laid: list[FloatArray],
    u: FloatArray,
    v: FloatArray,
) -> StraightLine:
    length = float(np.hypot(*end))
    crossings = []
    for (f, k), (a, b) in zip(gates, laid, strict=True):
        t = _turn(a, end) / (_turn(a, end) - _turn(b, end))
        tail, head = surface.vertices[surface.faces[f, k]], surface.vertices[surface.faces[f, (k + 1) % 3]]
        crossings.append(tail + t * (head - tail))
    return StraightLine(length, (end[0] * u + end[1] * v) / length, np.array(crossings).reshape(-1, 3))
