"""Exact polyhedral distances, through libigl."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import MouldError, StartError
from meshdrape.geodesic.guarded import answers_sooner, solve, solve_guarded
from meshdrape.geodesic.patch import Patch, faces_between
from meshdrape.geodesic.screen import DOUBTFUL, LOWEST, SAFE, screened
from meshdrape.surface import Surface, SurfacePoint

if TYPE_CHECKING:
    from typing import Protocol

    class HasSurface(Protocol):
        """Anything with a surface: a Mould."""

        @property
        def surface(self) -> Surface:
            """The triangle mesh."""


FloatArray = NDArray[np.float64]

# A patch reaches this share farther than the longest path expected; where none is, or that is exceeded by more than
# the share that is round-off, a tenth farther.
NEARLY, LOST, LARGER = 1e-6, 1e-10, 1.1


def exact_distances(patch: Patch, source: int, targets: list[int]) -> FloatArray:
    """Shortest distances on a patch from one vertex to others, mm; infinite where libigl cannot tell.

    References
    ----------
    Mitchell, Mount, Papadimitriou, The discrete geodesic problem, SIAM J. Comput. 16 (1987); libigl's exact_geodesic.
    """
    return _screened_distances(patch, source, targets)[0]


def _screened_distances(patch: Patch, source: int, targets: list[int]) -> tuple[FloatArray, float]:
    """Those distances, and how much the triangles left out may have changed them, mm."""
    vertices, faces = patch.arrays()
    for lowest in (LOWEST, SAFE):
        clean = screened(vertices, faces, lowest)
        if clean is None:
            continue
        # libigl reads 0 at vertices that no face uses: hand it none
        used, compact = np.unique(clean.faces, return_inverse=True)
        ends = clean.image[[source, *targets]]
        if not np.isin(ends, used).all():
            continue
        first, *others = np.searchsorted(used, ends).tolist()
        solver = solve_guarded if clean.lowest < DOUBTFUL or answers_sooner() else solve
        found = solver(vertices[used], compact.reshape(-1, 3), first, np.array(others))
        if np.isfinite(found).all():
            return found, clean.moved
    return np.full(len(targets), np.inf), 0.0


def geodesic_distance(mould: HasSurface, point_a: ArrayLike, point_b: ArrayLike) -> float:
    """Length of the shortest path on a mould between two points, mm.

    Exact on the polyhedron. Points off the mould are projected on it first.

    Parameters
    ----------
    mould : Mould
    point_a, point_b : (3,) float, mm

    Raises
    ------
    StartError
        If a point is not three finite numbers, or the points lie on separate parts of the mould.
    MouldError
        If libigl comes to no end on the mesh between them.
    """
    surface = mould.surface
    ends = []
    for name, point in (("first", point_a), ("second", point_b)):
        try:
            p = np.asarray(point, dtype=np.float64)
        except (TypeError, ValueError):
            msg = f"the {name} point {point!r} is not a point; give X, Y, Z in mm"
            raise StartError(msg) from None
        if p.shape != (3,) or not np.isfinite(p).all():
            msg = f"the {name} point {p.tolist()} is not a point; give X, Y, Z in mm"
            raise StartError(msg)
        ends.append(surface.closest_point(p)[0])
    a, b = ends
    if surface.face_component[a.face] != surface.face_component[b.face]:
        msg = f"the points lie on separate parts of the mould (faces {a.face} and {b.face}): no path joins them"
        raise StartError(msg)
    distance, _ = surface_distance(surface, a, b)
    if not np.isfinite(distance):
        msg = f"libigl cannot measure from face {a.face} to face {b.face}: flat triangles between; repair with --heal"
        raise MouldError(msg)
    return distance


def surface_distance(
    surface: Surface, a: SurfacePoint, b: SurfacePoint, bound: float | None = None
) -> tuple[float, float]:
    """Shortest distance between two points of a surface, and how far snapping moved its ends in all, mm.

    The patch searched grows until no shorter path can lie outside: a path of length d stays where the distances in
    space to both ends sum to d at most.

    Parameters
    ----------
    bound : float, optional
        A length the distance is not expected to exceed, mm. Where it does, it is measured again on a larger patch:
        libigl now and then loses the shortest path to a point beside an edge, and is off by up to a millionth.
    """
    if bound is None:
        return _distance(surface, a, b, 0.0)
    found, moved = _distance(surface, a, b, (1 + NEARLY) * bound)
    if found > (1 + LOST) * bound:
        again, moved_again = _distance(surface, a, b, LARGER * bound)
        if again < found:
            return again, moved_again
    return found, moved


def _distance(surface: Surface, a: SurfacePoint, b: SurfacePoint, reach: float) -> tuple[float, float]:
    """The same, on a patch that holds at first the paths no longer than `reach`, mm; 0 for a tenth above the chord."""
    chord = float(np.linalg.norm(a.position(surface) - b.position(surface)))
    size = surface.diagonal
    # no path is shorter, but for round-off: libigl's own, and that of the places
    least = chord * (1 - 1e-9) - 32 * float(np.finfo(float).eps * np.abs(surface.vertices).max())
    reach = max(reach or LARGER * chord, chord, 1e-9 * size)
    while True:
        faces = faces_between(surface, a, b, reach)
        if len(faces):
            found, moved = _on_patch(Patch.around(surface, faces, a, b, reach), surface, a, b)
            if not least <= found < float("inf"):
                # not reached, or libigl's 0 for a target not reached: cut off by a hull too small
                found, moved = _on_patch(Patch(surface, faces), surface, a, b)
                if found + moved < least:
                    found = float("inf")
            # on the whole component, or no longer than the paths the patch is sure to hold
            if found <= reach * (1 + 1e-12) or len(faces) == len(surface.faces):
                return found, moved
            reach = max(found, 1.5 * reach) if np.isfinite(found) else 2 * reach
        elif reach > 100 * size:
            return float("inf"), 0.0
        else:
            reach *= 2


def _on_patch(patch: Patch, surface: Surface, a: SurfacePoint, b: SurfacePoint) -> tuple[float, float]:
    """Distance from a to b on a patch, and how far snapping moved them in all; infinite where the patch lost one."""
    try:
        start, moved_a = patch.insert(a.face, a.position(surface))
        end, moved_b = patch.insert(b.face, b.position(surface))
    except KeyError:
        return float("inf"), 0.0
    if start == end:
        return 0.0, moved_a + moved_b
    found, moved = _screened_distances(patch, start, [end])
    return float(found[0]), moved_a + moved_b + moved
