"""Leading edge: the nose of a NACA four-digit wing, straight, swept or tapered, cloth on the outside.

y runs along the span from the root, x along the chord from the root's leading edge, z up. With xi the fraction of the
chord, the section is z = camber line ± thickness, the thickness measured at right angles to the camber line::

    5 t (0.2969 sqrt(xi) - 0.1260 xi - 0.3516 xi^2 + 0.2843 xi^3 - 0.1015 xi^4)

covered from the nose to xi = depth on both sides, the largest camber at most. The tip section is the root's,
tip_chord / chord times as large, its leading edge at (span tan(sweep), span, 0). So the surface is a cylinder, or a
cone if it tapers: developable. Upper and lower side are two faces that meet smoothly in the nose; each follows the
section to 1e-4 mm.

Lengths in millimetres. Facts, exact, with NACA 2412, a chord of 1000, a depth of 0.3, a span of 2000, swept by 25° and
without taper:

:Area: upper: 649249.476 mm²; lower: 631647.207 mm²
:Gaussian curvature: 0; the nose has a radius of 1.1019 t² · chord = 15.867 mm in the section
:Flat length: 320.883 mm over the upper side of the section and 313.754 mm over the lower; 2206.756 mm along the nose
:Shear: 0 from any seed in any direction
:Source: a developable surface with two straight fibres at right angles; E. N. Jacobs, K. E. Ward and R. M. Pinkerton,
    NACA report 460, 1933
"""

from __future__ import annotations

from collections.abc import Callable
from math import radians, tan

import cadquery as cq
import numpy as np
from numpy.typing import NDArray

naca = "2412"  # camber in hundredths, its place in tenths, thickness in hundredths of the chord
chord = 1000.0  # of the root
tip_chord = 1000.0  # of the tip
span = 2000.0  # from root to tip
sweep_deg = 25.0  # of the leading edge, backwards
depth = 0.3  # fraction of the chord covered on both sides


def build(
    *,
    naca: str = naca,
    chord: float = chord,
    tip_chord: float = tip_chord,
    span: float = span,
    sweep_deg: float = sweep_deg,
    depth: float = depth,
) -> cq.Workplane:
    """Build the open shell of ``upper`` and ``lower``, normals outwards."""
    for name, size in (("chord", chord), ("tip_chord", tip_chord), ("span", span)):
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not -80 <= sweep_deg <= 80:
        msg = f"sweep_deg={sweep_deg}: must lie between -80 and 80"
        raise ValueError(msg)
    if not 0.01 <= depth <= 0.99:
        msg = f"depth={depth}: the fraction of the chord covered must lie between 0.01 and 0.99"
        raise ValueError(msg)
    if not (len(naca) == 4 and naca.isdigit() and int(naca[2:])) or (naca[0] != "0" and naca[1] == "0"):
        msg = f"naca={naca!r}: four digits such as 0012 or 2412, of a section with a thickness"
        raise ValueError(msg)
    across = cq.Vector(span * tan(radians(sweep_deg)), span, 0)
    if naca[0] != "0" and depth > int(naca[1]) / 10:
        msg = (
            f"depth={depth}: NACA {naca} is covered to its largest camber at most, at {int(naca[1]) / 10} of the chord"
        )
        raise ValueError(msg)
    faces = {}
    for name, side in (("upper", 1.0), ("lower", -1.0)):
        root = section_edge(section(naca, side), chord, depth)
        tip = (root if tip_chord == chord else root.scale(tip_chord / chord)).translate(across)
        faces[name] = cq.Face.makeRuledSurface(root, tip)
    shell = cq.Shell.makeShell(list(faces.values()))
    if shell.Faces()[0].normalAt().z < 0:
        shell = cq.Shell(shell.wrapped.Reversed())
    shape = cq.Workplane(shell)
    for name, face in zip(faces, shell.Faces(), strict=True):
        shape.newObject([face]).tag(name)
    return shape


def section(naca: str, side: float) -> Callable[[NDArray], NDArray]:
    """Return (x, z) over the chord of one side as a function of s = sqrt(xi), in which the nose is smooth.

    It holds up to the place of the largest camber, behind which the camber line is another parabola.
    """
    camber, place, thickness = int(naca[0]) / 100, int(naca[1]) / 10 or 1.0, int(naca[2:]) / 100

    def at(s: NDArray) -> NDArray:
        xi = s**2
        half = 5 * thickness * (0.2969 * s - 0.1260 * xi - 0.3516 * xi**2 + 0.2843 * xi**3 - 0.1015 * xi**4)
        line = camber / place**2 * (2 * place * xi - xi**2)
        slope = np.arctan(2 * camber / place**2 * (place - xi))
        return np.stack([xi - side * half * np.sin(slope), line + side * half * np.cos(slope)], axis=-1)

    return at


def section_edge(at: Callable[[NDArray], NDArray], chord: float, depth: float) -> cq.Edge:
    """Interpolate one side of the root section from nose to depth, within 1e-4 mm."""
    step = 1e-20  # derivative by a complex step: exact to round-off
    ends = np.array([0, depth**0.5])
    slopes = chord * at(ends + 1j * step).imag / step
    for intervals in (32, 64, 128, 256, 512, 1024, 2048):
        s = np.linspace(*ends, intervals + 1)
        points = [cq.Vector(x, 0, z) for x, z in chord * at(s)]
        edge = cq.Edge.makeSpline(
            points, tangents=[cq.Vector(x, 0, z) for x, z in slopes], parameters=list(s), scale=False
        )
        between = (s[:-1] + s[1:]) / 2
        found = np.array([(p.x, p.z) for p in edge.positions(between, mode="parameter")])
        if np.abs(found - chord * at(between)).max() < 1e-4:
            return edge
    msg = f"chord={chord}: too large for a section within 1e-4 mm; is it in mm?"
    raise ValueError(msg)


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
