"""Slits: stretches of border that face each other across less than a cell or two of cloth."""

from __future__ import annotations

from itertools import chain

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Cloth on both sides of a slit narrower than this many spacings shares nodes over it, so it is bridged.
SLIT = 2.0
# Two edges face each other if their directions are opposite to within 60 degrees.
FACING_COSINE = -0.5
# And if the surface beside them turns by no more than 20 degrees from one to the other: the mouth of a channel, or of a
# sheet that is rolled up, is no slit.
LEVEL_COSINE = float(np.cos(np.radians(20.0)))
# They lie side by side over more than this share of one of them.
OVERLAP = 1e-6
# What lies farther off an edge's plane than across from it does not face it.
STEEPEST = 1.0
# So few points are compared with one another in less time than it takes to load a tree.
FEW = 2000


def facing_edges(
    tail: FloatArray, normal: FloatArray, after: IntArray, slit: float, width: float
) -> list[tuple[int, int]]:
    """Pairs of border edges that face each other across a slit, the nearest first.

    Parameters
    ----------
    tail : (n, 3) mm
        Where each edge begins, with the surface on its left.
    normal : (n, 3)
        Of the surface beside it.
    after : (n,) int
        The edge that begins where it ends.
    slit : float
        Of the widest slit, mm: two edges are nowhere nearer than their gap, and that is no more.
    width : float
        Two edges that lie side by side and are this far apart at one end face each other no more, mm.
    """
    head = tail[after]
    length = np.linalg.norm(head - tail, axis=1)
    # every end of an edge that may lie across from another edge is found about its middle
    edge, vertex = _within(tail, 0.5 * (tail + head), 0.5 * length + width)
    along = (head - tail) / length[:, None]
    outward = np.cross(along, normal)
    off = tail[vertex] - tail[edge]
    height = np.einsum("ij,ij->i", off, outward[edge])
    at = np.einsum("ij,ij->i", off, along[edge])
    lift = np.abs(np.einsum("ij,ij->i", off, normal[edge]))
    nearly = OVERLAP * length[edge]
    across = (height > 0) & (height <= width) & (lift <= STEEPEST * height)
    across &= (at >= -nearly) & (at <= length[edge] + nearly)
    if not across.any():
        return []
    edge, vertex, height = edge[across], vertex[across], height[across]
    # a vertex speaks for both border edges that end at it
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    a, b = np.concatenate([edge, edge]), np.concatenate([vertex, before[vertex]])
    gap = np.concatenate([height, height])
    opposite = np.einsum("ij,ij->i", along[a], along[b]) < FACING_COSINE
    opposite &= np.einsum("ij,ij->i", normal[a], normal[b]) > LEVEL_COSINE
    a, b, gap = a[opposite], b[opposite], gap[opposite]
    pairs, number = np.unique(np.minimum(a, b) * len(tail) + np.maximum(a, b), return_inverse=True)
    nearest = np.full(len(pairs), np.inf)
    np.minimum.at(nearest, number, gap)
    i, j = np.divmod(pairs, len(tail))
    ends = [np.einsum("ij,ij->i", point[j] - tail[i], along[i]) for point in (tail, head)]
    overlap = np.minimum(np.maximum(*ends), length[i]) - np.maximum(np.minimum(*ends), 0.0)
    kept = np.flatnonzero((nearest <= slit) & (overlap > OVERLAP * np.minimum(length[i], length[j])))
    kept = kept[np.argsort(nearest[kept], kind="stable")]
    return list(zip(i[kept].tolist(), j[kept].tolist(), strict=True))


def _within(points: FloatArray, centre: FloatArray, radius: FloatArray) -> tuple[IntArray, IntArray]:
    """Balls (n,) and the points that lie in each, as pairs."""
    if len(points) <= FEW:
        middle = points.mean(axis=0)
        c, p = centre - middle, points - middle
        room = radius**2 - np.einsum("ij,ij->i", c, c)
        ball, point = np.nonzero(np.einsum("ij,ij->i", p, p) - 2 * c @ p.T <= room[:, None])
        return ball, point
    from scipy.spatial import cKDTree

    found = cKDTree(points).query_ball_point(centre, radius)
    ball = np.repeat(np.arange(len(centre)), [len(near) for near in found])
    return ball, np.fromiter(chain.from_iterable(found), dtype=np.int64, count=len(ball))
