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
from meshdrape.kernels.walk import WALKED, turn_into, walk
from meshdrape.surface import Surface, SurfacePoint

FloatArray = NDArray[np.float64]
Place = tuple[int, float, float]

# Distances are met to this share of the spacing; libigl's own round-off is about 1e-13.
MET = 3e-11
MAX_TRIALS = 30
# Steps of the differences that give a direction, in spacings: its error is their square. The coarse one is for a
# straight path to start from, which then corrects itself; the fine one for edges that bend, and have nothing else.
COARSE, FINE = 1e-3, 1e-4
# Straight paths that end this near to the node, in spacings, are the edges themselves.
STRAIGHT = 1e-10


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
        self.a, self.b = a, b
        self.length = np.array([warp, weft])
        point_a, point_b = SurfacePoint.from_frame(surface, *a), SurfacePoint.from_frame(surface, *b)
        node = SurfacePoint.from_frame(surface, *guess)
        # whatever lies within one spacing of either, and a margin for trial points beyond the node
        reach = 1.2 * (warp + weft)
        faces = np.empty(0, dtype=np.int64)
        if slack is not None:
            ways = [
                faces_between(surface, *way, (1 + slack) * size)
                for way, size in (((point_a, node), warp), ((point_b, node), weft))
            ]
            if all(len(way) for way in ways):
                faces = np.union1d(*ways)
        if not len(faces):
            faces = np.union1d(*(faces_between(surface, point, point, reach) for point in (point_a, point_b)))
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
        edges = [self._edge(k, place) for k in range(2)]
        warp_edge, weft_edge = edges
        if warp_edge is None or weft_edge is None:
            return None
        p, q = warp_edge.arrive, weft_edge.arrive
        # sine of the angle from A's edge to B's: folded, as for straight paths, within a degree of parallel
        if (p[0] * q[1] - p[1] * q[0]) * side <= FOLD_SINE:
            return None
        return Settled(place, warp_edge, weft_edge)

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

    def _slopes(self, place: Place, step: float = COARSE) -> FloatArray | None:
        """Gradients (2, 2) of the distances to A and to B at a place, in the frame of its face."""
        slopes = self._gradients(self.patch, place, self.parents, step)
        return None if slopes is None or np.linalg.norm(slopes, axis=1).min() <= 0.1 else slopes

    def _gradients(self, patch: Patch, place: Place, sources: list[int], step: float) -> FloatArray | None:
        """Gradients (n, 2) at a place of distances from vertices of a patch, by differences over a step in spacings."""
        step *= float(self.length.min())
        around = [step_from(self.surface, place, move) for move in step * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]])]
        places = [near for near in around if near is not None]
        if len(places) < len(around):
            return None
        # all in one patch is quick; where they leave triangles too flat for libigl, each gets a patch of its own
        found = self._distances_from(patch, sources, places)
        if not np.isfinite(found).all():
            found = np.concatenate([self._distances_from(patch, sources, [near]) for near in places], axis=1)
        if not np.isfinite(found).all():
            return None
        return np.asarray(np.stack([found[:, 0] - found[:, 1], found[:, 2] - found[:, 3]], axis=1) / (2 * step))

    def _distances_from(self, patch: Patch, sources: list[int], places: list[Place]) -> FloatArray:
        """Distances (n_sources, n_places) from vertices of a patch; infinite where libigl or the patch cannot tell."""
        trial = patch.copy()
        ends = [insert(trial, self.surface, place) for place in places]
        targets = [end for end in ends if end is not None]
        if len(targets) < len(ends):
            return np.full((len(sources), len(places)), np.inf)
        return np.array([exact_distances(trial, source, targets) for source in sources])

    def _edge(self, k: int, place: Place) -> Edge | None:
        """The edge from a parent, A or B, to the node: straight where a straight path gets there, else bent."""
        parent, length = (self.a, self.b)[k], float(self.length[k])
        leave = self._leaving(parent, place, COARSE)
        if leave is None:
            return None
        target = SurfacePoint.from_frame(self.surface, *place).position(self.surface)
        straight, mesh = leave, self.surface.unfolding
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
        leave, slopes = self._leaving(parent, place, FINE), self._slopes(place, FINE)
        if leave is None or slopes is None:
            return None
        # the gradient of a distance is the direction in which its path arrives
        return Edge(leave, slopes[k] / np.linalg.norm(slopes[k]), bent=True)

    def _leaving(self, parent: Place, place: Place, step: float) -> FloatArray | None:
        """Direction (2,) at a parent in which the shortest path to the node leaves: less the distance's gradient."""
        trial = self.bare.copy()
        node = insert(trial, self.surface, place)
        slope = None if node is None else self._gradients(trial, parent, [node], step)
        if slope is None:
            return None
        size = float(np.linalg.norm(slope[0]))
        return -slope[0] / size if size > 0.1 else None


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
