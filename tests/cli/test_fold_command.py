"""meshdrape fold: a design in, JSON and one page of text out."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from command import ROOT, SAMPLES, run
from fold_designs import REAL, design, draped, in_degrees, table, toml

CRITERIA = ["eq20", "eq29", "within_reach", "characteristics", "drape"]
REAL_PARABOLA = SAMPLES / "designs" / "real_wing_parabola.toml"


def asked(capfd, tmp_path, base=None, *options, **changes):
    file = tmp_path / "design.toml"
    file.write_text(toml(table(base, **changes)))
    outcome = run(capfd, "fold", file, "--json", "--quiet", *options)
    assert (outcome.code, outcome.err) == (0, "")
    return json.loads(outcome.out)


def test_real_wing_with_its_parabola(capfd, tmp_path):
    """Every criterion beside the published figures in the file, the page of text on stdout."""
    target, page = tmp_path / "answer.json", tmp_path / "answer.html"
    outcome = run(capfd, "fold", REAL_PARABOLA, "-o", target, "-o", page)
    assert outcome.code == 0
    found = json.loads(target.read_text())
    assert found["feasible"] is True
    shear = found["max_shear_deg"]
    assert list(shear) == CRITERIA
    assert shear["eq20"] == {"wing_fed": None, "ribbon_fed": pytest.approx(5.711, abs=6e-4)}
    assert shear["eq29"] == {"wing_fed": pytest.approx(5.688, abs=6e-4), "ribbon_fed": None}
    for name in ("characteristics", "drape"):
        assert shear[name] == {
            "wing_fed": pytest.approx(3.008, abs=0.01), "ribbon_fed": pytest.approx(2.134, abs=0.01)
        }  # fmt: skip
    # the limit of the two from above, by what ψ changes between ribbons
    for name in ("wing_fed", "ribbon_fed"):
        assert 0 < shear["within_reach"][name] - shear["characteristics"][name] < 0.15
    assert found["margin_deg"] == pytest.approx(7 - shear["drape"]["wing_fed"], abs=1e-9)
    assert found["gamma_best_deg"] == pytest.approx(-shear["within_reach"]["ribbon_fed"] / 2, abs=1e-6)
    assert found["largest_factor"] == found["largest_factors"]["gamma 0"]["factor"]
    for limit in found["largest_factors"].values():
        assert max(limit["max_shear_deg"].values()) == pytest.approx(7, abs=0.0045)
    assert found["nearest_spar"]["unchanged"] is True
    assert found["warnings"] == []
    where = found["where"]["wing_fed"]
    y_row, y_column = where["row_crosses_at_y_mm"], where["column_crosses_at_y_mm"]
    psi = np.interp([y_row, y_column], found["where"]["y_mm"], found["where"]["psi_deg"])
    assert abs(psi[1] - psi[0]) == pytest.approx(shear["drape"]["wing_fed"], abs=0.01)
    best = found["laying"]["best"]
    assert (best["first"], best["end"], best["well_posed"]) == ("wing", "root", True)
    text = outcome.out
    assert text.startswith("CAN BE MADE: the cloth shears by 3.01 deg and locks at 7.00 deg, 3.99 deg to spare\n")
    assert "too strict here by 2.70 deg" in text
    assert len(text.splitlines()) < 60
    assert max(map(len, text.splitlines())) <= 120
    assert text.endswith(f"wrote    {target}\nwrote    {page}\n")
    assert "<html" in page.read_text(encoding="utf-8")[:200]


SMALL = {**REAL, "spacing": 0.1}


def test_the_unit_of_the_file_changes_nothing(capfd, tmp_path):
    """Metres or millimetres: the same numbers, but for the file's name and the seconds."""
    metres = asked(capfd, tmp_path, SMALL, spar={"deviation": "sine", "c": 0.03, "wavelength": 7.0})
    sizes = {name: 1000 * SMALL[name] for name in ("span", "chord", "spar_height", "spacing")}
    spar = {"deviation": "sine", "c": 30.0, "wavelength": 7000.0}
    other = asked(capfd, tmp_path, SMALL, unit="mm", **sizes, spar=spar)
    for one in (metres, other):
        del one["seconds"]
    assert flat(metres) == pytest.approx(flat(other), rel=1e-6, abs=1e-6)


def flat(value, name=""):
    """Every number of nested JSON by its path."""
    if isinstance(value, dict):
        return {k: v for key, one in value.items() for k, v in flat(one, f"{name}.{key}").items()}
    if isinstance(value, list):
        return {k: v for n, one in enumerate(value) for k, v in flat(one, f"{name}[{n}]").items()}
    return {name: value} if isinstance(value, (int, float)) else {}


def test_too_steep_a_spar(capfd, tmp_path):
    """Refused with its reasons, and mended: the spar it proposes drapes as it says.

    (20) passes a slope that changes sign: it sees half of what the cloth does.
    """
    spar = {"deviation": "sine", "c": 0.1, "wavelength": 7.0}
    found = asked(capfd, tmp_path, SMALL, "--nearest", "position", spar=spar)
    assert found["feasible"] is False
    assert found["margin_deg"] < -1
    assert found["max_shear_deg"]["eq20"]["ribbon_fed"] < 7 < found["max_shear_deg"]["drape"]["wing_fed"]
    assert found["remarks"]["eq20"].startswith("unsafe here")
    assert "passes what locks" in found["remarks"]["eq20"]
    assert found["largest_factor"] < 1
    near = found["nearest_spar"]
    assert (near["measure"], near["proven"], near["unchanged"]) == ("position", True, False)
    metres = {"y": [y / 1000 for y in near["y_mm"]], "f": [f / 1000 for f in near["f_mm"]]}
    start = {"gamma_deg": near["gamma_deg"]}
    again = draped(design(SMALL, spar={"deviation": "table", **metres}, start=start))
    assert in_degrees(again) == pytest.approx(list(near["max_shear_deg"].values()), abs=1e-3)
    assert max(in_degrees(again)) < 7


def test_chart(capfd, tmp_path):
    found = asked(capfd, tmp_path, SMALL, "--chart", "4x3", "--family", "ripple")["envelope"]
    assert (found["family"], found["rule"]) == ("ripple", "gamma 0")
    assert np.shape(found["wing_fed_deg"]) == np.shape(found["amplitude_mm"]) == (4, 3)
    assert len(found["allowed_mm"]) == len(found["wavelength_mm"]) == 3
    assert all(allowed > 0 for allowed in found["allowed_mm"])


@pytest.mark.parametrize("delay", [0.6, 3.0])
def test_ctrl_c_ends_every_process(tmp_path, delay):
    """As a terminal sends it, to the command and to the process in which the CAD mould is made."""
    begin = "import sys; from meshdrape.cli.main import main; print('begun', flush=True); sys.exit(main())"
    words = ["fold", REAL_PARABOLA, "--quiet", "-o", tmp_path / "answer.json", "--chart", "30x30"]
    process = subprocess.Popen(
        [sys.executable, "-c", begin, *map(str, words)], env={**os.environ, "PYTHONPATH": str(ROOT)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", "meshdrape: interrupted; no file was left half written\n")
    assert not list(tmp_path.iterdir())
    with pytest.raises(ProcessLookupError):
        os.killpg(process.pid, 0)


@pytest.mark.parametrize(("words", "says"), [
    (["--chart", "20"], "no chart"), (["--chart", "1x9"], "no chart"), (["--nearest", "angle"], "invalid choice"),
    (["--family", "bump"], "--family bump is the family of f that a chart varies: ask for one with --chart"),
    (["--family", "sine"], "ask for one with --chart"),
    (["-o", "answer.pdf"], "has the suffix .pdf"), (["-o", "none/answer.json"], "does not exist"),
])  # fmt: skip
def test_words_that_make_no_sense(capfd, words, says):
    outcome = run(capfd, "fold", REAL_PARABOLA, *words)
    assert outcome.code == 2
    assert says in outcome.err
    assert outcome.err.count("\n") == 1
    assert outcome.out == ""


@pytest.mark.parametrize(("changes", "says"), [
    ({"span": 0.014}, "a wing of 0.014 m is too short"),
    ({"spar_height": 4.0}, "higher than the wing is wide"),
    ({"spar": {"deviation": "wave"}}, "none, linear, parabola, sine, sin2_slope, bump, ripple, table"),
    ({"wing": {"profile": "table", "y": [0.0, 9.0, 5.0, 14.0], "g": [0.0, 0.1, 0.2, 0.3]}}, "y must increase"),
    ({"spar": {"deviation": "linear", "c": 2.0}}, "the profiles cross"),
])  # fmt: skip
def test_bad_designs_in_one_line(capfd, tmp_path, changes, says):
    file = tmp_path / "bad.toml"
    file.write_text(toml(table(**changes)))
    outcome = run(capfd, "fold", file)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.startswith("meshdrape: bad.toml: ")
    assert says in outcome.err
    assert outcome.err.count("\n") == 1
