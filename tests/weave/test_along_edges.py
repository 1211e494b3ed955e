"""Fibres along mesh edges, through vertices and along creases: as good as those beside them."""

import numpy as np
import pytest
from fold_designs import design, draped
from moulds import grid

import meshdrape
from meshdrape import NodeStatus
from meshdrape.geodesic.distance import surface_distance
from meshdrape.study.fold import frame
from meshdrape.surface import SurfacePoint

SIDE = np.arange(-10, 11) * 10.0


def hilly(seed, height):
    """A grid of 10 mm with every vertex lifted at random."""
    lift = np.random.default_rng(seed).normal(0, height, (len(SIDE), len(SIDE)))
    return grid(SIDE, SIDE, lambda x, y: (x, y, lift))


def middle(mesh):
    return mesh.vertices[len(mesh.vertices) // 2]


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (1, 1, 0)])
def test_nodes_of_a_start_fibre_through_vertices_lie_in_their_faces(direction):
    """Also one that comes just before a vertex which the fibre is drawn to."""
    outside = []
    for seed in range(12):
        mesh = hilly(seed, 0.2)
        net = meshdrape.drape(
            mesh.mould(), meshdrape.Fabric(10.0 / 3), middle(mesh), direction, extent=(60, 60, 60, 60)
        )
        i, j = net.seed_index
        for row, column in [(i, k) for k in range(net.shape[1])] + [(k, j) for k in range(net.shape[0])]:
            if net.node_status[row, column] <= NodeStatus.OFF_MOULD:
                place = SurfacePoint.from_frame(
                    net.surface, int(net.lattice.face[row, column]), *net.lattice.xy[row, column]
                )
                outside.append(-place.barycentric.min())
        assert net.count(NodeStatus.FOLDED) == net.count(NodeStatus.NOT_REACHED) == 0
    assert len(outside) > 500
    assert max(outside) < 1e-9


@pytest.mark.parametrize(("c", "wavelength", "spacing"), [(0.1790041241680962, 3.9061550672544385, 0.1)])
def test_a_row_along_a_crease_of_many_facets(monkeypatch, c, wavelength, spacing):
    """The sheet laid on the spar from the crease itself: every link passes its vertices by next to nothing."""
    of = design(
        wing={"profile": "flat"},
        spar={"deviation": "sine", "c": c, "wavelength": wavelength},
        start={"first": "spar", "gamma_deg": "free"},
        row_offset=0.0,
        spacing=spacing,
    )
    beside = draped(of)
    monkeypatch.setattr(frame, "BESIDE", 0.0)
    along = draped(of)
    assert along.cloth.row_offset == 0.0 < beside.cloth.row_offset
    assert along.lost == beside.lost == 0
    assert along.net.settled_by_libigl > 30
    assert np.degrees(along.largest.largest) == pytest.approx(np.degrees(beside.largest.largest), abs=0.1)
    assert meshdrape.audit(along.net, 300).max_relative_error < 1e-9


def test_libigl_is_asked_again_where_it_loses_the_path():
    """Within one triangle no way is shorter than the chord, and libigl must say so: there it was a millionth off."""
    k, m, n = 0.004676099106932643, 0.003443410424773247, 0.0026482978993176403
    side = np.arange(-8, 9) * 10.0
    mesh = grid(side, side, lambda x, y: (x, y, k * x**2 + m * y**2 + n * np.abs(x * y) / 2))
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(10.0 / 3), middle(mesh), (0, 1, 0))
    lattice, (row, _) = net.lattice, net.seed_index
    measured = 0
    for i in range(row - 3, row + 4):
        for j in range(net.shape[1] - 1):
            ends = [(i, j), (i, j + 1)]
            if max(net.node_status[end] for end in ends) == 0 and lattice.face[ends[0]] == lattice.face[ends[1]]:
                a, b = (SurfacePoint.from_frame(net.surface, int(lattice.face[at]), *lattice.xy[at]) for at in ends)
                distance, moved = surface_distance(net.surface, a, b, bound=10.0 / 3)
                assert distance == pytest.approx(10.0 / 3, abs=1e-11 + moved)
                measured += 1
    assert measured > 100
