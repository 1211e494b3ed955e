"""The fourth node of a cell: where two straightest paths of one spacing meet."""

import math

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.certify import is_alone, second_route
from meshdrape.kernels.walk import WALKED, holds, survey, turn_into

PLACED = 0
OUTSIDE = 2
FOLDED = 3
NOT_CONVERGED = 7
# Placed, but one of the two paths may have a shorter way round a convex vertex, or over a back.
DOUBTED = 100

MAX_ITERATIONS = 40
# From here on the two paths are turned in alternation: both at once may jump from side to side of a vertex for ever.
ALTERNATE_FROM = 5
# And from here on by half: a path that jumps to and fro by itself is caught between.
DAMPED_FROM = 24
# Warp and weft closer than one degree to parallel are taken as folded.
FOLD_SINE = math.sin(math.radians(1.0))


@kernel
def place(
    plane, neighbour, frame, vertex, beside, detour, normal,
    fa, xa, ya, ux, uy, wa, fb, xb, yb, vx, vy, wb, side, tolerance,
):  # fmt: skip
    """Point at geodesic distance wa from A and wb from B, near the ends of the two given paths.

    Both paths are walked and brought into one plane, where the ends of all paths that cross the same triangles lie
    on two circles about the unfolded starts. The circles' intersection turns both start directions: where the paths
    sweep over no vertex on the way there, and end in one triangle before and after, that closes the gap, and they
    need not be walked again. Of the two intersections the one on which A's path meets B's counter-clockwise is taken
    if `side` is 1, clockwise if -1: the sense of the quadrant, so that round-off never chooses.

    Returns
    -------
    (code, face, x, y, ux, uy, vx, vy, px, py, qx, qy, iterations)
        Node; directions at A and at B; directions in which the two paths arrive, in the frame of the node's face.
    """
    iterations = 0
    while True:
        code, f1, ax, ay, px, py, near_a, doubt_a, turn_a = survey(plane, neighbour, beside, fa, xa, ya, ux, uy, wa)
        if code != WALKED:
            return OUTSIDE, f1, xa, ya, ux, uy, vx, vy, px, py, px, py, iterations
        code, f2, bx, by, qx, qy, near_b, doubt_b, turn_b = survey(plane, neighbour, beside, fb, xb, yb, vx, vy, wb)
        if code != WALKED:
            return OUTSIDE, f1, xa, ya, ux, uy, vx, vy, px, py, qx, qy, iterations
        x1 = ax + wa * px
        y1 = ay + wa * py
        shared = f1 == f2
        if not shared:
            for k in range(3):
                other = neighbour[f2, k]
                if other >= 0 and other // 3 == f1:
                    at = 8 * k + 4
                    c = plane[f2, at]
                    s = plane[f2, at + 1]
                    bx, by = c * bx - s * by + plane[f2, at + 2], s * bx + c * by + plane[f2, at + 3]
                    qx, qy = c * qx - s * qy, s * qx + c * qy
                    shared = True
                    break
        if shared:
            x2 = bx + wb * qx
            y2 = by + wb * qy
            gap2 = (x2 - x1) ** 2 + (y2 - y1) ** 2
        else:
            gap2, small_a, small_b = _gap_in_space(
                frame, f1, x1, y1, px, py, wa, f2, bx + wb * qx, by + wb * qy, qx, qy, wb
            )
        if gap2 <= tolerance * tolerance:
            if not shared:
                if not _touch(vertex, f1, f2):
                    # two sheets of the surface that lie one on the other: no node
                    return NOT_CONVERGED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations
                qx, qy = turn_into(plane, neighbour, frame, f2, qx, qy, f1)
            break
        if iterations == MAX_ITERATIONS:
            return NOT_CONVERGED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations
        iterations += 1
        met = False
        if shared:
            # circles about A's and B's images
            ex = bx - ax
            ey = by - ay
            d2 = ex * ex + ey * ey
            along = 0.5 * (1.0 + (wa * wa - wb * wb) / d2)
            height2 = wa * wa / d2 - along * along
            if not height2 > 0.0:
                return FOLDED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations
            height = side * math.sqrt(height2)
            cx = ax + along * ex - height * ey
            cy = ay + along * ey + height * ex
            # turn = new direction / old one, as complex numbers
            gx = (cx - ax) / wa
            gy = (cy - ay) / wa
            ca = gx * px + gy * py
            sa = gy * px - gx * py
            hx = (cx - bx) / wb
            hy = (cy - by) / wb
            cb = hx * qx + hy * qy
            sb = hy * qx - hx * qy
            if f1 == f2 and ca > 0.0 and cb > 0.0:
                # a turn sweeps over nothing that stands farther aside than it carries the end
                near_a -= wa * abs(sa)
                near_b -= wb * abs(sb)
                met = near_a > 0.0 and near_b > 0.0 and holds(plane, f1, cx, cy)
        else:
            ca = 1.0
            sa = small_a
            cb = 1.0
            sb = small_b
        if not met and iterations > DAMPED_FROM:
            ca += 1.0
            cb += 1.0
        if not met and iterations > ALTERNATE_FROM:
            if iterations % 2 == 0:
                ca = 1.0
                sa = 0.0
            else:
                cb = 1.0
                sb = 0.0
        per_a = 1.0 / math.sqrt(ca * ca + sa * sa)
        per_b = 1.0 / math.sqrt(cb * cb + sb * sb)
        ux, uy = per_a * (ca * ux - sa * uy), per_a * (sa * ux + ca * uy)
        vx, vy = per_b * (cb * vx - sb * vy), per_b * (sb * vx + cb * vy)
        if met:
            x1 = cx
            y1 = cy
            px = gx
            py = gy
            qx = hx
            qy = hy
            break
    if (px * qy - py * qx) * side < FOLD_SINE:
        return FOLDED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations
    if len(detour) > 0 and (
        (
            not is_alone(near_a, doubt_a, turn_a, wa)
            and second_route(plane, neighbour, detour, normal, fa, xa, ya, ux, uy, wa)
        )
        or (
            not is_alone(near_b, doubt_b, turn_b, wb)
            and second_route(plane, neighbour, detour, normal, fb, xb, yb, vx, vy, wb)
        )
    ):
        return DOUBTED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations
    return PLACED, f1, x1, y1, ux, uy, vx, vy, px, py, qx, qy, iterations


@kernel
def folds_before(sine, ex, ey, gx, gy, ux, uy, vx, vy, side):
    """Whether a cell folds at one of the three corners D, A, B that were there before its node.

    Their angles lie between 1 and 179 degrees in a cell that does not: three corners of a cell may be open and the
    fourth turned over.

    Parameters
    ----------
    sine : float
        Of the angle from warp to weft at D, in the sense of the quadrant.
    ex, ey, gx, gy
        Unit directions in which D's edges arrive: the warp at B, the weft at A.
    ux, uy, vx, vy
        Those in which the node's edges leave: the warp A, the weft B.
    """
    return sine < FOLD_SINE or (ux * gy - uy * gx) * side < FOLD_SINE or (ex * vy - ey * vx) * side < FOLD_SINE


@kernel
def _touch(vertex, f, g):
    """Whether two faces share a vertex."""
    for k in range(3):
        for l in range(3):  # noqa: E741
            if vertex[f, k] == vertex[g, l]:
                return True
    return False


@kernel
def _gap_in_space(frame, f1, x1, y1, px, py, w1, f2, x2, y2, qx, qy, w2):
    """Squared gap between two ends on faces that share no edge, and the two small turns that close it."""
    a = frame[f1]
    b = frame[f2]
    gap2 = 0.0
    m11 = 0.0
    m12 = 0.0
    m22 = 0.0
    r1 = 0.0
    r2 = 0.0
    for k in range(3):
        g = b[k] + x2 * b[3 + k] + y2 * b[6 + k] - a[k] - x1 * a[3 + k] - y1 * a[6 + k]
        n1 = w1 * (-py * a[3 + k] + px * a[6 + k])
        n2 = -w2 * (-qy * b[3 + k] + qx * b[6 + k])
        gap2 += g * g
        m11 += n1 * n1
        m12 += n1 * n2
        m22 += n2 * n2
        r1 += n1 * g
        r2 += n2 * g
    determinant = m11 * m22 - m12 * m12
    if determinant <= 1e-12 * m11 * m22:
        return gap2, 0.0, 0.0
    return gap2, (m22 * r1 - m12 * r2) / determinant, (m11 * r2 - m12 * r1) / determinant
