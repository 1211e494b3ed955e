"""Start fibres as a user asks for them: turned at a crease, or drawn on the mould."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import StartError
from meshdrape.mould.mesh.check import FARTHEST
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.crease import crease_edges
from meshdrape.weave.start.fibre import FAMILY, Course, Track, Turn
from meshdrape.weave.start.path import crossings, draw
from meshdrape.weave.start.seed import unit_direction

if TYPE_CHECKING:
    from meshdrape.mould import Mould

FloatArray = NDArray[np.float64]

# Two drawn fibres that come this near, in spacings, cross.
MEET = 1e-6
# A drawn crossing nearer to parallel than this, rad, is folded before it starts.
LEAST_ANGLE = math.radians(1.0)


@dataclass(frozen=True, eq=False)
class StartFibres:
    """What a user prescribed of the two generators; nothing of it makes them straight.

    Attributes
    ----------
    warp_turn, weft_turn : float or None
        Turn at the first crease, rad.
    warp_path, weft_path : (n, 3) float64 or None
        Points the fibre runs through, mm, as they were given.
    """

    warp_turn: float | None = None
    weft_turn: float | None = None
    warp_path: FloatArray | None = None
    weft_path: FloatArray | None = None

    def __bool__(self) -> bool:
        return any(value is not None for value in (*self.turns, *self.paths))

    @property
    def turns(self) -> tuple[float | None, float | None]:
        """Of warp and weft, rad."""
        return self.warp_turn, self.weft_turn

    @property
    def paths(self) -> tuple[FloatArray | None, FloatArray | None]:
        """Of warp and weft, (n, 3) mm each."""
        return self.warp_path, self.weft_path


def prescribe(
    warp_turn: float | None, weft_turn: float | None, warp_path: ArrayLike | None, weft_path: ArrayLike | None
) -> StartFibres:
    """What was asked for, turns in rad and paths (n, 3) in mm, checked as far as it can be without the mould.

    Raises
    ------
    StartError
        If a turn is no angle below half a turn, a path is no list of points, or one fibre has both.
    """
    paths: list[FloatArray | None] = []
    for name, turn, path in zip(FAMILY, (warp_turn, weft_turn), (warp_path, weft_path), strict=True):
        if turn is not None and not abs(turn) < math.pi:
            msg = f"{name}_turn is {turn} rad; it must lie between -pi and pi"
            raise StartError(msg)
        if turn is not None and path is not None:
            msg = f"the {name} has both {name}_turn and {name}_path; give one: a path has its turns drawn in it"
            raise StartError(msg)
        paths.append(None if path is None else _points(path, f"{name}_path"))
    return StartFibres(
        None if warp_turn is None else float(warp_turn), None if weft_turn is None else float(weft_turn), *paths
    )


def _points(path: ArrayLike, name: str) -> FloatArray:
    try:
        points = np.array(path, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 2:
        msg = f"{name} has the shape {points.shape}; give at least two points as (n, 3), in mm"
        raise StartError(msg)
    # NaN fails the comparison too
    wrong = np.flatnonzero(~(np.abs(points) <= FARTHEST).all(axis=1))
    if len(wrong):
        msg = (
            f"{name}: point {wrong[0] + 1} is {points[wrong[0]].tolist()}; every coordinate must be a number within "
            f"{FARTHEST:g} mm"
        )
        raise StartError(msg)
    points.setflags(write=False)
    return points


def courses_on(
    mould: Mould,
    part: Surface,
    part_face: NDArray[np.int64],
    fabric: Fabric,
    given: StartFibres,
    seed: FloatArray | None,
    direction: ArrayLike | None,
) -> tuple[tuple[Course, Course], SurfacePoint | None]:
    """The courses of warp and weft on the draped part of a mould, and the seed on a drawn fibre; None of none.

    Parameters
    ----------
    mould : Mould
    part : Surface
    part_face : (m,) int
        The mould's triangle behind each face of the part.
    fabric : Fabric
    given : StartFibres
    seed, direction
        See :func:`tracks_on`.

    Raises
    ------
    StartError
        If a path cannot be drawn, or two do not cross.
    """
    turns = turns_on(part, mould.triangle_face[part_face], mould.angle_tolerance, given.turns)
    tracks: tuple[Track | None, Track | None] = (None, None)
    point = None
    if any(path is not None for path in given.paths):
        called = "the mould" if part is mould.surface else "the part of the mould it is drawn on"
        tracks, point = tracks_on(part, fabric, given.paths, seed, direction, called)
    return (Course(turns[0], tracks[0]), Course(turns[1], tracks[1])), point


def tracks_on(
    part: Surface,
    fabric: Fabric,
    paths: tuple[FloatArray | None, FloatArray | None],
    seed: FloatArray | None,
    direction: ArrayLike | None,
    called: str = "the mould",
) -> tuple[tuple[Track | None, Track | None], SurfacePoint]:
    """The drawn fibres on the draped part, run the way the net counts, and the seed on them.

    Parameters
    ----------
    part : Surface
    paths : (warp, weft)
        At least one.
    seed : (3,) mm, optional
        The seed is the point of the path nearest to it, or the nearest of two paths' crossings. Default: the paths'
        crossing, or the path's middle.
    direction : (3,), optional
        The warp runs along it rather than against it; default: as the path is drawn.
    called : str
        What errors call the part.

    Raises
    ------
    StartError
        If a path cannot be drawn, or two do not cross.
    """
    longest = fabric.longest
    along = None if direction is None else unit_direction(direction)
    drawn = [
        None if points is None else draw(part, points, longest, f"{name}_path", called)
        for name, points in zip(FAMILY, paths, strict=True)
    ]
    warp, weft = drawn
    if warp is None or weft is None:
        path = warp if warp is not None else weft
        assert path is not None
        track = Track(path, 0.5 * path.length if seed is None else path.nearest(seed)[0])
        point = path.point_at(track.at)
        run, normal = _run(part, track)
        if warp is None:
            # the weft lies at the initial angle from the warp
            c, s = math.cos(fabric.initial_angle), math.sin(fabric.initial_angle)
            run = c * run - s * np.cross(normal, run)
        if along is not None and float(run @ along) < 0:
            track = track.reversed()
        return ((track, None) if warp is not None else (None, track)), point
    within = MEET * fabric.shortest
    found, least, where = crossings(warp, weft, within)
    if not found:
        near = ", ".join(f"{v:.6g}" for v in where)
        msg = (
            f"warp_path and weft_path do not cross: they are {least:.6g} mm apart where they come nearest, at "
            f"({near}); draw both through one point"
        )
        raise StartError(msg)
    if seed is None:
        at = min(found, key=lambda pair: abs(pair[0] - 0.5 * warp.length))
    else:
        at = min(found, key=lambda pair: float(np.linalg.norm(warp.point_at(pair[0]).position(part) - seed)))
    first, second = Track(warp, at[0]), Track(weft, at[1])
    run, normal = _run(part, first)
    if along is not None and float(run @ along) < 0:
        first, run = first.reversed(), -run
    across, _ = _run(part, second)
    left = float(np.cross(run, across) @ normal)
    if abs(math.atan2(left, abs(float(run @ across)))) < LEAST_ANGLE:
        msg = "warp_path and weft_path run along each other where they meet; draw them at an angle"
        raise StartError(msg)
    return (first, second if left > 0 else second.reversed()), warp.point_at(at[0])


def _run(surface: Surface, track: Track) -> tuple[FloatArray, FloatArray]:
    """Direction of a track at the seed, the mean of both sides', and the normal there, (3,) each."""
    frame = surface.unfolding.frame
    sides, normals = [], []
    for sense, side in ((1.0, track), (-1.0, track.reversed())):
        face, _, run = side.path.place_at(side.at)
        sides.append(sense * (run.real * frame[face, 3:6] + run.imag * frame[face, 6:9]))
        normals.append(surface.face_normal[face])
    return np.asarray(sides[0] + sides[1]), np.asarray(normals[0] + normals[1]) / 2


def turns_on(
    part: Surface, cad_face: NDArray[np.int64], angle_tolerance: float | None, angles: tuple[float | None, float | None]
) -> tuple[Turn | None, Turn | None]:
    """Turns of both generators at the creases of the draped part.

    Parameters
    ----------
    part : Surface
    cad_face : (m,) int
        Id of the CAD face each triangle lies on, 0 where there is none.
    angle_tolerance : float or None
        Of the tessellation, rad.
    angles : (warp, weft)
        rad; None for a fibre that does not turn.
    """
    if angles == (None, None):
        return None, None
    crease = crease_edges(part, cad_face, angle_tolerance)
    warp, weft = (None if angle is None else Turn(angle, crease) for angle in angles)
    return warp, weft
