"""Corners of a cell with a vertex in it, against cells built on a cone and against small defects."""

import numpy as np
import pytest

from meshdrape.weave.measures.excess import Sides, corner_excess, laid_flat

EQUAL = Sides(1.0, 1.0, 1.0, 1.0)


@pytest.mark.parametrize("degrees", [40.0, 90.0, 125.0])
def test_small_defects_count_by_the_part_of_the_cell_beyond_them(degrees):
    """A vertex at (s, t) of the unit cell makes the corners d (1 - t) and d (1 - s) larger."""
    angle = np.radians(degrees)
    s, t = np.random.default_rng(0).uniform(0, 1, (2, 200))
    defect = 1e-7
    row, column = corner_excess(EQUAL, angle, defect, s + t * np.exp(1j * angle))
    assert row / defect == pytest.approx(1 - t, abs=1e-6)
    assert column / defect == pytest.approx(1 - s, abs=1e-6)


def test_a_rhombus_has_none_nor_a_rectangle_s_kind():
    angle = np.radians(np.linspace(30, 150, 13))
    for sides in (EQUAL, Sides(3.0, 2.0, 3.0, 2.0)):
        for excess in corner_excess(sides, angle):
            assert np.abs(excess).max() < 1e-14


def test_a_short_side_turns_the_others():
    """A flat quadrilateral by its corners: the angles its sides make in the plane."""
    angle = np.radians(80.0)
    row, column = corner_excess(Sides(0.9, 1.0, 1.0, 1.1), angle)
    b, d = 0.9 + 0j, np.exp(1j * angle)
    # the corner opposite, by bisection along the circle about b
    low, high = np.radians(20), np.radians(140)
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if abs(b + 1.1 * np.exp(1j * middle) - d) > 1 else (low, middle)
    c = b + 1.1 * np.exp(1j * low)
    assert row == pytest.approx(np.angle((0 - b) / (c - b)) % (2 * np.pi) - (np.pi - angle), abs=1e-12)
    assert column == pytest.approx(np.angle((c - d) / (0 - d)) % (2 * np.pi) - (np.pi - angle), abs=1e-12)


@pytest.mark.parametrize("defect", [np.radians(120), np.radians(20), np.radians(-60)])
@pytest.mark.parametrize("number", range(4))
def test_cells_about_the_apex_of_a_cone(defect, number):
    """Four triangles about an apex: their angles there are 2 pi less its defect, their sides those of the cell.

    Three corners by their distances from the apex; the fourth's by bisection, so that the angles add up.
    """
    rng = np.random.default_rng(number)
    # a flat cell with the apex inside, then the fourth corner moved till the cone closes
    angle = rng.uniform(1.3, 1.8)
    s, t = rng.uniform(0.3, 0.7, 2)
    apex = s + t * np.exp(1j * angle)
    to_first, to_warp, to_weft = abs(apex), abs(apex - 1), abs(apex - np.exp(1j * angle))

    def at_apex(a, b):
        return np.arccos(np.clip((a * a + b * b - 1) / (2 * a * b), -1, 1))

    def off(to_last):
        around = [(to_first, to_warp), (to_warp, to_last), (to_last, to_weft), (to_weft, to_first)]
        return sum(at_apex(a, b) for a, b in around) - (2 * np.pi - defect)

    lengths = np.linspace(max(abs(1 - to_warp), abs(1 - to_weft)) + 1e-9, 1 + min(to_warp, to_weft) - 1e-9, 20001)
    value = np.array([off(length) for length in lengths])
    # beyond its largest angle the corner turns inwards: the outer of the roots is the cell
    k = int(np.flatnonzero(value[:-1] * value[1:] <= 0)[-1])
    low, high = lengths[k], lengths[k + 1]
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if off(middle) * value[k] > 0 else (low, middle)

    def corner(here):
        """Angle at a corner from its two triangles, whose far sides reach the first corner and the last."""
        return sum(np.arccos((here**2 + 1 - far**2) / (2 * here)) for far in (to_first, low))

    beside_warp, beside_weft = corner(to_warp), corner(to_weft)
    where, at_first = laid_flat(EQUAL, *(np.array([value]) for value in (to_first, to_warp, to_weft)))
    assert at_first == pytest.approx(angle, abs=1e-12)
    assert where == pytest.approx(apex, abs=1e-12)
    row, column = corner_excess(EQUAL, at_first, defect, where)
    assert row == pytest.approx(beside_warp - (np.pi - angle), abs=1e-9)
    assert column == pytest.approx(beside_weft - (np.pi - angle), abs=1e-9)


def test_a_vertex_at_the_first_corner_is_all_before_the_others():
    where, angle = laid_flat(EQUAL, np.array([0.0]), np.array([1.0]), np.array([1.0]))
    row, column = corner_excess(EQUAL, angle, 1e-3, where)
    assert row == pytest.approx(1e-3)
    assert column == pytest.approx(1e-3)
