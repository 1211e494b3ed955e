"""Where a net that wraps round a mould meets itself."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD

MET_ITSELF = 4
# Sheets are told apart by how far they lie from each other across the mould, in spacings, and by their normals.
THICKNESS = 0.25
# A single sheet's nodes on one face stay within this many face diameters, in spacings, of each other.
WINDOW = 8.0


@kernel
def spread_on_faces(net, window, diameter, spacing):
    """Whether nodes with far-apart indices lie on one face, as they do where a sheet comes round again.

    Tells for certain on faces not much larger than a cell. window : (m, 4) int64 scratch; diameter : (m,) mm.
    """
    n_warp, n_weft = net.status.shape
    window[:, 0] = n_warp
    window[:, 1] = -1
    window[:, 2] = n_weft
    window[:, 3] = -1
    for i in range(n_warp):
        for j in range(n_weft):
            if net.status[i, j] > OFF_MOULD:
                continue
            f = net.face[i, j]
            window[f, 0] = min(window[f, 0], i)
            window[f, 1] = max(window[f, 1], i)
            window[f, 2] = min(window[f, 2], j)
            window[f, 3] = max(window[f, 3], j)
    for f in range(len(diameter)):
        allowed = 3.0 + WINDOW * diameter[f] / spacing
        if window[f, 1] - window[f, 0] > allowed or window[f, 3] - window[f, 2] > allowed:
            return True
    return False


@kernel(inline="always")
def _cross2(ax, ay, bx, by):
    return ax * by - ay * bx


@kernel
def _in_cell(position, status, ci, cj, face_frame, px, py, pz, thickness):
    """Whether a point lies over the whole cell (ci, cj), seen along the normal of a frame."""
    n_warp, n_weft = status.shape
    if ci < 0 or cj < 0 or ci >= n_warp - 1 or cj >= n_weft - 1:
        return False
    x = np.empty(4)
    y = np.empty(4)
    for corner in range(4):
        # round the cell: (0, 0), (1, 0), (1, 1), (0, 1)
        i = ci + (1 if corner == 1 or corner == 2 else 0)
        j = cj + (1 if corner >= 2 else 0)
        if status[i, j] > OFF_MOULD:
            return False
        rx = position[i, j, 0] - px
        ry = position[i, j, 1] - py
        rz = position[i, j, 2] - pz
        x[corner] = rx * face_frame[3] + ry * face_frame[4] + rz * face_frame[5]
        y[corner] = rx * face_frame[6] + ry * face_frame[7] + rz * face_frame[8]
        if rx * rx + ry * ry + rz * rz - x[corner] ** 2 - y[corner] ** 2 > (4.0 * thickness) ** 2:
            return False
    sign = 0.0
    for corner in range(4):
        after = (corner + 1) % 4
        turn = _cross2(x[corner], y[corner], x[after], y[after])
        if turn == 0.0 or turn * sign < 0.0:
            return False
        sign = turn
    return True


@kernel(inline="always")
def _bucket(x, y, z, size):
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791) & (size - 1)


@kernel
def stop_where_met(mesh, net, index, position, order, radius):
    """Take back, in a fixed order, each node that lies on a cell kept before it, and what depends on it.

    Parameters
    ----------
    index : (2,) the seed's (i, j)
    position : (n_warp, n_weft, 3) mm
    order : (n, 2) int64
        Nodes to go through, nearer to the seed first.
    radius : float
        No point of a cell is farther than this from one of its corners, mm.

    Returns
    -------
    int
        Nodes taken back: they become MET_ITSELF.
    """
    status = net.status
    n_warp, n_weft = status.shape
    kept = np.full((n_warp, n_weft), 8, dtype=np.uint8)
    cut = np.zeros((n_warp, n_weft), dtype=np.bool_)
    following = np.full(len(order), -1, dtype=np.int64)
    # kept nodes by cubes of side `radius`, hashed; a chance collision only costs a look
    size = 1024
    while size < 2 * len(order):
        size *= 2
    heads = np.full(size, -1, dtype=np.int64)
    taken = 0
    thickness = THICKNESS * radius
    for n in range(len(order)):
        i = order[n, 0]
        j = order[n, 1]
        if status[i, j] > OFF_MOULD:
            continue
        px = position[i, j, 0]
        py = position[i, j, 1]
        pz = position[i, j, 2]
        met = False
        # behind a node that met the net the fibre is cut
        pi = i - 1 if i > index[0] else i + 1
        pj = j - 1 if j > index[1] else j + 1
        if i != index[0] and cut[pi, j]:
            met = True
        if j != index[1] and cut[i, pj]:
            met = True
        vx = np.int64(math.floor(px / radius))
        vy = np.int64(math.floor(py / radius))
        vz = np.int64(math.floor(pz / radius))
        frame = mesh.frame[net.face[i, j]]
        nx = frame[4] * frame[8] - frame[5] * frame[7]
        ny = frame[5] * frame[6] - frame[3] * frame[8]
        nz = frame[3] * frame[7] - frame[4] * frame[6]
        if not met:
            for near in range(27):
                m = heads[_bucket(vx + near // 9 - 1, vy + near // 3 % 3 - 1, vz + near % 3 - 1, size)]
                while m >= 0 and not met:
                    a = order[m, 0]
                    b = order[m, 1]
                    if abs(a - i) > 2 or abs(b - j) > 2:
                        dx = position[a, b, 0] - px
                        dy = position[a, b, 1] - py
                        dz = position[a, b, 2] - pz
                        off = abs(dx * nx + dy * ny + dz * nz)
                        g = mesh.frame[net.face[a, b]]
                        facing = (
                            nx * (g[4] * g[8] - g[5] * g[7])
                            + ny * (g[5] * g[6] - g[3] * g[8])
                            + nz * (g[3] * g[7] - g[4] * g[6])
                        )
                        if off < thickness and facing > 0.5 and dx * dx + dy * dy + dz * dz <= radius * radius:
                            for corner in range(4):
                                ci = a - (corner & 1)
                                cj = b - (corner >> 1)
                                if _in_cell(position, kept, ci, cj, frame, px, py, pz, thickness):
                                    met = True
                    m = following[m]
                if met:
                    break
        if met:
            status[i, j] = MET_ITSELF
            cut[i, j] = True
            taken += 1
            continue
        kept[i, j] = status[i, j]
        bucket = _bucket(vx, vy, vz, size)
        following[n] = heads[bucket]
        heads[bucket] = n
    return taken
