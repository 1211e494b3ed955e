"""Wing and spar: two developable faces that meet in a curved crease, to be covered by one woven sheet.

y runs along the span from 0, x along the chord, z up. Two profiles make the tool, both 0 at y = 0:

- wing: z = g_w(y), from the crease at x = g_s(y) to x = g_s(y) + chord, normal towards +z;
- spar: x = g_s(y), from the crease at z = g_w(y) down to z = g_w(y) - spar_height, normal towards -x.

The cloth lies on the outside and folds over the crease, the curve (g_s(y), y, g_w(y)). Where g_s = g_w the
mould is an origami fold and the net does not shear at all; how far f = g_s - g_w may depart from 0 is the
question of the wing box. The rulings run along x on the wing and along z on the spar: both faces are
developable to the last digit. The crease follows the profiles to 1e-4 mm.

Profiles (lengths in mm, slopes without unit):

=============  =====================================================================================
wing_profile   ``real``: g_w' = A + B exp(-y / L), slopes of 15, 7 and 3 degrees at 0, 4 and 14 m;
               ``flat``: 0; ``quadratic``: wing_a y²; ``arc``: circle of radius wing_radius
spar_profile   ``origami``: g_w + f; or g_s itself, with deviation ``none``: ``flat``, ``quadratic``
               (spar_a), ``arc`` (spar_radius)
deviation      f: ``none``; ``linear``: c y; ``parabola``: c y² / (2 span); ``sine``:
               c sin(2π y / wavelength); ``sin2_slope``: f' = c sin²(π y / span); ``bump``:
               c r² exp(1 - r²) with r = y / length; ``ripple``: c (1 - cos(2π y / wavelength))
=============  =====================================================================================

Facts, exact, of the default: the real 14 m wing with a parabola of c = 0.1 between wing and spar:

:Area: wing: chord · 14098.238 mm = 42294714.458 mm²; spar: spar_height · 14173.590 mm = 14173590.122 mm²
:Gaussian curvature: 0 on both faces; the crease turns the net by ψ, tan α = g_s'/√(1 + g_w'²),
    tan β = g_w'/√(1 + g_s'²), ψ = β - α: 0° at y = 0, -5.68813° at y = 14000 mm
:Flat length: wing edge 14098.238 mm, spar edge 14173.590 mm, crease 14270.052 mm
:Shear: sheet laid undeformed on the wing, spacing 20 mm: at most 3.008° where rows come from the wing and
    2.134° where they start on the left-most spar ribbon
:Source: the net on the two unfolded sheets, no mesh involved
"""

from __future__ import annotations

from collections.abc import Callable

import cadquery as cq
import numpy as np
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

span = 14000.0  # along y
chord = 3000.0  # the wing reaches this far from the spar
spar_height = 1000.0  # the spar reaches this far below the wing
wing_profile = "real"  # real | flat | quadratic | arc
wing_a = 2e-5  # 1/mm, quadratic wing
wing_radius = 50000.0  # arc wing
spar_profile = "origami"  # origami | flat | quadratic | arc
spar_a = 4e-5  # 1/mm, quadratic spar
spar_radius = 50000.0  # arc spar
deviation = "parabola"  # none | linear | parabola | sine | sin2_slope | bump | ripple
c = 0.1  # size of the deviation: a slope for linear, parabola and sin2_slope, else mm
wavelength = 3500.0  # of sine and ripple
length = 1000.0  # of the bump
fillet_radius = 0.0  # of the edge between wing and spar, 0 = sharp
block = False  # the solid tool block in place of the open shell

Profile = Callable[[np.ndarray], np.ndarray]  # of y; analytic, so that it takes complex arguments


def build(
    *,
    span: float = span,
    chord: float = chord,
    spar_height: float = spar_height,
    wing_profile: str = wing_profile,
    wing_a: float = wing_a,
    wing_radius: float = wing_radius,
    spar_profile: str = spar_profile,
    spar_a: float = spar_a,
    spar_radius: float = spar_radius,
    deviation: str = deviation,
    c: float = c,
    wavelength: float = wavelength,
    length: float = length,
    fillet_radius: float = fillet_radius,
    block: bool = block,
) -> cq.Workplane:
    """Build the open shell of ``wing``, ``spar`` and, with a radius, ``fillet``; or the block they bound.

    The faces are tagged by these names. The block goes on below the spar with ``skirt``, down to a flat
    ``floor``, and has ``back``, ``root`` and ``tip``.
    """
    sizes = {
        "span": span,
        "chord": chord,
        "spar_height": spar_height,
        "wavelength": wavelength,
        "length": length,
    }
    for name, size in sizes.items():
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not 0 <= fillet_radius < min(chord, spar_height):
        msg = f"fillet_radius={fillet_radius}: must be 0 (sharp) or smaller than chord and spar_height"
        raise ValueError(msg)
    g_w = named_profile("wing_profile", wing_profile, wing_a, wing_radius, span)
    f = named_deviation(deviation, c, span, wavelength, length)
    if spar_profile == "origami":
        base = g_w
    else:
        base = named_profile("spar_profile", spar_profile, spar_a, spar_radius, span)
        if deviation != "none":
            msg = f"spar_profile={spar_profile!r} is all of g_s: set deviation to 'none', not {deviation!r}"
            raise ValueError(msg)

    def g_s(y: np.ndarray) -> np.ndarray:
        return base(y) + f(y)

    faces = block_faces(g_w, g_s, span, chord, spar_height)
    solid = cq.Solid.makeSolid(cq.Shell.makeShell(list(faces.values())))
    faces = dict(zip(faces, solid.Faces(), strict=True))  # sewing keeps the order
    if fillet_radius > 0:
        solid, faces = with_fillet(solid, faces, fillet_radius)
    if block:
        shape = cq.Workplane(solid)
    else:
        faces = {name: face for name, face in faces.items() if name in ("wing", "fillet", "spar")}
        shape = cq.Workplane(cq.Shell.makeShell(list(faces.values())))
    for name, face in faces.items():
        shape.newObject([face]).tag(name)
    return shape


def named_profile(parameter: str, name: str, a: float, radius: float, span: float) -> Profile:
    """Return g(y) of a profile that stands by itself, mm."""
    if name == "real":
        slope, decaying_slope, decay = 0.047227544, 0.220721648, 3731.291642
        return lambda y: slope * y + decaying_slope * decay * (1 - np.exp(-y / decay))
    if name == "flat":
        return lambda y: 0 * y
    if name == "quadratic":
        return lambda y: a * y**2
    if name == "arc":
        if not radius > span:
            msg = f"{parameter.removesuffix('profile')}radius={radius}: must be larger than the span, {span}"
            raise ValueError(msg)
        return lambda y: radius - np.sqrt(radius**2 - y**2)
    also = ", origami" if parameter == "spar_profile" else ""
    msg = f"{parameter}={name!r} is not known: real, flat, quadratic, arc{also}"
    raise ValueError(msg)


def named_deviation(name: str, c: float, span: float, wavelength: float, length: float) -> Profile:
    """Return f(y) = g_s - g_w, mm, 0 at y = 0."""
    turn = 2 * np.pi
    known: dict[str, Profile] = {
        "none": lambda y: 0 * y,
        "linear": lambda y: c * y,
        "parabola": lambda y: c * y**2 / (2 * span),
        "sine": lambda y: c * np.sin(turn * y / wavelength),
        "sin2_slope": lambda y: c * (y / 2 - span / (2 * turn) * np.sin(turn * y / span)),
        "bump": lambda y: c * (y / length) ** 2 * np.exp(1 - (y / length) ** 2),
        "ripple": lambda y: c * (1 - np.cos(turn * y / wavelength)),
    }
    if name not in known:
        msg = f"deviation={name!r} is not known: {', '.join(known)}"
        raise ValueError(msg)
    return known[name]


def spanwise_edge(x: Profile, z: Profile, span: float) -> cq.Edge:
    """Interpolate (x(y), y, z(y)) by a cubic spline of parameter y, within 1e-4 mm of the profiles."""
    step = 1e-20  # derivative by a complex step: exact to round-off
    ends = [cq.Vector((x(y).imag / step), 1.0, z(y).imag / step) for y in np.array([0, span]) + 1j * step]
    for intervals in (32, 64, 128, 256, 512, 1024, 2048):
        y = np.linspace(0, span, intervals + 1)
        points = [cq.Vector(*xyz) for xyz in zip(x(y), y, z(y), strict=True)]
        edge = cq.Edge.makeSpline(points, tangents=ends, parameters=list(y), scale=False)
        between = (y[:-1] + y[1:]) / 2
        found = np.array([p.toTuple() for p in edge.positions(between, mode="parameter")])
        if np.abs(found - np.stack([x(between), between, z(between)], axis=-1)).max() < 1e-4:
            return edge
    msg = f"the profiles change too fast along the span of {span} mm: raise wavelength or length, or lower c"
    raise ValueError(msg)


def block_faces(g_w: Profile, g_s: Profile, span: float, chord: float, spar_height: float) -> dict[str, cq.Face]:
    """Make the faces of the tool block by name, wing and spar first.

    Ruled B-spline faces rather than extrusions: between two equal curves a tessellator then puts vertices on
    the curves alone, its edges follow the rulings, and the facets are as developable as the face.
    """
    floor_z = g_w(np.linspace(0, span, 1001)).min() - 1.2 * spar_height
    crease = spanwise_edge(g_s, g_w, span)
    trailing = crease.translate(cq.Vector(chord, 0, 0))
    hem = crease.translate(cq.Vector(0, 0, -spar_height))
    toe = spanwise_edge(g_s, lambda y: 0 * y + floor_z, span)
    heel = toe.translate(cq.Vector(chord, 0, 0))
    ring = (crease, trailing, heel, toe, hem)

    def end_plane(corners: list[cq.Vector]) -> cq.Face:
        return cq.Face.makeFromWires(cq.Wire.makePolygon(corners, close=True))

    return {
        "wing": cq.Face.makeRuledSurface(crease, trailing),
        "spar": cq.Face.makeRuledSurface(crease, hem),
        "skirt": cq.Face.makeRuledSurface(hem, toe),
        "floor": cq.Face.makeRuledSurface(toe, heel),
        "back": cq.Face.makeRuledSurface(trailing, heel),
        "root": end_plane([edge.startPoint() for edge in ring]),
        "tip": end_plane([edge.endPoint() for edge in ring]),
    }


def with_fillet(
    solid: cq.Solid, faces: dict[str, cq.Face], fillet_radius: float
) -> tuple[cq.Solid, dict[str, cq.Face]]:
    """Round the edge between wing and spar; return the block and its faces by name."""
    crease = next(edge for edge in faces["wing"].Edges() if any(edge.isSame(e) for e in faces["spar"].Edges()))
    rounding = BRepFilletAPI_MakeFillet(solid.wrapped)
    rounding.Add(fillet_radius, crease.wrapped)
    rounding.Build()
    if not rounding.IsDone():
        msg = f"fillet_radius={fillet_radius}: no such fillet fits along the crease"
        raise ValueError(msg)
    rounded = cq.Shape.cast(rounding.Shape()).Solids()[0]
    made = {}
    for name, face in faces.items():
        changed = rounding.Modified(face.wrapped)
        made[name] = changed.First() if changed.Size() else face.wrapped
    made["fillet"] = rounding.Generated(crease.wrapped).First()
    # The history gives faces as they are stored; the solid has them with their outward orientation.
    return rounded, {
        name: next(face for face in rounded.Faces() if face.wrapped.IsSame(old)) for name, old in made.items()
    }


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
