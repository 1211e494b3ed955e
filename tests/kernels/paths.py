"""Straight walks by surface and place, whatever arrays the kernels want them handed over in."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels import walk as kernel
from meshdrape.surface import Surface

WALKED, LEFT_SURFACE = kernel.WALKED, kernel.LEFT_SURFACE


class Place(NamedTuple):
    """A place in the frame of a face."""

    face: int
    x: float
    y: float

    def in_space(self, surface: Surface) -> NDArray[np.float64]:
        frame = surface.unfolding.frame[self.face]
        return np.asarray(frame[:3] + self.x * frame[3:6] + self.y * frame[6:9])


class Walked(NamedTuple):
    """How a walk ended: its end, its start seen in the end's frame, and its direction there."""

    code: int
    end: Place
    start: Place
    direction: tuple[float, float]


def walk(surface: Surface, place: Place, direction: tuple[float, float], length: float) -> Walked:
    mesh = surface.unfolding
    code, face, x, y, dx, dy = kernel.walk(mesh.plane, mesh.neighbour, *place, *direction, length)
    return Walked(code, Place(face, x + length * dx, y + length * dy), Place(face, x, y), (dx, dy))


def turn_into(surface: Surface, source: int, direction: tuple[float, float], target: int) -> tuple[float, float]:
    mesh = surface.unfolding
    return kernel.turn_into(mesh.plane, mesh.neighbour, mesh.frame, source, *direction, target)


def place_at(surface: Surface, position) -> Place:
    """The place of a point on the surface."""
    point, distance = surface.closest_point(position)
    assert distance < 1e-9
    return Place(point.face, *point.in_frame(surface))


def in_face(surface: Surface, face: int, direction) -> tuple[float, float]:
    """A direction in space as a unit direction of a face."""
    frame = surface.unfolding.frame[face]
    along = np.array([np.dot(direction, frame[3:6]), np.dot(direction, frame[6:9])])
    return tuple(along / np.linalg.norm(along))
