"""CAD faces as triangles that meet without gaps and follow the rulings of what is developable."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import MouldError
from meshdrape.mould.facets import Facets
from meshdrape.mould.outline import EdgeNodes, Outline, Tolerances
from meshdrape.mould.patch import Nodes, Patch

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# A face whose normals cover less than this solid angle, sr, unrolls flat as far as a net can tell.
DEVELOPABLE = 1e-4
# A face that is not developable is cut into this many lengths at least.
FEWEST_LENGTHS = 8
# A chord's middle may miss the face's own middle by this share of a unit of the metric, and of the triangle's height,
# or the parameters fold.
DRIFT, HEIGHT = 0.1, 0.5
# Straight runs of an outline are bowed by this share of their length, that ears may be cut from them.
BOW = 1e-5
MOST_TRIANGLES = 2_000_000


@dataclass(frozen=True, eq=False)
class Tessellation:
    """Triangles of CAD faces.

    Attributes
    ----------
    vertices : (n, 3) float64, mm
    triangles : (m, 3) int64, counter-clockwise about the faces' own normals
    triangle_face : (m,) int64
        Index of the face each lies on.
    developable : (k,) bool, of each face
    """

    vertices: Floats
    triangles: Ints
    triangle_face: Ints
    developable: NDArray[np.bool_]


def is_developable(patch: Patch) -> bool:
    """Whether a face unrolls flat: the absolute Gaussian curvature over it, sampled, sums to next to nothing."""
    grid = (np.stack(np.meshgrid(np.arange(12), np.arange(12)), -1).reshape(-1, 2) + 0.5) / 12
    span = patch.bounds[1] - patch.bounds[0]
    nodes = patch.nodes((patch.bounds[0] + grid * span) * patch.scale)
    element = np.linalg.norm(np.cross(nodes.tangent[:, 0], nodes.tangent[:, 1]), axis=1)
    area = float(element.mean() * np.prod(span * patch.scale))
    return float(np.abs(nodes.curvature).mean()) * area < DEVELOPABLE


def tessellate(faces: list[TopoDS_Face], tolerances: Tolerances) -> Tessellation:
    """Triangles of the faces, their shared edges divided once for both sides.

    Raises
    ------
    MouldError
        If a face's outline cannot be triangulated, or the tolerances ask for more triangles than can be draped.
    """
    patches = [Patch(face, n) for n, face in enumerate(faces)]
    developable = np.array([is_developable(patch) for patch in patches])
    for patch, flat in zip(patches, developable, strict=True):
        grid = np.stack(np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5)), -1).reshape(-1, 2)
        there = patch.nodes((patch.bounds[0] + grid * (patch.bounds[1] - patch.bounds[0])) * patch.scale).position
        extent = float(np.linalg.norm(np.ptp(there, axis=0)))
        patch.length = extent if flat else extent / FEWEST_LENGTHS
        patch.angle = tolerances.angle if flat else tolerances.gauss_angle
    edges = EdgeNodes(patches, tolerances)
    outlines = [edges.outline(n) for n in range(len(patches))]
    triangles, first = [], 0
    for n, outline in enumerate(outlines):
        triangles.append(_ears(outline, n) + first)
        first += len(outline.nodes.uv)
    number = np.concatenate([outline.node for outline in outlines])
    facets = Facets(Nodes.joined([outline.nodes for outline in outlines]), np.concatenate(triangles))
    facets.flip_to_delaunay()

    def evaluate(face: Ints, uv: Floats) -> Nodes:
        order = np.argsort(face, kind="stable")
        parts = [patches[f].nodes(uv[face == f]) for f in np.unique(face)]
        return Nodes.joined(parts).take(np.argsort(order, kind="stable"))

    facets.split_long_edges(_limit(developable, tolerances), evaluate, MOST_TRIANGLES)
    # nodes inside the faces come after those of the edges, which the faces share
    inner = len(edges.position) + np.arange(len(facets.nodes.uv) - len(number))
    vertices = np.vstack([edges.position, facets.nodes.position[len(number) :]])
    corners = np.concatenate([number, inner])[facets.triangles]
    # at a pole an edge is a point, and a triangle on it nothing
    whole = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    face = facets.nodes.face[facets.triangles[whole, 0]]
    return Tessellation(vertices, corners[whole], face, developable)


def _limit(developable: NDArray[np.bool_], tolerances: Tolerances) -> Any:
    """How many times too long inner edges are; a developable face's only where they turn across its rulings."""

    def limit(facets: Facets, edge: Ints) -> Floats:
        a, b, c, d = facets._quad(edge)
        nodes = facets.nodes
        metric, step = (nodes.metric[a] + nodes.metric[b]) / 2, nodes.uv[a] - nodes.uv[b]
        length = _measured(metric, step)
        # half the sum of the end tangents' difference: how the face's own middle lies off the chord's
        off = np.einsum("kij,ki->kj", nodes.tangent[a] - nodes.tangent[b], step) / 8
        tangent = (nodes.tangent[a] + nodes.tangent[b]) / 2
        sag = np.abs(np.einsum("kj,kj->k", off, (nodes.normal[a] + nodes.normal[b]) / 2))
        drift = _measured(metric, _in_parameters(tangent, off))
        area = np.sqrt(np.maximum(metric[:, 0] * metric[:, 2] - metric[:, 1] ** 2, 0.0))
        height = np.minimum(
            *(
                np.abs(step[:, 0] * (nodes.uv[z] - nodes.uv[a])[:, 1] - step[:, 1] * (nodes.uv[z] - nodes.uv[a])[:, 0])
                * area
                / np.maximum(length, 1e-30)
                for z in (c, d)
            )
        )
        size = np.maximum(length, np.sqrt(sag / tolerances.chord))
        size = np.maximum(size, np.sqrt(drift / np.minimum(DRIFT, HEIGHT * height + 1e-12)))
        for pole, other in ((a, b), (b, a)):
            # at a pole the parameters say nothing: the way there is measured from the other end
            k = np.flatnonzero(nodes.singular[pole])
            way = nodes.position[pole[k]] - nodes.position[other[k]]
            size[k] = _measured(nodes.metric[other[k]], _in_parameters(nodes.tangent[other[k]], way))
            length[k] = 0.0
        turn = np.where(length > 0, np.linalg.norm(nodes.normal[a] - nodes.normal[b], axis=1), 0.0)
        return np.where(developable[nodes.face[a]], turn / tolerances.angle / 2, size)

    return limit


def _measured(metric: Floats, step: Floats) -> Floats:
    """Length of parameter steps (k, 2) in a metric (k, 3)."""
    u, v = step[:, 0], step[:, 1]
    return np.asarray(
        np.sqrt(np.maximum(metric[:, 0] * u**2 + 2 * metric[:, 1] * u * v + metric[:, 2] * v**2, 0.0))
    )


def _in_parameters(tangent: Floats, vector: Floats) -> Floats:
    """Parameter steps (k, 2) that come nearest to vectors (k, 3), given the tangents (k, 2, 3)."""
    e, f, g = (np.einsum("kj,kj->k", tangent[:, i], tangent[:, j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    p, q = (np.einsum("kj,kj->k", vector, tangent[:, i]) for i in (0, 1))
    area2 = np.maximum(e * g - f * f, 1e-300)
    return np.stack([(g * p - f * q) / area2, (e * q - f * p) / area2], axis=1)


def _ears(outline: Outline, face: int) -> Ints:
    """Triangles over an outline in the parameters, without a node inside."""
    import mapbox_earcut

    uv = outline.nodes.uv
    bowed = np.empty_like(uv)
    start = 0
    for end in outline.ring_end.tolist():
        bowed[start:end] = _bowed(uv[start:end])
        start = end
    ears = np.asarray(
        mapbox_earcut.triangulate_float64(bowed, outline.ring_end.astype(np.uint32)), dtype=np.int64
    ).reshape(-1, 3)
    one, two = uv[ears[:, 1]] - uv[ears[:, 0]], uv[ears[:, 2]] - uv[ears[:, 0]]
    area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    if area.sum() < 0:
        ears, area = ears[:, ::-1].copy(), -area
    if len(ears) != len(uv) + 2 * (len(outline.ring_end) - 1) - 2 or area.min() < 0:
        msg = f"the outline of CAD face {face + 1} crosses itself; mend the face in CAD, or leave it out with --faces"
        raise MouldError(msg)
    return ears


def _bowed(ring: Floats) -> Floats:
    """A ring whose straight runs of nodes bulge a little outward, so that an ear cutter keeps every node of them."""
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
    corners = np.flatnonzero(np.abs(turn) >= BOW)
    out = ring.copy()
    for n, corner in enumerate(corners.tolist()):
        following = int(corners[(n + 1) % len(corners)])
        count = (following - corner) % len(ring) or len(ring)
        between = (corner + np.arange(1, count)) % len(ring)
        run = ring[following] - ring[corner]
        if not len(between) or not run.any():
            continue
        share = ((ring[between] - ring[corner]) @ run) / (run @ run)
        out[between] += BOW * (share * (1 - share))[:, None] * np.array([-run[1], run[0]])
    return out
