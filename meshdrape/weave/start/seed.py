"""The seed point and the four half-fibres that leave it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import StartError
from meshdrape.kernels.generator import corner_angle, corner_place, turn_about_vertex
from meshdrape.kernels.walk import turn_into
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.start.rays import SNAP, Ray, Rays

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SeedStar:
    """The four half-fibres at the seed, +warp, +weft, -warp, -weft, each in the face it enters.

    Attributes
    ----------
    face : (4,) int32
    xy : (4, 2) the seed in the frame of each face, mm
    out : (4, 2) unit directions in those frames
    far_edge : (4,) the edge each half-fibre must cross first where the seed is a vertex, else -1
    sector : (4,) angles between neighbouring half-fibres, counter-clockwise, rad
    tangent : (2, 2) unit directions of warp and weft themselves, in the frame of the first face
        Those of the half-fibres +warp and +weft, but where a fibre bends on its first edges: then `out` is the
        direction of those edges.
    """

    face: NDArray[np.int32]
    xy: FloatArray
    out: FloatArray
    far_edge: NDArray[np.int64]
    sector: FloatArray
    tangent: FloatArray

    def ray(self, half: int) -> Ray:
        """A half-fibre's start."""
        (x, y), (dx, dy) = self.xy[half], self.out[half]
        return Ray(int(self.face[half]), float(x), float(y), float(dx), float(dy), int(self.far_edge[half]))


def seed_star(surface: Surface, point: SurfacePoint, direction: ArrayLike, initial_angle: float) -> SeedStar:
    """Half-fibres of a seed: the warp along `direction`, projected, the weft at the initial angle from it.

    `direction` is a vector (3,) of any length. The star of the seed is unfolded to its total angle A; counter-clockwise
    about the normal the half-fibres follow at initial_angle A / 2 pi, A / 2 and A / 2 + initial_angle A / 2 pi.

    Raises
    ------
    StartError
        If the direction is zero, not finite, or along the normal.
    """
    along = unit_direction(direction)
    where = point.barycentric
    corner = int(np.argmax(where))
    if where[corner] >= 1 - SNAP:
        return _at_vertex(surface, point.face, corner, along, initial_angle)
    face = point.face
    edge = int(np.argmin(where))
    if where[edge] <= SNAP:
        # on the edge opposite that corner: enter whichever face the direction points into more
        across = int(surface.face_neighbour[face, (edge + 1) % 3])
        if across >= 0 and _into(surface, across // 3, across % 3, along) > _into(surface, face, (edge + 1) % 3, along):
            position = point.position(surface)
            face = across // 3
            x, y = _in_frame(surface, face, position)
            return _in_face(surface, face, x, y, along, initial_angle)
    x, y = point.in_frame(surface)
    return _in_face(surface, face, x, y, along, initial_angle)


def part_under(whole: Surface, point: SurfacePoint, seed: ArrayLike) -> tuple[Surface, NDArray[np.int64], SurfacePoint]:
    """The connected part that a point of a surface lies on.

    Parameters
    ----------
    whole : Surface
    point : SurfacePoint
        The point of it nearest to the seed.
    seed : (3,) float, mm

    Returns
    -------
    part : Surface
    part_face : (m,) int64
        The face of the whole behind each of its faces.
    point : SurfacePoint
        The same point of the part.
    """
    if whole.n_components == 1:
        return whole, np.arange(len(whole.faces)), point
    part, part_face = whole.component(int(whole.face_component[point.face]))
    return part, part_face, part.closest_point(np.asarray(seed, dtype=np.float64))[0]


def numbers(name: str, value: ArrayLike) -> FloatArray:
    """What was given for `name`, as an array of numbers.

    Raises
    ------
    StartError
        If it is none.
    """
    try:
        given = np.asarray(value)
        # numpy would read a text as a number
        if given.dtype.kind in "US":
            raise TypeError
        return given.astype(np.float64)
    except (TypeError, ValueError):
        msg = f"{name} is {' '.join(repr(value).split()):.80}; give numbers"
        raise StartError(msg) from None


def unit_direction(direction: ArrayLike) -> FloatArray:
    """A direction of unit length, (3,).

    Raises
    ------
    StartError
        If it is zero, not finite or not of numbers.
    """
    along = numbers("direction", direction)
    largest = float(np.abs(along).max()) if along.shape == (3,) else math.nan
    if not (math.isfinite(largest) and largest > 0):
        msg = f"direction {_triple(along)} is no direction: give three numbers that are not all zero"
        raise StartError(msg)
    # the square of a large number may be beyond all numbers, that of a small one nothing
    along = along / largest
    return np.asarray(along / np.linalg.norm(along))


def _in_face(surface: Surface, face: int, x: float, y: float, along: FloatArray, initial_angle: float) -> SeedStar:
    dx, dy = _planar(surface, face, along)
    size = math.hypot(dx, dy)
    if size < 1e-6:
        raise StartError(_along_normal(along))
    first = math.atan2(dy, dx)
    angles = first + np.array([0.0, initial_angle, math.pi, math.pi + initial_angle])
    out = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return SeedStar(
        face=np.full(4, face, dtype=np.int32),
        xy=np.tile([x, y], (4, 1)),
        out=out,
        far_edge=np.full(4, -1, dtype=np.int64),
        sector=np.array([initial_angle, math.pi - initial_angle] * 2),
        tangent=out[:2],
    )


def _at_vertex(surface: Surface, face: int, corner: int, along: FloatArray, initial_angle: float) -> SeedStar:
    mesh = surface.unfolding
    vertex = int(surface.faces[face, corner])
    total = float(mesh.vertex_angle[vertex])
    best: tuple[float, int, int, float, float] | None = None
    f, k = face, corner
    while True:
        dx, dy = _planar(surface, f, along)
        size = math.hypot(dx, dy)
        sector, ex, ey = corner_angle(mesh, f, k)
        if size > 1e-6:
            at = math.atan2(ex * dy - ey * dx, ex * dx + ey * dy)
            # how far out of this face's sector the projection points: none is best, then the longer projection
            beyond = max(-at, at - sector, 0.0)
            score = size if beyond <= 1e-9 else -beyond
            if best is None or score > best[0] + 1e-12:
                at = min(max(at, 0.0), sector)
                c, s = math.cos(at), math.sin(at)
                best = (score, f, k, c * ex - s * ey, s * ex + c * ey)
        code = int(mesh.neighbour[f, (k + 2) % 3])
        f, k = code // 3, code % 3
        if f == face and k == corner:
            break
    if best is None:
        raise StartError(_along_normal(along))
    _, f, k, dx, dy = best
    part = initial_angle / (2 * math.pi) * total
    turns = [0.0, part, total / 2 - part, part]
    faces, places, outs, far = [], [], [], []
    for turn in turns:
        f, k, dx, dy = turn_about_vertex(mesh, f, k, dx, dy, turn)
        faces.append(f)
        places.append(corner_place(mesh, f, k))
        outs.append((dx, dy))
        far.append((k + 1) % 3)
    return SeedStar(
        face=np.array(faces, dtype=np.int32),
        xy=np.array(places, dtype=np.float64),
        out=np.array(outs, dtype=np.float64),
        far_edge=np.array(far, dtype=np.int64),
        sector=np.array([part, total / 2 - part] * 2),
        tangent=np.array([outs[0], turn_into(mesh.plane, mesh.neighbour, mesh.frame, faces[1], *outs[1], faces[0])]),
    )


def star_of_rays(surface: Surface, rays: Rays, leave: Sequence[Ray], tangents: tuple[float, float]) -> SeedStar:
    """Half-fibres that leave a seed in given directions.

    Parameters
    ----------
    rays : Rays
        Of the seed.
    leave : four Ray
        +warp, +weft, -warp, -weft.
    tangents : (warp, weft)
        Angles of the fibres themselves.
    """
    angle = np.array([rays.angle(ray.face, ray.dx, ray.dy) for ray in leave])
    mesh, face = surface.unfolding, leave[0].face
    tangent = []
    for at in tangents:
        ray = rays.ray(at)
        tangent.append(turn_into(mesh.plane, mesh.neighbour, mesh.frame, ray.face, ray.dx, ray.dy, face))
    return SeedStar(
        face=np.array([ray.face for ray in leave], dtype=np.int32),
        xy=np.array([[ray.x, ray.y] for ray in leave]),
        out=np.array([[ray.dx, ray.dy] for ray in leave]),
        far_edge=np.array([ray.far_edge for ray in leave], dtype=np.int64),
        sector=(np.roll(angle, -1) - angle) % rays.total,
        tangent=np.array(tangent),
    )


def _planar(surface: Surface, face: int, along: FloatArray) -> tuple[float, float]:
    frame = surface.unfolding.frame[face]
    return float(along @ frame[3:6]), float(along @ frame[6:9])


def _in_frame(surface: Surface, face: int, position: FloatArray) -> tuple[float, float]:
    frame = surface.unfolding.frame[face]
    return float((position - frame[:3]) @ frame[3:6]), float((position - frame[:3]) @ frame[6:9])


def _into(surface: Surface, face: int, edge: int, along: FloatArray) -> float:
    """How far `along` points from the edge into the face."""
    dx, dy = _planar(surface, face, along)
    line = surface.unfolding.line[face, 3 * edge : 3 * edge + 2]
    return float(line[0] * dx + line[1] * dy)


def _along_normal(along: FloatArray) -> str:
    return f"direction {_triple(along)} is along the mould's normal at the seed; give one that runs along the surface"


def _triple(vector: FloatArray) -> str:
    return "(" + ", ".join(f"{v:g}" for v in np.ravel(vector)) + ")"
