"""Cone: an open patch of a circular cone, symmetric about the plane y = 0, cloth on the outside.

The apex is the origin, left out, and the axis is z. A point at slant distance rho from the apex and azimuth
phi is (rho sin(a) cos(phi), rho sin(a) sin(phi), rho cos(a)) with a the half angle; on the flat sheet it lies
at the same distance rho from the apex, at the angle phi sin(a).

Lengths in millimetres. Facts, exact, with a = 25°, slant distances 300 to 1900 mm and an arc of 240°:

:Area: arc · sin a · (1900² - 300²) / 2 = 3115656.254 mm²
:Gaussian curvature: 0 (the apex, with its defect 2π (1 - sin a), is outside the patch)
:Flat length: a sector of arc · sin a = 101.428° between the radii 300 and 1900 mm
:Shear: 0 from any seed in any direction
:Source: a developable surface with two straight fibres at right angles
"""

from __future__ import annotations

from math import cos, radians, sin

import cadquery as cq

half_angle_deg = 25.0  # a, between axis and ruling
slant_from = 300.0  # distance from the apex to the small rim, along a ruling
slant_to = 1900.0  # to the large rim
arc_deg = 240.0  # azimuth covered


def build(
    *,
    half_angle_deg: float = half_angle_deg,
    slant_from: float = slant_from,
    slant_to: float = slant_to,
    arc_deg: float = arc_deg,
) -> cq.Workplane:
    """Build the patch, one conical face with its normal away from the axis."""
    if not 0 < half_angle_deg < 90:
        msg = f"half_angle_deg={half_angle_deg}: must lie between 0 and 90"
        raise ValueError(msg)
    if not 0 < slant_from < slant_to:
        msg = f"slant_from={slant_from}, slant_to={slant_to}: must be positive and increase"
        raise ValueError(msg)
    if not 0 < arc_deg < 360:
        msg = f"arc_deg={arc_deg}: must lie between 0 and 360, the patch is not a closed cone"
        raise ValueError(msg)
    across, along = sin(radians(half_angle_deg)), cos(radians(half_angle_deg))
    wedge = cq.Solid.makeCone(
        slant_from * across,
        slant_to * across,
        (slant_to - slant_from) * along,
        cq.Vector(0, 0, slant_from * along),
        angleDegrees=arc_deg,
    )
    wedge = wedge.rotate(cq.Vector(), cq.Vector(0, 0, 1), -arc_deg / 2)
    return cq.Workplane(wedge.faces("%CONE"))


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
