"""Round a convex vertex, or round the back of a tube, another way may be the shorter: no edge of a net has one."""

import numpy as np
import pytest
from moulds import bumpy, cube, icosphere, tube

import meshdrape
from meshdrape.geodesic import surface_distance
from meshdrape.kernels.certify import second_route
from meshdrape.kernels.tables import Detours
from meshdrape.surface import Surface, SurfacePoint

MOULDS = {
    "ball of few triangles": (lambda: icosphere(2, 1000.0), 180.0, (80, -60, 970)),
    "ball": (lambda: icosphere(4, 1000.0), 100.0, (80, -60, 995)),
    "hills, cells above triangles": (lambda: bumpy(7), 25.0, (3, 5, 0)),
    "closed cube": (lambda: cube(200.0, 2), 35.0, (30, 40, 0)),
    "tube, cells half way round": (lambda: tube(60.0), 150.0, (60, 0, 0)),
}


@pytest.mark.parametrize("name", MOULDS)
def test_no_edge_has_a_shorter_way(name):
    make, spacing, seed = MOULDS[name]
    net = meshdrape.drape(make().mould(), meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.3, 0.1))
    found = meshdrape.audit(net, edges=5000)
    assert found.n_edges + found.n_through_vertex > 3
    assert found.n_second_routes == 0, found
    assert not found.n_edges or found.max_relative_error < 1e-9, found


def test_without_suspicion_there_would_be_some():
    """On a ball of few triangles, with the tables that raise it emptied."""
    make, spacing, seed = MOULDS["ball"]
    mould = make().mould()
    surface = mould.surface
    n = len(surface.faces)
    vars(surface)["detours"] = Detours(np.zeros((n, 3)), np.zeros(n, dtype=bool), np.tile([0.0, 0.0, 1.0], (n, 1)))
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.3, 0.1))
    assert meshdrape.audit(net, edges=5000).n_second_routes > 0


@pytest.mark.parametrize("defect", [0.05, 0.5, np.pi / 2, 4.0])
def test_suspicion_on_a_cone(defect):
    """Past an apex of known defect: a path that has a shorter way is suspected, one far from the apex is not."""
    n = 12
    slant = 1000.0
    half = np.arcsin(1 - defect / (2 * np.pi))
    turns = 2 * np.pi * np.arange(n) / n
    # the base's polygon is such that the face angles at the apex add up to 2 pi less the defect
    wide = np.sin((2 * np.pi - defect) / (2 * n)) / np.sin(np.pi / n)
    rim = slant * np.stack([wide * np.cos(turns), wide * np.sin(turns), np.full(n, -np.sqrt(1 - wide**2))], axis=1)
    assert half > 0
    faces = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    surface = Surface.from_arrays(np.concatenate([[[0.0, 0.0, 0.0]], rim]), np.array(faces))
    assert surface.vertex_defect[0] == pytest.approx(defect, abs=1e-12)
    mesh, detours = surface.unfolding, surface.detours
    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(200):
        weights = rng.dirichlet((1, 1, 1))
        tail = SurfacePoint(int(rng.integers(n)), weights)
        x, y = tail.in_frame(surface)
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(50, 500)
        direction = (np.cos(angle), np.sin(angle))
        from meshdrape.kernels.walk import WALKED, walk

        code, face, u, v, dx, dy = walk(mesh.plane, mesh.neighbour, tail.face, x, y, *direction, length)
        if code != WALKED:
            continue
        head = SurfacePoint.from_frame(surface, int(face), u + length * dx, v + length * dy)
        distance, _ = surface_distance(surface, tail, head)
        suspected = second_route(mesh.plane, mesh.neighbour, detours.tangent, tail.face, x, y, *direction, length)
        shorter = distance < length * (1 - 1e-9)
        assert suspected or not shorter
        seen.add((bool(suspected), bool(shorter)))
    assert (False, False) in seen
