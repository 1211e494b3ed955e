"""The faces around two points that a short path between them could touch."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel


@kernel
def point_triangle_distance(px, py, pz, frame, corner):
    """Distance in space from a point to a triangle given by its frame (9,) and corners (3,)."""
    rx = px - frame[0]
    ry = py - frame[1]
    rz = pz - frame[2]
    x = rx * frame[3] + ry * frame[4] + rz * frame[5]
    y = rx * frame[6] + ry * frame[7] + rz * frame[8]
    height2 = max(rx * rx + ry * ry + rz * rz - x * x - y * y, 0.0)
    # corners in the frame: (0, 0), (corner[0], 0), (corner[1], corner[2])
    inside = True
    best = math.inf
    ax = 0.0
    ay = 0.0
    for k in range(3):
        if k == 0:
            bx, by = corner[0], 0.0
        elif k == 1:
            bx, by = corner[1], corner[2]
        else:
            bx, by = 0.0, 0.0
        ex = bx - ax
        ey = by - ay
        if ex * (y - ay) - ey * (x - ax) < 0.0:
            inside = False
        t = ((x - ax) * ex + (y - ay) * ey) / (ex * ex + ey * ey)
        t = min(max(t, 0.0), 1.0)
        best = min(best, (x - ax - t * ex) ** 2 + (y - ay - t * ey) ** 2)
        ax = bx
        ay = by
    return math.sqrt(height2 if inside else height2 + best)


@kernel(makes_arrays=True)
def flood(mesh, first_face, a, b, bound):
    """Faces reached from `first_face` over edges for which |x - a| + |x - b| <= bound holds somewhere.

    A path from a to b no longer than `bound` stays on them, for distances in space bound those on the surface.
    Returns the faces, (n,) int64, in the order found.
    """
    seen = {np.int64(first_face)}
    found = [np.int64(first_face)]
    at = 0
    while at < len(found):
        face = found[at]
        at += 1
        for k in range(3):
            code = mesh.neighbour[face, k]
            if code < 0:
                continue
            other = np.int64(code // 3)
            if other in seen:
                continue
            seen.add(other)
            to_a = point_triangle_distance(a[0], a[1], a[2], mesh.frame[other], mesh.corner[other])
            to_b = point_triangle_distance(b[0], b[1], b[2], mesh.frame[other], mesh.corner[other])
            if to_a + to_b <= bound:
                found.append(other)
    out = np.empty(len(found), dtype=np.int64)
    for n in range(len(found)):
        out[n] = found[n]
    return out
