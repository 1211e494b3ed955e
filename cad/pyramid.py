"""Pyramid: n equal triangles that meet in the origin, of any angle at the apex, cloth on the outside.

The apex is the origin and the axis points down to -z. All curvature sits in the apex, an angle defect of
2π - n · apex angle; three faces of 90° are the corner of a cube.

Lengths in millimetres. Facts, exact, with four faces of 60° at the apex and slant edges of 1000 mm:

:Area: sides · slant² sin(apex angle) / 2 = 1732050.808 mm²
:Gaussian curvature: 0, but for the apex, an angle defect of 2π - sides · apex angle = 2π/3
:Flat length: 1000 mm along each edge
:Shear: 90° - sides · apex angle / 4 = 30° in every cell of the net whose origin is the apex: the four half-fibres
    leave it sides · apex angle / 4 = 60° apart
:Source: the total angle at the apex, shared out equally; exact for any spacing
"""

from __future__ import annotations

from math import cos, pi, radians, sin, sqrt

import cadquery as cq

sides = 4  # faces
apex_angle_deg = 60.0  # of each face at the apex
slant = 1000.0  # length of the edges that leave the apex


def build(*, sides: int = sides, apex_angle_deg: float = apex_angle_deg, slant: float = slant) -> cq.Workplane:
    """Build the open shell of triangular faces, tagged ``side_1``, ``side_2``, ... counter-clockwise from above."""
    if sides != int(sides) or sides < 3:
        msg = f"sides={sides}: must be a whole number, at least 3"
        raise ValueError(msg)
    if not 0 < sides * apex_angle_deg < 360:
        msg = f"apex_angle_deg={apex_angle_deg}: must lie between 0 and {360 / sides:g}, where {sides} sides lie flat"
        raise ValueError(msg)
    if not slant > 0:
        msg = f"slant={slant}: must be positive"
        raise ValueError(msg)
    sides = int(sides)
    out = slant * sin(radians(apex_angle_deg) / 2) / sin(pi / sides)  # from the axis to a corner of the base
    turns = [2 * pi * (corner + 0.5) / sides for corner in range(sides + 1)]
    corners = [cq.Vector(out * cos(turn), out * sin(turn), -sqrt(slant**2 - out**2)) for turn in turns]
    corners[-1] = corners[0]
    faces = [
        cq.Face.makeFromWires(cq.Wire.makePolygon([cq.Vector(), corners[side], corners[side + 1]], close=True))
        for side in range(sides)
    ]
    shell = cq.Shell.makeShell(faces)
    if shell.Faces()[0].normalAt().z < 0:
        shell = cq.Shell(shell.wrapped.Reversed())
    shape = cq.Workplane(shell)
    for number, face in enumerate(shell.Faces(), start=1):
        shape.newObject([face]).tag(f"side_{number}")
    return shape


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
