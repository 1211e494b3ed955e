"""Joggle: a flat panel that steps down to another level over a ramp, cloth on top.

The section in the plane y = 0 goes along x: flat at z = 0 up to x = 0, an arc that turns down by the ramp's angle,
the straight ramp, an arc that turns back, and flat at z = -depth. Extruded along y it is developable: planes and
cylinders with common rulings.

Lengths in millimetres. Facts, exact, with a depth of 10, radii of 15, a ramp of 30° and 150 mm flat at either end:

:Area: width · flat length = 65533.897 mm²
:Gaussian curvature: 0
:Flat length: before + 2 · radius · angle + ramp + after, the ramp (depth - 2 radius (1 - cos angle)) / sin angle:
    327.669 mm across the step
:Shear: 0 from any seed in any direction
:Source: a developable surface with two straight fibres at right angles
"""

from __future__ import annotations

from math import cos, radians, sin

import cadquery as cq
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.gp import gp_Vec

depth = 10.0  # of the step
ramp_angle_deg = 30.0  # of the ramp, down from the panel
radius = 15.0  # of both bends
before = 150.0  # flat before the step
after = 150.0  # flat behind it
width = 200.0  # of the panel, along y


def build(
    *,
    depth: float = depth,
    ramp_angle_deg: float = ramp_angle_deg,
    radius: float = radius,
    before: float = before,
    after: float = after,
    width: float = width,
) -> cq.Workplane:
    """Build the open shell of ``upper``, ``convex``, ``ramp``, ``concave`` and ``lower``, normals up."""
    sizes = {"depth": depth, "radius": radius, "before": before, "after": after, "width": width}
    for name, size in sizes.items():
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not 0 < ramp_angle_deg < 90:
        msg = f"ramp_angle_deg={ramp_angle_deg}: must lie between 0 and 90"
        raise ValueError(msg)
    angle = radians(ramp_angle_deg)
    ramp = (depth - 2 * radius * (1 - cos(angle))) / sin(angle)
    if not ramp > 0:
        msg = f"depth={depth}: no straight ramp is left between two arcs of radius {radius}; lower radius or the angle"
        raise ValueError(msg)

    def bend(at: float) -> cq.Vector:  # of the upper arc
        return cq.Vector(radius * sin(at), 0, radius * (cos(at) - 1))

    end = 2 * bend(angle) + cq.Vector(ramp * cos(angle), 0, -ramp * sin(angle))
    section = {
        "upper": cq.Edge.makeLine(cq.Vector(-before, 0, 0), cq.Vector(0, 0, 0)),
        "convex": cq.Edge.makeThreePointArc(cq.Vector(0, 0, 0), bend(angle / 2), bend(angle)),
        "ramp": cq.Edge.makeLine(bend(angle), end - bend(angle)),
        "concave": cq.Edge.makeThreePointArc(end - bend(angle), end - bend(angle / 2), end),
        "lower": cq.Edge.makeLine(end, end + cq.Vector(after, 0, 0)),
    }
    along = gp_Vec(0, width, 0)
    strips = [cq.Face(BRepPrimAPI_MakePrism(edge.wrapped, along).Shape()) for edge in section.values()]
    shell = cq.Shell.makeShell(strips)
    if shell.Faces()[0].normalAt().z < 0:
        shell = cq.Shell(shell.wrapped.Reversed())
    shape = cq.Workplane(shell)
    for name, face in zip(section, shell.Faces(), strict=True):
        shape.newObject([face]).tag(name)
    return shape


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
