"""Slits: stretches of border that face each other across less than a cell or two of cloth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Cloth on both sides of a slit narrower than this many spacings shares nodes over it, so it is bridged.
SLIT = 2.0
# Two edges face each other if their directions are opposite to within 60 degrees.
FACING_COSINE = -0.5
# They lie side by side over more than this share of one of them.
OVERLAP = 1e-6
# What lies farther off an edge's plane than across from it does not face it.
STEEPEST = 1.0


def facing_edges(surface: Surface, loops: list[IntArray], slit: float, width: float) -> list[tuple[int, int]]:
    """Pairs of border edges that face each other across a slit, by their places along all the loops, the nearest first.

    Parameters
    ----------
    loops : list of (k,) half-edges
    slit : float
        Of the widest slit, mm: two edges are nowhere nearer than their gap, and that is no more.
    width : float
        Two edges that lie side by side and are this far apart at one end face each other no more, mm.
    """
    from scipy.spatial import cKDTree

    loop = np.concatenate(loops)
    face, k = loop // 3, loop % 3
    tail = surface.vertices[surface.faces[face, k]]
    head = surface.vertices[surface.faces[face, (k + 1) % 3]]
    length = np.linalg.norm(head - tail, axis=1)
    # every end of an edge that may lie across from another edge is found about its middle
    tree = cKDTree(tail)
    found = tree.query_ball_point(0.5 * (tail + head), 0.5 * length + width)
    count = np.array([len(near) for near in found])
    edge = np.repeat(np.arange(len(loop)), count)
    vertex = np.concatenate([np.asarray(near, dtype=np.int64) for near in found])
    along = (head - tail) / length[:, None]
    normal = surface.face_normal[face]
    outward = np.cross(along, normal)
    off = tail[vertex] - tail[edge]
    height = np.einsum("ij,ij->i", off, outward[edge])
    at = np.einsum("ij,ij->i", off, along[edge])
    lift = np.abs(np.einsum("ij,ij->i", off, normal[edge]))
    nearly = OVERLAP * length[edge]
    across = (height > 0) & (height <= width) & (lift <= STEEPEST * height)
    across &= (at >= -nearly) & (at <= length[edge] + nearly)
    edge, vertex, height, at = edge[across], vertex[across], height[across], at[across]
    # a vertex speaks for both border edges that end at it
    before = np.concatenate([np.roll(np.arange(a, a + n), 1) for a, n in _spans(loops)])
    a = np.concatenate([edge, edge])
    b = np.concatenate([vertex, before[vertex]])
    gap = np.concatenate([height, height])
    alike = np.einsum("ij,ij->i", along[a], along[b]) < FACING_COSINE
    a, b, gap = a[alike], b[alike], gap[alike]
    low = np.minimum(a, b)
    pair = low * len(loop) + np.maximum(a, b)
    pairs, first = np.unique(pair, return_inverse=True)
    nearest = np.full(len(pairs), np.inf)
    np.minimum.at(nearest, first, gap)
    i, j = np.divmod(pairs, len(loop))
    kept = (nearest <= slit) & _side_by_side(tail, head, along, length, i, j)
    order = np.lexsort((pairs[kept], nearest[kept]))
    return list(zip(i[kept][order].tolist(), j[kept][order].tolist(), strict=True))


def _spans(loops: list[IntArray]) -> list[tuple[int, int]]:
    """First place and number of places of each loop."""
    count = [len(loop) for loop in loops]
    return list(zip(np.cumsum([0, *count[:-1]]).tolist(), count, strict=True))


def _side_by_side(
    tail: FloatArray, head: FloatArray, along: FloatArray, length: FloatArray, i: IntArray, j: IntArray
) -> NDArray[np.bool_]:
    """Whether edges i and j overlap, seen across, over more than a point."""
    ends = [np.einsum("ij,ij->i", point[j] - tail[i], along[i]) for point in (tail, head)]
    overlap = np.minimum(np.maximum(*ends), length[i]) - np.maximum(np.minimum(*ends), 0.0)
    return np.asarray(overlap > OVERLAP * np.minimum(length[i], length[j]))
