"""Saddle: z = x^2 / (2 p) - y^2 / (2 q) over a rectangle centred on the origin, cloth on top.

A polynomial of degree 2 in x and in y is a biquadratic Bezier patch: the face is exact, not fitted. The parabolas
x = 0 and y = 0 are geodesics by symmetry, and so are, where p = q, the two straight lines x = ±y.

Lengths in millimetres. Facts, exact, with p = q = 1000 mm over a square of 2400 mm:

:Area: ∬ √(1 + x²/p² + y²/q²) dx dy = 7967499.080 mm²
:Gaussian curvature: -1 / (p q (1 + x²/p² + y²/q²)²), -1e-6 mm⁻² at the centre
:Flat length: 2890.433 mm along x = 0 and y = 0; 3394.113 mm along the straight lines x = ±y
:Shear: started along the lines x = ±y it is the hyperbolic paraboloid z = x y / p turned by 45°: -26.66743° at fabric
    coordinates (1000, 1000) mm (cells open), the node there at (1078.4965, 0, 581.5774) mm
:Source: smooth limit of the Chebyshev net, σ_uv = -K sin σ, solved to more digits than printed
"""

from __future__ import annotations

import cadquery as cq
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt

radius_x = 1000.0  # p, of curvature at the centre, upwards along x
radius_y = 1000.0  # q, downwards along y
length = 2400.0  # of the rectangle, along x
width = 2400.0  # along y


def build(
    *, radius_x: float = radius_x, radius_y: float = radius_y, length: float = length, width: float = width
) -> cq.Workplane:
    """Build the patch, one biquadratic face with its normal towards +z."""
    sizes = {"radius_x": radius_x, "radius_y": radius_y, "length": length, "width": width}
    for name, size in sizes.items():
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    x, y = length / 2, width / 2
    pole = TColgp_Array2OfPnt(1, 3, 1, 3)
    for i in range(3):
        for j in range(3):
            # t² over [-1, 1] has the Bernstein factors 1, -1, 1
            z = (-1) ** i * x**2 / (2 * radius_x) - (-1) ** j * y**2 / (2 * radius_y)
            pole.SetValue(i + 1, j + 1, gp_Pnt((i - 1) * x, (j - 1) * y, z))
    # The tolerance of MakeFace only tells it which edges of the patch have shrunk to a point.
    return cq.Workplane(cq.Face(BRepBuilderAPI_MakeFace(Geom_BezierSurface(pole), 1e-6).Face()))


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
