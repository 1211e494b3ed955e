"""Nodes that libigl decides: the authority where straight paths cannot reach, or where none is to be trusted.

Behind a saddle vertex lies a shadow that no straight path enters: the shortest path to a node in there bends at the
vertex. Distances know nothing of that, so a node is found from distances alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.distance import exact_distances, surface_distance
from meshdrape.geodesic.patch import Patch, faces_between
from meshdrape.kernels.place import FOLD_SINE
from meshdrape.kernels.walk import WALKED, walk
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]
Place = tuple[int, float, float]

# Distances are met to this share of the spacing; libigl's own round-off is about 1e-13.
MET = 3e-11
MAX_TRIALS = 30
# Step of the differences that give an edge its directions, in spacings: their error is its square.
STEP = 1e-4
# Straight paths that end this near to the node, in spacings, are the edges themselves.
STRAIGHT = 1e-10
# Paths up to this much longer than an edge are kept in view where the node is all but known.
NARROW = 1.02


@dataclass(frozen=True)
class Edge:
    """An edge to a settled node.

    Attributes
    ----------
    leave, arrive : (2,)
        Unit directions at the parent and at the node, in the frames of their faces.
    bent : bool
        Whether the shortest path turns at a vertex, so that no straight walk from the parent ends at the node.
    """

    leave: FloatArray
    arrive: FloatArray
    bent: bool


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
    narrow : bool
        Look only where the shortest paths to the guess, and a little longer ones, can lie: quick, for a guess that is
        all but right.
    """

    def __init__(
        self, surface: Surface, a: Place, b: Place, warp: float, weft: float, guess: Place, *, narrow: bool = False
    ) -> None:
        self.surface = surface
        self.a, self.b = a, b
        self.length = np.array([warp, weft])
        point_a, point_b = SurfacePoint.from_frame(surface, *a), SurfacePoint.from_frame(surface, *b)
        node = SurfacePoint.from_frame(surface, *guess)
        # whatever lies within one spacing of either, and a margin for trial points beyond the node
        reach = 1.2 * (warp + weft)
        if narrow:
            ways = ((point_a, node, NARROW * warp), (point_b, node, NARROW * weft))
        else:
            ways = ((point_a, point_a, reach), (point_b, point_b, reach))
        faces = np.union1d(*(faces_between(surface, *way) for way in ways))
        self.bare = Patch.within(surface, faces, (point_a, point_b, node), 0.55 * reach)
        self.patch = self.bare.copy()
        self.parents = [self.patch.insert(p.face, p.position(surface))[0] for p in (point_a, point_b)]

    def run(self, guess: Place, side: float) -> Settled | None:
        """The node nearest to a guess, on the side where A's edge meets B's counter-clockwise (`side` 1) or not (-1).

        None where there is no such point, or the search does not close.
        """
        place = self._meet(guess)
        if place is None:
            return None
        slope = self._slopes(place)
        if slope is None:
            return None
        # the gradient of a distance is the direction in which its path arrives
        arrive = slope / np.linalg.norm(slope, axis=1)[:, None]
        # sine of the angle from A's edge to B's: folded, as for straight paths, within a degree of parallel
        if (arrive[0, 0] * arrive[1, 1] - arrive[0, 1] * arrive[1, 0]) * side <= FOLD_SINE:
            return None
        edges = []
        for parent, length, into in zip((self.a, self.b), self.length, arrive, strict=True):
            edge = self._edge(parent, place, float(length), into)
            if edge is None:
                return None
            edges.append(edge)
        return Settled(place, *edges)

    def distances(self, place: Place) -> FloatArray | None:
        """Shortest distances (2,) from a place to A and to B, mm; None where it lies off the patch."""
        trial = self.patch.copy()
        vertex = insert(trial, self.surface, place)
        if vertex is None:
            return None
        found = exact_distances(trial, vertex, self.parents)
        return found if np.isfinite(found).all() else None

    def _meet(self, guess: Place) -> Place | None:
        """Broyden's method on the two distances, in the plane of the guess's face unfolded along straight paths."""
        shift = np.zeros(2)
        found = self.distances(guess)
        slope = self._slopes(guess)
        if found is None or slope is None:
            return None
        miss = found - self.length
        inverse = _inverse(slope)
        place: Place | None = guess
        for _ in range(MAX_TRIALS):
            if np.abs(miss / self.length).max() <= MET:
                return place
            move = -inverse @ miss
            size = float(np.linalg.norm(move))
            longest = 0.3 * float(self.length.min())
            if size > longest:
                move *= longest / size
            place = step_from(self.surface, guess, shift + move)
            found = None if place is None else self.distances(place)
            if found is None:
                return None
            change = found - self.length - miss
            shift, miss = shift + move, miss + change
            # good Broyden: the inverse that maps this change to this move, nearest to the last
            mapped = inverse @ change
            scale = float(move @ mapped)
            if abs(scale) > 1e-3 * float(move @ move):
                inverse = inverse + np.outer(move - mapped, move @ inverse) / scale
        return None

    def _slopes(self, place: Place) -> FloatArray | None:
        """Gradients (2, 2) of the distances to A and to B at a place, in the frame of its face."""
        step = STEP * float(self.length.min())
        slopes = np.empty((2, 2))
        for axis in range(2):
            ends = []
            for sense in (step, -step):
                near = step_from(self.surface, place, sense * np.eye(2)[axis])
                found = None if near is None else self.distances(near)
                if found is None:
                    return None
                ends.append(found)
            slopes[:, axis] = (ends[0] - ends[1]) / (2 * step)
        return slopes if np.linalg.norm(slopes, axis=1).min() > 0.1 else None

    def _edge(self, parent: Place, place: Place, length: float, arrive: FloatArray) -> Edge | None:
        """The edge from a parent to the node: straight where a straight path gets there, else bent."""
        leave = self._leaving(parent, place, length)
        if leave is None:
            return None
        target = SurfacePoint.from_frame(self.surface, *place).position(self.surface)
        straight, mesh = leave, self.surface.unfolding
        for _ in range(3):
            code, face, x, y, dx, dy = walk(mesh.plane, mesh.neighbour, *parent, *straight, length)
            if code != WALKED:
                break
            frame = self.surface.unfolding.frame[face]
            end = (x + length * dx, y + length * dy)
            off = target - frame[:3]
            gap = np.array([off @ frame[3:6] - end[0], off @ frame[6:9] - end[1]])
            if (
                float(np.linalg.norm(target - frame[:3] - end[0] * frame[3:6] - end[1] * frame[6:9]))
                <= STRAIGHT * length
            ):
                return Edge(straight, arrive, bent=False)
            turn = float(gap @ np.array([-dy, dx])) / length
            straight = straight + turn * np.array([-straight[1], straight[0]])
            straight = straight / np.linalg.norm(straight)
        return Edge(leave, arrive, bent=True)

    def _leaving(self, parent: Place, place: Place, length: float) -> FloatArray | None:
        """Direction (2,) at a parent in which the shortest path to the node leaves: less the distance's gradient."""
        step = STEP * length
        slope = np.empty(2)
        for axis in range(2):
            ends = []
            for sense in (step, -step):
                near = step_from(self.surface, parent, sense * np.eye(2)[axis])
                trial = self.bare.copy()
                source = None if near is None else insert(trial, self.surface, near)
                target = insert(trial, self.surface, place)
                if source is None or target is None:
                    return None
                found = float(exact_distances(trial, source, [target])[0])
                if not np.isfinite(found):
                    return None
                ends.append(found)
            slope[axis] = (ends[0] - ends[1]) / (2 * step)
        size = float(np.linalg.norm(slope))
        return -slope / size if size > 0.1 else None


def shortest(surface: Surface, tail: Place, head: Place, length: float) -> bool:
    """Whether no way between two places is shorter than the edge of a given length (mm) that joins them."""
    ends = [SurfacePoint.from_frame(surface, *place) for place in (tail, head)]
    distance, moved = surface_distance(surface, ends[0], ends[1], bound=length * (1 + 1e-6))
    return distance >= length * (1 - MET) - moved


def step_from(surface: Surface, place: Place, move: FloatArray) -> Place | None:
    """The place straight on by `move` (2,), mm in the frame of the place's face; None off the surface."""
    length = float(np.linalg.norm(move))
    if length == 0:
        return place
    dx, dy = move / length
    mesh = surface.unfolding
    code, face, x, y, dx, dy = walk(mesh.plane, mesh.neighbour, *place, dx, dy, length)
    return (int(face), x + length * dx, y + length * dy) if code == WALKED else None


def insert(patch: Patch, surface: Surface, place: Place) -> int | None:
    """Make a place a vertex of a patch; None where the patch does not hold it."""
    try:
        return patch.insert(place[0], SurfacePoint.from_frame(surface, *place).position(surface))[0]
    except KeyError:
        return None


def _inverse(slope: FloatArray) -> FloatArray:
    """Inverse of the slopes; where the two are nearly parallel, the pseudo-inverse."""
    return np.asarray(np.linalg.pinv(slope, rcond=1e-6))
