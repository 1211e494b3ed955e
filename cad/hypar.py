"""Hyperbolic paraboloid: the saddle z = k x y over a square centred on the origin, cloth on top.

The lines x = const and y = const are straight and lie in the surface; the two through the origin cross at
right angles and are the natural start fibres. The face is exact, a bilinear patch. Its straight borders are
divided into short edges: a tessellator puts no vertex inside a straight edge, and would else leave fans of
slivers there whose normals are many degrees off.

Lengths in millimetres. Facts, exact, with k = 0.001 mm⁻¹ and a side of 2600 mm:

:Area: ∬ √(1 + k² (x² + y²)) dx dy = 9719334.434 mm²
:Gaussian curvature: -k² / (1 + k² (x² + y²))², -1e-6 mm⁻² at the centre
:Flat length: 2600 mm along x = 0 and y = 0, 4264.317 mm along each side
:Shear: -26.66743° at fabric coordinates (1000, 1000) mm from the two lines through the origin (cells open),
    the node there at (762.6122, 762.6122, 581.5774) mm
:Source: smooth limit of the Chebyshev net, σ_uv = -K sin σ, solved to more digits than printed
"""

from __future__ import annotations

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepLib import BRepLib
from OCP.Geom import Geom_BezierSurface
from OCP.Geom2d import Geom2d_Line
from OCP.gp import gp_Dir2d, gp_Pnt, gp_Pnt2d
from OCP.TColgp import TColgp_Array2OfPnt

k = 0.001  # 1/mm, twist of the surface
side = 2600.0  # of the square in x and y
border_edges = 32  # pieces of each side


def build(*, k: float = k, side: float = side, border_edges: int = border_edges) -> cq.Workplane:
    """Build the patch, one bilinear face with its normal towards +z."""
    if not side > 0:
        msg = f"side={side}: must be positive"
        raise ValueError(msg)
    if border_edges != int(border_edges) or border_edges < 1:
        msg = f"border_edges={border_edges}: must be a whole number, at least 1"
        raise ValueError(msg)
    corner = TColgp_Array2OfPnt(1, 2, 1, 2)
    for i, x in enumerate((-side / 2, side / 2), start=1):
        for j, y in enumerate((-side / 2, side / 2), start=1):
            corner.SetValue(i, j, gp_Pnt(x, y, k * x * y))
    surface = Geom_BezierSurface(corner)

    border = BRepBuilderAPI_MakeWire()
    for start, direction in (((0, 0), (1, 0)), ((1, 0), (0, 1)), ((1, 1), (-1, 0)), ((0, 1), (0, -1))):
        line = Geom2d_Line(gp_Pnt2d(*start), gp_Dir2d(*direction))
        for piece in range(int(border_edges)):
            ends = (piece / border_edges, (piece + 1) / border_edges)
            border.Add(BRepBuilderAPI_MakeEdge(line, surface, *ends).Edge())
    face = BRepBuilderAPI_MakeFace(surface, border.Wire(), True).Face()
    BRepLib.BuildCurves3d_s(face)
    return cq.Workplane(cq.Face(face))


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
