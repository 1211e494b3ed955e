"""The nearest spar that can be made: known projections, and designs too steep brought back and draped."""

import math

import numpy as np
import pytest
from fold_designs import design, draped, in_degrees

from meshdrape.errors import DesignError
from meshdrape.study.fold.frame import frame_of
from meshdrape.study.fold.least import least_distance
from meshdrape.study.fold.nearest import nearest_spar
from meshdrape.theory import within_reach

LOCKING = math.radians(7.0)


def test_least_distance_to_half_spaces():
    """The foot of the perpendicular on a plane, in the metric of |root x|; and a corner of two planes."""
    root = np.array([[2.0, 1.0], [0.0, 3.0]])
    normal = np.array([1.0, -2.0])
    metric = np.linalg.inv(root.T @ root)
    foot = metric @ normal / (normal @ metric @ normal) * 5.0
    assert least_distance(root, normal[None], np.array([5.0])) == pytest.approx(foot)
    assert least_distance(root, np.eye(2), np.array([3.0, 4.0])) == pytest.approx([3.0, 4.0])
    assert least_distance(root, normal[None], np.array([-1.0])) == pytest.approx([0.0, 0.0])


def test_least_distance_meets_the_conditions_of_a_minimum():
    """Random problems: feasible, and the gradient is a positive combination of the rows that hold exactly."""
    from scipy.optimize import nnls

    random = np.random.default_rng(4)
    for _ in range(5):
        root, row = np.triu(random.normal(size=(6, 6))) + 4 * np.eye(6), random.normal(size=(20, 6))
        least = row @ random.normal(size=6) - random.uniform(0, 1, 20)
        x = least_distance(root, row, least)
        room = row @ x - least
        assert room.min() > -1e-9
        active = room < 1e-8
        gradient = root.T @ (root @ x)
        assert nnls(row[active].T, gradient)[1] < 1e-8 * np.linalg.norm(gradient)


def test_least_distance_without_a_solution():
    with pytest.raises(DesignError, match="no spar"):
        least_distance(np.eye(2), np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([1.0, 1.0]))


@pytest.mark.parametrize("measure", ["slope", "position"])
def test_design_half_over_the_limit(measure):
    """f' = c sin² 50 % past its limit: the f* found is proved by its own drape on the CAD mould."""
    of = design(spar={"deviation": "sin2_slope", "c": 0.1857})
    drape = draped(of)
    assert max(in_degrees(drape)) > 1.45 * 7
    found = nearest_spar(of, drape, measure)
    assert found.proven
    assert not found.unchanged
    assert 6.95 < np.degrees(found.shear.largest) <= 7.0
    again = design(
        spar={"deviation": "table", "y": (found.y / 1000).tolist(), "f": (found.nearest / 1000).tolist()},
        start={"gamma_deg": "best"},
    )
    on_cad = draped(again, cad=True)
    assert max(in_degrees(on_cad)) == pytest.approx(np.degrees(found.shear.largest), abs=0.005)
    assert np.degrees(on_cad.gamma) == pytest.approx(np.degrees(found.gamma), abs=1e-3)
    # smooth: no turn of the spar that the wanted one did not have by far
    bend = np.abs(again.deviation_profile.bend(np.linspace(0, 14000, 4001))).max()
    assert bend < 4 * of.deviation_profile.largest_bend
    assert found.largest_loss == np.abs(found.loss).max() == abs(found.loss[found.y == found.largest_loss_at][0])


def test_each_measure_is_nearest_in_its_own():
    of = design(spar={"deviation": "parabola", "c": 0.6}, spacing=0.05)
    drape = draped(of)
    found = {measure: nearest_spar(of, drape, measure) for measure in ("slope", "position")}
    slope = {name: np.sum(np.gradient(one.loss, one.y) ** 2) for name, one in found.items()}
    assert slope["slope"] < slope["position"]
    assert found["position"].rms_loss < found["slope"].rms_loss
    # and nearer than the design scaled down until it fits
    scaled = design(spar={"deviation": "parabola", "c": 0.42}, spacing=0.05)
    assert max(in_degrees(draped(scaled))) > 6.85
    shrunk = (of.deviation_profile - scaled.deviation_profile)(found["position"].y)
    assert found["position"].rms_loss < 0.5 * np.sqrt(np.mean((shrunk - shrunk.mean()) ** 2))


def test_design_that_fits_is_left_alone():
    """As it is, or but for a turn of the left-most ribbon."""
    of = design(spacing=0.05)
    found = nearest_spar(of, draped(of))
    assert found.unchanged
    assert np.array_equal(found.wanted, found.nearest)
    assert (found.gamma, found.drapes) == (0.0, 1)
    tilted = design(spar={"deviation": "linear", "c": 0.3}, spacing=0.05)
    found = nearest_spar(tilted, draped(tilted))
    assert found.unchanged
    assert found.proven
    assert found.gamma == pytest.approx(frame_of(tilted).gamma_best())
    assert found.largest_loss == 0


def test_smooth_limit_of_the_nearest_spar_sits_at_the_angle():
    """Least squares leaves no room: the pair that binds is at the angle, but for what the spacing hides."""
    of = design(spar={"deviation": "sin2_slope", "c": 0.2}, spacing=0.04)
    found = nearest_spar(of, draped(of))
    again = design(spar={"deviation": "table", "y": (found.y / 1000).tolist(), "f": (found.nearest / 1000).tolist()})
    reach = within_reach(again.fold, 1000.0)
    assert np.degrees(reach.wing_fed.shear) == pytest.approx(7.0, abs=0.1)
    assert reach.ribbon_fed_best <= LOCKING


def test_design_many_times_over_the_limit_still_gets_an_answer():
    """Slopes of three: psi is nowhere near linear in f; f shrunk until it fits is found, and proved."""
    of = design(spar={"deviation": "ripple", "c": 0.5, "wavelength": 1.0}, span=4.0, spacing=0.05, spar_height=0.5)
    found = nearest_spar(of, draped(of))
    assert found.proven
    assert not found.unchanged
    assert found.shear.largest <= LOCKING
    assert np.abs(found.nearest).max() < np.abs(found.wanted).max() / 5


def test_unknown_measure():
    of = design(spacing=0.1)
    with pytest.raises(DesignError, match="no measure is called 'angle': slope, position"):
        nearest_spar(of, draped(of), "angle")
