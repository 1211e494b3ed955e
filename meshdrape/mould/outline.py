"""Nodes along the edges of CAD faces, and the outlines they make in the parameters of each face.

An edge is divided once, for all faces it bounds, so faces share their nodes and nothing has to be welded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from meshdrape.mould.patch import Floats, Ints, Nodes, Patch

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Edge

CREASE = np.radians(1.0)  # faces that meet at less than this angle meet smoothly
MOST_PROBES = 33  # places where an undivided edge is looked at; a quarter of a segment once it is divided
FEWEST_PROBES = 5
MOST_HALVINGS = 20
POLE_SEGMENTS = 8  # of an edge that is one point, as at the pole of a sphere
EDGE_END = 1 / 64  # probes keep this share away from the ends, where the curve may have a kink


@dataclass(frozen=True)
class Tolerances:
    """How far facets may depart from the CAD faces: mm and rad.

    ``angle`` holds for creases and developable faces, ``gauss_angle`` for everything else.
    """

    chord: float
    angle: float
    gauss_angle: float


@dataclass(frozen=True)
class Passage:
    """One passage of a face's outline along a CAD edge."""

    edge: TopoDS_Edge
    key: int
    patch: Patch
    pcurve: Any
    reversed: bool
    degenerate: bool


@dataclass(frozen=True)
class Outline:
    """The outline of one face: nodes counter-clockwise round it, clockwise round its holes.

    ``ring_end`` counts the nodes up to the end of each ring, the outer one first; ``node`` is the global number of each node.
    """

    nodes: Nodes
    node: Ints
    ring_end: Ints


class EdgeNodes:
    """Numbers and places of the nodes on vertices and edges of a set of faces."""

    def __init__(self, patches: list[Patch], tolerances: Tolerances) -> None:
        from OCP.TopTools import TopTools_IndexedMapOfShape

        self.tolerances = tolerances
        self._edges = TopTools_IndexedMapOfShape()
        self._vertices = TopTools_IndexedMapOfShape()
        self.rings = [self._rings(patch) for patch in patches]
        passages: dict[int, list[Passage]] = {}
        for passage in (passage for rings in self.rings for ring in rings for passage in ring):
            passages.setdefault(passage.key, []).append(passage)
        self._parameter: dict[int, Floats] = {}
        self._node: dict[int, Ints] = {}
        self._ends: dict[int, tuple[int, int]] = {}
        positions = []
        for key, here in passages.items():
            if not here[0].degenerate:
                self._parameter[key] = divide(here, tolerances)
            self._ends[key] = self._end_vertices(here[0].edge)
        positions = [self._vertex_position(i + 1) for i in range(self._vertices.Extent())]
        for key, parameter in self._parameter.items():
            first, last = self._ends[key]
            inner = len(positions) + np.arange(len(parameter) - 2)
            positions.extend(_curve_points(passages[key][0].edge, parameter[1:-1]))
            self._node[key] = np.concatenate([[first], inner, [last]]).astype(np.int64)
        self.position = np.array(positions).reshape(-1, 3)

    def outline(self, index: int) -> Outline:
        """Outline of the face with this index."""
        parts: list[Nodes] = []
        numbers: list[Ints] = []
        ring_end: list[int] = []
        for ring in self.rings[index]:
            for passage in ring:
                if passage.degenerate:
                    ends = passage.pcurve.FirstParameter(), passage.pcurve.LastParameter()
                    parameter = np.linspace(*ends, POLE_SEGMENTS + 1)
                    number = np.full(len(parameter), self._ends[passage.key][0])
                else:
                    parameter, number = self._parameter[passage.key], self._node[passage.key]
                if passage.reversed:
                    parameter, number = parameter[::-1], number[::-1]
                parts.append(passage.patch.nodes(_uv(passage, parameter[:-1])))
                numbers.append(number[:-1])
            ring_end.append(sum(map(len, numbers)))
        return Outline(Nodes.joined(parts), np.concatenate(numbers), np.array(ring_end))

    def _rings(self, patch: Patch) -> list[list[Passage]]:
        from OCP.BRep import BRep_Tool
        from OCP.BRepAdaptor import BRepAdaptor_Curve2d
        from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
        from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
        from OCP.TopExp import TopExp_Explorer
        from OCP.TopoDS import TopoDS

        face = TopoDS.Face_s(patch.face.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        outer = BRepTools.OuterWire_s(face)
        wires = []
        explorer = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_WIRE)
        while explorer.More():
            wire = TopoDS.Wire_s(explorer.Current())
            wires.insert(0 if wire.IsSame(outer) else len(wires), wire)
            explorer.Next()
        rings = []
        for wire in wires:
            ring = []
            walk = BRepTools_WireExplorer(wire, face)
            while walk.More():
                edge = walk.Current()
                ring.append(
                    Passage(
                        edge,
                        self._edges.Add(edge),
                        patch,
                        BRepAdaptor_Curve2d(edge, face),
                        edge.Orientation() == TopAbs_Orientation.TopAbs_REVERSED,
                        BRep_Tool.Degenerated_s(edge),
                    )
                )
                walk.Next()
            rings.append(ring)
        return rings

    def _end_vertices(self, edge: TopoDS_Edge) -> tuple[int, int]:
        from OCP.TopAbs import TopAbs_Orientation
        from OCP.TopExp import TopExp
        from OCP.TopoDS import TopoDS

        forward = TopoDS.Edge_s(edge.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
        first, last = (
            self._vertices.Add(v) - 1 for v in (TopExp.FirstVertex_s(forward), TopExp.LastVertex_s(forward))
        )
        return first, last

    def _vertex_position(self, key: int) -> tuple[float, float, float]:
        from OCP.BRep import BRep_Tool
        from OCP.TopoDS import TopoDS

        return BRep_Tool.Pnt_s(TopoDS.Vertex_s(self._vertices.FindKey(key))).Coord()


def divide(passages: list[Passage], tolerances: Tolerances) -> Floats:
    """Parameters of the nodes on an edge, ends included, ascending.

    Segments are halved until the chord stays within the chord tolerance, its direction within half the angle
    tolerance of the edge's, and none is longer than a unit in the metric of a face beside it. Halving in the
    parameter puts matching nodes on the two rims of a ruled face.
    """
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_Shape
    from OCP.TColStd import TColStd_Array1OfReal

    curve = BRepAdaptor_Curve(passages[0].edge)
    breaks = TColStd_Array1OfReal(1, curve.NbIntervals(GeomAbs_Shape.GeomAbs_C1) + 1)
    curve.Intervals(breaks, GeomAbs_Shape.GeomAbs_C1)
    nodes = np.array([breaks.Value(i) for i in range(1, breaks.Length() + 1)])
    segments = np.column_stack([nodes[:-1], nodes[1:]])
    turn = tolerances.angle if _is_crease(passages, nodes) else tolerances.gauss_angle
    done = [nodes]
    for level in range(MOST_HALVINGS):
        probes = np.linspace(EDGE_END, 1 - EDGE_END, max(FEWEST_PROBES, (MOST_PROBES >> level) | 1))
        at = segments[:, :1] + (segments[:, 1:] - segments[:, :1]) * probes
        split = _leaves_chord(curve, segments, at, tolerances.chord, turn / 2)
        for passage in passages:
            split |= _metric_length(passage, at) > 1.0
        segments = segments[split]
        if not len(segments):
            break
        middle = segments.mean(axis=1)
        done.append(middle)
        segments = np.vstack(
            [np.column_stack([segments[:, 0], middle]), np.column_stack([middle, segments[:, 1]])]
        )
    return np.sort(np.concatenate(done))


def _is_crease(passages: list[Passage], ends: Floats) -> bool:
    """Whether two faces meet along the edge at an angle somewhere."""
    if len(passages) < 2:
        return False
    from OCP.TopAbs import TopAbs_Orientation

    at = np.linspace(ends[0], ends[-1], 9)[1:-1]
    normals = []
    for passage in passages[:2]:
        flip = passage.patch.face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        normals.append(passage.patch.nodes(_uv(passage, at)).normal * (-1 if flip else 1))
    return bool(np.any(np.linalg.norm(normals[0] - normals[1], axis=1) > CREASE))


def _leaves_chord(curve: Any, segments: Floats, at: Floats, chord_tolerance: float, direction: float) -> Any:
    """Whether a segment leaves its chord by more than the tolerance, or differs in direction, shape (s,)."""
    from OCP.gp import gp_Pnt, gp_Vec

    point, derivative = gp_Pnt(), gp_Vec()
    rows = []
    for t in np.column_stack([segments[:, :1], at, segments[:, 1:]]).ravel().tolist():
        curve.D1(t, point, derivative)
        rows.append(point.Coord() + derivative.Coord())
    values = np.array(rows).reshape(len(segments), -1, 2, 3)
    start, end = values[:, 0, 0], values[:, -1, 0]
    chord = end - start
    length = np.linalg.norm(chord, axis=1)
    along = chord / np.maximum(length, np.finfo(float).tiny)[:, None]
    offset = values[:, 1:-1, 0] - start[:, None]
    aside = offset - np.einsum("spi,si->sp", offset, along)[..., None] * along[:, None]
    speed = np.linalg.norm(values[:, 1:-1, 1], axis=2)
    cosine = np.einsum("spi,si->sp", values[:, 1:-1, 1], along) / np.where(speed > 0, speed, 1.0)
    turned = (cosine < np.cos(direction)) & (speed > 0)
    return (np.linalg.norm(aside, axis=2) > chord_tolerance).any(axis=1) | turned.any(axis=1)


def _metric_length(passage: Passage, at: Floats) -> Floats:
    """Length of segments on a face in its metric, shape (s,)."""
    nodes = passage.patch.nodes(_uv(passage, at.ravel()))
    uv, metric = nodes.uv.reshape(*at.shape, 2), nodes.metric.reshape(*at.shape, 3)
    step, metric = np.diff(uv, axis=1), (metric[:, 1:] + metric[:, :-1]) / 2
    square = (
        metric[..., 0] * step[..., 0] ** 2
        + 2 * metric[..., 1] * step.prod(axis=2)
        + metric[..., 2] * step[..., 1] ** 2
    )
    length: Floats = np.sqrt(np.maximum(square, 0.0)).sum(axis=1)
    return length


def _uv(passage: Passage, parameter: Floats) -> Floats:
    """Scaled parameters on the face at parameters of the edge, shape (n, 2)."""
    points = [passage.pcurve.Value(t).Coord() for t in parameter.tolist()]
    return np.array(points).reshape(-1, 2) * passage.patch.scale


def _curve_points(edge: TopoDS_Edge, parameter: Floats) -> list[tuple[float, float, float]]:
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    return [curve.Value(t).Coord() for t in parameter.tolist()]
