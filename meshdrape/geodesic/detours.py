"""Where a straight path may not be the shortest: round a convex vertex, or several, or over the back of a tube."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.certify import TURNED_OVER
from meshdrape.kernels.crowd import reach_of_crowds
from meshdrape.kernels.facets import star_radii
from meshdrape.kernels.flood import flood
from meshdrape.kernels.tables import KEPT_OUT, Detours
from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A way round a vertex of defect d is shorter by d^2 / 32 of the path at most: below this defect, rad, by nothing that
# counts.
LEAST_DETOUR = 1e-5
# Vertices are suspected of a shorter way round as if their defects were so many times larger, and more where others
# stand behind them; crowds, whose middle is looked for at their vertices alone, still more.
MARGIN, CROWD_MARGIN = 1.5, 2.0
# Curvature spread no denser than this over the square of a path's length offers no shorter way: on a sphere that
# takes pi^2.
SPREAD = 1.0
# Normals compared each with each, at most.
MOST_NORMALS = 3000
# A drape of one spacing needs two tables at most: its own, and that of the coarse net which tells how far it reaches.
TABLES_KEPT = 2
# Boxes along an axis, so that their numbers stay below 2^63.
MOST_BOXES = 2.0**20
# Crowds whose centres lie within this part of their reach of one another are taken as one.
ALIKE = 0.25


def detours(surface: Surface, length: float) -> Detours:
    """Tables by which kernels suspect that a path of at most `length`, mm, has a shorter way; the last ones are kept.

    A vertex of angle defect d offers a shorter way to a path whose ends it sees, on the path's side, at an angle of
    more than pi - d / 2. Vertices that stand close together act as one; how far from their middle a path is suspect
    depends on its length, and is given to all vertices there as a radius to keep out of.
    """
    kept: dict[float, Detours] = vars(surface).setdefault("_detours", {})
    table = kept.pop(length, None)
    if table is None:
        table = _detours(surface, length)
        while len(kept) >= TABLES_KEPT:
            kept.pop(next(iter(kept)))
    kept[length] = table
    return table


def _detours(surface: Surface, length: float) -> Detours:
    defect = np.where(surface.border_vertex, 0.0, np.maximum(surface.vertex_defect, 0.0))
    defect[defect < LEAST_DETOUR] = 0.0
    star = _star_radius(surface)
    alone = 0.5 * length * np.tan(0.25 * np.minimum(CROWD_MARGIN * defect, np.pi))
    area = np.bincount(surface.faces.ravel(), np.repeat(surface.face_area / 3, 3), len(defect))
    asked = np.flatnonzero((alone > star) | (defect * length**2 > SPREAD * area))
    margin = np.full(len(defect), MARGIN)
    keep_out = np.zeros(len(defect))
    if len(asked):
        reach, gathered = _crowds(surface.vertices, defect, asked, length)
        margin[asked] *= 1 + gathered
        crowded = reach > star[asked]
        keep_out = _keep_out(surface, *_thinned(surface.vertices, asked[crowded], reach[crowded]))
    half = np.minimum(0.5 * margin * defect, 3.0)
    # far from a vertex, the tangent of half its defect; a number beyond all tangents says: keep out
    corner = np.where(keep_out > 0, KEPT_OUT + keep_out, np.clip(np.tan(half), -0.5 * KEPT_OUT, 0.5 * KEPT_OUT))
    faces = surface.faces
    wary = ((surface.corner_angle > np.pi - half[faces]) | (keep_out[faces] > 0)).any(axis=1)
    if not corner.any() and _faces_one_way(surface.face_normal):
        nothing = np.empty((0, 3))
        return Detours(nothing, np.asarray(wary), np.zeros((len(faces), 6), dtype=np.float32), nothing)
    return Detours(corner[faces], np.asarray(wary), _beside(surface, corner), surface.face_normal)


def _beside(surface: Surface, corner: FloatArray) -> NDArray[np.float32]:
    """(m, 6) of `Detours`, from its entries (n,) for each vertex."""
    beside = np.zeros((len(surface.faces), 6), dtype=np.float32)
    beside[:, ::2] = np.where((corner < 0) | (corner >= KEPT_OUT), np.inf, corner)[surface.faces[:, [2, 0, 1]]]
    normal = surface.face_normal
    for k in range(3):
        over = surface.face_neighbour[:, k]
        cosine = np.einsum("md,md->m", normal, normal[np.maximum(over, 0) // 3])
        beside[:, 2 * k + 1] = np.where(over >= 0, np.arccos(np.clip(cosine, -1.0, 1.0)), 0.0)
    return beside


def _faces_one_way(normal: FloatArray) -> bool:
    """Whether no two normals (m, 3) are so far apart that a path could turn over; False where there are too many."""
    if (normal @ normal[0]).min() <= TURNED_OVER + 1e-6:
        return False
    one_way = np.unique(normal.round(9), axis=0)
    return len(one_way) <= MOST_NORMALS and bool((one_way @ one_way.T).min() > TURNED_OVER + 1e-6)


def _crowds(vertices: FloatArray, defect: FloatArray, asked: IntArray, length: float) -> tuple[FloatArray, FloatArray]:
    """How far off each vertex asked for, with those round it, may offer a shorter way, mm; and their defects, rad."""
    convex = np.flatnonzero(defect)
    half = 0.5 * length
    low = vertices[convex].min(axis=0)
    width = max(half, float(np.ptp(vertices[convex], axis=0).max()) / MOST_BOXES)
    box = np.floor((vertices[convex] - low) / width).astype(np.int64)
    size = box.max(axis=0) + 1
    key = (box[:, 0] * size[1] + box[:, 1]) * size[2] + box[:, 2]
    order = np.argsort(key, kind="stable")
    convex = convex[order]
    reach, gathered = reach_of_crowds(
        vertices[asked],
        vertices[convex],
        defect[convex],
        key[order],
        low,
        size,
        width,
        half,
        CROWD_MARGIN,
        defect[asked],
    )
    return np.asarray(reach), np.asarray(gathered)


def _keep_out(surface: Surface, centre: IntArray, reach: FloatArray) -> FloatArray:
    """(n,) radius round each vertex within which a path comes near one of the crowds, mm; 0 where none does."""
    out = np.zeros(len(surface.vertices))
    longest = _longest_edge(surface)
    some_face = np.empty(len(out), dtype=np.int64)
    some_face[surface.faces.ravel()] = np.repeat(np.arange(len(surface.faces)), 3)
    for v, far in zip(centre.tolist(), reach.tolist(), strict=True):
        middle = surface.vertices[v]
        faces = surface.faces[flood(surface.unfolding, int(some_face[v]), middle, middle, 2 * far)]
        away = np.linalg.norm(surface.vertices[faces] - middle, axis=2)
        nearest = np.argmin(away, axis=1)
        rows = np.arange(len(faces))
        corner, off = faces[rows, nearest], away[rows, nearest]
        # balls about the corners that together hold the ball about the crowd, as far as paths can meet it there
        np.maximum.at(out, corner, np.minimum(off + far, np.maximum(far - off, 0.0) + 2 * longest[corner]))
    return out


def _thinned(vertices: FloatArray, centre: IntArray, reach: FloatArray) -> tuple[IntArray, FloatArray]:
    """Of centres close together the one of the longest reach, which is enlarged to hold the others'."""
    if not len(centre):
        return centre, reach
    # boxes of one width for reaches within an octave
    width = ALIKE * np.exp2(np.floor(np.log2(reach)))
    box = np.floor(vertices[centre] / width[:, None]).astype(np.int64)
    order = np.argsort(-reach, kind="stable")
    _, first = np.unique(np.column_stack([box, np.log2(width).round()])[order], axis=0, return_index=True)
    best = np.sort(order[first])
    alone = len(best) == len(centre)
    return centre[best], reach[best] if alone else reach[best] + np.sqrt(3.0) * width[best]


def _star_radius(surface: Surface) -> FloatArray:
    """(n,) distance from each vertex to the nearest line of the edges round it, mm."""
    out = np.empty(len(surface.vertices))
    star_radii(surface.vertices, surface.faces, surface.face_area, out)
    return out


def _longest_edge(surface: Surface) -> FloatArray:
    """(n,) longest edge at each vertex, mm."""
    tail, head = surface.faces.ravel(), np.roll(surface.faces, -1, axis=1).ravel()
    edge = np.linalg.norm(surface.vertices[head] - surface.vertices[tail], axis=1)
    out = np.zeros(len(surface.vertices))
    np.maximum.at(out, tail, edge)
    np.maximum.at(out, head, edge)
    return out
