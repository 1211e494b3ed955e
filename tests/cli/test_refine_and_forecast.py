"""The error bar of drape --refine and the forecast of inspect --seed, as their users meet them."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest
from command import SAMPLES, draped, run

import meshdrape
from meshdrape.weave.measures.noise import SIGMAS, mesh_noise

# Sample, seed, direction, extent, how far the forecast may be off the drape's own maximum, share.
STARTS = {
    "hemisphere": ("0,0,500", "1,0.3,0", "400,400,400,400", 0.06),
    "krogh_double_curved": ("250,250,40", "1,0,0", None, 0.25),
    "cube_corner": ("0,0,0", "-1,-0.4,0", None, 1e-6),
    "wing_spar": ("2000,7000,1000", "0,1,0", None, 0.05),
    "hypar": ("0,0,0", "1,0,0", "1000,1000,1000,1000", 0.06),
}


def words(start):
    seed, direction, extent, _ = start
    return [f"--seed={seed}", f"--direction={direction}", *([f"--extent={extent}"] if extent else [])]


@pytest.mark.parametrize("name", STARTS)
def test_forecast_against_the_drape(capfd, name):
    start = STARTS[name]
    mould = meshdrape.read_mould(SAMPLES / f"{name}.step")
    spacing = mould.surface.diagonal / 200
    outcome = run(capfd, "inspect", SAMPLES / f"{name}.step", *words(start), "--spacing", spacing, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    facts = json.loads(outcome.out)
    seed, direction, extent = (None if text is None else tuple(map(float, text.split(","))) for text in start[:3])
    seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    measures = meshdrape.measure(meshdrape.drape(mould, meshdrape.Fabric(spacing), seed, direction, extent=extent))
    shear = np.degrees(measures.max_shear)
    assert facts["forecast"]["max_shear_deg"] == pytest.approx(shear, rel=start[3])
    locks = facts["forecast"]["max_shear_deg"] > 7
    assert [warning[:10] for warning in facts["warnings"]] == (["this start"] if locks else [])


@pytest.mark.parametrize("name", ["krogh_double_curved", "wing_spar", "cube_corner"])
def test_a_forecast_takes_milliseconds(name):
    """Once the mould's tables are built, whatever the spacing."""
    mould = meshdrape.read_mould(SAMPLES / f"{name}.step")
    fabric = meshdrape.Fabric(mould.surface.diagonal / 300)
    meshdrape.forecast(mould, fabric)
    least = min(meshdrape.forecast(mould, fabric).seconds for _ in range(3))
    assert least < 0.3  # some 10 to 50 ms on a quiet machine


def test_forecast_for_people(capfd):
    outcome = run(capfd, "inspect", SAMPLES / "cube_corner.step", "--seed", "0,0,0", "--direction=-1,-0.4,0")
    assert "  forecast    about 22.5 deg of shear, largest near (" in outcome.out
    assert "  WARNING     this start needs about 22.5 degrees of shear where the cloth locks at 7;" in outcome.out
    assert "forecast" not in run(capfd, "inspect", SAMPLES / "cube_corner.step").out
    wide = run(capfd, "inspect", SAMPLES / "cube_corner.step", "--seed", "0,0,0", "--locking-angle", "30")
    assert "WARNING" not in wide.out


def test_forecast_of_chosen_faces_and_bad_starts(capfd):
    block = SAMPLES / "wing_spar_block.step"
    told = json.loads(run(capfd, "inspect", block, "--faces", "1,2", "--direction", "0,1,0", "--json").out)
    assert 1 < told["forecast"]["max_shear_deg"] < 7
    assert len(told["faces"]) == 7
    unchosen = run(capfd, "inspect", block, "--direction", "0,1,0")
    assert (unchosen.code, unchosen.out) == (2, "")
    assert "choose with --faces" in unchosen.err
    away = run(capfd, "inspect", SAMPLES / "cone.stl", "--seed", "1e6,0,0")
    assert (away.code, away.err.count("\n")) == (2, 1)
    assert "seed" in away.err


def test_refine_gives_the_maximum_its_bar(capfd, tmp_path):
    net = tmp_path / "net.ply"
    start = ("--spacing", "50", "--seed", "0,0,0", "--direction", "1,0,0", "--extent", "500,500,500,500")
    summary = draped(capfd, SAMPLES / "hypar.step", net, *start, "--refine")
    bar = summary["refinement"]
    assert bar["max_shear_deg"][2] == summary["max_shear_deg"]
    assert bar["triangles"][2] == summary["mould"]["triangles"]
    assert 0 < bar["error_bar_deg"] < 0.1 * summary["max_shear_deg"]
    assert bar["error_bar_deg"] >= bar["mesh_noise_deg"] / SIGMAS
    assert bar["mesh_noise_deg"] == summary["mesh_noise_deg"]
    assert summary["seconds"]["refinement"] > 0
    plain = draped(capfd, SAMPLES / "hypar.step", tmp_path / "plain.ply", *start)
    assert plain["max_shear_deg"] == summary["max_shear_deg"]
    assert "refinement" not in plain
    outcome = run(capfd, "drape", SAMPLES / "hypar.step", "-o", net, *start, "--refine", "--no-picture")
    (row,) = (line for line in outcome.out.splitlines() if line.startswith("   refined"))
    assert f"+- {bar['error_bar_deg']:.2g} deg" in row


def test_refine_bends_the_fibres_as_the_drape_does(capfd, tmp_path):
    start = ("--spacing", "200", "--seed", "2000,7000,1000", "--direction", "0,1,0", "--extent", "2000,2000,2000,2000")
    summary = draped(
        capfd, SAMPLES / "wing_spar.step", tmp_path / "net.ply", *start, "--weft-turn-deg", "-8", "--refine"
    )
    bar = summary["refinement"]
    assert bar["max_shear_deg"][2] == summary["max_shear_deg"]
    assert np.ptp(bar["max_shear_deg"]) < 0.2 < summary["max_shear_deg"]
    assert bar["error_bar_deg"] < 0.3


def test_cloth_that_stops_cannot_be_refined(capfd, tmp_path):
    words = ("drape", SAMPLES / "hypar.step", "-o", tmp_path / "net.ply", "--spacing", "50", "--refine")
    outcome = run(capfd, *words, "--stop-at", "7")
    assert (outcome.code, outcome.out) == (2, "")
    assert "cloth that stops at 7 degrees of shear" in outcome.err
    assert outcome.err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_mesh_cannot_be_refined(capfd, tmp_path):
    begun = time.perf_counter()
    outcome = run(capfd, "drape", SAMPLES / "cone.stl", "-o", tmp_path / "net.ply", "--spacing", "1", "--refine")
    assert (outcome.code, outcome.out) == (2, "")
    assert "cone.stl is a mesh, its own truth" in outcome.err
    assert outcome.err.count("\n") == 1
    assert not list(tmp_path.iterdir())
    assert time.perf_counter() - begun < 10  # it is said before millions of nodes are laid


@pytest.mark.parametrize(
    "name",
    [
        "blade_root", "c_spar", "cone", "cube_corner", "cylinder", "hemisphere", "hypar", "joggle",
        "krogh_double_curved", "l_corner", "leading_edge", "pyramid", "saddle", "wing_spar",
    ],
)  # fmt: skip
def test_noise_of_the_samples(name):
    """At the default tolerances below a twentieth of a locking angle of 7 degrees."""
    assert np.degrees(mesh_noise(meshdrape.read_mould(SAMPLES / f"{name}.step").surface)) < 7 / 20


def test_a_noisy_mesh_is_warned_of(capfd, tmp_path):
    coarse = ("--angle-tolerance", "4", "--chord-tolerance", "4", "--spacing", "100", "--extent", "300,300,300,300")
    summary = draped(capfd, SAMPLES / "hemisphere.step", tmp_path / "net.ply", "--seed", "0,0,500", *coarse)
    assert summary["mesh_noise_deg"] > 0.7
    assert any("the mesh alone can falsify the shear" in warning for warning in summary["warnings"])


def test_the_balance_is_told_with_its_place(capfd, tmp_path):
    net = tmp_path / "net.ply"
    summary = draped(capfd, SAMPLES / "krogh_double_curved.step", net, "--spacing", "20")
    stored = meshdrape.read_net(net)
    residual = np.abs(np.degrees(stored.balance_residual))
    assert np.nanmax(residual) >= summary["balance_residual_deg"] > 0
    i, j = np.argwhere(np.isclose(residual, summary["balance_residual_deg"], rtol=1e-9))[0]
    middle = stored.node_position[i : i + 2, j : j + 2].reshape(-1, 3).mean(axis=0)
    assert summary["balance_residual_at"] == pytest.approx(middle.tolist())
    known = np.isfinite(stored.predicted_shear)
    np.testing.assert_allclose(
        stored.balance_residual[known], (stored.cell_shear - stored.predicted_shear)[known], atol=1e-14
    )
    # a cell has its own defects also where its rectangle has gaps
    assert known.sum() < np.isfinite(stored.cell_defect).sum() == np.isfinite(stored.cell_shear).sum()
    assert summary["nodes_by_libigl"] >= 0
