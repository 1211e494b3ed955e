"""Round a convex vertex, or round the back of a tube, another way may be the shorter: no edge of a net has one."""

import numpy as np
import pytest
from moulds import Mesh, bumpy, cube, grid, icosphere, tube

import meshdrape
from meshdrape.geodesic import surface_distance
from meshdrape.geodesic.detours import detours
from meshdrape.kernels.certify import is_alone, second_route
from meshdrape.kernels.tables import KEPT_OUT, Detours
from meshdrape.kernels.walk import WALKED, survey, walk
from meshdrape.surface import Surface, SurfacePoint

MOULDS = {
    "ball of few triangles": (lambda: icosphere(2, 1000.0), 180.0, (80, -60, 970)),
    "ball": (lambda: icosphere(4, 1000.0), 100.0, (80, -60, 995)),
    "hills, cells above triangles": (lambda: bumpy(7), 25.0, (3, 5, 0)),
    "closed cube": (lambda: cube(200.0, 2), 35.0, (30, 40, 0)),
    "closed cube of small triangles": (lambda: cube(200.0, 12), 55.0, (30, 40, 0)),
    "cone of blunt tip": (lambda: blunt_cone(3.0), 25.0, (8.0, -22.0, 0)),
    "cone of very blunt tip": (lambda: blunt_cone(12.0), 25.0, (8.0, -22.0, 0)),
    "tube, cells half way round": (lambda: tube(60.0), 150.0, (60, 0, 0)),
}


def blunt_cone(tip: float) -> Mesh:
    """A cone of slope 0.9 with its tip rounded off over so many mm, in triangles a third of that, wider further out."""
    fine = np.arange(0, 4 * tip, tip / 3)
    side = np.concatenate([fine, np.geomspace(fine[-1], 80.0, 9)[1:]])
    side = np.concatenate([-side[:0:-1], side])
    return grid(side, side, lambda x, y: (x, y, -0.9 * np.sqrt(x**2 + y**2 + tip**2)))


def cone(defect: float, n: int = 12, slant: float = 1000.0) -> Surface:
    """A pyramid of n faces about an apex of known angle defect."""
    turns = 2 * np.pi * np.arange(n) / n
    # the base's polygon is such that the face angles at the apex add up to 2 pi less the defect
    wide = np.sin((2 * np.pi - defect) / (2 * n)) / np.sin(np.pi / n)
    rim = slant * np.stack([wide * np.cos(turns), wide * np.sin(turns), np.full(n, -np.sqrt(1 - wide**2))], axis=1)
    faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    return Surface.from_arrays(np.concatenate([[[0.0, 0.0, 0.0]], rim]), np.array(faces))


@pytest.mark.parametrize("name", MOULDS)
def test_no_edge_has_a_shorter_way(name):
    make, spacing, seed = MOULDS[name]
    net = meshdrape.drape(make().mould(), meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.3, 0.1))
    found = meshdrape.audit(net, edges=5000)
    assert found.n_edges + found.n_through_vertex > 3
    assert found.n_second_routes == 0, found
    assert not found.n_edges or found.max_relative_error < 1e-9, found


@pytest.mark.parametrize("name", ["ball", "cone of blunt tip", "closed cube of small triangles"])
def test_without_suspicion_there_would_be_some(name, monkeypatch):
    """With the tables that raise it emptied."""
    make, spacing, seed = MOULDS[name]
    mould = make().mould()

    def trustful(surface, length):
        n = len(surface.faces)
        nothing = np.zeros((n, 6), dtype=np.float32)
        return Detours(np.zeros((n, 3)), np.zeros(n, dtype=bool), nothing, np.tile([0.0, 0.0, 1.0], (n, 1)))

    monkeypatch.setattr("meshdrape.weave.lay.quadrants.detours", trustful)
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.3, 0.1))
    assert meshdrape.audit(net, edges=5000).n_second_routes > 0


def past(surface: Surface, point, length: float, rng: np.random.Generator, spread: float):
    """A straight path of some length past a point (3,): (suspected, shorter way there is); None where it ends."""
    mesh, table = surface.unfolding, detours(surface, length)
    away = rng.normal(size=3)
    tail, _ = surface.closest_point(point + length * rng.uniform(0.3, 0.7) * away / np.linalg.norm(away))
    ahead = point - tail.position(surface)
    ahead += spread * np.linalg.norm(ahead) * rng.normal(size=3)
    direction = mesh.frame[tail.face].reshape(3, 3)[1:] @ ahead
    if not np.linalg.norm(direction) > 0:
        return None
    direction /= np.linalg.norm(direction)
    x, y = tail.in_frame(surface)
    code, face, u, v, dx, dy = walk(mesh.plane, mesh.neighbour, tail.face, x, y, *direction, length)
    if code != WALKED:
        return None
    head = SurfacePoint.from_frame(surface, int(face), u + length * dx, v + length * dy)
    distance, _ = surface_distance(surface, tail, head, bound=length * (1 + 1e-6))
    suspected = second_route(
        mesh.plane, mesh.neighbour, table.corner, table.normal, tail.face, x, y, *direction, length
    )
    return bool(suspected), bool(distance < length * (1 - 1e-9))


@pytest.mark.parametrize("defect", [0.05, 0.5, np.pi / 2, 4.0])
def test_suspicion_beside_an_apex(defect):
    """A path that has a shorter way round it is suspected, one far from it is not."""
    surface = cone(defect)
    assert surface.vertex_defect[0] == pytest.approx(defect, abs=1e-12)
    rng = np.random.default_rng(3)
    seen = {past(surface, np.zeros(3), 300.0, rng, 0.5) for _ in range(150)}
    assert (False, True) not in seen
    assert {(True, True), (False, False)} <= seen or defect == 4.0


@pytest.mark.parametrize(
    ("make", "point", "length"),
    [
        (lambda: blunt_cone(1.0), (0, 0, -0.9), 20.0),
        (lambda: blunt_cone(10.0), (0, 0, -9.0), 20.0),
        (lambda: cube(200.0, 10), (200, 200, 200), 60.0),
        (lambda: icosphere(3, 100.0), (0, 0, 100), 60.0),
        (lambda: icosphere(3, 100.0), (0, 0, 100), 140.0),
        (lambda: tube(60.0, 900.0), (60, 0, 0), 350.0),
    ],
)
def test_suspicion_beside_crowds(make, point, length):
    """Vertices that offer no shorter way may do so together, and from farther off than the faces round them."""
    surface = make().mould().surface
    rng = np.random.default_rng(5)
    seen = [past(surface, np.array(point, dtype=float), length, rng, 0.2) for _ in range(100)]
    assert (False, True) not in seen
    assert (True, True) in seen


@pytest.mark.parametrize(
    ("make", "length", "share"),
    [
        (lambda: icosphere(4, 100.0), 5.0, 0.95),
        (lambda: icosphere(4, 100.0), 60.0, 0.01),
        (lambda: bumpy(7), 25.0, 0.0),
        (lambda: blunt_cone(3.0), 25.0, 0.0),
        (lambda: cube(200.0, 12), 8.0, 0.8),
        (lambda: tube(60.0), 150.0, 0.0),
    ],
)
def test_what_a_walk_tells_clears_no_path_that_is_suspect(make, length, share):
    """Taken as if all that stands beside a path were as near as the nearest, it spares most of them the certificate."""
    surface = make().mould().surface
    mesh, table = surface.unfolding, detours(surface, length)
    rng = np.random.default_rng(2)
    seen = []
    for _ in range(2000):
        face = int(rng.integers(len(surface.faces)))
        start = SurfacePoint(face, rng.dirichlet([1, 1, 1])).in_frame(surface)
        angle = rng.uniform(0, 2 * np.pi)
        path = (face, *start, np.cos(angle), np.sin(angle), length)
        code, *_, near, doubt, turn = survey(mesh.plane, mesh.neighbour, table.beside, *path)
        if code == WALKED:
            suspected = second_route(mesh.plane, mesh.neighbour, table.corner, table.normal, *path)
            seen.append((bool(is_alone(near, doubt, turn, length)), bool(suspected)))
    assert (True, True) not in seen
    assert np.mean([alone for alone, _ in seen]) >= share


def test_suspicion_is_local():
    """Big flat faces of a thin plate are suspect at their corners only, though all corners are crowds of two."""
    surface = cube(1.0, 1).moved(np.diag([500.0, 400.0, 3.0])).mould().surface
    rng = np.random.default_rng(1)
    places = [(x, y, 3.0) for x, y in rng.uniform(0.05, 0.95, (100, 2)) * (500, 400)]
    assert {past(surface, np.array(place), 10.0, rng, 1.0) for place in places} == {(False, False)}


def test_suspicion_does_not_depend_on_how_large_the_rest_is():
    """Where boxes as wide as a path would be more than there are numbers."""
    small, far = blunt_cone(1.0), 1e9
    corners = np.abs(small.vertices[:, :2]).max(axis=1) >= 80.0 * (1 - 1e-12)
    large = Mesh(np.where(corners[:, None], far * small.vertices, small.vertices), small.triangles)
    tip = int(np.argmax(small.vertices[:, 2]))
    radius = []
    for mesh in (small, large):
        surface = mesh.mould().surface
        face, k = np.argwhere(surface.faces == tip)[0]
        radius.append(detours(surface, 20.0).corner[face, k] - KEPT_OUT)
    assert radius[0] > 4
    assert radius[1] == pytest.approx(radius[0], rel=1e-6)
