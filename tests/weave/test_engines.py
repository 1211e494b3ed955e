"""The fast kernels against nets placed node by node from libigl's exact distances alone."""

from dataclasses import replace

import numpy as np
import pytest
from cases import CASES

import meshdrape

# name: how much of it, mm of cloth each way; a reference node costs milliseconds
PIECES = {
    "hills": 30.0,
    "hills, cloth of 60 degrees": 33.0,
    "steep hills": 25.0,
    "wing and spar": 250.0,
    "cap, cells above triangles": 350.0,
    "cap, cells far above triangles": 500.0,
    "hypar": 250.0,
    "cube's corner, from beside it": 110.0,
    "cube's corner, from the vertex": 95.0,
    "foot of a step, from the floor": 150.0,
    "plate with a hole": 40.0,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", PIECES)
def test_fast_engine_equals_the_reference(name):
    """To 1e-9 of the spacing, node by node, with the same statuses."""
    case = replace(CASES[name], extent=(PIECES[name],) * 4)
    fast, reference = case.drape(), case.drape(engine="libigl")
    assert np.array_equal(fast.node_status, reference.node_status)
    assert (fast.node_status <= 1).sum() > 20
    off = np.linalg.norm(fast.node_position - reference.node_position, axis=-1)
    assert np.nanmax(off) < 1e-9 * fast.fabric.warp_spacing
    shear = [meshdrape.measure(net).cell_shear for net in (fast, reference)]
    # libigl's edges have their directions from differences of distances
    assert shear[0] == pytest.approx(shear[1], abs=1e-5, nan_ok=True)


def test_unknown_engine():
    with pytest.raises(meshdrape.MeshdrapeError, match="engine") as caught:
        CASES["plate"].drape(engine="quick")
    assert "\n" not in str(caught.value)
