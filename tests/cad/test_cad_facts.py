"""Each script builds what its docstring says: the numbers there against formulas, the B-rep and its triangles."""

from __future__ import annotations

import re
from collections.abc import Callable
from types import ModuleType

import cadquery as cq
import cone
import cube_corner
import cylinder
import hemisphere
import hypar
import krogh_double_curved
import make_samples
import numpy as np
import pytest
import wing_spar
from further_facts import FURTHER
from mould_facts import Fact, over_square
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepLProp import BRepLProp_SLProps
from references import sphere_angle
from tessellated import Tessellation, tessellate

KROGH = np.array([[0, 1.089, -3.75, 4.321], [1.004, -4.4, 0, 0], [-3.667, 8.889, 0, 0], [3.086, 0, 0, 0]])
"""Factor of x^i y^j, metres."""


def krogh_derivative(x: np.ndarray, y: np.ndarray, i: int, j: int) -> np.ndarray:
    """Derivative of z, of order i in x and j in y; mm in, powers of mm out."""
    factors = np.polynomial.polynomial.polyder(np.polynomial.polynomial.polyder(KROGH, i, axis=0), j, axis=1)
    return np.polynomial.polynomial.polyval2d(x / 1000, y / 1000, factors) * 1000.0 ** (1 - i - j)


def real_slope(y: np.ndarray) -> np.ndarray:
    return 0.047227544 + 0.220721648 * np.exp(-y / 3731.291642)


def along_span(integrand: Callable[[np.ndarray], np.ndarray]) -> float:
    return over_square(0, 14000, lambda x, y: integrand(y)) / 14000


def curvature_of_krogh(p: np.ndarray) -> np.ndarray:
    xx, xy, yy = (krogh_derivative(p[:, 0], p[:, 1], *order) for order in ((2, 0), (1, 1), (0, 2)))
    return (xx * yy - xy**2) / krogh_stretch(p[:, 0], p[:, 1]) ** 4


def krogh_stretch(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return np.sqrt(1 + krogh_derivative(x, y, 1, 0) ** 2 + krogh_derivative(x, y, 0, 1) ** 2)


def off_wing_spar(t: Tessellation) -> np.ndarray:
    x, y, z = t.vertices.T
    g_w = 0.047227544 * y + 0.220721648 * 3731.291642 * (1 - np.exp(-y / 3731.291642))
    g_s = g_w + 0.1 * y**2 / 28000
    return np.minimum(np.abs(z - g_w), np.abs(x - g_s))


def radial(p: np.ndarray) -> np.ndarray:
    return p * [1, 1, 0]


FACTS = (
    Fact(
        hemisphere,
        (2 * np.pi * 500**2,),
        lambda t: np.linalg.norm(t.vertices, axis=1) - 500,
        lambda p: p,
        lambda p: np.full(len(p), 1 / 500**2),
        1 / 500,
    ),
    Fact(
        cylinder,
        (np.pi * 500 * 1800,),
        lambda t: np.hypot(*t.vertices.T[:2]) - 500,
        radial,
        largest_curvature=1 / 500,
    ),
    Fact(
        cone,
        (np.radians(240) * np.sin(np.radians(25)) * (1900**2 - 300**2) / 2,),
        lambda t: np.hypot(*t.vertices.T[:2]) - np.tan(np.radians(25)) * t.vertices[:, 2],
        radial,
        largest_curvature=1 / (300 * np.tan(np.radians(25))),
    ),
    Fact(
        hypar,
        (over_square(-1300, 1300, lambda x, y: np.sqrt(1 + 1e-6 * (x**2 + y**2))),),
        lambda t: t.vertices[:, 2] - 1e-3 * t.vertices[:, 0] * t.vertices[:, 1],
        lambda p: np.tile([0, 0, 1], (len(p), 1)),
        lambda p: -1e-6 / (1 + 1e-6 * (p[:, 0] ** 2 + p[:, 1] ** 2)) ** 2,
        1e-3,
    ),
    Fact(
        cube_corner,
        (3 * 1000**2,),
        lambda t: t.vertices.min(axis=1),
        lambda p: -(p < 1e-9).astype(float),
    ),
    Fact(
        krogh_double_curved,
        (over_square(0, 500, krogh_stretch),),
        lambda t: t.vertices[:, 2] - krogh_derivative(*t.vertices.T[:2], 0, 0),
        lambda p: np.tile([0, 0, 1], (len(p), 1)),
        curvature_of_krogh,
        0.008,
    ),
    Fact(
        wing_spar,
        (
            3000 * along_span(lambda y: np.hypot(1, real_slope(y))),
            1000 * along_span(lambda y: np.hypot(1, real_slope(y) + 0.1 * y / 14000)),
        ),
        off_wing_spar,
        lambda p: np.tile([-1, 0, 1], (len(p), 1)),
        largest_curvature=0.220721648 / 3731.291642,
    ),
    *FURTHER,
)
each_mould = pytest.mark.parametrize("fact", FACTS, ids=lambda fact: fact.script.__name__)


@pytest.fixture(scope="module")
def built() -> dict[ModuleType, cq.Workplane]:
    return {fact.script: fact.script.build() for fact in FACTS}


@each_mould
def test_docstring_states_the_exact_area(fact):
    stated = make_samples.facts(fact.script.__doc__)["Area"]
    numbers = [float(number) for number in re.findall(r"([\d.]+) mm²", stated)]
    assert numbers == pytest.approx(fact.areas, abs=1e-3)  # printed to three decimals


@each_mould
def test_brep_is_valid_and_has_the_exact_area(fact, built):
    shape = built[fact.script].val()
    assert shape.isValid()
    # Open CASCADE integrates areas by a fixed number of Gauss points: 1.2e-7 off for the cubic patch.
    assert shape.Area() == pytest.approx(sum(fact.areas), rel=5e-7)


@each_mould
def test_brep_has_the_gaussian_curvature(fact, built):
    for face in built[fact.script].val().Faces():
        surface = BRepAdaptor_Surface(face.wrapped)
        u = np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 7)[1:-1]
        v = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 7)[1:-1]
        local = [BRepLProp_SLProps(surface, a, b, 2, 1e-9) for a in u for b in v]
        found = np.array([at.GaussianCurvature() for at in local])
        points = np.array([at.Value().Coord() for at in local])
        np.testing.assert_allclose(found, fact.curvature(points), rtol=1e-9, atol=1e-18)


@each_mould
def test_tessellation_lies_on_the_surface_and_keeps_the_area(fact, built):
    chord = 0.2
    mesh = tessellate(built[fact.script], chord, np.radians(5.0))
    assert np.abs(fact.off(mesh)).max() < 1e-4  # the wing's profiles are interpolated that well, the rest is exact
    # A gap h changes the area by 2 h times the mean curvature, the tilt of facets by as much again.
    assert mesh.area == pytest.approx(sum(fact.areas), rel=4 * chord * fact.largest_curvature + 1e-12)


@each_mould
def test_tessellation_is_one_oriented_piece_with_the_cloth_outside(fact, built):
    mesh = tessellate(built[fact.script], 0.5, np.radians(5.0))
    assert set(mesh.edge_uses.values()) == {1}
    assert all(len(set(triangle)) == 3 for triangle in mesh.triangles.tolist())
    # A single border loop: every border vertex is left once and reached once.
    assert len(np.unique(mesh.border[:, 0])) == len(mesh.border) == len(np.unique(mesh.border[:, 1]))
    euler = len(mesh.vertices) - (3 * len(mesh.triangles) + len(mesh.border)) / 2 + len(mesh.triangles)
    assert euler == 1  # a disk: nothing is left unwelded
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    assert (np.einsum("ij,ij->i", mesh.triangle_vector, fact.outward(middle)) > 0).all()


def test_hemisphere_shear_is_that_of_the_smooth_net():
    stated = make_samples.facts(hemisphere.__doc__)["Shear"]
    on_diagonal = re.findall(r"([\d.]+)° at (?:([\d.]+) )?R", stated)
    assert len(on_diagonal) == 3
    for shear, along in on_diagonal:
        found = 90 - np.degrees(sphere_angle(float(along or 1) ** 2))
        assert found == pytest.approx(float(shear), abs=6e-6)
    assert sphere_angle(float(re.search(r"locks at u v = ([\d.]+) R²", stated)[1])) == pytest.approx(0, abs=1e-6)


def test_wing_spar_lengths_and_fold_are_those_stated():
    stated = make_samples.facts(wing_spar.__doc__)
    lengths = [float(number) for number in re.findall(r"([\d.]+) mm", stated["Flat length"])]
    end = np.array(14000.0)

    def spar_slope(y):
        return real_slope(y) + 0.1 * y / 14000

    expected = [
        along_span(lambda y: np.hypot(1, real_slope(y))),
        along_span(lambda y: np.hypot(1, spar_slope(y))),
        along_span(lambda y: np.sqrt(1 + real_slope(y) ** 2 + spar_slope(y) ** 2)),
    ]
    assert lengths == pytest.approx(expected, abs=1e-3)
    alpha = np.arctan(spar_slope(end) / np.hypot(1, real_slope(end)))
    beta = np.arctan(real_slope(end) / np.hypot(1, spar_slope(end)))
    assert f"{np.degrees(beta - alpha):.5f}° at y = 14000 mm" in stated["Gaussian curvature"]


def test_krogh_heights_and_curvatures_are_those_stated():
    stated = make_samples.facts(krogh_double_curved.__doc__)
    corner = np.array([[0, 0], [500, 0], [0, 500], [500, 500], [250, 250]], float)
    heights = [float(h) for h in re.findall(r"-?\d[\d.]*", stated["Flat length"].split("z = ")[1])]
    found = krogh_derivative(*corner.T, 0, 0)
    assert heights[:4] == pytest.approx(found[:4], abs=1e-9)
    assert f"{found[4]:g} mm at (250, 250)" in stated["Flat length"]
    side = np.linspace(0, 500, 501)
    everywhere = curvature_of_krogh(np.stack(np.meshgrid(side, side, indexing="ij"), -1).reshape(-1, 2))
    numbers = [float(k) for k in re.findall(r"(-?[\d.]+e-6)", stated["Gaussian curvature"])]
    expected = [curvature_of_krogh(corner[4:])[0], everywhere.min(), everywhere.max()]
    assert numbers == pytest.approx(expected, rel=2e-5)
