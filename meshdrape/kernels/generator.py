"""Straightest geodesics through vertices and along edges, and the star of a vertex."""

import math

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.walk import LEFT_SURFACE, MAX_CROSSINGS, WALKED

# Further outcome of a trace: its turn at the crease leads back over the crease.
TURNED_BACK = 2
# Where a fibre turned, if not on an edge: it has not met a crease; it turned at a node.
NOT_TURNED = -2
TURNED_AT_NODE = -1

# A path this near to a vertex, relative to the edge it crosses, runs through it: round-off.
VERTEX_TOUCH = 1e-9
# So does one that aims beside it by less than half the vertex's defect and less than this angle, rad: which side it
# passed would turn it by more than that. Symmetric moulds then give symmetric nets, and a fibre along mesh edges keeps
# to them. A flat vertex catches nothing.
VERTEX_AIM = 1e-4


@kernel
def corner_place(mesh, face, k):
    """Corner k of a face in the face's frame."""
    if k == 0:
        return 0.0, 0.0
    if k == 1:
        return mesh.corner[face, 0], 0.0
    return mesh.corner[face, 1], mesh.corner[face, 2]


@kernel
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


@kernel
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


@kernel
def crease_gap(mesh, crease, face, k, dx, dy):
    """Angles to the creases at corner k of `face` on both sides of the straight way out of a fibre that came in.

    (dx, dy) points back to where the fibre came from; angles are counted from it, counter-clockwise about the vertex.
    Returns (low, high), the creases next to half the star's angle; they hold between them the ways over the crease.
    (0, 0) where the fibre crosses none: it runs along one, or one side has none.
    """
    total = mesh.vertex_angle[mesh.vertex[face, k]]
    half = 0.5 * total
    _, ex, ey = corner_angle(mesh, face, k)
    at = -math.atan2(ex * dy - ey * dx, ex * dx + ey * dy)
    low = 0.0
    high = total
    first = face
    while True:
        if crease[face, k]:
            edge = at % total
            if min(edge, total - edge) < VERTEX_AIM or abs(edge - half) < VERTEX_AIM:
                return 0.0, 0.0
            if edge < half:
                low = max(low, edge)
            else:
                high = min(high, edge)
        at += corner_angle(mesh, face, k)[0]
        code = mesh.neighbour[face, (k + 2) % 3]
        if code < 0:
            return 0.0, 0.0
        face = code // 3
        k = code % 3
        if face == first:
            break
    if low == 0.0 or high == total:
        return 0.0, 0.0
    return low, high


@kernel
def trace(
    mesh,
    crease,
    turn,
    face,
    x,
    y,
    dx,
    dy,
    only,
    run,
    spacing,
    count,
    node_face,
    node_xy,
    node_out,
    node_in,
    through,
):
    """Follow the straightest geodesic from (x, y) and set a node every `spacing`, at most `count`.

    Straight over edges, equal angles on both sides through a vertex (Polthier and Schmies, Straightest geodesics on
    polyhedral surfaces, 1998). A start on a vertex names the opposite edge in `only`, the first to be crossed; -1
    elsewhere. `run` is the length of fibre from the last node to the start, 0 where the start is a node; the start is
    not written. node_face (count,), node_xy, node_out, node_in (count, 2)
    get each node's face and place, and the directions in which the fibre leaves and reaches it, in that face's frame;
    through (count,) whether a vertex lies on the edge that reaches it.

    Where it first crosses an edge marked in crease (m, 3), it turns by `turn`, rad, counter-clockwise from the straight
    way on; an empty crease (0, 3) for a fibre that does not turn.

    Returns (code, nodes set, length followed, turned): LEFT_SURFACE where the surface ends first, TURNED_BACK where the
    turn leads back over the crease; `turned` the number of the edge with the turn on it, from 0, TURNED_AT_NODE or
    NOT_TURNED.
    """
    n = 0
    turned = NOT_TURNED
    pending = len(crease) > 0
    # where the current straight piece began, seen in the current frame, and how far along the fibre that is
    sx = x
    sy = y
    begun = run
    done = run
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
            return WALKED, n, done, turned
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
            # the way to the vertex is longer than to the edge that was met: a node may lie on what is left of it
            while n < count and (n + 1) * spacing < done - 1e-12 * spacing:
                at = (n + 1) * spacing - begun
                node_face[n] = face
                node_xy[n, 0] = sx + at * dx
                node_xy[n, 1] = sy + at * dy
                node_out[n, 0] = dx
                node_out[n, 1] = dy
                node_in[n, 0] = dx
                node_in[n, 1] = dy
                n += 1
            if n == count:
                return WALKED, n, done, turned
            begun = done
            if n < count and done > n * spacing + 1e-9 * spacing:
                through[n] = True
            total = mesh.vertex_angle[mesh.vertex[face, caught]]
            if total <= 0.0:
                return LEFT_SURFACE, n, done, turned
            way = 0.5 * total
            over = False
            if pending:
                low, high = crease_gap(mesh, crease, face, caught, -dx, -dy)
                over = low < high
                if over:
                    way += turn
                    if not low < way < high:
                        return TURNED_BACK, n, done, turned
            face, k, dx, dy = turn_about_vertex(mesh, face, caught, -dx, -dy, way)
            if face < 0:
                return LEFT_SURFACE, n, done, turned
            x, y = corner_place(mesh, face, k)
            sx = x
            sy = y
            # the line may run along a side of this face: only the far edge can be its exit
            only = (k + 1) % 3
            entered = -1
        else:
            code = mesh.neighbour[face, exit_edge]
            if code < 0:
                return LEFT_SURFACE, n, done, turned
            c = mesh.crossing[face, 4 * exit_edge]
            s = mesh.crossing[face, 4 * exit_edge + 1]
            tx = mesh.crossing[face, 4 * exit_edge + 2]
            ty = mesh.crossing[face, 4 * exit_edge + 3]
            x, y = c * x - s * y + tx, s * x + c * y + ty
            sx, sy = c * sx - s * sy + tx, s * sx + c * sy + ty
            dx, dy = c * dx - s * dy, s * dx + c * dy
            over = pending and crease[face, exit_edge]
            face = code // 3
            entered = code % 3
            if over:
                dx, dy = math.cos(turn) * dx - math.sin(turn) * dy, math.sin(turn) * dx + math.cos(turn) * dy
                if not mesh.line[face, 3 * entered] * dx + mesh.line[face, 3 * entered + 1] * dy > 0.0:
                    return TURNED_BACK, n, done, turned
                sx = x
                sy = y
                begun = done
        if over:
            pending = False
            turned = n
            if n < count and abs((n + 1) * spacing - done) <= 1e-9 * spacing:
                # a node on the crease is reached in one direction and left in another
                turned = TURNED_AT_NODE
                node_face[n] = face
                node_xy[n, 0] = x
                node_xy[n, 1] = y
                node_out[n, 0] = dx
                node_out[n, 1] = dy
                node_in[n, 0] = math.cos(turn) * dx + math.sin(turn) * dy
                node_in[n, 1] = math.cos(turn) * dy - math.sin(turn) * dx
                n += 1
    return LEFT_SURFACE, n, done, turned
