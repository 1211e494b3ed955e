"""Directions about a point of a surface, measured by one angle all round it."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from meshdrape.kernels.generator import corner_angle, corner_place
from meshdrape.surface import Surface, SurfacePoint

# Barycentric distance below which a point lies on an edge or a vertex: round-off.
SNAP = 1e-9


class Ray(NamedTuple):
    """A direction at a point, in the frame of the face it enters.

    `far_edge` is the edge it must cross first where the point is a vertex, else -1.
    """

    face: int
    x: float
    y: float
    dx: float
    dy: float
    far_edge: int


class _Sector(NamedTuple):
    face: int
    x: float
    y: float
    ex: float
    ey: float
    begin: float
    size: float
    far_edge: int


class Rays:
    """The faces about a point, unfolded one after the other, counter-clockwise about the normal.

    Parameters
    ----------
    surface : Surface
    point : SurfacePoint
        Not on a border.

    Attributes
    ----------
    total : float
        Angle all round, rad: 2 pi but at a vertex.
    """

    def __init__(self, surface: Surface, point: SurfacePoint) -> None:
        self._surface = surface
        self._sectors = _sectors(surface, point)
        self.total = self._sectors[-1].begin + self._sectors[-1].size

    def angle(self, face: int, dx: float, dy: float) -> float:
        """Angle of a direction given in the frame of a face that holds the point, rad in [0, total)."""
        found = [sector for sector in self._sectors if sector.face == face]
        if found:
            sector = found[0]
            turn = math.atan2(sector.ex * dy - sector.ey * dx, sector.ex * dx + sector.ey * dy)
            return (sector.begin + turn) % self.total
        # a face that holds the point but for round-off: its neighbour with the nearest plane speaks for it
        frames = self._surface.unfolding.frame
        along = dx * frames[face, 3:6] + dy * frames[face, 6:9]
        best = max(self._sectors, key=lambda s: math.hypot(along @ frames[s.face, 3:6], along @ frames[s.face, 6:9]))
        frame = frames[best.face]
        return self.angle(best.face, float(along @ frame[3:6]), float(along @ frame[6:9]))

    def ray(self, angle: float) -> Ray:
        """The direction at an angle."""
        angle %= self.total
        sector = next((s for s in self._sectors if angle <= s.begin + s.size), self._sectors[-1])
        c, s = math.cos(angle - sector.begin), math.sin(angle - sector.begin)
        return Ray(
            sector.face,
            sector.x,
            sector.y,
            c * sector.ex - s * sector.ey,
            s * sector.ex + c * sector.ey,
            sector.far_edge,
        )


def _sectors(surface: Surface, point: SurfacePoint) -> list[_Sector]:
    mesh, face = surface.unfolding, point.face
    corner = int(np.argmax(point.barycentric))
    if point.barycentric[corner] >= 1 - SNAP:
        sectors: list[_Sector] = []
        f, k, begin = face, corner, 0.0
        while True:
            size, ex, ey = corner_angle(mesh, f, k)
            x, y = corner_place(mesh, f, k)
            sectors.append(_Sector(f, x, y, ex, ey, begin, size, (k + 1) % 3))
            begin += size
            code = int(mesh.neighbour[f, (k + 2) % 3])
            f, k = code // 3, code % 3
            if code < 0 or f == face:
                return sectors
    x, y = point.in_frame(surface)
    low = int(np.argmin(point.barycentric))
    edge = (low + 1) % 3
    code = int(mesh.neighbour[face, edge])
    if point.barycentric[low] > SNAP or code < 0:
        return [_Sector(face, x, y, 1.0, 0.0, 0.0, 2 * math.pi, -1)]
    # an edge runs with its face on the left, and against that of the face across
    place = point.position(surface)
    sectors = []
    for f, k in ((face, edge), (code // 3, code % 3)):
        frame = mesh.frame[f]
        _, ex, ey = corner_angle(mesh, f, k)
        off = place - frame[:3]
        sectors.append(
            _Sector(f, float(off @ frame[3:6]), float(off @ frame[6:9]), ex, ey, math.pi * len(sectors), math.pi, -1)
        )
    return sectors
