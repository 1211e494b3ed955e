"""The chords of a start fibre's bent edges: how long they are, and what they cross."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.shortest import Piece, path_length, shortest_path, without_specks
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.net import Net
from meshdrape.weave.start.rays import SNAP, Rays
from meshdrape.weave.status import NodeStatus

# Sense of the four half-fibres +warp, +weft, -warp, -weft along the lattice.
SENSE = ((1, 0), (0, 1), (-1, 0), (0, -1))


class Chord(NamedTuple):
    """The shortest path between the ends of a generator's edge that bends.

    `half` is the half-fibre it belongs to and `order` the number of its edge, from 0 at the seed.
    """

    half: int
    order: int
    pieces: list[Piece]

    @property
    def length(self) -> float:
        """Length, mm: less than one spacing."""
        return path_length(self.pieces)


class Passed(NamedTuple):
    """A mesh edge that a chord crosses, or a vertex it runs through.

    Half-edge `at` is crossed outwards at the share `t` of its length; or `at` is -1, and of the defect of `vertex` the
    share `t` lies to the left.
    """

    at: int
    vertex: int
    t: float


def place(net: Net, i: int, j: int) -> SurfacePoint:
    """A node as a point of the surface."""
    x, y = net.lattice.xy[i, j].tolist()
    return SurfacePoint.from_frame(net.surface, int(net.lattice.face[i, j]), x, y)


def generator_nodes(net: Net, half: int) -> NDArray[np.int64]:
    """Lattice indices of the nodes of a half-fibre, the seed first, up to the first that is not there, (n, 2)."""
    at = np.array(net.seed_index) + np.arange(int(net.start.n_nodes[half]) + 1)[:, None] * SENSE[half]
    at = at[((at >= 0) & (at < net.shape)).all(axis=1)]
    gone = np.flatnonzero(net.lattice.status[at[:, 0], at[:, 1]] > NodeStatus.OFF_MOULD)
    return np.asarray(at[: gone[0]] if len(gone) else at)


def chords(net: Net) -> list[Chord]:
    """Those of all four half-fibres."""
    found = []
    for half in range(4):
        nodes = generator_nodes(net, half)
        for order in np.flatnonzero(net.start.arc[half, : len(nodes) - 1]).tolist():
            tail, head = (place(net, *nodes[k]) for k in (order, order + 1))
            found.append(Chord(half, order, without_specks(shortest_path(net.surface, tail, head))))
    return found


def passed(surface: Surface, chord: Chord) -> list[Passed]:
    """What a chord crosses on its way, in its order."""
    found: list[Passed] = []
    for before, after in pairwise(chord.pieces):
        point = SurfacePoint.from_frame(surface, before.face, before.head.real, before.head.imag)
        corner = int(np.argmax(point.barycentric))
        if point.barycentric[corner] >= 1 - SNAP:
            vertex = int(surface.faces[before.face, corner])
            if not found or found[-1].vertex != vertex:
                found.append(Passed(-1, vertex, left_share(surface, point, before, after)))
            continue
        (k,) = np.flatnonzero(surface.face_neighbour[before.face] // 3 == after.face)[:1].tolist()
        tail, head = point.barycentric[[k, (k + 1) % 3]]
        found.append(Passed(3 * before.face + k, -1, float(head / (tail + head))))
    return found


def left_share(surface: Surface, vertex: SurfacePoint, before: Piece, after: Piece) -> float:
    """Share of a vertex's defect to the left of a shortest path through it: straight on one side, all on the other."""
    left, right = sides(surface, vertex, before, after)
    total = 2 * np.pi - left - right
    return min(max((np.pi - left) / total, 0.0), 1.0) if total else 0.5


def sides(surface: Surface, point: SurfacePoint, before: Piece, after: Piece) -> tuple[float, float]:
    """Angles at a point on the left and on the right of the two pieces of a path that meet there, rad."""
    rays = Rays(surface, point)
    back = rays.angle(before.face, -before.direction.real, -before.direction.imag)
    left = (back - rays.angle(after.face, after.direction.real, after.direction.imag)) % rays.total
    return left, rays.total - left
