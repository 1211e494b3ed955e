"""Straight lines across unfolded triangles."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from moulds import bumpy, cube, cylinder, icosphere, plate, sliver_plate, step_corner
from paths import LEFT_SURFACE, WALKED, Place, in_face, place_at, turn_into, walk

from meshdrape.kernels.walk import off_mould, survey
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.lay.collar import extended

MESHES = {
    "plate": plate(),
    "slivers": sliver_plate(),
    "bumpy": bumpy(5),
    "rough": bumpy(6, height=60),
    "sphere": icosphere(2, 100),
    "cube": cube(100, 3),
    "step": step_corner(100, 2),
    "prism": cylinder(60, (0, 3), 80, 9),
}
SURFACES = {name: Surface.from_arrays(*mesh) for name, mesh in MESHES.items()}

starts = st.tuples(
    st.sampled_from(sorted(SURFACES)), st.floats(0, 1, exclude_max=True), st.floats(0.01, 0.98), st.floats(0.01, 0.98),
    st.floats(0, 2 * np.pi),
)  # fmt: skip


def somewhere(name, which, a, b):
    """A surface and a place inside one of its faces."""
    surface = SURFACES[name]
    a, b = (a, b) if a + b < 0.99 else (1 - a, 1 - b)
    face = int(which * len(surface.faces))
    return surface, Place(face, *SurfacePoint(face, np.array([1 - a - b, a, b])).in_frame(surface))


def unit(angle):
    return np.cos(angle), np.sin(angle)


def reverse(direction):
    return -direction[0], -direction[1]


@given(starts, st.floats(1e-6, 120))
def test_walking_back_returns_to_the_start(start, length):
    *spot, angle = start
    surface, place = somewhere(*spot)
    there = walk(surface, place, unit(angle), length)
    assume(there.code == WALKED)
    line = surface.unfolding.line[there.end.face].reshape(3, 3)
    inside = line[:, 0] * there.end.x + line[:, 1] * there.end.y - line[:, 2]
    assert inside.min() > -1e-9
    back = walk(surface, there.end, reverse(there.direction), length)
    assert back.code == WALKED
    assert back.end.in_space(surface) == pytest.approx(place.in_space(surface), abs=1e-9)


@given(starts, st.floats(0.5, 60), st.floats(0.5, 60))
def test_two_walks_in_a_row_are_one(start, first, second):
    *spot, angle = start
    surface, place = somewhere(*spot)
    whole = walk(surface, place, unit(angle), first + second)
    assume(whole.code == WALKED)
    half = walk(surface, place, unit(angle), first)
    rest = walk(surface, half.end, half.direction, second)
    assert rest.code == WALKED
    assert rest.end.in_space(surface) == pytest.approx(whole.end.in_space(surface), abs=1e-7)


@given(starts, st.floats(1e-6, 150))
def test_on_a_plane_it_is_a_straight_line(start, length):
    _, *spot, angle = start
    for name in ("plate", "slivers"):
        surface, place = somewhere(name, *spot)
        walked = walk(surface, place, unit(angle), length)
        frame = surface.unfolding.frame[place.face]
        target = place.in_space(surface) + length * (np.cos(angle) * frame[3:6] + np.sin(angle) * frame[6:9])
        if abs(target[0]) < 100 and abs(target[1]) < 70:
            assert walked.code == WALKED
            assert walked.end.in_space(surface) == pytest.approx(target, abs=1e-9)
            assert walked.start.in_space(surface) == pytest.approx(place.in_space(surface), abs=1e-9)
        else:
            assert walked.code == LEFT_SURFACE


def test_round_a_prism_it_unrolls():
    """From the middle of the first facet to that of the fifth: azimuth counted by chords, height by the tangent."""
    surface, step = SURFACES["prism"], 3 / 9
    middle = 60 * np.cos(step / 2)
    place = place_at(surface, [middle * np.cos(step / 2), middle * np.sin(step / 2), -40])
    across = np.array([-np.sin(step / 2), np.cos(step / 2), 0])
    direction = in_face(surface, place.face, np.cos(0.2) * across + [0, 0, np.sin(0.2)])
    length = 4 * 2 * 60 * np.sin(step / 2) / np.cos(0.2)
    walked = walk(surface, place, direction, length)
    assert walked.code == WALKED
    centre = [middle * np.cos(4.5 * step), middle * np.sin(4.5 * step), -40 + length * np.sin(0.2)]
    assert walked.end.in_space(surface) == pytest.approx(centre, abs=1e-9)


@pytest.mark.parametrize("angle", [0.0, 0.3, -0.6])
def test_over_the_edge_of_a_cube(angle):
    """From the middle of the top down the next side, straight on in the unfolded plane."""
    surface = SURFACES["cube"]
    place = place_at(surface, [50, 50, 100])
    along = np.array([np.cos(angle), np.sin(angle), 0])
    walked = walk(surface, place, in_face(surface, place.face, along), 80.0)
    assert walked.code == WALKED
    x, y = 50 + 80 * along[:2]
    assert walked.end.in_space(surface) == pytest.approx([100, y, 200 - x], abs=1e-9)


def test_length_zero_stays():
    surface, place = somewhere("bumpy", 0.3, 0.2, 0.3)
    walked = walk(surface, place, (1.0, 0.0), 0.0)
    assert walked.code == WALKED
    assert walked.end == place


@given(starts, st.floats(0, 2 * np.pi))
def test_turning_into_a_neighbour_and_back_is_nothing(start, turn):
    surface, place = somewhere(*start[:-1])
    for code in surface.face_neighbour[place.face]:
        if code >= 0:
            there = turn_into(surface, place.face, unit(turn), int(code // 3))
            assert np.hypot(*there) == pytest.approx(1, abs=1e-12)
            assert turn_into(surface, int(code // 3), there, place.face) == pytest.approx(unit(turn), abs=1e-12)


def test_off_mould_is_measured_from_the_mould():
    """On the collar of a plate: beyond the border by more than the slack."""
    plate_surface = SURFACES["plate"]
    surface = extended(plate_surface, 20.0)
    mesh = surface.unfolding
    for x, y, off in [
        (100.5, 3, True), (100.0005, 3, False), (99.9, 3, False), (0, -70.002, True), (0, -70.0004, False),
        (100.002, 70.002, True), (100.0005, 70.0005, False),
    ]:  # fmt: skip
        point, distance = surface.closest_point([x, y, 0])
        assert distance < 1e-9
        assert bool(off_mould(mesh, point.face, *point.in_frame(surface), 1e-3)) is off, (x, y)


@pytest.mark.parametrize("turn", [0.0, 1e-17, -1e-17, 1e-16, -1e-16, 5e-16, -5e-16, 1e-15, -1e-15, 1e-13, -1e-13])
def test_along_edges_and_through_vertices_it_ends_in_the_face_that_holds_the_end(turn):
    """Round-off chooses the side of an edge that is followed; the end's face must hold the end all the same."""
    surface = SURFACES["plate"]
    tried = 0
    for face in range(len(surface.faces)):
        for k in range(3):
            tail, head = surface.vertices[surface.faces[face, [k, (k + 1) % 3]]]
            along = (head - tail) / np.linalg.norm(head - tail)
            weight = np.zeros(3)
            weight[[k, (k + 1) % 3]] = 0.7, 0.3
            place = Place(face, *SurfacePoint(face, weight).in_frame(surface))
            frame = surface.unfolding.frame[face]
            dx, dy = along @ frame[3:6], along @ frame[6:9]
            there = walk(surface, place, (dx - turn * dy, dy + turn * dx), 3.3 * np.linalg.norm(head - tail))
            if there.code != WALKED:
                continue
            tried += 1
            line = surface.unfolding.line[there.end.face].reshape(3, 3)
            height = line[:, 0] * there.end.x + line[:, 1] * there.end.y - line[:, 2]
            assert height.min() > -1e-9, (face, k)
    assert tried > 100


def test_what_stands_beside_a_walk():
    """On a plane: the corner nearest to the line of all faces it crosses, and the sum over them and over the edges."""
    surface = SURFACES["plate"]
    mesh, rng = surface.unfolding, np.random.default_rng(4)
    beside = rng.uniform(size=(len(surface.faces), 6)).astype(np.float32)
    for _ in range(50):
        (ax, ay), angle = rng.uniform(-35, 35, 2), rng.uniform(0, 2 * np.pi)
        length = rng.uniform(5, 28)
        place = place_at(surface, (ax, ay, 0.0))
        direction = in_face(surface, place.face, (np.cos(angle), np.sin(angle), 0.0))
        code, *_, near, doubt, turn = survey(mesh.plane, mesh.neighbour, beside, *place, *direction, length)
        assert code == WALKED
        along = np.linspace(0, length, 4001)[:, None] * [np.cos(angle), np.sin(angle)] + [ax, ay]
        corners = surface.vertices[surface.faces][:, :, :2]
        tails, heads = corners, np.roll(corners, -1, axis=1)
        edge, out = heads - tails, along[:, None, None] - tails
        left = edge[..., 0] * out[..., 1] - edge[..., 1] * out[..., 0]
        crossed = []
        for face in np.argmax((left >= 0).all(axis=2), axis=1).tolist():
            if face not in crossed:
                crossed.append(face)
        offset = corners[crossed] - [ax, ay]
        aside = np.abs(np.cos(angle) * offset[..., 1] - np.sin(angle) * offset[..., 0])
        assert near == pytest.approx(aside.min(), abs=1e-12)
        total, turned = beside[crossed[0], ::2].sum(), 0.0
        for before, after in pairwise(crossed):
            k = [code // 3 for code in surface.face_neighbour[after]].index(before)
            total, turned = total + beside[after, 2 * k], turned + beside[after, 2 * k + 1]
        assert (doubt, turn) == pytest.approx((total, turned), rel=1e-6)
