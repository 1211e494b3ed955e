"""All nodes there can be: the circle about each parent scanned for points at one spacing from the other.

About each, for behind a saddle vertex no straight radius of one of them gets, but one of the other's may. A search from
a first guess may miss a node that exists. Where the scan finds none either, the cloth folds there.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.field import Place
from meshdrape.surface import SurfacePoint
from meshdrape.weave.lay.settle import NodeSearch, Settled, step_from

FloatArray = NDArray[np.float64]

# Directions tried about a parent.
DIRECTIONS = 72
# A straight path to which another is shorter by more than this share is no radius.
NO_RADIUS = 1e-9
# A point this near to the cell's known corner, in spacings, is that corner.
SAME = 1e-3


def scan(search: NodeSearch, corner: Place, guess: Place, side: float) -> Settled | None:
    """The node nearest to a guess of all that there are, but for the cell's known corner; None where there is none.

    Parameters
    ----------
    search : NodeSearch
        Of the two parents A and B.
    corner, guess : (face, x, y)
        The node that closes the cell, at one spacing from A and from B like the one sought; where that is expected.
    side : float
        1 where A's edge meets B's counter-clockwise at the node, -1 where not.
    """
    surface = search.surface
    near = SurfacePoint.from_frame(surface, *guess).position(surface)
    known = SurfacePoint.from_frame(surface, *corner).position(surface)
    shortest = float(search.length.min())
    starts = []
    for place in (place for about in (0, 1) for place in _crossings(search, about)):
        at = SurfacePoint.from_frame(surface, *place).position(surface)
        starts.append((float(np.linalg.norm(at - near)), place))
    for _, place in sorted(starts):
        found = search.run(place, side)
        if found is None:
            continue
        at = SurfacePoint.from_frame(surface, *found.place).position(surface)
        if np.linalg.norm(at - known) > SAME * shortest:
            return found
    return None


def _crossings(search: NodeSearch, about: int) -> Iterator[Place]:
    """Places on the circle about one parent, A or B, where the distance to the other passes the spacing.

    To a fraction of a degree.
    """
    turns = np.linspace(0.0, 2 * np.pi, DIRECTIONS, endpoint=False)
    misses = _misses(search, about, turns)
    for k in range(DIRECTIONS):
        low, high = turns[k], turns[k] + 2 * np.pi / DIRECTIONS
        (place, before), (beyond, after) = misses[k], misses[(k + 1) % DIRECTIONS]
        if before * after > 0 or not np.isfinite(before * after):
            # a radius that is none may hide a crossing beside it
            if np.isfinite(before) != np.isfinite(after):
                start = place if np.isfinite(before) else beyond
                if start is not None:
                    yield start
            continue
        # the search closes in from where the chord between the two passes zero
        turn = low + (high - low) * before / (before - after)
        ((there, miss),) = _misses(search, about, np.array([turn]))
        yield from (start for start in (there if np.isfinite(miss) else None, place) if start is not None)


def _misses(search: NodeSearch, about: int, turns: FloatArray) -> list[tuple[Place | None, float]]:
    """Ends of the straight paths that leave a parent at given angles, and by how much each is too far from the other.

    In mm; NaN where a path leaves the surface, or is not the shortest to its end.
    """
    radius = float(search.length[about])
    places = [
        step_from(search.surface, search.parents[about], radius * np.array([np.cos(t), np.sin(t)])) for t in turns
    ]
    face = np.array([-1 if place is None else place[0] for place in places])
    xy = np.array([(0.0, 0.0) if place is None else place[1:] for place in places])
    own, other = (search.fields[parent].distances(face, xy) for parent in (about, 1 - about))
    is_radius = np.isfinite(other) & (np.abs(own - radius) <= radius * NO_RADIUS)
    misses = np.where(is_radius, other - search.length[1 - about], np.nan)
    return list(zip(places, misses.tolist(), strict=True))
