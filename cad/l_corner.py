"""L-corner: two flat flanges joined by a fillet, the cloth outside the bend (convex) or inside it (concave).

The section in the plane y = 0: the upper flange goes along x up to x = 0, the bend turns down by the angle on the
radius, the lower flange goes straight on. Extruded along y it is developable: two planes and a cylinder.

Lengths in millimetres. Facts, exact, with flanges of 100 and 80, a radius of 10 and an angle of 90°:

:Area: flanges: 30000 mm² and 24000 mm²; fillet: width · radius · angle = 4712.389 mm²
:Gaussian curvature: 0
:Flat length: upper + radius · angle + lower = 195.708 mm across the bend
:Shear: 0 from any seed in any direction
:Source: a developable surface with two straight fibres at right angles
"""

from __future__ import annotations

from math import cos, radians, sin

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.gp import gp_Vec

upper = 100.0  # flat part of the upper flange
lower = 80.0  # flat part of the lower flange
radius = 10.0  # of the bend, on the side of the cloth
angle_deg = 90.0  # by which the bend turns
width = 300.0  # along y
concave = False  # the cloth lies inside the bend


def build(
    *,
    upper: float = upper,
    lower: float = lower,
    radius: float = radius,
    angle_deg: float = angle_deg,
    width: float = width,
    concave: bool = concave,
) -> cq.Workplane:
    """Build the open shell of ``upper``, ``fillet`` and ``lower``, normals on the cloth's side."""
    for name, size in (("upper", upper), ("lower", lower), ("radius", radius), ("width", width)):
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not 0 < angle_deg < 180:
        msg = f"angle_deg={angle_deg}: must lie between 0 and 180"
        raise ValueError(msg)
    angle = radians(angle_deg)

    def bend(at: float) -> cq.Vector:
        return cq.Vector(radius * sin(at), 0, radius * (cos(at) - 1))

    end = bend(angle) + cq.Vector(lower * cos(angle), 0, -lower * sin(angle))
    section = {
        "upper": cq.Edge.makeLine(cq.Vector(-upper, 0, 0), cq.Vector(0, 0, 0)),
        "fillet": cq.Edge.makeThreePointArc(cq.Vector(0, 0, 0), bend(angle / 2), bend(angle)),
        "lower": cq.Edge.makeLine(bend(angle), end),
    }
    along = gp_Vec(0, width, 0)
    strips = [cq.Face(BRepPrimAPI_MakePrism(edge.wrapped, along).Shape()) for edge in section.values()]
    shell = cq.Shell.makeShell(strips)
    if (shell.Faces()[0].normalAt().z < 0) != concave:
        shell = cq.Shell(shell.wrapped.Reversed())
    shape = cq.Workplane(shell)
    for name, face in zip(section, shell.Faces(), strict=True):
        shape.newObject([face]).tag(name)
    return shape


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
