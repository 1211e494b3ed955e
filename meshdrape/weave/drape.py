"""drape(): a fabric over a mould, from a seed and a direction to a net."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import FabricError, StartError
from meshdrape.mould.mesh.check import FARTHEST
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.meeting import end_where_met
from meshdrape.weave.lay.recross import creases_of, end_where_recrossed
from meshdrape.weave.lay.sheet import lay, trim
from meshdrape.weave.net import Net, Request
from meshdrape.weave.start.prescribed import courses_on, prescribe
from meshdrape.weave.start.seed import numbers, part_under

if TYPE_CHECKING:
    from meshdrape.mould import Mould

FloatArray = NDArray[np.float64]

ENGINES = ("fast", "libigl")
# Digits that a coordinate has, relative to the mould's size.
ROUND_OFF = 1e-16


def drape(
    mould: Mould,
    fabric: Fabric,
    seed: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    engine: str = "fast",
    extent: tuple[float, float, float, float] | None = None,
    *,
    warp_turn: float | None = None,
    weft_turn: float | None = None,
    warp_path: ArrayLike | None = None,
    weft_path: ArrayLike | None = None,
    stop_at: float | None = None,
    recrossing: bool = False,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Net:
    """The fishnet of a fabric on a mould.

    The warp generator leaves the seed along `direction`, projected on the surface, the weft generator at the fabric's
    initial angle counter-clockwise about the normal; both are straightest geodesics, unless told otherwise. Every
    other node lies at one spacing, measured by exact polyhedral geodesic distance, from its two neighbours nearer to
    the seed.

    Parameters
    ----------
    mould : Mould
    fabric : Fabric
    seed : (3,) float, mm
        Projected on the mould; default the point of the mould nearest to its centroid. With a path, the seed is the
        path's nearest point, by default its middle; with two, their nearest crossing, by default that nearest to the
        middle of the warp's.
    direction : (3,) float
        Default the longest axis of the bounding box that is not along the normal. With a path it only chooses which
        way along it the net counts; default as the path is drawn.
    engine : "fast" or "libigl"
        "libigl" has every node off the generators looked for by its exact distances from both parents and taken only
        where libigl measures the spacing: slow, the reference that "fast" agrees with to 1e-9 of the spacing.
    extent : (warp-, warp+, weft-, weft+), mm
        Cloth from the seed each way; default as far as the mould reaches.
    warp_turn, weft_turn : float, rad
        Turn of that generator where it first crosses a crease, each half at its own: counter-clockwise as seen from
        the side the cloth lies on (right-handed about the mould's normal), from the straightest way over the crease.
        Nodes keep one spacing along the bent fibre. Rows that do not start beyond the crease do not depend on it, to
        the bit, but for which of their last nodes past the border are kept as a hem. A crease is an edge at which the
        normals of its two triangles differ by more than 20 degrees; between two faces of a CAD file more than 2
        degrees, and twice the angle tolerance, suffice. It goes on past the border it ends at. A rounded edge has none.
    warp_path, weft_path : (n, 3) float, mm
        Points of that generator in their order: each projected on the mould, joined by geodesics, with nodes at equal
        arc length along the curve from the seed on, both ways; past its ends the fibre goes straight on. It keeps its
        own geodesic curvature, so its edges are arcs whose ends lie nearer than one spacing. The other generator
        crosses it straight at the initial angle, unless it has a path of its own: then at the angle as drawn. The
        direction it is counted from lies midway between the fibre's first edges on both sides of the seed: the curve's
        own where it bends evenly; at a kink, half of it; at a kink less than a spacing off, half of what that turns
        the first edge by.
    stop_at : float, rad
        The cloth ends, cell by cell, before the first that would be sheared by more: STOPPED.
    recrossing : bool
        Go on where a fibre comes back over a crease that it crossed, by at least half a spacing, instead of ending it
        there as RECROSSED: a sheet laid undeformed on one side has no such fibre. A crease that closes on itself,
        round a boss, may always be crossed twice.
    threads : int
        Default the number of cores. The net does not depend on it.
    progress : callable
        Called with the number of nodes placed so far.

    Returns
    -------
    Net

    Raises
    ------
    StartError
        If the seed lies farther than one spacing from the mould, the direction is zero or along the normal, or a
        generator that is to turn never meets a crease or turns back over it; if a point of a path lies farther than
        one spacing from the mould, or two paths do not cross.
    FabricError
        If the spacing is larger than the mould, or below the round-off of its coordinates.
    NetError
        If the net would not fit in the memory.
    """
    _check_request(mould, fabric, engine, extent, stop_at, threads)
    threads = threads or os.cpu_count() or 1
    given = prescribe(warp_turn, weft_turn, warp_path, weft_path)
    drawn = given.paths[0] if given.paths[0] is not None else given.paths[1]
    whole = mould.surface
    asked = seed is not None
    if seed is None:
        seed = (whole.middle if drawn is None else whole.closest_point(drawn[0])[0]).position(whole)
    seed = numbers("seed", seed)
    # NaN fails the comparison too
    if seed.shape != (3,) or not (np.abs(seed) <= FARTHEST).all():
        msg = f"seed {seed.tolist()} is not a point within {FARTHEST:g} mm; give X,Y,Z in mm"
        raise StartError(msg)
    longest = fabric.longest
    point, distance = whole.closest_point(seed)
    if distance > longest:
        near = ", ".join(f"{v:.6g}" for v in point.position(whole))
        msg = (
            f"seed ({', '.join(f'{v:g}' for v in seed)}) lies {distance:.6g} mm from the mould, farther than "
            f"one spacing ({longest:g} mm); the nearest point is ({near})"
        )
        raise StartError(msg)
    notes = []
    part, part_face, point = part_under(whole, point, seed)
    if part is not whole:
        notes.append(
            f"the mould has {whole.n_components} separate parts; draped the seed's, {len(part.faces)} triangles"
        )
    courses, drawn_point = courses_on(mould, part, part_face, fabric, given, seed if asked else None, direction)
    if drawn_point is not None:
        point = drawn_point
        moved = float(np.linalg.norm(point.position(part) - seed))
        if asked and moved > max(distance, 1e-6 * longest):
            notes.append(f"the seed was moved {moved:.4g} mm onto the drawn fibre")
    if direction is None:
        direction = default_direction(part, point.face)
    # far from the origin, places in space would be too coarse to close a cell by; a path is drawn where it was given
    close, by = part.brought_near if drawn is None else (part, np.zeros(3))
    laid = lay(
        close,
        fabric,
        point,
        direction,
        extent,
        threads,
        progress,
        courses=courses,
        stop_at=math.pi if stop_at is None else stop_at,
        settle_every=engine == "libigl",
    )
    surface, lattice, start = laid.surface, laid.lattice, laid.start
    end_where_met(close, surface, fabric, lattice, start)
    if not recrossing:
        creases = creases_of(close, mould.triangle_face[part_face], mould.angle_tolerance)
        end_where_recrossed(creases, surface, fabric, lattice, start, threads)
    trim(surface, fabric, lattice, start, threads)
    if close is not part:
        surface = surface.moved(-by)
    frame = surface.unfolding.frame[start.face[0]]
    return Net(
        mould=mould,
        fabric=fabric,
        surface=surface,
        surface_face=part_face,
        lattice=lattice,
        start=start,
        seed=point.position(part),
        seed_distance=distance,
        direction=start.tangent[0, 0] * frame[3:6] + start.tangent[0, 1] * frame[6:9],
        collar_depth=laid.collar_depth,
        start_fibres=given,
        request=Request(engine, extent, stop_at, recrossing),
        notes=tuple(notes),
        settled_by_libigl=laid.settled,
        libigl_seconds=laid.seconds,
        threads=threads,
    )


def default_direction(surface: Surface, face: int) -> FloatArray:
    """The longest side of the bounding box that runs along the surface at a face rather than off it, (3,)."""
    for axis in np.argsort(-surface.extent):
        along = np.eye(3)[axis]
        if abs(float(along @ surface.face_normal[face])) < math.cos(math.radians(30.0)):
            return np.asarray(along)
    return np.array([1.0, 0.0, 0.0])


def _check_request(
    mould: Mould,
    fabric: Fabric,
    engine: str,
    extent: tuple[float, float, float, float] | None,
    stop_at: float | None,
    threads: int | None,
) -> None:
    """Raise StartError or FabricError for what no mould could be draped with, or not this one."""
    if engine not in ENGINES:
        msg = f"there is no engine {engine!r}; choose one of {', '.join(ENGINES)}"
        raise StartError(msg)
    longest = fabric.longest
    size = mould.surface.diagonal
    if longest > size:
        msg = f"spacing {longest:g} mm is larger than the mould, {size:g} mm across; check the unit of either"
        raise FabricError(msg)
    shortest = fabric.shortest
    if shortest < ROUND_OFF * size:
        msg = (
            f"spacing {shortest:g} mm is lost in the round-off of a mould {size:g} mm across; check the unit of either"
        )
        raise FabricError(msg)
    if extent is not None:
        lengths = numbers("extent", extent)
        if lengths.shape != (4,) or not (lengths >= 0).all():
            given = tuple(np.ravel(lengths).tolist())
            msg = f"extent {given} must be four lengths in mm, none negative: warp-, warp+, weft-, weft+"
            raise StartError(msg)
    if threads is not None and not (isinstance(threads, int | np.integer) and threads > 0):
        msg = f"threads is {threads!r}; give a whole number from 1 on, or none for all cores"
        raise StartError(msg)
    if stop_at is not None and not numbers("stop_at", stop_at) > 0:
        msg = f"the cloth cannot stop at a shear of {math.degrees(stop_at):g} degrees; give one above 0"
        raise StartError(msg)
