"""Generic double-curved mould of Krogh et al.: a cubic height field over a square, cloth on top.

With x, y and z in metres, 0 <= x, y <= 0.5::

    z = 1.004 x + 1.089 y - 3.667 x^2 - 4.4 x y - 3.75 y^2 + 3.086 x^3 + 8.889 x^2 y + 4.321 y^3

A polynomial of degree 3 in x and in y is a bicubic Bezier patch: the face is exact, not fitted.

Lengths in millimetres. Facts, exact, with a side of 500 mm:

:Area: 287371.724 mm²
:Gaussian curvature: both signs, -1.00550173e-6 mm⁻² at (250, 250), from -27.585e-6 to 37.050e-6 mm⁻²
:Flat length: none, the surface is not developable; corners at z = 0, -29, 147.125 and 129.25 mm for (x, y) =
    (0, 0), (500, 0), (0, 500) and (500, 500), 39.3125 mm at (250, 250)
:Shear: no closed form
:Source: Krogh et al. 2021, doi 10.1007/s00158-021-02925-z
"""

from __future__ import annotations

from math import comb

import cadquery as cq
import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt

side = 500.0  # of the square in x and y


def build(*, side: float = side) -> cq.Workplane:
    """Build the patch, one bicubic face with its normal towards +z."""
    if not side > 0:
        msg = f"side={side}: must be positive"
        raise ValueError(msg)
    height = np.array(  # factor of x^i y^j, metres
        [
            [0.0, 1.089, -3.75, 4.321],
            [1.004, -4.4, 0.0, 0.0],
            [-3.667, 8.889, 0.0, 0.0],
            [3.086, 0.0, 0.0, 0.0],
        ]
    )
    scale = (side / 1000.0) ** np.arange(4)  # to the unit square
    to_bernstein = np.array([[comb(i, j) / comb(3, j) for j in range(4)] for i in range(4)])
    z = 1000.0 * to_bernstein @ (height * np.outer(scale, scale)) @ to_bernstein.T

    pole = TColgp_Array2OfPnt(1, 4, 1, 4)
    for i in range(4):
        for j in range(4):
            pole.SetValue(i + 1, j + 1, gp_Pnt(i * side / 3, j * side / 3, float(z[i, j])))
    # The tolerance of MakeFace only tells it which edges of the patch have shrunk to a point.
    face = cq.Face(BRepBuilderAPI_MakeFace(Geom_BezierSurface(pole), 1e-6).Face())
    return cq.Workplane(face)


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
