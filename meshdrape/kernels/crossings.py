"""Where the edges of a net cross the edges of the mesh, so that each vertex can be told the cell it lies in."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT, edge_key
from meshdrape.kernels.generator import VERTEX_AIM, VERTEX_TOUCH, corner_angle, corner_place, turn_about_vertex
from meshdrape.kernels.walk import MAX_CROSSINGS

# The end of an edge this near to a mesh edge, in spacings, lies on whichever side its node says: round-off.
AT_END = 1e-9
# A bent edge is known by its directions at both ends, found by differences: so near, rad, it passes its vertex.
BENT_AIM = 1e-5
# Vertices one edge may run through; an edge along more mesh edges than this is followed no further.
MOST_PASSED = 10_000


@kernel
def _sides(family, i, j, forward):
    """Cells to the left and to the right of a net edge as it is walked: (left i, left j, right i, right j)."""
    if family == WARP:
        left_i, left_j, right_i, right_j = i, j, i, j - 1
    else:
        left_i, left_j, right_i, right_j = i - 1, j, i, j
    if forward:
        return left_i, left_j, right_i, right_j
    return right_i, right_j, left_i, left_j


@kernel
def _note(mesh, face, k, t, sides, nearest, cell):
    """Keep a crossing of edge k of a face, outwards, at the share t of its length, where it is its ends' nearest."""
    # walking out, corner k + 1 lies to the left
    h = 3 * face + k
    if t < nearest[h]:
        nearest[h] = t
        cell[h, 0] = sides[2]
        cell[h, 1] = sides[3]
    other = mesh.neighbour[face, k]
    if other >= 0 and 1.0 - t < nearest[other]:
        nearest[other] = 1.0 - t
        cell[other, 0] = sides[0]
        cell[other, 1] = sides[1]


@kernel
def _left_angle(mesh, face, k, bx, by, out_face, out_k, ox, oy):
    """Angle at a vertex on the left of a path: counter-clockwise from the way out to the way back (bx, by)."""
    sector, ex, ey = corner_angle(mesh, out_face, out_k)
    begin = math.atan2(ex * oy - ey * ox, ex * ox + ey * oy)
    _, ex, ey = corner_angle(mesh, face, k)
    end = math.atan2(ex * by - ey * bx, ex * bx + ey * by)
    total = -begin
    f = out_face
    c = out_k
    for _ in range(MAX_CROSSINGS):
        if f == face and total + end >= -1e-9:
            return total + end
        total += sector
        code = mesh.neighbour[f, (c + 2) % 3]
        if code < 0:
            return math.nan
        f = code // 3
        c = code % 3
        sector, ex, ey = corner_angle(mesh, f, c)
    return math.nan


@kernel
def _follow(mesh, face, x, y, dx, dy, length, head_face, aimed, bent, sides, nearest, cell, passed):
    """Walk one net edge and note what it crosses.

    aimed : a generator's edge that runs through a vertex: it is caught as `trace` catches it, and goes on straightest.
    bent : stop at the first vertex, and say in which face and corner.
    passed : (k,) gets the vertices the edge runs through.

    Returns (number of those vertices, face, corner or -1, direction back from there).
    """
    n_passed = 0
    entered = -1
    only = -1
    # from a vertex, the far edge alone can be the first to be crossed
    for k in range(3):
        cx, cy = corner_place(mesh, face, k)
        if (x - cx) ** 2 + (y - cy) ** 2 <= (VERTEX_TOUCH * length) ** 2:
            only = (k + 1) % 3
    left = length
    tolerance = AT_END * length
    for _ in range(MAX_CROSSINGS):
        exit_at = math.inf
        exit_edge = -1
        for k in range(3):
            if k == entered or (only >= 0 and k != only):
                continue
            nx = mesh.line[face, 3 * k]
            ny = mesh.line[face, 3 * k + 1]
            rate = nx * dx + ny * dy
            if rate < 0.0:
                at = -(nx * x + ny * y - mesh.line[face, 3 * k + 2]) / rate
                if at < exit_at:
                    exit_at = at
                    exit_edge = k
        only = -1
        exit_at = max(exit_at, 0.0)
        caught = -1
        if exit_edge >= 0:
            for k in (exit_edge, (exit_edge + 1) % 3):
                cx, cy = corner_place(mesh, face, k)
                along = (cx - x) * dx + (cy - y) * dy
                if along < -tolerance or along > left + tolerance:
                    continue
                ox, oy = corner_place(mesh, face, (2 * exit_edge + 1 - k) % 3)
                edge = math.sqrt((ox - cx) ** 2 + (oy - cy) ** 2)
                reach = VERTEX_TOUCH * edge
                if aimed:
                    defect = abs(2.0 * math.pi - mesh.vertex_angle[mesh.vertex[face, k]])
                    reach = max(reach, min(VERTEX_AIM, 0.5 * defect) * edge)
                if bent:
                    reach = max(reach, BENT_AIM * length)
                at_x = x + exit_at * dx
                at_y = y + exit_at * dy
                if (
                    abs((cx - x) * dy - (cy - y) * dx) <= reach
                    and (at_x - cx) ** 2 + (at_y - cy) ** 2 <= 16.0 * reach * reach
                ):
                    caught = k
        if caught >= 0:
            cx, cy = corner_place(mesh, face, caught)
            vertex = mesh.vertex[face, caught]
            # beside it an ordinary edge may leave several faces
            if n_passed == 0 or passed[n_passed - 1] != vertex:
                if n_passed == len(passed):
                    return n_passed, face, -1, -dx, -dy
                passed[n_passed] = vertex
                n_passed += 1
            if bent:
                return n_passed, face, caught, -dx, -dy
            done = math.sqrt((cx - x) ** 2 + (cy - y) ** 2)
            if aimed:
                if done > 0.0:
                    dx = (cx - x) / done
                    dy = (cy - y) / done
                left -= done
                total = mesh.vertex_angle[vertex]
                if left <= tolerance or total <= 0.0:
                    return n_passed, face, caught, -dx, -dy
                face, k, dx, dy = turn_about_vertex(mesh, face, caught, -dx, -dy, 0.5 * total)
                if face < 0:
                    return n_passed, face, caught, -dx, -dy
                x, y = corner_place(mesh, face, k)
                only = (k + 1) % 3
                entered = -1
                continue
        if exit_at >= left + tolerance or (exit_at >= left - tolerance and face == head_face):
            return n_passed, face, -1, -dx, -dy
        if exit_edge < 0:
            return n_passed, face, -1, -dx, -dy
        x += exit_at * dx
        y += exit_at * dy
        left -= exit_at
        cx, cy = corner_place(mesh, face, exit_edge)
        ox, oy = corner_place(mesh, face, (exit_edge + 1) % 3)
        t = math.sqrt(((x - cx) ** 2 + (y - cy) ** 2) / ((ox - cx) ** 2 + (oy - cy) ** 2))
        _note(mesh, face, exit_edge, min(t, 1.0), sides, nearest, cell)
        code = mesh.neighbour[face, exit_edge]
        if code < 0:
            return n_passed, face, -1, -dx, -dy
        at = 4 * exit_edge
        c = mesh.crossing[face, at]
        s = mesh.crossing[face, at + 1]
        x, y = c * x - s * y + mesh.crossing[face, at + 2], s * x + c * y + mesh.crossing[face, at + 3]
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code - 3 * face
    return n_passed, face, -1, -dx, -dy


@kernel(nogil=True, makes_arrays=True)
def cross(mesh, net, start, warp, weft, nearest, cell, mark, mark_share):
    """Follow every edge of a net over the mesh, but those of a generator that bend.

    Parameters
    ----------
    nearest : (3 m,) float64
        Gets, for each half-edge 3 f + k, how far from its tail the first net edge crosses it, as a share of its length;
        left infinite where none does. Infinite on entry.
    cell : (3 m, 2) int64
        Gets the cell on the tail's side of that net edge.
    mark : (n, 4) int64, mark_share : (n,)
        Get (vertex, family, i, j) of the net edges that run through a vertex, and the share of its defect that lies to
        the left of the edge towards larger indices.

    Returns
    -------
    int
        Number of such edges, more than n where `mark` was too short to take them all.
    """
    n_warp, n_weft = net.status.shape
    i0 = start.origin[0]
    j0 = start.origin[1]
    n_marks = 0
    passed = np.empty(MOST_PASSED, dtype=np.int64)
    beyond = np.empty(1, dtype=np.int64)
    for family in range(2):
        length = warp if family == WARP else weft
        for i in range(n_warp - (1 if family == WARP else 0)):
            for j in range(n_weft - (1 if family == WEFT else 0)):
                i2 = i + 1 if family == WARP else i
                j2 = j if family == WARP else j + 1
                if net.status[i, j] > OFF_MOULD or net.status[i2, j2] > OFF_MOULD:
                    continue
                generator = (family == WARP and j == j0) or (family == WEFT and i == i0)
                # within one triangle nothing is crossed
                if net.face[i, j] == net.face[i2, j2] and not generator:
                    continue
                forward = i >= i0 if family == WARP else j >= j0
                ti, tj, hi, hj = (i, j, i2, j2) if forward else (i2, j2, i, j)
                # a generator's edge that bends is a chord of another length, which no walk of one spacing follows
                if generator and start.arc[family if forward else family + 2, abs(hi - i0) + abs(hj - j0) - 1]:
                    continue
                face = net.face[ti, tj]
                head_face = net.face[hi, hj]
                x = net.xy[ti, tj, 0]
                y = net.xy[ti, tj, 1]
                dx = net.warp_out[i, j, 0] if family == WARP else net.weft_out[i, j, 0]
                dy = net.warp_out[i, j, 1] if family == WARP else net.weft_out[i, j, 1]
                aimed = False
                if generator:
                    half = family if forward else family + 2
                    aimed = start.through[half, abs(hi - i0) + abs(hj - j0) - 1]
                    if ti == i0 and tj == j0:
                        # at a vertex each half-fibre leaves in a face of its own
                        face = start.face[half]
                        x = start.xy[half, 0]
                        y = start.xy[half, 1]
                        dx = start.out[half, 0]
                        dy = start.out[half, 1]
                bent = dx * dx + dy * dy > 2.0
                ex = 0.0
                ey = 0.0
                if bent:
                    at = np.searchsorted(start.bent_key, edge_key(net, family, i, j))
                    dx = start.bent_ends[at, 0]
                    dy = start.bent_ends[at, 1]
                    ex = start.bent_ends[at, 2]
                    ey = start.bent_ends[at, 3]
                sides = _sides(family, i, j, forward)
                n_passed, back_face, back_k, bx, by = _follow(
                    mesh, face, x, y, dx, dy, length, head_face, aimed, bent, sides, nearest, cell, passed
                )
                share = 0.5
                if bent and back_k >= 0:
                    # the piece beyond the vertex, from its far end
                    sides = _sides(family, i, j, not forward)
                    _, out_face, out_k, ox, oy = _follow(
                        mesh, head_face, net.xy[hi, hj, 0], net.xy[hi, hj, 1], -ex, -ey, length, face, False, True,
                        sides, nearest, cell, beyond,
                    )  # fmt: skip
                    if out_k >= 0 and beyond[0] == passed[0]:
                        # straight on one side, all of the defect lies on the other
                        defect = 2.0 * math.pi - mesh.vertex_angle[passed[0]]
                        angle = _left_angle(mesh, back_face, back_k, bx, by, out_face, out_k, ox, oy)
                        if defect != 0.0 and not math.isnan(angle):
                            share = min(max((math.pi - angle) / defect, 0.0), 1.0)
                for k in range(n_passed):
                    if n_marks < len(mark):
                        mark[n_marks, 0] = passed[k]
                        mark[n_marks, 1] = family
                        mark[n_marks, 2] = i
                        mark[n_marks, 3] = j
                        mark_share[n_marks] = share if forward else 1.0 - share
                    n_marks += 1
    return n_marks
