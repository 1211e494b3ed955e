"""Section 7.3 of the study group report: pyramids and the corner of a cube."""

import numpy as np
import pytest
from references import cube_corner_net

from meshdrape.errors import DesignError
from meshdrape.theory import apex_net, apex_shear, pyramid_angle, pyramid_edges

CUBE = np.eye(3)  # its edges from the corner, counter-clockwise seen from outside


def test_cube_corner():
    """Half-fibres 3π/8 apart, every cell 67.5 / 112.5 degrees: π/8 per quadrant, exact for any spacing."""
    assert np.degrees(apex_shear(3 * np.pi / 2)) == pytest.approx(22.5, abs=1e-13)
    slant = float(np.arccos(1 / np.sqrt(3)))
    assert pyramid_angle(3, slant) == pytest.approx(3 * np.pi / 2, rel=1e-14)
    for first in (0.0, 0.3, 2.0):
        net = apex_net(CUBE, 0.1, 8, first)
        for quadrant in range(4):
            assert net[quadrant] == pytest.approx(cube_corner_net(0.1, 8, first, quadrant), abs=1e-12)


@pytest.mark.parametrize(("sides", "slant"), [(3, 0.6), (4, 1.2), (5, 0.9), (7, 1.5)])
def test_pyramid(sides, slant):
    edges = pyramid_edges(sides, slant)
    between = np.arccos(np.sum(edges * np.roll(edges, -1, axis=0), axis=1))
    assert between.sum() == pytest.approx(pyramid_angle(sides, slant), rel=1e-13)
    net = apex_net(edges, 0.07, 12, first=0.2)
    # neighbouring quadrants share a half-fibre, of links one spacing long and straight within a face
    for quadrant in range(4):
        assert net[quadrant][0] == pytest.approx(net[(quadrant + 1) % 4][:, 0], abs=1e-12)
    assert np.linalg.norm(net[:, 1:, 0], axis=-1) == pytest.approx(
        np.broadcast_to(0.07 * np.arange(1, 13), (4, 12)), abs=1e-12
    )
    # in space no link is longer than a spacing, nor any cell's side where it lies in one face
    for axis in (1, 2):
        length = np.linalg.norm(np.diff(net, axis=axis), axis=-1)
        assert length.max() <= 0.07 * (1 + 1e-12)
        assert np.isclose(length, 0.07, rtol=1e-12).mean() > 0.5
    # cells wholly in one face shear by the quarter of the angle defect
    a, b, d = net[:, 1:, :-1], net[:, :-1, 1:], net[:, :-1, :-1]
    cosine = np.sum((a - d) * (b - d), axis=-1) / 0.07**2
    plane = np.all([np.isclose(np.linalg.norm(k - d, axis=-1), 0.07, rtol=1e-12) for k in (a, b)], axis=0)
    across = np.linalg.norm(net[:, 1:, 1:] - d, axis=-1)
    one_face = plane & np.isclose(across, 0.07 * np.sqrt(2 + 2 * cosine), rtol=1e-12)
    shear = np.arcsin(cosine[one_face])
    assert one_face.sum() > 100
    found, count = np.unique(np.round(shear, 9), return_counts=True)
    assert found[count.argmax()] == pytest.approx(apex_shear(pyramid_angle(sides, slant)), abs=1e-9)


def test_flat_and_saddle():
    assert apex_shear(2 * np.pi) == 0
    assert apex_shear(2.5 * np.pi) < 0
    flat = apex_net(pyramid_edges(4, np.pi / 2), 1.0, 3)
    assert flat[0][2, 1] == pytest.approx([2, 1, 0], abs=1e-12)


def test_refused():
    with pytest.raises(DesignError, match="total_angle=13"):
        apex_shear(13.0)
    with pytest.raises(DesignError, match="sides=2"):
        pyramid_angle(2, 1.0)
