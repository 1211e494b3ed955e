"""Meshes of slivers: exact edges, and libigl asked only where there may be something to tell."""

import numpy as np
import pytest

import meshdrape
from meshdrape.surface import SurfacePoint
from meshdrape.weave.lay import settle


def slivers(seed, stretch, points=250, size=60.0, noise=0.2):
    """Random points, triangulated as if one axis were `stretch` times as long, and lifted at random."""
    from scipy.spatial import Delaunay

    rng = np.random.default_rng(seed)
    plane = rng.uniform(0, size, (points, 2))
    triangles = Delaunay(plane * [1.0, stretch]).simplices
    corners = plane[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turned = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    triangles = triangles[np.abs(turned) > 1e-6]
    backward = turned[np.abs(turned) > 1e-6] < 0
    triangles[backward] = triangles[backward][:, ::-1]
    vertices = np.column_stack([plane, rng.normal(0, noise, points)])
    used, triangles = np.unique(triangles, return_inverse=True)
    return meshdrape.Mould.from_arrays(vertices[used], triangles.reshape(-1, 3))


@pytest.mark.parametrize(("seed", "stretch"), [(2, 100.0), (5, 200.0)])
def test_most_nodes_that_are_doubted_are_judged_without_libigl(monkeypatch, seed, stretch):
    judged, measured = [], []
    shortest, surface_distance = settle.shortest, settle.surface_distance

    def counted_shortest(*request):
        judged.append(shortest(*request))
        return judged[-1]

    def counted_distance(*request, **options):
        measured.append(surface_distance(*request, **options))
        return measured[-1]

    monkeypatch.setattr("meshdrape.weave.lay.judge.shortest", counted_shortest)
    monkeypatch.setattr(settle, "surface_distance", counted_distance)
    mould = slivers(seed, stretch)
    seed_point = mould.surface.closest_point((29, 31, 0))[0].position(mould.surface)
    net = meshdrape.drape(mould, meshdrape.Fabric(1.0), seed_point, (1, 0.4, 0), extent=(16, 16, 16, 16), threads=1)
    assert len(judged) > 150
    assert len(measured) < 0.3 * len(judged)
    assert meshdrape.audit(net, 150).max_relative_error < 1e-9


def test_what_is_shortest_is_what_libigl_says():
    """Straight paths over slivers, some of them not the shortest."""
    length = 15.0
    mould = slivers(3, 60.0, noise=1.5)
    surface, rng = mould.surface, np.random.default_rng(3)
    says = []
    for _ in range(150):
        face, turn = int(rng.integers(len(surface.faces))), rng.uniform(0, 2 * np.pi)
        tail = (face, *SurfacePoint(face, rng.dirichlet([1, 1, 1])).in_frame(surface))
        head = settle.step_from(surface, tail, length * np.array([np.cos(turn), np.sin(turn)]))
        if head is not None:
            ends = [SurfacePoint.from_frame(surface, *place) for place in (tail, head)]
            says.append(settle.surface_distance(surface, *ends)[0] >= length * (1 - settle.MET))
            assert settle.shortest(surface, tail, head, length) == says[-1]
    assert len(says) > 60
    assert 0.1 < np.mean(says) < 0.95
