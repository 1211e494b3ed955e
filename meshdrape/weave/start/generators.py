"""The two generator fibres, and the lattice they open."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.errors import NetError, StartError
from meshdrape.kernels.emit import border_status
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.crease import continued
from meshdrape.weave.start.fibre import FAMILY, STRAIGHT, Courses, HalfFibre, Turn, straight_half, track_half
from meshdrape.weave.start.rays import Ray, Rays
from meshdrape.weave.start.seed import SeedStar, seed_star, star_of_rays
from meshdrape.weave.status import NodeStatus

# Bytes a lattice takes per entry: face, place, two directions, status.
ENTRY_BYTES = 4 + 16 + 16 + 16 + 1
# A node this near to the border, in spacings, counts as on the mould.
BORDER_SLACK = 1e-6
# More nodes than any machine holds: a spacing of next to nothing must not overflow the count.
MOST_NODES = 1e18
# Sense of the four half-fibres along warp and weft.
SENSE = ((1, 0), (0, 1), (-1, 0), (0, -1))


Extent = tuple[float, float, float, float]
"""Lengths of cloth from the seed, mm: warp-, warp+, weft-, weft+."""


def generator_counts(surface: Surface, fabric: Fabric, extent: Extent | None) -> list[int]:
    """Most nodes each half-fibre (+warp, +weft, -warp, -weft) can have.

    Bounded by the cloth's extent (warp-, warp+, weft-, weft+ from the seed, mm), else by pi times the diagonal of the
    bounding box: more than once round any convex mould.
    """
    reach = float(np.pi) * surface.diagonal
    lengths = [reach] * 4
    if extent is not None:
        lengths = [min(reach, extent[k]) for k in (1, 3, 0, 2)]
    spacing = (fabric.warp_spacing, fabric.weft_spacing) * 2
    # a cloth whose extent is a whole number of spacings keeps its last node
    return [int(min(length / step + 1e-9, MOST_NODES)) for length, step in zip(lengths, spacing, strict=True)]


def start_fibres(
    surface: Surface,
    fabric: Fabric,
    point: SurfacePoint,
    direction: ArrayLike,
    counts: list[int],
    memory: int,
    courses: Courses = STRAIGHT,
) -> tuple[SeedStar, list[HalfFibre]]:
    """The star of the seed, and the half-fibres +warp, +weft, -warp, -weft as far as surface and `counts` let them.

    Parameters
    ----------
    point : SurfacePoint
        The seed; on the tracks, if there are any.
    direction : (3,)
        Of the warp, where neither fibre follows a track.
    memory : int
        Bytes the lattice may take.
    courses : (warp, weft)

    Raises
    ------
    NetError
        If a fibre alone does not fit.
    StartError
        If a fibre that is to turn never meets a crease, or turns back over it.
    """
    spacing = (fabric.warp_spacing, fabric.weft_spacing) * 2
    for count in counts:
        check_memory(count + 1, 1, fabric, memory)
    halves: dict[int, HalfFibre] = {}
    for family, course in enumerate(courses):
        if course.track is not None:
            for half, track in ((family, course.track), (family + 2, course.track.reversed())):
                halves[half] = track_half(surface, point, track, spacing[half], counts[half])
    if halves:
        rays = Rays(surface, point)
        leave, tangents = _leaving(rays, halves, fabric.initial_angle)
        star = star_of_rays(surface, rays, leave, tangents)
    else:
        star = seed_star(surface, point, direction, fabric.initial_angle)
    for family, course in enumerate(courses):
        if course.track is not None:
            continue
        met, turn = False, course.turn
        if turn is not None:
            turn = Turn(turn.angle, continued(surface, turn.crease))
        for half in (family, family + 2):
            ray = star.ray(half)
            halves[half], turned = straight_half(surface, ray, half, spacing[half], counts[half], turn)
            met |= turned
        if turn is not None and not met:
            name = FAMILY[family]
            msg = (
                f"the {name} meets no crease to turn at; move the seed or the direction so that it crosses a sharp "
                f"edge, or give the whole fibre as {name}_path"
            )
            raise StartError(msg)
    fibres = [halves[half] for half in range(4)]
    if not all(course.track for course in courses) and any(fibre.leave for fibre in fibres):
        # a turn on the first edge: the star is that of the edges
        rays = Rays(surface, point)
        frame = [rays.angle(star.face[0], *tangent) for tangent in star.tangent]
        leave = [fibre.leave or star.ray(half) for half, fibre in enumerate(fibres)]
        star = star_of_rays(surface, rays, leave, (frame[0], frame[1]))
    return star, fibres


def _leaving(rays: Rays, halves: dict[int, HalfFibre], initial_angle: float) -> tuple[list[Ray], tuple[float, float]]:
    """Directions of the four half-fibres where at least one fibre follows a track, and the angles of both fibres.

    A fibre's own direction halves the angle its two sides make; a straight fibre crosses it at the initial angle.
    """
    total = rays.total
    part = initial_angle / (2 * math.pi) * total
    angle: dict[int, float] = {}
    tangent: dict[int, float] = {}
    for half, fibre in halves.items():
        assert fibre.leave is not None
        angle[half] = rays.angle(fibre.leave.face, fibre.leave.dx, fibre.leave.dy)
    for family in (0, 1):
        if family in halves:
            left = (angle[family + 2] - angle[family]) % total
            tangent[family] = angle[family] - 0.5 * (0.5 * total - left)
    if 0 not in halves:
        tangent[0] = tangent[1] - part
    if 1 not in halves:
        tangent[1] = tangent[0] + part
    leave: list[Ray] = []
    for half in range(4):
        drawn = halves[half].leave if half in halves else None
        leave.append(drawn or rays.ray(tangent[half % 2] + (0.5 * total if half > 1 else 0.0)))
    return leave, (tangent[0], tangent[1])


def lay_generators(
    surface: Surface,
    fabric: Fabric,
    star: SeedStar,
    halves: list[HalfFibre],
    counts: list[int],
    memory: int,
    reach: Extent | None = None,
) -> tuple[Lattice, Start]:
    """A lattice with the seed and both generators in place; everything else NOT_REACHED.

    Parameters
    ----------
    halves : list of HalfFibre
        +warp, +weft, -warp, -weft.
    memory : int
        Bytes the lattice may take.
    reach : (warp-, warp+, weft-, weft+), mm, optional
        Room to leave where the net is expected to go on past a generator's end.

    Raises
    ------
    NetError
        If the lattice does not fit: with the count of nodes and the spacing that would.
    """
    mesh = surface.unfolding
    spacing = (fabric.warp_spacing, fabric.weft_spacing) * 2
    set_nodes = [len(fibre) for fibre in halves]
    room = set_nodes
    if reach is not None:
        wanted = [int(np.ceil(reach[k] / step)) for k, step in zip((1, 3, 0, 2), spacing, strict=True)]
        room = [min(most, max(got, want)) for most, got, want in zip(counts, set_nodes, wanted, strict=True)]
    plus_i, plus_j, minus_i, minus_j = room
    shape = (minus_i + plus_i + 1, minus_j + plus_j + 1)
    check_memory(*shape, fabric, memory)
    lattice = empty_lattice(shape)
    i0, j0 = minus_i, minus_j
    # beyond a generator's end nothing is ever on that generator
    lattice.status[:, j0] = lattice.status[i0, :] = NodeStatus.OUTSIDE
    lattice.face[i0, j0] = star.face[0]
    lattice.xy[i0, j0] = star.xy[0]
    lattice.status[i0, j0] = NodeStatus.PLACED
    arrival = np.zeros((4, max(shape), 2))
    through = np.zeros((4, max(shape)), dtype=np.bool_)
    arc = np.zeros((4, max(shape)), dtype=np.bool_)
    for half, fibre in enumerate(halves):
        si, sj = SENSE[half]
        k = np.arange(1, len(fibre) + 1)
        i, j = i0 + si * k, j0 + sj * k
        lattice.face[i, j] = fibre.face
        lattice.xy[i, j] = fibre.xy
        side = np.empty(len(fibre), dtype=np.uint8)
        border_status(mesh, fibre.face, fibre.xy, border_slack(fabric), side)
        lattice.status[i, j] = side
        arrival[half, : len(fibre)] = fibre.into
        through[half, : len(fibre)] = fibre.through
        arc[half, : len(fibre)] = fibre.arc
        # the edge that leaves each node but the last, kept at its lower index
        if si:
            lattice.warp_out[i[:-1] - (si < 0), j0] = fibre.out[:-1]
        else:
            lattice.weft_out[i0, j[:-1] - (sj < 0)] = fibre.out[:-1]
    start = Start(
        origin=np.array([i0, j0]),
        face=star.face,
        xy=star.xy,
        out=star.out,
        sector=star.sector,
        n_nodes=np.array(set_nodes),
        tangent=star.tangent,
        arrival=arrival,
        through=through,
        arc=arc,
        bent_key=np.empty(0, dtype=np.int64),
        bent_ends=np.empty((0, 4)),
    )
    _keep_seed_edges(lattice, start, set_nodes)
    return lattice, start


def _keep_seed_edges(lattice: Lattice, start: Start, lengths: list[int]) -> None:
    """Keep the four edges at the seed, each in the frame in which its half-fibre starts."""
    i0, j0 = start.origin
    plus_i, plus_j, minus_i, minus_j = lengths
    if plus_i:
        lattice.warp_out[i0, j0] = start.out[0]
    if plus_j:
        lattice.weft_out[i0, j0] = start.out[1]
    if minus_i:
        lattice.warp_out[i0 - 1, j0] = start.out[2]
    if minus_j:
        lattice.weft_out[i0, j0 - 1] = start.out[3]


def border_slack(fabric: Fabric) -> float:
    """Distance from the border within which a node still counts as on the mould, mm."""
    return BORDER_SLACK * fabric.shortest


def empty_lattice(shape: tuple[int, int]) -> Lattice:
    """A lattice of NOT_REACHED nodes; the rest of it is not initialised, so memory is touched only where nodes fall."""
    return Lattice(
        face=np.empty(shape, dtype=np.int32),
        xy=np.empty((*shape, 2)),
        warp_out=np.empty((*shape, 2)),
        weft_out=np.empty((*shape, 2)),
        status=np.full(shape, NodeStatus.NOT_REACHED, dtype=np.uint8),
    )


def check_memory(n_warp: int, n_weft: int, fabric: Fabric, memory: int) -> None:
    """Raise NetError if a lattice of this shape takes more than `memory` bytes."""
    entries = n_warp * n_weft
    if entries * ENTRY_BYTES > memory:
        larger = fabric.warp_spacing * np.sqrt(entries * ENTRY_BYTES / memory)
        msg = (
            f"a spacing of {fabric.spacing} mm gives {n_warp} x {n_weft} = {entries:,} nodes, "
            f"{entries * ENTRY_BYTES / 2**30:.1f} GiB where {memory / 2**30:.1f} GiB are free; "
            f"take a spacing above {larger:.2g} mm or bound the cloth with --extent"
        )
        raise NetError(msg)


def free_memory() -> int:
    """Bytes a net may take: three fifths of what the machine has free."""
    try:
        with open("/proc/meminfo") as lines:
            for line in lines:
                if line.startswith("MemAvailable"):
                    return int(line.split()[1]) * 1024 * 3 // 5
    except OSError:
        pass
    return 4 * 2**30
