"""Straight edges between nodes whose places are known: how to leave one end so as to arrive at the other."""

import math

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, keep_edge
from meshdrape.kernels.walk import WALKED, turn_into, walk

MAX_TURNS = 40
# First aims, rad off the chord: a vertex between the ends may hide one of them.
FIRST_AIMS = (0.0, 0.02, -0.02, 0.1, -0.1, 0.3, -0.3)


@kernel
def _gap(mesh, face, x, y, px, py, pz):
    """From a place in a face to a point in space: its two coordinates in the face's frame, and the distance."""
    f = mesh.frame[face]
    ox = px - f[0]
    oy = py - f[1]
    oz = pz - f[2]
    u = ox * f[3] + oy * f[4] + oz * f[5] - x
    v = ox * f[6] + oy * f[7] + oz * f[8] - y
    # what stands off the plane
    nx = f[4] * f[8] - f[5] * f[7]
    ny = f[5] * f[6] - f[3] * f[8]
    nz = f[3] * f[7] - f[4] * f[6]
    w = ox * nx + oy * ny + oz * nz
    return u, v, math.sqrt(u * u + v * v + w * w)


@kernel
def aim(mesh, face, x, y, head_face, head_x, head_y, length, enough):
    """The straight path of a given length that ends nearest to a node.

    Returns (distance of its end from the node, direction at the start, direction at the end in the node's frame).
    """
    h = mesh.frame[head_face]
    px = h[0] + head_x * h[3] + head_y * h[6]
    py = h[1] + head_x * h[4] + head_y * h[7]
    pz = h[2] + head_x * h[5] + head_y * h[8]
    u, v, _ = _gap(mesh, face, x, y, px, py, pz)
    toward = math.atan2(v, u)
    best = math.inf
    best_at = toward
    ex = math.nan
    ey = math.nan
    for first in FIRST_AIMS:
        at = toward + first
        for _ in range(MAX_TURNS):
            code, f, ox, oy, dx, dy = walk(mesh.plane, mesh.neighbour, face, x, y, math.cos(at), math.sin(at), length)
            if code != WALKED:
                break
            u, v, gap = _gap(mesh, f, ox + length * dx, oy + length * dy, px, py, pz)
            if gap < best:
                best = gap
                best_at = at
                ex, ey = turn_into(mesh.plane, mesh.neighbour, mesh.frame, f, dx, dy, head_face)
            turn = (dx * v - dy * u) / length
            if abs(turn) < 1e-15:
                break
            at += turn
        if best <= enough:
            break
    return best, math.cos(best_at), math.sin(best_at), ex, ey


@kernel(nogil=True)
def aim_edges(mesh, net, start, i_first, i_last, warp, weft, enough, gap):
    """Give every edge off the generators its direction, where a straight path of one spacing joins its ends.

    Parameters
    ----------
    net : Lattice
        With places and statuses; the rows i_first <= i < i_last of its directions are written.
    enough : float
        Distance from the node, mm, at which no other aim is tried.
    gap : (2, n_warp, n_weft)
        Gets, by family, how far from its head each edge's straight path ends, mm; NaN where there is no edge and on
        the generators.
    """
    n_warp, n_weft = net.status.shape
    i0 = start.origin[0]
    j0 = start.origin[1]
    for i in range(i_first, i_last):
        for j in range(n_weft):
            for family in range(2):
                gap[family, i, j] = math.nan
                i2 = i + 1 if family == WARP else i
                j2 = j if family == WARP else j + 1
                if i2 >= n_warp or j2 >= n_weft or net.status[i, j] > OFF_MOULD or net.status[i2, j2] > OFF_MOULD:
                    continue
                if (family == WARP and j == j0) or (family != WARP and i == i0):
                    continue
                length = warp if family == WARP else weft
                forward = i >= i0 if family == WARP else j >= j0
                ti, tj, hi, hj = (i, j, i2, j2) if forward else (i2, j2, i, j)
                if net.face[ti, tj] == net.face[hi, hj]:
                    u = net.xy[hi, hj, 0] - net.xy[ti, tj, 0]
                    v = net.xy[hi, hj, 1] - net.xy[ti, tj, 1]
                    size = math.sqrt(u * u + v * v)
                    gap[family, i, j] = abs(size - length)
                    dx = u / size
                    dy = v / size
                    ex = dx
                    ey = dy
                else:
                    gap[family, i, j], dx, dy, ex, ey = aim(
                        mesh, net.face[ti, tj], net.xy[ti, tj, 0], net.xy[ti, tj, 1], net.face[hi, hj],
                        net.xy[hi, hj, 0], net.xy[hi, hj, 1], length, enough,
                    )  # fmt: skip
                keep_edge(net, start, family, ti, tj, 1 if forward else -1, dx, dy, ex, ey)
