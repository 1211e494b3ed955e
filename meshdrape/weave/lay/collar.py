"""The surface extended past its border, so that fabric that leaves the mould still has something to lie on.

Each border triangle's plane goes on outward. At a border vertex neighbouring planes meet where they intersect, so that
creases and rulings go on past the border and a developable mould stays developable; planes that are one and the same
meet in a mitre; at a sharp convex corner they leave a gap that is filled flat. A hole is filled. Nodes out there hold
the net together at the border and are trimmed afterwards.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface
from meshdrape.weave.lay.notches import without_notches
from meshdrape.weave.lay.outlines import triangulate

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Scalar = TypeVar("Scalar", bound=np.generic)

# A convex corner that turns more than this gets a fan of flat triangles, for a mitre would reach too far.
FAN_FROM = np.radians(100.0)
# Planes closer than this to parallel, rad, have no intersection that means anything.
ONE_PLANE = 1e-6
# From here on, rad, two planes meet in a crease, which always goes on past the border.
CREASE = np.radians(5.0)
# Two planes meet along a ruling only if it leaves both borders at more than about 20 degrees.
RULING_LEAVES = 0.35
# Rulings of one developable face hardly turn from one border vertex to the next; beyond this sine they are none.
RULINGS_APART = 0.1
# An outer edge keeps at least this share of its border edge, else the extension of a hollow border would fold over.
OUTER_EDGE_SHARE = 0.05
# It is drawn in by a fifth so often at most.
MOST_ROUNDS = 80
# Squares of diagonals that differ by no more than this share are of one length.
ALIKE = 1e-12


def extended(surface: Surface, depth: float, slit: float = 0.0) -> Surface:
    """The surface with a collar `depth` mm wide along its outer borders and its holes filled.

    Faces and vertices of `surface` keep their numbers; those of the collar follow. A closed surface is returned as
    it is. Notches narrower than `depth` and slits narrower than `slit` are filled first; along a hollow border the
    collar is narrowed where it would fold over itself.
    """
    n_mould_faces = len(surface.faces)
    notches = without_notches(surface, depth, slit)
    if len(notches):
        surface = surface.continued(np.empty((0, 3)), notches, n_mould_faces)
    vertices, faces = [], []
    count = len(surface.vertices)
    for loop in surface.border_loops:
        if surface.is_hole(loop):
            new_vertices, new_faces = _fill(surface, loop, count)
        else:
            new_vertices, new_faces = _strip(surface, loop, depth, count)
        vertices.append(new_vertices)
        faces.append(new_faces)
        count += len(new_vertices)
    if not faces:
        return surface
    return surface.continued(np.concatenate(vertices), np.concatenate(faces), n_mould_faces)


def _strip(surface: Surface, loop: IntArray, depth: float, first: int) -> tuple[FloatArray, IntArray]:
    """Vertices and faces of the strips along an outer border, one a border edge, and of the fans between them."""
    face, k = loop // 3, loop % 3
    tail = surface.faces[face, k]
    along = surface.vertices[_next(tail)] - surface.vertices[tail]
    length = np.linalg.norm(along, axis=1)
    along /= length[:, None]
    normal = surface.face_normal[face]
    outward = np.cross(along, normal)
    before = _last(outward)
    turn = np.pi - surface.vertex_angle[tail]
    ruling = np.cross(_last(normal), normal)
    angle = np.linalg.norm(ruling, axis=1)
    ruling /= np.maximum(angle, ONE_PLANE)[:, None]
    middle = before + outward
    ruling *= np.where(_dot(ruling, middle) < 0, -1.0, 1.0)[:, None]
    leaves = np.minimum(_dot(ruling, before), _dot(ruling, outward))
    ruled = (angle > ONE_PLANE) & (leaves > RULING_LEAVES)
    # what fills a notch leans as the notch had it: no ruling of the mould's
    filling = surface.face_rim[face] >= 0
    ruled &= ~(filling | _last(filling))
    # nor are there rulings where those of neighbours point every way: there the planes meet by noise
    apart = np.linalg.norm(np.cross(ruling, _next(ruling)), axis=1) > RULINGS_APART
    alone = ruled & (_last(ruled) | _next(ruled)) & ~_in_family(ruled, apart)
    ruled &= ~alone | (angle >= CREASE)
    size = np.linalg.norm(middle, axis=1)
    mitre = np.where((size > 0.5)[:, None], middle / np.maximum(size, 0.5)[:, None], outward)

    # one outer vertex a border vertex, as far out as both strips are deep
    rays = (mitre, depth / np.clip(size / 2, RULING_LEAVES, 1.0)), (ruling, depth / np.clip(leaves, RULING_LEAVES, 1.0))
    # how far that lies along the border edge which starts there, and along the one that ends there
    onward = [reach * _dot(ray, along) for ray, reach in rays]
    arrived = [reach * _dot(ray, _last(along)) for ray, reach in rays]
    shrink = np.ones(len(loop))
    anew = True
    for _ in range(MOST_ROUNDS):
        if anew:
            chosen, fan = ruled, (turn > FAN_FROM) & ~ruled
            ends, begins = _next(np.where(ruled, arrived[1], arrived[0])), np.where(ruled, onward[1], onward[0])
            no_family = ruled & (angle < CREASE) & ~_in_family(ruled, apart)
            crossed = ruled & _next(ruled) & apart
        used = np.where(fan, 0.0, shrink)  # a fan begins and ends square to its edges
        outer = length + _next(used) * ends - used * begins
        folded = outer < OUTER_EDGE_SHARE * length
        if not folded.any():
            break
        touched = folded | _last(folded)
        # planes of a doubly curved border meet at random: a ruling that is not one of a family is worse than a mitre
        crossing = folded & crossed
        stray = ((crossing | _last(crossing)) & ruled & (angle < CREASE)) | (touched & no_family)
        anew = bool(stray.any())
        if anew:
            ruled = ruled & ~stray
        else:
            shrink = np.where(touched, 0.8 * shrink, shrink)
    out = [(used * reach)[:, None] * ray for ray, reach in rays]
    place = surface.vertices[tail] + np.where(chosen[:, None], out[1], out[0])
    spreads = {
        i: surface.vertices[tail[i]] + depth * _fan(before[i], outward[i], along[i - 1], turn[i])
        for i in np.flatnonzero(fan).tolist()
    }
    return _sewn(surface.vertices, tail, place, spreads, first)


def _sewn(
    vertices: FloatArray, tail: IntArray, place: FloatArray, spreads: dict[int, FloatArray], first: int
) -> tuple[FloatArray, IntArray]:
    """The outer vertices, numbered on from `first`, and the faces that join them to the border.

    Parameters
    ----------
    tail : (k,)
        Vertices of the border, in order.
    place : (k, 3)
        The outer vertex of each, but for those that have a fan of several:
    spreads : dict of (n, 3)
    """
    count = np.ones(len(tail), dtype=np.int64)
    for i, spread in spreads.items():
        count[i] = len(spread)
    start = np.cumsum(count) - count  # the first outer vertex of each, at which the strip before it ends
    outer = np.repeat(place, count, axis=0)
    faces = []
    for i, spread in spreads.items():
        n = int(start[i])
        outer[n : n + len(spread)] = spread
        on = first + np.arange(n, n + len(spread))
        faces.append(np.stack([np.full(len(spread) - 1, tail[i]), on[:-1], on[1:]], axis=1))
    a, b = tail, _next(tail)
    outer_a, outer_b = start + count - 1, _next(start)
    across_a, across_b = vertices[b] - outer[outer_a], vertices[a] - outer[outer_b]
    outer_a, outer_b = outer_a + first, outer_b + first
    # cut along the shorter diagonal: a mirrored mould gets the mirrored collar; where they are alike, not by round-off
    at_a = _dot(across_a, across_a) <= (1 + ALIKE) * _dot(across_b, across_b)
    strips = np.stack(
        [
            np.stack([b, a, np.where(at_a, outer_a, outer_b)], axis=1),
            np.stack([np.where(at_a, b, a), outer_a, outer_b], axis=1),
        ],
        axis=1,
    )
    return outer, np.concatenate([*faces, strips.reshape(-1, 3)])


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    """Scalar product of each row, (n,)."""
    return np.asarray(np.einsum("ij,ij->i", a, b))


def _next(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Of the next vertex round the loop."""
    return np.concatenate([values[1:], values[:1]])


def _last(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Of the one before."""
    return np.concatenate([values[-1:], values[:-1]])


def _in_family(ruled: NDArray[np.bool_], apart: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether each ruling is one of three or more in a row of which neighbours are nearly parallel."""
    kin = ruled & _next(ruled) & ~apart
    three = kin & _next(kin)
    beside = _last(three)
    return np.asarray(three | beside | _last(beside))


def _fan(first: FloatArray, last: FloatArray, along: FloatArray, turn: float) -> FloatArray:
    """Unit rays (n, 3) from `first` to `last`, at most 60 degrees apart, the outer ones a full depth out in between."""
    angle = float(np.arccos(np.clip(first @ last, -1.0, 1.0)))
    steps = max(1, int(np.ceil(max(angle, turn) / np.radians(60.0))))
    across = last - (first @ last) * first
    size = float(np.linalg.norm(across))
    # a tip that turns right back: the rays are opposite and the fan goes round by the way ahead
    across = across / size if size > 1e-6 else along
    rays = [np.cos(angle * j / steps) * first + np.sin(angle * j / steps) * across for j in range(1, steps)]
    return np.array([first, *(ray / np.cos(0.5 * angle / steps) for ray in rays), last])


def _fill(surface: Surface, loop: IntArray, first: int) -> tuple[FloatArray, IntArray]:
    """Triangles over a hole: a fan from its middle where that sees the whole rim, else the rim's own triangulation."""
    # the mould lies on the left of its border, the filling on the right: run the other way
    rim = surface.faces[loop // 3, loop % 3][::-1]
    points = surface.vertices[rim]
    following = np.roll(points, -1, axis=0)
    weight = np.linalg.norm(following - points, axis=1) + np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1)
    middle = np.average(points, axis=0, weights=weight)
    doubled = np.cross(points - middle, following - middle)
    normal = doubled.sum(axis=0)
    size = float(np.linalg.norm(normal))
    fan = np.stack([np.full(len(rim), first), rim, np.roll(rim, -1)], axis=1)
    if size > 0 and (doubled @ normal < 1e-9 * size * size / len(rim)).any():
        ears = triangulate(points - middle, normal / size)
        if ears is not None and not _repeats_edge(surface, rim, rim[ears]):
            return np.empty((0, 3)), rim[ears]
    return middle[None], fan


def _repeats_edge(surface: Surface, rim: IntArray, ears: IntArray) -> bool:
    """Whether a diagonal across a hole joins vertices that the mould joins already, round the outside of the hole."""
    n = len(surface.vertices)
    at_rim = np.zeros(n, dtype=bool)
    at_rim[rim] = True
    keys = []
    for triangles in (surface.faces, ears):
        tail, head = triangles.ravel(), triangles[:, [1, 2, 0]].ravel()
        beside = at_rim[tail] & at_rim[head]
        keys.append(tail[beside] * n + head[beside])
    # the rim itself the mould runs through the other way
    return bool(np.isin(keys[1], keys[0]).any())
