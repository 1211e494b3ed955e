"""Blade root: the suction side of a wind turbine blade where its round root becomes an aerofoil, cloth on the outside.

z runs along the blade from the root. With theta from 0 at the trailing edge to pi at the leading edge, and
v = z / length, the surface is (1 - b) times the half circle (R cos(theta), R sin(theta)) plus b times the aerofoil's
upper side, with b = 3 v^2 - 2 v^3, which leaves the root and arrives at the aerofoil without a kink. The aerofoil is
symmetric: at the fraction xi = (1 - theta / pi)^2 of its chord from the nose it has the half thickness of the NACA
four-digit series, below. It is drawn about the point axis_fraction of the chord behind its nose, and turned by the
twist::

    5 t (0.2969 sqrt(xi) - 0.1260 xi - 0.3516 xi^2 + 0.2843 xi^3 - 0.1015 xi^4)

One face, a tensor product of a cubic spline round the section and a cubic polynomial along the blade; it follows
the formula to 1e-4 mm.

Lengths in millimetres. Facts, exact, with a root of 1000, a chord of 1600, t = 0.3 and 12° of twist over 3000 mm:

:Area: 4900438.486 mm²
:Gaussian curvature: both signs: at theta = π/2 3.1237e-7 mm⁻² at the root and -1.2103e-7 mm⁻² at v = 0.9
:Flat length: π R = 1570.796 mm round the root, 1736.726 mm round the aerofoil
:Shear: no closed form
:Source: the formulas above; E. N. Jacobs, K. E. Ward and R. M. Pinkerton, NACA report 460, 1933
"""

from __future__ import annotations

from math import radians

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt
from OCP.TColgp import TColgp_Array2OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

root_diameter = 1000.0  # 2 R
chord = 1600.0  # of the aerofoil
thickness = 0.3  # t, of the aerofoil, of its chord
twist_deg = 12.0  # of the aerofoil against the root's axes, nose up
axis_fraction = 0.35  # of the chord from nose to blade axis
length = 3000.0  # from root to aerofoil


def build(
    *,
    root_diameter: float = root_diameter,
    chord: float = chord,
    thickness: float = thickness,
    twist_deg: float = twist_deg,
    axis_fraction: float = axis_fraction,
    length: float = length,
) -> cq.Workplane:
    """Build the patch, one face with its normal outwards."""
    for name, size in (("root_diameter", root_diameter), ("chord", chord), ("length", length)):
        if not size > 0:
            msg = f"{name}={size}: must be positive"
            raise ValueError(msg)
    if not 0 < thickness < 1:
        msg = f"thickness={thickness}: must lie between 0 and 1, a fraction of the chord"
        raise ValueError(msg)
    if not 0 <= axis_fraction <= 1:
        msg = f"axis_fraction={axis_fraction}: must lie between 0 and 1"
        raise ValueError(msg)
    if not -90 <= twist_deg <= 90:
        msg = f"twist_deg={twist_deg}: must lie between -90 and 90"
        raise ValueError(msg)
    knots, poles = sections(root_diameter / 2, chord, thickness, radians(twist_deg), axis_fraction)
    grid = TColgp_Array2OfPnt(1, poles.shape[1], 1, 4)
    for i, (circle, aerofoil) in enumerate(zip(*poles, strict=True), start=1):
        for j in range(4):  # b has the Bernstein factors 0, 0, 1, 1
            x, y = circle if j < 2 else aerofoil
            grid.SetValue(i, j + 1, gp_Pnt(x, y, length * j / 3))
    count = len(knots)
    surface = Geom_BSplineSurface(
        grid,
        reals(knots),
        reals([0.0, 1.0]),
        integers([4, *[1] * (count - 2), 4]),
        integers([4, 4]),
        3,
        3,
    )
    # The tolerance of MakeFace only tells it which edges of the patch have shrunk to a point.
    face = cq.Face(BRepBuilderAPI_MakeFace(surface, 1e-6).Face())
    if face.normalAt().y < 0:
        face = cq.Face(face.wrapped.Reversed())
    return cq.Workplane(face)


def sections(
    radius: float, chord: float, thickness: float, twist: float, axis_fraction: float
) -> tuple[list[float], NDArray]:
    """Return knots and poles, (2, n, 2), of half circle and aerofoil as cubic splines of theta."""
    from scipy.interpolate import make_interp_spline

    turn = np.array([[np.cos(twist), np.sin(twist)], [-np.sin(twist), np.cos(twist)]])

    def both(theta: NDArray) -> NDArray:
        circle = radius * np.stack([np.cos(theta), np.sin(theta)], axis=-1)
        s = 1 - theta / np.pi  # sqrt(xi), smooth round the nose
        xi = s**2
        half = 5 * thickness * (0.2969 * s - 0.1260 * xi - 0.3516 * xi**2 + 0.2843 * xi**3 - 0.1015 * xi**4)
        return np.stack([circle, chord * np.stack([xi - axis_fraction, half], axis=-1) @ turn.T], axis=-2)

    step = 1e-20  # derivative by a complex step: exact to round-off
    first, last = both(np.array([0, np.pi]) + 1j * step).imag / step
    for intervals in (64, 128, 256, 512):
        theta = np.linspace(0, np.pi, intervals + 1)
        spline = make_interp_spline(theta, both(theta), k=3, bc_type=([(1, first)], [(1, last)]))
        between = (theta[:-1] + theta[1:]) / 2
        if np.abs(spline(between) - both(between)).max() < 1e-4:
            return theta.tolist(), np.moveaxis(spline.c, 1, 0)
    msg = f"chord={chord}: too large for a section within 1e-4 mm; is it in mm?"
    raise ValueError(msg)


def reals(values: list[float]) -> TColStd_Array1OfReal:
    """Copy numbers into an array of Open CASCADE."""
    array = TColStd_Array1OfReal(1, len(values))
    for index, value in enumerate(values, start=1):
        array.SetValue(index, value)
    return array


def integers(values: list[int]) -> TColStd_Array1OfInteger:
    """Copy whole numbers into an array of Open CASCADE."""
    array = TColStd_Array1OfInteger(1, len(values))
    for index, value in enumerate(values, start=1):
        array.SetValue(index, value)
    return array


if "show_object" in globals():
    show_object(build())  # type: ignore[name-defined]  # noqa: F821
