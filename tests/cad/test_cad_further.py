"""What the further moulds are known to be beyond the common facts: ends, limits, sides, joints."""

from __future__ import annotations

import re

import blade_root
import double_dome
import hat
import joggle
import l_corner
import leading_edge
import make_samples
import numpy as np
import pyramid
import pytest
import saddle
from further_facts import naca_2412, naca_2412_of_root
from mould_facts import over_square
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepLProp import BRepLProp_SLProps
from tessellated import tessellate

AWAY, HIGH = 110.0, np.sqrt(260.0**2 - 110.0**2)  # of the double dome: d and h
TOUCH = AWAY * 200 / 260


def numbers(script, field: str, unit: str) -> list[float]:
    stated = make_samples.facts(script.__doc__)[field]
    return [float(number) for number in re.findall(rf"(-?[\d.]+(?:e-?\d+)?) {unit}", stated)]


def outline_of_double_dome(x: np.ndarray) -> np.ndarray:
    """Radius of the body of revolution at x."""
    with np.errstate(invalid="ignore"):
        waist, dome = HIGH - np.sqrt(200**2 - x**2), np.sqrt(60**2 - (np.abs(x) - AWAY) ** 2)
    return np.where(np.abs(x) < TOUCH, waist, dome)


def test_double_dome_without_fillet_has_the_areas_stated():
    shape = double_dome.build(fillet_radius=0.0)
    area = {name: sum(face.Area() for face in tagged.vals()) for name, tagged in shape.ctx.tags.items()}
    assert area["left"] == pytest.approx(area["right"], rel=1e-9)
    found = [area["left"] + area["right"], area["waist"], area["rim"]]
    assert numbers(double_dome, "Area", "mm²") == pytest.approx(found, rel=1e-7)
    assert found[0] == pytest.approx(2 * np.pi * 60**2 * (1 + AWAY / 260), rel=1e-9)


def test_double_dome_lies_on_its_body_and_its_curvature_adds_up_to_nothing():
    shape = double_dome.build()
    mesh = tessellate(shape, 0.05, np.radians(5))
    names = {name: tagged.vals() for name, tagged in shape.ctx.tags.items()}
    assert {name: len(faces) for name, faces in names.items()} == {
        "left": 1, "waist": 1, "right": 1, "fillet": 4, "rim": 1
    }  # fmt: skip
    for index, face in enumerate(shape.val().Faces()):
        p = mesh.vertices[np.unique(mesh.triangles[mesh.triangle_face == index])]
        if any(face.isSame(other) for name in ("left", "waist", "right") for other in names[name]):
            assert np.abs(np.hypot(p[:, 1], p[:, 2]) - outline_of_double_dome(p[:, 0])).max() < 1e-3
        elif face.geomType() == "PLANE":
            assert np.abs(p[:, 2]).max() < 1e-6
    assert (mesh.triangle_vector[:, 2] > -1e-9).all()  # nothing overhangs, all looks up
    corner = mesh.vertices[mesh.triangles]
    side = np.roll(corner, -1, axis=1) - corner
    side /= np.linalg.norm(side, axis=2, keepdims=True)
    angle = np.arccos(np.clip(-np.einsum("ijk,ijk->ij", side, np.roll(side, 1, axis=1)), -1, 1))
    total = np.zeros(len(mesh.vertices))
    np.add.at(total, mesh.triangles, angle)
    inside = np.setdiff1d(np.arange(len(total)), mesh.border)
    assert (2 * np.pi - total[inside]).sum() == pytest.approx(0, abs=1e-6)
    assert len(mesh.vertices) - len(mesh.edge_uses) / 2 - len(mesh.border) / 2 + len(mesh.triangles) == 1


def test_double_dome_curvature_and_ridge_are_those_stated():
    dome, waist = numbers(double_dome, "Gaussian curvature", "mm⁻²")
    assert (dome, waist) == pytest.approx((1 / 60**2, -1 / (200 * (HIGH - 200))), rel=1e-5)
    bend = np.arcsin(AWAY / 260)
    assert numbers(double_dome, "Flat length", "mm") == pytest.approx([200 * bend + 60 * (np.pi / 2 + bend)], abs=1e-3)


def test_double_dome_is_symmetric():
    shape = double_dome.build()
    mesh_area = {name: sum(face.Area() for face in tagged.vals()) for name, tagged in shape.ctx.tags.items()}
    assert mesh_area["left"] == pytest.approx(mesh_area["right"], rel=1e-4)
    box = shape.val().BoundingBox()
    assert (box.xmin + box.xmax, box.ymin + box.ymax, box.zmax) == pytest.approx((0, 0, 60), abs=1e-3)


def test_hat_meridian_is_that_stated():
    foot, leave = np.sqrt(100**2 + 4000), np.arcsin(1 / 6)
    assert numbers(hat, "Flat length", "mm") == pytest.approx([120 * (np.pi / 2 - leave) + 200 - foot], abs=1e-3)


def test_tangent_faces_join_without_a_kink():
    """Across an edge that two faces share, their normals agree."""
    for script in (hat, joggle, l_corner, leading_edge):
        faces = script.build().val().Faces()
        joints = 0
        for first, face in enumerate(faces):
            for other in faces[first + 1 :]:
                for edge in face.Edges():
                    if any(edge.isSame(shared) for shared in other.Edges()):
                        middle = edge.positionAt(0.37)
                        # the spline of the nose repeats the direction of the section at its end
                        assert face.normalAt(middle).dot(other.normalAt(middle)) == pytest.approx(1, abs=1e-9)
                        joints += 1
        assert joints >= len(faces) - 1


def test_corner_may_be_concave():
    convex, concave = l_corner.build(), l_corner.build(concave=True)
    for outer, inner in zip(convex.val().Faces(), concave.val().Faces(), strict=True):
        assert outer.normalAt().toTuple() == pytest.approx((-inner.normalAt()).toTuple(), abs=1e-12)
        assert outer.Area() == pytest.approx(inner.Area(), rel=1e-12)


@pytest.mark.parametrize(("sides", "apex_angle_deg"), [(3, 90.0), (3, 119.0), (4, 60.0), (7, 20.0)])
def test_pyramid_has_the_angle_asked_for_at_its_apex(sides, apex_angle_deg):
    shape = pyramid.build(sides=sides, apex_angle_deg=apex_angle_deg, slant=100.0)
    mesh = tessellate(shape)
    (apex,) = np.flatnonzero((np.abs(mesh.vertices) < 1e-12).all(axis=1))
    assert len(mesh.triangles) == sides == (mesh.triangles == apex).any(axis=1).sum()
    for triangle in mesh.triangles:
        a, b = (mesh.vertices[vertex] for vertex in triangle if vertex != apex)
        assert np.linalg.norm([a, b], axis=1) == pytest.approx([100, 100])
        assert np.degrees(np.arccos(a @ b / 1e4)) == pytest.approx(apex_angle_deg)
    assert (mesh.triangle_vector[:, 2] > 0).all()
    assert set(shape.ctx.tags) == {f"side_{number}" for number in range(1, sides + 1)}


def test_saddle_is_the_hypar_turned_by_half_a_right_angle():
    """The node stated is the hyperbolic paraboloid's own, (762.6122, 762.6122, 581.5774), turned."""
    stated = make_samples.facts(saddle.__doc__)
    assert f"({762.6122 * np.sqrt(2):.4f}, 0, 581.5774)" in stated["Shear"]
    along, straight = numbers(saddle, "Flat length", "mm")
    arc = over_square(0, 1200, lambda x, y: np.hypot(1, x / 1000)) / 1200
    assert (along, straight) == pytest.approx((2 * arc, 2400 * np.sqrt(2)), abs=1e-3)
    face = saddle.build().val()
    surface = BRepAdaptor_Surface(face.wrapped)
    for t in np.linspace(0, 1, 5):
        assert surface.Value(t, t).Z() == pytest.approx(0, abs=1e-9)
        assert surface.Value(t, 1 - t).Z() == pytest.approx(0, abs=1e-9)


def test_leading_edge_lengths_are_those_stated():
    depth = np.sqrt(0.3)

    def length(side):
        def speed(_, s):
            return np.hypot(*(1e20 * naca_2412_of_root(s + 1e-20j, side)).imag)

        return over_square(0, depth, speed) / depth

    expected = [length(1.0), length(-1.0), 2000 / np.cos(np.radians(25))]
    assert numbers(leading_edge, "Flat length", "mm") == pytest.approx(expected, abs=1e-3)
    assert numbers(leading_edge, "Gaussian curvature", "mm") == pytest.approx([1.1019 * 0.12**2 * 1000], abs=1e-3)


def test_tapered_leading_edge_is_a_cone():
    """Its rulings meet in the point where the chord would vanish, so it unrolls; tip and root are similar."""
    shape = leading_edge.build(tip_chord=400.0)
    apex = np.array([2000 * np.tan(np.radians(25)), 2000.0, 0]) / 0.6
    for face in shape.val().Faces():
        surface = BRepAdaptor_Surface(face.wrapped)
        ends = surface.FirstVParameter(), surface.LastVParameter()
        for u in np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 21):
            root, tip = sorted((np.array(surface.Value(u, v).Coord()) for v in ends), key=lambda p: p[1])
            assert (tip - apex) == pytest.approx(0.4 * (root - apex), abs=1e-8)


@pytest.mark.parametrize("naca", ["2412", "0012", "4415", "4408"])
def test_leading_edge_of_any_four_digits_is_smooth_at_the_nose(naca):
    shape = leading_edge.build(naca=naca, depth=0.4)
    upper, lower = (shape.ctx.tags[name].val() for name in ("upper", "lower"))
    (nose,) = [edge for edge in upper.Edges() if any(edge.isSame(other) for other in lower.Edges())]
    middle = nose.positionAt(0.5)
    assert upper.normalAt(middle).dot(lower.normalAt(middle)) == pytest.approx(1, abs=1e-9)
    assert upper.normalAt().z > 0.9
    assert lower.normalAt().z < -0.9


def test_section_of_the_facts_is_the_same_either_way():
    xi = np.linspace(0, 0.3, 7)
    assert pytest.approx(naca_2412_of_root(np.sqrt(xi), -1.0), abs=1e-12) == naca_2412(xi, -1.0).T


@pytest.mark.parametrize("naca", ["12", "24123", "abcd", "2400", "2012"])
def test_what_is_no_section_is_refused(naca):
    with pytest.raises(ValueError, match=f"naca='{naca}': four digits"):
        leading_edge.build(naca=naca)


def blade(theta: np.ndarray, v: np.ndarray) -> np.ndarray:
    """The formula of the docstring, (..., 3), analytic."""
    s = 1 - theta / np.pi
    xi = s * s
    half = 1.5 * (0.2969 * s - 0.1260 * xi - 0.3516 * xi**2 + 0.2843 * xi**3 - 0.1015 * xi**4)
    x, y, twist, b = 1600 * (xi - 0.35), 1600 * half, np.radians(12), 3 * v**2 - 2 * v**3
    x, y = np.cos(twist) * x + np.sin(twist) * y, np.cos(twist) * y - np.sin(twist) * x
    circle = 500 * np.cos(theta), 500 * np.sin(theta)
    return np.stack([(1 - b) * circle[0] + b * x, (1 - b) * circle[1] + b * y, 3000 * v + 0 * theta], axis=-1)


def test_blade_root_follows_its_formula():
    surface = BRepAdaptor_Surface(blade_root.build().val().wrapped)
    for theta in np.linspace(0, np.pi, 61):
        for v in np.linspace(0, 1, 9):
            found = np.array(surface.Value(theta, v).Coord())
            assert found == pytest.approx(blade(np.array(theta), np.array(v)), abs=1e-4)


def test_blade_root_facts_are_those_stated():
    def patch(t, v):  # both over [0, 1]
        along_theta = (1e20 * blade(np.pi * t + 1e-20j, v)).imag
        along_v = (1e20 * blade(np.pi * t, v + 1e-20j)).imag
        return np.pi * np.linalg.norm(np.cross(along_theta, along_v), axis=-1)

    def round_the_tip(t, _):
        return np.pi * np.linalg.norm((1e20 * blade(np.pi * t + 1e-20j, 1.0)).imag, axis=-1)

    face = blade_root.build().val()
    area = over_square(0, 1, patch)
    assert numbers(blade_root, "Area", "mm²") == pytest.approx([area], abs=1e-3)
    assert face.Area() == pytest.approx(area, rel=1e-6)
    assert face.normalAt().y > 0.9
    lengths = numbers(blade_root, "Flat length", "mm")
    assert lengths == pytest.approx([500 * np.pi, over_square(0, 1, round_the_tip)], abs=1e-3)
    surface = BRepAdaptor_Surface(face.wrapped)
    found = [BRepLProp_SLProps(surface, np.pi / 2, v, 2, 1e-9).GaussianCurvature() for v in (0.0, 0.9)]
    # second derivatives of the spline are good to the square of its intervals
    assert numbers(blade_root, "Gaussian curvature", "mm⁻²") == pytest.approx(found, rel=1e-3)
