"""Every edge of a net is a shortest path of one spacing, on any mould, to 1e-9: libigl's word, not the solver's."""

import numpy as np
import pytest
from cases import CASES
from lattice import placed

import meshdrape
from meshdrape.geodesic.patch import Patch
from meshdrape.surface import SurfacePoint


@pytest.fixture(scope="module", params=CASES)
def net(request):
    return CASES[request.param].drape()


def test_edges_are_exact(net):
    """Apart from edges of a generator that runs through a vertex, where straightest is not shortest."""
    found = meshdrape.audit(net, edges=600)
    assert found.n_edges + found.n_through_vertex + found.n_skipped == min(600, found.n_population)
    assert found.n_edges > 60
    assert found.n_skipped < 0.1 * found.n_edges
    assert found.max_relative_error < 1e-9, found
    assert found.n_second_routes == 0


def test_nodes_that_have_a_place_lie_on_the_mould_or_its_extension(net):
    here = placed(net)
    assert np.array_equal(here, np.isfinite(net.node_position).all(axis=-1))
    surface = net.mould.surface
    for i, j in np.argwhere(net.node_status == meshdrape.NodeStatus.PLACED)[::29]:
        assert surface.closest_point(net.node_position[i, j])[1] < 1e-6 * net.fabric.warp_spacing * (1 + 1e-6)


def test_seed_node_is_the_seed(net):
    assert net.node_status[net.seed_index] == meshdrape.NodeStatus.PLACED
    assert net.node_position[net.seed_index] == pytest.approx(net.seed, abs=1e-9)
    assert np.linalg.norm(net.direction) == pytest.approx(1)


def test_directions_are_unit_tangents_at_the_nodes(net):
    here = placed(net)
    for direction in (net.warp_direction, net.weft_direction):
        size = np.linalg.norm(direction, axis=-1)
        known = np.isfinite(size)
        assert not (known & ~here).any()
        assert size[known] == pytest.approx(1, abs=1e-12)
        normal = net.surface.face_normal[net.lattice.face[known]]
        assert np.abs(np.einsum("ij,ij->i", direction[known], normal)).max() < 1e-9


@pytest.mark.parametrize(
    "name",
    [
        "hills",
        "steep hills",
        "closed sphere",
        "foot of a step, from the floor",
        "cap, cells far above triangles",
    ],
)
def test_a_second_witness_agrees(name):
    """pygeodesic, on the whole extended mould with both ends inserted as vertices."""
    import pygeodesic.geodesic

    net = CASES[name].drape()
    here = placed(net)
    warp, weft = np.argwhere(here[:-1] & here[1:]), np.argwhere(here[:, :-1] & here[:, 1:])
    rng = np.random.default_rng(1)
    edges = [
        (at, at + step)
        for some, step in ((warp, [1, 0]), (weft, [0, 1]))
        for at in some[rng.permutation(len(some))[:12]]
    ]
    for tail, head in edges:
        patch = Patch(net.surface, np.arange(len(net.surface.faces)))
        ends = []
        for at in (tail, head):
            face = int(net.lattice.face[tuple(at)])
            point = SurfacePoint.from_frame(net.surface, face, *net.lattice.xy[tuple(at)])
            vertex, moved = patch.insert(face, point.position(net.surface))
            assert moved < 1e-9
            ends.append(vertex)
        found, _ = pygeodesic.geodesic.PyGeodesicAlgorithmExact(*patch.arrays()).geodesicDistance(*ends)
        assert found == pytest.approx(net.fabric.warp_spacing, rel=1e-9)
