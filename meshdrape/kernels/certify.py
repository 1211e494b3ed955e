"""Whether a straight path is sure to be the shortest: no convex vertex beside it offers a shorter way round."""

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.walk import MAX_CROSSINGS

# A path over which the surface turns by more than about 100 degrees may lie on a tube, with another way round the back.
# One sharp crease turns it by 90.
TURNED_OVER = -0.17


@kernel(inline="always")
def turned_over(normal, f, g):
    """Whether the normals of two faces are so far apart that a tube's back may be the shorter way."""
    return normal[f, 0] * normal[g, 0] + normal[f, 1] * normal[g, 1] + normal[f, 2] * normal[g, 2] < TURNED_OVER


@kernel
def _round_corner(detour, cx, cy, x, y, tx, ty):
    """Whether the way from (x, y) to (tx, ty) round the far side of the corner (cx, cy) may be the shorter."""
    # the angle at the vertex between both ends, on the path's side, exceeds pi less what `detour` is the tangent of
    ax = x - cx
    ay = y - cy
    bx = tx - cx
    by = ty - cy
    dot = ax * bx + ay * by
    cross = abs(ax * by - ay * bx)
    if detour > 0.0:
        return cross < -detour * dot
    return dot < 0.0 or cross > -detour * dot


@kernel
def second_route(plane, neighbour, detour, face, x, y, dx, dy, length):
    """Whether a straight path may have a shorter second route round a convex vertex.

    Round a vertex of angle defect d the two ways between a path's ends are equally long where the ends are seen from
    the vertex at an angle of pi - d / 2 on either side. For small defects that is a lateral distance of
    d s r / (2 (s + r)), s and r being the path's lengths before and after the vertex. True is no proof: it is for
    exact distances to decide. False is one, but for vertices in no face that the path crosses.

    Parameters
    ----------
    plane, neighbour
        Of `Unfolding`, as `walk` has them.
    detour : (m, 3)
        `Detours.tangent`.
    """
    tx = x + length * dx
    ty = y + length * dy
    for k in range(3):
        d = detour[face, k]
        if d != 0.0:
            cx = 0.0
            cy = 0.0
            if k == 1:
                cx = plane[face, 21]
            elif k == 2:
                cx = plane[face, 22]
                cy = plane[face, 23]
            if _round_corner(d, cx, cy, x, y, tx, ty):
                return True
    entered = -1
    for _ in range(MAX_CROSSINGS):
        # over the edge that the end lies beyond and that the line itself crosses
        exit_edge = -1
        for k in range(3):
            if k == entered:
                continue
            if plane[face, 3 * k] * tx + plane[face, 3 * k + 1] * ty - plane[face, 3 * k + 2] >= 0.0:
                continue
            ux = 0.0
            uy = 0.0
            vx = plane[face, 21]
            vy = 0.0
            if k == 1:
                ux = plane[face, 21]
                vx = plane[face, 22]
                vy = plane[face, 23]
            elif k == 2:
                ux = plane[face, 22]
                uy = plane[face, 23]
                vx = 0.0
            # the edge's tail lies to the right of the line, its head to the left
            if dx * (uy - y) - dy * (ux - x) <= 0.0 and dx * (vy - y) - dy * (vx - x) >= 0.0:
                exit_edge = k
                break
        if exit_edge < 0:
            return False
        code = neighbour[face, exit_edge]
        if code < 0:
            return False
        at = 9 + 4 * exit_edge
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
            cx = 0.0
            cy = 0.0
            if k == 1:
                cx = plane[face, 21]
            elif k == 2:
                cx = plane[face, 22]
                cy = plane[face, 23]
            if _round_corner(d, cx, cy, x, y, tx, ty):
                return True
    return False
