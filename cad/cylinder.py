"""Cylinder: an open patch of the cylinder x^2 + y^2 = R^2, cloth on the outside.

The axis is z and the patch is centred on the point (R, 0, 0), symmetric about the planes y = 0 and z = 0. A
point at azimuth phi and height z lies on the flat sheet at (R phi, z).

Lengths in millimetres. Facts, exact, with R = 500 mm, an arc of 180° and a length of 1800 mm:

:Area: arc · R · length = 2827433.388 mm²
:Gaussian curvature: 0
:Flat length: arc · R = 1570.796 mm round the arc, 1800 mm along the axis
:Shear: 0 from any seed in any direction
:Source: a developable surface with two straight fibres at right angles
"""

from __future__ import annotations

import cadquery as cq

radius = 500.0  # R
length = 1800.0  # along the axis
arc_deg = 180.0  # azimuth covered


def build(*, radius: float = radius, length: float = length, arc_deg: float = arc_deg) -> cq.Workplane:
    """Build the patch, one cylindrical face with its normal away from the axis."""
    if not (radius > 0 and length > 0):
        msg = f"radius={radius}, length={length}: must be positive"
        raise ValueError(msg)
    if not 0 < arc_deg < 360:
        msg = f"arc_deg={arc_deg}: must lie between 0 and 360, the patch is not a closed tube"
        raise ValueError(msg)
    base = cq.Vector(0, 0, -length / 2)
    wedge = cq.Solid.makeCylinder(radius, length, base, angleDegrees=arc_deg)
    wedge = wedge.rotate(cq.Vector(), cq.Vector(0, 0, 1), -arc_deg / 2)
    return cq.Workplane(wedge.faces("%CYLINDER"))


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
