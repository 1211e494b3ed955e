"""Nodes of a net, cell after cell, in any of the four senses of the lattice."""

import math

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.certify import second_route
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT, edge_ends, keep_edge
from meshdrape.kernels.place import (
    DOUBTED,
    FOLD_SINE,
    FOLDED,
    NOT_CONVERGED,
    OUTSIDE,
    PLACED,
    folds_before,
    place,
)
from meshdrape.kernels.shear import past_stop
from meshdrape.kernels.walk import WALKED, holds, off_mould, walk

STOPPED = 5
NOT_REACHED = 8

# Why a tile stopped at a node that has place and edges: its edges may not be the shortest; or it is held by one fibre
# alone, a warp or a weft, whose edge may not be.
LOST = 0
UNSURE = 1
FREE_WARP = 2
FREE_WEFT = 3


@kernel(nogil=True)
def sweep(
    mesh, detours, net, start, si, sj, i_first, i_count, j_first, j_count,
    warp, weft, initial_angle, stop_at, tolerance, slack, every, arrived, report,
):  # fmt: skip
    """Place the nodes (i_first + si a, j_first + sj b) of one tile, 0 <= a < i_count, 0 <= b < j_count.

    A node has two parents, A one step back along the warp and B one step back along the weft, and the node D that
    closes their cell. Nodes that have a place keep it. Each place depends on parents alone, so tiles may run in any
    order, on any thread, that places parents first.

    The sheet beyond the mould hangs free: where one parent was lost off the mould and the other lies on the mould, or
    on the hem beside it, the fibre goes straight on, as a fibre does that nothing crosses.

    Parameters
    ----------
    si, sj : int
        Sense of the sweep, +1 or -1; parents at i_first - si and j_first - sj must be valid indices.
    warp, weft : float
        Spacing, mm.
    initial_angle, stop_at : float
        A node whose cell is sheared by more than `stop_at` from the initial angle is STOPPED, rad; pi for never.
    tolerance : float
        Largest gap between the ends of a node's two edges, mm.
    slack : float
        A node this near to the border counts as on the mould, mm.
    every : bool
        Leave every node to be settled by others, as if it had not converged: what is found is their first guess.
    arrived : (j_count, 2)
        Directions in which the weft edges of the row before arrive, (0, 0) where not known, as at the beginning.
    report : (5,) int64
        Gets: nodes placed, iterations, the (i, j) of a node to be settled, and why: LOST, UNSURE, FREE_WARP, FREE_WEFT.

    A tile lies in one quadrant, so every edge runs outward, from the parent, its tail, to the node.

    Returns
    -------
    bool
        True if the tile is done; False if it stopped at report[2:4], marked NOT_CONVERGED, and must be called again
        once that node is settled.
    """
    # single arrays for the hot loop: a call with a whole table costs more than what it does
    plane = mesh.plane
    neighbour = mesh.neighbour
    frame = mesh.frame
    vertex = mesh.vertex
    rim = mesh.rim
    beside = detours.beside
    detour = detours.corner
    wary = detours.wary
    normal = detours.normal
    face = net.face
    xy = net.xy
    warp_out = net.warp_out
    weft_out = net.weft_out
    status = net.status
    i0 = start.origin[0]
    j0 = start.origin[1]
    tolerance2 = tolerance * tolerance
    side = float(si * sj)
    stopping = stop_at < math.pi
    angle = initial_angle if side > 0.0 else math.pi - initial_angle
    least = math.cos(min(angle + stop_at, math.pi)) if stopping else -2.0
    most = math.cos(max(angle - stop_at, 0.0)) if stopping else 2.0
    for a in range(i_count):
        i = i_first + si * a
        ia = i - si
        warp_at = min(i, ia)
        # direction in which the warp edge D-B arrives at B; unknown at the start of a row
        known = False
        rx = 0.0
        ry = 0.0
        for b in range(j_count):
            j = j_first + sj * b
            jb = j - sj
            # of the weft edge D-A at A; then of B-C at C, for the next row
            hx = arrived[b, 0]
            hy = arrived[b, 1]
            arrived[b, 0] = 0.0
            arrived[b, 1] = 0.0
            if status[i, j] != NOT_REACHED:
                known = False
                continue
            has_a = status[ia, j] <= OFF_MOULD
            has_b = status[i, jb] <= OFF_MOULD
            if not has_a and not has_b:
                known = False
                status[i, j] = OUTSIDE if status[ia, j] == OUTSIDE and status[i, jb] == OUTSIDE else NOT_REACHED
                continue
            has_d = status[ia, jb] <= OFF_MOULD
            if not (has_a and has_b and has_d):
                known = False
                code = _go_free(mesh, detours, net, start, si, sj, i, j, has_a, has_b, warp, weft, slack, report)
                if code >= DOUBTED:
                    status[i, j] = NOT_CONVERGED
                    report[2] = i
                    report[3] = j
                    report[4] = FREE_WARP if code == DOUBTED + WARP else FREE_WEFT
                    return False
                status[i, j] = code
                continue
            fa = face[ia, j]
            fb = face[i, jb]
            xa = xy[ia, j, 0]
            ya = xy[ia, j, 1]
            xb = xy[i, jb, 0]
            yb = xy[i, jb, 1]
            at_seed = ia == i0 and jb == j0
            # directions in which D's edges arrive, the warp's at B and the weft's at A
            px = 0.0
            py = 0.0
            warp_known = known and not at_seed
            if warp_known:
                ex = rx
                ey = ry
            else:
                px, py, ex, ey = edge_ends(mesh, net, start, WARP, ia, jb, si, warp)
            qx = 0.0
            qy = 0.0
            weft_known = (hx != 0.0 or hy != 0.0) and not at_seed
            if weft_known:
                gx = hx
                gy = hy
            else:
                qx, qy, gx, gy = edge_ends(mesh, net, start, WEFT, ia, jb, sj, weft)
            if fa == fb and not wary[fa] and not at_seed and not every:
                # the planar fourth corner of the rhombus, if this triangle holds it
                x = xa + warp * ex
                y = ya + warp * ey
                away_x = xb + weft * gx - x
                away_y = yb + weft * gy - y
                if (
                    away_x * away_x + away_y * away_y <= tolerance2
                    and holds(plane, fa, x, y)
                    and (ex * gy - ey * gx) * side > FOLD_SINE
                    and not (stopping and not least <= ex * gx + ey * gy <= most)
                ):
                    face[i, j] = fa
                    xy[i, j, 0] = x
                    xy[i, j, 1] = y
                    warp_out[warp_at, j, 0] = ex
                    warp_out[warp_at, j, 1] = ey
                    weft_out[i, min(j, jb), 0] = gx
                    weft_out[i, min(j, jb), 1] = gy
                    arrived[b, 0] = gx
                    arrived[b, 1] = gy
                    if rim[fa] < 0:
                        status[i, j] = PLACED
                    else:
                        status[i, j] = OFF_MOULD if off_mould(mesh, fa, x, y, slack) else PLACED
                    report[0] += 1
                    known = True
                    rx = ex
                    ry = ey
                    continue
            # and those in which they leave D
            if warp_known:
                px = warp_out[warp_at, jb, 0]
                py = warp_out[warp_at, jb, 1]
            if weft_known:
                qx = weft_out[ia, min(j, jb), 0]
                qy = weft_out[ia, min(j, jb), 1]
            # first guess: a rhombus of no curvature, D's edges carried along D-A and D-B
            if at_seed:
                half = half_fibre(si, sj)
                # quadrants counter-clockwise; weft seen from warp is left of it where si and sj agree
                c = math.cos(start.sector[half])
                s = -side * math.sin(start.sector[half])
            else:
                # p / q as complex numbers: the turn from the weft edge to the warp edge at D
                c = px * qx + py * qy
                s = py * qx - px * qy
            # unit to the last bit, or lengths would drift from cell to cell: one Newton step of 1 / sqrt renews them
            scale = 1.5 - 0.5 * (c * c + s * s) * (gx * gx + gy * gy)
            gx *= scale
            gy *= scale
            scale = 1.5 - 0.5 * (c * c + s * s) * (ex * ex + ey * ey)
            ex *= scale
            ey *= scale
            ux = c * gx - s * gy
            uy = s * gx + c * gy
            vx = c * ex + s * ey
            vy = c * ey - s * ex
            code, f, x, y, ux, uy, vx, vy, px, py, qx, qy, iterations = place(
                plane,
                neighbour,
                frame,
                vertex,
                beside,
                detour,
                normal,
                fa,
                xa,
                ya,
                ux,
                uy,
                warp,
                fb,
                xb,
                yb,
                vx,
                vy,
                weft,
                side,
                tolerance,
            )
            report[1] += iterations
            if code in (PLACED, DOUBTED) and folds_before(-s * side, ex, ey, gx, gy, ux, uy, vx, vy, side):
                code = FOLDED
            if every and code == PLACED:
                code = NOT_CONVERGED
            if code == PLACED:
                report[0] += 1
                face[i, j] = f
                xy[i, j, 0] = x
                xy[i, j, 1] = y
                warp_out[warp_at, j, 0] = ux
                warp_out[warp_at, j, 1] = uy
                weft_out[i, min(j, jb), 0] = vx
                weft_out[i, min(j, jb), 1] = vy
                arrived[b, 0] = qx
                arrived[b, 1] = qy
                status[i, j] = PLACED
                if rim[f] >= 0 and off_mould(mesh, f, x, y, slack):
                    status[i, j] = OFF_MOULD
                known = True
                rx = px
                ry = py
                if stopping and past_stop(mesh, net, start, si, sj, i, j, initial_angle, stop_at, warp, weft):
                    report[0] -= 1
                    status[i, j] = STOPPED
                    arrived[b, 0] = 0.0
                    arrived[b, 1] = 0.0
                    known = False
            else:
                known = False
                asked = code == DOUBTED or (every and code == NOT_CONVERGED)
                if status[ia, j] == OFF_MOULD and status[i, jb] == OFF_MOULD and not asked:
                    # the extension is no mould: what fails on it is lost to it, not to the cloth
                    code = OUTSIDE
                status[i, j] = code
                if code in (NOT_CONVERGED, DOUBTED):
                    face[i, j] = f
                    xy[i, j, 0] = x
                    xy[i, j, 1] = y
                    warp_out[warp_at, j, 0] = ux
                    warp_out[warp_at, j, 1] = uy
                    weft_out[i, min(j, jb), 0] = vx
                    weft_out[i, min(j, jb), 1] = vy
                    status[i, j] = NOT_CONVERGED
                    report[2] = i
                    report[3] = j
                    report[4] = UNSURE if code == DOUBTED else LOST
                    return False
    return True


@kernel
def half_fibre(si, sj):
    """Half-fibre that bounds a quadrant clockwise; they are numbered counter-clockwise from +warp."""
    if sj > 0:
        return 0 if si > 0 else 1
    return 2 if si < 0 else 3


@kernel
def _near_mould(status, i, j, back_i, back_j, i0, j0):
    """Whether the fibre left the mould no more than two nodes before (i, j), on this side of the generators."""
    for _ in range(3):
        if i < 0 or j < 0 or i >= status.shape[0] or j >= status.shape[1] or status[i, j] > OFF_MOULD:
            return False
        if status[i, j] == PLACED:
            return True
        # beyond a generator lies another quadrant, which may be swept later
        if (back_i != 0 and i == i0) or (back_j != 0 and j == j0):
            return False
        i += back_i
        j += back_j
    return False


@kernel
def _go_free(mesh, detours, net, start, si, sj, i, j, has_a, has_b, warp, weft, slack, report):
    """Status of a node that lacks a parent, placed straight on from the other one where the sheet hangs free."""
    status = net.status
    i0 = start.origin[0]
    j0 = start.origin[1]
    ia = i - si
    jb = j - sj
    side = float(si * sj)
    half = half_fibre(si, sj)
    if has_a and status[i, jb] == OUTSIDE and _near_mould(status, ia, j, -si, 0, i0, j0):
        if ia != i0:
            if status[ia - si, j] <= OFF_MOULD:
                _, _, dx, dy = edge_ends(mesh, net, start, WARP, ia - si, j, si, warp)
                return straight_on(mesh, detours, net, start, WARP, ia, j, si, i, j, dx, dy, warp, slack, report)
        elif status[ia, jb] <= OFF_MOULD:
            # from the weft generator itself: at the initial angle
            _, _, gx, gy = edge_ends(mesh, net, start, WEFT, ia, jb, sj, weft)
            c = math.cos(start.sector[half])
            s = -side * math.sin(start.sector[half])
            return straight_on(
                mesh, detours, net, start, WARP, ia, j, si, i, j, c * gx - s * gy, s * gx + c * gy, warp, slack, report
            )
    if has_b and status[ia, j] == OUTSIDE and _near_mould(status, i, jb, 0, -sj, i0, j0):
        if jb != j0:
            if status[i, jb - sj] <= OFF_MOULD:
                _, _, dx, dy = edge_ends(mesh, net, start, WEFT, i, jb - sj, sj, weft)
                return straight_on(mesh, detours, net, start, WEFT, i, jb, sj, i, j, dx, dy, weft, slack, report)
        elif status[ia, jb] <= OFF_MOULD:
            _, _, gx, gy = edge_ends(mesh, net, start, WARP, ia, jb, si, warp)
            c = math.cos(start.sector[half])
            s = side * math.sin(start.sector[half])
            return straight_on(
                mesh, detours, net, start, WEFT, i, jb, sj, i, j, c * gx - s * gy, s * gx + c * gy, weft, slack, report
            )
    if (has_a or status[ia, j] == OUTSIDE) and (has_b or status[i, jb] == OUTSIDE):
        return OUTSIDE
    return NOT_REACHED


@kernel
def straight_on(mesh, detours, net, start, family, i, j, step, i2, j2, dx, dy, length, slack, report):
    """Place (i2, j2) one edge straight on from (i, j).

    Returns its status, or DOUBTED and the family of the edge that may have a shorter way.
    """
    size = math.sqrt(dx * dx + dy * dy)
    dx /= size
    dy /= size
    tail = net.face[i, j]
    x = net.xy[i, j, 0]
    y = net.xy[i, j, 1]
    doubted = len(detours.corner) > 0 and second_route(
        mesh.plane, mesh.neighbour, detours.corner, detours.normal, tail, x, y, dx, dy, length
    )
    code, f, x, y, ex, ey = walk(mesh.plane, mesh.neighbour, tail, x, y, dx, dy, length)
    if code != WALKED:
        return OUTSIDE
    x += length * ex
    y += length * ey
    net.face[i2, j2] = f
    net.xy[i2, j2, 0] = x
    net.xy[i2, j2, 1] = y
    keep_edge(net, start, family, i, j, step, dx, dy, ex, ey)
    if doubted:
        return DOUBTED + family
    report[0] += 1
    return OFF_MOULD if off_mould(mesh, f, x, y, slack) else PLACED
