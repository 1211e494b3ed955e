"""Edges of facets split until the facets follow the CAD faces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from meshdrape.errors import MouldError
from meshdrape.mould.cad.facets import Facets
from meshdrape.mould.cad.patch import MOST_DRIFT, Bools, Floats, Ints, Nodes, Tolerances, in_parameters, metric_length

# Sizes within this ratio of one another are split in random order: by size alone only peaks would be split.
SIZE_CLASS: Final = 1.25
# mm; no shorter edge of a facet is split: at a kink that the face does not tell of this would be for ever.
SHORTEST: Final = 1e-5
MOST_TRIANGLES: Final = 2_000_000
# The largest size falls from hundreds to one in some twenty-five rounds, and in every second at the least; where it has
# not fallen for so many, it never will, for edges on the outline are not split. Each round takes longer than the last.
ROUNDS: Final = 40

Evaluate = Callable[[Ints, Floats], Nodes]


def refine(facets: Facets, tolerances: Tolerances, developable: Bools, evaluate: Evaluate, ids: Sequence[int]) -> None:
    """Split inner edges in the middle, largest first, and keep the facets Delaunay.

    Parameters
    ----------
    facets : Facets
        Changed in place.
    tolerances : Tolerances
    developable : (n_faces,) bool
        These keep to their outlines, unless an edge between two nodes there turns the normal by far too much.
    evaluate : callable
        Nodes on the faces of the given indices, (k,), at the given parameters, (k, 2).
    ids : sequence of int
        What the user calls the faces.

    Raises
    ------
    MouldError
        The tolerances ask for more triangles than any mould needs, or facets never come to follow a face.
    """
    largest: list[float] = []
    random = np.random.default_rng(0)
    while True:
        edge = facets.inner_edges()
        size = _size(facets, edge, tolerances, developable)
        edge, size = edge[size > 1], size[size > 1]
        if len(edge):
            largest.append(float(size.max()))
            if len(largest) >= ROUNDS and largest[-1] > 0.99 * largest[-ROUNDS]:
                number = ids[facets.nodes.face[facets.quads(edge[[size.argmax()]])[0][0]]]
                msg = (
                    f"no facets follow face {number}, however small: it has a kink, or its outline does not lie on it; "
                    f"mend it in CAD"
                )
                raise MouldError(msg)
        edge = edge[facets.apart(edge, np.floor(np.log(size) / np.log(SIZE_CLASS)) + random.random(len(size)))]
        if not len(edge):
            return
        require_triangles(len(facets.triangles))
        a, b, _, _ = facets.quads(edge)
        middle = (facets.nodes.uv[a] + facets.nodes.uv[b]) / 2
        facets.make_delaunay(facets.split(edge, evaluate(facets.nodes.face[a], middle)))


def require_triangles(count: float) -> None:
    """Raise MouldError if there are to be more triangles than any mould needs."""
    if count > MOST_TRIANGLES:
        msg = f"the mould takes more than {MOST_TRIANGLES:,} triangles at these tolerances; make them larger"
        raise MouldError(msg)


def _size(facets: Facets, edge: Ints, tolerances: Tolerances, developable: Bools) -> Floats:
    """Size of inner edges; 1 is the largest there may be."""
    a, b, _, _ = facets.quads(edge)
    nodes = facets.nodes
    flat = developable[nodes.face[a]]
    size = np.zeros(len(edge))
    size[flat] = np.linalg.norm(nodes.normal[a[flat]] - nodes.normal[b[flat]], axis=1) / (2 * tolerances.angle)
    pole_a, pole_b = nodes.pole[a], nodes.pole[b]
    size[flat & (pole_a | pole_b)] = 0.0
    for pole, other, here in ((a, b, ~flat & pole_a), (b, a, ~flat & pole_b)):
        size[here] = _size_from_pole(nodes, pole[here], other[here], tolerances.chord)
    plain = ~flat & ~pole_a & ~pole_b
    size[plain] = _plain_size(nodes, a[plain], b[plain], tolerances.chord)
    size[np.linalg.norm(nodes.position[a] - nodes.position[b], axis=1) <= SHORTEST] = 0.0
    return size


def _plain_size(nodes: Nodes, a: Ints, b: Ints, chord_tolerance: float) -> Floats:
    """Size of edges a-b on doubly curved faces: by the metric, the gap to the face and the drift on it."""
    metric = (nodes.metric[a] + nodes.metric[b]) / 2
    step = nodes.uv[b] - nodes.uv[a]
    length = metric_length(metric, step)
    # the middle of the cubic through both ends with their tangents, from the middle of the chord
    bulge = np.einsum("kpi,kp->ki", nodes.tangent[a] - nodes.tangent[b], step) / 8
    tangent, normal = (nodes.tangent[a] + nodes.tangent[b]) / 2, (nodes.normal[a] + nodes.normal[b]) / 2
    gap = np.abs(np.einsum("ki,ki->k", bulge, normal))
    drift = metric_length(metric, in_parameters(tangent, bulge))
    return np.asarray(np.maximum(length, np.sqrt(np.maximum(gap / chord_tolerance, drift / MOST_DRIFT))))


def _size_from_pole(nodes: Nodes, pole: Ints, other: Ints, chord_tolerance: float) -> Floats:
    """Size of edges from a pole, where parameters say nothing, by the chord and the forms at the other end."""
    chord = nodes.position[pole] - nodes.position[other]
    length = metric_length(nodes.metric[other], in_parameters(nodes.tangent[other], chord))
    gap = np.abs(np.einsum("ki,ki->k", chord, nodes.normal[other])) / 4
    return np.asarray(np.maximum(length, np.sqrt(gap / chord_tolerance)))
