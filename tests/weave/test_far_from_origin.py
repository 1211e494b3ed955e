"""A mould in aircraft coordinates, kilometres from the origin: the same net as near it, node for node."""

import numpy as np
import pytest
from moulds import icosphere, rotation

import meshdrape


@pytest.mark.parametrize("away", [1e6, 1e7])
@pytest.mark.parametrize("spacing", [2.0, 9.0])
def test_far_from_the_origin(spacing, away):
    ball = icosphere(2, 100.0)
    dome = ball.kept(ball.vertices[ball.triangles].mean(axis=1)[:, 2] > 20)
    # aslant, or coordinates happen to be round
    turn = rotation((0.3, -0.5, 1.0), 0.7)
    shift = away * np.array([0.35, 0.82, -0.33])
    near_mould, far_mould = dome.moved(turn).mould(), dome.moved(turn, shift).mould()
    net, far = (
        meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=turn @ [3, 7, 99] + at, direction=turn @ [1, 0.3, 0])
        for mould, at in ((near_mould, 0), (far_mould, shift))
    )
    assert np.count_nonzero(net.node_status == meshdrape.NodeStatus.PLACED) > 500
    assert np.array_equal(far.node_status, net.node_status)
    # coordinates end at 2^-53 of the offset, those of the mould as well; some hundred nodes in a row pass it on
    rough = np.finfo(float).eps * away
    assert np.nanmax(np.linalg.norm(far.node_position - shift - net.node_position, axis=-1)) < 1000 * rough
    shear, far_shear = (meshdrape.measure(n).cell_shear for n in (net, far))
    assert far_shear == pytest.approx(shear, abs=1000 * rough / spacing, nan_ok=True)
    assert meshdrape.audit(far, 200).max_relative_error < 20 * rough / spacing
    # the surface went back to where the mould is
    assert np.array_equal(far.surface.vertices[: len(far_mould.surface.vertices)], far_mould.surface.vertices)


def test_a_surface_brought_near_is_not_rounded():
    surface = icosphere(1, 100.0).moved(rotation((1, 2, 3), 0.4), (3e5, 20.0, -7e6)).mould().surface
    near, by = surface.brought_near
    assert by[1] == 0
    assert np.abs(near.vertices).max() < 150
    assert np.array_equal(near.vertices - by, surface.vertices)
    assert np.array_equal(near.moved(-by).vertices, surface.vertices)
    assert np.array_equal(near.unfolding.plane, surface.unfolding.plane)
    there, where = near.brought_near
    assert there is near
    assert not where.any()
