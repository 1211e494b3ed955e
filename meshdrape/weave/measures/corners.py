"""Corners of cells at a generator's node that is a vertex of the mesh, where no plane holds all four."""

from __future__ import annotations

import numpy as np

from meshdrape.geodesic.shortest import shortest_path, without_specks
from meshdrape.kernels.edges import WARP, WEFT, edge_ends
from meshdrape.surface import SurfacePoint
from meshdrape.weave.measures.chords import generator_nodes, place
from meshdrape.weave.measures.turning import nodes_at_vertices
from meshdrape.weave.net import Net
from meshdrape.weave.start.rays import Rays
from meshdrape.weave.status import NodeStatus


def corrections(net: Net) -> list[tuple[int, int, float]]:
    """Cells (i, j) about such nodes, the seed apart, and what their shear is more than the frames of faces say, rad.

    An edge is kept by its direction in the frame of the node's face. At a vertex that direction depends on the way
    round it, so angles are taken about the vertex itself, from the edges followed anew.
    """
    found = []
    for half in range(4):
        nodes = generator_nodes(net, half)
        for k in nodes_at_vertices(net, nodes):
            i, j = nodes[k].tolist()
            found += _about(net, i, j)
    return found


def _about(net: Net, i: int, j: int) -> list[tuple[int, int, float]]:
    status = net.lattice.status
    here = place(net, i, j)
    rays = Rays(net.surface, here)
    found = []
    for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        ring = [(i, j), (i + a, j), (i, j + b), (i + a, j + b)]
        if any(not (0 <= m < net.shape[0] and 0 <= n < net.shape[1]) for m, n in ring):
            continue
        if any(status[at] > NodeStatus.OFF_MOULD for at in ring):
            continue
        warp, weft = (_angle(net, rays, here, at) for at in ring[1:3])
        corner = (weft - warp) % rays.total if a * b > 0 else np.pi - (warp - weft) % rays.total
        found.append((min(i, i + a), min(j, j + b), (_shown(net, i, j, a, b) - corner) / 4))
    return found


def _angle(net: Net, rays: Rays, here: SurfacePoint, at: tuple[int, int]) -> float:
    """Direction about a vertex in which an edge leaves it for another node."""
    first = without_specks(shortest_path(net.surface, here, place(net, *at)))[0]
    return rays.angle(first.face, first.direction.real, first.direction.imag)


def _shown(net: Net, i: int, j: int, a: int, b: int) -> float:
    """Angle from +warp to +weft at a node, of the edges to (i + a, j) and to (i, j + b), as its frame has it, rad."""
    tables = (net.surface.unfolding, net.lattice, net.start)
    warp = edge_ends(*tables, WARP, min(i, i + a), j, 1, net.fabric.warp_spacing)
    weft = edge_ends(*tables, WEFT, i, min(j, j + b), 1, net.fabric.weft_spacing)
    (px, py), (qx, qy) = (warp[:2] if a > 0 else warp[2:]), (weft[:2] if b > 0 else weft[2:])
    return float(np.arctan2(px * qy - py * qx, px * qx + py * qy))
