"""Edges between nodes: the direction kept of each, and both ends made from it."""

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.walk import turn_into, walk

OFF_MOULD = 1

WARP = 0
WEFT = 1


@kernel
def edge_key(net, family, i, j):
    """Number of the edge kept at [i, j] of its family."""
    return 2 * (i * net.status.shape[1] + j) + family


@kernel
def edge_ends(mesh, net, start, family, i, j, step, length):
    """Direction of the edge from (i, j) to its neighbour `step` (+1 or -1) on, at both ends, each in its node's frame.

    Returns (dx, dy, ex, ey): leaving (i, j), arriving at the neighbour. Only the seed's side is kept of an edge,
    so the other end is walked to, unless one face holds both.
    """
    i0 = start.origin[0]
    j0 = start.origin[1]
    if family == WARP:
        i2 = i + step
        j2 = j
        outward = (i2 > i0) == (step > 0) and (i2 - i0) != 0
        lower_i = min(i, i2)
        ox = net.warp_out[lower_i, j, 0]
        oy = net.warp_out[lower_i, j, 1]
    else:
        i2 = i
        j2 = j + step
        outward = (j2 > j0) == (step > 0) and (j2 - j0) != 0
        lower_j = min(j, j2)
        ox = net.weft_out[i, lower_j, 0]
        oy = net.weft_out[i, lower_j, 1]
    if outward:
        ti = i
        tj = j
        hi = i2
        hj = j2
    else:
        ti = i2
        tj = j2
        hi = i
        hj = j
    tail_face = net.face[ti, tj]
    head_face = net.face[hi, hj]
    sx = ox
    sy = oy
    # on a generator, which a vertex may have turned on its way?
    half = -1
    order = 0
    if family == WARP and j == j0:
        half = 0 if hi > ti else 2
        order = abs(hi - i0)
    elif family == WEFT and i == i0:
        half = 1 if hj > tj else 3
        order = abs(hj - j0)
    if half >= 0 and order <= start.n_nodes[half]:
        ex = start.arrival[half, order - 1, 0]
        ey = start.arrival[half, order - 1, 1]
    elif ox * ox + oy * oy > 2.0:
        # a bent edge: twice a unit vector marks it
        at = np.searchsorted(start.bent_key, edge_key(net, family, min(ti, hi), min(tj, hj)))
        sx = start.bent_ends[at, 0]
        sy = start.bent_ends[at, 1]
        ex = start.bent_ends[at, 2]
        ey = start.bent_ends[at, 3]
    elif tail_face == head_face:
        ex = ox
        ey = oy
    else:
        _, face, _, _, ex, ey = walk(
            mesh.plane, mesh.neighbour, tail_face, net.xy[ti, tj, 0], net.xy[ti, tj, 1], ox, oy, length
        )
        ex, ey = turn_into(mesh.plane, mesh.neighbour, mesh.frame, face, ex, ey, head_face)
    if outward:
        return sx, sy, ex, ey
    return -ex, -ey, -sx, -sy


@kernel
def keep_edge(net, start, family, i, j, step, dx, dy, ex, ey):
    """Keep the edge from (i, j) to its neighbour: (dx, dy) leaves (i, j), (ex, ey) arrives at the neighbour."""
    if family == WARP:
        i2 = i + step
        k = min(i, i2)
        if (i2 > start.origin[0]) == (step > 0) and i2 != start.origin[0]:
            net.warp_out[k, j, 0] = dx
            net.warp_out[k, j, 1] = dy
        else:
            net.warp_out[k, j, 0] = -ex
            net.warp_out[k, j, 1] = -ey
    else:
        j2 = j + step
        k = min(j, j2)
        if (j2 > start.origin[1]) == (step > 0) and j2 != start.origin[1]:
            net.weft_out[i, k, 0] = dx
            net.weft_out[i, k, 1] = dy
        else:
            net.weft_out[i, k, 0] = -ex
            net.weft_out[i, k, 1] = -ey
