"""Hat: a hemisphere on a flat rim, joined by a fillet, cloth on the outside; the classic forming test.

The rim lies in the plane z = 0 with the sphere's centre in its middle. The fillet is the inner part of a torus:
its tube of radius r has its centre at z = r, rho = sqrt(R^2 + 2 R r) from the axis; it leaves the dome at the
elevation a, sin a = r / (R + r), and the rim at rho. The dome's face has its poles and its seam outside itself.

Lengths in millimetres. Facts, exact, with R = 100, r = 20 and a rim of radius 200 mm:

:Area: dome: 2 π R² (1 - sin a) = 52359.878 mm²; fillet: 2 π r (rho (π/2 - a) - r (1 - sin a)) = 18771.611 mm²; rim:
    π (200² - rho²) = 81681.409 mm²
:Gaussian curvature: 1/R² = 1e-4 mm⁻² on the dome, 0 on the rim, negative on the fillet; 2π (1 - sin a) in all on the
    dome, the opposite on the fillet
:Flat length: 250.080 mm from the top to the rim's border along any meridian
:Shear: on the dome that of the hemisphere: 14.27443° at fabric coordinates u = v = R / 2 from the top
:Source: surfaces of revolution; on the dome the smooth limit of the Chebyshev net, σ_uv = -K sin σ, in closed form
"""

from __future__ import annotations

from math import asin, cos, pi, sin, sqrt

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

radius = 100.0  # R, of the dome
fillet_radius = 20.0  # r, between dome and rim
rim_radius = 200.0  # of the rim's border


def build(
    *, radius: float = radius, fillet_radius: float = fillet_radius, rim_radius: float = rim_radius
) -> cq.Workplane:
    """Build the open shell of ``dome``, ``fillet`` and ``rim``, normals up and out."""
    for name, size in (("radius", radius), ("fillet_radius", fillet_radius)):
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if fillet_radius > 20 * radius:
        msg = f"fillet_radius={fillet_radius}: must be at most {20 * radius:g}, or nothing of the dome is left"
        raise ValueError(msg)
    foot = sqrt(radius**2 + 2 * radius * fillet_radius)
    if not rim_radius > foot:
        msg = f"rim_radius={rim_radius}: must be larger than {foot:.3f}, where the fillet ends"
        raise ValueError(msg)
    leave = asin(fillet_radius / (radius + fillet_radius))

    def on_fillet(angle: float) -> tuple[float, float]:
        return foot - fillet_radius * cos(angle), fillet_radius * (1 - sin(angle))

    base = (
        cq.Workplane("XZ")
        .moveTo(0, -radius)
        .lineTo(rim_radius, -radius)
        .lineTo(rim_radius, 0)
        .lineTo(foot, 0)
        .threePointArc(on_fillet((leave + pi / 2) / 2), on_fillet(leave))
        .lineTo(0, on_fillet(leave)[1])
        .close()
        .revolve(360, (0, 0, 0), (0, 1, 0))
        .val()
    )
    axes = gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 1, 0), gp_Dir(0, 0, -1))
    ball = cq.Solid(BRepPrimAPI_MakeSphere(axes, radius).Solid())
    room = cq.Solid.makeBox(2 * radius, 2 * radius, radius, cq.Vector(-radius, -radius, on_fillet(leave)[1]))
    tool = base.fuse(ball.intersect(room))
    faces = [
        next(
            face
            for face in tool.Faces()
            if face.geomType() in kinds and face.normalAt().z > 0.5 * (kinds == ("PLANE",))
        )
        # a fillet wider than the hole it leaves is no torus to the kernel
        for kinds in (("SPHERE",), ("TORUS", "REVOLUTION"), ("PLANE",))
    ]
    shape = cq.Workplane(cq.Shell.makeShell(faces))
    for name, face in zip(("dome", "fillet", "rim"), shape.val().Faces(), strict=True):
        shape.newObject([face]).tag(name)
    return shape


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
