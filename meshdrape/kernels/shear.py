"""Shear of cells, from the angles between their edges in the surface."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT, edge_ends


@kernel(inline="always")
def _angle(px, py, qx, qy):
    return math.atan2(px * qy - py * qx, px * qx + py * qy)


@kernel
def _mean_corner(start, i, j, ax, ay, bx, by, cx, cy, dx, dy, ex, ey, fx, fy, gx, gy, hx, hy):
    """Mean angle from +warp to +weft over the corners of the cell (i, j)-(i + 1, j + 1).

    Directions at both ends of its four edges: (a, b) the warp edge from (i, j), (c, d) that from (i, j + 1), (e, f) the
    weft edge from (i, j), (g, h) that from (i + 1, j).
    """
    i0 = start.origin[0]
    j0 = start.origin[1]
    total = _angle(ax, ay, ex, ey)
    total += _angle(dx, dy, hx, hy)
    total += _angle(bx, by, gx, gy)
    total += _angle(cx, cy, fx, fy)
    # the seed's own corner is its share of the star's angle, whatever the frames say
    if (i == i0 or i + 1 == i0) and (j == j0 or j + 1 == j0):
        if i == i0 and j == j0:
            total += start.sector[0] - _angle(ax, ay, ex, ey)
        elif j == j0:
            total += math.pi - start.sector[1] - _angle(bx, by, gx, gy)
        elif i == i0:
            total += math.pi - start.sector[3] - _angle(cx, cy, fx, fy)
        else:
            total += start.sector[2] - _angle(dx, dy, hx, hy)
    return 0.25 * total


@kernel
def shear_of(mesh, net, start, i, j, initial_angle, warp, weft):
    """Signed shear of one cell (i, j)-(i + 1, j + 1) that has all its corners, rad, as `cell_shear` has it."""
    ax, ay, bx, by = edge_ends(mesh, net, start, WARP, i, j, 1, warp)
    cx, cy, dx, dy = edge_ends(mesh, net, start, WARP, i, j + 1, 1, warp)
    ex, ey, fx, fy = edge_ends(mesh, net, start, WEFT, i, j, 1, weft)
    gx, gy, hx, hy = edge_ends(mesh, net, start, WEFT, i + 1, j, 1, weft)
    return initial_angle - _mean_corner(start, i, j, ax, ay, bx, by, cx, cy, dx, dy, ex, ey, fx, fy, gx, gy, hx, hy)


@kernel
def past_stop(mesh, net, start, si, sj, i, j, initial_angle, stop_at, warp, weft):
    """Whether the cell of a node and its parents, one step back in the sense (si, sj), is sheared too far."""
    shear = shear_of(mesh, net, start, min(i, i - si), min(j, j - sj), initial_angle, warp, weft)
    return abs(shear) > stop_at


@kernel(nogil=True, makes_arrays=True)
def cell_shear(mesh, net, start, i_first, initial_angle, warp, weft, out):
    """Signed shear of the cells (i, j)-(i + 1, j + 1) of the rows from i_first on, out (rows, n_weft - 1), rad.

    Initial angle less the mean over the four corners of the angle from +warp to +weft, measured in the surface: the
    corners at (i, j) and (i + 1, j + 1) as they are, the other two as supplements. NaN where a corner is missing.
    """
    n_weft = net.status.shape[1]
    i0 = start.origin[0]
    j0 = start.origin[1]
    # weft edges of the row below, both ends
    below = np.empty((n_weft, 4))
    above = np.empty((n_weft, 4))
    above_row = -1
    for a in range(out.shape[0]):
        i = i_first + a
        reuse = above_row == i
        if reuse:
            below, above = above, below
        above_row = i + 1
        # both ends of the warp edge this cell shares with the one before it, where that has found them
        cx = math.nan
        cy = dx = dy = cx
        for j in range(n_weft - 1):
            f = net.face[i, j]
            placed = net.status[i, j] <= OFF_MOULD and net.status[i, j + 1] <= OFF_MOULD
            placed_above = net.status[i + 1, j] <= OFF_MOULD and net.status[i + 1, j + 1] <= OFF_MOULD
            if not (placed and placed_above):
                out[a, j] = math.nan
                if placed_above:
                    px, py, qx, qy = edge_ends(mesh, net, start, WEFT, i + 1, j, 1, weft)
                    above[j, 0] = px
                    above[j, 1] = py
                    above[j, 2] = qx
                    above[j, 3] = qy
                cx = math.nan
                continue
            g = net.face[i + 1, j]
            one_face = f == g and f == net.face[i, j + 1] and f == net.face[i + 1, j + 1]
            # beside a generator, whose edges may bend, it need not be a rhombus
            if one_face and i not in (i0 - 1, i0) and j not in (j0 - 1, j0):
                px = net.xy[i + 1, j, 0] - net.xy[i, j, 0]
                py = net.xy[i + 1, j, 1] - net.xy[i, j, 1]
                qx = net.xy[i, j + 1, 0] - net.xy[i, j, 0]
                qy = net.xy[i, j + 1, 1] - net.xy[i, j, 1]
                out[a, j] = initial_angle - _angle(px, py, qx, qy)
                # the row above asks for this edge again if it needs it: it must not matter where a block begins
                above[j, 0] = math.nan
                cx = math.nan
                continue
            if not reuse or math.isnan(below[j, 0]):
                px, py, qx, qy = edge_ends(mesh, net, start, WEFT, i, j, 1, weft)
                below[j, 0] = px
                below[j, 1] = py
                below[j, 2] = qx
                below[j, 3] = qy
            px, py, qx, qy = edge_ends(mesh, net, start, WEFT, i + 1, j, 1, weft)
            above[j, 0] = px
            above[j, 1] = py
            above[j, 2] = qx
            above[j, 3] = qy
            if math.isnan(cx):
                ax, ay, bx, by = edge_ends(mesh, net, start, WARP, i, j, 1, warp)
            else:
                ax, ay, bx, by = cx, cy, dx, dy
            cx, cy, dx, dy = edge_ends(mesh, net, start, WARP, i, j + 1, 1, warp)
            out[a, j] = initial_angle - _mean_corner(
                start, i, j, ax, ay, bx, by, cx, cy, dx, dy,
                below[j, 0], below[j, 1], below[j, 2], below[j, 3],
                above[j, 0], above[j, 1], above[j, 2], above[j, 3],
            )  # fmt: skip
