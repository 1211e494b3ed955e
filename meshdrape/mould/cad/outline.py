"""The outlines of CAD faces in their parameters, their nodes shared along common edges, cut into triangles.

An edge is divided once for all faces it bounds: what is one in the CAD file is one in the mesh, with nothing to
weld.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from meshdrape.mould.cad.edges import Passage, curve_points, divide
from meshdrape.mould.cad.patch import Floats, Ints, Nodes, Patch, Tolerances

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Edge

# Nodes of an outline of more than so many are moved aside while it is cut, by this share of the segments beside them.
MANY: Final = 3000
JOGGLE: Final = 1e-5
# Segments of an edge that is one point.
POLE_SEGMENTS: Final = 8
# rad; nodes that turn the outline by less lie on a straight side of it.
STRAIGHT: Final = 1e-5
# Straight sides are bent inwards by this share of their length while they are cut into triangles.
BEND: Final = 1e-5


@dataclass(frozen=True, eq=False)
class Outline:
    """The outline of one face.

    Attributes
    ----------
    nodes : Nodes
        Counter-clockwise round the face in (u, v), clockwise round its holes.
    number : (k,) int64
        Of each node among all nodes of the mould.
    ring_end : (r,) int64
        Count of the nodes up to the end of each ring, the outer one first.
    """

    nodes: Nodes
    number: Ints
    ring_end: Ints

    def triangles(self) -> Ints | None:
        """Return triangles between the nodes, counter-clockwise, (t, 3); None where the outline crosses itself.

        The triangles of an outline of fewer than three nodes are none.
        """
        uv = self.nodes.uv
        if len(uv) < 3:
            return np.empty((0, 3), dtype=np.int64)
        rings = np.split(np.arange(len(uv)), self.ring_end[:-1])
        bent = np.concatenate([_bent_inwards(uv[ring]) for ring in rings])
        doubled = abs(sum(_shoelace(uv[ring]) for ring in rings))
        cuts = (_joggled_cut, _delaunay_cut, _ear_cut) if len(uv) > MANY else (_delaunay_cut, _ear_cut)
        for cut in cuts:
            triangles = cut(bent, self.nodes.metric.mean(axis=0), self.ring_end)
            area = _doubled_area(uv[triangles])
            whole = len(triangles) == len(uv) + 2 * len(rings) - 4 and bool(np.isclose(area.sum(), doubled, rtol=1e-6))
            if whole and area.min() > 0:
                return triangles
        return None


class Outlines:
    """The outlines of the faces of a mould, with one numbering of their nodes.

    Attributes
    ----------
    position : (n, 3) float64
        Of the numbered nodes, mm.
    """

    def __init__(self, patches: list[Patch], tolerances: Tolerances) -> None:
        from OCP.TopTools import TopTools_IndexedMapOfShape

        self._edges = TopTools_IndexedMapOfShape()
        self._vertices = TopTools_IndexedMapOfShape()
        self._rings = [self._walk(patch) for patch in patches]
        passages: dict[int, list[Passage]] = {}
        for passage in (passage for rings in self._rings for ring in rings for passage in ring):
            passages.setdefault(passage.key, []).append(passage)
        self._edge = {key: here[0].edge for key, here in passages.items()}
        self._ends = {key: self._end_vertices(edge) for key, edge in self._edge.items()}
        self._parameter = {key: divide(here, tolerances) for key, here in passages.items() if not here[0].is_point}
        self._count()

    def outline(self, index: int) -> Outline:
        """Return the outline of the face of this index."""
        parts, numbers, ring_end = [], [], []
        for ring in self._rings[index]:
            for passage in ring:
                if passage.is_point:
                    ends = passage.curve.FirstParameter(), passage.curve.LastParameter()
                    parameter = np.linspace(*ends, POLE_SEGMENTS + 1)
                    number = np.full(len(parameter), self._ends[passage.key][0], dtype=np.int64)
                else:
                    parameter, number = self._parameter[passage.key], self._number[passage.key]
                if passage.backwards:
                    parameter, number = parameter[::-1], number[::-1]
                parts.append(passage.nodes(parameter[:-1]))
                numbers.append(number[:-1])
            ring_end.append(sum(map(len, numbers)))
        return Outline(Nodes.joined(parts), np.concatenate(numbers), np.array(ring_end, dtype=np.int64))

    def halve(self, index: int) -> None:
        """Put a node into the middle of every segment of the outline of a face."""
        for key in {passage.key for ring in self._rings[index] for passage in ring} & set(self._parameter):
            parameter = self._parameter[key]
            self._parameter[key] = np.sort(np.concatenate([parameter, (parameter[1:] + parameter[:-1]) / 2]))
        self._count()

    def _count(self) -> None:
        """Number the nodes: the vertices first, then those along each edge."""
        positions = [self._vertex_position(i + 1) for i in range(self._vertices.Extent())]
        self._number: dict[int, Ints] = {}
        for key, parameter in self._parameter.items():
            first, last = self._ends[key]
            along = len(positions) + np.arange(len(parameter) - 2)
            positions += curve_points(self._edge[key], parameter[1:-1])
            self._number[key] = np.concatenate([[first], along, [last]]).astype(np.int64)
        self.position: Floats = np.array(positions).reshape(-1, 3)

    def _walk(self, patch: Patch) -> list[list[Passage]]:
        """Passages along the rings of a face, the outer ring first."""
        from OCP.BRep import BRep_Tool
        from OCP.BRepAdaptor import BRepAdaptor_Curve2d
        from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
        from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS

        face = TopoDS.Face_s(patch.face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        outer = BRepTools.OuterWire_s(face)
        rings: list[list[Passage]] = []
        wires = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_WIRE)
        while wires.More():
            wire = TopoDS.Wire_s(wires.Current())
            ring = []
            edges = BRepTools_WireExplorer(wire, face)
            while edges.More():
                edge = edges.Current()
                backwards = edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
                curve = BRepAdaptor_Curve2d(edge, face)
                key = self._edges.Add(edge)
                ring.append(Passage(edge, key, patch, curve, backwards, BRep_Tool.Degenerated_s(edge)))
                edges.Next()
            rings.insert(0 if wire.IsSame(outer) else len(rings), ring)
            wires.Next()
        return rings

    def _end_vertices(self, edge: TopoDS_Edge) -> tuple[int, int]:
        """Numbers of the vertices where the parameter of an edge is least and greatest."""
        from OCP.TopAbs import TopAbs_Orientation
        from OCP.TopExp import TopExp
        from OCP.TopoDS import TopoDS

        forward = TopoDS.Edge_s(edge.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        first, last = TopExp.FirstVertex_s(forward), TopExp.LastVertex_s(forward)
        return self._vertices.Add(first) - 1, self._vertices.Add(last) - 1

    def _vertex_position(self, key: int) -> tuple[float, float, float]:
        from OCP.BRep import BRep_Tool
        from OCP.TopoDS import TopoDS

        return tuple(BRep_Tool.Pnt_s(TopoDS.Vertex_s(self._vertices.FindKey(key))).Coord())


def _bent_inwards(ring: Floats) -> Floats:
    """The ring with its straight sides bent inwards a little, (k, 2).

    A cut into triangles by ears drops nodes that lie on a straight side; on a side bent inwards it has to join
    each of them to nodes elsewhere.
    """
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
    corners = np.flatnonzero(np.abs(turn) > STRAIGHT)
    bent = ring.copy()
    ends = np.roll(corners, -1)
    between = (ends - corners - 1) % len(ring)
    straight = between > 0
    for corner, end, count in zip(corners[straight], ends[straight], between[straight], strict=True):
        side = (corner + np.arange(1, count + 1)) % len(ring)
        chord = ring[end] - ring[corner]
        share = (ring[side] - ring[corner]) @ chord / (chord @ chord)
        bent[side] += BEND * (share * (1 - share))[:, None] * np.array([-chord[1], chord[0]])
    return bent


def _delaunay_cut(uv: Floats, metric: Floats, ring_end: Ints, joggle: float = 0.0) -> Ints:
    """Delaunay triangles inside an outline, in one metric for all of it; those of a part if they cross its rings.

    Next to what is wanted in the end where the metric hardly varies: ears of a long strip make a fan that would
    have to be turned over diagonal by diagonal.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import Delaunay, QhullError

    uu, mixed, vv = metric
    stretched = uv @ np.linalg.cholesky(np.array([[uu, mixed], [mixed, vv]]) + 1e-12 * (uu + vv) * np.eye(2))
    n = len(uv)
    following = np.arange(1, n + 1)
    following[ring_end - 1] = np.concatenate([[0], ring_end[:-1]])
    after, before = np.linalg.norm(stretched[following] - stretched, axis=1), np.empty(n)
    before[following] = after
    aside = joggle * np.minimum(before, after)
    stretched += aside[:, None] * np.random.default_rng(0).uniform(-1.0, 1.0, (n, 2))
    try:
        found = Delaunay(stretched)
    except QhullError:
        return np.empty((0, 3), dtype=np.int64)
    triangles, beyond = found.simplices.astype(np.int64), found.neighbors  # neighbour k lies opposite corner k
    clockwise = _doubled_area(uv[triangles]) < 0
    triangles[clockwise], beyond[clockwise] = triangles[clockwise][:, ::-1], beyond[clockwise][:, ::-1]
    tail, head = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
    inside, outside = following[tail] == head, following[head] == tail
    linked = (beyond >= 0) & ~inside & ~outside
    graph = coo_array((np.ones(linked.sum()), (np.nonzero(linked)[0], beyond[linked])), shape=(len(triangles),) * 2)
    _, part = connected_components(graph, directed=False)
    wanted = np.zeros(part.max() + 1, dtype=bool)
    wanted[part[inside.any(axis=1)]] = True
    return np.ascontiguousarray(triangles[wanted[part]])


def _joggled_cut(uv: Floats, metric: Floats, ring_end: Ints) -> Ints:
    """The same of nodes moved aside a little.

    Nodes that face each other across a strip, or along an arc, lie on common circles. Qhull makes one polygon of
    those, which takes time with the square of their number.
    """
    return _delaunay_cut(uv, metric, ring_end, JOGGLE)


def _ear_cut(uv: Floats, metric: Floats, ring_end: Ints) -> Ints:
    """Triangles inside an outline, whatever its shape; too few or wrong ones if it crosses itself."""
    from mapbox_earcut import triangulate_float64

    del metric
    triangles = triangulate_float64(uv, ring_end.astype(np.uint32)).reshape(-1, 3).astype(np.int64)
    return np.ascontiguousarray(triangles if _doubled_area(uv[triangles]).sum() > 0 else triangles[:, ::-1])


def _shoelace(ring: Floats) -> float:
    """Twice the area inside a ring, positive if it runs counter-clockwise."""
    following = np.roll(ring, -1, axis=0)
    return float((ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]).sum())


def _doubled_area(corners: Floats) -> Floats:
    """Twice the signed area of triangles, (t, 3, 2) to (t,)."""
    (a, b), (c, d) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return np.asarray(a * d - b * c)
