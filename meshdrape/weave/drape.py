"""drape(): a fabric over a mould, from a seed and a direction to a net."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import FabricError, StartError
from meshdrape.kernels import emit
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface
from meshdrape.weave.collar import extended
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.generators import (
    check_memory,
    empty_lattice,
    free_memory,
    generator_counts,
    lay_generators,
)
from meshdrape.weave.meeting import end_where_met
from meshdrape.weave.net import Net, run_kernel
from meshdrape.weave.quadrants import fill
from meshdrape.weave.start import seed_star
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.mould import Mould

FloatArray = NDArray[np.float64]

# Depth of the collar in spacings. A cell's diagonal is shorter than two, so the parents of every node on the mould
# find a place on it; two more carry the hem.
COLLAR_DEPTH = 4.0
# Cells of cloth kept past the last that touches the mould.
HEM = 2


def drape(
    mould: Mould,
    fabric: Fabric,
    seed: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    *,
    extent: tuple[float, float, float, float] | None = None,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Net:
    """The fishnet of a fabric on a mould.

    The warp generator leaves the seed along `direction`, projected on the surface, the weft generator at the fabric's
    initial angle counter-clockwise about the normal; both are straightest geodesics. Every other node lies at one
    spacing, measured by exact polyhedral geodesic distance, from its two neighbours nearer to the seed.

    Parameters
    ----------
    mould : Mould
    fabric : Fabric
    seed : (3,) float, mm
        Projected on the mould; default the point of the mould nearest to its centroid.
    direction : (3,) float
        Default the longest axis of the bounding box that is not along the normal.
    extent : (warp-, warp+, weft-, weft+), mm
        Cloth from the seed each way; default as far as the mould reaches.
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
        If the seed lies farther than one spacing from the mould, or the direction is zero or along the normal.
    FabricError
        If the spacing is larger than the mould.
    NetError
        If the net would not fit in the memory.
    """
    threads = threads or os.cpu_count() or 1
    longest = max(fabric.warp_spacing, fabric.weft_spacing)
    size = float(np.linalg.norm(mould.size))
    if longest > size:
        msg = f"spacing {longest:g} mm is larger than the mould, {size:g} mm across; check the unit of either"
        raise FabricError(msg)
    extent = _checked_extent(extent)
    whole = mould.surface
    if seed is None:
        seed = whole.closest_point(default_seed(whole))[0].position(whole)
    seed = np.asarray(seed, dtype=np.float64)
    if seed.shape != (3,) or not np.isfinite(seed).all():
        msg = f"seed {seed.tolist()} is not a point; give X,Y,Z in mm"
        raise StartError(msg)
    point, distance = whole.closest_point(seed)
    if distance > longest:
        near = ", ".join(f"{v:.6g}" for v in point.position(whole))
        msg = (
            f"seed ({', '.join(f'{v:g}' for v in seed)}) lies {distance:.6g} mm from the mould, farther than "
            f"one spacing ({longest:g} mm); the nearest point is ({near})"
        )
        raise StartError(msg)
    notes = []
    part, part_face = whole, np.arange(len(whole.faces))
    if whole.n_components > 1:
        number = int(whole.face_component[point.face])
        part, part_face = whole.component(number)
        notes.append(
            f"the mould has {whole.n_components} separate parts; draped the seed's, {len(part.faces)} triangles"
        )
        point, _ = part.closest_point(seed)
    if direction is None:
        direction = default_direction(part, point.face)
    surface = extended(part, COLLAR_DEPTH * longest)
    star = seed_star(surface, point, direction, fabric.initial_angle)
    frame = surface.unfolding.frame[star.face[0]]
    memory = free_memory()
    counts = generator_counts(part, fabric, extent)
    lattice, start = lay_generators(surface, fabric, star, counts, memory)
    lattice, start, settled = _fill_all(surface, fabric, lattice, start, counts, memory, threads, progress)
    end_where_met(part, surface, fabric, lattice, start)
    _trim(surface, fabric, lattice, start, threads)
    return Net(
        mould=mould,
        fabric=fabric,
        surface=surface,
        surface_face=part_face,
        lattice=lattice,
        start=start,
        seed=point.position(part),
        seed_distance=distance,
        direction=star.out[0, 0] * frame[3:6] + star.out[0, 1] * frame[6:9],
        notes=tuple(notes),
        settled_by_libigl=settled,
        threads=threads,
    )


def default_seed(surface: Surface) -> FloatArray:
    """The centroid of the surface, (3,) mm: projected, it is a seed near the middle of the mould."""
    centres = surface.vertices[surface.faces].mean(axis=1)
    return np.asarray(np.average(centres, axis=0, weights=surface.face_area))


def default_direction(surface: Surface, face: int) -> FloatArray:
    """The longest side of the bounding box that runs along the surface at a face rather than off it, (3,)."""
    extent = np.ptp(surface.vertices, axis=0)
    for axis in np.argsort(-extent):
        along = np.eye(3)[axis]
        if abs(float(along @ surface.face_normal[face])) < math.cos(math.radians(30.0)):
            return np.asarray(along)
    return np.array([1.0, 0.0, 0.0])


def _checked_extent(
    extent: tuple[float, float, float, float] | None,
) -> tuple[float, float, float, float] | None:
    if extent is None:
        return None
    if len(extent) != 4 or not all(length >= 0 for length in extent):
        msg = f"extent {tuple(extent)} must be four lengths in mm, none negative: warp-, warp+, weft-, weft+"
        raise StartError(msg)
    return extent


def _fill_all(
    surface: Surface,
    fabric: Fabric,
    lattice: Lattice,
    start: Start,
    counts: list[int],
    memory: int,
    threads: int,
    progress: Callable[[int], None] | None,
) -> tuple[Lattice, Start, int]:
    """Fill the quadrants; where the mould goes on past the generators' ends, give the lattice room and fill on."""
    settled = 0
    while True:
        start, more = fill(surface, fabric, lattice, start, threads, progress)
        settled += more
        grow = _room_wanted(lattice, start, counts)
        if not any(grow):
            return lattice, start, settled
        lattice, start = _grown(lattice, start, grow, fabric, memory)


def _room_wanted(lattice: Lattice, start: Start, counts: list[int]) -> tuple[int, int, int, int]:
    """Rows to add before and after, columns before and after: where a side has nodes on the mould, a quarter more."""
    status = lattice.status
    n_warp, n_weft = status.shape
    i0, j0 = (int(v) for v in start.origin)
    have = (i0, n_warp - 1 - i0, j0, n_weft - 1 - j0)
    most = (counts[2], counts[0], counts[3], counts[1])
    sides = (status[0], status[-1], status[:, 0], status[:, -1])
    length = (n_warp, n_warp, n_weft, n_weft)
    before_i, after_i, before_j, after_j = (
        min(max(8, n // 4), limit - got) if (side == NodeStatus.PLACED).any() else 0
        for side, n, limit, got in zip(sides, length, most, have, strict=True)
    )
    return before_i, after_i, before_j, after_j


def _grown(
    lattice: Lattice, start: Start, grow: tuple[int, int, int, int], fabric: Fabric, memory: int
) -> tuple[Lattice, Start]:
    before_i, after_i, before_j, after_j = grow
    n_warp, n_weft = lattice.status.shape
    shape = (n_warp + before_i + after_i, n_weft + before_j + after_j)
    check_memory(*shape, fabric, memory)
    larger = empty_lattice(shape)
    window = (slice(before_i, before_i + n_warp), slice(before_j, before_j + n_weft))
    larger.face[window], larger.status[window] = lattice.face, lattice.status
    larger.xy[window], larger.warp_out[window], larger.weft_out[window] = lattice.xy, lattice.warp_out, lattice.weft_out
    i0, j0 = start.origin[0] + before_i, start.origin[1] + before_j
    # nothing beyond a generator's end is ever on that generator
    larger.status[:, j0][np.r_[0:before_i, before_i + n_warp : shape[0]]] = NodeStatus.OUTSIDE
    larger.status[i0, :][np.r_[0:before_j, before_j + n_weft : shape[1]]] = NodeStatus.OUTSIDE
    # bent edges are known by their place in the lattice
    cell, family = start.bent_key // 2, start.bent_key % 2
    i, j = cell // n_weft + before_i, cell % n_weft + before_j
    moved = start._replace(origin=np.array([i0, j0]), bent_key=2 * (i * shape[1] + j) + family)
    return larger, moved


def _trim(surface: Surface, fabric: Fabric, lattice: Lattice, start: Start, threads: int) -> None:
    n_warp, n_weft = lattice.status.shape
    touching = np.empty((max(n_warp - 1, 0), max(n_weft - 1, 0)), dtype=np.bool_)
    rows = max(1, -(-(n_warp - 1) // (4 * threads)))
    run_kernel(
        emit.touching_cells,
        [
            (
                surface.unfolding,
                lattice,
                start,
                a,
                fabric.warp_spacing,
                fabric.weft_spacing,
                touching[a : a + rows],
            )
            for a in range(0, n_warp - 1, rows)
        ],
        threads,
    )
    emit.trim(lattice, touching, HEM)
