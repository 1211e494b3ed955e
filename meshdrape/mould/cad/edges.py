"""Where the nodes along a CAD edge go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from meshdrape.errors import MouldError
from meshdrape.mould.apart import step
from meshdrape.mould.cad.patch import Bools, Floats, Nodes, Patch, Tolerances
from meshdrape.mould.mesh.check import FARTHEST, at

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Edge

# rad; faces that meet at less than this are smooth across their edge: it turns no fibre.
CREASE: Final = np.radians(1.0)
# An undivided edge is looked at in many places, for a wave that its ends and middle do not show.
MOST_PROBES: Final = 33
FEWEST_PROBES: Final = 5
# Probes keep this share of a segment away from its ends, where the curve may have a kink.
ASIDE: Final = 1 / 64
# A strip between two such edges has a million triangles, half of the most there may be.
MOST_NODES: Final = 500_000
# mm; what is smaller is a point and not divided. The finest that Open CASCADE keeps apart from a point, the tip of a
# cone of 1e-7, is divided as finely as the rim across from it, or no facets between the two follow the face.
SHORTEST: Final = 1e-10


@dataclass(frozen=True, eq=False)
class Passage:
    """One passage of the outline of a face along a CAD edge.

    Attributes
    ----------
    edge : TopoDS_Edge
    key : int
        The same for all passages along an edge.
    patch : Patch
    curve : BRepAdaptor_Curve2d
        The edge in the face's parameters, on this side of a seam.
    backwards : bool
        Whether the outline runs against the edge.
    is_point : bool
        Whether the edge is one point, as at the pole of a sphere.
    """

    edge: TopoDS_Edge
    key: int
    patch: Patch
    curve: Any
    backwards: bool
    is_point: bool

    def nodes(self, parameter: Floats) -> Nodes:
        """Return the nodes on the face at parameters of the edge, (n,)."""
        uv = [self.curve.Value(t).Coord() for t in parameter.tolist()]
        return self.patch.nodes(np.array(uv).reshape(-1, 2) * self.patch.scale)


def divide(passages: list[Passage], tolerances: Tolerances) -> Floats:
    """Return the parameters of the nodes on an edge, its ends included, ascending.

    Segments are halved until the chord keeps within the chord tolerance and half the angle tolerance of the
    edge, and is no longer than a unit in the metric of the faces beside it. The angle is that of creases where
    the edge is one; a smooth edge turns no fibre. Halving the parameter puts nodes opposite each other on the
    two rims of a ruled face.

    Raises
    ------
    MouldError
        The tolerances ask for more nodes than any mould needs.
    """
    curve, segments = _smooth_pieces(passages[0].edge)
    turn = tolerances.angle if _is_crease(passages, segments) else tolerances.gauss_angle
    done = [segments[:, 0], segments[-1:, 1]]
    n_probes = MOST_PROBES
    while len(segments):
        step()
        probes = np.linspace(ASIDE, 1 - ASIDE, n_probes)
        probed = segments[:, :1] + np.diff(segments, axis=1) * probes
        pieces = _pieces(curve, segments, probed, tolerances.chord, turn / 2)
        if pieces.sum() + sum(map(len, done)) > MOST_NODES:
            begin = at(curve.Value(curve.FirstParameter()).Coord())
            msg = (
                f"the edge that begins at {begin} takes more than {MOST_NODES:,} nodes at these "
                f"tolerances; make them larger, or mend it in CAD"
            )
            raise MouldError(msg)
        split = pieces > 1.0
        for passage in passages:
            rest = np.flatnonzero(~split)
            split[rest] = _is_long(passage, probed[rest])
        segments = segments[split]
        middle = segments.mean(axis=1, keepdims=True)
        done.append(middle[:, 0])
        segments = np.stack([np.hstack([segments[:, :1], middle]), np.hstack([middle, segments[:, 1:]])]).reshape(-1, 2)
        n_probes = max(FEWEST_PROBES, n_probes // 2)
    return np.sort(np.concatenate(done))


def curve_points(edge: TopoDS_Edge, parameter: Floats) -> list[tuple[float, float, float]]:
    """Return the points of an edge at the given parameters, mm."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve

    curve = BRepAdaptor_Curve(edge)
    return [curve.Value(t).Coord() for t in parameter.tolist()]


def _smooth_pieces(edge: TopoDS_Edge) -> tuple[Any, Floats]:
    """The curve of an edge and the parameters between its kinks, (s, 2)."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_Shape
    from OCP.TColStd import TColStd_Array1OfReal

    curve = BRepAdaptor_Curve(edge)
    kinks = TColStd_Array1OfReal(1, curve.NbIntervals(GeomAbs_Shape.GeomAbs_C1) + 1)
    curve.Intervals(kinks, GeomAbs_Shape.GeomAbs_C1)
    at = np.array([kinks.Value(i) for i in range(1, kinks.Length() + 1)])
    return curve, np.column_stack([at[:-1], at[1:]])


def _is_crease(passages: list[Passage], segments: Floats) -> bool:
    """Whether two faces meet along the edge at an angle somewhere."""
    if len(passages) < 2:
        return False
    at = np.linspace(segments[0, 0], segments[-1, 1], 11)[1:-1]
    one, other = (passage.nodes(at).normal * (-1 if passage.patch.reversed else 1) for passage in passages[:2])
    return bool((np.linalg.norm(one - other, axis=1) > CREASE).any())


def _pieces(curve: Any, segments: Floats, at: Floats, chord_tolerance: float, direction: float) -> Floats:
    """Into how many pieces a segment has to be cut to keep to the chord tolerance and the angle, about, (s,)."""
    from OCP.gp import gp_Pnt, gp_Vec

    point, derivative = gp_Pnt(), gp_Vec()
    rows = []
    for t in np.hstack([segments[:, :1], at, segments[:, 1:]]).ravel().tolist():
        curve.D1(t, point, derivative)
        rows.append(point.Coord() + derivative.Coord())
    values = np.array(rows).reshape(len(segments), -1, 2, 3)
    # NaN fails the comparison too
    if not (np.abs(values[:, :, 0]) <= FARTHEST).all():
        msg = f"an edge goes on for more than {FARTHEST:g} mm; mend it in CAD"
        raise MouldError(msg)
    start, chord = values[:, 0, 0], values[:, -1, 0] - values[:, 0, 0]
    along = chord / np.maximum(np.linalg.norm(chord, axis=1), np.finfo(float).tiny)[:, None]
    offset, tangent = values[:, 1:-1, 0] - start[:, None], values[:, 1:-1, 1]
    aside = offset - np.einsum("spi,si->sp", offset, along)[..., None] * along[:, None]
    by_chord = np.sqrt(np.linalg.norm(aside, axis=2) / chord_tolerance)
    cosine = np.einsum("spi,si->sp", tangent, along)
    sine = np.linalg.norm(tangent - cosine[..., None] * along[:, None], axis=2)
    by_angle = np.arctan2(sine, cosine) / direction
    pieces = np.maximum(np.fmax(by_chord, by_angle).max(axis=1), 1.0)  # of a derivative beyond all measure nothing
    return np.where(_has_size(values[..., 0, :]), pieces, 1.0)


def _is_long(passage: Passage, at: Floats) -> Bools:
    """Whether segments are longer than a unit in the metric of a face, (s,)."""
    nodes = passage.nodes(at.ravel())
    uv, metric = nodes.uv.reshape(*at.shape, 2), nodes.metric.reshape(*at.shape, 3)
    (du, dv), (uu, uv_, vv) = (
        np.moveaxis(np.diff(uv, axis=1), 2, 0),
        np.moveaxis((metric[:, 1:] + metric[:, :-1]) / 2, 2, 0),
    )
    length = np.sqrt(np.maximum(uu * du**2 + 2 * uv_ * du * dv + vv * dv**2, 0.0)).sum(axis=1)
    return np.asarray((length > 1.0) & _has_size(nodes.position.reshape(*at.shape, 3)))


def _has_size(points: Floats) -> Bools:
    """Whether the points along a segment, (s, p, 3), do not all lie in one place, (s,)."""
    return np.asarray(np.linalg.norm(points - points[:, :1], axis=2).max(axis=1) > SHORTEST)
