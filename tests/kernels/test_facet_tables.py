"""The tables of a mesh against slow and obvious ones, and the parts it falls into."""

import numpy as np
import pytest
from moulds import Mesh, bumpy, cap, cube, holed_plate, icosphere, tube

from meshdrape.kernels.components import connected_parts
from meshdrape.kernels.facets import chords, may_be_nearest, pair_edges, star_radii
from meshdrape.mould.formats.weld import _close_pairs
from meshdrape.surface import Surface


def fan(n: int) -> Mesh:
    """A cone of n triangles round one vertex, numbered last."""
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    k = np.arange(n)
    return Mesh(np.concatenate([rim, [[0, 0, 0.3]]]), np.stack([k, (k + 1) % n, np.full(n, n)], axis=1))


MESHES = [
    bumpy(3),
    cap(3),
    cube(),
    holed_plate(),
    icosphere(2),
    tube(),
    fan(5000),
    Mesh(np.eye(3), np.array([[0, 1, 2]])),
]


@pytest.fixture(params=MESHES, ids=lambda mesh: f"{len(mesh.triangles)} triangles")
def mesh(request: pytest.FixtureRequest) -> Mesh:
    return Mesh(request.param.vertices, np.ascontiguousarray(request.param.triangles, dtype=np.int64))


def test_edges_are_paired_as_a_dictionary_pairs_them(mesh):
    tail, head = mesh.triangles.ravel().tolist(), np.roll(mesh.triangles, -1, axis=1).ravel().tolist()
    half_edge = {ends: h for h, ends in enumerate(zip(tail, head, strict=True))}
    expected = [half_edge.get((b, a), -1) for a, b in zip(tail, head, strict=True)]
    found = np.empty_like(mesh.triangles)
    assert pair_edges(mesh.triangles, found)
    assert found.ravel().tolist() == expected


@pytest.mark.parametrize(
    "triangles",
    [
        [[0, 1, 2], [0, 1, 3]],  # alike
        [[0, 1, 2], [1, 0, 3], [0, 1, 4]],  # a third, as the first
        [[0, 1, 2], [1, 0, 3], [1, 0, 4]],  # a third, as the second
        [[0, 0, 1], [0, 0, 2]],
    ],
)
def test_edges_of_no_surface_are_refused(triangles):
    triangles = np.array(triangles)
    assert not pair_edges(triangles, np.empty_like(triangles))


def test_facets_are_numpys_to_the_bit(mesh):
    """They were numpy's once, and nets must not change with who works them out."""
    surface = Surface.from_arrays(mesh.vertices, mesh.triangles)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    assert np.array_equal(surface.face_area, 0.5 * size)
    assert np.array_equal(surface.face_normal, normal / size[:, None])
    sides = np.stack([np.linalg.norm(v - u, axis=1) for u, v in ((b, c), (c, a), (a, b))], axis=1)
    opposite, left, right = sides, np.roll(sides, -1, axis=1), np.roll(sides, -2, axis=1)
    cosine = (left**2 + right**2 - opposite**2) / (2 * left * right)
    assert np.allclose(np.cos(surface.corner_angle), cosine, rtol=0, atol=1e-12)


def test_a_continued_surface_is_that_of_all_its_triangles(mesh):
    # vertices in the order of their first use, so that the first triangles use the first of them
    _, first_use, vertex = np.unique(mesh.triangles, return_index=True, return_inverse=True)
    order = np.argsort(first_use)
    vertices, triangles = mesh.vertices[order], np.argsort(order)[vertex].reshape(-1, 3)
    kept = max(1, len(triangles) // 3)
    n = int(triangles[:kept].max()) + 1
    whole = Surface.from_arrays(vertices, triangles, kept)
    continued = Surface.from_arrays(vertices[:n], triangles[:kept]).continued(vertices[n:], triangles[kept:], kept)
    for name in ("vertices", "faces", "face_neighbour", "face_rim", "face_normal", "face_area", "corner_angle"):
        assert np.array_equal(getattr(continued, name), getattr(whole, name)), name


def test_chords_are_those_of_the_normals(mesh):
    surface = Surface.from_arrays(mesh.vertices, mesh.triangles)
    first = len(mesh.triangles) // 2
    chord = np.full((len(mesh.triangles) - first, 3), np.nan)
    chords(surface.face_normal, surface.face_neighbour, first, chord)
    beside = surface.face_neighbour[first:]
    away = surface.face_normal[beside // 3] - surface.face_normal[first:, None]
    assert np.array_equal(chord, np.where(beside < 0, 0.0, np.linalg.norm(away, axis=2)))


def test_star_radii_are_the_lowest_heights(mesh):
    surface = Surface.from_arrays(mesh.vertices, mesh.triangles)
    found = np.empty(len(mesh.vertices))
    star_radii(surface.vertices, surface.faces, surface.face_area, found)
    expected = np.full(len(mesh.vertices), np.inf)
    for k in range(3):
        p, q, r = (mesh.vertices[np.roll(mesh.triangles, -k, axis=1)[:, n]] for n in range(3))
        along = (r - q) / np.linalg.norm(r - q, axis=1)[:, None]
        height = np.linalg.norm(np.cross(along, p - q), axis=1)
        np.minimum.at(expected, mesh.triangles[:, k], height)
    assert np.allclose(found, expected, rtol=1e-12)


def test_the_nearest_face_is_among_those_that_may_be(mesh):
    surface = Surface.from_arrays(mesh.vertices, mesh.triangles)
    rng = np.random.default_rng(8)
    size = np.abs(mesh.vertices).max()
    for point in rng.uniform(-1.5 * size, 1.5 * size, (20, 3)):
        few = may_be_nearest(surface.vertices, surface.faces, point)
        weights = rng.dirichlet([0.3, 0.3, 0.3], (200, len(mesh.triangles)))
        places = np.einsum("smk,mkd->smd", weights, mesh.vertices[mesh.triangles])
        nearest = np.linalg.norm(places - point, axis=2).min(axis=0)
        _, distance = surface.closest_point(point)
        assert (np.diff(few) > 0).all()
        assert distance <= nearest.min() * (1 + 1e-12)
        assert int(np.argmin(nearest)) in few.tolist() or nearest[few].min() <= nearest.min() * 1.05


def test_parts_are_scipys():
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    rng = np.random.default_rng(5)
    for n, k in ((1, 0), (7, 3), (1000, 400), (1000, 900), (1000, 5000)):
        a, b = rng.integers(0, n, (2, k))
        expected = connected_components(coo_array((np.ones(k), (a, b)), shape=(n, n)), directed=False)[1]
        assert np.array_equal(connected_parts(a, b, n), expected)


@pytest.mark.parametrize("flat", [False, True])
def test_close_pairs_are_those_of_a_tree(flat):
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(6)
    points = rng.uniform(0, 10, (3000, 3)) * ((1, 1, 0) if flat else (1, 1, 1))
    points[1000:2000] = points[:1000] + rng.uniform(-1e-3, 1e-3, (1000, 3))
    found = np.sort(_close_pairs(points, 1e-3), axis=1)
    expected = cKDTree(points).query_pairs(1e-3)
    assert len(found) == len(expected) > 100
    assert set(map(tuple, found.tolist())) == expected
