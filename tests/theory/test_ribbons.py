"""Locking angle from the ribbons of figure 2 of the study group report."""

import numpy as np
import pytest

from meshdrape.errors import FabricError
from meshdrape.theory import gap, locking_angle, locking_range, width_for


def test_ribbons_touch_at_locking():
    for width in np.linspace(0.1, 1, 10):
        lock = locking_angle(width, 1.0)
        assert gap(width, 1.0, lock) == pytest.approx(0, abs=1e-15)
        assert gap(width, 1.0, 0.9 * lock) >= 0
        assert width_for(lock, 1.0) == pytest.approx(width, rel=1e-14)


def test_distance_of_sheared_ribbons_as_drawn():
    """Two parallel ribbons of a sheared lattice, pitch one along the crossing family: their distance by coordinates."""
    for shear in (0.0, 0.1, 0.7):
        along, across = np.array([1.0, 0.0]), np.array([np.sin(shear), np.cos(shear)])
        distance = abs(along[0] * across[1] - along[1] * across[0])
        assert gap(0.6, 1.0, shear) == pytest.approx(distance - 0.6, abs=1e-15)


def test_fabric_of_the_report():
    """It locks at about 7 degrees: its gaps are three quarters of a percent of the pitch."""
    assert 1 - width_for(np.radians(7), 1.0) == pytest.approx(0.00745, abs=1e-5)


def test_family_that_touches_first_decides():
    assert locking_angle(0.5, 1.0, 1.9, 2.0) == locking_angle(0.95, 1.0)
    assert locking_angle(0.95, 1.0, 0.5, 2.0) == locking_angle(0.95, 1.0)


def test_woven_at_another_angle():
    closing, opening = locking_range(0.5, 1.0, np.radians(60))
    assert np.degrees([closing, opening]) == pytest.approx([30, 90])
    assert locking_range(0.5, 1.0, np.pi / 2) == pytest.approx((np.pi / 3, np.pi / 3))


def test_refused():
    with pytest.raises(FabricError, match=r"width 2 at pitch 1"):
        locking_angle(2, 1)
    with pytest.raises(FabricError, match="overlap at this angle"):
        locking_range(0.9, 1.0, 0.5)
    with pytest.raises(FabricError, match="locking angle 2"):
        width_for(2, 1)
