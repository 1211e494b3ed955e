"""Tapered C-spar: a flat web and two flanges over fillets, its height falling along the span, cloth on the outside.

y runs along the span, z up. The web lies in the plane x = 0, its normal towards -x, symmetric about z = 0; its height,
flanges' faces included, is root_height at y = 0 and tip_height at y = span. The flanges reach from the web to
x = flange. Web and flanges are at right angles all along, so each fillet is a quarter of a cylinder.

Lengths in millimetres. Facts, exact, with a span of 2000, heights of 300 and 150, flanges of 80 and a radius of 12 mm:

:Area: web: span ((root + tip height) / 2 - 2 radius / cos t) = 401966.262 mm²; fillets: π/2 · radius · span / cos t,
    37725.610 mm² and 37725.610 mm²; flanges: (flange - radius) span / cos t, 136095.591 mm² and 136095.591 mm²
:Gaussian curvature: 0
:Flat length: one flat sheet: web, fillets and flanges unroll together; 2001.406 mm along a flange's border
:Shear: 0 from any seed in any direction
:Source: planes and cylinders with common rulings; the flanges incline by tan t = (root - tip height) / (2 span)
"""

from __future__ import annotations

import cadquery as cq
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

span = 2000.0  # along y
root_height = 300.0  # at y = 0
tip_height = 150.0  # at y = span
flange = 80.0  # width of the flanges, along x
fillet_radius = 12.0  # between web and flanges


def build(
    *,
    span: float = span,
    root_height: float = root_height,
    tip_height: float = tip_height,
    flange: float = flange,
    fillet_radius: float = fillet_radius,
) -> cq.Workplane:
    """Build the open shell of ``web``, ``upper_fillet``, ``upper_flange``, ``lower_fillet``, ``lower_flange``."""
    sizes = {"span": span, "root_height": root_height, "tip_height": tip_height, "flange": flange}
    for name, size in sizes.items():
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    most = min(flange, 0.45 * min(root_height, tip_height))
    if not 0 < fillet_radius < most:
        msg = f"fillet_radius={fillet_radius}: must be positive and smaller than {most:g}, for flange and web to remain"
        raise ValueError(msg)
    outline = [(0, -root_height / 2), (span, -tip_height / 2), (span, tip_height / 2), (0, root_height / 2)]
    block = cq.Workplane("YZ").polyline(outline).close().extrude(flange)
    rounding = BRepFilletAPI_MakeFillet(block.val().wrapped)
    for crease in block.faces("<X").edges("not |Z").vals():
        rounding.Add(fillet_radius, crease.wrapped)
    shell = cq.Shell.makeShell([face for face in cq.Shape.cast(rounding.Shape()).Faces() if name_of(face)])
    shape = cq.Workplane(shell)
    for face in shell.Faces():
        shape.newObject([face]).tag(name_of(face))
    return shape


def name_of(face: cq.Face) -> str | None:
    """Tell a face of the tool by its kind and normal; None for the block's other faces."""
    normal = face.normalAt()
    side = "upper" if normal.z > 0 else "lower"
    if face.geomType() == "CYLINDER":
        return f"{side}_fillet"
    if normal.x < -0.5:
        return "web"
    return f"{side}_flange" if abs(normal.x) < 0.5 and abs(normal.z) > 1e-9 else None


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
