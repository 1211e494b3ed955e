"""From lattice to space, and what is trimmed at the border."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel
from meshdrape.kernels.edges import OFF_MOULD, WARP, WEFT, edge_ends
from meshdrape.kernels.walk import MAX_CROSSINGS, off_mould

OUTSIDE = 2


@kernel(nogil=True)
def positions(mesh, net, i_first, out):
    """World positions of the rows from i_first on, out (rows, n_weft, 3); NaN where there is no node."""
    for a in range(out.shape[0]):
        i = i_first + a
        for j in range(out.shape[1]):
            if net.status[i, j] > OFF_MOULD:
                out[a, j, 0] = math.nan
                out[a, j, 1] = math.nan
                out[a, j, 2] = math.nan
                continue
            frame = mesh.frame[net.face[i, j]]
            x = net.xy[i, j, 0]
            y = net.xy[i, j, 1]
            for k in range(3):
                out[a, j, k] = frame[k] + x * frame[3 + k] + y * frame[6 + k]


@kernel
def node_tangent(mesh, net, start, family, i, j, spacing, came):
    """Unit tangent of a fibre at a node, in the frame of its face: the mean of the edges before and after it.

    NaN where the fibre has no edge at the node. At the seed it is the fibre's own start: on a vertex the two halves
    need not be opposite.

    came : (2,)
        How the edge before arrives, NaN where that is to be found; gets how the edge after arrives at the next node,
        NaN where that was not asked. Node after node, each edge is walked once.
    """
    n_warp, n_weft = net.status.shape
    cx = came[0]
    cy = came[1]
    came[0] = math.nan
    if family == WARP:
        after = i + 1 < n_warp and net.status[i + 1, j] <= OFF_MOULD
        before = i > 0 and net.status[i - 1, j] <= OFF_MOULD
    else:
        after = j + 1 < n_weft and net.status[i, j + 1] <= OFF_MOULD
        before = j > 0 and net.status[i, j - 1] <= OFF_MOULD
    if i == start.origin[0] and j == start.origin[1]:
        return start.tangent[family, 0], start.tangent[family, 1]
    dx = 0.0
    dy = 0.0
    if after:
        px, py, came[0], came[1] = edge_ends(mesh, net, start, family, i, j, 1, spacing)
        dx += px
        dy += py
    if before:
        if math.isnan(cx):
            px, py, _, _ = edge_ends(mesh, net, start, family, i, j, -1, spacing)
            cx = -px
            cy = -py
        dx += cx
        dy += cy
    size = math.sqrt(dx * dx + dy * dy)
    if size == 0.0:
        return math.nan, math.nan
    return dx / size, dy / size


@kernel
def _tangent(mesh, net, start, family, i, j, spacing, came):
    """The same; where one face holds the neighbours on both sides their chord is the mean of the two edges."""
    f = net.face[i, j]
    # the node before and the one after
    bi, bj, ai, aj = (i - 1, j, i + 1, j) if family == WARP else (i, j - 1, i, j + 1)
    if (
        min(bi, bj) >= 0
        and ai < net.status.shape[0]
        and aj < net.status.shape[1]
        and net.status[bi, bj] <= OFF_MOULD
        and net.status[ai, aj] <= OFF_MOULD
        and net.face[bi, bj] == f
        and net.face[ai, aj] == f
    ):
        came[0] = math.nan
        dx = net.xy[ai, aj, 0] - net.xy[bi, bj, 0]
        dy = net.xy[ai, aj, 1] - net.xy[bi, bj, 1]
        size = math.sqrt(dx * dx + dy * dy)
        return dx / size, dy / size
    return node_tangent(mesh, net, start, family, i, j, spacing, came)


@kernel(nogil=True, makes_arrays=True)
def directions(mesh, net, start, i_first, warp, weft, warp_out, weft_out):
    """Unit tangents (rows, n_weft, 3) of the fibres at the nodes of the rows from i_first on; NaN without a node."""
    n_weft = net.status.shape[1]
    # how the edges before arrive: of each warp at the row at hand, of the weft at the column
    warp_came = np.full((n_weft, 2), math.nan)
    weft_came = np.empty(2)
    for a in range(warp_out.shape[0]):
        i = i_first + a
        weft_came[0] = math.nan
        for j in range(n_weft):
            if net.status[i, j] > OFF_MOULD:
                warp_out[a, j, :] = math.nan
                weft_out[a, j, :] = math.nan
                warp_came[j, 0] = math.nan
                weft_came[0] = math.nan
                continue
            frame = mesh.frame[net.face[i, j]]
            px, py = _tangent(mesh, net, start, WARP, i, j, warp, warp_came[j])
            qx, qy = _tangent(mesh, net, start, WEFT, i, j, weft, weft_came)
            for k in range(3):
                warp_out[a, j, k] = px * frame[3 + k] + py * frame[6 + k]
                weft_out[a, j, k] = qx * frame[3 + k] + qy * frame[6 + k]


@kernel
def border_status(mesh, face, xy, slack, out):
    """Status of places (n,), (n, 2): 0 on the mould, 1 on its extension."""
    for n in range(len(face)):
        out[n] = OFF_MOULD if off_mould(mesh, face[n], xy[n, 0], xy[n, 1], slack) else 0


@kernel
def _crosses_mould(mesh, face, x, y, dx, dy, length):
    """Whether the straight path from (x, y) touches a face of the mould."""
    entered = -1
    for _ in range(MAX_CROSSINGS):
        if mesh.rim[face] < 0:
            return True
        exit_at = math.inf
        exit_edge = -1
        for k in range(3):
            if k == entered:
                continue
            rate = mesh.line[face, 3 * k] * dx + mesh.line[face, 3 * k + 1] * dy
            if rate < 0.0:
                at = -(mesh.line[face, 3 * k] * x + mesh.line[face, 3 * k + 1] * y - mesh.line[face, 3 * k + 2]) / rate
                if at < exit_at:
                    exit_at = at
                    exit_edge = k
        if length <= exit_at:
            return False
        code = mesh.neighbour[face, exit_edge]
        if code < 0:
            return False
        c = mesh.crossing[face, 4 * exit_edge]
        s = mesh.crossing[face, 4 * exit_edge + 1]
        tx = mesh.crossing[face, 4 * exit_edge + 2]
        ty = mesh.crossing[face, 4 * exit_edge + 3]
        x, y = c * x - s * y + tx, s * x + c * y + ty
        dx, dy = c * dx - s * dy, s * dx + c * dy
        face = code // 3
        entered = code % 3
    return False


@kernel(nogil=True, makes_arrays=True)
def touching_cells(mesh, net, start, i_first, warp, weft, out):
    """Whether each whole cell touches the mould, by a corner or an edge; rows from i_first, out (rows, n_weft - 1)."""
    _touching_by_corner(net.status, i_first, out)
    status = net.status
    face = net.face
    # of edges two cells share: whether the one before found that they touch, 1 or 0, or has not looked, -1
    above = np.full(out.shape[1], -1, dtype=np.int8)
    for a in range(out.shape[0]):
        i = i_first + a
        right = -1
        for j in range(out.shape[1]):
            if (
                status[i, j] == OFF_MOULD
                and status[i + 1, j] == OFF_MOULD
                and status[i, j + 1] == OFF_MOULD
                and status[i + 1, j + 1] == OFF_MOULD
                # an edge inside one face off the mould crosses nothing
                and not (face[i, j] == face[i + 1, j] == face[i, j + 1] == face[i + 1, j + 1])
            ):
                below = above[j] if above[j] >= 0 else _edge_touches(mesh, net, start, WEFT, i, j, weft)
                left = right if right >= 0 else _edge_touches(mesh, net, start, WARP, i, j, warp)
                right = _edge_touches(mesh, net, start, WARP, i, j + 1, warp)
                above[j] = _edge_touches(mesh, net, start, WEFT, i + 1, j, weft)
                out[a, j] = below + left + right + above[j] > 0
            else:
                right = -1
                above[j] = -1


@kernel(nogil=True)
def _touching_by_corner(status, i_first, out):
    """Whether each cell is whole and has a corner on the mould: on its own, the loop runs many cells at a time."""
    for a in range(out.shape[0]):
        below = status[i_first + a]
        above = status[i_first + a + 1]
        for j in range(out.shape[1]):
            high = max(max(below[j], below[j + 1]), max(above[j], above[j + 1]))
            low = min(min(below[j], below[j + 1]), min(above[j], above[j + 1]))
            out[a, j] = (high <= OFF_MOULD) & (low == 0)


@kernel
def _edge_touches(mesh, net, start, family, i, j, length):
    """Whether the edge that leaves (i, j) for larger indices crosses a face of the mould, 1 or 0."""
    dx, dy, _, _ = edge_ends(mesh, net, start, family, i, j, 1, length)
    return 1 if _crosses_mould(mesh, net.face[i, j], net.xy[i, j, 0], net.xy[i, j, 1], dx, dy, length) else 0


@kernel(nogil=True)
def trim(net, touching, hem):
    """Take back the nodes off the mould that no cell needs: they become OUTSIDE.

    Those farther than `hem` cells from a cell that touches the mould, and those at no whole cell.
    """
    n_warp, n_weft = net.status.shape
    for i in range(n_warp):
        for j in range(n_weft):
            if net.status[i, j] != OFF_MOULD:
                continue
            kept = False
            for a in range(max(i - 1 - hem, 0), min(i + 1 + hem, n_warp - 1)):
                for b in range(max(j - 1 - hem, 0), min(j + 1 + hem, n_weft - 1)):
                    if touching[a, b]:
                        kept = True
                        break
                if kept:
                    break
            if not kept:
                net.status[i, j] = OUTSIDE
    for i in range(n_warp):
        for j in range(n_weft):
            if net.status[i, j] != OFF_MOULD:
                continue
            kept = False
            for a in range(max(i - 1, 0), min(i + 1, n_warp - 1)):
                for b in range(max(j - 1, 0), min(j + 1, n_weft - 1)):
                    if (
                        net.status[a, b] <= OFF_MOULD
                        and net.status[a + 1, b] <= OFF_MOULD
                        and net.status[a, b + 1] <= OFF_MOULD
                        and net.status[a + 1, b + 1] <= OFF_MOULD
                    ):
                        kept = True
            if not kept:
                net.status[i, j] = OUTSIDE
