"""Whether a straight path is sure to be the shortest: nothing beside it offers a shorter way round."""

import math

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.tables import KEPT_OUT
from meshdrape.kernels.walk import MAX_CROSSINGS

# A path over which the surface turns by more than about 100 degrees may lie on a tube, with another way round the back.
# One sharp crease turns it by 90.
TURNED_OVER = -0.17
# Turns at the edges crossed that add up to less, rad, turn nothing over: TURNED_OVER is the cosine of 1.742.
MOST_TURN = 1.74
# Vertices that give less than this part of the turn are not counted.
LEAST_DOUBT = 0.01


@kernel
def _doubt(d, ax, ay, bx, by, dx, dy):
    """How near a corner comes to offering a shorter way to a path that it sees go from (ax, ay) to (bx, by).

    `d` is its entry in `Detours.corner`, (dx, dy) the path's direction. The part of its turn that it would have to
    give, positive if it lies on the left, negative on the right; infinite if it may offer one by itself.
    """
    # the angle at the vertex between both ends, on the path's side, against pi less what d is the tangent of
    dot = ax * bx + ay * by
    cross = ax * by - ay * bx
    if 0.0 < d < KEPT_OUT:
        turn = -d * dot
        return turn / cross if turn > LEAST_DOUBT * abs(cross) else 0.0
    if d < 0.0:
        return math.inf if dot < 0.0 or abs(cross) > -d * dot else 0.0
    # whether the path comes within a radius
    before = ax * dx + ay * dy
    beyond = bx * dx + by * dy
    if before > 0.0:
        away2 = ax * ax + ay * ay
    elif beyond < 0.0:
        away2 = bx * bx + by * by
    else:
        away2 = (ax * dy - ay * dx) ** 2
    return math.inf if away2 < (d - KEPT_OUT) ** 2 else 0.0


@kernel
def is_alone(near, doubt, turn, length):
    """Whether a straight path is sure to have no second route, by what `survey` tells of what stands beside it.

    A vertex of angle defect d at a lateral distance y gives at most d length / (8 y) of what `second_route` adds up:
    where they all would not do that stood as near as the nearest, nothing need be followed once more.
    """
    return doubt * length <= 4.0 * near and turn < MOST_TURN


@kernel
def second_route(plane, neighbour, detour, normal, face, x, y, dx, dy, length):
    """Whether a straight path may have a shorter second route: round convex vertices, or over the back of a tube.

    Round a vertex of angle defect d the two ways between a path's ends are equally long where the ends are seen from
    the vertex at an angle of pi - d / 2 on either side. For small defects that is a lateral distance
    y = d s r / (2 (s + r)), s and r being the path's lengths before and after the vertex. A way round several
    vertices of one side sags by w(s) for a length of half the integral of w'^2, and gains d (w - y) at each; by the
    inequality of Cauchy and Schwarz none is shorter while d s r / (2 y (s + r)) adds up to less than one.

    True is no proof: it is for exact distances to decide.

    It is written so that numba counts no reference to an array: counting takes longer than all the rest.

    Parameters
    ----------
    plane, neighbour
        Of `Unfolding`, as `walk` has them.
    detour, normal : (m, 3)
        Of `Detours`, not empty.
    """
    tx = x + length * dx
    ty = y + length * dy
    left = 0.0
    right = 0.0
    for k in range(3):
        d = detour[face, k]
        if d != 0.0:
            cx = plane[face, 8 * k + 2]
            cy = plane[face, 8 * k + 3]
            doubt = _doubt(d, x - cx, y - cy, tx - cx, ty - cy, dx, dy)
            if doubt > 0.0:
                left += doubt
            else:
                right -= doubt
    nx = normal[face, 0]
    ny = normal[face, 1]
    nz = normal[face, 2]
    entered = -1
    for _ in range(MAX_CROSSINGS):
        # over the edge that the end lies beyond; of two the one that the line itself crosses
        exit_edge = -1
        for k in range(3):
            at = 8 * k
            height = plane[face, at] * (tx - plane[face, at + 2]) + plane[face, at + 1] * (ty - plane[face, at + 3])
            if k == entered or height >= 0.0:
                continue
            exit_edge = k
            ux = plane[face, at + 2]
            uy = plane[face, at + 3]
            at = at + 8 if k < 2 else 0
            vx = plane[face, at + 2]
            vy = plane[face, at + 3]
            # its tail to the right of the line, its head to the left
            if dx * (uy - y) - dy * (ux - x) <= 0.0 and dx * (vy - y) - dy * (vx - x) >= 0.0:
                break
        if exit_edge < 0:
            return left > 1.0 or right > 1.0
        code = neighbour[face, exit_edge]
        if code < 0:
            return left > 1.0 or right > 1.0
        at = 8 * exit_edge + 4
        c = plane[face, at]
        s = plane[face, at + 1]
        x, y = c * x - s * y + plane[face, at + 2], s * x + c * y + plane[face, at + 3]
        tx, ty = c * tx - s * ty + plane[face, at + 2], s * tx + c * ty + plane[face, at + 3]
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code - 3 * face
        # the one corner that is new
        k = (entered + 2) % 3
        d = detour[face, k]
        if d != 0.0:
            cx = plane[face, 8 * k + 2]
            cy = plane[face, 8 * k + 3]
            doubt = _doubt(d, x - cx, y - cy, tx - cx, ty - cy, dx, dy)
            if doubt > 0.0:
                left += doubt
            else:
                right -= doubt
        if nx * normal[face, 0] + ny * normal[face, 1] + nz * normal[face, 2] < TURNED_OVER:
            left = math.inf
    return left > 1.0 or right > 1.0
