"""The whole sphere under any fabric: unequal spacings, initial angles off 90 degrees, both sides, any start.

Against the exact discrete net on the sphere. Position and shear as a mesh of chord tolerance h can be held to them:
3 h + 3 (h / R)^0.75 L, and 10 (h / R)^0.75 rad at most, 2 (h / R)^0.75 rad in the mean square.
"""

import numpy as np
import pytest
from moulds import icosphere, rotation
from references import sphere_cell_shear, sphere_net_of

import meshdrape
from meshdrape import NodeStatus

RADIUS = 1000.0
REACH = 0.8 * RADIUS


@pytest.mark.parametrize("number", range(6))
def test_net_is_that_on_the_sphere(number):
    rng = np.random.default_rng(number)
    mesh = icosphere(4 + number % 2, RADIUS).moved(rotation(rng.normal(size=3), float(rng.uniform(0, 6))))
    inside = number % 3 == 2
    mould = (mesh.reversed() if inside else mesh).mould()
    rise = RADIUS - float(np.linalg.norm(mesh.vertices[mesh.triangles].mean(axis=1), axis=1).min())
    spacing = tuple(RADIUS * rng.uniform(0.04, 0.12, 2))
    initial = float(rng.uniform(np.radians(50), np.radians(130)))
    up = rng.normal(size=3)
    up /= np.linalg.norm(up)
    warp = np.cross(up, rng.normal(size=3))
    warp /= np.linalg.norm(warp)
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing, initial), RADIUS * up, warp)
    # seen from within, counter-clockwise about the normal is the other way round
    axes = np.stack([warp, np.cross(-up if inside else up, warp), up])
    node = sphere_net_of(RADIUS, spacing, initial, REACH)
    exact = sphere_cell_shear(node, initial)
    near = {at for at in node if np.hypot(at[0] * spacing[0], at[1] * spacing[1]) < REACH}
    i0, j0 = net.seed_index
    off = [np.linalg.norm(net.node_position[i + i0, j + j0] - node[i, j] @ axes) for i, j in near]
    assert all(net.node_status[i + i0, j + j0] == NodeStatus.PLACED for i, j in near)
    bound = (rise / RADIUS) ** 0.75
    assert max(off) < 3 * rise + 3 * bound * REACH
    shear = meshdrape.measure(net).cell_shear
    cells = [(i, j) for i, j in exact if {(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)} <= near]
    error = np.array([shear[i + i0, j + j0] - exact[i, j] for i, j in cells])
    assert len(cells) > 50
    assert np.abs(error).max() < 10 * bound
    assert np.sqrt(np.mean(error**2)) < 2 * bound
