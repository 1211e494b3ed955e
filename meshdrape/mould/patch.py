"""What tessellation asks of a CAD face: its points, normals and fundamental forms."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SINGULAR = 1e-9  # |Su x Sv| below this share of |Su|^2 + |Sv|^2: a pole, an apex, an edge shrunk to a point
ASIDE = 1e-4  # how far towards the middle of the face its forms are taken there, as a share of the parameters


@dataclass
class Nodes:
    """Nodes on CAD faces; a node belongs to one face and to one side of a seam.

    Attributes
    ----------
    face : (k,) int
        Index of the CAD face.
    uv : (k, 2) float
        Parameters on the face, scaled so that both are roughly millimetres.
    position, normal : (k, 3) float
        Point in mm; unit normal Su x Sv, whichever way the face is turned.
    tangent : (k, 2, 3) float
        Derivatives Su, Sv by the scaled parameters.
    metric : (k, 3) float
        M_uu, M_uv, M_vv of the metric of :mod:`meshdrape.mould.facets`.
    curvature : (k,) float
        Gaussian curvature, 1/mm^2.
    """

    face: Ints
    uv: Floats
    position: Floats
    normal: Floats
    tangent: Floats
    metric: Floats
    curvature: Floats
    singular: NDArray[np.bool_]

    def take(self, index: Ints) -> Nodes:
        """Nodes at the given places."""
        return Nodes(*(getattr(self, field.name)[index] for field in fields(self)))

    @staticmethod
    def joined(parts: list[Nodes]) -> Nodes:
        """All nodes of the parts, one after the other."""
        return Nodes(
            *(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Nodes))
        )


class Patch:
    """One CAD face, ready to be evaluated at many points.

    Parameters
    ----------
    face
        The face; its location is applied, its orientation is not.
    index
        What :attr:`Nodes.face` is to say.
    """

    def __init__(self, face: TopoDS_Face, index: int) -> None:
        from OCP.BRepAdaptor import BRepAdaptor_Surface
        from OCP.BRepTools import BRepTools
        from OCP.gp import gp_Pnt, gp_Vec

        self.face = face
        self.index = index
        self.surface = BRepAdaptor_Surface(face)
        self.length = self.angle = 1.0
        self._point, self._vectors = gp_Pnt(), [gp_Vec() for _ in range(5)]
        u0, u1, v0, v1 = BRepTools.UVBounds_s(face)
        self.bounds = np.array([[u0, v0], [u1, v1]])
        self.scale = np.ones(2)
        grid = np.array([[1, 1], [1, 3], [3, 1], [3, 3]]) / 4
        derivatives = self._evaluate(self.bounds[0] + grid * (self.bounds[1] - self.bounds[0]))
        self.scale = np.linalg.norm(derivatives[:, 1:3], axis=2).mean(axis=0)

    def _evaluate(self, uv: Floats) -> Floats:
        """S, Su, Sv, Suu, Svv, Suv at unscaled parameters, shape (k, 6, 3)."""
        evaluate, point, vectors = self.surface.D2, self._point, self._vectors
        su, sv, suu, svv, suv = vectors
        rows = []
        for u, v in uv.tolist():
            evaluate(u, v, point, su, sv, suu, svv, suv)
            rows.append(point.Coord() + su.Coord() + sv.Coord() + suu.Coord() + svv.Coord() + suv.Coord())
        return np.array(rows).reshape(-1, 6, 3)

    def nodes(self, uv: Floats) -> Nodes:
        """Nodes at scaled parameters, shape (k, 2)."""
        values = self._evaluate(uv / self.scale)
        position = values[:, 0].copy()
        normal = np.cross(values[:, 1], values[:, 2])
        singular = np.linalg.norm(normal, axis=1) <= SINGULAR * (values[:, 1:3] ** 2).sum(axis=(1, 2))
        if singular.any():
            aside = uv[singular] / self.scale
            aside += ASIDE * (self.bounds.mean(axis=0) - aside)
            values[singular] = self._evaluate(aside)
            normal = np.cross(values[:, 1], values[:, 2])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        tangent = values[:, 1:3] / self.scale[:, None]
        second = np.stack(
            [
                values[:, 3] / self.scale[0] ** 2,
                values[:, 5] / self.scale.prod(),
                values[:, 4] / self.scale[1] ** 2,
            ],
            axis=1,
        )
        first_form = np.stack(
            [
                _dot(tangent[:, 0], tangent[:, 0]),
                _dot(tangent[:, 0], tangent[:, 1]),
                _dot(tangent[:, 1], tangent[:, 1]),
            ],
            axis=1,
        )
        second_form = np.einsum("kij,kj->ki", second, normal)
        area = first_form[:, 0] * first_form[:, 2] - first_form[:, 1] ** 2
        gauss = (second_form[:, 0] * second_form[:, 2] - second_form[:, 1] ** 2) / area
        twice_mean = (
            first_form[:, 0] * second_form[:, 2]
            - 2 * first_form[:, 1] * second_form[:, 1]
            + first_form[:, 2] * second_form[:, 0]
        ) / area
        third_form = twice_mean[:, None] * second_form - gauss[:, None] * first_form
        metric = first_form / self.length**2 + third_form / self.angle**2
        return Nodes(np.full(len(uv), self.index), uv, position, normal, tangent, metric, gauss, singular)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("ij,ij->i", a, b)
