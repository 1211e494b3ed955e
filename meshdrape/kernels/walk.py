"""Straight lines across unfolded triangles."""

import math

from numba import njit

WALKED = 0
LEFT_SURFACE = 1

# A shortest path enters a face at most once, so only a broken mesh reaches this.
MAX_CROSSINGS = 100_000


@njit(cache=True, error_model="numpy")
def walk(mesh, face, x, y, dx, dy, length):
    """Walk straight on for `length` from (x, y) in `face`, in the unit direction (dx, dy).

    Instead of stepping from edge to edge the start itself is carried into each new frame, so round-off grows
    only by one rigid motion a crossing and the start's image is at hand for the circles of `place`.

    Returns
    -------
    (code, face, x, y, dx, dy)
        Face where the path ends; image of the start and the direction in its frame: the end is
        (x + length dx, y + length dy).
    """
    entered = -1
    line = mesh.line
    crossing = mesh.crossing
    for _ in range(MAX_CROSSINGS):
        exit_at = math.inf
        exit_edge = -1
        for k in range(3):
            if k == entered:
                continue
            rate = line[face, 3 * k] * dx + line[face, 3 * k + 1] * dy
            if rate < 0.0:
                height = line[face, 3 * k] * x + line[face, 3 * k + 1] * y - line[face, 3 * k + 2]
                at = -height / rate
                if at < exit_at:
                    exit_at = at
                    exit_edge = k
        if length <= exit_at:
            return WALKED, face, x, y, dx, dy
        code = mesh.neighbour[face, exit_edge]
        if code < 0:
            return LEFT_SURFACE, face, x, y, dx, dy
        c = crossing[face, 4 * exit_edge]
        s = crossing[face, 4 * exit_edge + 1]
        x, y = c * x - s * y + crossing[face, 4 * exit_edge + 2], s * x + c * y + crossing[face, 4 * exit_edge + 3]
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code - 3 * face
    return LEFT_SURFACE, face, x, y, dx, dy


@njit(cache=True, error_model="numpy")
def turn_into(mesh, source, dx, dy, target):
    """Direction (dx, dy) of face `source` in the frame of face `target`, which holds the same point.

    Neighbours are unfolded; across a vertex, where unfolding depends on the way round, the direction in space is
    projected.
    """
    if source == target:
        return dx, dy
    for k in range(3):
        code = mesh.neighbour[source, k]
        if code >= 0 and code // 3 == target:
            c = mesh.crossing[source, 4 * k]
            s = mesh.crossing[source, 4 * k + 1]
            return c * dx - s * dy, s * dx + c * dy
    a = mesh.frame[source]
    b = mesh.frame[target]
    vx = dx * a[3] + dy * a[6]
    vy = dx * a[4] + dy * a[7]
    vz = dx * a[5] + dy * a[8]
    ex = vx * b[3] + vy * b[4] + vz * b[5]
    ey = vx * b[6] + vy * b[7] + vz * b[8]
    size = math.sqrt(ex * ex + ey * ey)
    return ex / size, ey / size


@njit(cache=True, error_model="numpy")
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
