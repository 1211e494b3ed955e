"""Profiles and deviations: derivatives, arc length and its inverse, the spline of a table, what is refused."""

import numpy as np
import pytest
from rates import orders
from scipy.integrate import quad

from meshdrape.errors import DesignError
from meshdrape.theory import Fold, profiles

SPAN = 14.0
Y_TABLE = np.linspace(0, SPAN, 29)
EACH = {
    "flat": profiles.flat(SPAN),
    "quadratic": profiles.quadratic(0.01, SPAN),
    "real": profiles.real_wing(SPAN),
    "arc": profiles.arc(65.0, SPAN),
    "table": profiles.table(Y_TABLE, 0.01 * Y_TABLE**2 + 0.02 * np.sin(Y_TABLE)),
    "linear": profiles.linear_deviation(0.1, SPAN),
    "parabola": profiles.parabola_deviation(0.1, SPAN),
    "sine": profiles.sine_deviation(0.05, 3.5, SPAN),
    "sin2_slope": profiles.sin2_slope_deviation(0.1, SPAN),
    "bump": profiles.bump_deviation(0.05, 1.5, SPAN),
    "ripple": profiles.ripple_deviation(0.02, 2.0, SPAN),
    "sum": profiles.real_wing(SPAN) - 2 * profiles.bump_deviation(0.05, 1.5, SPAN),
    "reversed": (profiles.real_wing(SPAN) + profiles.table(Y_TABLE, np.sin(Y_TABLE / 9))).reversed(),
}


@pytest.mark.parametrize("name", EACH)
def test_derivatives(name):
    """Central differences of order h², the span's ends left out, and a spline's knots."""
    g, h = EACH[name], 1e-5
    y = np.linspace(0.013, SPAN - 0.013, 96)
    # the derivative next in order times h²/6, and round-off over h
    assert (g(y + h) - g(y - h)) / (2 * h) == pytest.approx(g.slope(y), abs=1e-9)
    assert (g.slope(y + h) - g.slope(y - h)) / (2 * h) == pytest.approx(g.bend(y), abs=2e-9)


@pytest.mark.parametrize("name", EACH)
def test_goes_on_straight_beyond_its_ends(name):
    g = EACH[name]
    for end, out in ((0.0, -1.7), (SPAN, SPAN + 2.3)):
        assert g(out) == pytest.approx(g(end) + g.slope(end) * (out - end), rel=1e-14, abs=1e-14)
        assert g.bend(out) == 0


@pytest.mark.parametrize("name", EACH)
def test_arc_length(name):
    g = EACH[name]
    assert g.arc_length(0.0) == 0
    y = np.linspace(-1, SPAN + 1, 301)
    s = g.arc_length(y)
    assert np.abs(g.at_arc_length(s) - y).max() < 1e-12 * SPAN
    assert np.abs(g.near_arc_length(s) - y).max() < 1e-10 * SPAN
    knots = [b for b in g.breaks if b < 5]
    found, _ = quad(lambda t: float(g.stretch(t)), 0, 5, points=knots or None, epsabs=1e-13, epsrel=1e-13)
    assert g.arc_length(5.0) == pytest.approx(found, rel=1e-12)


def test_arc_length_of_a_circle_and_a_parabola():
    radius, a = 65.0, 0.3
    assert EACH["arc"].length == pytest.approx(radius * np.arcsin(SPAN / radius), rel=1e-14)
    t = 2 * a * 2.0
    closed = (t * np.sqrt(1 + t * t) + np.arcsinh(t)) / (4 * a)
    assert profiles.quadratic(a, 2.0).length == pytest.approx(closed, rel=1e-14)


def test_real_wing():
    """Study group report, section 2: 15 degrees at the root, 7 at 4 m, 3 at the tip; lengths in metres."""
    wing = profiles.real_wing()
    assert np.degrees(np.arctan(wing.slope([0, 4, 14]))) == pytest.approx([15, 7, 3], abs=1e-6)
    assert wing(0) == 0
    assert wing.length == pytest.approx(14.098238, abs=1e-6)
    in_mm = profiles.real_wing(14000.0, metre=1000.0)
    y = np.linspace(0, 14, 9)
    assert in_mm(1000 * y) == pytest.approx(1000 * wing(y), rel=1e-12)
    assert in_mm.slope(1000 * y) == pytest.approx(wing.slope(y), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "parameters", "y", "f"),
    [
        ("none", {}, 3.0, 0.0),
        ("linear", {"c": 0.1}, 3.0, 0.3),
        ("parabola", {"c": 0.1}, 14.0, 0.7),
        ("sine", {"c": 0.05, "wavelength": 3.5}, 0.875, 0.05),
        ("sin2_slope", {"c": 0.1}, 14.0, 0.7),
        ("bump", {"c": 0.05, "length": 1.5}, 1.5, 0.05),
        ("ripple", {"c": 0.02, "wavelength": 2.0}, 1.0, 0.04),
        ("table", {"y": Y_TABLE, "f": 0.1 * Y_TABLE}, 3.3, 0.33),
    ],
)
def test_deviations_by_name(name, parameters, y, f):
    deviation = profiles.named_deviation(name, SPAN, **parameters)
    assert deviation(y) == pytest.approx(f, abs=1e-14)
    assert deviation(0.0) == pytest.approx(0, abs=1e-16)
    if name == "sin2_slope":
        assert deviation.slope(3.0) == pytest.approx(0.1 * np.sin(np.pi * 3 / 14) ** 2, rel=1e-14)


def test_spline_through_a_table_converges_with_the_fourth_power():
    error = []
    for n in (20, 40, 80):
        y = np.linspace(0, 3, n + 1)
        spline = profiles.table(y, np.sin(2 * y))
        fine = np.linspace(0, 3, 1999)
        error.append(np.abs(spline(fine) - np.sin(2 * fine)).max())
    assert (orders(error) > 3.6).all(), error


def test_reversed_profile():
    wing = EACH["real"]
    y = np.linspace(0, SPAN, 11)
    assert wing.reversed()(y) == pytest.approx(wing(SPAN - y) - wing(SPAN), abs=1e-14)
    assert wing.reversed().reversed()(y) == pytest.approx(wing(y), abs=1e-14)
    assert wing.reversed().length == pytest.approx(wing.length, rel=1e-14)


@pytest.mark.parametrize(
    ("make", "culprit"),
    [
        (lambda: profiles.flat(0.0), "span=0.0"),
        (lambda: profiles.arc(10.0, SPAN), "radius=10.0"),
        (lambda: profiles.table([0, 1, 1, 2], [0, 1, 2, 3]), r"y\[2\] = 1.0 comes after y\[1\] = 1.0"),
        (lambda: profiles.table([0, 1, 2], [0, 1, 2]), "at least 4"),
        (lambda: profiles.table([0, 1, 2, 3], [0, 1, np.nan, 3]), r"g\[2\] = nan"),
        (lambda: profiles.table([0, 1, 2, 3], [0, 1, 2, 3], span=4.0), "does not cover 0 to 4.0"),
        (lambda: profiles.sine_deviation(0.1, -1.0, SPAN), "wavelength=-1.0"),
        (lambda: profiles.bump_deviation(0.1, 0.0, SPAN), "length=0.0"),
        (lambda: profiles.linear_deviation(np.inf, SPAN), "c=inf"),
        (lambda: profiles.flat(1.0) + profiles.flat(2.0), "span 1.0 and 2.0"),
        (lambda: profiles.named_profile("wavy", SPAN), "'wavy' is not known: real, flat, quadratic, arc, table"),
        (lambda: profiles.named_deviation("sine", SPAN, c=0.1), "needs wavelength"),
        (lambda: profiles.named_deviation("linear", SPAN, c=0.1, length=2), "does not take 'length'; it takes c"),
    ],
)
def test_refused(make, culprit):
    with pytest.raises(DesignError, match=culprit) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_knots_beside_the_stations_of_a_table():
    """A span that is no round number: knots fall within round-off of the stations of the tables, and of the span."""
    random = np.random.default_rng(1)
    for _ in range(60):
        span, n = random.uniform(0.1, 20), int(random.integers(4, 40))
        g = profiles.table(np.linspace(0, span, n), 0.01 * span / n * random.normal(size=n), span)
        y = random.uniform(0, span, 20)
        assert g.near_arc_length(g.arc_length(y)) == pytest.approx(y, abs=1e-10 * span)
        fold = Fold(g, g + g.reversed())
        assert fold.tables.drift(y) == pytest.approx(fold.drift(y), abs=1e-10 * span)
        at = fold.spar.arc_length(y)
        assert fold.tables.crease_height(at) == pytest.approx(g(y), abs=1e-9 * span)
