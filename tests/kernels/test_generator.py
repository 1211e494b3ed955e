"""Straightest geodesics: through vertices with equal angles on both sides, along edges, and the star of a vertex."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from moulds import bumpy, cube, cube_corner, grid, hypar, icosphere, plate, step_corner
from paths import LEFT_SURFACE, WALKED, Place, in_face, place_at, walk

from meshdrape.kernels.generator import corner_angle, corner_place, trace, turn_about_vertex
from meshdrape.surface import Surface


def follow(surface, seed, direction, spacing, count):
    """Fibre from a seed inside a face: code, nodes in space (k, 3), through (k,)."""
    place = place_at(surface, seed)
    face, through = np.empty(count, dtype=np.int32), np.zeros(count, dtype=np.bool_)
    xy, out, into = (np.empty((count, 2)) for _ in range(3))
    along = in_face(surface, place.face, direction)
    no_crease = np.zeros((0, 3), dtype=np.bool_)
    code, n, _, _ = trace(
        surface.unfolding, no_crease, 0.0, *place, *along, -1, 0.0, spacing, count, face, xy, out, into, through
    )
    node = np.array([Place(face[k], *xy[k]).in_space(surface) for k in range(n)]).reshape(-1, 3)
    assert np.abs(np.linalg.norm(out[:n], axis=1) - 1).max(initial=0) < 1e-12
    assert np.abs(np.linalg.norm(into[:n], axis=1) - 1).max(initial=0) < 1e-12
    return code, node, through[:n]


@given(st.floats(-40, 40), st.floats(-30, 30), st.floats(0, 2 * np.pi))
def test_clear_of_vertices_it_is_a_straight_walk(x, y, angle):
    surface = Surface.from_arrays(*bumpy(4, n=9))
    point, _ = surface.closest_point([x, y, 0])
    assume(point.barycentric.min() > 1e-6)
    place = Place(point.face, *point.in_frame(surface))
    frame = surface.unfolding.frame[place.face]
    direction = np.cos(angle) * frame[3:6] + np.sin(angle) * frame[6:9]
    _, node, through = follow(surface, place.in_space(surface), direction, 7.0, 12)
    assume(not through.any())
    for k in range(len(node)):
        walked = walk(surface, place, (np.cos(angle), np.sin(angle)), 7.0 * (k + 1))
        assert walked.code == WALKED
        assert node[k] == pytest.approx(walked.end.in_space(surface), abs=1e-8)


@pytest.mark.parametrize("angle", [0, 45, 90, 135, 180, 225, 270, 315])
def test_along_edges_and_through_flat_vertices_it_stays_straight(angle):
    """A grid of squares cut along one diagonal: fibres along rows, columns and diagonals pass nothing but vertices."""
    side = np.linspace(-100, 100, 9)
    surface = Surface.from_arrays(*grid(side, side, lambda x, y: (x, y, 0)))
    direction = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0])
    seed = 0.3 * 25 * direction
    code, node, _ = follow(surface, seed, direction, 10.0, 40)
    assert code == LEFT_SURFACE
    expected = seed + 10.0 * np.arange(1, len(node) + 1)[:, None] * direction
    assert node == pytest.approx(expected, abs=1e-9)
    reach = 100 / np.abs(direction).max()
    assert len(node) == int((reach - 7.5 + 1e-9) / 10)


def test_fibre_through_vertices_of_a_saddle_stays_on_its_ruling():
    """The hypar's straight lines run along mesh edges through vertices: half the angle on both sides by symmetry."""
    surface = Surface.from_arrays(*hypar(1.0, 1.0, 10, symmetric=True))
    for axis in (0, 1):
        direction = np.eye(3)[axis]
        _, node, _ = follow(surface, 30.0 * direction, direction, 70.0, 30)
        assert len(node) == 13
        expected = (30 + 70 * np.arange(1, 14))[:, None] * direction
        assert node == pytest.approx(expected, abs=1e-8)


def test_through_a_cubes_vertex_the_angle_is_halved():
    """From (1, 1) on the top straight at the corner, total angle 3 pi / 2: it leaves along the edge below."""
    surface = Surface.from_arrays(*cube_corner(1000, 2))
    code, node, through = follow(surface, [400, 400, 0], [-1, -1, 0], 100.0, 12)
    assert code in (WALKED, LEFT_SURFACE)
    # 565.7 mm to the corner; beyond it up the z axis
    expected = np.zeros((len(node), 3))
    done = 100 * np.arange(1, len(node) + 1) - 400 * np.sqrt(2)
    expected[done < 0, 0] = expected[done < 0, 1] = -done[done < 0] / np.sqrt(2)
    expected[done >= 0, 2] = done[done >= 0]
    assert node == pytest.approx(expected, abs=1e-9)
    assert through[5]


def test_through_a_saddle_vertex_the_angle_is_halved():
    """Total angle 5 pi / 2: from the +x ray 5 pi / 4 further on lies half-way between -x and +z on the wall."""
    surface = Surface.from_arrays(*step_corner(1000, 2))
    _, node, _ = follow(surface, [430, 0, 0], [-1, 0, 0], 100.0, 10)
    beyond = node[4:]
    length = 100 * np.arange(5, 5 + len(beyond)) - 430
    expected = length[:, None] * np.array([-1, 0, 1]) / np.sqrt(2)
    assert len(beyond) == 6
    assert beyond == pytest.approx(expected, abs=1e-9)


def test_nodes_are_one_spacing_apart_along_the_fibre_whatever_the_mesh():
    """On a plane the chord is the length: even through vertices none is gained or lost."""
    surface = Surface.from_arrays(*plate())
    for vertex in (30, 44, 51):
        seed = surface.vertices[vertex] - [31.0, 17.0, 0]
        _, node, _ = follow(surface, seed, [31.0, 17.0, 0], 6.5, 30)
        assert np.linalg.norm(np.diff(node, axis=0), axis=1) == pytest.approx(6.5, abs=1e-10)


def star(surface, vertex):
    face, corner = np.argwhere(surface.faces == vertex)[0]
    return int(face), int(corner)


@given(st.integers(0, 41), st.floats(0, 2 * np.pi), st.floats(-6, 6))
def test_turning_about_a_vertex_and_back_is_nothing(vertex, first, turn):
    mesh = Surface.from_arrays(*icosphere(1, 100))
    face, corner = star(mesh, vertex)
    start = turn_about_vertex(mesh.unfolding, face, corner, *corner_angle(mesh.unfolding, face, corner)[1:], first)
    there = turn_about_vertex(mesh.unfolding, *start, turn)
    back = turn_about_vertex(mesh.unfolding, *there, -turn)
    assert _ray(mesh, *back) == pytest.approx(_ray(mesh, *start), abs=1e-9)
    assert np.hypot(*there[2:]) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("mesh", [cube(100, 2), icosphere(1, 100)])
def test_turning_by_the_whole_angle_comes_round(mesh):
    surface = Surface.from_arrays(*mesh)
    for vertex in range(len(surface.vertices)):
        face, corner = star(surface, vertex)
        _, ex, ey = corner_angle(surface.unfolding, face, corner)
        start = turn_about_vertex(surface.unfolding, face, corner, ex, ey, 0.1)
        round_ = turn_about_vertex(surface.unfolding, *start, surface.vertex_angle[vertex])
        assert _ray(surface, *round_) == pytest.approx(_ray(surface, *start), abs=1e-9)


def _ray(surface, face, corner, dx, dy):
    """The direction in space."""
    frame = surface.unfolding.frame[face]
    return dx * frame[3:6] + dy * frame[6:9]


def test_turning_off_the_border_is_told():
    surface = Surface.from_arrays(*plate())
    face, corner = star(surface, 0)
    _, ex, ey = corner_angle(surface.unfolding, face, corner)
    assert turn_about_vertex(surface.unfolding, face, corner, ex, ey, 4.0)[0] < 0


def test_corner_angles_are_the_triangles():
    surface = Surface.from_arrays(*bumpy(8, n=6))
    for face in range(len(surface.faces)):
        for k in range(3):
            assert corner_angle(surface.unfolding, face, k)[0] == pytest.approx(
                surface.corner_angle[face, k], abs=1e-12
            )
            x, y = corner_place(surface.unfolding, face, k)
            frame = surface.unfolding.frame[face]
            assert frame[:3] + x * frame[3:6] + y * frame[6:9] == pytest.approx(
                surface.vertices[surface.faces[face, k]], abs=1e-9
            )
