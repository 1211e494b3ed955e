"""How far a design can go: factors that are known in closed form, and those found sent through the CAD mould."""

import math
import time

import numpy as np
import pytest
from fold_designs import design, draped, in_degrees

from meshdrape.errors import DesignError
from meshdrape.study.fold import chart as chart_module
from meshdrape.study.fold.chart import _STEEPNESS, FAMILIES, allowed, envelope
from meshdrape.study.fold.limits import limits
from meshdrape.theory import named_deviation

LOCKING = 7.0


def test_flat_wing_and_tilted_spar():
    """ψ = -arctan(k c) everywhere: upright, the ribbon locks at k = tan 7° / c; left to itself, never.

    Exact with a row that starts at the corner: elsewhere a link of the ribbon bends over the edge and turns the first
    column a little more.
    """
    of = design(wing={"profile": "flat"}, spar={"deviation": "linear", "c": 0.1}, spacing=0.1, row_offset=0.0)
    found = {limit.rule: limit for limit in limits(of)}
    assert found["gamma 0"].factor == pytest.approx(math.tan(math.radians(LOCKING)) / 0.1, rel=5e-4)
    assert np.degrees(found["gamma 0"].shear.largest) == pytest.approx(LOCKING, abs=0.0041)
    assert found["free"].factor is found["best"].factor is None
    assert found["free"].tried > 8


def test_origami_has_no_limit():
    for limit in limits(design(spar={"deviation": "none"}, spacing=0.1)):
        assert (limit.factor, limit.tried) == (None, math.inf)


@pytest.mark.parametrize("spar", [
    {"deviation": "sin2_slope", "c": 0.1}, {"deviation": "sine", "c": 0.03, "wavelength": 9.0},
])  # fmt: skip
def test_largest_factor_locks_on_the_cad_mould(spar):
    """Found on facets along the rulings; f times it, made by the CAD script, locks to 0.01 degrees."""
    of = design(spar=spar)
    limit = limits(of)[0]
    again = draped(design(spar={**spar, "c": spar["c"] * limit.factor}), cad=True)
    assert max(in_degrees(again)) == pytest.approx(LOCKING, abs=0.01)


def test_a_ribbon_turned_past_the_locking_angle_locks_for_every_f():
    """The rule of the design itself is looked at beside the other three."""
    found = {limit.rule: limit.factor for limit in limits(design(start={"gamma_deg": 9.0}, spacing=0.1))}
    assert list(found) == ["gamma 0", "free", "best", "design"]
    assert found["design"] == 0.0
    assert found["best"] >= found["gamma 0"] > 1


# --- the chart --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("family", FAMILIES)
def test_amplitudes_of_the_chart_are_those_of_the_same_slopes(family):
    f = named_deviation(family, 14.0, c=1.0, **{FAMILIES[family]: 3.0})
    assert np.abs(f.slope(np.linspace(0, 14, 200_001))).max() == pytest.approx(_STEEPNESS[family] / 3.0, rel=1e-6)


def test_chart_is_made_of_drapes():
    """A design of the chart, draped by itself at the chart's spacing, and the allowed amplitude between two of them."""
    of = design(start={"gamma_deg": "best"})
    done: list[int] = []
    chart = envelope(of, "sine", (4, 3), done.append)
    assert done == list(range(1, 13))
    assert np.isfinite(chart.largest).all()
    spar = {"deviation": "sine", "c": chart.amplitude[1, 2] / 1000, "wavelength": chart.wavelength[2] / 1000}
    one = draped(design(spar=spar, spacing=chart.spacing / 1000, start={"gamma_deg": "best"}))
    assert np.degrees([chart.wing_fed[1, 2], chart.ribbon_fed[1, 2]]) == pytest.approx(in_degrees(one), abs=0.02)
    for b in range(3):
        k = int(np.searchsorted(chart.largest[:, b], of.locking_angle))
        assert chart.amplitude[k - 1, b] < chart.allowed[b] < chart.amplitude[k, b]


def test_interrupted_chart_does_not_drape_the_rest(monkeypatch):
    laid: list[float] = []

    def slowly(of, family, amplitude, wavelength, spacing):
        laid.append(amplitude)
        time.sleep(0.02)

    def interrupted(done):
        raise KeyboardInterrupt

    monkeypatch.setattr(chart_module, "_draped", slowly)
    with pytest.raises(KeyboardInterrupt):
        envelope(design(), "sine", (20, 20), interrupted, threads=2)
    assert len(laid) < 40


def test_allowed_amplitude_of_a_known_shear():
    amplitude = np.geomspace(1, 100, 7)[:, None] * np.array([1.0, 2.0, 1.0])
    largest = np.log(amplitude * np.array([1.0, 1.0, 1e-9])) + np.array([0.0, 0.0, 0.0])
    found = allowed(amplitude, largest, math.log(10.0))
    assert found[:2] == pytest.approx([10.0, 10.0])
    assert math.isnan(found[2])
    assert allowed(amplitude, largest + 100, 7.0)[0] == 0


def test_unknown_family():
    with pytest.raises(DesignError, match="no family is called 'wave': sine, ripple, bump"):
        envelope(design(), "wave")
