"""What tessellation asks of a CAD face: its points, normals and fundamental forms at many places at once."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# |Su x Sv| below this share of |Su|^2 + |Sv|^2 is a pole: a rim shrunk to a point, as on a sphere or a cone.
SINGULAR: Final = 1e-9
# How far towards the middle of the face the forms of a pole are taken, as a share of the parameters.
ASIDE: Final = 1e-4
# Samples along each parameter that decide on the kind of a face.
SAMPLES: Final = 12
# rad; a face whose Gauss image is smaller unrolls flat for all that cloth could tell: no more shear than this.
FLATTEST: Final = 1e-4
# The image of a straight line of the parameters on its face may lie beside its chord by this much in the metric.
MOST_DRIFT: Final = 0.1
# A doubly curved face is looked at in at least so many places along its length.
FEWEST_LOOKS: Final = 8


@dataclass(frozen=True)
class Tolerances:
    """How far facets may depart from the CAD faces.

    Attributes
    ----------
    chord : float, mm
        Largest gap between a facet and the face.
    angle : float, rad
        Largest turn of the normal from node to node on developable faces, and of a crease from one segment to
        the next.
    """

    chord: float
    angle: float

    @property
    def gauss_angle(self) -> float:
        """Largest turn of the normal from node to node on doubly curved faces, rad.

        A crease misses its direction by half of ``angle`` at worst, and the shear of a cell is the difference of
        two such places. On a doubly curved face a cell is sheared by the defects of all vertices between it and
        the start fibres, and those that the net cuts through at the rim count wholly or not at all. With the
        curvature spread evenly that is a random sum: on spheres with nodes a apart it was measured as 0.3 a^1.5
        rad on average and a^1.5 at worst. So this angle keeps both to ``angle``.
        """
        return float(self.angle ** (2 / 3))


@dataclass(frozen=True, eq=False)
class Nodes:
    """Places on CAD faces; a node belongs to one face and to one side of a seam.

    Attributes
    ----------
    face : (k,) int64
        Index of the face.
    uv : (k, 2) float64
        Parameters on the face, scaled so that both are roughly millimetres.
    position, normal : (k, 3) float64
        Point in mm; unit normal Su x Sv, whichever way the face is turned.
    tangent : (k, 2, 3) float64
        Derivatives Su, Sv by the scaled parameters.
    metric : (k, 3) float64
        M_uu, M_uv, M_vv of the metric of :mod:`meshdrape.mould.cad.facets`.
    curvature : (k,) float64
        Gaussian curvature, 1/mm^2.
    pole : (k,) bool
        Whether the parameters have a pole here; the forms are then those beside it.
    """

    face: Ints
    uv: Floats
    position: Floats
    normal: Floats
    tangent: Floats
    metric: Floats
    curvature: Floats
    pole: Bools

    def __getitem__(self, index: Ints) -> Nodes:
        """Nodes at the given places."""
        return Nodes(*(getattr(self, field.name)[index] for field in fields(self)))

    def __len__(self) -> int:
        return len(self.face)

    @staticmethod
    def joined(parts: list[Nodes]) -> Nodes:
        """Return all nodes of the parts, one part after the other."""
        return Nodes(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Nodes)))


class Patch:
    """One CAD face, ready to be evaluated.

    Parameters
    ----------
    face : TopoDS_Face
        Its location is applied, its orientation is not.
    index : int
        What :attr:`Nodes.face` is to say.
    tolerances : Tolerances, optional
        They scale the metric, which is zero without.
    """

    def __init__(self, face: TopoDS_Face, index: int = 0, tolerances: Tolerances | None = None) -> None:
        from OCP.BRepAdaptor import BRepAdaptor_Surface
        from OCP.BRepTools import BRepTools
        from OCP.gp import gp_Pnt, gp_Vec
        from OCP.TopAbs import TopAbs_Orientation

        self.face = face
        self.index = index
        self.reversed = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        self.surface = BRepAdaptor_Surface(face)
        self._point, self._vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        self._bounds = np.array([[u0, v0], [u1, v1]])
        self.scale = np.ones(2)
        self._length = self.angle = np.inf
        self._follows_bends = False
        self.scale = np.linalg.norm(self._evaluate(self._grid())[:, 1:3], axis=2).mean(axis=0)
        self.scale[self.scale == 0] = 1.0
        if tolerances is None:
            return
        extent = float(np.linalg.norm(np.ptp(self.samples.position, axis=0)))
        self._length = extent if self.developable else extent / self._looks()
        self.angle = tolerances.angle if self.developable else tolerances.gauss_angle
        self._follows_bends = not self.developable

    @cached_property
    def samples(self) -> Nodes:
        """Nodes spread over the face; over its parameters, if none of those lie within its outline."""
        uv = self._grid()
        inside = self._inside(uv)
        return self.nodes(uv[inside if inside.any() else slice(None)] * self.scale)

    @cached_property
    def developable(self) -> bool:
        """Whether the face unrolls flat without stretching, to within what a net could tell."""
        samples = self.samples
        area = np.linalg.norm(np.cross(samples.tangent[:, 0], samples.tangent[:, 1]), axis=1)
        cell = np.prod(np.diff(self._bounds, axis=0) * self.scale) / SAMPLES**2
        return bool(np.sum(np.abs(samples.curvature) * area) * cell < FLATTEST)

    @property
    def extent(self) -> float:
        """Size of the face, mm, as its samples tell; infinite or NaN for one that goes on for ever."""
        return float(np.abs(np.ptp(self.samples.position, axis=0)).max() + np.abs(self.samples.position).max())

    def fewest_triangles(self, chord: float) -> float:
        """Triangles that a doubly curved face takes at least, within a factor of some ten.

        In a triangle of side l the gap is |K|^1/2 l^2 / 8 or more, and the metric allows sides of 1.
        """
        if self.developable:
            return 0.0
        samples = self.samples
        area = np.linalg.norm(np.cross(samples.tangent[:, 0], samples.tangent[:, 1]), axis=1)
        e, f, g = samples.metric.T
        by_angle = np.sqrt(np.maximum(e * g - f * f, 0.0))
        by_chord = area * np.sqrt(np.abs(samples.curvature)) / (8 * chord)
        cell = float(np.prod(np.diff(self._bounds, axis=0) * self.scale)) / SAMPLES**2
        return float(np.maximum(by_angle, by_chord).sum() * cell)

    @cached_property
    def middle(self) -> Nodes:
        """One node about the middle of the face: where its centre of mass projects, or the sample nearest to it."""
        from OCP.BRep import BRep_Tool
        from OCP.BRepGProp import BRepGProp
        from OCP.GProp import GProp_GProps
        from OCP.ShapeAnalysis import ShapeAnalysis_Surface

        properties = GProp_GProps()
        BRepGProp.SurfaceProperties_s(self.face, properties)
        centre = properties.CentreOfMass()
        uv = ShapeAnalysis_Surface(BRep_Tool.Surface_s(self.face)).ValueOfUV(centre, 1e-7)
        if self._inside(np.array([uv.Coord()]))[0]:
            return self.nodes(np.array([uv.Coord()]) * self.scale)
        away = np.linalg.norm(self.samples.position - np.array(centre.Coord()), axis=1)
        return self.samples[away.argmin(keepdims=True)]

    def nodes(self, uv: Floats) -> Nodes:
        """Return the nodes at scaled parameters, (k, 2)."""
        values = self._evaluate(uv / self.scale)
        position = values[:, 0].copy()
        normal = np.cross(values[:, 1], values[:, 2])
        pole = np.linalg.norm(normal, axis=1) <= SINGULAR * (values[:, 1:3] ** 2).sum(axis=(1, 2))
        if pole.any():
            aside = uv[pole] / self.scale
            values[pole] = self._evaluate(aside + ASIDE * (self._bounds.mean(axis=0) - aside))
            normal = np.cross(values[:, 1], values[:, 2])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None]
        tangent = values[:, 1:3] / self.scale[:, None]
        second = values[:, [3, 5, 4]] / np.array([self.scale[0] ** 2, self.scale.prod(), self.scale[1] ** 2])[:, None]
        first_form = np.einsum("kpi,kpi->kp", tangent[:, [0, 0, 1]], tangent[:, [0, 1, 1]])
        second_form = np.einsum("kpi,ki->kp", second, normal)
        (e, f, g), (k, m, n) = first_form.T, second_form.T
        area2 = np.maximum(e * g - f * f, np.finfo(float).tiny)
        gauss = (k * n - m * m) / area2
        twice_mean = (e * n - 2 * f * m + g * k) / area2
        third_form = twice_mean[:, None] * second_form - gauss[:, None] * first_form
        metric = first_form / self._length**2 + third_form / self.angle**2
        if self._follows_bends:
            metric = _with_bends(metric, tangent, second)
        return Nodes(np.full(len(uv), self.index), uv, position, normal, tangent, metric, gauss, pole)

    def _evaluate(self, uv: Floats) -> Floats:
        """S, Su, Sv, Suu, Svv, Suv at unscaled parameters, (k, 6, 3)."""
        evaluate, point, vectors = self.surface.D2, self._point, self._vectors
        su, sv, suu, svv, suv = vectors
        rows = []
        for u, v in uv.tolist():
            evaluate(u, v, point, su, sv, suu, svv, suv)
            rows.append(point.Coord() + su.Coord() + sv.Coord() + suu.Coord() + svv.Coord() + suv.Coord())
        return np.array(rows).reshape(-1, 6, 3)

    def _inside(self, uv: Floats) -> Bools:
        """Whether unscaled parameters lie within the outline of the face, (k,)."""
        from OCP.BRepTopAdaptor import BRepTopAdaptor_FClass2d
        from OCP.gp import gp_Pnt2d
        from OCP.TopAbs import TopAbs_State

        classifier = BRepTopAdaptor_FClass2d(self.face, 1e-7)
        return np.array([classifier.Perform(gp_Pnt2d(u, v)) != TopAbs_State.TopAbs_OUT for u, v in uv.tolist()])

    def _grid(self) -> Floats:
        """Middles of a grid of cells over the parameters, unscaled, (SAMPLES**2, 2)."""
        middle = (np.arange(SAMPLES) + 0.5) / SAMPLES
        grid = np.stack(np.meshgrid(middle, middle, indexing="ij"), axis=-1).reshape(-1, 2)
        return np.asarray(self._bounds[0] + grid * np.diff(self._bounds, axis=0))

    def _looks(self) -> int:
        """How many nodes along the face at least: one for each span of a spline, within reason."""
        from OCP.GeomAbs import GeomAbs_Shape

        spans = (
            self.surface.NbUIntervals(GeomAbs_Shape.GeomAbs_C2),
            self.surface.NbVIntervals(GeomAbs_Shape.GeomAbs_C2),
        )
        return int(min(max(FEWEST_LOOKS, *spans), 4 * FEWEST_LOOKS))


def _with_bends(metric: Floats, tangent: Floats, second: Floats) -> Floats:
    """The metric, longer along lines of the parameters that bend sideways on the face.

    The chord of such a line passes its middle beside it on the face, by an eighth of the tangential part of the second
    derivative. Where that is much of a unit, nodes may lie nearer to the line than its chord, and the facets between
    them face down: so along a fillet that runs out in a plane, whose normal does not turn there. A step that drifts
    by MOST_DRIFT of a unit is made one unit long.
    """
    drift = [metric_length(metric, in_parameters(tangent, second[:, p])) / 8 for p in (0, 2)]
    longer = metric.copy()
    longer[:, 0] += drift[0] / MOST_DRIFT
    longer[:, 2] += drift[1] / MOST_DRIFT
    return longer


def metric_length(metric: Floats, step: Floats) -> Floats:
    """Length of steps in (u, v), (k, 2), in the metric of nodes, (k, 3)."""
    du, dv = step.T
    return np.asarray(
        np.sqrt(np.maximum(metric[:, 0] * du**2 + 2 * metric[:, 1] * du * dv + metric[:, 2] * dv**2, 0.0))
    )


def in_parameters(tangent: Floats, vector: Floats) -> Floats:
    """Steps in (u, v) whose images are nearest to vectors in space, (k, 2)."""
    (su, sv), x = np.moveaxis(tangent, 1, 0), vector
    e, f, g = (np.einsum("ki,ki->k", p, q) for p, q in ((su, su), (su, sv), (sv, sv)))
    p, q = np.einsum("ki,ki->k", x, su), np.einsum("ki,ki->k", x, sv)
    area2 = np.maximum(e * g - f * f, np.finfo(float).tiny)
    return np.asarray(np.column_stack([g * p - f * q, e * q - f * p]) / area2[:, None])
