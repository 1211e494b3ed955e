"""Cube corner: the three faces of a cube that meet in the origin, cloth on the outside.

The cube is [0, side]^3, so the faces lie in the coordinate planes and their normals point towards -x, -y and
-z. All curvature sits in one point: the three right angles at the corner leave a defect of 90°.

Lengths in millimetres. Facts, exact, with a side of 1000 mm:

:Area: 3 side² = 3000000 mm²
:Gaussian curvature: 0, but for the corner, an angle defect of π/2
:Flat length: 1000 mm along each edge
:Shear: 22.5° in every cell of the net whose origin is the corner: the four half-fibres leave it 67.5° apart,
    the cells have corners of 67.5° and 112.5°
:Source: the total angle 3π/2 at the corner, shared out equally; exact for any spacing
"""

from __future__ import annotations

import cadquery as cq

side = 1000.0  # of the cube


def build(*, side: float = side) -> cq.Workplane:
    """Build the open shell of three square faces, tagged ``yz``, ``zx`` and ``xy`` after their planes."""
    if not side > 0:
        msg = f"side={side}: must be positive"
        raise ValueError(msg)
    cube = cq.Solid.makeBox(side, side, side)
    faces = [cube.face(selector) for selector in ("<X", "<Y", "<Z")]
    shell = cq.Workplane(cq.Shell.makeShell(faces))
    for name, face in zip(("yz", "zx", "xy"), shell.val().Faces(), strict=True):
        shell.newObject([face]).tag(name)
    return shell


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
