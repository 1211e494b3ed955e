"""Double dome: two spherical ends joined by a waist, on a flat rim with a fillet, cloth on the outside.

In the style of the international forming benchmark; the sizes are round ones of our own, not those of its drawing.
The upper half of a body of revolution about the x axis: spheres of radius R about (±d, 0, 0), and between them,
touching both, the inner part of a torus whose tube of radius w is centred on the circle of radius
h = sqrt((R + w)^2 - d^2). The rim lies in the plane z = 0; the fillet rolls along the foot of the body. The faces
of the domes have their poles outside themselves.

Lengths in millimetres. Facts, exact, with R = 60, d = 110, w = 200 mm and a rim of 470 by 270 mm:

:Area: without the fillet: domes: 2 π R² (1 + d / (R + w)) = 32189.242 mm²; waist: 2 π w (h a - w sin a),
    sin a = d / (R + w), = 22992.601 mm²; rim: 95563.542 mm²
:Gaussian curvature: 1/R² = 2.77778e-4 mm⁻² on the domes, -1 / (w (h - w)) = -1.40511e-4 mm⁻² amid the waist,
    0 on the rim; in all 0 by Gauss and Bonnet, the rim being flat
:Flat length: 207.826 mm along the ridge from the middle of the waist to the foot of a dome, without the fillet
:Shear: no closed form; on a dome alone, from its top, that of the hemisphere
:Source: a surface of revolution
"""

from __future__ import annotations

from math import sqrt

import cadquery as cq
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

radius = 60.0  # R, of the domes
distance = 220.0  # 2 d, from the centre of one dome to that of the other
waist_radius = 200.0  # w, of the arc that joins the domes
fillet_radius = 20.0  # of the foot, 0 = sharp
rim_length = 470.0  # along x
rim_width = 270.0  # along y


def build(
    *,
    radius: float = radius,
    distance: float = distance,
    waist_radius: float = waist_radius,
    fillet_radius: float = fillet_radius,
    rim_length: float = rim_length,
    rim_width: float = rim_width,
) -> cq.Workplane:
    """Build the open shell of ``left``, ``waist``, ``right``, ``fillet`` (four faces) and ``rim``, normals up."""
    check(radius, distance, waist_radius, fillet_radius, rim_length, rim_width)
    body = half_body(radius, distance / 2, waist_radius)
    slab = cq.Solid.makeBox(rim_length, rim_width, radius, cq.Vector(-rim_length / 2, -rim_width / 2, -radius))
    tool = body.fuse(slab).Solids()[0]
    if fillet_radius > 0:
        tool = with_fillet(tool, fillet_radius, (rim_length, rim_width))
    of_slab = [face for face in tool.Faces() if face.geomType() == "PLANE" and face.normalAt().z < 0.5]
    shell = cq.Shell.makeShell([face for face in tool.Faces() if face not in of_slab])
    shape = cq.Workplane(shell)
    named: dict[str, list[cq.Face]] = {}
    for face in shell.Faces():
        named.setdefault(name_of(face, radius), []).append(face)
    for name, faces in named.items():
        shape.newObject(faces).tag(name)
    return shape


def name_of(face: cq.Face, radius: float) -> str:
    """Tell a face by its kind and place."""
    middle = face.Center()
    if face.geomType() == "PLANE":
        return "rim"
    if face.geomType() == "SPHERE":
        return "left" if middle.x < 0 else "right"
    return "waist" if face.geomType() == "TORUS" and abs(middle.y) < 0.01 * radius else "fillet"


def check(
    radius: float, distance: float, waist_radius: float, fillet_radius: float, rim_length: float, rim_width: float
) -> None:
    """Refuse what is no double dome."""
    for name, size in (("radius", radius), ("distance", distance), ("waist_radius", waist_radius)):
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not 0 <= fillet_radius < radius:
        msg = f"fillet_radius={fillet_radius}: must be 0 (sharp) or smaller than the radius of the domes, {radius}"
        raise ValueError(msg)
    most = 2 * min(sqrt((radius + waist_radius) ** 2 - waist_radius**2), 0.7 * (radius + waist_radius))
    if not distance < most:
        msg = f"distance={distance}: must be smaller than {most:.3f}, or the waist closes; raise radius or lower this"
        raise ValueError(msg)
    foot = sqrt(radius**2 + 2 * radius * fillet_radius)
    for name, size, least in (("rim_length", rim_length, distance + 2 * foot), ("rim_width", rim_width, 2 * foot)):
        if not size > least:
            msg = f"{name}={size}: must be larger than {least:.3f}, where the foot ends"
            raise ValueError(msg)


def half_body(radius: float, away: float, waist_radius: float) -> cq.Shape:
    """Make the body above z = 0."""
    high = sqrt((radius + waist_radius) ** 2 - away**2)
    touch = away * waist_radius / (radius + waist_radius)  # where waist and dome meet
    wide = high * radius / (radius + waist_radius)
    section = (
        cq.Workplane("XY")
        .moveTo(-touch, 0)
        .lineTo(-touch, wide)
        .threePointArc((0, high - waist_radius), (touch, wide))
        .lineTo(touch, 0)
        .close()
    )
    waist = section.revolve(180, (0, 0, 0), (1, 0, 0)).val()
    if waist.Center().z < 0:
        waist = waist.mirror("XY")
    room = cq.Solid.makeBox(2 * radius, 2 * radius, radius, cq.Vector(touch, -radius, 0))
    # Poles and seam below the foot or on the waist's side.
    axes = gp_Ax2(gp_Pnt(away, 0, 0), gp_Dir(1, 0, -1), gp_Dir(-1, 0, -1))
    right = cq.Solid(BRepPrimAPI_MakeSphere(axes, radius).Solid()).intersect(room)
    return waist.fuse(right, right.mirror("YZ"))


def with_fillet(tool: cq.Solid, fillet_radius: float, rim: tuple[float, float]) -> cq.Solid:
    """Round the foot of the body."""
    rounding = BRepFilletAPI_MakeFillet(tool.wrapped)
    for edge in tool.Edges():
        box = edge.BoundingBox()
        inside = max(abs(box.xmin), box.xmax) < rim[0] / 2 - 1e-3 and max(abs(box.ymin), box.ymax) < rim[1] / 2 - 1e-3
        if max(abs(box.zmin), abs(box.zmax)) < 1e-3 and inside:
            rounding.Add(fillet_radius, edge.wrapped)
    rounding.Build()
    if not rounding.IsDone():
        msg = f"fillet_radius={fillet_radius}: no such fillet fits along the foot"
        raise ValueError(msg)
    return cq.Shape.cast(rounding.Shape()).Solids()[0]


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
