"""Shortest ways from a source to places in the faces about it, read off the windows that were found from it."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.windows import (
    ARRIVE_X,
    ARRIVE_Y,
    AT_SOURCE,
    BASE,
    BEFORE,
    BEND,
    DISTANCE,
    FIRST,
    HIGH,
    INTO,
    LEAVE_X,
    LEAVE_Y,
    LOW,
    NEXT,
    PASSED,
    C,
    S,
    X,
    Y,
    corner_of,
)


@kernel
def nearest_way(on, out, source, sx, sy, face, x, y):
    """The shortest of all ways from the source (sx, sy), in its face, to (x, y) in `face`.

    Each is the length of a path there is: a place that no window quite holds, for round-off, is reached by the end of
    one.

    Returns
    -------
    (length, arrive_x, arrive_y, bend, leave_x, leave_y, base)
        In mm; direction in which the path arrives, in the frame of `face`; the last vertex at which it bends, -1 where
        it is straight; direction in which it leaves the source, in the frame of the face `base`.
    """
    best = math.inf
    ax = 0.0
    ay = 0.0
    lx = 0.0
    ly = 0.0
    bend = -1
    base = source
    if face == source:
        best = math.hypot(x - sx, y - sy)
        if best > 0.0:
            ax = (x - sx) / best
            ay = (y - sy) / best
            lx = ax
            ly = ay
    for k in range(3):
        w = out.first[3 * face + k]
        px, py = corner_of(on.plane, face, k)
        qx, qy = corner_of(on.plane, face, (k + 1) % 3)
        while w >= 0:
            ox = out.real[w, X]
            oy = out.real[w, Y]
            length = out.real[w, PASSED]
            # beside the rays through the piece's ends: round the nearer end
            at = -1.0
            hx = px + out.real[w, LOW] * (qx - px)
            hy = py + out.real[w, LOW] * (qy - py)
            if (hx - ox) * (y - oy) - (hy - oy) * (x - ox) > 0.0:
                at = out.real[w, LOW]
            hx = px + out.real[w, HIGH] * (qx - px)
            hy = py + out.real[w, HIGH] * (qy - py)
            if (hx - ox) * (y - oy) - (hy - oy) * (x - ox) < 0.0:
                at = out.real[w, HIGH]
            hx = x
            hy = y
            if at >= 0.0:
                hx = px + at * (qx - px)
                hy = py + at * (qy - py)
                length += math.hypot(x - hx, y - hy)
            size = math.hypot(hx - ox, hy - oy)
            length += size
            if length < best and size > 0.0:
                best = length
                bend = out.whole[w, BEND]
                base = out.whole[w, BASE]
                ax = (hx - ox) / size
                ay = (hy - oy) / size
                lx = out.real[w, C] * ax + out.real[w, S] * ay
                ly = out.real[w, C] * ay - out.real[w, S] * ax
                size = math.hypot(x - hx, y - hy)
                if size > 0.0:
                    ax = (x - hx) / size
                    ay = (y - hy) / size
            w = out.whole[w, NEXT]
    for k in range(3):
        v = on.vertex[face, k]
        cx, cy = corner_of(on.plane, face, k)
        size = math.hypot(x - cx, y - cy)
        if out.spot[v, DISTANCE] + size < best:
            best = out.spot[v, DISTANCE] + size
            bend = v
            if size > 0.0:
                ax = (x - cx) / size
                ay = (y - cy) / size
            elif out.way[v, INTO] == 3 * face + k:
                ax = out.spot[v, ARRIVE_X]
                ay = out.spot[v, ARRIVE_Y]
            if out.way[v, BEFORE] == AT_SOURCE:
                bend = -1
                base = face
                lx = ax
                ly = ay
    last = bend
    while bend >= 0:
        lx = out.spot[bend, LEAVE_X]
        ly = out.spot[bend, LEAVE_Y]
        base = out.way[bend, FIRST]
        bend = out.way[bend, BEFORE]
    return best, ax, ay, last, lx, ly, base


@kernel(makes_arrays=True)
def nearest_ways(on, out, source, sx, sy, face, xy):
    """Lengths of the shortest ways to many places, (n,); infinite where the face is -1."""
    lengths = np.full(len(face), math.inf)
    for n in range(len(face)):
        if face[n] >= 0:
            lengths[n] = nearest_way(on, out, source, sx, sy, face[n], xy[n, 0], xy[n, 1])[0]
    return lengths
