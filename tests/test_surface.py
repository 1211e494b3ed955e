"""The surface: its tables, its borders and parts, and the identities that hold on any closed or open mesh."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from moulds import (
    bumpy,
    cap,
    cube,
    cube_corner,
    cylinder,
    grid,
    holed_plate,
    icosphere,
    plate,
    sliver_plate,
    step_corner,
    tube,
)

from meshdrape.errors import MouldError
from meshdrape.surface import Surface, SurfacePoint

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
ALL = {
    "plate": plate(),
    "holed": holed_plate(),
    "slivers": sliver_plate(),
    "cylinder": cylinder(n=20),
    "tube": tube(),
    "cap": cap(3),
    "sphere": icosphere(2),
    "bumpy": bumpy(3),
    "cube": cube(),
    "corner": cube_corner(),
    "step": step_corner(),
}


@pytest.fixture(params=ALL)
def surface(request):
    mesh = ALL[request.param]
    return Surface.from_arrays(mesh.vertices, mesh.triangles)


def test_neighbours_are_each_others(surface):
    flat = surface.face_neighbour.ravel()
    inner = np.flatnonzero(flat >= 0)
    assert np.array_equal(flat[flat[inner]], inner)
    tail = surface.faces.ravel()
    head = surface.faces[:, [1, 2, 0]].ravel()
    assert np.array_equal(tail[flat[inner]], head[inner])
    assert np.array_equal(head[flat[inner]], tail[inner])


def test_arrays_cannot_be_written_to(surface):
    for array in (surface.vertices, surface.faces, surface.face_neighbour):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_arrays_are_copies():
    vertices = np.array(SQUARE, dtype=float)
    surface = Surface.from_arrays(vertices, [[0, 1, 2], [0, 2, 3]])
    vertices[0] = 7
    assert surface.vertices[0] == pytest.approx([0, 0, 0])


def test_angle_defects_and_border_turns_sum_to_the_euler_characteristic(surface):
    """Gauss-Bonnet of the whole mesh: sum of all defects = 2 pi (V - E + F), to round-off."""
    n_edges = (3 * len(surface.faces) + np.count_nonzero(surface.face_neighbour < 0)) / 2
    euler = len(surface.vertices) - n_edges + len(surface.faces)
    assert surface.vertex_defect.sum() == pytest.approx(2 * np.pi * euler, abs=1e-9)


def test_border_loops_run_once_along_every_border_edge(surface):
    border = np.flatnonzero(surface.face_neighbour.ravel() < 0)
    loops = surface.border_loops
    assert sorted(np.concatenate([*loops, []]).astype(int).tolist()) == border.tolist()
    for loop in loops:
        tail = surface.faces[loop // 3, loop % 3]
        head = surface.faces[loop // 3, (loop % 3 + 1) % 3]
        assert np.array_equal(head, np.roll(tail, -1))
    lengths = [surface.half_edge_length(loop).sum() for loop in loops]
    assert lengths == sorted(lengths, reverse=True)


def test_border_lengths_are_the_outlines():
    mesh = holed_plate(200, 60)
    loops = Surface.from_arrays(*mesh).border_loops
    found = [Surface.from_arrays(*mesh).half_edge_length(loop).sum() for loop in loops]
    assert found == pytest.approx([800, 240])


def test_unfolding_carries_the_common_edge_onto_itself(surface):
    """Over each edge the frame of one side maps both ends to the very places they have on the other side."""
    mesh = surface.unfolding
    place = np.zeros((len(surface.faces), 3, 2))
    place[:, 1, 0], place[:, 2] = mesh.corner[:, 0], mesh.corner[:, 1:]
    size = np.abs(mesh.corner).max()
    for k in range(3):
        face = np.flatnonzero(surface.face_neighbour[:, k] >= 0)
        other, side = np.divmod(surface.face_neighbour[face, k], 3)
        c, s, tx, ty = (mesh.crossing[face, 4 * k + m] for m in range(4))
        assert np.abs(c**2 + s**2 - 1).max() < 1e-12
        for corner, theirs in ((k, (side + 1) % 3), ((k + 1) % 3, side)):
            x, y = place[face, corner].T
            there = np.stack([c * x - s * y + tx, s * x + c * y + ty], axis=1)
            assert np.abs(there - place[other, theirs]).max() < 1e-12 * size
        # and the far corner of this face to the other side of the edge
        x, y = place[face, (k + 2) % 3].T
        far = np.stack([c * x - s * y + tx, s * x + c * y + ty], axis=1)
        line = mesh.line[other].reshape(-1, 3, 3)[np.arange(len(other)), side]
        assert (line[:, 0] * far[:, 0] + line[:, 1] * far[:, 1] - line[:, 2]).max() < 0


def test_frames_put_corners_in_space(surface):
    mesh = surface.unfolding
    frame = mesh.frame
    for k, xy in enumerate(
        [
            np.zeros((len(frame), 2)),
            np.stack([mesh.corner[:, 0], 0 * mesh.corner[:, 0]], 1),
            mesh.corner[:, 1:],
        ]
    ):
        place = frame[:, :3] + xy[:, :1] * frame[:, 3:6] + xy[:, 1:] * frame[:, 6:9]
        assert place == pytest.approx(surface.vertices[surface.faces[:, k]], abs=1e-9)
    assert np.cross(frame[:, 3:6], frame[:, 6:9]) == pytest.approx(surface.face_normal, abs=1e-12)


def test_point_restates_itself():
    surface = Surface.from_arrays(*bumpy(1))
    point = SurfacePoint(17, np.array([0.2, 0.5, 0.3]))
    again = SurfacePoint.from_frame(surface, 17, *point.in_frame(surface))
    assert again.barycentric == pytest.approx(point.barycentric, abs=1e-12)
    assert again.position(surface) == pytest.approx(point.position(surface), abs=1e-12)


COORDINATE = st.floats(-150, 150)


@given(st.tuples(COORDINATE, COORDINATE, COORDINATE), st.integers(0, 10_000))
def test_closest_point_is_closer_than_any_other(position, seed):
    """Against random points of the surface, and optimal in its own face: no sampled place is nearer."""
    surface = Surface.from_arrays(*bumpy(2, n=10))
    point, distance = surface.closest_point(position)
    assert point.barycentric.min() >= 0
    assert point.barycentric.sum() == pytest.approx(1, abs=1e-12)
    assert np.linalg.norm(point.position(surface) - position) == pytest.approx(distance, abs=1e-9)
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet([0.5] * 3, size=(len(surface.faces), 20))
    samples = np.einsum("msk,mkd->msd", weights, surface.vertices[surface.faces])
    assert distance <= np.linalg.norm(samples - position, axis=-1).min() + 1e-9


@pytest.mark.parametrize(
    ("position", "nearest"),
    [
        ((3, 4, 10), (3, 4, 0)),
        ((500, 4, 0), (100, 4, 0)),
        ((500, 600, -7), (100, 70, 0)),
        ((-100, -70, 1), (-100, -70, 0)),
    ],
)
def test_closest_point_of_a_plate(position, nearest):
    surface = Surface.from_arrays(*plate())
    point, distance = surface.closest_point(position)
    assert point.position(surface) == pytest.approx(nearest, abs=1e-9)
    assert distance == pytest.approx(np.linalg.norm(np.subtract(position, nearest)), abs=1e-9)


def test_closest_point_on_needles():
    """A triangle a millionth as high as long: the foot is found to a millionth of its height."""
    surface = Surface.from_arrays([[0, 0, 0], [1000, 0, 0], [333, 1e-3, 0]], [[0, 1, 2]])
    point, distance = surface.closest_point([333, 5e-4, 2.0])
    assert distance == pytest.approx(2.0, abs=1e-9)
    assert point.position(surface) == pytest.approx([333, 5e-4, 0], abs=1e-9)


def test_components():
    parts = plate().joined(icosphere(1, 20).moved(np.eye(3), (0, 0, 300)))
    surface = Surface.from_arrays(*parts)
    assert surface.n_components == 2
    assert np.bincount(surface.face_component).tolist() == [126, 80]
    ball, behind = surface.component(1)
    assert len(ball.vertices) == 42
    assert np.array_equal(surface.vertices[surface.faces[behind]], ball.vertices[ball.faces])


def test_vertex_defects_of_known_polyhedra():
    assert np.sort(Surface.from_arrays(*cube(1, 1)).vertex_defect) == pytest.approx([np.pi / 2] * 8)
    corner = Surface.from_arrays(*cube_corner())
    at = np.flatnonzero(np.linalg.norm(corner.vertices, axis=1) < 1e-9)
    assert corner.vertex_defect[at] == pytest.approx(np.pi / 2)
    step = Surface.from_arrays(*step_corner())
    at = np.flatnonzero(np.linalg.norm(step.vertices, axis=1) < 1e-9)
    assert step.vertex_defect[at] == pytest.approx(-np.pi / 2)


def test_areas_and_normals():
    surface = Surface.from_arrays(*sliver_plate(200, 140))
    assert surface.face_area.sum() == pytest.approx(200 * 140)
    assert surface.face_normal == pytest.approx(np.tile([0, 0, 1.0], (len(surface.faces), 1)))
    ball = Surface.from_arrays(*icosphere(2, 1000))
    centre = ball.vertices[ball.faces].mean(axis=1)
    assert np.einsum("ij,ij->i", ball.face_normal, centre).min() > 0


@pytest.mark.parametrize(
    ("triangles", "words"),
    [
        ([[0, 1, 2], [0, 1, 3]], "vertices 0 and 1"),  # two triangles run the edge the same way
        ([[0, 1, 2], [1, 0, 3], [1, 0, 4]], "vertices 1 and 0"),  # three triangles on one edge
    ],
)
def test_edges_that_cannot_be_walked_over(triangles, words):
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, -1, 1]]
    with pytest.raises(MouldError, match=words) as caught:
        Surface.from_arrays(vertices, triangles)
    assert "\n" not in str(caught.value)


def test_grid_of_one_cell():
    surface = Surface.from_arrays(*grid([0, 1], [0, 1], lambda x, y: (x, y, 0)))
    assert np.count_nonzero(surface.face_neighbour >= 0) == 2
    assert len(surface.border_loops[0]) == 4
