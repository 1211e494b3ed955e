"""From a point of the mould to the cell of the net that lies on it."""

import math

import numpy as np

from meshdrape.kernels.buckets import bucket, cube_beside
from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT
from meshdrape.kernels.emit import node_tangent
from meshdrape.kernels.sight import REACH, is_whole, lies_on_cell

MAX_STEPS = 80
# Corners on a plane turned by more than this from the point's own say nothing of its fibres.
SAME_PLANE = math.cos(math.radians(20.0))


@kernel(makes_arrays=True)
def first_nodes(mesh, net, out):
    """A node on each face, out (m, 2): the first one, else the nearest neighbouring face's; -1 where none is near."""
    n_warp, n_weft = net.status.shape
    n_faces = out.shape[0]
    out[:] = -1
    queue = np.empty(n_faces, dtype=np.int64)
    tail = 0
    for i in range(n_warp):
        for j in range(n_weft):
            f = net.face[i, j] if net.status[i, j] <= OFF_MOULD else n_faces
            if f < n_faces and out[f, 0] < 0:
                out[f, 0] = i
                out[f, 1] = j
                queue[tail] = f
                tail += 1
    # over creases only where there is no other way: a node beyond one says little of this side
    for over_creases in range(2):
        head = 0
        while head < tail:
            f = queue[head]
            head += 1
            for k in range(3):
                code = mesh.neighbour[f, k]
                if code < 0:
                    continue
                g = code // 3
                if g < n_faces and out[g, 0] < 0 and (over_creases == 1 or _one_plane(mesh, f, g)):
                    out[g, 0] = out[f, 0]
                    out[g, 1] = out[f, 1]
                    queue[tail] = g
                    tail += 1


@kernel
def _one_plane(mesh, f, g):
    """Whether two faces are turned against each other by less than the angle of a crease."""
    a = mesh.frame[f]
    b = mesh.frame[g]
    dot = 0.0
    for k in range(3):
        k1 = (k + 1) % 3
        k2 = (k + 2) % 3
        dot += (a[3 + k1] * a[6 + k2] - a[3 + k2] * a[6 + k1]) * (b[3 + k1] * b[6 + k2] - b[3 + k2] * b[6 + k1])
    return dot > SAME_PLANE


@kernel(inline="always")
def _node(mesh, net, i, j, out):
    frame = mesh.frame[net.face[i, j]]
    for k in range(3):
        out[k] = frame[k] + net.xy[i, j, 0] * frame[3 + k] + net.xy[i, j, 1] * frame[6 + k]


@kernel
def _faces_alike(mesh, net, i, j, normal):
    """Whether a corner of the cell lies on a face turned to the same side as a normal."""
    for corner in range(4):
        g = mesh.frame[net.face[i + (corner & 1), j + (corner >> 1)]]
        nx = g[4] * g[8] - g[5] * g[7]
        ny = g[5] * g[6] - g[3] * g[8]
        nz = g[3] * g[7] - g[4] * g[6]
        if nx * normal[0] + ny * normal[1] + nz * normal[2] > 0.1:
            return True
    return False


@kernel
def _solve(px, py, pz, n, a, u, v):
    """Coordinates (alpha, beta) of a point from corner a along u and v, seen along the unit normal n."""
    rx = px - a[0]
    ry = py - a[1]
    rz = pz - a[2]
    # triple products with the normal leave out what stands off the plane
    uv = n[0] * (u[1] * v[2] - u[2] * v[1]) + n[1] * (u[2] * v[0] - u[0] * v[2]) + n[2] * (u[0] * v[1] - u[1] * v[0])
    rv = n[0] * (ry * v[2] - rz * v[1]) + n[1] * (rz * v[0] - rx * v[2]) + n[2] * (rx * v[1] - ry * v[0])
    ur = n[0] * (u[1] * rz - u[2] * ry) + n[1] * (u[2] * rx - u[0] * rz) + n[2] * (u[0] * ry - u[1] * rx)
    if uv == 0.0:
        return math.nan, math.nan
    return rv / uv, ur / uv


@kernel
def _climb(mesh, net, i, j, px, py, pz, normal, a, u, v):
    """From the cell (i, j) on to the one that a point seems to lie on, seen along a normal.

    The point's coordinates in the cell at hand tell how many cells to go: on a flat mould one step is enough,
    elsewhere a few. (-1, -1) where the way leaves the net. a, u, v : (3,) scratch.
    """
    n_warp, n_weft = net.status.shape
    for step in range(MAX_STEPS):
        # the edges of the cell at hand, borrowed from the cell before where it ends
        _node(mesh, net, i, j, a)
        if i + 1 < n_warp and net.status[i + 1, j] <= OFF_MOULD:
            _node(mesh, net, i + 1, j, u)
            for k in range(3):
                u[k] -= a[k]
        elif i > 0 and net.status[i - 1, j] <= OFF_MOULD:
            _node(mesh, net, i - 1, j, u)
            for k in range(3):
                u[k] = a[k] - u[k]
        else:
            break
        if j + 1 < n_weft and net.status[i, j + 1] <= OFF_MOULD:
            _node(mesh, net, i, j + 1, v)
            for k in range(3):
                v[k] -= a[k]
        elif j > 0 and net.status[i, j - 1] <= OFF_MOULD:
            _node(mesh, net, i, j - 1, v)
            for k in range(3):
                v[k] = a[k] - v[k]
        else:
            break
        alpha, beta = _solve(px, py, pz, normal, a, u, v)
        if not (abs(alpha) < 1e6 and abs(beta) < 1e6):
            break
        di = math.floor(alpha)
        dj = math.floor(beta)
        if di == 0 and dj == 0:
            return i, j
        # a cell bent over a crease may send the point to its neighbour and back
        near = 0.55 + 0.005 * step
        if abs(alpha - 0.5) < near and abs(beta - 0.5) < near and is_whole(net.status, i, j):
            return i, j
        moved = False
        for _shrink in range(12):
            ti = i + di
            tj = j + dj
            if 0 <= ti < n_warp and 0 <= tj < n_weft and net.status[ti, tj] <= OFF_MOULD and (di != 0 or dj != 0):
                i = ti
                j = tj
                moved = True
                break
            if di == 0 and dj == 0:
                break
            di = int(di / 2)
            dj = int(dj / 2)
        if not moved:
            break
    return -1, -1


@kernel
def _lies(mesh, net, i, j, face, point, normal, warp, weft, corner, share):
    """Whether a point lies on the cell (i, j), if it is whole; `share` (2,) gets its coordinates there, 0 to 1."""
    if not is_whole(net.status, i, j) or not _faces_alike(mesh, net, i, j, normal):
        return False
    f = mesh.frame[face]
    x = 0.0
    y = 0.0
    for k in range(3):
        x += (point[k] - f[k]) * f[3 + k]
        y += (point[k] - f[k]) * f[6 + k]
    if not lies_on_cell(mesh, net, i, j, face, x, y, warp, weft, corner):
        return False
    ux = corner[1, 0] - corner[0, 0]
    uy = corner[1, 1] - corner[0, 1]
    vx = corner[3, 0] - corner[0, 0]
    vy = corner[3, 1] - corner[0, 1]
    turn = ux * vy - uy * vx
    share[0] = min(max((vx * corner[0, 1] - vy * corner[0, 0]) / turn, 0.0), 1.0)
    share[1] = min(max((uy * corner[0, 0] - ux * corner[0, 1]) / turn, 0.0), 1.0)
    return True


@kernel(nogil=True, makes_arrays=True)
def climb_to_cells(mesh, net, warp, weft, face, point, normal, first, cell, share):
    """The cell over each point, where a climb from a node nearby leads there.

    Parameters
    ----------
    warp, weft : float
        Spacings, mm.
    face : (n,) int64
        Face of the surface that holds each point; points of one face follow each other.
    point, normal : (n, 3)
    first : (m, 2)
        From `first_nodes`.
    cell : (n, 2) int64
        Gets the cell; -1 where the climb did not lead to it.
    share : (n, 2)
        Gets the point's coordinates in its cell, along the warp and along the weft, 0 to 1.
    """
    a = np.empty(3)
    u = np.empty(3)
    v = np.empty(3)
    corner = np.empty((4, 2))
    last = -1
    for q in range(len(face)):
        cell[q] = -1
        f = face[q]
        if first[f, 0] < 0:
            continue
        # on from the last point's cell, else from the face's own node
        for attempt in range(2):
            if attempt == 0 and (last < 0 or face[last] != f):
                continue
            i, j = (cell[last, 0], cell[last, 1]) if attempt == 0 else (first[f, 0], first[f, 1])
            i, j = _climb(mesh, net, i, j, point[q, 0], point[q, 1], point[q, 2], normal[q], a, u, v)
            if i >= 0 and _lies(mesh, net, i, j, f, point[q], normal[q], warp, weft, corner, share[q]):
                cell[q, 0] = i
                cell[q, 1] = j
                last = q
                break


@kernel(nogil=True, makes_arrays=True)
def search_cells(mesh, net, warp, weft, face, point, normal, missed, cell, share):
    """The cell over each point that no climb led to, among all those with a corner near it: seams, rims and creases.

    Parameters
    ----------
    missed : (k,) int64
        The points.
    """
    n_warp, n_weft = net.status.shape
    # no point of a cell is farther than this from one of its corners
    radius = 0.5 * REACH * (warp + weft)
    size = 1024
    while size < 32 * len(missed):
        size *= 2
    wanted = np.zeros(size, dtype=np.bool_)
    at = np.empty(3, dtype=np.int64)
    for q in missed:
        for k in range(3):
            at[k] = math.floor(point[q, k] / radius)
        for near in range(27):
            wanted[cube_beside(at[0], at[1], at[2], near, size)] = True
    heads = np.full(size, -1, dtype=np.int64)
    place = np.empty(3)
    nodes = [(0, 0, -1)][:0]
    for i in range(n_warp):
        for j in range(n_weft):
            if net.status[i, j] > OFF_MOULD:
                continue
            _node(mesh, net, i, j, place)
            for k in range(3):
                at[k] = math.floor(place[k] / radius)
            here = bucket(at[0], at[1], at[2], size)
            if wanted[here]:
                nodes.append((i, j, heads[here]))
                heads[here] = len(nodes) - 1
    corner = np.empty((4, 2))
    told = np.empty(2)
    for q in missed:
        for k in range(3):
            at[k] = math.floor(point[q, k] / radius)
        for near in range(27):
            n = heads[cube_beside(at[0], at[1], at[2], near, size)]
            while n >= 0:
                i, j, n = nodes[n]
                if _gap2(mesh, net, i, j, point[q], place) > radius * radius:
                    continue
                for which in range(4):
                    ci = i - (which & 1)
                    cj = j - (which >> 1)
                    # of two layers the one nearer to the lattice's first corner, whatever the order they are found in
                    after = cell[q, 0] >= 0 and (ci, cj) >= (cell[q, 0], cell[q, 1])
                    if not after and _lies(mesh, net, ci, cj, face[q], point[q], normal[q], warp, weft, corner, told):
                        cell[q, 0] = ci
                        cell[q, 1] = cj
                        share[q] = told


@kernel
def _gap2(mesh, net, i, j, point, place):
    """Square of the distance in space between a node and a point, mm2."""
    _node(mesh, net, i, j, place)
    gap2 = 0.0
    for k in range(3):
        gap2 += (place[k] - point[k]) ** 2
    return gap2


@kernel(nogil=True, makes_arrays=True)
def fibres_on_cells(mesh, net, start, warp, weft, tangent, normal, cell, share, warp_out, weft_out):
    """Directions of the fibres at points of cells: the mean of those at the corners, in the plane of the point's face.

    Parameters
    ----------
    tangent : (2, n_warp, n_weft, 3)
        Directions of warp and weft at the nodes, if at hand, else of length 0: they are then found as needed.
    normal : (n, 3)
        Of the face that holds each point.
    cell, share : (n, 2)
        As told by `climb_to_cells`; where the cell is -1 nothing is written.
    warp_out, weft_out : (n, 3)
        Get unit vectors.
    """
    came = np.empty(2)
    for q in range(len(cell)):
        i = cell[q, 0]
        j = cell[q, 1]
        if i < 0:
            continue
        alpha = share[q, 0]
        beta = share[q, 1]
        for family in range(2):
            sx = 0.0
            sy = 0.0
            sz = 0.0
            for corner in range(4):
                ci = i + (corner & 1)
                cj = j + (corner >> 1)
                g = mesh.frame[net.face[ci, cj]]
                nx = g[4] * g[8] - g[5] * g[7]
                ny = g[5] * g[6] - g[3] * g[8]
                nz = g[3] * g[7] - g[4] * g[6]
                weight = (alpha if corner & 1 else 1.0 - alpha) * (beta if corner >> 1 else 1.0 - beta)
                if nx * normal[q, 0] + ny * normal[q, 1] + nz * normal[q, 2] < SAME_PLANE:
                    weight *= 1e-9
                weight += 1e-12
                if tangent.shape[1] > 0:
                    if not math.isnan(tangent[family, ci, cj, 0]):
                        sx += weight * tangent[family, ci, cj, 0]
                        sy += weight * tangent[family, ci, cj, 1]
                        sz += weight * tangent[family, ci, cj, 2]
                    continue
                came[0] = math.nan
                tx, ty = node_tangent(mesh, net, start, family, ci, cj, warp if family == WARP else weft, came)
                if math.isnan(tx):
                    continue
                sx += weight * (tx * g[3] + ty * g[6])
                sy += weight * (tx * g[4] + ty * g[7])
                sz += weight * (tx * g[5] + ty * g[8])
            off = sx * normal[q, 0] + sy * normal[q, 1] + sz * normal[q, 2]
            sx -= off * normal[q, 0]
            sy -= off * normal[q, 1]
            sz -= off * normal[q, 2]
            size = math.sqrt(sx * sx + sy * sy + sz * sz)
            if family == WEFT:
                weft_out[q, 0] = sx / size
                weft_out[q, 1] = sy / size
                weft_out[q, 2] = sz / size
            else:
                warp_out[q, 0] = sx / size
                warp_out[q, 1] = sy / size
                warp_out[q, 2] = sz / size


@kernel(nogil=True)
def cells_by_face(net, shear, touching, locking, initial_angle, largest, area, over):
    """Largest |shear|, area and area over the lock per face of the mould, of the cells whose first corner lies there.

    largest, area, over : (m,) accumulated; areas in cells of sin(angle) = 1.
    """
    n_faces = len(largest)
    for i in range(shear.shape[0]):
        for j in range(shear.shape[1]):
            if not touching[i, j]:
                continue
            f = n_faces
            for corner in range(4):
                ci = i + (corner & 1)
                cj = j + (corner >> 1)
                if net.status[ci, cj] == 0 and net.face[ci, cj] < n_faces:
                    f = net.face[ci, cj]
                    break
            if f == n_faces:
                continue
            size = math.sin(initial_angle - shear[i, j])
            area[f] += size
            if abs(shear[i, j]) > locking:
                over[f] += size
            largest[f] = max(largest[f], abs(shear[i, j]))
