"""Exact distances from a point to all of a few faces, by windows: bundles of straight paths over one edge.

A window is a piece of an edge and the image, in the plane of the face behind it, of the point its paths come straight
from: the source itself or a vertex where they bend. From face to face a window is unfolded on and cut where its paths
part at a vertex; it is dropped where another way is shorter for all its paths. Nothing is rounded or merged, so a
distance is that of one straight line in the plane, and its slope the line's direction.

References
----------
J. Chen, Y. Han, Shortest paths on a polyhedron, 1990; S.-Q. Xin, G.-J. Wang, Improving Chen and Han's algorithm on the
discrete geodesic problem, ACM Trans. Graphics 28, 2009 (the queue, and the test by distances to vertices).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.cache import kernel

# A corner is in sight of a window, with the distance that goes with it, though this far to the side of it, rad.
GLANCE = 1e-12
# Paths bend at a vertex within this of the sector behind it, rad: round-off, and a path that does is one all the same.
WIDER = 1e-7
# A source this near to a corner, in edges, is that vertex.
SNAP = 1e-12
# `way[v, BEFORE]` of a vertex that is the source.
AT_SOURCE = -2

# Columns of `Windows.real`.
X, Y, LOW, HIGH, PASSED, C, S = range(7)
# Columns of `Windows.whole`.
HALF, BEND, BASE, NEXT = range(4)
# Columns of `Windows.spot`.
DISTANCE, LEAVE_X, LEAVE_Y, ARRIVE_X, ARRIVE_Y = range(5)
# Columns of `Windows.way`.
BEFORE, FIRST, INTO = range(3)
# Entries of `Windows.counts`.
N_WINDOWS, N_QUEUED, N_ROOM = range(3)


class Faces(NamedTuple):
    """Faces of a surface, numbered among themselves, and so their vertices."""

    plane: NDArray[np.float64]
    """(n, 24) as in `Unfolding`, whose numbers of faces do not count here."""
    across: NDArray[np.int64]
    """(n, 3) 3 g + l: edge l of face g lies on the other side; -1 where the faces end."""
    vertex: NDArray[np.int64]
    """(n, 3) corners."""
    bends: NDArray[np.bool_]
    """(k,) whether a shortest path may bend at each vertex."""
    angle: NDArray[np.float64]
    """(k,) sum of the face angles at each vertex, rad; 0 on a border."""


class Windows(NamedTuple):
    """All windows from one source, and the vertices they found."""

    real: NDArray[np.float64]
    """(w, 7) image of the point the paths come straight from (x, y), in the frame of the face entered; piece of the
    edge entered over, from its tail 0 to its head 1; distance from the source to that point, mm; turn (c, s) from the
    frame where the straight run begins."""
    whole: NDArray[np.int64]
    """(w, 4) half-edge 3 f + k entered over; vertex the paths come straight from, -1 the source; face where that run
    begins; the next window over the same half-edge, -1 after the last."""
    first: NDArray[np.int64]
    """(3 n,) the first window over each half-edge."""
    sight: NDArray[np.float64]
    """(3 n, 2) of the windows over each half-edge that hold the corner opposite the one nearest to it: how near, mm,
    and where the path to it enters."""
    spot: NDArray[np.float64]
    """(k, 5) distance of each vertex, mm; direction in which the last straight run to it leaves; and arrives."""
    way: NDArray[np.int64]
    """(k, 3) the vertex where that run begins, -1 the source; the face in whose frame it leaves; the corner 3 f + k at
    which it arrives, in the frame of f."""
    key: NDArray[np.float64]
    """(r,) heap: the least length of a path through a window, or to a vertex where paths bend, mm."""
    item: NDArray[np.int64]
    """(r,) that window, or -1 - v for the vertex."""
    counts: NDArray[np.int64]
    """(3,) windows; entries of the heap; whether there was room for all."""


@kernel
def spread(on, out, face, x, y, reach, slack):
    """Find the windows of all shortest paths from (x, y) in `face` that are no longer than `reach`.

    Parameters
    ----------
    on : Faces
    out : Windows
        Emptied: `first` of -1, `sight` and distances infinite, all else zero.
    slack : float
        Paths that differ by less are held to be equally long, mm.

    Returns
    -------
    bool
        False if there was no room for all.
    """
    out.counts[N_ROOM] = 1
    at_vertex = -1
    for k in range(3):
        cx, cy = corner_of(on.plane, face, k)
        dx = cx - x
        dy = cy - y
        away = math.hypot(dx, dy)
        if away <= SNAP * on.plane[face, 10]:
            at_vertex = k
        if away > 0.0:
            dx /= away
            dy /= away
        _reached(on, out, face, k, away, -1, face, dx, dy, dx, dy)
    if at_vertex >= 0:
        out.way[on.vertex[face, at_vertex], BEFORE] = AT_SOURCE
        out.counts[N_QUEUED] = 0
        _about(on, out, face, at_vertex, reach, slack)
    else:
        for k in range(3):
            _over(on, out, face, k, x, y, 0.0, 1.0, 0.0, -1, face, 1.0, 0.0, 0, reach, slack)
    while out.counts[N_QUEUED] > 0 and out.counts[N_ROOM] > 0:
        key, w = _popped(out)
        if w >= 0:
            _onward(on, out, w, reach, slack)
        elif key <= out.spot[-1 - w, DISTANCE]:
            # else it has been reached by a shorter way since
            _round(on, out, -1 - w, reach, slack)
    return out.counts[N_ROOM] > 0


@kernel
def corner_of(plane, f, k):
    """Corner k of a face in its frame."""
    return plane[f, 8 * k + 2], plane[f, 8 * k + 3]


@kernel
def _cut(sx, sy, dx, dy, px, py, qx, qy):
    """Where the line from S along d cuts the edge p-q: 0 at p, 1 at q, no farther."""
    rate = dx * (qy - py) - dy * (qx - px)
    if rate == 0.0:
        return 0.5
    t = ((px - sx) * dy - (py - sy) * dx) / rate
    return min(max(t, 0.0), 1.0)


@kernel
def _push(out, key, item):
    at = out.counts[N_QUEUED]
    if at == len(out.key):
        out.counts[N_ROOM] = 0
        return
    out.counts[N_QUEUED] = at + 1
    while at > 0:
        above = (at - 1) // 2
        if out.key[above] <= key:
            break
        out.key[at] = out.key[above]
        out.item[at] = out.item[above]
        at = above
    out.key[at] = key
    out.item[at] = item


@kernel
def _popped(out):
    key = out.key[0]
    item = out.item[0]
    n = out.counts[N_QUEUED] - 1
    out.counts[N_QUEUED] = n
    last = out.key[n]
    moved = out.item[n]
    at = 0
    while True:
        below = 2 * at + 1
        if below >= n:
            break
        if below + 1 < n and out.key[below + 1] < out.key[below]:
            below += 1
        if out.key[below] >= last:
            break
        out.key[at] = out.key[below]
        out.item[at] = out.item[below]
        at = below
    out.key[at] = last
    out.item[at] = moved
    return key, item


@kernel
def _reached(on, out, f, k, total, before, base, lx, ly, ax, ay):
    """Note a way to corner k of a face if it is the shortest so far."""
    v = on.vertex[f, k]
    if total < out.spot[v, DISTANCE]:
        out.spot[v, DISTANCE] = total
        out.spot[v, LEAVE_X] = lx
        out.spot[v, LEAVE_Y] = ly
        out.spot[v, ARRIVE_X] = ax
        out.spot[v, ARRIVE_Y] = ay
        out.way[v, BEFORE] = before
        out.way[v, FIRST] = base
        out.way[v, INTO] = 3 * f + k
        if on.bends[v]:
            _push(out, total, -1 - v)


@kernel
def _onward(on, out, w, reach, slack):
    """Unfold a window through the face it enters, to one or both of the edges beyond."""
    half = out.whole[w, HALF]
    bend = out.whole[w, BEND]
    base = out.whole[w, BASE]
    passed = out.real[w, PASSED]
    if bend >= 0 and passed > out.spot[bend, DISTANCE] + slack:
        return
    sx = out.real[w, X]
    sy = out.real[w, Y]
    low = out.real[w, LOW]
    high = out.real[w, HIGH]
    c = out.real[w, C]
    s = out.real[w, S]
    f = half // 3
    k = half - 3 * f
    px, py = corner_of(on.plane, f, k)
    qx, qy = corner_of(on.plane, f, (k + 1) % 3)
    vx, vy = corner_of(on.plane, f, (k + 2) % 3)
    # rays from the image through the ends of the piece, and to the corner
    lx = px + low * (qx - px) - sx
    ly = py + low * (qy - py) - sy
    rx = px + high * (qx - px) - sx
    ry = py + high * (qy - py) - sy
    ax = vx - sx
    ay = vy - sy
    size = math.hypot(ax, ay)
    beyond_left = lx * ay - ly * ax
    beyond_right = ry * ax - rx * ay
    left = beyond_left <= 0.0
    right = beyond_right <= 0.0
    held = left and right
    if max(beyond_left / math.hypot(lx, ly), beyond_right / math.hypot(rx, ry)) <= GLANCE * size:
        total = passed + size
        ux = ax / size
        uy = ay / size
        _reached(on, out, f, (k + 2) % 3, total, bend, base, c * ux + s * uy, c * uy - s * ux, ux, uy)
        if held:
            at = _cut(sx, sy, ax, ay, px, py, qx, qy)
            if total > out.sight[half, 0] + slack:
                # one angle, one split: beyond the nearer window's path to the corner there is nothing to win
                if at < out.sight[half, 1]:
                    right = False
                else:
                    left = False
            if total < out.sight[half, 0]:
                out.sight[half, 0] = total
                out.sight[half, 1] = at
    if right:
        a = 0.0 if high == 1.0 else _cut(sx, sy, rx, ry, qx, qy, vx, vy)
        b = 1.0 if held else _cut(sx, sy, lx, ly, qx, qy, vx, vy)
        _over(on, out, f, (k + 1) % 3, sx, sy, a, b, passed, bend, base, c, s, 1, reach, slack)
    if left:
        a = 0.0 if held else _cut(sx, sy, rx, ry, vx, vy, px, py)
        b = 1.0 if low == 0.0 else _cut(sx, sy, lx, ly, vx, vy, px, py)
        _over(on, out, f, (k + 2) % 3, sx, sy, a, b, passed, bend, base, c, s, 2, reach, slack)


@kernel
def _over(on, out, f, e, sx, sy, low, high, passed, bend, base, c, s, turned, reach, slack):
    """Keep the window that leaves a face over a piece of its edge e, unless all its paths have a shorter way.

    `turned` is 1 where it came in over the edge before e, 2 over the edge after, 0 where it begins in the face.
    """
    code = on.across[f, e]
    if code < 0 or not high - low > 1e-15:
        return
    px, py = corner_of(on.plane, f, e)
    qx, qy = corner_of(on.plane, f, (e + 1) % 3)
    ex = qx - px
    ey = qy - py
    edge2 = ex * ex + ey * ey
    # nearest point of the piece
    t = min(max(((sx - px) * ex + (sy - py) * ey) / edge2, low), high)
    key = passed + math.hypot(px + t * ex - sx, py + t * ey - sy)
    if key > reach:
        return
    if turned > 0:
        edge = math.sqrt(edge2)
        to_low = passed + math.hypot(px + low * ex - sx, py + low * ey - sy)
        to_high = passed + math.hypot(px + high * ex - sx, py + high * ey - sy)
        # a way by an end of the edge that is shorter to the far end of the piece is so to all of it, and one by the
        # third corner if it is to the end on the side where the window came in
        if out.spot[on.vertex[f, e], DISTANCE] + high * edge < to_high - slack:
            return
        if out.spot[on.vertex[f, (e + 1) % 3], DISTANCE] + (1.0 - low) * edge < to_low - slack:
            return
        at, known = (low, to_low) if turned == 1 else (high, to_high)
        ox, oy = corner_of(on.plane, f, (e + 2) % 3)
        by_third = out.spot[on.vertex[f, (e + 2) % 3], DISTANCE] + math.hypot(px + at * ex - ox, py + at * ey - oy)
        if by_third < known - slack:
            return
    n = out.counts[N_WINDOWS]
    if n == len(out.real):
        out.counts[N_ROOM] = 0
        return
    out.counts[N_WINDOWS] = n + 1
    mc = on.plane[f, 8 * e + 4]
    ms = on.plane[f, 8 * e + 5]
    out.real[n, X] = mc * sx - ms * sy + on.plane[f, 8 * e + 6]
    out.real[n, Y] = ms * sx + mc * sy + on.plane[f, 8 * e + 7]
    out.real[n, LOW] = 1.0 - high
    out.real[n, HIGH] = 1.0 - low
    out.real[n, PASSED] = passed
    out.real[n, C] = mc * c - ms * s
    out.real[n, S] = ms * c + mc * s
    out.whole[n, HALF] = code
    out.whole[n, BEND] = bend
    out.whole[n, BASE] = base
    out.whole[n, NEXT] = out.first[code]
    out.first[code] = n
    _push(out, key, n)


@kernel
def _from_corner(on, out, f, k, low, high, passed, bend, reach, slack):
    """The window from corner k of a face over a piece of the edge opposite, and ways along the sides to its ends."""
    sx, sy = corner_of(on.plane, f, k)
    for end in (1, 2):
        if (end == 1 and low == 0.0) or (end == 2 and high == 1.0):
            cx, cy = corner_of(on.plane, f, (k + end) % 3)
            along = math.hypot(cx - sx, cy - sy)
            ux = (cx - sx) / along
            uy = (cy - sy) / along
            _reached(on, out, f, (k + end) % 3, passed + along, bend, f, ux, uy, ux, uy)
    _over(on, out, f, (k + 1) % 3, sx, sy, low, high, passed, bend, f, 1.0, 0.0, 0, reach, slack)


@kernel
def _about(on, out, face, corner, reach, slack):
    """Windows from a vertex that is the source into all faces about it, counter-clockwise; at a border, also back."""
    for clockwise in (False, True):
        f = face
        k = corner
        while True:
            if not (clockwise and f == face):
                _from_corner(on, out, f, k, 0.0, 1.0, 0.0, -1, reach, slack)
            code = on.across[f, k] if clockwise else on.across[f, (k + 2) % 3]
            if code < 0:
                break
            f = code // 3
            k = (code % 3 + 1) % 3 if clockwise else code % 3
            if f == face:
                return


@kernel
def _round(on, out, v, reach, slack):
    """Windows from a vertex where paths bend, into the sector at half a turn or more, either way, from where they came.

    Turning about the vertex counter-clockwise; where a border was met on the way, also clockwise.
    """
    start = out.way[v, INTO] // 3
    corner = out.way[v, INTO] - 3 * start
    # back to where the path came from
    bx = -out.spot[v, ARRIVE_X]
    by = -out.spot[v, ARRIVE_Y]
    least = math.pi - WIDER
    most = on.angle[v] - least if on.angle[v] > 0.0 else math.inf
    for clockwise in (False, True):
        f = start
        k = corner
        begun = False
        turned = 0.0
        while True:
            sx, sy = corner_of(on.plane, f, k)
            # the sides at the vertex: that over which the turn enters, and the other
            ux, uy = corner_of(on.plane, f, (k + 2) % 3 if clockwise else (k + 1) % 3)
            wx, wy = corner_of(on.plane, f, (k + 1) % 3 if clockwise else (k + 2) % 3)
            ux -= sx
            uy -= sy
            wx -= sx
            wy -= sy
            if begun:
                wide = math.atan2(abs(ux * wy - uy * wx), ux * wx + uy * wy)
                near = max(least - turned, 0.0)
                far = min(most - turned, wide)
                if near < far:
                    a = 0.0 if near == 0.0 else _turned_cut(ux, uy, wx, wy, wide, near)
                    b = 1.0 if far == wide else _turned_cut(ux, uy, wx, wy, wide, far)
                    if clockwise:
                        a, b = 1.0 - b, 1.0 - a
                    _from_corner(on, out, f, k, a, b, out.spot[v, DISTANCE], v, reach, slack)
                turned += wide
            else:
                turned = math.atan2(abs(bx * wy - by * wx), bx * wx + by * wy)
                begun = True
            if turned >= most:
                return
            code = on.across[f, k] if clockwise else on.across[f, (k + 2) % 3]
            if code < 0:
                break
            f = code // 3
            k = (code % 3 + 1) % 3 if clockwise else code % 3
            if f == start:
                return


@kernel
def _turned_cut(ux, uy, wx, wy, wide, turn):
    """Where the ray turned by an angle from side u of a corner towards side w cuts the edge opposite: 0 at u's end."""
    a = math.hypot(ux, uy) * math.sin(turn)
    b = math.hypot(wx, wy) * math.sin(wide - turn)
    return a / (a + b)
