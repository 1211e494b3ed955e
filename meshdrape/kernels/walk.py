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
    code, face, x, y, dx, dy, _, _, _ = survey(plane, neighbour, None, face, x, y, dx, dy, length)
    return code, face, x, y, dx, dy


@kernel
def survey(plane, neighbour, beside, face, x, y, dx, dy, length):
    """Walk as `walk` does, and tell what there is beside the path.

    Instead of stepping from edge to edge the start itself is carried into each new frame, so round-off grows
    only by one rigid motion a crossing and the start's image is at hand for the circles of `place`. Which edge is
    next is a question of sides, answered without a division.

    Parameters
    ----------
    beside : (m, 6) or None
        Of `Detours`; None where nobody asks.

    Returns
    -------
    (code, face, x, y, dx, dy, near, doubt, turn)
        `near` is how far the line runs past the nearest corner of the faces it crosses, mm; `doubt` and `turn` are
        the sums of `beside` over those corners and over the edges crossed.
    """
    # how far each corner lies to the left of the line
    s0 = dx * (plane[face, 3] - y) - dy * (plane[face, 2] - x)
    s1 = dx * (plane[face, 11] - y) - dy * (plane[face, 10] - x)
    s2 = dx * (plane[face, 19] - y) - dy * (plane[face, 18] - x)
    near = min(abs(s0), min(abs(s1), abs(s2)))
    doubt = 0.0
    turn = 0.0
    if beside is not None:
        doubt = beside[face, 0] + beside[face, 2] + beside[face, 4]
    # out over the edge whose tail lies to the right and whose head to the left
    if s0 <= 0.0 and s1 > 0.0:
        exit_edge = 0
    elif s1 <= 0.0 and s2 > 0.0:
        exit_edge = 1
    elif s2 <= 0.0 and s0 > 0.0:
        exit_edge = 2
    else:
        # the line misses the face by round-off, or begins at a corner and leaves it
        exit_edge = max(_beyond(plane, face, -1, x + length * dx, y + length * dy), 0)
    entered = -1
    for _ in range(MAX_CROSSINGS):
        at = 8 * exit_edge
        tx = x + length * dx
        ty = y + length * dy
        if plane[face, at] * (tx - plane[face, at + 2]) + plane[face, at + 1] * (ty - plane[face, at + 3]) >= 0.0:
            # along an edge it is round-off that chose the side; what counts is whether the end lies in the face
            exit_edge = _beyond(plane, face, entered, tx, ty)
            if exit_edge < 0:
                return WALKED, face, x, y, dx, dy, near, doubt, turn
            at = 8 * exit_edge
        code = neighbour[face, exit_edge]
        if code < 0:
            return LEFT_SURFACE, face, x, y, dx, dy, near, doubt, turn
        c = plane[face, at + 4]
        s = plane[face, at + 5]
        x, y = c * x - s * y + plane[face, at + 6], s * x + c * y + plane[face, at + 7]
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code - 3 * face
        if beside is not None:
            doubt += beside[face, 2 * entered]
            turn += beside[face, 2 * entered + 1]
        # in over one edge, out over the next where the far corner lies to the left, over the one before where not
        before = entered - 1 if entered > 0 else 2
        left = dx * (plane[face, 8 * before + 3] - y) - dy * (plane[face, 8 * before + 2] - x)
        near = min(near, abs(left))
        exit_edge = 3 - entered - before if left > 0.0 else before
    return LEFT_SURFACE, face, x, y, dx, dy, near, doubt, turn


@kernel
def _beyond(plane, face, entered, x, y):
    """The edge, other than the one entered over, beyond which a place lies farthest; -1 where it lies in the face."""
    edge = -1
    worst = 0.0
    for k in range(3):
        at = 8 * k
        height = plane[face, at] * (x - plane[face, at + 2]) + plane[face, at + 1] * (y - plane[face, at + 3])
        if k != entered and height < worst:
            worst = height
            edge = k
    return edge


@kernel
def holds(plane, face, x, y):
    """Whether a place (x, y) of a face's frame lies in the face."""
    # edge 0 lies on the x axis, edge 2 ends in the origin; without branches, at which numba would count references
    above_1 = plane[face, 8] * (x - plane[face, 10]) + plane[face, 9] * y
    above_2 = plane[face, 16] * x + plane[face, 17] * y
    return min(y, min(above_1, above_2)) >= 0.0


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
            c = plane[source, 8 * k + 4]
            s = plane[source, 8 * k + 5]
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
