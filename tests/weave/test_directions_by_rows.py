"""Edges that a tangent shares with the next node's are walked once; where a block begins must not matter."""

import numpy as np
from moulds import cap, krogh

import meshdrape


def test_directions_do_not_depend_on_where_a_block_begins():
    for mould, seed in ((cap(4).mould(), (0, 0, 1000)), (krogh(40).mould(), None)):
        spacing = mould.surface.diagonal / 60
        net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.2, 0))
        assert len(np.unique(net.lattice.face[net.node_status <= 1])) > 200  # most edges leave their triangle
        whole = np.stack(net.directions(0, net.shape[0]))
        for i in range(net.shape[0]):
            alone = np.stack(net.directions(i, i + 1))
            assert np.array_equal(alone, whole[:, i : i + 1], equal_nan=True)


def test_directions_are_the_means_of_both_edges():
    """Chords of a smooth curve are nearly parallel to its tangent: a lost or reversed edge would be seen at once."""
    mould = cap(4).mould()
    net = meshdrape.drape(mould, meshdrape.Fabric(20.0), seed=(0, 0, 1000), direction=(1, 0.2, 0))
    for axis, direction in ((0, net.warp_direction), (1, net.weft_direction)):
        position = np.moveaxis(net.node_position, axis, 0)
        chord = position[2:] - position[:-2]
        chord /= np.linalg.norm(chord, axis=-1)[..., None]
        cosine = np.einsum("ijk,ijk->ij", chord, np.moveaxis(direction, axis, 0)[1:-1])
        assert np.nanmin(cosine) > np.cos(np.radians(10.0))  # facets meet at up to four
        assert np.isfinite(cosine).sum() > 1000
