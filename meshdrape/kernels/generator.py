"""Straightest geodesics through vertices and along edges, and the star of a vertex."""

import math

from numba import njit

from meshdrape.kernels.walk import LEFT_SURFACE, MAX_CROSSINGS, WALKED

# A path this near to a vertex, relative to the edge it crosses, runs through it: round-off.
VERTEX_TOUCH = 1e-9
# So does one that aims beside it by less than half the vertex's defect and less than this angle, rad: which side it
# passed would turn it by more than that. Symmetric moulds then give symmetric nets, and a fibre along mesh edges keeps
# to them. A flat vertex catches nothing.
VERTEX_AIM = 1e-4


@njit(cache=True, error_model="numpy")
def corner_place(mesh, face, k):
    """Corner k of a face in the face's frame."""
    if k == 0:
        return 0.0, 0.0
    if k == 1:
        return mesh.corner[face, 0], 0.0
    return mesh.corner[face, 1], mesh.corner[face, 2]


@njit(cache=True, error_model="numpy")
def corner_angle(mesh, face, k):
    """Angle at corner k and the direction of the edge from corner k to k + 1."""
    x, y = corner_place(mesh, face, k)
    x1, y1 = corner_place(mesh, face, (k + 1) % 3)
    x2, y2 = corner_place(mesh, face, (k + 2) % 3)
    ax = x1 - x
    ay = y1 - y
    bx = x2 - x
    by = y2 - y
    size = math.sqrt(ax * ax + ay * ay)
    return math.atan2(ax * by - ay * bx, ax * bx + ay * by), ax / size, ay / size


@njit(cache=True, error_model="numpy")
def turn_about_vertex(mesh, face, k, dx, dy, angle):
    """Direction at corner k of `face`, turned counter-clockwise about the vertex by `angle` across unfolded faces.

    Returns (face, corner, dx, dy) in the frame of the face whose sector holds it; face -1 where a border is met.
    """
    sector, ex, ey = corner_angle(mesh, face, k)
    at = math.atan2(ex * dy - ey * dx, ex * dx + ey * dy) + angle
    for _ in range(MAX_CROSSINGS):
        if 0.0 <= at <= sector:
            c = math.cos(at)
            s = math.sin(at)
            return face, k, c * ex - s * ey, s * ex + c * ey
        if at > sector:
            at -= sector
            code = mesh.neighbour[face, (k + 2) % 3]
            if code < 0:
                return -1, k, dx, dy
            face = code // 3
            k = code % 3
            sector, ex, ey = corner_angle(mesh, face, k)
        else:
            code = mesh.neighbour[face, k]
            if code < 0:
                return -1, k, dx, dy
            face = code // 3
            k = (code % 3 + 1) % 3
            sector, ex, ey = corner_angle(mesh, face, k)
            at += sector
    return -1, k, dx, dy


@njit(cache=True, error_model="numpy")
def trace(mesh, face, x, y, dx, dy, only, spacing, count, node_face, node_xy, node_out, node_in, through):
    """Follow the straightest geodesic from (x, y) and set a node every `spacing`, at most `count`.

    Straight over edges, equal angles on both sides through a vertex (Polthier and Schmies, Straightest geodesics on
    polyhedral surfaces, 1998). A start on a vertex names the opposite edge in `only`, the first to be crossed; -1
    elsewhere. The start is not written. node_face (count,), node_xy, node_out, node_in (count, 2)
    get each node's face and place, and the directions in which the fibre leaves and reaches it, in that face's frame;
    through (count,) whether a vertex lies on the edge that reaches it.

    Returns (code, nodes set, length followed): LEFT_SURFACE where the surface ends first.
    """
    n = 0
    # where the current straight piece began, seen in the current frame, and how far along the fibre that is
    sx = x
    sy = y
    begun = 0.0
    done = 0.0
    entered = -1
    for _ in range(MAX_CROSSINGS * 10):
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
        exit_at = max(exit_at, 0.0)
        only = -1
        # a node on the exit edge is left to the next face: past a vertex, directions are those after it
        while n < count and (n + 1) * spacing - done < exit_at - 1e-12 * spacing:
            at = (n + 1) * spacing - done
            node_face[n] = face
            node_xy[n, 0] = x + at * dx
            node_xy[n, 1] = y + at * dy
            node_out[n, 0] = dx
            node_out[n, 1] = dy
            node_in[n, 0] = dx
            node_in[n, 1] = dy
            n += 1
        if n == count:
            return WALKED, n, done
        done += exit_at
        x += exit_at * dx
        y += exit_at * dy
        # through a vertex?
        caught = -1
        for k in (exit_edge, (exit_edge + 1) % 3):
            cx, cy = corner_place(mesh, face, k)
            ox, oy = corner_place(mesh, face, (2 * exit_edge + 1 - k) % 3)
            edge = math.sqrt((ox - cx) ** 2 + (oy - cy) ** 2)
            defect = abs(2.0 * math.pi - mesh.vertex_angle[mesh.vertex[face, k]])
            aim = min(VERTEX_AIM, 0.5 * defect) * min(edge, math.sqrt((cx - sx) ** 2 + (cy - sy) ** 2))
            reach = max(VERTEX_TOUCH * edge, aim)
            if abs((cx - sx) * dy - (cy - sy) * dx) <= reach and (x - cx) ** 2 + (y - cy) ** 2 <= 16.0 * reach * reach:
                caught = k
        if caught >= 0:
            # aim the straight piece at the vertex itself, so that the fibre's length stays its own
            x, y = corner_place(mesh, face, caught)
            length = math.sqrt((x - sx) ** 2 + (y - sy) ** 2)
            if length > 0.0:
                dx = (x - sx) / length
                dy = (y - sy) / length
            done = begun + length
            begun = done
            if n < count and done > n * spacing + 1e-9 * spacing:
                through[n] = True
            total = mesh.vertex_angle[mesh.vertex[face, caught]]
            if total <= 0.0:
                return LEFT_SURFACE, n, done
            face, k, dx, dy = turn_about_vertex(mesh, face, caught, -dx, -dy, 0.5 * total)
            if face < 0:
                return LEFT_SURFACE, n, done
            x, y = corner_place(mesh, face, k)
            sx = x
            sy = y
            # the line may run along a side of this face: only the far edge can be its exit
            only = (k + 1) % 3
            entered = -1
            continue
        code = mesh.neighbour[face, exit_edge]
        if code < 0:
            return LEFT_SURFACE, n, done
        c = mesh.crossing[face, 4 * exit_edge]
        s = mesh.crossing[face, 4 * exit_edge + 1]
        tx = mesh.crossing[face, 4 * exit_edge + 2]
        ty = mesh.crossing[face, 4 * exit_edge + 3]
        x, y = c * x - s * y + tx, s * x + c * y + ty
        sx, sy = c * sx - s * sy + tx, s * sx + c * sy + ty
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code % 3
    return LEFT_SURFACE, n, done
