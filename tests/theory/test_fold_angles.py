"""The fold's angles (26) to (28), its flat sheets and the drift of the columns."""

import numpy as np
import pytest

from meshdrape.errors import DesignError
from meshdrape.theory import Fold, flat, linear_deviation, parabola_deviation, quadratic, real_wing, sine_deviation

WING = real_wing()
FOLDS = {
    "figure 4": Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0)),
    "real": Fold(WING, WING + parabola_deviation(0.1, 14.0)),
    "wavy": Fold(WING, WING + sine_deviation(0.05, 3.5, 14.0)),
    "steep": Fold(quadratic(0.9, 1.0), -quadratic(1.3, 1.0)),
}


def stations(fold):
    return np.linspace(0.0, fold.span, 41)


@pytest.mark.parametrize("name", FOLDS)
def test_angles_are_those_of_the_crease_on_the_flat_sheets(name):
    """tan α and tan β of (26), (27) against the direction of the flattened crease, by differences."""
    fold, h = FOLDS[name], 1e-6
    y = stations(fold)[1:-1]
    for edge, angle in ((fold.wing_edge, fold.alpha), (fold.spar_edge, fold.beta)):
        step = edge(y + h) - edge(y - h)
        assert np.angle(step) == pytest.approx(angle(y), abs=1e-8)
    # one crease, so of one length on both sheets
    assert np.abs(fold.wing_edge(y + h) - fold.wing_edge(y)) == pytest.approx(
        np.abs(fold.spar_edge(y + h) - fold.spar_edge(y)), rel=1e-7
    )


@pytest.mark.parametrize("name", FOLDS)
def test_psi(name):
    fold = FOLDS[name]
    y = stations(fold)
    assert fold.psi(y) == pytest.approx(fold.beta(y) - fold.alpha(y), abs=1e-15)
    w, s = fold.wing.slope(y), fold.spar.slope(y)
    p, q = np.sqrt(1 + w**2), np.sqrt(1 + s**2)
    assert np.tan(fold.psi(y)) == pytest.approx((w * p - s * q) / (p * q + w * s), rel=1e-12, abs=1e-15)  # (28)
    inner, h = y[1:-1], 1e-6
    assert (fold.psi(inner + h) - fold.psi(inner - h)) / (2 * h) == pytest.approx(fold.psi_slope(inner), abs=1e-8)


def test_published_psi():
    """Figure 4 of the study group report at y = 1, and a flat wing with a straight skew spar; closed forms."""
    fold = FOLDS["figure 4"]
    assert fold.psi(0.0) == 0
    assert np.degrees(fold.psi(1.0)) == pytest.approx(-19.25821, abs=5e-6)
    skew = Fold(flat(2.0), linear_deviation(0.12, 2.0))
    assert np.degrees(skew.psi(stations(skew))) == pytest.approx(-6.842773, abs=5e-7)
    assert skew.psi(1.0) == pytest.approx(-np.arctan(0.12), abs=1e-15)


def test_origami_fold_does_not_turn_the_net():
    """(3): g_w = g_s."""
    fold = Fold(WING, WING)
    assert np.abs(fold.psi(stations(fold))).max() < 1e-16
    assert fold.drift(stations(fold)) == pytest.approx(WING.arc_length(stations(fold)), rel=1e-14)


@pytest.mark.parametrize("name", FOLDS)
def test_crease_in_space(name):
    fold = FOLDS[name]
    y = stations(fold)
    crease = np.stack([fold.spar(y), y, fold.wing(y)], axis=-1)
    for edge, to_space in ((fold.wing_edge, fold.wing_to_space), (fold.spar_edge, fold.spar_to_space)):
        flat_edge = edge(y)
        assert to_space(np.stack([flat_edge.real, flat_edge.imag], axis=-1)) == pytest.approx(crease, abs=1e-10)
    edge = fold.spar_edge(y)
    assert fold.depth(np.stack([edge.real, edge.imag - 0.3], axis=-1)) == pytest.approx(0.3 + 0 * y, abs=1e-10)


@pytest.mark.parametrize("name", FOLDS)
def test_what_a_row_crosses_does_not_depend_on_the_way(name):
    """d spar_edge - dH = i exp(i ψ) dx: down a column the net is turned by the ψ of the rows; integrated by Gauss."""
    fold = FOLDS[name]
    node, weight = np.polynomial.legendre.leggauss(60)
    y = fold.span / 2 * (1 + node)
    across = np.sum(weight * fold.span / 2 * 1j * np.exp(1j * fold.psi(y)) * fold.spar.slope(y))
    found = np.diff(fold.spar_edge([0.0, fold.span]) - fold.drift([0.0, fold.span]))[0]
    assert abs(found - across) < 1e-11 * fold.span


def test_tables_follow_the_functions():
    for fold in FOLDS.values():
        y = np.linspace(0, fold.span, 997)
        assert np.abs(fold.tables.drift(y) - fold.drift(y)).max() < 1e-10 * fold.span
        assert np.abs(fold.tables.crease_height(fold.spar.arc_length(y)) - fold.wing(y)).max() < 1e-10 * fold.span


@pytest.mark.parametrize("name", FOLDS)
def test_swapped_and_reversed(name):
    """Roles exchanged: (x, z) = (-z', -x'), so ψ turns its sign twice and stays; y reversed, ψ changes sign."""
    fold = FOLDS[name]
    y = stations(fold)
    assert fold.swapped().psi(y) == pytest.approx(fold.psi(y), abs=1e-15)
    assert fold.swapped().swapped().spar(y) == pytest.approx(fold.spar(y), abs=1e-15)
    assert fold.reversed().psi(fold.span - y) == pytest.approx(-fold.psi(y), abs=1e-12)


def test_spans_must_agree():
    with pytest.raises(DesignError, match=r"spans 1.0 and 2.0"):
        Fold(flat(1.0), flat(2.0))
