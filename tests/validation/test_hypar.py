"""The hyperbolic paraboloid z = k x y covered from its two straight lines.

Source: Barton et al., New Techniques for Composite Wing Manufacture, section 7: the continuum model's equation (33)
with the two rulings through the origin as data, solved without a mesh to the digits shown. On a saddle cells open.
"""

import numpy as np
import pytest
from lattice import cells_at, nodes_at, shear_deg
from moulds import hypar
from references import hypar_net

import meshdrape

SHEAR_AT_CORNER = {0.5: -10.91200, 1.0: -26.66743}
NODE_AT_CORNER = (0.7626122, 0.7626122, 0.5815774)  # k = 1


@pytest.mark.parametrize("k", SHEAR_AT_CORNER)
def test_equations_reproduce_the_published_corner(k):
    node, angle = hypar_net(k, 1.0, 40)
    assert 90 - np.degrees(angle[-1, -1]) == pytest.approx(SHEAR_AT_CORNER[k], abs=1e-5)
    if k == 1.0:
        assert node[-1, -1] == pytest.approx(NODE_AT_CORNER, abs=1e-7)


@pytest.mark.parametrize("n", [201, 200], ids=["fibres_across_triangles", "fibres_along_edges_through_vertices"])
@pytest.mark.parametrize("k", SHEAR_AT_CORNER)
def test_draped_hypar(k, n):
    """All four quadrants: nodes to 3 h + 3 (h / R)^0.75 L, shear to max 10 and rms 2 (h / R)^0.75 rad."""
    side, spacing = 2.6 / n, 0.05
    h, smallest_radius = k * side**2 / 4, 1 / k
    noise = (h / smallest_radius) ** 0.75
    net = meshdrape.drape(hypar(k, n=n).mould(), meshdrape.Fabric(1000 * spacing), (0, 0, 0), (1, 0, 0))
    node, angle = hypar_net(k, 1.0, 40)
    node = node[::2, ::2]  # every 0.05
    centre = angle[1::2, 1::2]
    i, j = np.meshgrid(np.arange(21), np.arange(21), indexing="ij")
    cells = np.radians(shear_deg(net))
    for si, sj in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        off = np.linalg.norm(nodes_at(net, si * i, sj * j) / 1000 * [si, sj, si * sj] - node, axis=-1)
        # the net's own distance from the smooth one, second order in the spacing: 1.1e-4 at 0.05 on the sphere
        assert off.max() < 3 * h + 3 * noise * np.sqrt(2) + 1.1e-4
        ci, cj = i[:-1, :-1], j[:-1, :-1]
        found = cells_at(net, cells, ci if si > 0 else -1 - ci, cj if sj > 0 else -1 - cj)
        wrong = found - si * sj * (np.pi / 2 - centre)
        assert np.abs(wrong).max() < 10 * noise + np.radians(0.0141)
        assert np.sqrt(np.mean(wrong**2)) < 2 * noise + np.radians(0.0141)
        assert np.degrees(found[-1, -1]) * si * sj < 0
