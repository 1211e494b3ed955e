"""Straight lines across unfolded triangles."""

import math

from meshdrape.kernels.cache import kernel

WALKED = 0
LEFT_SURFACE = 1

# A shortest path enters a face at most once, so only a broken mesh reaches this.
MAX_CROSSINGS = 100_000


@kernel
def walk(plane, neighbour, face, x, y, dx, dy, length):
    """Walk straight on for `length` from (x, y) in `face`, in the unit direction (dx, dy).

    Instead of stepping from edge to edge the start itself is carried into each new frame, so round-off grows
    only by one rigid motion a crossing and the start's image is at hand for the circles of `place`. Which edge is
    next is a question of sides, answered without a division.

    Parameters
    ----------
    plane, neighbour
        Of `Unfolding`; handed over singly, for a call with all its arrays costs more than the walk.

    Returns
    -------
    (code, face, x, y, dx, dy)
        Face where the path ends; image of the start and the direction in its frame: the end is
        (x + length dx, y + length dy).
    """
    # first face: which edges the end lies beyond
    tx = x + length * dx
    ty = y + length * dy
    exit_edge = -1
    worst = 0.0
    second = -1
    for k in range(3):
        height = plane[face, 3 * k] * tx + plane[face, 3 * k + 1] * ty - plane[face, 3 * k + 2]
        if height < 0.0:
            if exit_edge >= 0:
                second = exit_edge if height < worst else k
            if height < worst:
                worst = height
                exit_edge = k
    if exit_edge < 0:
        return WALKED, face, x, y, dx, dy
    if second >= 0:
        # beyond two: the corner between them decides, by the side on which the line passes it
        v = second if (exit_edge + 1) % 3 == second else exit_edge
        cx = 0.0
        cy = 0.0
        if v == 1:
            cx = plane[face, 21]
        elif v == 2:
            cx = plane[face, 22]
            cy = plane[face, 23]
        exit_edge = (v + 2) % 3 if dx * (cy - y) - dy * (cx - x) > 0.0 else v
    for _ in range(MAX_CROSSINGS):
        code = neighbour[face, exit_edge]
        if code < 0:
            return LEFT_SURFACE, face, x, y, dx, dy
        at = 9 + 4 * exit_edge
        c = plane[face, at]
        s = plane[face, at + 1]
        x, y = c * x - s * y + plane[face, at + 2], s * x + c * y + plane[face, at + 3]
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code - 3 * face
        # in over one edge, out over the next where the far corner lies to the left, over the one before where not
        cx = 0.0
        cy = 0.0
        if entered == 0:
            cx = plane[face, 22]
            cy = plane[face, 23]
        elif entered == 2:
            cx = plane[face, 21]
        exit_edge = entered + 1 if dx * (cy - y) - dy * (cx - x) > 0.0 else entered + 2
        if exit_edge > 2:
            exit_edge -= 3
        at = 3 * exit_edge
        tx = x + length * dx
        ty = y + length * dy
        if plane[face, at] * tx + plane[face, at + 1] * ty - plane[face, at + 2] >= 0.0:
            # along an edge it is round-off that chose the side; what counts is whether the end lies in the face
            other = 3 - entered - exit_edge
            at = 3 * other
            if plane[face, at] * tx + plane[face, at + 1] * ty - plane[face, at + 2] >= 0.0:
                return WALKED, face, x, y, dx, dy
            exit_edge = other
    return LEFT_SURFACE, face, x, y, dx, dy


@kernel
def turn_into(plane, neighbour, frame, source, dx, dy, target):
    """Direction (dx, dy) of face `source` in the frame of face `target`, which holds the same point.

    Neighbours are unfolded; across a vertex, where unfolding depends on the way round, the direction in space is
    projected.
    """
    if source == target:
        return dx, dy
    for k in range(3):
        code = neighbour[source, k]
        if code >= 0 and code // 3 == target:
            c = plane[source, 9 + 4 * k]
            s = plane[source, 10 + 4 * k]
            return c * dx - s * dy, s * dx + c * dy
    a = frame[source]
    b = frame[target]
    vx = dx * a[3] + dy * a[6]
    vy = dx * a[4] + dy * a[7]
    vz = dx * a[5] + dy * a[8]
    ex = vx * b[3] + vy * b[4] + vz * b[5]
    ey = vx * b[6] + vy * b[7] + vz * b[8]
    size = math.sqrt(ex * ex + ey * ey)
    return ex / size, ey / size


@kernel
def off_mould(mesh, face, x, y, slack):
    """Whether (x, y) in `face` lies on the extension, farther than `slack` from the mould itself."""
    rim = mesh.rim[face]
    if rim < 0:
        return False
    for k in range(3):
        if rim & (1 << k):
            height = mesh.line[face, 3 * k] * x + mesh.line[face, 3 * k + 1] * y - mesh.line[face, 3 * k + 2]
            if height <= slack:
                return False
        if rim & (8 << k):
            cx = 0.0
            cy = 0.0
            if k == 1:
                cx = mesh.corner[face, 0]
            elif k == 2:
                cx = mesh.corner[face, 1]
                cy = mesh.corner[face, 2]
            if (x - cx) ** 2 + (y - cy) ** 2 <= slack * slack:
                return False
    return True
