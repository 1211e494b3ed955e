"""Exact distances from one place of a surface to all places near it, with the directions of the shortest paths."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.walk import turn_into
from meshdrape.kernels.ways import nearest_way, nearest_ways
from meshdrape.kernels.windows import Faces, Windows, spread
from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Place = tuple[int, float, float]

# A vertex about which the faces turn by more than a full turn, or half a turn on a border, by this much, rad, is one
# where shortest paths bend; below it they pass by straight, but for the square of this share of their length.
BENDING = 1e-9
# Ways that differ by less than this share of the reach are followed all.
EQUAL = 1e-10
# Room for windows at first.
WINDOWS_A_FACE = 40


class Region:
    """Faces of a surface, numbered among themselves.

    Parameters
    ----------
    faces : (n,) int
        Of the surface, ascending.
    """

    def __init__(self, surface: Surface, faces: IntArray) -> None:
        self.surface, self.faces = surface, faces
        self.vertices, compact = np.unique(surface.faces[faces], return_inverse=True)
        code = surface.face_neighbour[faces]
        other = self.numbers(np.maximum(code, 0) // 3)
        mesh = surface.unfolding
        self.tables = Faces(
            plane=mesh.plane[faces],
            across=np.where((code >= 0) & (other >= 0), 3 * other + code % 3, -1),
            vertex=compact.reshape(-1, 3),
            bends=surface.vertex_defect[self.vertices] < -BENDING,
            angle=mesh.vertex_angle[self.vertices],
        )

    def numbers(self, faces: IntArray) -> IntArray:
        """Numbers (n,) of faces of the surface in the region; -1 of those that are not in it."""
        at = np.minimum(np.searchsorted(self.faces, faces), len(self.faces) - 1)
        return np.where(self.faces[at] == faces, at, -1)

    def number(self, face: int) -> int:
        """Number of a face of the surface in the region; -1 where it is not in it."""
        at = int(np.searchsorted(self.faces, face))
        return at if at < len(self.faces) and self.faces[at] == face else -1


class Way(NamedTuple):
    """A shortest path.

    Attributes
    ----------
    length : float
        mm.
    leave, arrive : (2,)
        Unit directions at its two ends, in the frames of their faces.
    bend : int
        The last vertex at which it turns on its way; -1 where it runs straight.
    """

    length: float
    leave: FloatArray
    arrive: FloatArray
    bend: int

    @property
    def bent(self) -> bool:
        """Whether it turns at a vertex."""
        return self.bend >= 0


class DistanceField:
    """Distances, exact but for round-off, from a source to the places of a region, along paths within it.

    Parameters
    ----------
    source : (face, x, y)
        In the region, in the frame of its face, mm.
    reach : float
        No path longer than this is looked for, mm.

    References
    ----------
    See :mod:`meshdrape.kernels.windows`.
    """

    def __init__(self, region: Region, source: Place, reach: float) -> None:
        self._region, self._source = region, source
        home = region.number(source[0])
        room = WINDOWS_A_FACE * len(region.faces)
        while True:
            windows = _emptied(len(region.faces), len(region.tables.bends), room)
            if spread(region.tables, windows, home, *source[1:], reach, EQUAL * reach):
                break
            room *= 4
        self._tables = (region.tables, windows, home, *source[1:])

    def to(self, place: Place) -> Way | None:
        """The shortest path to a place; None where the region holds none."""
        number = self._region.number(place[0])
        if number < 0:
            return None
        length, ax, ay, bend, lx, ly, base = nearest_way(*self._tables, number, *place[1:])
        if not np.isfinite(length):
            return None
        mesh = self._region.surface.unfolding
        last = int(self._region.vertices[bend]) if bend >= 0 else -1
        begun = int(self._region.faces[base])
        leave = turn_into(mesh.plane, mesh.neighbour, mesh.frame, begun, lx, ly, self._source[0])
        return Way(float(length), np.array(leave), np.array([ax, ay]), last)

    def distances(self, face: IntArray, xy: FloatArray) -> FloatArray:
        """Shortest distances (n,) to places given by their faces (n,), -1 for none, and (n, 2) in their frames, mm."""
        number = np.where(face >= 0, self._region.numbers(np.maximum(face, 0)), -1)
        return np.asarray(nearest_ways(*self._tables, number, xy))


def _emptied(n_faces: int, n_vertices: int, room: int) -> Windows:
    spot = np.zeros((n_vertices, 5))
    spot[:, 0] = np.inf
    return Windows(
        real=np.empty((room, 7)),
        whole=np.empty((room, 4), dtype=np.int64),
        first=np.full(3 * n_faces, -1),
        sight=np.full((3 * n_faces, 2), np.inf),
        spot=spot,
        way=np.full((n_vertices, 3), -1),
        key=np.empty(room),
        item=np.empty(room, dtype=np.int64),
        counts=np.zeros(3, dtype=np.int64),
    )
