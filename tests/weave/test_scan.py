"""Nodes in the shadow of a saddle vertex, where the straight paths of one parent do not get, in either role."""

import numpy as np
import pytest
from moulds import Mesh

import meshdrape


def star(points: int = 3, lift: float = 0.6, radius: float = 500.0) -> Mesh:
    """Flat triangles about one vertex of 464 degrees, the rim going up and down."""
    azimuth = np.linspace(0, 2 * np.pi, 2 * points, endpoint=False)
    rim = np.stack([np.cos(azimuth), np.sin(azimuth), lift * (-1.0) ** np.arange(2 * points)], axis=-1)
    spoke = 1 + np.arange(2 * points)
    return Mesh(
        radius * np.vstack([np.zeros(3), rim]), np.stack([np.zeros_like(spoke), spoke, np.roll(spoke, -1)], axis=-1)
    )


# found among a few hundred random starts: in one of both roles the first guess is far off the node that is there
@pytest.mark.parametrize(
    ("place", "degrees"),
    [((96, 158), 43), ((33, -35), 138), ((102, 81), 47), ((-147, 102), 123), ((234, 2), 74), ((3, -124), 104)],
)
def test_warp_and_weft_change_roles(place, degrees):
    mould = star().mould()
    seed = mould.surface.closest_point((*place, 0.0))[0].position(mould.surface)
    fabric = meshdrape.Fabric(80.0)
    along = np.radians(degrees)
    net = meshdrape.drape(mould, fabric, seed=seed, direction=(np.cos(along), np.sin(along), 0))
    # the weft becomes the warp; the old warp is then the new weft, run backwards
    turned = meshdrape.drape(mould, fabric, seed=seed, direction=net.weft_direction[net.seed_index])
    status, position = turned.node_status.T[::-1], turned.node_position.transpose(1, 0, 2)[::-1]
    assert (net.seed_index[0], net.seed_index[1]) == (len(status) - 1 - turned.seed_index[1], turned.seed_index[0])
    assert np.array_equal(status, net.node_status)
    placed = status == meshdrape.NodeStatus.PLACED
    assert np.linalg.norm(position - net.node_position, axis=-1)[placed].max() < 1e-9 * 80
    assert meshdrape.audit(net).max_relative_error < 1e-11
