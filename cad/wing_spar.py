"""Wing and spar: two developable faces that meet in a curved crease, to be covered by one woven sheet.

y runs along the span from 0, x along the chord, z up. Two profiles make the tool:

- wing: z = g_w(y), from the crease at x = g_s(y) to x = g_s(y) + chord, normal towards +z;
- spar: x = g_s(y), from the crease at z = g_w(y) down to z = g_w(y) - spar_height, normal towards -x.

The cloth lies on the outside and folds over the crease, the curve (g_s(y), y, g_w(y)). Where g_s = g_w the
mould is an origami fold and the net does not shear at all; how far f = g_s - g_w may depart from 0 is the
question of the wing box. The rulings run along x on the wing and along z on the spar: both faces are
developable to the last digit. The crease follows the profiles to 1e-4 mm.

A spar that is not perpendicular falls away from the wing's chord by spar_angle_deg, its slope m = tan of it:
its rulings run along (-cos, 0, -sin) of that angle, spar_height is measured along them, and the fold is
origami for g_s = cot(spar_angle_deg / 2) g_w. With rear_spar the wing ends in a second crease and spar of the
same height and angle: a C-section.

Profiles (lengths in mm, slopes without unit):

=============  =====================================================================================
wing_profile   ``real``: g_w' = A + B exp(-y / L), slopes of 15, 7 and 3 degrees at 0, 4 and 14 m;
               ``flat``: 0; ``quadratic``: wing_a y²; ``arc``: circle of radius wing_radius;
               ``table``: cubic spline through wing_table
spar_profile   ``origami``: g_w cot(spar_angle_deg / 2) + f; or g_s itself, with deviation ``none``:
               ``real``, ``flat``, ``quadratic`` (spar_a), ``arc`` (spar_radius), ``table`` (spar_table)
deviation      f: ``none``; ``linear``: c y; ``parabola``: c y² / (2 span); ``sine``:
               c sin(2π y / wavelength); ``sin2_slope``: f' = c sin²(π y / span); ``bump``:
               c r² exp(1 - r²) with r = y / length; ``ripple``: c (1 - cos(2π y / wavelength));
               ``table``: cubic spline through deviation_table
rear_profile   the rear crease, x = chord - g_s(y) (``mirror``) or x = chord + g_s(y) (``parallel``)
=============  =====================================================================================

A table is the text ``0:0,1000:12,...`` of y:g, or the name of a CSV file with a row y,g each; its y increases and
covers the span; the spline is the one whose third derivative does not jump at the first and last inner point.

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

from collections.abc import Callable, Iterable
from itertools import pairwise
from math import cos, isfinite, radians, sin, tan
from pathlib import Path

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet

span = 14000.0  # along y
chord = 3000.0  # the wing reaches this far from the spar
spar_height = 1000.0  # the spar reaches this far from the wing, along its rulings
spar_angle_deg = 90.0  # from the wing's chord, drawn on past the crease, down to the spar
wing_profile = "real"  # g_w: real | flat | quadratic | arc | table
wing_a = 2e-5  # 1/mm, quadratic wing
wing_radius = 50000.0  # arc wing
wing_table = ""  # table wing, y:g_w,y:g_w,... or a CSV file
spar_profile = "origami"  # g_s: origami (g_w + f) | real | flat | quadratic | arc | table
spar_a = 4e-5  # 1/mm, quadratic spar
spar_radius = 50000.0  # arc spar
spar_table = ""  # table spar, y:g_s,y:g_s,... or a CSV file
deviation = "parabola"  # f: none | linear | parabola | sine | sin2_slope | bump | ripple | table
c = 0.1  # size of the deviation: a slope for linear, parabola and sin2_slope, else mm
wavelength = 3500.0  # of sine and ripple
length = 1000.0  # of the bump
deviation_table = ""  # table deviation, y:f,y:f,... or a CSV file
fillet_radius = 0.0  # of the edge between wing and spar, 0 = sharp
rear_spar = False  # a second spar at the other end of the chord: a C-section
rear_profile = "mirror"  # of the rear spar: mirror | parallel
block = False  # the solid tool block in place of the open shell

Profile = Callable[[NDArray], NDArray]  # of y; analytic, so that it takes complex arguments
Curve = tuple[Profile, Profile]  # x and z of y


def build(
    *,
    span: float = span,
    chord: float = chord,
    spar_height: float = spar_height,
    spar_angle_deg: float = spar_angle_deg,
    wing_profile: str = wing_profile,
    wing_a: float = wing_a,
    wing_radius: float = wing_radius,
    wing_table: str = wing_table,
    spar_profile: str = spar_profile,
    spar_a: float = spar_a,
    spar_radius: float = spar_radius,
    spar_table: str = spar_table,
    deviation: str = deviation,
    c: float = c,
    wavelength: float = wavelength,
    length: float = length,
    deviation_table: str = deviation_table,
    fillet_radius: float = fillet_radius,
    rear_spar: bool = rear_spar,
    rear_profile: str = rear_profile,
    block: bool = block,
) -> cq.Workplane:
    """Build the open shell of ``wing`` and ``spar``, or the block they bound.

    A fillet radius adds ``fillet``, a rear spar ``rear_spar`` and ``rear_fillet``. The faces are tagged by these
    names. The block goes on below the spar with ``skirt``, down to a flat ``floor``, and has ``back``, ``root`` and
    ``tip``.
    """
    sizes = {"span": span, "chord": chord, "spar_height": spar_height, "wavelength": wavelength, "length": length}
    check_sizes(sizes, spar_angle_deg, fillet_radius)
    g_w = named_profile("wing", wing_profile, wing_a, wing_radius, wing_table, span)
    f = named_deviation(deviation, c, span, wavelength, length, deviation_table)
    if spar_profile == "origami":
        fold = 1 / tan(radians(spar_angle_deg) / 2) if spar_angle_deg != 90 else 1.0

        def base(y: NDArray) -> NDArray:
            return fold * g_w(y)

    else:
        base = named_profile("spar", spar_profile, spar_a, spar_radius, spar_table, span)
        if deviation != "none":
            msg = f"spar_profile={spar_profile!r} is all of g_s: set deviation to 'none', not {deviation!r}"
            raise ValueError(msg)

    def g_s(y: NDArray) -> NDArray:
        return base(y) + f(y)

    rear = rear_crease(rear_profile, g_s, chord) if rear_spar else None
    check_apart(g_s, rear, span, chord, -spar_height * cos(radians(spar_angle_deg)))
    faces = block_faces(g_w, g_s, rear, span, chord, spar_height, spar_angle_deg)
    solid = cq.Solid.makeSolid(cq.Shell.makeShell(list(faces.values())))
    faces = dict(zip(faces, solid.Faces(), strict=True))  # sewing keeps the order
    if fillet_radius > 0:
        solid, faces = with_fillets(solid, faces, fillet_radius)
    if block:
        shape = cq.Workplane(solid)
    else:
        tool = ("wing", "spar", "rear_spar", "fillet", "rear_fillet")
        faces = {name: face for name, face in faces.items() if name in tool}
        shape = cq.Workplane(cq.Shell.makeShell(list(faces.values())))
    for name, face in faces.items():
        shape.newObject([face]).tag(name)
    return shape


def check_sizes(sizes: dict[str, float], spar_angle_deg: float, fillet_radius: float) -> None:
    """Refuse what is no wing; lengths in metres most of all."""
    for name, size in sizes.items():
        if not (size > 0 and isfinite(size)):
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    span, chord, spar_height = (sizes[name] for name in ("span", "chord", "spar_height"))
    if span < 100:
        msg = f"span={span}: lengths are in mm, and no wing is {span:g} mm long; for {span:g} m give {1000 * span:g}"
        raise ValueError(msg)
    if spar_height > chord:
        msg = f"spar_height={spar_height}: the spar is higher than the wing is wide, chord={chord}; are both in mm?"
        raise ValueError(msg)
    if not 0 < spar_angle_deg < 180:
        msg = f"spar_angle_deg={spar_angle_deg}: must lie between 0 and 180; 90 is perpendicular"
        raise ValueError(msg)
    if not 0 <= fillet_radius < min(chord, spar_height):
        msg = f"fillet_radius={fillet_radius}: must be 0 (sharp) or smaller than chord and spar_height"
        raise ValueError(msg)


def rear_crease(rear_profile: str, g_s: Profile, chord: float) -> Profile:
    """Return x of the rear crease."""
    if rear_profile == "mirror":
        return lambda y: chord - g_s(y)
    if rear_profile == "parallel":
        return lambda y: chord + g_s(y)
    msg = f"rear_profile={rear_profile!r} is not known: mirror, parallel"
    raise ValueError(msg)


def check_apart(g_s: Profile, rear: Profile | None, span: float, chord: float, undercut: float) -> None:
    """Refuse spars that cross each other, and one spar that leans under the whole wing."""
    y = np.linspace(0, span, 1001)
    if rear is None:
        if undercut >= chord:
            msg = f"chord={chord}: the spar leans {undercut:.0f} mm under the wing and past its far end; raise chord"
            raise ValueError(msg)
        return
    crossed = rear(y) - g_s(y) - 2 * max(undercut, 0.0) <= 0
    if crossed.any():
        msg = (
            f"chord={chord}: the front and the rear spar cross at y = {y[crossed.argmax()]:.0f} mm; raise chord, "
            "lower the deviation, or set rear_profile to 'parallel'"
        )
        raise ValueError(msg)


def named_profile(part: str, name: str, a: float, radius: float, table: str, span: float) -> Profile:
    """Return g(y) of a profile that stands by itself, mm; `part` is wing or spar."""
    if name == "real":
        slope, decaying_slope, decay = 0.047227544, 0.220721648, 3731.291642
        return lambda y: slope * y + decaying_slope * decay * (1 - np.exp(-y / decay))
    if name == "flat":
        return lambda y: 0 * y
    if name == "quadratic":
        return lambda y: a * y**2
    if name == "arc":
        if not radius > span:
            msg = f"{part}_radius={radius}: must be larger than the span, {span}"
            raise ValueError(msg)
        return lambda y: radius - np.sqrt(radius**2 - y**2)
    if name == "table":
        return spline(f"{part}_table", table, span)
    also = ", origami" if part == "spar" else ""
    msg = f"{part}_profile={name!r} is not known: real, flat, quadratic, arc, table{also}"
    raise ValueError(msg)


def named_deviation(name: str, c: float, span: float, wavelength: float, length: float, table: str) -> Profile:
    """Return f(y) = g_s - g_w, mm."""
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
    if name == "table":
        return spline("deviation_table", table, span)
    if name not in known:
        msg = f"deviation={name!r} is not known: {', '.join(known)}, table"
        raise ValueError(msg)
    return known[name]


def spline(parameter: str, table: str, span: float) -> Profile:
    """Interpolate a table by a cubic spline, the third derivative continuous at its first and last inner point."""
    from scipy.interpolate import CubicSpline

    points = table_points(parameter, table)
    if len(points) < 2:
        msg = f"{parameter}={table!r}: give at least two points, such as 0:0,{span:g}:100, or the name of a CSV file"
        raise ValueError(msg)
    at, value = np.array(points).T
    for before, after in pairwise(at):
        if not after > before:
            msg = f"{parameter}: y must increase, but {after:g} follows {before:g}"
            raise ValueError(msg)
    if at[0] > 0 or at[-1] < span:
        msg = f"{parameter} reaches from y = {at[0]:g} to {at[-1]:g} mm, the span from 0 to {span:g} mm: cover it"
        raise ValueError(msg)
    factor = CubicSpline(at, value).c  # highest power first

    def profile(y: NDArray) -> NDArray:  # scipy's own takes no complex y
        piece = np.clip(np.searchsorted(at, np.real(y), side="right") - 1, 0, len(at) - 2)
        t = y - at[piece]
        return ((factor[0][piece] * t + factor[1][piece]) * t + factor[2][piece]) * t + factor[3][piece]

    return profile


def table_points(parameter: str, table: str) -> list[list[float]]:
    """Read y and g of each point from the text, or from the CSV file it names; a head line is left out."""
    if table.lower().endswith((".csv", ".txt")):
        try:
            lines = Path(table).read_text(encoding="utf-8-sig").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            msg = f"{parameter}={table!r} cannot be read: {getattr(error, 'strerror', None) or 'it is no text'}"
            raise ValueError(msg) from error
        rows = [line.replace(";", ",").split(",") for line in lines if line.strip()]
        if rows and not any(character.isdigit() for character in "".join(rows[0])):
            rows = rows[1:]
    else:
        rows = [pair.split(":") for pair in table.split(",") if pair.strip()]
    points = []
    for row in rows:
        try:
            y, value = map(float, row)
        except ValueError:
            y = value = float("nan")
        if not isfinite(y + value):
            msg = f"{parameter}: {':'.join(row).strip()!r} is not a point y:g of two numbers, in mm"
            raise ValueError(msg)
        points.append([y, value])
    return points


def spanwise_edges(curves: Iterable[Curve], span: float) -> list[cq.Edge]:
    """Interpolate each (x(y), y, z(y)) by a cubic spline of parameter y, within 1e-4 mm, all with the same knots."""
    curves = list(curves)
    for intervals in (32, 64, 128, 256, 512, 1024, 2048):
        edges = [spanwise_edge(x, z, span, intervals) for x, z in curves]
        if all(edge is not None for edge in edges):
            return edges
    msg = f"the profiles change too fast along the span of {span} mm: raise wavelength or length, or lower c"
    raise ValueError(msg)


def spanwise_edge(x: Profile, z: Profile, span: float, intervals: int) -> cq.Edge | None:
    """Interpolate one curve, None if that many intervals are too few."""
    step = 1e-20  # derivative by a complex step: exact to round-off
    ends = [cq.Vector((x(y).imag / step), 1.0, z(y).imag / step) for y in np.array([0, span]) + 1j * step]
    y = np.linspace(0, span, intervals + 1)
    points = [cq.Vector(*xyz) for xyz in zip(x(y), y, z(y), strict=True)]
    edge = cq.Edge.makeSpline(points, tangents=ends, parameters=list(y), scale=False)
    between = (y[:-1] + y[1:]) / 2
    found = np.array([p.toTuple() for p in edge.positions(between, mode="parameter")])
    off = np.abs(found - np.stack([x(between), between, z(between)], axis=-1)).max()
    return edge if off < 1e-4 else None


def block_faces(
    g_w: Profile,
    g_s: Profile,
    rear: Profile | None,
    span: float,
    chord: float,
    spar_height: float,
    spar_angle_deg: float,
) -> dict[str, cq.Face]:
    """Make the faces of the tool block by name, wing and spar first.

    Ruled B-spline faces rather than extrusions: between two equal curves a tessellator then puts vertices on
    the curves alone, its edges follow the rulings, and the facets are as developable as the face.
    """
    angle = radians(spar_angle_deg)
    across, down = (0.0, spar_height) if spar_angle_deg == 90 else (spar_height * cos(angle), spar_height * sin(angle))
    floor_z = g_w(np.linspace(0, span, 1001)).min() - 1.2 * down

    def at_floor(x: Profile, lean: float) -> Curve:
        return (lambda y: x(y) + lean), (lambda y: 0 * y + floor_z)

    if rear is None:
        (crease,) = spanwise_edges([(g_s, g_w)], span)
        trailing = rear_hem = crease.translate(cq.Vector(chord, 0, 0))
        (toe,) = spanwise_edges([at_floor(g_s, -across)], span)
        heel = toe.translate(cq.Vector(chord + across, 0, 0))
    else:
        crease, trailing = spanwise_edges([(g_s, g_w), (rear, g_w)], span)
        rear_hem = trailing.translate(cq.Vector(across, 0, -down))
        toe, heel = spanwise_edges([at_floor(g_s, -across), at_floor(rear, across)], span)
    hem = crease.translate(cq.Vector(-across, 0, -down))
    ring = [crease, trailing, *([rear_hem] if rear else []), heel, toe, hem]

    def end_plane(corners: list[cq.Vector]) -> cq.Face:
        return cq.Face.makeFromWires(cq.Wire.makePolygon(corners, close=True))

    return {
        "wing": cq.Face.makeRuledSurface(crease, trailing),
        "spar": cq.Face.makeRuledSurface(crease, hem),
        **({"rear_spar": cq.Face.makeRuledSurface(trailing, rear_hem)} if rear else {}),
        "skirt": cq.Face.makeRuledSurface(hem, toe),
        "floor": cq.Face.makeRuledSurface(toe, heel),
        "back": cq.Face.makeRuledSurface(rear_hem, heel),
        "root": end_plane([edge.startPoint() for edge in ring]),
        "tip": end_plane([edge.endPoint() for edge in ring]),
    }


def with_fillets(
    solid: cq.Solid, faces: dict[str, cq.Face], fillet_radius: float
) -> tuple[cq.Solid, dict[str, cq.Face]]:
    """Round the edges between wing and spars; return the block and its faces by name."""
    creases = {
        fillet: next(edge for edge in faces["wing"].Edges() if any(edge.isSame(e) for e in faces[spar].Edges()))
        for fillet, spar in (("fillet", "spar"), ("rear_fillet", "rear_spar"))
        if spar in faces
    }
    rounding = BRepFilletAPI_MakeFillet(solid.wrapped)
    for crease in creases.values():
        rounding.Add(fillet_radius, crease.wrapped)
    rounding.Build()
    if not (rounding.IsDone() and cq.Shape.cast(rounding.Shape()).isValid()):
        msg = f"fillet_radius={fillet_radius}: no such fillet fits along the crease"
        raise ValueError(msg)
    rounded = cq.Shape.cast(rounding.Shape()).Solids()[0]
    made = {}
    for name, face in faces.items():
        changed = rounding.Modified(face.wrapped)
        made[name] = changed.First() if changed.Size() else face.wrapped
    for name, crease in creases.items():
        made[name] = rounding.Generated(crease.wrapped).First()
    # The history gives faces as they are stored; the solid has them with their outward orientation.
    return rounded, {
        name: next(face for face in rounded.Faces() if face.wrapped.IsSame(old)) for name, old in made.items()
    }


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
