"""Hemisphere: the dome z = sqrt(R^2 - x^2 - y^2) on the plane z = 0, cloth on the outside.

A sphere has no flat pattern: the net shears from the first cell on. The dome is two spherical faces that meet
in the arch y = 0. Each has the poles of its own coordinates well outside it, so that no tessellator collapses
triangles there, as happens at the pole of a sphere made in one piece.

Lengths in millimetres. Facts, exact, with R = 500 mm:

:Area: 2 π R² = 1570796.327 mm²
:Gaussian curvature: 1/R² = 4e-6 mm⁻² everywhere
:Flat length: π R / 2 = 785.398 mm from the top to the rim along any great circle
:Shear: fibres started from the top along two great circles at right angles: 90° - W(u v / R²) at fabric
    coordinates u, v, where (t W')' = -sin W, W(0) = π/2; on the diagonal u = v: 2.29163° at 0.2 R,
    14.27443° at 0.5 R, 54.31828° at R; the net locks at u v = 1.8615917 R²
:Source: smooth limit of the Chebyshev net, σ_uv = -K sin σ, in closed form
"""

from __future__ import annotations

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

radius = 500.0  # R


def build(*, radius: float = radius) -> cq.Workplane:
    """Build the open shell of two faces, normals away from the centre."""
    if not radius > 0:
        msg = f"radius={radius}: must be positive"
        raise ValueError(msg)
    # Poles towards y = -z and the seam behind both: neither meets the quarter y > 0, z > 0.
    axes = gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 1, -1), gp_Dir(0, -1, -1))
    ball = cq.Solid(BRepPrimAPI_MakeSphere(axes, radius).Solid())
    quarter = ball.intersect(cq.Solid.makeBox(2 * radius, radius, radius, cq.Vector(-radius, 0, 0)))
    near = quarter.face("%SPHERE")
    return cq.Workplane(cq.Shell.makeShell([near, near.mirror("XZ")]))


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
