"""The corner of a cube, the origin of the net on the vertex: four half-fibres 3 pi / 8 apart.

Source: Barton et al., New Techniques for Composite Wing Manufacture, section 7.3: pi / 8 of shear in each quadrant.
It is exact for a finite spacing too, since each quadrant unfolds into a plane lattice of 67.5 and 112.5 degrees.
"""

import numpy as np
import pytest
from lattice import nodes_at, shear_deg
from moulds import cube_corner, rotation
from references import cube_corner_net

import meshdrape

DIRECTIONS = [0.0, 1e-9, 10.0, 45.0, 67.5, 89.9, 90.0, 100.0, 180.0, 231.7]


def direction_at(degrees):
    """Unit vector in the cube's faces at an angle from the x axis, counted over the unfolded faces."""
    face = int(degrees // 90)
    within = np.radians(degrees - 90 * face)
    axis = np.eye(3)
    return np.cos(within) * axis[face % 3] + np.sin(within) * axis[(face + 1) % 3]


@pytest.mark.parametrize("degrees", DIRECTIONS)
def test_every_cell_is_sheared_by_a_quarter_right_angle(degrees):
    """22.5 degrees to 1e-6, nodes to 1e-9 of the extent, whatever direction the warp takes."""
    net = meshdrape.drape(cube_corner().mould(), meshdrape.Fabric(100.0), (0, 0, 0), direction_at(degrees))
    shear = shear_deg(net)
    cells = shear[np.isfinite(shear)]
    assert len(cells) > 300
    assert np.abs(np.abs(cells) - 22.5).max() < 1e-6
    for quadrant, (si, sj) in enumerate([(1, 1), (-1, 1), (-1, -1), (1, -1)]):
        node = cube_corner_net(100.0, 7, np.radians(degrees), quadrant)
        i, j = np.meshgrid(np.arange(8), np.arange(8), indexing="ij")
        # half-fibres follow as +warp, +weft, -warp, -weft: the second and fourth quadrants start with a weft one
        found = nodes_at(net, si * i, sj * j) if quadrant % 2 == 0 else nodes_at(net, si * j, sj * i)
        inside = node.max(axis=-1) < 999
        assert np.linalg.norm(found - node, axis=-1)[inside].max() < 1e-6


def test_shear_is_positive_where_warp_and_weft_close():
    """About a corner the first and third quadrants close to 67.5 degrees; in the others +warp and +weft open."""
    net = meshdrape.drape(cube_corner().mould(), meshdrape.Fabric(100.0), (0, 0, 0), (1, 0.3, 0))
    i0, j0 = net.seed_index
    shear = shear_deg(net)
    assert shear[i0, j0] == pytest.approx(22.5)
    assert shear[i0 - 1, j0 - 1] == pytest.approx(22.5)
    assert shear[i0 - 1, j0] == pytest.approx(-22.5)
    assert shear[i0, j0 - 1] == pytest.approx(-22.5)


@pytest.mark.parametrize("spacing", [9.0, 37.0, 333.0])
@pytest.mark.parametrize("n", [1, 2, 9])
def test_whatever_the_mesh_and_the_spacing(spacing, n):
    turn = rotation([1, 2, -1], 1.1)
    mesh = cube_corner(n=n).moved(turn, shift=(50, -20, 10))
    net = meshdrape.drape(
        mesh.mould(),
        meshdrape.Fabric(spacing),
        (50, -20, 10),
        turn @ direction_at(33.0),
        extent=(900, 900, 900, 900),
    )
    shear = shear_deg(net)
    assert np.abs(np.abs(shear[np.isfinite(shear)]) - 22.5).max() < 1e-6
