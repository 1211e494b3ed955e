"""A collar is built once for the drapes of one spacing, and not kept for ever."""

import numpy as np
import pytest
from moulds import cap

import meshdrape
from meshdrape.weave.lay import sheet as lay

SEED, DIRECTION = (0.0, 0.0, 1000.0), (1.0, 0.3, 0.0)


@pytest.fixture
def built(monkeypatch):
    """Depths of the collars that were built."""
    depths = []
    real = lay.extended

    def extended(surface, depth, slit):
        depths.append(depth)
        return real(surface, depth, slit)

    monkeypatch.setattr(lay, "extended", extended)
    return depths


def laid(mould, spacing):
    return meshdrape.drape(mould, meshdrape.Fabric(spacing), SEED, DIRECTION)


def test_a_scouted_net_laid_again_builds_none(built, monkeypatch):
    """It has a collar of its own and one of the coarse net that goes before it."""
    monkeypatch.setattr(lay, "SCOUT_FROM", 500)
    monkeypatch.setattr(lay, "SCOUT_NODES", 60)
    mould = cap().mould()
    first = laid(mould, 50.0)
    assert len(built) == 2
    assert built[0] == 4 * 50.0 < built[1]
    again = laid(mould, 50.0)
    assert len(built) == 2
    np.testing.assert_array_equal(first.node_position, again.node_position)
    fresh = laid(cap().mould(), 50.0)
    np.testing.assert_array_equal(first.node_position, fresh.node_position)


def test_the_two_last_used_are_kept(built):
    mould = cap().mould()
    for spacing, anew in ((50, 1), (60, 1), (50, 0), (70, 1), (50, 0), (70, 0), (60, 1), (70, 0), (50, 1)):
        before = len(built)
        laid(mould, spacing)
        assert len(built) - before == anew, spacing
