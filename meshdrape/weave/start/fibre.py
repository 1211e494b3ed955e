"""The halves of a start fibre, each a row of nodes outward from the seed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import StartError
from meshdrape.geodesic.shortest import shortest_path, without_specks
from meshdrape.kernels.generator import NOT_TURNED, TURNED_BACK, trace
from meshdrape.kernels.walk import turn_into
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.start.path import SurfacePath
from meshdrape.weave.start.rays import Ray, Rays

FloatArray = NDArray[np.float64]

FAMILY = ("warp", "weft")
# Nodes nearer than this share of the spacing to a joint of a path lie on it: round-off.
AT_JOINT = 1e-9
# A path goes straight on along its last piece longer than this share of the spacing.
LAST_PIECE = 1e-6


@dataclass(frozen=True, eq=False)
class HalfFibre:
    """Nodes of one half of a start fibre, the seed left out, and the edges that reach them.

    Attributes
    ----------
    face : (n,) int32
    xy : (n, 2) in the frame of that face, mm
    out, into : (n, 2)
        Unit directions in which the edges leave and reach each node, in the frame of its face.
    through : (n,) bool
        Whether a vertex lies on the edge that reaches the node.
    arc : (n,) bool
        Whether the fibre bends on that edge, so that its ends lie nearer than one spacing. The edge's directions are
        then those of the shortest path between its ends, so that cells are measured by their own nodes.
    leave : Ray or None
        Direction of the first edge at the seed, where the star of the seed does not say it.
    """

    face: NDArray[np.int32]
    xy: FloatArray
    out: FloatArray
    into: FloatArray
    through: NDArray[np.bool_]
    arc: NDArray[np.bool_]
    leave: Ray | None = None

    def __len__(self) -> int:
        return len(self.face)


@dataclass(frozen=True, eq=False)
class Turn:
    """A turn at a crease.

    Attributes
    ----------
    angle : float
        Counter-clockwise about the mould's normal, rad.
    crease : (m, 3) bool
        Edges at which the fibre may turn, of the mould's faces or of those with its extension.
    """

    angle: float
    crease: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Track:
    """A curve that a start fibre follows, and the arc length at which the seed lies on it, mm."""

    path: SurfacePath
    at: float

    def reversed(self) -> Track:
        """The same, run the other way."""
        return Track(self.path.reversed(), self.path.length - self.at)


@dataclass(frozen=True, eq=False)
class Course:
    """How one start fibre runs: straight on, unless it turns at a crease or follows a curve."""

    turn: Turn | None = None
    track: Track | None = None


Courses = tuple[Course, Course]
"""Of the warp and of the weft generator."""

STRAIGHT: Courses = (Course(), Course())


def straight_half(
    surface: Surface, ray: Ray, half: int, spacing: float, count: int, turn: Turn | None = None
) -> tuple[HalfFibre, bool]:
    """A half-fibre that runs straight, but for a turn where it first crosses a crease; and whether it turned.

    Parameters
    ----------
    ray : Ray
        Direction at the seed.
    half : int
        0 to 3: +warp, +weft, -warp, -weft.
    spacing : float
        mm along the fibre.
    count : int
        Most nodes.
    turn : Turn, optional

    Raises
    ------
    StartError
        If the turn leads back over the crease.
    """
    fibre, code, turned = _traced(surface, ray, 0.0, spacing, count, turn)
    if turn is not None and code == TURNED_BACK:
        name = FAMILY[half % 2]
        msg = (
            f"a {name} turn of {math.degrees(turn.angle):g} degrees leads the {name} back over the crease; "
            f"give a smaller {name}_turn"
        )
        raise StartError(msg)
    if 0 <= turned < len(fibre):
        fibre.arc[turned] = True
    return _by_chords(surface, fibre, ray), turned != NOT_TURNED


def track_half(surface: Surface, point: SurfacePoint, track: Track, spacing: float, count: int) -> HalfFibre:
    """The half-fibre from the seed to the end of a track, at equal arc length along it, and straight on from there.

    Its `leave` is always set.

    Parameters
    ----------
    surface : Surface
        The one the track was drawn on, or its extension.
    point : SurfacePoint
        The seed.
    track : Track
    spacing : float
        mm along the curve.
    count : int
        Most nodes.
    """
    path, joint = track.path, AT_JOINT * spacing
    if path.length - track.at <= joint:
        rays = Rays(surface, point)
        back = rays.angle(int(path.face[-1]), *_pair(-path.direction[-1]))
        ray = rays.ray(back + 0.5 * rays.total)
        return replace(_traced(surface, ray, 0.0, spacing, count)[0], leave=ray)
    on = min(int((path.length - track.at + joint) / spacing), count)
    length = np.minimum(track.at + spacing * np.arange(on + 1), path.length)
    piece = np.array([path.piece_at(at + joint) for at in length])
    xy = path.tail[piece] + (length - path.knot[piece]) * path.direction[piece]
    out = path.direction[piece]
    arc = np.array([path.bends_between(a + joint, b - joint) for a, b in pairwise(length)], dtype=np.bool_)
    # from the tail of the last piece, which has length enough to hold a direction
    last = int(np.flatnonzero(np.diff(path.knot) > LAST_PIECE * spacing)[-1])
    end = Ray(int(path.face[last]), *_pair(path.tail[last]), *_pair(path.direction[last]), -1)
    beyond, _, _ = _traced(surface, end, float(path.knot[last] - length[-1]), spacing, count - on)
    if len(beyond):
        beyond.arc[0] = path.bends_between(float(length[-1]) + joint, path.length - joint)
    fibre = HalfFibre(
        face=np.concatenate([path.face[piece[1:]], beyond.face]).astype(np.int32),
        xy=np.concatenate([_pairs(xy[1:]), beyond.xy]),
        out=np.concatenate([_pairs(out[1:]), beyond.out]),
        into=np.concatenate([_arrivals(surface, path, length[1:], piece[1:], joint), beyond.into]),
        through=np.concatenate([np.zeros(on, dtype=np.bool_), beyond.through]),
        arc=np.concatenate([arc, beyond.arc]),
    )
    seed = Ray(int(path.face[piece[0]]), *_pair(xy[0]), *_pair(out[0]), -1)
    fibre = _by_chords(surface, fibre, seed)
    return fibre if fibre.leave is not None else replace(fibre, leave=seed)


def _arrivals(
    surface: Surface, path: SurfacePath, length: FloatArray, piece: NDArray[np.int64], joint: float
) -> FloatArray:
    """Directions (n, 2) in which a path reaches places on it, in the frames of the pieces that leave them."""
    mesh = surface.unfolding
    into = np.empty((len(length), 2))
    for n, (at, after) in enumerate(zip(length, piece, strict=True)):
        before = path.piece_at(at - joint)
        into[n] = turn_into(
            mesh.plane, mesh.neighbour, mesh.frame, path.face[before], *_pair(path.direction[before]), path.face[after]
        )
    return into


def _traced(
    surface: Surface, ray: Ray, run: float, spacing: float, count: int, turn: Turn | None = None
) -> tuple[HalfFibre, int, int]:
    """Nodes from a ray straight on, the outcome of the trace, and where it turned."""
    face = np.empty(count, dtype=np.int32)
    xy, out, into = (np.empty((count, 2)) for _ in range(3))
    through = np.zeros(count, dtype=np.bool_)
    crease = np.zeros((0, 3), dtype=np.bool_) if turn is None else turn.crease
    code, n, _, turned = trace(
        surface.unfolding, crease, 0.0 if turn is None else turn.angle, *ray, run, spacing, count, face, xy, out, into,
        through,
    )  # fmt: skip
    fibre = HalfFibre(face[:n], xy[:n], out[:n], into[:n], through[:n], np.zeros(n, dtype=np.bool_))
    return fibre, int(code), int(turned)


def _by_chords(surface: Surface, fibre: HalfFibre, seed: Ray) -> HalfFibre:
    """The half-fibre with the directions of the shortest paths between the ends of its bent edges."""
    bent = np.flatnonzero(fibre.arc)
    if not len(bent):
        return fibre
    mesh = surface.unfolding
    leave = fibre.leave
    for n in bent.tolist():
        tail = (seed.face, seed.x, seed.y) if n == 0 else (int(fibre.face[n - 1]), *fibre.xy[n - 1])
        head = (int(fibre.face[n]), *fibre.xy[n])
        ends = [SurfacePoint.from_frame(surface, *place) for place in (tail, head)]
        chord = without_specks(shortest_path(surface, ends[0], ends[1]))
        first, last = chord[0], chord[-1]
        if n == 0:
            leave = Ray(first.face, *_pair(first.tail), *_pair(first.direction), -1)
        else:
            fibre.out[n - 1] = turn_into(
                mesh.plane, mesh.neighbour, mesh.frame, first.face, *_pair(first.direction), fibre.face[n - 1]
            )
        fibre.into[n] = turn_into(
            mesh.plane, mesh.neighbour, mesh.frame, last.face, *_pair(last.direction), fibre.face[n]
        )
    return replace(fibre, leave=leave)


def _pair(z: complex) -> tuple[float, float]:
    return float(z.real), float(z.imag)


def _pairs(z: NDArray[np.complex128]) -> FloatArray:
    return np.stack([z.real, z.imag], axis=1)
