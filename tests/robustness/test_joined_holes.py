"""Holes whose filling would join vertices that the mould joins already, on the other side."""

import numpy as np
import pytest
from moulds import Mesh, bumpy

import meshdrape
from meshdrape import NodeStatus


def with_a_corner_pulled_away(place: tuple[float, float, float]) -> Mesh:
    """Hills of 32 triangles, one of which has a corner elsewhere: a hole with two corners that its edge joins."""
    mesh = bumpy(1, n=4)
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    torn = int(np.argmin(np.linalg.norm(middle - (-16, 36, 13), axis=1)))
    away = int(np.argmin(mesh.vertices[mesh.triangles[torn], 1]))
    triangles = mesh.triangles.copy()
    triangles[torn, away] = len(mesh.vertices)
    return Mesh(np.vstack([mesh.vertices, place]), triangles)


@pytest.mark.parametrize("place", [(1000.0, 3.1, 17.0), (90.0, 20.0, 60.0), (-30.0, 20.0, 90.0)])
def test_a_hole_across_which_an_edge_runs_already(place):
    mesh = with_a_corner_pulled_away(place)
    mould = meshdrape.Mould.from_arrays(mesh.vertices, mesh.triangles)
    net = meshdrape.drape(mould, meshdrape.Fabric(9.0), seed=mesh.vertices[2], extent=(99, 99, 99, 99))
    assert net.count(NodeStatus.PLACED) > 100
    assert meshdrape.audit(net, 100).max_relative_error < 1e-9
