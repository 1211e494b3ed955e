"""The tables of an unfolding, face by face."""

import math

from meshdrape.kernels.cache import kernel


@kernel
def unfold(vertices, faces, neighbour, corner, frame, line, crossing, plane):
    """Lay every face in a frame of its own and find the motions over its sides: fills the tables of `Unfolding`."""
    _lay_flat(vertices, faces, corner, frame)
    _join(corner, neighbour, line, crossing, plane)


@kernel
def _lay_flat(vertices, faces, corner, frame):
    """Lay every face in a frame of its own: fills `corner` (m, 3) and `frame` (m, 9) of `Unfolding`."""
    for f in range(len(faces)):
        a, b, c = faces[f]
        ux = vertices[b, 0] - vertices[a, 0]
        uy = vertices[b, 1] - vertices[a, 1]
        uz = vertices[b, 2] - vertices[a, 2]
        vx = vertices[c, 0] - vertices[a, 0]
        vy = vertices[c, 1] - vertices[a, 1]
        vz = vertices[c, 2] - vertices[a, 2]
        nx = uy * vz - uz * vy
        ny = uz * vx - ux * vz
        nz = ux * vy - uy * vx
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        nx /= size
        ny /= size
        nz /= size
        x1 = math.sqrt(ux * ux + uy * uy + uz * uz)
        ux /= x1
        uy /= x1
        uz /= x1
        # the y axis, left of the x axis in the plane
        wx = ny * uz - nz * uy
        wy = nz * ux - nx * uz
        wz = nx * uy - ny * ux
        corner[f, 0] = x1
        corner[f, 1] = vx * ux + vz * uz + vy * uy
        corner[f, 2] = vx * wx + vz * wz + vy * wy
        for k in range(3):
            frame[f, k] = vertices[a, k]
        frame[f, 3] = ux
        frame[f, 4] = uy
        frame[f, 5] = uz
        frame[f, 6] = wx
        frame[f, 7] = wy
        frame[f, 8] = wz


@kernel
def _side(corner, f, k):
    """Tail and head of side k of a face in its frame."""
    x1 = corner[f, 0]
    x2 = corner[f, 1]
    y2 = corner[f, 2]
    if k == 0:
        return 0.0, 0.0, x1, 0.0
    if k == 1:
        return x1, 0.0, x2, y2
    return x2, y2, 0.0, 0.0


@kernel
def _join(corner, neighbour, line, crossing, plane):
    """From faces laid flat to their sides and the motions over them: fills `line`, `crossing`, `plane`."""
    for f in range(len(corner)):
        for k in range(3):
            px, py, qx, qy = _side(corner, f, k)
            ex = qx - px
            ey = qy - py
            size = math.sqrt(ex * ex + ey * ey)
            ex /= size
            ey /= size
            line[f, 3 * k] = -ey
            line[f, 3 * k + 1] = ex
            line[f, 3 * k + 2] = -ey * px + ex * py
            code = max(neighbour[f, k], 0)
            g = code // 3
            rx, ry, tx, ty = _side(corner, g, code - 3 * g)
            # their side runs against ours
            hx = rx - tx
            hy = ry - ty
            size = math.sqrt(hx * hx + hy * hy)
            hx /= size
            hy /= size
            c = ex * hx + ey * hy
            s = ex * hy - ey * hx
            # its middle is the same point on both sides
            mx = 0.5 * (px + qx)
            my = 0.5 * (py + qy)
            at = 4 * k
            crossing[f, at] = c
            crossing[f, at + 1] = s
            crossing[f, at + 2] = 0.5 * (rx + tx) - (c * mx - s * my)
            crossing[f, at + 3] = 0.5 * (ry + ty) - (s * mx + c * my)
            plane[f, 8 * k] = -ey
            plane[f, 8 * k + 1] = ex
            plane[f, 8 * k + 2] = px
            plane[f, 8 * k + 3] = py
            for n in range(4):
                plane[f, 8 * k + 4 + n] = crossing[f, at + n]
