"""The design file: read strictly, the same in every unit, and refused in one line that names the culprit."""

from pathlib import Path

import numpy as np
import pytest
from fold_designs import REAL, design, table, toml

from meshdrape.errors import DesignError, FileError
from meshdrape.study.fold.design import UNITS, design_from, read_design

SAMPLES = Path(__file__).parents[2] / "samples" / "designs"
Y = [0.0, 3.0, 8.0, 14.0]


def test_samples_are_designs():
    files = sorted(SAMPLES.glob("*.toml"))
    assert files
    for file in files:
        assert read_design(file).source == file
    one, other = read_design(SAMPLES / "real_wing_parabola.toml"), design()
    y = np.linspace(0, 14000, 15)
    assert np.array_equal(one.fold.spar(y), other.fold.spar(y))
    assert (one.span, one.spacing, one.locking_angle, one.gamma) == (14000, 20, other.locking_angle, 0.0)


def in_unit(unit):
    """The parts of a design and their lengths in a unit."""
    k = 1000 / UNITS[unit]
    sizes = {name: REAL[name] * k for name in ("span", "chord", "spar_height", "spacing")}
    y = [k * at for at in Y]
    wave = {"wavelength": 3.5 * k}
    real, curved = {"profile": "real"}, {"profile": "table", "y": y, "g": [0.0, 0.2 * k, 0.4 * k, 0.5 * k]}
    return sizes, [
        {"wing": {"profile": "quadratic", "a": 0.01 / k}, "spar": {"deviation": "sine", "c": 0.05 * k, **wave}},
        {"wing": {"profile": "arc", "radius": 90 * k}, "spar": {"deviation": "bump", "c": 0.05 * k, "length": 4 * k}},
        {"wing": curved, "spar": {"deviation": "linear", "c": 0.1}},
        {"wing": real, "spar": {"deviation": "table", "y": y, "f": [0.0, 0.01 * k, 0.02 * k, 0.05 * k]}},
        {"wing": real, "spar": {"deviation": "ripple", "c": 0.01 * k, **wave}},
        {"wing": real, "spar": {"profile": "arc", "radius": 60 * k}},
        {"wing": real, "spar": {"deviation": "sin2_slope", "c": 0.1}},
        {"wing": {"profile": "flat"}, "spar": {"deviation": "parabola", "c": 0.1}},
    ]


@pytest.mark.parametrize("unit", [unit for unit in UNITS if unit != "m"])
def test_the_same_design_in_another_unit(unit):
    y = np.linspace(0, 14000, 57)
    for mine, theirs in zip(in_unit(unit)[1], in_unit("m")[1], strict=True):
        one, other = design(unit=unit, **in_unit(unit)[0], **mine), design(**theirs)
        assert one.spacing == pytest.approx(other.spacing, rel=1e-12)
        for name in ("wing", "spar"):
            mine_g, their_g = getattr(one.fold, name), getattr(other.fold, name)
            assert mine_g(y) == pytest.approx(their_g(y), rel=1e-9, abs=1e-9)
            assert mine_g.slope(y) == pytest.approx(their_g.slope(y), rel=1e-9, abs=1e-12)


BAD = {
    "no such key": ({"sapn": 3.0}, "'sapn': unit, span"),
    "no such key of start": ({"start": {"gama_deg": 3.0}}, "'gama_deg': first, gamma_deg, end"),
    "no such unit": ({"unit": "metre"}, "'metre' is not known: mm, cm, m, in, ft"),
    "no such profile": ({"wing": {"profile": "naca"}}, "'naca' is not known: real, flat, quadratic, arc, table"),
    "no such deviation": (
        {"spar": {"deviation": "wave"}},
        "'wave' is not known: none, linear, parabola, sine, sin2_slope, bump, ripple, table",
    ),
    "no such first": ({"start": {"first": "tail"}}, "'tail' is not known: wing, spar"),
    "no such gamma": ({"start": {"gamma_deg": "upright"}}, '"free" or "best"'),
    "parameter of another deviation": ({"spar": {"deviation": "linear", "c": 0.1, "wavelength": 3.0}}, "'wavelength'"),
    "parameter missing": ({"spar": {"deviation": "sine", "c": 0.1}}, "needs wavelength"),
    "inner parameter": ({"wing": {"profile": "real", "metre": 5.0}}, "does not take 'metre'"),
    "both": ({"spar": {"profile": "real", "deviation": "none"}}, "both a profile and a deviation"),
    "neither": ({"spar": {}}, "deviation is missing"),
    "no wing": ({"wing": None}, "[wing] is missing"),
    "wing no table": ({"wing": "real"}, "write [wing]"),
    "span missing": ({"span": None}, "span is missing"),
    "word for a number": ({"chord": "three"}, "chord = 'three' is not a number"),
    "truth for a number": ({"chord": True}, "chord = True is not a number"),
    "not finite": ({"chord": float("nan")}, "chord = nan is not finite"),
    "negative": ({"spar_height": -1.0}, "spar_height = -1: must be positive"),
    "zero": ({"spacing": 0}, "spacing = 0: must be positive"),
    "locking": ({"locking_angle_deg": 90}, "locking_angle_deg = 90: must lie below 90"),
    "offset": ({"row_offset": 1.5}, "row_offset = 1.5: must lie between 0 and 1"),
    "gamma": ({"start": {"gamma_deg": 95}}, "gamma_deg = 95"),
    "unit forgotten": ({"unit": "mm"}, "a wing of 14 mm is too short; is unit = 'mm' right"),
    "unit too large": ({"span": 14000.0}, "a wing of 14000 m is too long"),
    "only the span in mm": ({"unit": "mm", "span": 14000.0}, "chord: 3 mm wide on a span of 14000 mm; are both in mm?"),
    "chord in mm": ({"chord": 3000.0}, "chord: 3000 m wide on a span of 14 m"),
    "wave in mm": ({"spar": {"deviation": "sine", "c": 0.05, "wavelength": 3500.0}}, "wavelength = 3500 m on a span"),
    "bump in mm": ({"spar": {"deviation": "bump", "c": 0.05, "length": 1000.0}}, "length = 1000 m on a span of 14 m"),
    "wave between ribbons": (
        {"spar": {"deviation": "ripple", "c": 1e-5, "wavelength": 0.01}},
        "[spar] wavelength = 0.01 m is shorter than two ribbons, which lie 0.02 m apart",
    ),
    "table in mm": (
        {"spar": {"deviation": "table", "y": [1000 * y for y in Y], "f": [0.0, 0.1, 0.2, 0.3]}},
        "[spar] y reaches 14000 m on a span of 14 m",
    ),
    "spacing of atoms": ({"spacing": 1e-9}, "spacing = 1e-09 m makes 1.4e+19 nodes"),
    "integer without end": ({"spar": {"deviation": "linear", "c": 10**400}}, "is beyond 1e+09; check its unit"),
    "spacing in mm": ({"spacing": 20.0}, "spacing = 20 m leaves no four ribbons"),
    "spar too high": ({"spar_height": 3.5}, "the spar is higher than the wing is wide (chord = 3)"),
    "table falls back": (
        {"wing": {"profile": "table", "y": [0.0, 8.0, 3.0, 14.0], "g": [0.0, 0.1, 0.2, 0.3]}},
        "y must increase",
    ),
    "table too short": ({"wing": {"profile": "table", "y": [0.0, 1.0, 2.0, 3.0], "g": [0.0, 0.1, 0.2, 0.3]}}, "cover"),
    "table of three": ({"wing": {"profile": "table", "y": [0.0, 7.0, 14.0], "g": [0.0, 0.1, 0.2]}}, "at least 4"),
    "table uneven": ({"wing": {"profile": "table", "y": Y, "g": [0.0, 0.1, 0.2]}}, "got 4 for y and 3 for g"),
    "deviation uneven": ({"spar": {"deviation": "table", "y": Y, "f": [0.0]}}, "[spar] a table needs two equal lists"),
    "word in a table": ({"wing": {"profile": "table", "y": Y, "g": [0.0, 0.1, "b", 0.3]}}, "g[2] = 'b' is not a"),
    "number for a table": ({"wing": {"profile": "table", "y": 3.0, "g": 1.0}}, "must be a list"),
    "list for a number": ({"spar": {"deviation": "linear", "c": [0.1, 0.2]}}, "must be a number, not a list"),
    "arc too small": ({"wing": {"profile": "arc", "radius": 10.0}}, "radius"),
    "wavelength": ({"spar": {"deviation": "sine", "c": 0.1, "wavelength": 0.0}}, "wavelength"),
    "crossing": ({"spar": {"deviation": "linear", "c": 1.0}}, "the profiles cross: f = 14 m at y = 14"),
    "crossing the other way": ({"spar": {"deviation": "linear", "c": -1.0}}, "the profiles cross: f = -14 m"),
    "too steep": ({"wing": {"profile": "quadratic", "a": 0.4}}, "slope of 11.2 at y = 14 m"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_designs(name):
    changes, says = BAD[name]
    bad = {key: value for key, value in table(**changes).items() if value is not None}
    with pytest.raises(DesignError) as error:
        design_from(bad)
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_what_is_wrong_with_a_profile_is_said_in_the_units_of_the_file():
    """3.5 m of the file, not the 3500 mm it is made of; and in which table."""
    with pytest.raises(DesignError, match=r"^\[spar\] wavelength=-3.5: must be positive$"):
        design(spar={"deviation": "sine", "c": 0.1, "wavelength": -3.5})
    with pytest.raises(DesignError, match=r"^\[wing\] radius=13.0: must be larger than the span, 14.0$"):
        design(wing={"profile": "arc", "radius": 13.0})


def test_files_that_are_no_design(tmp_path):
    with pytest.raises(FileError, match=r"none\.toml does not exist; check the path"):
        read_design(tmp_path / "none.toml")
    bad = tmp_path / "bad.toml"
    for content in (b"unit = m\n", b"\xff\xfe\x00"):
        bad.write_bytes(content)
        with pytest.raises(FileError, match="is no TOML"):
            read_design(bad)
    bad.write_text(toml(table(span=-14.0)))
    with pytest.raises(DesignError, match=r"^bad\.toml: span = -14: must be positive$"):
        read_design(bad)
