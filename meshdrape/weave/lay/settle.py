"""Nodes that libigl decides: the authority where straight paths cannot reach, or where none is to be trusted.

Behind a saddle vertex lies a shadow that no straight path enters: the shortest path to a node in there bends at the
vertex. Distances know nothing of that, so such a node is looked for where the distances from its two parents are the
spacings, and is one only if libigl measures the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.distance import surface_distance
from meshdrape.geodesic.field import DistanceField, Place, Region, Way
from meshdrape.geodesic.patch import faces_between
from meshdrape.kernels.place import FOLD_SINE
from meshdrape.kernels.walk import WALKED, turn_into, walk
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]

# libigl's distances are those asked for to this share of them; its own round-off is about 1e-13.
MET = 3e-11
# The search has closed at this share of the spacing, or where round-off lets it come no closer.
CLOSED = 1e-14
MAX_TRIALS, MAX_HALVINGS = 30, 6
# Straight paths that end this near to the node, in spacings, are the edges themselves.
STRAIGHT = 1e-10
# What is asked for a way shorter than an edge reaches this much farther, so that the edge itself lies in it.
NEARBY = 1e-6
# Paths longer than the spacing by more than this factor are of no use to a search.
FARTHEST = 1.5


@dataclass(frozen=True)
class Edge:
    """An edge to a settled node.

    Attributes
    ----------
    leave, arrive : (2,)
        Unit directions at the parent and at the node, in the frames of their faces.
    bent : bool
        Whether the shortest path turns at a vertex, so that no straight walk from the parent ends at the node.
    bend : int
        The last vertex at which it turns; -1 for none.
    """

    leave: FloatArray
    arrive: FloatArray
    bent: bool
    bend: int = -1


@dataclass(frozen=True)
class Settled:
    """A node found from distances alone: its place (face, x, y) and the edges to its two parents."""

    place: Place
    warp_edge: Edge
    weft_edge: Edge


class NodeSearch:
    """The search for the node at shortest distance `warp` from A and `weft` from B.

    Parameters
    ----------
    a, b : (face, x, y)
        The parents in the frames of their faces, mm.
    warp, weft : float
        Spacing, mm.
    guess : (face, x, y)
        Where the node is expected.
    slack : float, optional
        Look only where paths lie that are longer by this share than the edges to the guess: quick, for a guess that is
        nearly right.
    """

    def __init__(
        self,
        surface: Surface,
        a: Place,
        b: Place,
        warp: float,
        weft: float,
        guess: Place,
        *,
        slack: float | None = None,
    ) -> None:
        self.surface = surface
        self.parents = (a, b)
        self.length = np.array([warp, weft])
        ends = [SurfacePoint.from_frame(surface, *place) for place in self.parents]
        sizes = self.length.tolist()
        regions = []
        if slack is not None:
            node = SurfacePoint.from_frame(surface, *guess)
            ways = [
                faces_between(surface, end, node, (1 + slack) * size) for end, size in zip(ends, sizes, strict=True)
            ]
            if all(len(way) for way in ways):
                regions = [Region(surface, np.union1d(*ways))] * 2
        if not regions:
            regions = [
                Region(surface, np.sort(faces_between(surface, end, end, 2 * FARTHEST * size)))
                for end, size in zip(ends, sizes, strict=True)
            ]
        self.fields = [
            DistanceField(region, place, FARTHEST * size)
            for region, place, size in zip(regions, self.parents, sizes, strict=True)
        ]

    def run(self, guess: Place, side: float) -> Settled | None:
        """The node nearest to a guess, on the side where A's edge meets B's counter-clockwise (`side` 1) or not (-1).

        None where there is no such point, the search does not close, or libigl knows of a shorter way.
        """
        for method in (self._meet, self._meet_over_ridges):
            found = method(guess)
            settled = None if found is None else self._settled(*found, side)
            if settled is not None:
                return settled
        return None

    def _settled(self, place: Place, ways: list[Way], side: float) -> Settled | None:
        """The node at a place, if it is on the right side, and libigl knows of no other distance."""
        warp_edge, weft_edge = (self._edge(k, place, way) for k, way in enumerate(ways))
        p, q = warp_edge.arrive, weft_edge.arrive
        # sine of the angle from A's edge to B's: folded, as for straight paths, within a degree of parallel
        if (p[0] * q[1] - p[1] * q[0]) * side <= FOLD_SINE:
            return None
        for parent, length, edge in zip(self.parents, self.length.tolist(), (warp_edge, weft_edge), strict=True):
            distance, moved = _measured(self.surface, parent, place, length)
            # libigl drops what of a path's faces is next to nothing, along a crease, and then finds no way as short as
            # one that has been walked
            longest = length if edge.bent else np.inf
            if not length * (1 - MET) - moved <= distance <= longest * (1 + MET) + moved:
                return None
        return Settled(place, warp_edge, weft_edge)

    def _meet(self, guess: Place) -> tuple[Place, list[Way]] | None:
        """Newton's method on the two distances, whose slopes are the directions in which the shortest paths arrive."""
        place, ways = guess, self._ways(guess)
        if ways is None:
            return None
        longest = 0.3 * float(self.length.min())
        for _ in range(MAX_TRIALS):
            miss = self._miss(ways)
            if np.abs(miss).max() <= CLOSED:
                break
            slope = np.stack([way.arrive for way in ways]) / self.length[:, None]
            move = -_inverse(slope) @ miss
            move *= min(1.0, longest / float(np.linalg.norm(move) or 1.0))
            nearer = self._nearer(place, move, float(np.linalg.norm(miss)))
            if nearer is None:
                break
            place, ways = nearer
        return (place, ways) if np.abs(self._miss(ways)).max() <= MET else None

    def _meet_over_ridges(self, guess: Place) -> tuple[Place, list[Way]] | None:
        """Broyden's method: where two ways are equally long the slopes jump, and Newton's goes to and fro for ever.

        In the plane of the guess's face, unfolded along straight paths.
        """
        ways = self._ways(guess)
        if ways is None:
            return None
        shift, miss = np.zeros(2), self._miss(ways)
        inverse = _inverse(np.stack([way.arrive for way in ways]) / self.length[:, None])
        longest = 0.3 * float(self.length.min())
        place: Place | None = guess
        for _ in range(MAX_TRIALS):
            move = -inverse @ miss
            move *= min(1.0, longest / float(np.linalg.norm(move) or 1.0))
            place = step_from(self.surface, guess, shift + move)
            ways = None if place is None else self._ways(place)
            if place is None or ways is None:
                return None
            change = self._miss(ways) - miss
            shift, miss = shift + move, miss + change
            if np.abs(miss).max() <= MET:
                return place, ways
            # good Broyden: the inverse that maps this change to this move, nearest to the last
            mapped = inverse @ change
            scale = float(move @ mapped)
            if abs(scale) > 1e-3 * float(move @ move):
                inverse = inverse + np.outer(move - mapped, move @ inverse) / scale
        return None

    def _nearer(self, place: Place, move: FloatArray, miss: float) -> tuple[Place, list[Way]] | None:
        """The place after a move, or half of it, and so on, that misses by less; None where none does."""
        for _ in range(MAX_HALVINGS):
            trial = step_from(self.surface, place, move)
            ways = None if trial is None else self._ways(trial)
            if trial is not None and ways is not None and np.linalg.norm(self._miss(ways)) < miss:
                return trial, ways
            move = 0.5 * move
        return None

    def _ways(self, place: Place) -> list[Way] | None:
        """The shortest paths from A and from B to a place; None where it lies beyond the faces searched."""
        ways = [way for way in (field.to(place) for field in self.fields) if way is not None]
        return ways if len(ways) == len(self.fields) else None

    def _miss(self, ways: list[Way]) -> FloatArray:
        """How much longer the two are than the spacings, in spacings, (2,)."""
        return np.asarray(np.array([way.length for way in ways]) / self.length - 1.0)

    def _edge(self, k: int, place: Place, way: Way) -> Edge:
        """The edge from a parent, A or B, to the node: straight where a straight path gets there, else bent."""
        parent, length = self.parents[k], float(self.length[k])
        target = SurfacePoint.from_frame(self.surface, *place).position(self.surface)
        straight, mesh = way.leave, self.surface.unfolding
        for _ in range(4):
            code, face, x, y, dx, dy = walk(mesh.plane, mesh.neighbour, *parent, *straight, length)
            if code != WALKED:
                break
            frame = mesh.frame[face]
            end = (x + length * dx, y + length * dy)
            off = target - frame[:3]
            gap = np.array([off @ frame[3:6] - end[0], off @ frame[6:9] - end[1]])
            if float(np.linalg.norm(off - end[0] * frame[3:6] - end[1] * frame[6:9])) <= STRAIGHT * length:
                into = turn_into(mesh.plane, mesh.neighbour, mesh.frame, face, dx, dy, place[0])
                return Edge(straight, np.array(into), bent=False)
            turn = float(gap @ np.array([-dy, dx])) / length
            straight = straight + turn * np.array([-straight[1], straight[0]])
            straight = straight / np.linalg.norm(straight)
        return Edge(way.leave, way.arrive, bent=True, bend=way.bend)


def shortest(surface: Surface, tail: Place, head: Place, length: float) -> bool:
    """Whether no way between two places is shorter than the edge of a given length (mm) that joins them.

    Distances spread over the few faces such a way could touch tell at a tenth of libigl's cost that there is none;
    where they find one, libigl has the last word.
    """
    ends = [SurfacePoint.from_frame(surface, *place) for place in (tail, head)]
    faces = faces_between(surface, ends[0], ends[1], length * (1 + NEARBY))
    if len(faces):
        way = DistanceField(Region(surface, np.sort(faces)), tail, length * (1 + NEARBY)).to(head)
        if way is not None and way.length >= length * (1 - MET):
            return True
    distance, moved = _measured(surface, tail, head, length)
    return distance >= length * (1 - MET) - moved


def _measured(surface: Surface, tail: Place, head: Place, length: float) -> tuple[float, float]:
    """Distance by libigl, mm, where it is expected to be `length`, and by how much it may be off for points snapped."""
    ends = [SurfacePoint.from_frame(surface, *place) for place in (tail, head)]
    return surface_distance(surface, ends[0], ends[1], bound=length)


def step_from(surface: Surface, place: Place, move: FloatArray) -> Place | None:
    """The place straight on by `move` (2,), mm in the frame of the place's face; None off the surface."""
    length = float(np.linalg.norm(move))
    if length == 0:
        return place
    dx, dy = move / length
    mesh = surface.unfolding
    code, face, x, y, dx, dy = walk(mesh.plane, mesh.neighbour, *place, dx, dy, length)
    return (int(face), x + length * dx, y + length * dy) if code == WALKED else None


def _inverse(slope: FloatArray) -> FloatArray:
    """Inverse of the slopes; where the two are nearly parallel, the pseudo-inverse."""
    return np.asarray(np.linalg.pinv(slope, rcond=1e-6))
