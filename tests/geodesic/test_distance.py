"""Exact distances on polyhedra, against unfolding by hand, identities of a metric, and a second implementation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from moulds import (
    Mesh,
    bumpy,
    cap,
    cube,
    cube_corner,
    cut_plate,
    cylinder,
    grid,
    holed_plate,
    icosphere,
    plate,
    rotation,
    sliver_plate,
    step_corner,
    tube,
)
from unfolding import straight_line

import meshdrape
from meshdrape.errors import StartError
from meshdrape.geodesic import surface_distance
from meshdrape.geodesic.patch import Patch, faces_between
from meshdrape.surface import SurfacePoint


def distance(mesh, a, b):
    return meshdrape.geodesic_distance(mesh.mould(), a, b)


XY = st.tuples(st.floats(-99, 99), st.floats(-69, 69))


@given(XY, XY)
def test_on_a_plane_it_is_euclids(a, b):
    expected = np.hypot(a[0] - b[0], a[1] - b[1])
    for mesh in (plate(), sliver_plate()):
        assert distance(mesh, (*a, 0), (*b, 0)) == pytest.approx(expected, rel=1e-9, abs=1e-6)


@given(st.floats(-0.9, 0.9), st.floats(-300, 300), st.floats(-0.9, 0.9), st.floats(-300, 300))
def test_on_a_prism_it_is_euclids_unrolled(p, z, q, w):
    """Points at the azimuths p and q of a prism of 12 facets over two radians, each by its place along the outline.

    Ends nearer to each other than 1e-7 of a facet's length may be taken for one, for libigl's sake.
    """
    n, radius = 12, 200.0
    mesh = cylinder(radius, (-1.0, 1.0), 400, n)
    step = 2.0 / n
    chord = 2 * radius * np.sin(step / 2)

    def on_prism(azimuth, height):
        k = min(int((azimuth + 1) / step), n - 1)
        t = (azimuth + 1) / step - k
        ends = -1 + step * np.array([k, k + 1])
        xy = (1 - t) * np.array([np.cos(ends[0]), np.sin(ends[0])]) + t * np.array([np.cos(ends[1]), np.sin(ends[1])])
        return [*(radius * xy), height], (k + t) * chord

    (a, along_a), (b, along_b) = on_prism(p, z), on_prism(q, w)
    assert distance(mesh, a, b) == pytest.approx(np.hypot(along_a - along_b, z - w), rel=1e-9, abs=2e-7 * 500)


def test_on_a_tube_the_shorter_way_round():
    """A closed prism of 24 facets: 10 facets one way, 14 the other."""
    mesh, chord = tube(60, 200, 24), 2 * 60 * np.sin(np.pi / 24)

    def at(k, z):
        return [60 * np.cos(2 * np.pi * k / 24), 60 * np.sin(2 * np.pi * k / 24), z]

    assert distance(mesh, at(3, -20), at(13, 30)) == pytest.approx(np.hypot(10 * chord, 50), rel=1e-12)
    assert distance(mesh, at(3, -20), at(17, 30)) == pytest.approx(np.hypot(10 * chord, 50), rel=1e-12)


@pytest.mark.parametrize("side", [1.0, 250.0])
@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ((0, 0, 0), (1, 1, 1), np.sqrt(5)),  # opposite corners
        ((0, 0, 0), (1, 1, 0), np.sqrt(2)),
        ((0.5, 0.5, 0), (0.5, 0.5, 1), 2.0),  # middles of opposite faces
        ((0.5, 0, 0), (0.5, 1, 1), 2.0),  # middles of opposite edges
        ((0.5, 0.5, 1), (1, 0.5, 0.5), 1.0),
        ((0, 0, 0), (0.5, 0.5, 1), np.sqrt(0.25 + 2.25)),
    ],
)
def test_on_a_cube(side, a, b, expected):
    for n in (1, 3):
        found = distance(cube(side, n), side * np.array(a), side * np.array(b))
        assert found == pytest.approx(side * expected, rel=1e-12)


def test_the_spider_and_the_fly():
    """Dudeney's room, 30 x 12 x 12 feet: a foot below the ceiling to a foot above the floor at the far end is 40."""
    room = cube(1.0, 5)
    room = Mesh(room.vertices * [12, 12, 30], room.triangles)
    assert distance(room, (6, 11, 0), (6, 1, 30)) == pytest.approx(40, rel=1e-12)


def test_across_the_corner_of_a_cube():
    """Three squares: from one to the next through their common edge unfolded, where that is inside."""
    mesh = cube_corner(100, 2)
    assert distance(mesh, (30, 40, 0), (0, 50, 20)) == pytest.approx(np.hypot(30 + 20, 10), rel=1e-12)
    # opposite each other about the corner: round either side is the same, three right angles in all
    assert distance(mesh, (30, 30, 0), (0, 0, 50)) == pytest.approx(
        np.sqrt(1800 + 2500 - 2 * np.sqrt(1800) * 50 * np.cos(3 * np.pi / 4)), rel=1e-12
    )


def test_round_the_foot_of_a_step():
    """In the shadow of the saddle vertex the path bends there: the sum of both legs."""
    mesh = step_corner(100, 2)
    assert distance(mesh, (30, 1, 0), (-20, 0, 30)) == pytest.approx(
        min(np.hypot(30, 1) + np.hypot(20, 30), _unfolded(30, 1)), rel=1e-12
    )


def _unfolded(x, y):
    """From (x, y, 0) over the floor straight to the wall y = 0 at (-20, 0, 30): the wall laid back into the floor."""
    return np.hypot(x + 20, y + 30) if x + (-20 - x) * y / (y + 30) <= 0 else np.inf


def test_round_a_hole_and_round_a_corner():
    """The mould, not the extension or the filling: a path bends at the corners it has to go round."""
    hole = holed_plate(200, 60)  # about (25, 5): corners (-5, -25) and (55, 35)
    found = distance(hole, (-35, 5, 0), (85, 5, 0))
    assert found == pytest.approx(2 * np.hypot(30, 30) + 60, rel=1e-12)
    ell = cut_plate(lambda x, y: (x < 0) | (y < 0))
    assert distance(ell, (50, -20, 0), (-30, 60, 0)) == pytest.approx(np.hypot(50, 20) + np.hypot(30, 60), rel=1e-12)


def test_round_a_fin_rather_than_over_it():
    """The shorter way leaves what a first look between the points takes in: over the fin 170 mm, round its end 128."""
    import pygeodesic.geodesic

    x, y = [-100, -50, -1, 0, 1, 50, 100], np.linspace(-100, 100, 21)
    fin = grid(x, y, lambda x, y: (x, y, 35.0 * ((x == 0) & (np.abs(y) <= 30))))
    a, b = np.flatnonzero((np.abs(fin.vertices[:, 0]) == 50) & (fin.vertices[:, 1] == 0))
    theirs, _ = pygeodesic.geodesic.PyGeodesicAlgorithmExact(*fin).geodesicDistance(a, b)
    assert theirs < 135
    assert distance(fin, *fin.vertices[[a, b]]) == pytest.approx(theirs, rel=1e-12)


def test_on_a_sphere_it_is_the_great_circle():
    mesh = icosphere(5, 1000)
    rng = np.random.default_rng(3)
    for _ in range(4):
        a, b = (v / np.linalg.norm(v) for v in rng.normal(size=(2, 3)))
        arc = 1000 * np.arccos(a @ b)
        # a polyhedron inscribed in it, of chord tolerance 0.3 mm
        assert distance(mesh, 1000 * a, 1000 * b) == pytest.approx(arc, rel=1e-3)


RANDOM = st.integers(0, 10_000)


@given(RANDOM)
def test_metric(seed):
    """Symmetric, zero to itself, triangle inequality, no shorter than the chord."""
    mould = bumpy(7, n=10, height=50).mould()
    rng = np.random.default_rng(seed)
    a, b, c = (_random_point(mould.surface, rng) for _ in range(3))
    ab, bc, ca = (meshdrape.geodesic_distance(mould, p, q) for p, q in ((a, b), (b, c), (c, a)))
    assert meshdrape.geodesic_distance(mould, b, a) == pytest.approx(ab, rel=1e-10)
    assert meshdrape.geodesic_distance(mould, a, a) == pytest.approx(0, abs=1e-6)
    assert ab <= bc + ca + 1e-9
    assert ab >= np.linalg.norm(a - b) * (1 - 1e-12)


def _random_point(surface, rng):
    face = int(rng.integers(len(surface.faces)))
    return SurfacePoint(face, rng.dirichlet([1, 1, 1])).position(surface)


@pytest.mark.parametrize(
    "mesh", [bumpy(11, n=12, height=60), icosphere(2, 100), cap(3, 100), cube(100, 2), step_corner(100, 2)]
)
def test_agrees_with_a_second_implementation(mesh):
    """pygeodesic on the whole mesh with the points inserted; ours cuts a patch out of it."""
    import pygeodesic.geodesic

    mould = mesh.mould()
    rng = np.random.default_rng(5)
    for _ in range(6):
        a, b = (_random_point(mould.surface, rng) for _ in range(2))
        whole = Patch(mould.surface, np.arange(len(mould.surface.faces)))
        ends = [whole.insert(mould.surface.closest_point(p)[0].face, p)[0] for p in (a, b)]
        theirs, _ = pygeodesic.geodesic.PyGeodesicAlgorithmExact(*whole.arrays()).geodesicDistance(*ends)
        assert meshdrape.geodesic_distance(mould, a, b) == pytest.approx(theirs, rel=1e-11)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_scales_and_moves_with_the_mould(scale):
    mesh = bumpy(9, n=10)
    a, b = mesh.vertices[[17, 88]] + [0.1, 0.2, 0]
    turn = rotation([1, 2, 3], 0.8)
    shift = scale * np.array([1e3, -2e3, 5e2])
    moved = mesh.moved(turn, shift, scale)
    expected = scale * distance(mesh, a, b)
    assert distance(moved, scale * turn @ a + shift, scale * turn @ b + shift) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("spot", ["vertex", "edge", "near vertex", "near edge", "border"])
def test_ends_at_vertices_and_edges(spot):
    """libigl hangs on heights below 1e-8 of an edge: none may reach it, and the distance is right all the same."""
    mesh = plate()
    surface = mesh.mould().surface
    face = 40
    weights = {
        "vertex": [1, 0, 0],
        "edge": [0.4, 0.6, 0],
        "near vertex": [1 - 2e-9, 1e-9, 1e-9],
        "near edge": [0.4, 0.6 - 1e-10, 1e-10],
    }.get(spot)
    a = np.array([100.0, 3.0, 0]) if weights is None else np.array(weights) @ surface.vertices[surface.faces[face]]
    b = np.array([-61.0, 22.0, 0])
    assert distance(mesh, a, b) == pytest.approx(np.linalg.norm(a - b), abs=1e-6)


def test_points_off_the_mould_are_projected():
    assert distance(plate(), (10, 20, 55), (-30, 20, -3)) == pytest.approx(40)


def test_bound_changes_nothing():
    surface = bumpy(12, height=40).mould().surface
    a, b = surface.closest_point([-60, 10, 0])[0], surface.closest_point([50, -20, 0])[0]
    free = surface_distance(surface, a, b)[0]
    for bound in (1.0, free * (1 + 1e-9), 3 * free):
        assert surface_distance(surface, a, b, bound=bound)[0] == pytest.approx(free, rel=1e-12)


def test_faces_between_hold_every_path_of_that_length():
    surface = plate().mould().surface
    a, b = surface.closest_point([-20, 0, 0])[0], surface.closest_point([20, 5, 0])[0]
    faces = faces_between(surface, a, b, 60.0)
    # every point whose distances to both sum to 60 or less lies on one of them
    rng = np.random.default_rng(0)
    spots = rng.uniform([-60, -40], [60, 40], size=(500, 2))
    ends = np.array([[-20, 0], [20, 5]])
    near = np.linalg.norm(spots[:, None] - ends, axis=2).sum(axis=1) < 60
    assert near.sum() > 50
    for spot in spots[near]:
        assert surface.closest_point([*spot, 0])[0].face in faces


def test_points_on_separate_parts():
    two = plate().joined(plate().moved(np.eye(3), (0, 0, 300)))
    with pytest.raises(StartError, match="separate parts") as caught:
        distance(two, (0, 0, 0), (0, 0, 300))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("point", [(np.nan, 0, 0), (0, np.inf, 0), (1, 2), None, "abc", ("a", 0, 0), [[1], 2, 3]])
def test_points_that_are_none(point):
    with pytest.raises(StartError, match="point"):
        distance(plate(), (0, 0, 0), point)


def test_on_a_convex_mesh_it_is_the_shortest_straight_line():
    """Shortest paths pass no convex vertex: all triangles in sight are laid flat, with none of our kernels."""
    mould = icosphere(2, 100).mould()
    rng = np.random.default_rng(2)
    for _ in range(12):
        a = mould.surface.closest_point(_random_point(mould.surface, rng))[0]
        near = a.position(mould.surface) + rng.normal(scale=35, size=3)
        b = mould.surface.closest_point(near)[0]
        ends = [point.position(mould.surface) for point in (a, b)]
        line = straight_line(mould.surface, a.face, ends[0], b.face, ends[1], reach=150.0)
        assert line is not None
        assert meshdrape.geodesic_distance(mould, *ends) == pytest.approx(line.length, rel=1e-12)


def test_from_the_very_middle_of_a_large_triangle():
    """Of a triangle much larger than the path only what lies near is kept; its middle is what the rest is held by."""
    mould = Mesh(np.array([[0.0, 0, 0], [900, 0, 0], [0, 900, 0]]), np.array([[0, 1, 2]])).mould()
    assert meshdrape.geodesic_distance(mould, (300, 300, 0), (310, 300, 0)) == pytest.approx(10, rel=1e-12)
    assert meshdrape.geodesic_distance(mould, (300, 295, 0), (300, 300, 0)) == pytest.approx(5, rel=1e-12)


def test_a_drape_from_the_middle_of_a_face_by_libigl_alone():
    mould = Mesh(np.array([[0.0, 0, 0], [900, 0, 0], [0, 900, 0]]), np.array([[0, 1, 2]])).mould()
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), (300, 300, 0), (2, 1, 0), engine="libigl")
    assert np.count_nonzero(net.node_status == meshdrape.NodeStatus.PLACED) > 140
    assert meshdrape.audit(net).max_relative_error < 1e-12
