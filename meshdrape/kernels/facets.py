"""What each triangle of a mesh is by itself and beside its neighbours, in one pass over all."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel


@kernel(makes_arrays=True)
def pair_edges(faces, neighbour):
    """Find the half-edge across each edge: fills `neighbour` (m, 3) with 3 g + l, -1 at a border.

    Edges are looked up by their ends in a hash table: a fan of many triangles takes no longer than as many apart.

    Returns
    -------
    bool
        Whether no edge is run through twice in one sense. Else the mesh is not manifold or not oriented alike, and
        `neighbour` says nothing.
    """
    size = 1024
    while size < 4 * len(faces):
        size *= 2
    # the half-edge first met of each edge
    held = np.full(size, -1, dtype=np.int32)
    neighbour[:] = -1
    for f in range(len(faces)):
        for k in range(3):
            tail = faces[f, k]
            head = faces[f, (k + 1) % 3]
            # bits from the middle of a product: they depend on all bits of both ends
            at = (((min(tail, head) * 0x27D4EB2F165667C5 + max(tail, head)) * 0x1E3779B97F4A7C15) >> 31) & (size - 1)
            while True:
                h = held[at]
                if h < 0:
                    held[at] = 3 * f + k
                    break
                g = h // 3
                m = h - 3 * g
                if faces[g, m] == tail and faces[g, (m + 1) % 3] == head:
                    return False
                if faces[g, m] == head and faces[g, (m + 1) % 3] == tail:
                    if neighbour[g, m] >= 0:
                        return False
                    neighbour[g, m] = 3 * f + k
                    neighbour[f, k] = h
                    break
                at = (at + 1) & (size - 1)
    return True


@kernel(makes_arrays=True)
def measure_facets(vertices, faces, normal, area, angle):
    """Fill `normal` (m, 3), unit; `area` (m,), mm2; and `angle` (m, 3), rad, at each corner."""
    u = np.empty(3)
    v = np.empty(3)
    for f in range(len(faces)):
        for k in (2, 1, 0):
            a = faces[f, k]
            b = faces[f, (k + 1) % 3]
            c = faces[f, (k + 2) % 3]
            for axis in range(3):
                u[axis] = vertices[b, axis] - vertices[a, axis]
                v[axis] = vertices[c, axis] - vertices[a, axis]
            nx = u[1] * v[2] - u[2] * v[1]
            ny = u[2] * v[0] - u[0] * v[2]
            nz = u[0] * v[1] - u[1] * v[0]
            size = math.sqrt(nx * nx + ny * ny + nz * nz)
            angle[f, k] = math.atan2(size, u[0] * v[0] + u[2] * v[2] + u[1] * v[1])
        # of corner 0, which came last
        area[f] = 0.5 * size
        normal[f, 0] = nx / size
        normal[f, 1] = ny / size
        normal[f, 2] = nz / size


@kernel
def chords(normal, neighbour, first, chord):
    """Distance between the tips of the unit normals on both sides of each edge of the faces from `first` on.

    Fills `chord` (m - first, 3): twice the sine of half the angle between them, 0 at a border.
    """
    for f in range(first, len(neighbour)):
        for k in range(3):
            g = neighbour[f, k] // 3
            away = 0.0
            if neighbour[f, k] >= 0:
                for axis in range(3):
                    away += (normal[g, axis] - normal[f, axis]) ** 2
            chord[f - first, k] = math.sqrt(away)


@kernel
def star_radii(vertices, faces, area, radius):
    """Fill `radius` (n,): distance from each vertex to the nearest line of the edges round it, mm."""
    radius[:] = math.inf
    for f in range(len(faces)):
        for k in range(3):
            b = faces[f, (k + 1) % 3]
            c = faces[f, (k + 2) % 3]
            edge = 0.0
            for axis in range(3):
                edge += (vertices[c, axis] - vertices[b, axis]) ** 2
            a = faces[f, k]
            radius[a] = min(radius[a], 2.0 * area[f] / math.sqrt(edge))


@kernel(makes_arrays=True)
def may_be_nearest(vertices, faces, point):
    """Faces one of which holds the point of the mesh nearest to a given one, (n,): few of them, in their order.

    A face farther off than another's farthest point cannot be it; each is known by a ball about its centroid.
    """
    m = len(faces)
    away = np.empty(m)
    radius = np.empty(m)
    least = math.inf
    for f in range(m):
        gap2 = 0.0
        radius2 = 0.0
        for k in range(3):
            corner2 = 0.0
            for axis in range(3):
                centre = (vertices[faces[f, 0], axis] + vertices[faces[f, 1], axis] + vertices[faces[f, 2], axis]) / 3.0
                corner2 += (vertices[faces[f, k], axis] - centre) ** 2
                if k == 0:
                    gap2 += (centre - point[axis]) ** 2
            radius2 = max(radius2, corner2)
        away[f] = math.sqrt(gap2)
        radius[f] = math.sqrt(radius2)
        least = min(least, away[f] + radius[f])
    count = 0
    for f in range(m):
        count += away[f] - radius[f] <= least
    found = np.empty(count, dtype=np.int64)
    count = 0
    for f in range(m):
        if away[f] - radius[f] <= least:
            found[count] = f
            count += 1
    return found
