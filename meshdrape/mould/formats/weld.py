"""Vertices that are one and the same, given more than once."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Corners of one vertex that were rounded to single precision on their own may be this share of the largest
# coordinate apart: a last place in each of three coordinates, twice over.
ROUND_OFF: Final = 4 * float(np.finfo(np.float32).eps)
# A unit vector along no axis and no diagonal.
ACROSS: Final = np.array([0.485, 0.617, np.sqrt(1 - 0.485**2 - 0.617**2)])


def welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Return the mesh with vertices of equal coordinates made one, in the order of their first."""
    order = np.lexsort(vertices.T)
    ordered = vertices[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)]) if len(order) else np.empty(0, bool)
    first = np.empty(len(order), dtype=np.int64)
    first[order] = order[new][np.cumsum(new) - 1]
    return _merged(vertices, triangles, first)


def welded_along_borders(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Return the mesh with border vertices that differ by round-off of single precision made one.

    Only vertices of edges that are open are looked at, and never the two ends of one edge.
    """
    edge = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    key = edge[:, 0] * len(vertices) + edge[:, 1]
    unique, count = np.unique(key, return_counts=True)
    border = np.unique(np.concatenate(np.divmod(unique[count == 1], len(vertices))))
    points = vertices[border]
    # what is not finite, or so large that its square is not, is reported later
    if not len(border) or not (np.abs(points) < 1e150).all():
        return vertices, triangles
    a, b = np.sort(border[_close_pairs(points, ROUND_OFF * float(np.abs(points).max()))], axis=1).T
    apart = ~np.isin(a * len(vertices) + b, unique)
    if not apart.any():
        return vertices, triangles
    from meshdrape.kernels.components import connected_parts

    label = connected_parts(a[apart], b[apart], len(vertices))
    _, first, inverse = np.unique(label, return_index=True, return_inverse=True)
    return _merged(vertices, triangles, first[inverse])


def _close_pairs(points: Floats, distance: float) -> Ints:
    """Return the pairs (k, 2) of points (n, 3) no farther apart than a distance much smaller than the mesh."""
    # sorted along a line in no plane of symmetry, close points have few others between them
    along = points @ ACROSS
    order = np.argsort(along, kind="stable")
    along = along[order]
    pairs = []
    for step in range(1, len(points)):
        k = np.flatnonzero(along[step:] - along[:-step] <= distance)
        if not len(k):
            break
        pairs.append(np.stack([order[k], order[k + step]], axis=1))
    found = np.concatenate(pairs) if pairs else np.empty((0, 2), dtype=np.int64)
    apart = np.linalg.norm(points[found[:, 0]] - points[found[:, 1]], axis=1)
    return np.asarray(found[apart <= distance])


def _merged(vertices: Floats, triangles: Ints, first: Ints) -> tuple[Floats, Ints]:
    """Every vertex made the one given for it, (n,), which is its own."""
    kept = first == np.arange(len(first))
    return vertices[kept], (np.cumsum(kept) - 1)[first][triangles]
