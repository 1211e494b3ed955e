"""What lies where about a point of the surface, seen along straight paths in the surface.

Two sheets of a mould may lie closer to each other than nodes of one sheet: how near a node is in space does not tell
whether it can be reached. A straight path does, and where nothing is curved it tells exactly how far and which way.
"""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD
from meshdrape.kernels.flood import flood
from meshdrape.kernels.walk import WALKED, walk

MAX_TURNS = 10
# First looks, rad off the chord, for a vertex between the ends may hide one of them.
FIRST_LOOKS = (0.0, 0.1, -0.1, 0.5, -0.5)
# A path that ends this near to the node, in its own lengths, in its face or beside it, has found it: what is left is
# unfolded. Behind a saddle vertex no straight path ends, and one that passes it as near as FOUND_BEHIND stands for it.
FOUND = 1e-2
FOUND_BEHIND = 0.3
# Round-off of the place at which a path ends, in lengths of it.
SAME_PLACE = 1e-9
# A path in a cell is no longer than two of its sides, but where the cell is curved.
REACH = 1.1
# A side seen longer than this, in spacings, is seen to its left and to its right round a tube; one behind the tip of a
# cube's corner appears to be as long.
WIDEST = 2.0


@kernel
def _offset(mesh, face, x, y, px, py, pz):
    """From (x, y) in a face to a point in space: two coordinates in the face's frame, and the third off its plane."""
    f = mesh.frame[face]
    ox = px - f[0]
    oy = py - f[1]
    oz = pz - f[2]
    u = ox * f[3] + oy * f[4] + oz * f[5]
    v = ox * f[6] + oy * f[7] + oz * f[8]
    w = (
        ox * (f[4] * f[8] - f[5] * f[7])
        + oy * (f[5] * f[6] - f[3] * f[8])
        + oz * (f[3] * f[7] - f[4] * f[6])
    )  # fmt: skip
    return u - x, v - y, w


@kernel
def _share_vertex(mesh, f, g):
    for k in range(3):
        for m in range(3):
            if mesh.vertex[f, k] == mesh.vertex[g, m]:
                return True
    return False


@kernel(makes_arrays=True)
def _joined(mesh, f, g, px, py, pz, radius):
    """Whether one can go from face f to face g, which holds the point, over faces that near to it."""
    at = np.array([px, py, pz])
    return bool(np.any(flood(mesh, f, at, at, 2.0 * radius) == g))


@kernel
def sight(mesh, face, x, y, goal, goal_x, goal_y, reach):
    """Where a node in another face appears from (x, y): the way and the length of the straight path to it.

    Parameters
    ----------
    goal, goal_x, goal_y
        Face and place of the node.
    reach : float
        Longer paths do not count, mm.

    Returns
    -------
    (seen, u, v)
        Whether there is such a path; its vector in the frame of `face`, mm.
    """
    g = mesh.frame[goal]
    px = g[0] + goal_x * g[3] + goal_y * g[6]
    py = g[1] + goal_x * g[4] + goal_y * g[7]
    pz = g[2] + goal_x * g[5] + goal_y * g[8]
    u, v, w = _offset(mesh, face, x, y, px, py, pz)
    chord = math.sqrt(u * u + v * v + w * w)
    if chord > reach:
        return False, u, v
    if chord <= SAME_PLACE * reach:
        return _share_vertex(mesh, face, goal), u, v
    size = math.sqrt(u * u + v * v)
    if size <= SAME_PLACE * chord:
        return False, u, v
    # the chord's own length, along the surface
    u *= chord / size
    v *= chord / size
    nearest = math.inf
    near_face = -1
    near_u = u
    near_v = v
    for first in FIRST_LOOKS:
        c = math.cos(first)
        s = math.sin(first)
        lu = c * u - s * v
        lv = s * u + c * v
        for _ in range(MAX_TURNS):
            length = math.sqrt(lu * lu + lv * lv)
            if not 0.0 < length <= reach:
                break
            dx = lu / length
            dy = lv / length
            code, f, ox, oy, ex, ey = walk(mesh.plane, mesh.neighbour, face, x, y, dx, dy, length)
            if code != WALKED:
                break
            # from its end to the node, unfolded where their faces are neighbours
            hu, hv, hw = _offset(mesh, f, ox + length * ex, oy + length * ey, px, py, pz)
            beside = f == goal
            for k in range(3):
                other = mesh.neighbour[goal, k]
                if not beside and other >= 0 and other // 3 == f:
                    c = mesh.crossing[goal, 4 * k]
                    s = mesh.crossing[goal, 4 * k + 1]
                    hu = c * goal_x - s * goal_y + mesh.crossing[goal, 4 * k + 2] - ox - length * ex
                    hv = s * goal_x + c * goal_y + mesh.crossing[goal, 4 * k + 3] - oy - length * ey
                    hw = 0.0
                    beside = True
            aside = math.sqrt(hu * hu + hv * hv)
            gap = math.sqrt(aside * aside + hw * hw)
            along = length + hu * ex + hv * ey
            across = ex * hv - ey * hu
            lu = along * dx - across * dy
            lv = along * dy + across * dx
            if (beside and gap <= FOUND * length) or (gap <= SAME_PLACE * length and _share_vertex(mesh, f, goal)):
                return along * along + across * across <= reach * reach, lu, lv
            # right over it, or under: another sheet
            if not beside and aside <= 0.1 * abs(hw) and not _joined(mesh, f, goal, px, py, pz, 2.0 * gap):
                return False, lu, lv
            if gap < nearest:
                nearest = gap
                near_face = f
                near_u = lu
                near_v = lv
    if nearest > FOUND_BEHIND * chord:
        return False, near_u, near_v
    return _joined(mesh, near_face, goal, px, py, pz, 2.0 * nearest), near_u, near_v


@kernel
def is_whole(status, i, j):
    """Whether the cell (i, j) has its four nodes."""
    n_warp, n_weft = status.shape
    return (
        0 <= i < n_warp - 1
        and 0 <= j < n_weft - 1
        and status[i, j] <= OFF_MOULD
        and status[i + 1, j] <= OFF_MOULD
        and status[i, j + 1] <= OFF_MOULD
        and status[i + 1, j + 1] <= OFF_MOULD
    )


@kernel
def lies_on_cell(mesh, net, i, j, face, x, y, warp, weft, corner):
    """Whether (x, y) in a face lies on the cell (i, j), whose four nodes are seen from there.

    A side between two cells appears the same for both, so a point on a sheet lies on one of its cells and no other.

    Parameters
    ----------
    warp, weft : float
        Spacings, mm.
    corner : (4, 2)
        Gets where the corners (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1) appear, in the frame of the face, mm.
    """
    reach = REACH * (warp + weft)
    for k in range(4):
        ci = i + (1 if k == 1 or k == 2 else 0)
        cj = j + (1 if k >= 2 else 0)
        goal = net.face[ci, cj]
        corner[k, 0] = net.xy[ci, cj, 0] - x
        corner[k, 1] = net.xy[ci, cj, 1] - y
        if goal != face:
            seen, u, v = sight(mesh, face, x, y, goal, net.xy[ci, cj, 0], net.xy[ci, cj, 1], reach)
            if not seen:
                return False
            corner[k, 0] = u
            corner[k, 1] = v
    # sides that a ray along the x axis crosses
    inside = False
    for k in range(4):
        m = (k + 1) % 4
        widest = WIDEST * (warp if k % 2 == 0 else weft)
        if (corner[m, 0] - corner[k, 0]) ** 2 + (corner[m, 1] - corner[k, 1]) ** 2 > widest * widest:
            return False
        ya = corner[k, 1]
        yb = corner[m, 1]
        if (ya > 0.0) != (yb > 0.0):
            # the same for either sense of the side, to the bit
            turn = corner[k, 0] * yb - corner[m, 0] * ya
            if (turn > 0.0) == (yb > ya):
                inside = not inside
    return inside
