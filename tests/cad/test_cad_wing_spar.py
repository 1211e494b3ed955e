"""The wing and spar: rulings, crease, profiles by name, rounded edge, tool block."""

from __future__ import annotations

import re

import numpy as np
import pytest
import wing_spar
from OCP.BRepAdaptor import BRepAdaptor_Surface
from tessellated import tessellate

SHORT = {"span": 2000.0, "chord": 600.0, "spar_height": 250.0}


DEVIATION = {  # name: c and f(y), with wavelength 700 and length 400
    "none": (0.0, lambda y: 0 * y),
    "linear": (0.03, lambda y: 0.03 * y),
    "parabola": (0.03, lambda y: 0.03 * y**2 / 4000),
    "sine": (8.0, lambda y: 8 * np.sin(2 * np.pi * y / 700)),
    "sin2_slope": (0.03, lambda y: 0.03 * (y / 2 - 500 / np.pi * np.sin(np.pi * y / 1000))),
    "bump": (8.0, lambda y: 8 * (y / 400) ** 2 * np.exp(1 - (y / 400) ** 2)),
    "ripple": (8.0, lambda y: 16 * np.sin(np.pi * y / 700) ** 2),
}


def crease_points(shape) -> np.ndarray:
    """Points of the edge that wing and spar share, (n, 3)."""
    wing, spar = (shape.ctx.tags[name].val() for name in ("wing", "spar"))
    (crease,) = [edge for edge in wing.Edges() if any(edge.isSame(other) for other in spar.Edges())]
    return np.array([point.toTuple() for point in crease.positions(np.linspace(0, 1, 501))])


def test_faces_are_tagged_and_share_one_edge():
    shape = wing_spar.build()
    assert list(shape.ctx.tags) == ["wing", "spar"]
    assert all(tagged.val() in shape.val().Faces() for tagged in shape.ctx.tags.values())
    assert len(shape.val().Edges()) == 7


def test_rulings_are_straight_lines_of_the_surfaces():
    """A line of constant parameter runs along x on the wing, along z on the spar, at constant speed."""
    shape = wing_spar.build()
    for name, axis, length in (("wing", 0, 3000), ("spar", 2, 1000)):
        surface = BRepAdaptor_Surface(shape.ctx.tags[name].val().wrapped)
        assert (surface.UDegree(), surface.VDegree()) == (3, 1)
        across = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 5)
        for u in np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 101):
            line = np.array([surface.Value(u, v).Coord() for v in across])
            assert np.ptp(np.delete(line, axis, axis=1), axis=0).max() < 1e-9
            assert np.abs(np.diff(line[:, axis])) == pytest.approx(np.full(4, length / 4), abs=1e-9)


@pytest.mark.parametrize(("chord", "angle_deg"), [(10, 5), (1, 1), (0.1, 1), (0.05, 0.5)])
def test_tessellation_is_strips_along_the_rulings(chord, angle_deg):
    mesh = tessellate(wing_spar.build(), chord, np.radians(angle_deg))
    for face, axis in ((0, 0), (1, 2)):
        assert mesh.vertices_inside(face).size == 0  # so the facets unroll, whatever the tolerance
        vector = mesh.triangle_vector[mesh.triangle_face == face]
        assert np.abs(vector[:, axis] / np.linalg.norm(vector, axis=1)).max() < 1e-9


def test_crease_of_the_tessellation_is_conforming():
    mesh = tessellate(wing_spar.build())
    sides = [set(np.unique(mesh.triangles[mesh.triangle_face == face])) for face in (0, 1)]
    crease = sides[0] & sides[1]
    edges = [edge for edge in mesh.edge_uses if set(edge) <= crease]
    assert len(crease) > 50
    assert len(edges) == 2 * (len(crease) - 1)  # each edge of the crease once in either sense
    assert set(mesh.edge_uses.values()) == {1}


def test_crease_follows_the_real_profile_and_the_parabola():
    x, y, z = crease_points(wing_spar.build()).T
    g_w = 0.047227544 * y + 0.220721648 * 3731.291642 * (1 - np.exp(-y / 3731.291642))
    assert np.abs(z - g_w).max() < 1e-4
    assert np.abs(x - g_w - 0.1 * y**2 / 28000).max() < 1e-4
    assert (y.min(), y.max()) == pytest.approx((0, 14000), abs=1e-9)
    slope = np.degrees(np.arctan(0.047227544 + 0.220721648 * np.exp(-np.array([0, 4000, 14000]) / 3731.291642)))
    assert slope == pytest.approx([15, 7, 3], abs=1e-5)


@pytest.mark.parametrize("deviation", DEVIATION)
def test_deviation_by_name(deviation):
    c, f = DEVIATION[deviation]
    shape = wing_spar.build(**SHORT, wing_profile="flat", deviation=deviation, c=c, wavelength=700.0, length=400.0)
    x, y, z = crease_points(shape).T
    assert np.abs(x - f(y)).max() < 1e-4
    assert np.abs(z).max() < 1e-9


def test_profiles_by_name():
    quadratic = wing_spar.build(
        **SHORT, wing_profile="quadratic", wing_a=2e-4, spar_profile="quadratic", spar_a=4e-4, deviation="none"
    )
    x, y, z = crease_points(quadratic).T
    assert np.abs(x - 4e-4 * y**2).max() < 1e-8  # a cubic spline repeats a parabola
    assert np.abs(z - 2e-4 * y**2).max() < 1e-8
    arc = wing_spar.build(**SHORT, wing_profile="flat", spar_profile="arc", spar_radius=5000.0, deviation="none")
    x, y, z = crease_points(arc).T
    assert np.abs(np.hypot(x - 5000, y) - 5000).max() < 1e-4
    origami = wing_spar.build(**SHORT, deviation="none")
    x, _, z = crease_points(origami).T
    assert np.abs(x - z).max() < 1e-12


def test_a_small_fillet_nears_the_sharp_edge():
    sharp = wing_spar.build(**SHORT).val().Area()
    lost = []
    for radius in (20.0, 10.0, 5.0):
        shape = wing_spar.build(**SHORT, fillet_radius=radius)
        assert list(shape.ctx.tags) == ["wing", "spar", "fillet"]
        assert shape.val().isValid()
        assert shape.ctx.tags["wing"].val().normalAt().z > 0.9
        assert shape.ctx.tags["spar"].val().normalAt().x < -0.9
        rounded = shape.ctx.tags["fillet"].val().normalAt()
        assert rounded.x < -0.5
        assert rounded.z > 0.5
        lost.append(sharp - shape.val().Area())
    # Two strips r wide give way to a quarter circle: (2 - pi/2) r per length, for an edge near 90 degrees.
    assert np.diff(np.log2(lost)) == pytest.approx([-1, -1], abs=0.01)
    assert lost[-1] == pytest.approx((2 - np.pi / 2) * 5 * 2010, rel=0.2)


def test_block_is_a_solid_whose_faces_can_be_picked():
    shell, block = wing_spar.build(), wing_spar.build(block=True)
    assert block.val().ShapeType() == "Solid"
    assert block.val().isValid()
    assert block.val().Volume() > 0
    assert list(block.ctx.tags) == ["wing", "spar", "skirt", "floor", "back", "root", "tip"]
    assert block.faces(">Z").val() == block.ctx.tags["wing"].val()
    assert block.faces("<X").val() == block.ctx.tags["spar"].val()
    for name in ("wing", "spar"):
        on_shell, on_block = (shape.ctx.tags[name].val() for shape in (shell, block))
        assert on_block.Area() == pytest.approx(on_shell.Area(), rel=1e-12)
        assert on_block.normalAt().toTuple() == pytest.approx(on_shell.normalAt().toTuple(), abs=1e-12)


def test_block_may_have_a_fillet():
    sharp, rounded = (wing_spar.build(**SHORT, block=True, fillet_radius=radius) for radius in (0.0, 20.0))
    assert rounded.val().ShapeType() == "Solid"
    assert list(rounded.ctx.tags) == [*sharp.ctx.tags, "fillet"]
    assert all(tagged.val() in rounded.val().Faces() for tagged in rounded.ctx.tags.values())
    # A square gives way to a quarter circle, for an edge near 90 degrees.
    lost = sharp.val().Volume() - rounded.val().Volume()
    assert lost == pytest.approx((1 - np.pi / 4) * 20**2 * 2010, rel=0.2)


def test_table_of_a_cubic_is_the_cubic(tmp_path):
    """A cubic spline repeats a cubic where its third derivative may not jump at the ends, as text and as a file."""

    def g(y):
        return 1e-8 * y**3 - 3e-5 * y**2 + 0.05 * y

    y = np.array([0, 300, 700, 1200, 1600, 2100.0])
    text = ",".join(f"{at!r}:{value!r}" for at, value in zip(y.tolist(), g(y).tolist(), strict=True))
    file = tmp_path / "profile.csv"
    file.write_text("y,g\n" + "\n".join(pair.replace(":", ",") for pair in text.split(",")) + "\n")
    for table in (text, str(file)):
        shape = wing_spar.build(**SHORT, wing_profile="table", wing_table=table, deviation="none")
        x, at, z = crease_points(shape).T
        assert np.abs(z - g(at)).max() < 1e-8
        assert np.abs(x - z).max() < 1e-9
    shape = wing_spar.build(**SHORT, wing_profile="flat", deviation="table", deviation_table=text)
    x, at, z = crease_points(shape).T
    assert np.abs(x - g(at)).max() < 1e-8
    given = wing_spar.build(**SHORT, wing_profile="flat", deviation="none", spar_profile="table", spar_table=text)
    assert np.abs(crease_points(given) - crease_points(shape)).max() == 0


def test_table_follows_the_real_wing():
    """Points 250 mm apart: their spline repeats the profile they were taken from to the fourth order."""
    y = np.linspace(0, 14000, 57)
    g_w = 0.047227544 * y + 0.220721648 * 3731.291642 * (1 - np.exp(-y / 3731.291642))
    table = ",".join(f"{at!r}:{value!r}" for at, value in zip(y.tolist(), g_w.tolist(), strict=True))
    found = crease_points(wing_spar.build(wing_profile="table", wing_table=table))
    assert np.abs(found - crease_points(wing_spar.build())).max() < 2e-3


@pytest.mark.parametrize("angle_deg", [30.0, 60.0, 90.0, 120.0])
def test_spar_at_any_angle_is_origami_by_construction(angle_deg):
    """Either side's ruling makes the same angle with the crease: unfolded, the two sheets are one."""
    shape = wing_spar.build(**SHORT, spar_angle_deg=angle_deg, deviation="none")
    (crease,) = [
        edge
        for edge in shape.ctx.tags["wing"].val().Edges()
        if any(edge.isSame(other) for other in shape.ctx.tags["spar"].val().Edges())
    ]
    tangent = np.array([crease.tangentAt(t).toTuple() for t in np.linspace(0, 1, 21)])
    angle = np.radians(angle_deg)
    along_spar = np.array([-np.cos(angle), 0, -np.sin(angle)])
    assert np.abs(tangent @ along_spar + tangent[:, 0]).max() < 1e-6
    assert np.abs(tangent[:, 0]).min() > 0.01  # nor is it trivially so
    surface = BRepAdaptor_Surface(shape.ctx.tags["spar"].val().wrapped)
    u, v = (np.linspace(*ends, 5) for ends in ((0, 2000), (surface.FirstVParameter(), surface.LastVParameter())))
    for at in u:
        line = np.array([surface.Value(at, across).Coord() for across in v])
        steps = np.diff(line, axis=0)
        assert np.abs(np.cross(steps, along_spar)).max() < 1e-9
        assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(250, abs=1e-9)
    normal = np.array(shape.ctx.tags["spar"].val().normalAt().toTuple())
    assert normal @ [-np.sin(angle), 0, np.cos(angle)] > 0.9  # away from the tool


def test_c_section_has_a_rear_spar_that_mirrors_the_front():
    both = {**SHORT, "rear_spar": True, "chord": 3000.0}
    shape = wing_spar.build(**both)
    assert list(shape.ctx.tags) == ["wing", "spar", "rear_spar"]
    assert shape.val().isValid()
    front, rear = (shape.ctx.tags[name].val() for name in ("spar", "rear_spar"))
    assert front.Area() == pytest.approx(rear.Area(), rel=1e-9)
    assert rear.normalAt().x > 0.9
    middle, reflected = front.Center(), rear.Center()
    assert (3000 - reflected.x, reflected.y, reflected.z) == pytest.approx(middle.toTuple(), abs=1e-4)
    parallel = wing_spar.build(**{**both, "rear_profile": "parallel"})
    assert parallel.ctx.tags["rear_spar"].val().Center().x == pytest.approx(middle.x + 3000, abs=1e-4)
    for name, axis in (("wing", 0), ("spar", 2), ("rear_spar", 2)):
        surface = BRepAdaptor_Surface(shape.ctx.tags[name].val().wrapped)
        across = np.linspace(surface.FirstVParameter(), surface.LastVParameter(), 5)
        for u in np.linspace(surface.FirstUParameter(), surface.LastUParameter(), 21):
            line = np.array([surface.Value(u, v).Coord() for v in across])
            assert np.ptp(np.delete(line, axis, axis=1), axis=0).max() < 1e-9


def test_c_section_with_fillets_and_as_a_block():
    both = {**SHORT, "rear_spar": True, "chord": 3000.0, "fillet_radius": 20.0}
    shape, block = wing_spar.build(**both), wing_spar.build(**both, block=True)
    assert list(shape.ctx.tags) == ["wing", "spar", "rear_spar", "fillet", "rear_fillet"]
    assert shape.val().isValid()
    assert shape.ctx.tags["fillet"].val().Area() == pytest.approx(shape.ctx.tags["rear_fillet"].val().Area(), rel=1e-4)
    assert block.val().ShapeType() == "Solid"
    assert block.val().isValid()
    assert all(tagged.val() in block.val().Faces() for tagged in block.ctx.tags.values())


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"span": 0.0}, "span=0.0: must be positive"),
        ({"chord": -1.0}, "chord=-1.0: must be positive"),
        ({"wing_profile": "naca"}, "wing_profile='naca' is not known: real, flat, quadratic, arc"),
        ({"spar_profile": "naca", "deviation": "none"}, "spar_profile='naca' is not known"),
        ({"spar_profile": "flat"}, "spar_profile='flat' is all of g_s: set deviation to 'none', not 'parabola'"),
        ({"deviation": "wobble"}, "deviation='wobble' is not known: none, linear, parabola"),
        ({"wing_profile": "arc", "wing_radius": 14000.0}, "wing_radius=14000.0: must be larger than the span"),
        ({"fillet_radius": 1000.0}, "fillet_radius=1000.0: must be 0"),
        ({"deviation": "ripple", "wavelength": 1.0, "c": 5.0}, "the profiles change too fast"),
        ({"span": 14.0, "chord": 3.0, "spar_height": 1.0}, "span=14.0: lengths are in mm"),
        ({"spar_height": 4000.0}, "spar_height=4000.0: the spar is higher than the wing is wide, chord=3000.0"),
        ({"spar_angle_deg": 0.0}, "spar_angle_deg=0.0: must lie between 0 and 180"),
        (
            {"spar_angle_deg": 170.0, "chord": 980.0, "spar_height": 980.0, "rear_spar": True},
            "chord=980.0: the front and",
        ),
        ({"rear_spar": True}, "chord=3000.0: the front and the rear spar cross at y = 9282 mm; raise chord"),
        ({"rear_spar": True, "rear_profile": "none"}, "rear_profile='none' is not known: mirror, parallel"),
        ({"wing_profile": "table"}, "wing_table='': give at least two points, such as 0:0,14000:100"),
        (
            {"wing_profile": "table", "wing_table": "0:0,9000:1,9000:2"},
            "wing_table: y must increase, but 9000 follows 9000",
        ),
        ({"wing_profile": "table", "wing_table": "0:0,9000:1"}, "wing_table reaches from y = 0 to 9000 mm"),
        ({"deviation": "table", "deviation_table": "0:0,1:2:3"}, "deviation_table: '1:2:3' is not a point y:g"),
        ({"deviation": "table", "deviation_table": "0:0,14000:nan"}, "deviation_table: '14000:nan' is not a point y:g"),
        (
            {"deviation": "table", "deviation_table": "none.csv"},
            "deviation_table='none.csv' cannot be read: No such file",
        ),
        ({"fillet_radius": 900.0}, "fillet_radius=900.0: no such fillet fits along the crease"),
    ],
)
def test_parameters_that_make_no_wing_are_refused(parameters, message):
    with pytest.raises(ValueError, match=re.escape(message)) as refused:
        wing_spar.build(**parameters)
    assert "\n" not in str(refused.value)
