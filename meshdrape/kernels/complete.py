"""Arms of a mould that lie back towards the seed, covered from the cloth beyond them.

Quadrants grow away from the generators. Round a reflex corner of the outline, the leg of a U say, cloth has to grow
back: there a node is placed from any two neighbours that close a cell, in any of the four senses of the lattice.
"""

import math

from meshdrape.kernels.aim import aim
from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT, edge_ends, keep_edge
from meshdrape.kernels.place import DOUBTED, NOT_CONVERGED, PLACED, folds_before, place
from meshdrape.kernels.shear import past_stop
from meshdrape.kernels.sweep import FREE_WARP, FREE_WEFT, LOST, STOPPED, UNSURE, straight_on
from meshdrape.kernels.walk import off_mould

OUTSIDE = 2
MET_ITSELF = 4

# Gap, in spacings, within which two fronts of the sheet agree on an edge.
AGREE = 1e-10
# A node is not placed twice in vain.
NOWHERE = -1


@kernel(nogil=True)
def has_bays(status):
    """Whether a node on the mould has a neighbour that no quadrant reached for want of parents."""
    n_warp, n_weft = status.shape
    for i in range(n_warp):
        for j in range(n_weft - 1):
            a = status[i, j]
            b = status[i, j + 1]
            if (a == PLACED and b == OUTSIDE) or (a == OUTSIDE and b == PLACED):
                return True
    for i in range(n_warp - 1):
        for j in range(n_weft):
            a = status[i, j]
            b = status[i + 1, j]
            if (a == PLACED and b == OUTSIDE) or (a == OUTSIDE and b == PLACED):
                return True
    return False


@kernel
def _has(status, i, j):
    return 0 <= i < status.shape[0] and 0 <= j < status.shape[1] and status[i, j] <= OFF_MOULD


@kernel
def _leads_from_mould(status, i, j, back_i, back_j):
    """Whether the fibre through (i, j) left the mould no more than two nodes before."""
    for _ in range(3):
        if not _has(status, i, j):
            return False
        if status[i, j] == PLACED:
            return True
        i += back_i
        j += back_j
    return False


@kernel
def join(mesh, net, start, family, i, j, step, length):
    """Keep the edge from (i, j) to its neighbour, if a straight path of one spacing leads from one to the other.

    Also where the two lie on sheets of the extension that lie one on the other: it is one plane there.
    """
    i2 = i + step if family == WARP else i
    j2 = j if family == WARP else j + step
    gap, dx, dy, ex, ey = aim(
        mesh, net.face[i, j], net.xy[i, j, 0], net.xy[i, j, 1],
        net.face[i2, j2], net.xy[i2, j2, 0], net.xy[i2, j2, 1], length, AGREE * length,
    )  # fmt: skip
    if not gap <= AGREE * length:
        return False
    keep_edge(net, start, family, i, j, step, dx, dy, ex, ey)
    return True


@kernel
def joins_all(mesh, net, start, si, sj, i, j, off, warp, weft):
    """Whether a node just placed from (i - si, j) or (i, j - sj) is one spacing from every other neighbour placed.

    Keeps the edges to those. A neighbour beside the mould that does not agree with a node on it gives way: it is
    OUTSIDE again.

    Parameters
    ----------
    off : bool
        Whether the node lies beside the mould.
    """
    status = net.status
    # the edges to its parents are kept already
    joins_warp = not _has(status, i + si, j) or join(mesh, net, start, WARP, i, j, si, warp)
    joins_weft = not _has(status, i, j + sj) or join(mesh, net, start, WEFT, i, j, sj, weft)
    if joins_warp and joins_weft:
        return True
    # what lies on a generator has its edges from there
    on_generator = i + si == start.origin[0] or j == start.origin[1]
    if not joins_warp and (off or on_generator or status[i + si, j] == PLACED):
        return False
    on_generator = i == start.origin[0] or j + sj == start.origin[1]
    if not joins_weft and (off or on_generator or status[i, j + sj] == PLACED):
        return False
    if not joins_warp:
        status[i + si, j] = OUTSIDE
    if not joins_weft:
        status[i, j + sj] = OUTSIDE
    return True


@kernel
def complete(
    mesh,
    detours,
    net,
    start,
    si,
    sj,
    i_first,
    i_count,
    j_first,
    j_count,
    warp,
    weft,
    initial_angle,
    stop_at,
    tolerance,
    slack,
    report,
):
    """Place nodes that no quadrant reached, in the sense (si, sj), in the rectangle from (i_first, j_first) on.

    As `sweep`, but from whatever cloth there is on the near side, and only where the node agrees with all its
    neighbours on the mould: where two fronts of the sheet come together and do not, it is MET_ITSELF.

    Parameters
    ----------
    report : (5,) int64
        Gets as that of `sweep`: nodes placed, iterations, the (i, j) of a node to be settled, and why.

    Returns
    -------
    bool
        True if the rectangle is done; False if it stopped at report[2:4], marked NOT_CONVERGED.
    """
    status = net.status
    side = float(si * sj)
    for a in range(i_count):
        i = i_first + si * a
        ia = i - si
        for b in range(j_count):
            j = j_first + sj * b
            jb = j - sj
            if status[i, j] != OUTSIDE:
                continue
            has_a = _has(status, ia, j)
            has_b = _has(status, i, jb)
            if not (has_a or has_b):
                continue
            if has_a and has_b:
                if not _has(status, ia, jb):
                    continue
                beside = status[ia, j] == PLACED or status[i, jb] == PLACED or status[ia, jb] == PLACED
                px, py, ex, ey = edge_ends(mesh, net, start, WARP, ia, jb, si, warp)
                qx, qy, gx, gy = edge_ends(mesh, net, start, WEFT, ia, jb, sj, weft)
                c = px * qx + py * qy
                s = py * qx - px * qy
                size = math.sqrt((c * c + s * s) * (gx * gx + gy * gy))
                gx /= size
                gy /= size
                size = math.sqrt((c * c + s * s) * (ex * ex + ey * ey))
                ex /= size
                ey /= size
                code, f, x, y, ux, uy, vx, vy, px, py, qx, qy, iterations = place(
                    mesh.plane, mesh.neighbour, mesh.frame, mesh.vertex, detours.beside, detours.corner, detours.normal,
                    net.face[ia, j], net.xy[ia, j, 0], net.xy[ia, j, 1], c * gx - s * gy, s * gx + c * gy, warp,
                    net.face[i, jb], net.xy[i, jb, 0], net.xy[i, jb, 1], c * ex + s * ey, c * ey - s * ex, weft,
                    side, tolerance,
                )  # fmt: skip
                report[1] += iterations
                if code not in (PLACED, DOUBTED, NOT_CONVERGED):
                    continue
                if code != NOT_CONVERGED and folds_before(-s * side, ex, ey, gx, gy, ux, uy, vx, vy, side):
                    continue
                if code == NOT_CONVERGED and status[ia, j] == OFF_MOULD and status[i, jb] == OFF_MOULD:
                    continue
                net.face[i, j] = f
                net.xy[i, j, 0] = x
                net.xy[i, j, 1] = y
                keep_edge(net, start, WARP, ia, j, si, ux, uy, px, py)
                keep_edge(net, start, WEFT, i, jb, sj, vx, vy, qx, qy)
                why = LOST if code == NOT_CONVERGED else UNSURE if code == DOUBTED else NOWHERE
            else:
                # the sheet's edge hangs free: its last fibre goes straight on
                family = WARP if has_a else WEFT
                step = si if has_a else sj
                length = warp if has_a else weft
                pi = ia if has_a else i
                pj = j if has_a else jb
                bi = pi - si if has_a else i
                bj = j if has_a else pj - sj
                if not _has(status, bi, bj) or not _leads_from_mould(status, pi, pj, bi - pi, bj - pj):
                    continue
                if has_a and _has(status, i, j + sj) and _has(status, ia, j + sj):
                    # cloth on its other side: another sense closes that cell
                    continue
                if has_b and _has(status, i + si, j) and _has(status, i + si, jb):
                    continue
                beside = status[pi, pj] == PLACED
                _, _, dx, dy = edge_ends(mesh, net, start, family, bi, bj, step, length)
                code = straight_on(mesh, detours, net, start, family, pi, pj, step, i, j, dx, dy, length, slack, report)
                if code == OUTSIDE:
                    continue
                why = NOWHERE
                if code >= DOUBTED:
                    why = FREE_WARP if family == WARP else FREE_WEFT
                else:
                    # counted once it is known to agree with its other neighbours
                    report[0] -= 1
            if why != NOWHERE:
                status[i, j] = NOT_CONVERGED
                report[2] = i
                report[3] = j
                report[4] = why
                return False
            off = off_mould(mesh, net.face[i, j], net.xy[i, j, 0], net.xy[i, j, 1], slack)
            if off and not beside:
                continue
            if not joins_all(mesh, net, start, si, sj, i, j, off, warp, weft):
                if not off:
                    status[i, j] = MET_ITSELF
                continue
            status[i, j] = OFF_MOULD if off else PLACED
            if (
                stop_at < math.pi
                and has_a
                and has_b
                and past_stop(mesh, net, start, si, sj, i, j, initial_angle, stop_at, warp, weft)
            ):
                status[i, j] = STOPPED
                continue
            report[0] += 1
    return True
