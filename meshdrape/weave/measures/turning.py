"""How far the start fibres turn at their nodes, measured in the surface on either side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.shortest import shortest_path, without_specks
from meshdrape.weave.measures.chords import generator_nodes, place, sides
from meshdrape.weave.net import Net
from meshdrape.weave.start.rays import SNAP

FloatArray = NDArray[np.float64]

# A defect below this is the round-off of a flat vertex, rad.
FLAT = 1e-14


def turning(net: Net, half: int) -> FloatArray:
    """Turn of a half-fibre to its left and to its right at each node, the seed left out, (n, 2) rad.

    Half a turn less the angle on that side, from the edge that arrives to the one that leaves. Both add up to the angle
    defect of the node, so only where it is no vertex is one the opposite of the other. The last node turns nowhere.
    """
    nodes = generator_nodes(net, half)
    found = np.zeros((max(len(nodes) - 1, 0), 2))
    if net.start_fibres:
        for k in range(1, len(nodes) - 1):
            turn = _in_frame(net, half, nodes, k)
            found[k - 1] = turn, -turn
    for k in nodes_at_vertices(net, nodes):
        found[k - 1] = _about_vertex(net, nodes, k)
    return found


def nodes_at_vertices(net: Net, nodes: NDArray[np.int64]) -> list[int]:
    """Orders of a half-fibre's nodes, neither the first nor the last, that are vertices with a defect."""
    surface, vertex = net.surface, vertices_at(net, nodes)
    curved = (vertex >= 0) & ~surface.border_vertex[vertex] & (np.abs(surface.vertex_defect[vertex]) > FLAT)
    return (np.flatnonzero(curved[1:-1]) + 1).tolist()


def _in_frame(net: Net, half: int, nodes: NDArray[np.int64], k: int) -> float:
    """Turn to the left at a node as the frame of its face has it, rad."""
    edge = tuple(np.minimum(nodes[k], nodes[k + 1]))
    a, b = net.start.arrival[half, k - 1], (net.lattice.warp_out, net.lattice.weft_out)[half % 2][edge]
    return float(np.arctan2(a[0] * b[1] - a[1] * b[0], a @ b))


def _about_vertex(net: Net, nodes: NDArray[np.int64], k: int) -> tuple[float, float]:
    """Turns to the left and to the right at a node that is a vertex, by the angles about it, rad."""
    surface = net.surface
    if not net.start_fibres:
        # straightest: as much on either side
        half_defect = float(surface.vertex_defect[vertices_at(net, nodes[k : k + 1])[0]]) / 2
        return half_defect, half_defect
    before, here, after = (place(net, *nodes[n]) for n in (k - 1, k, k + 1))
    left, right = sides(
        surface,
        here,
        without_specks(shortest_path(surface, before, here))[-1],
        without_specks(shortest_path(surface, here, after))[0],
    )
    return float(np.pi - left), float(np.pi - right)


def vertices_at(net: Net, nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """The mesh vertex each of some nodes (n, 2) lies on, (n,); -1 for none."""
    lattice, surface = net.lattice, net.surface
    face, xy = lattice.face[nodes[:, 0], nodes[:, 1]], lattice.xy[nodes[:, 0], nodes[:, 1]]
    x1, x2, y2 = surface.unfolding.corner[face].T
    c = xy[:, 1] / y2
    b = (xy[:, 0] - c * x2) / x1
    weight = np.stack([1 - b - c, b, c], axis=1)
    corner = weight.argmax(axis=1)
    at = np.arange(len(nodes))
    return np.asarray(np.where(weight[at, corner] >= 1 - SNAP, surface.faces[face, corner], -1))
