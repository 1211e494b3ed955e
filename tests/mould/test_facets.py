"""Diagonals and splits on plain arrays, no CAD face behind them."""

import numpy as np
import pytest
from scipy.spatial import Delaunay

from meshdrape.mould.cad.facets import Facets
from meshdrape.mould.cad.patch import Nodes


def flat_nodes(uv: np.ndarray, metric: tuple[float, float, float] = (1, 0, 1)) -> Nodes:
    """Nodes on the plane z = 0 with one metric for all of them."""
    n = len(uv)
    return Nodes(
        face=np.zeros(n, dtype=np.int64),
        uv=uv,
        position=np.column_stack([uv, np.zeros(n)]),
        normal=np.tile([0.0, 0.0, 1.0], (n, 1)),
        tangent=np.tile(np.eye(3)[:2], (n, 1, 1)),
        metric=np.tile(np.array(metric, dtype=float), (n, 1)),
        curvature=np.zeros(n),
        pole=np.zeros(n, dtype=bool),
    )


def counter_clockwise(uv: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (uv[triangles[:, k]] for k in range(3))
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    return np.where(turned[:, None], triangles[:, ::-1], triangles).astype(np.int64)


def cloud(seed: int, n: int = 300) -> np.ndarray:
    square = np.array([[-1, -1], [2, -1], [2, 2], [-1, 2]], dtype=float)
    return np.concatenate([square, np.random.default_rng(seed).random((n, 2))])


def edges(triangles: np.ndarray) -> set[tuple[int, int]]:
    return {tuple(sorted(pair)) for t in triangles.tolist() for pair in zip(t, t[1:] + t[:1], strict=True)}


def assert_consistent(facets: Facets) -> None:
    """Every twin runs back along its half-edge."""
    tail, head = facets.triangles.ravel(), facets.triangles[:, [1, 2, 0]].ravel()
    half = np.flatnonzero(facets.twin >= 0)
    twin = facets.twin[half]
    assert (facets.twin[twin] == half).all()
    assert (tail[half] == head[twin]).all()
    assert (head[half] == tail[twin]).all()
    directed = tail * len(facets.nodes) + head
    assert len(np.unique(directed)) == len(directed)
    assert (facets.twin < 0).sum() == len(edges(facets.triangles)) * 2 - facets.triangles.size


@pytest.mark.parametrize("metric", [(1, 0, 1), (1, 0, 400), (5, 4, 5)])
def test_flips_reach_the_delaunay_triangulation_of_the_metric(metric):
    uv = cloud(0)
    facets = Facets(flat_nodes(uv, metric), counter_clockwise(uv, Delaunay(uv).simplices), np.ones(1))
    facets.make_delaunay()
    uu, mixed, vv = metric
    stretched = uv @ np.linalg.cholesky([[uu, mixed], [mixed, vv]])
    assert edges(facets.triangles) == edges(Delaunay(stretched).simplices)
    assert_consistent(facets)


def test_a_fan_over_a_straight_side_turns_into_a_strip():
    n = 200
    low, high = np.column_stack([np.arange(n), np.zeros(n)]), np.column_stack([np.arange(n), np.full(n, 0.7)])
    uv = np.concatenate([low, high]).astype(float)
    fan = [[i, i + 1, n] for i in range(n - 1)] + [[n - 1, n + j + 1, n + j] for j in range(n - 1)]
    facets = Facets(flat_nodes(uv), np.array(fan), np.ones(1))
    facets.make_delaunay()
    assert_consistent(facets)
    assert max(abs(a % n - b % n) for a, b in edges(facets.triangles)) == 1


def test_splits_keep_the_surface_and_its_neighbours():
    uv = cloud(1)
    facets = Facets(flat_nodes(uv), counter_clockwise(uv, Delaunay(uv).simplices), np.ones(1))
    area = 9.0
    for _ in range(3):
        edge = facets.inner_edges()
        edge = edge[facets.apart(edge, np.arange(len(edge), dtype=float))]
        assert len(np.unique(np.concatenate([edge // 3, facets.twin[edge] // 3]))) == 2 * len(edge)
        a, b, _, _ = facets.quads(edge)
        before = len(facets.triangles)
        touched = facets.split(edge, flat_nodes((facets.nodes.uv[a] + facets.nodes.uv[b]) / 2))
        assert len(facets.triangles) == before + 2 * len(edge)
        assert len(touched) == 4 * len(edge)
        assert_consistent(facets)
        facets.make_delaunay(touched)
        assert_consistent(facets)
    corners = facets.nodes.uv[facets.triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    signed = (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    assert signed.min() > 0
    assert signed.sum() == pytest.approx(area, rel=1e-12)
