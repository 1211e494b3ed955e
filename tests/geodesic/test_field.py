"""Distance fields by windows against libigl's distances; their directions against straight walks and differences."""

import numpy as np
import pytest
from moulds import Mesh, bumpy, cone, cube, cylinder, holed_plate, icosphere, plate, sliver_plate, step_corner, tube

from meshdrape.geodesic.distance import surface_distance
from meshdrape.geodesic.field import DistanceField, Region
from meshdrape.geodesic.patch import faces_between
from meshdrape.kernels.walk import WALKED, walk
from meshdrape.surface import Surface, SurfacePoint


def _noisy():
    hills = bumpy(1, n=14)
    return Mesh(hills.vertices + np.random.default_rng(1).normal(0, 1.0, hills.vertices.shape), hills.triangles)


MESHES = {
    "plate": plate,
    "slivers": sliver_plate,
    "plate with a hole": holed_plate,
    "cone with curved borders": lambda: cone(n=30),
    "hills": lambda: bumpy(2, n=16),
    "rough": lambda: bumpy(5, n=14, height=60, jitter=0.3),
    "noisy": _noisy,
    "sphere": lambda: icosphere(3, 100),
    "cube": lambda: cube(100.0, 4),
    "saddle vertex": lambda: step_corner(1000, 5),
    "tube": tube,
}


@pytest.fixture(scope="module", params=MESHES)
def surface(request):
    return Surface.from_arrays(*MESHES[request.param]())


def _place(surface, rng):
    """In a face, on an edge or on a vertex."""
    kind, face = rng.random(), int(rng.integers(len(surface.faces)))
    weight = rng.dirichlet([1, 1, 1])
    if kind < 0.2:
        weight = np.eye(3)[rng.integers(3)]
    elif kind < 0.4:
        weight = np.roll([0.3, 0.7, 0.0], rng.integers(3))
    point = SurfacePoint(face, weight)
    return point, (face, *point.in_frame(surface))


def _everywhere(surface, place):
    return DistanceField(Region(surface, np.arange(len(surface.faces))), place, 10 * surface.diagonal)


def test_distances_are_libigls(surface):
    rng = np.random.default_rng(4)
    for _ in range(6):
        source, place = _place(surface, rng)
        field = _everywhere(surface, place)
        ends = [_place(surface, rng) for _ in range(10)]
        found = np.array([field.to(end).length for _, end in ends])
        for length, (end, _) in zip(found, ends, strict=True):
            distance, moved = surface_distance(surface, source, end)
            assert abs(length - distance) < 1e-11 * surface.diagonal + moved
        many = field.distances(np.array([end[0] for _, end in ends]), np.array([end[1:] for _, end in ends]))
        assert np.array_equal(many, found)


def test_a_straight_way_is_walked_from_its_own_direction(surface):
    """From the source in the direction in which it leaves, for its length, to the place, arriving as it says."""
    rng = np.random.default_rng(6)
    mesh = surface.unfolding
    straight = 0
    for _ in range(60):
        weight, goal = rng.dirichlet([1, 1, 1], 2)
        faces = rng.integers(len(surface.faces), size=2)
        tail, head = (SurfacePoint(int(f), w) for f, w in zip(faces, (weight, goal), strict=True))
        source, place = ((p.face, *p.in_frame(surface)) for p in (tail, head))
        way = _everywhere(surface, source).to(place)
        if way.bent:
            continue
        code, face, x, y, dx, dy = walk(mesh.plane, mesh.neighbour, *source, *way.leave, way.length)
        assert code == WALKED
        end = SurfacePoint.from_frame(surface, face, x + way.length * dx, y + way.length * dy)
        assert np.linalg.norm(end.position(surface) - head.position(surface)) < 1e-9 * surface.diagonal
        if face == head.face:
            assert (dx, dy) == pytest.approx(tuple(way.arrive), abs=1e-9)
        straight += 1
    assert straight >= 5


def test_slopes_are_the_directions_of_the_paths(surface):
    """By central differences of both ends, bent paths among them."""
    rng = np.random.default_rng(8)
    step = 1e-6 * surface.diagonal
    n_bent = 0
    for _ in range(25):
        tail, head = (SurfacePoint(int(rng.integers(len(surface.faces))), np.full(3, 1 / 3)) for _ in range(2))
        if tail.face == head.face:
            continue
        source, place = ((p.face, *p.in_frame(surface)) for p in (tail, head))
        field = _everywhere(surface, source)
        back = _everywhere(surface, place)
        way = field.to(place)
        n_bent += way.bent
        assert back.to(source).length == pytest.approx(way.length, rel=1e-13)
        for one, at, direction in ((field, place, way.arrive), (back, source, -way.leave)):
            around = [
                one.to((at[0], at[1] + dx, at[2] + dy)).length
                for dx, dy in ((step, 0), (-step, 0), (0, step), (0, -step))
            ]
            slope = np.array([around[0] - around[1], around[2] - around[3]]) / (2 * step)
            # where two ways are equally long the slope jumps
            if np.linalg.norm(slope) > 1 - 1e-6:
                assert slope == pytest.approx(direction, abs=1e-5)
    if surface.vertex_defect.min() < -0.3:
        assert n_bent > 0


def test_a_region_holds_the_paths_it_was_cut_for():
    surface = Surface.from_arrays(*bumpy(4, n=40, height=45))
    rng = np.random.default_rng(2)
    for _ in range(10):
        (a, source), (b, place) = (_place(surface, rng) for _ in range(2))
        distance, _ = surface_distance(surface, a, b)
        faces = np.sort(faces_between(surface, a, b, distance * (1 + 1e-6)))
        assert len(faces) < len(surface.faces)
        way = DistanceField(Region(surface, faces), source, 1.1 * distance).to(place)
        assert way.length == pytest.approx(distance, rel=1e-12)
        outside = np.setdiff1d(np.arange(len(surface.faces)), faces)[0]
        assert DistanceField(Region(surface, faces), source, distance).to((int(outside), 0.0, 0.0)) is None


def test_beyond_the_reach_there_is_no_way():
    surface = Surface.from_arrays(*cylinder(60, (0, 3), 80, 30))
    (a, source), (b, place) = (
        (p, (p.face, *p.in_frame(surface)))
        for p in (SurfacePoint(0, np.full(3, 1 / 3)), SurfacePoint(len(surface.faces) - 1, np.full(3, 1 / 3)))
    )
    region = Region(surface, np.arange(len(surface.faces)))
    assert DistanceField(region, source, 20.0).to(place) is None
    distance, _ = surface_distance(surface, a, b)
    assert DistanceField(region, source, distance).to(place).length == pytest.approx(distance, rel=1e-12)
