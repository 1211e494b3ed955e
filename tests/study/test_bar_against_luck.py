"""Error bars of random starts on the hemisphere: two maxima that agree by chance are not taken for convergence.

The tolerances are coarse, so that facets err visibly; the exact discrete net on the sphere is known to round-off.
"""

from pathlib import Path

import numpy as np
import pytest
from references import sphere_cell_shear, sphere_net_of

import meshdrape

HEMISPHERE = Path(__file__).parents[2] / "samples" / "hemisphere.step"
RADIUS = 500.0


# of 200 starts six had a bar that missed while maxima alone were compared; these are two of them
@pytest.mark.parametrize("number", [9, 191])
def test_bar_contains_the_exact_maximum(number):
    rng = np.random.default_rng(number)
    spacing = tuple(RADIUS * rng.uniform(0.04, 0.12, 2))
    initial = np.radians(rng.uniform(60, 120))
    up = np.array([0, 0, 1.0]) + rng.normal(0, 0.1, 3)
    up /= np.linalg.norm(up)
    warp = np.cross(up, rng.normal(size=3))
    warp /= np.linalg.norm(warp)
    # all on the sphere: the cloth ends well within the border
    extent = tuple(RADIUS * rng.uniform(0.3, 0.65, 4))
    mould = meshdrape.read_mould(HEMISPHERE, chord_tolerance=0.3, angle_tolerance=np.radians(2))
    fabric = meshdrape.Fabric(spacing, initial)
    net = meshdrape.drape(mould, fabric, RADIUS * up, warp, extent=extent)
    found = meshdrape.refine(mould, fabric, extent=extent, net=net)
    measures = meshdrape.measure(net)
    assert (net.node_status == meshdrape.NodeStatus.PLACED).all()
    exact = sphere_cell_shear(sphere_net_of(RADIUS, spacing, initial, 0.65 * RADIUS), initial)
    i0, j0 = net.seed_index
    truth = max(abs(exact[i - i0, j - j0]) for i, j in np.argwhere(measures.cell_touches_mould))
    assert found.max_shear[-1] == measures.max_shear
    assert abs(measures.max_shear - truth) <= found.error_bar
    assert found.error_bar < np.radians(1)
