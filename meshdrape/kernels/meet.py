"""Where a net that wraps round a mould meets itself."""

import math

import numpy as np

from meshdrape.kernels.buckets import bucket, cube_beside
from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD
from meshdrape.kernels.sight import REACH, is_whole, lies_on_cell

MET_ITSELF = 4
# A cell whose sides appear this long, in spacings, is as good as flat,
FLAT = 0.95
# and what appears farther beside it than this does not lie on it.
BESIDE = 0.3
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


@kernel
def _may_lie(position, kept, i, j, ci, cj, a, b, normal, warp, weft, to):
    """Whether the node (i, j) can lie on the whole cell (ci, cj), of whose corners (a, b) is the nearest.

    What is told from places in space, at little cost: false only where no way along the surface is short enough, or
    where the cell is as good as flat and the node beside it. to : (4, 3) scratch.
    """
    if not is_whole(kept, ci, cj):
        return False
    nearest = 0.0
    for k in range(3):
        nearest += (position[a, b, k] - position[i, j, k]) ** 2
    diagonal = 0.0
    for corner in range(4):
        # round the cell: (0, 0), (1, 0), (1, 1), (0, 1)
        k = ci + (1 if corner == 1 or corner == 2 else 0)
        m = cj + (1 if corner >= 2 else 0)
        away = 0.0
        for axis in range(3):
            to[corner, axis] = position[k, m, axis] - position[i, j, axis]
            away += to[corner, axis] ** 2
        # the nearest corner answers for the cell, so that it is looked at once
        if away < nearest:
            return False
        if corner % 2 == 0:
            diagonal += math.sqrt(away)
    if diagonal > REACH * (warp + weft):
        return False
    # where its sides appear as long as they are on the surface, the cell is seen as it is
    beside = False
    turned = _triple(to[0], to[1], normal) + _triple(to[1], to[2], normal) + _triple(to[2], to[0], normal) > 0.0
    for corner in range(4):
        tail = to[corner]
        head = to[(corner + 1) % 4]
        along = 0.0
        size = 0.0
        for axis in range(3):
            side = head[axis] - tail[axis]
            along += side * normal[axis]
            size += side * side
        size = math.sqrt(max(size - along * along, 0.0))
        if size < FLAT * (warp if corner % 2 == 0 else weft):
            return True
        inward = _triple(tail, head, normal) / size
        if (inward if turned else -inward) < -0.5 * BESIDE * (warp + weft):
            beside = True
    return not beside


@kernel(inline="always")
def _triple(u, v, n):
    """The volume u x v . n."""
    return n[0] * (u[1] * v[2] - u[2] * v[1]) + n[1] * (u[2] * v[0] - u[0] * v[2]) + n[2] * (u[0] * v[1] - u[1] * v[0])


@kernel(makes_arrays=True)
def stop_where_met(mesh, net, index, position, order, warp, weft):
    """Take back, in a fixed order, each node that lies on a cell kept before it, and what depends on it.

    A node lies on a cell if the surface leads from one to the other, not if it is near to it in space: the layers of a
    roll are nearer to each other than the nodes of one.

    Parameters
    ----------
    index : (2,) the seed's (i, j)
    position : (n_warp, n_weft, 3) mm
    order : (n, 2) int64
        Nodes to go through, nearer to the seed first.
    warp, weft : float
        Spacings, mm.

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
    # no point of a cell is farther than this from one of its corners
    radius = 0.5 * REACH * (warp + weft)
    # kept nodes by cubes of side `radius`
    size = 1024
    while size < 2 * len(order):
        size *= 2
    heads = np.full(size, -1, dtype=np.int64)
    taken = 0
    normal = np.empty(3)
    corner = np.empty((4, 2))
    to = np.empty((4, 3))
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
        normal[0] = frame[4] * frame[8] - frame[5] * frame[7]
        normal[1] = frame[5] * frame[6] - frame[3] * frame[8]
        normal[2] = frame[3] * frame[7] - frame[4] * frame[6]
        if not met:
            for near in range(27):
                m = heads[cube_beside(vx, vy, vz, near, size)]
                while m >= 0 and not met:
                    a = order[m, 0]
                    b = order[m, 1]
                    m = following[m]
                    if abs(a - i) <= 2 and abs(b - j) <= 2:
                        continue
                    dx = position[a, b, 0] - px
                    dy = position[a, b, 1] - py
                    dz = position[a, b, 2] - pz
                    if dx * dx + dy * dy + dz * dz > radius * radius:
                        continue
                    # the other side of a thin mould
                    g = mesh.frame[net.face[a, b]]
                    facing = (
                        normal[0] * (g[4] * g[8] - g[5] * g[7])
                        + normal[1] * (g[5] * g[6] - g[3] * g[8])
                        + normal[2] * (g[3] * g[7] - g[4] * g[6])
                    )
                    if facing <= 0.0:
                        continue
                    for which in range(4):
                        ci = a - (which & 1)
                        cj = b - (which >> 1)
                        if _may_lie(position, kept, i, j, ci, cj, a, b, normal, warp, weft, to) and lies_on_cell(
                            mesh, net, ci, cj, net.face[i, j], net.xy[i, j, 0], net.xy[i, j, 1], warp, weft, corner
                        ):
                            met = True
                if met:
                    break
        if met:
            status[i, j] = MET_ITSELF
            cut[i, j] = True
            taken += 1
            continue
        kept[i, j] = status[i, j]
        here = bucket(vx, vy, vz, size)
        following[n] = heads[here]
        heads[here] = n
    return taken
