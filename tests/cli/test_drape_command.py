"""meshdrape drape: the files it writes, and what each option does to them."""

from __future__ import annotations

import json
import math
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from command import CAD, SAMPLES, draped, run
from meshfiles import binary_stl
from moulds import cap, grid, icosphere, plate

import meshdrape
from meshdrape import weave
from meshdrape.cli import drape as drape_command
from meshdrape.cli.main import main
from meshdrape.weave import read_off
from meshdrape.weave.measures.noise import mesh_noise

SPACING, SEED, DIRECTION = 40.0, (50.0, 30.0, 990.0), (1.0, 0.3, 0.0)
COMPANIONS = ["net.fibres.ply", "net.json", "net.mould.ply", "net.ply", "net.png"]
# what design and README promise to scripts
KEYS = {
    "nodes", "cells", "cloth_mm", "max_shear_deg", "max_shear_at", "over_locking_percent", "coverage_percent",
    "statuses", "audit_max_relative_error", "mesh_noise_deg", "balance_residual_deg", "warnings", "seconds",
    "version", "command",
}  # fmt: skip


def words(values) -> str:
    return ",".join(map(str, values))


@pytest.fixture(scope="module")
def dome(tmp_path_factory) -> Path:
    """A cap of a sphere of 1000 mm radius, where a net is sheared both ways."""
    file = tmp_path_factory.mktemp("dome") / "dome.stl"
    file.write_bytes(binary_stl(cap()))
    return file


@pytest.fixture(scope="module")
def flat(tmp_path_factory) -> Path:
    """A plate of 200 x 140 mm in the plane z = 0."""
    file = tmp_path_factory.mktemp("flat") / "flat.stl"
    file.write_bytes(binary_stl(plate()))
    return file


@pytest.fixture(scope="module")
def whole(dome, tmp_path_factory) -> Path:
    """The net of one drape with nothing left out."""
    net = tmp_path_factory.mktemp("whole") / "net.ply"
    options = ["--spacing", str(SPACING), "--seed", words(SEED), "--direction", words(DIRECTION)]
    assert main(["drape", str(dome), "-o", str(net), *options, "--reference", "0,1,0", "--quiet"]) == 0
    return net


@pytest.fixture(scope="module")
def through_api(dome):
    """The measures of the same drape by the public names."""
    return meshdrape.measure(
        meshdrape.drape(meshdrape.read_mould(dome), meshdrape.Fabric(SPACING), SEED, DIRECTION)
    )  # fmt: skip


@pytest.mark.parametrize("suffix", [".json", ".png", ".stl", ""])
def test_a_net_is_written_as_ply(capfd, flat, tmp_path, suffix):
    """Under the name of one of its companions it would be lost beneath that one."""
    outcome = run(capfd, "drape", flat, "-o", tmp_path / f"net{suffix}", "--spacing", 20)
    assert (outcome.code, outcome.out, outcome.err.count("\n")) == (2, "", 1)
    assert f"net{suffix} has the suffix {suffix or '(none)'}; a net is written as .ply" in outcome.err
    assert not list(tmp_path.iterdir())


# --- files ------------------------------------------------------------------------------------------------------------


def test_net_and_companions_are_written_and_nothing_else(whole):
    assert sorted(path.name for path in whole.parent.iterdir()) == COMPANIONS
    picture = whole.with_suffix(".png").read_bytes()
    assert picture.startswith(b"\x89PNG\r\n\x1a\n")
    assert picture.endswith(b"IEND\xaeB`\x82")


def test_summary_agrees_with_the_public_names(whole, dome, through_api):
    summary = json.loads(whole.with_suffix(".json").read_text())
    net, mould = through_api.net, through_api.net.mould
    field = read_off(through_api, (0, 1, 0))
    assert summary.keys() >= KEYS
    assert summary["version"] == meshdrape.__version__
    assert summary["command"].startswith(f"meshdrape drape {dome} -o {whole} --spacing {SPACING}")
    status = net.node_status
    assert summary["statuses"] == {
        s.name: int((status == s).sum()) for s in meshdrape.NodeStatus if (status == s).any()
    }
    assert summary["nodes"] == (status == meshdrape.NodeStatus.PLACED).sum() > 500
    assert summary["cells"] == through_api.cell_touches_mould.sum()
    assert tuple(summary["cloth_mm"].values()) == pytest.approx(through_api.cloth)
    assert summary["max_shear_deg"] == pytest.approx(math.degrees(through_api.max_shear), rel=1e-9)
    assert summary["max_shear_at"] == pytest.approx(through_api.max_shear_position.tolist(), abs=1e-6)
    assert summary["over_locking_percent"] == pytest.approx(100 * through_api.over_locking_fraction)
    assert 0 < summary["over_locking_percent"] < 100
    assert summary["coverage_percent"] == pytest.approx(100 * field.coverage_fraction)
    assert summary["mesh_noise_deg"] == pytest.approx(math.degrees(mesh_noise(mould.surface)))
    assert 0 <= summary["audit_max_relative_error"] < 1e-7
    assert summary["audit"]["n_edges"] >= 100
    assert 0 <= summary["balance_residual_deg"] < 1
    assert summary["seconds"]["total"] >= max(summary["seconds"].values())
    assert any("the cloth locks" in warning for warning in summary["warnings"])
    assert summary["reference"] == [0, 1, 0]
    assert summary["seed"] == pytest.approx(net.seed.tolist(), abs=1e-9)
    assert summary["direction"] == pytest.approx(net.direction.tolist(), abs=1e-9)
    assert summary["mould"]["triangles"] == len(mould.triangles)
    assert summary["mould"]["sha256"] == mould.sha256
    assert summary["mould"]["area_mm2"] == pytest.approx(mould.surface.face_area.sum())


def test_whatever_compiles_is_told_of(flat, tmp_path, monkeypatch):
    """Measuring and the audit have kernels of their own: the notice of the first run is not over before them."""
    inside, seen = [], {}

    @contextmanager
    def told(quiet):
        inside.append(quiet)
        yield
        inside.pop()

    def watched(module, name):
        real = getattr(module, name)
        monkeypatch.setattr(module, name, lambda *words, **named: seen.update({name: bool(inside)})
                            or real(*words, **named))  # fmt: skip

    monkeypatch.setattr(drape_command, "compilation_told", told)
    for name in ("drape", "measure", "read_off", "audit"):
        watched(weave, name)
    watched(sys.modules["meshdrape.weave.measures.balance"], "balance")
    assert main(["drape", str(flat), "-o", str(tmp_path / "net.ply"), "--spacing", "20", "--no-picture"]) == 0
    assert seen == dict.fromkeys(("drape", "measure", "read_off", "audit", "balance"), True)
    assert not inside


def test_net_file_holds_the_net_of_the_public_names(whole, through_api):
    net, stored = through_api.net, meshdrape.read_net(whole)
    np.testing.assert_array_equal(stored.node_status, net.node_status)
    np.testing.assert_allclose(stored.node_position, net.node_position, rtol=0, atol=1e-9)
    np.testing.assert_allclose(stored.warp_direction, net.warp_direction, rtol=0, atol=1e-9)
    np.testing.assert_allclose(stored.weft_direction, net.weft_direction, rtol=0, atol=1e-9)
    assert stored.seed_index == net.seed_index
    touching = through_api.cell_touches_mould
    np.testing.assert_allclose(stored.cell_shear[touching], through_api.cell_shear[touching], rtol=0, atol=1e-9)
    assert stored.mould_file.resolve() == net.mould.source.resolve()


def test_net_file_opens_in_meshlab(whole, meshlab):
    stored = meshdrape.read_net(whole)
    mesh = meshlab(whole)
    there = np.isfinite(stored.node_position[..., 0])
    np.testing.assert_allclose(mesh.vertex_matrix(), stored.node_position[there], rtol=0, atol=1e-9)
    shear = np.degrees(np.abs(stored.cell_shear[np.isfinite(stored.cell_shear)]))
    assert mesh.face_number() == 2 * len(shear)  # MeshLab cuts each cell in two
    assert mesh.face_scalar_array().max() == pytest.approx(shear.max(), rel=1e-6)
    assert mesh.face_scalar_array().mean() == pytest.approx(shear.mean(), rel=1e-6)
    assert mesh.has_vertex_color()
    assert mesh.has_face_color()


def test_companions_open_in_meshlab(whole, through_api, meshlab):
    mould, fibres = (meshlab(whole.with_suffix(suffix)) for suffix in (".mould.ply", ".fibres.ply"))
    field = read_off(through_api, (0, 1, 0))
    np.testing.assert_allclose(mould.vertex_matrix(), field.vertices, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(mould.face_matrix(), field.triangles)
    shear = np.where(np.isnan(field.shear), 0.0, np.degrees(np.abs(field.shear)))
    np.testing.assert_allclose(mould.face_scalar_array(), shear, rtol=1e-5, atol=1e-6)
    ends = fibres.vertex_matrix()[fibres.edge_matrix()]
    chord = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert fibres.edge_number() > 100
    # facets meet at 4 degrees, strips past the border at more
    assert (chord <= SPACING * (1 + 1e-9)).all()
    assert (chord >= SPACING * 0.97).all()


def test_the_net_does_not_depend_on_threads_or_run(capfd, dome, tmp_path):
    files = []
    for threads in (1, 2):
        folder = tmp_path / str(threads)
        folder.mkdir()
        draped(capfd, dome, folder / "net.ply", "--spacing", 50, "--threads", threads)
        files.append([(folder / name).read_bytes() for name in ("net.ply", "net.fibres.ply")])
    assert files[0] == files[1]


def test_an_earlier_net_is_replaced(capfd, flat, tmp_path):
    (tmp_path / "net.ply").write_bytes(b"an earlier one")
    draped(capfd, flat, tmp_path / "net.ply", "--spacing", 20)
    assert meshdrape.read_net(tmp_path / "net.ply").fabric.spacing == 20
    assert sorted(path.name for path in tmp_path.iterdir()) == COMPANIONS[:-1]


# --- what is printed, and the exit code -------------------------------------------------------------------------------


def test_summary_for_people(capfd, flat, tmp_path):
    net = tmp_path / "net.ply"
    outcome = run(capfd, "drape", flat, "-o", net, "--spacing", 10, "--no-picture")
    assert (outcome.code, outcome.err) == (0, "")
    summary = json.loads(net.with_suffix(".json").read_text())
    for text in (
        f"{flat}, 200 x 140 x 0 mm, 126 triangles",
        f"{summary['nodes']:,} nodes, {summary['cells']:,} cells, spacing 10 mm",
        "coverage  100.00 % of the mould",
        "max shear  0.000 deg",
        "largest relative error",
    ):
        assert text in outcome.out
    for suffix in (".ply", ".mould.ply", ".fibres.ply", ".json"):
        assert f"wrote  {net.with_suffix(suffix)}\n" in outcome.out
    assert ".png" not in outcome.out


def test_json_on_stdout_is_the_file(capfd, flat, tmp_path):
    net = tmp_path / "net.ply"
    outcome = run(capfd, "drape", flat, "-o", net, "--spacing", 10, "--no-picture", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    assert json.loads(outcome.out) == json.loads(net.with_suffix(".json").read_text())


def test_lost_fabric_has_an_exit_code_of_its_own(capfd, tmp_path):
    """Cloth folds on a closed sphere before it is round it."""
    (tmp_path / "sphere.stl").write_bytes(binary_stl(icosphere(3)))
    net = tmp_path / "net.ply"
    summary = draped(capfd, tmp_path / "sphere.stl", net, "--spacing", 100, code=3)
    status = meshdrape.read_net(net).node_status
    folded = int((status == meshdrape.NodeStatus.FOLDED).sum())
    assert summary["statuses"]["FOLDED"] == folded > 0
    (warning,) = (warning for warning in summary["warnings"] if "FOLDED" in warning)
    assert warning.startswith(f"{folded} nodes FOLDED, first at node")
    assert summary["coverage_percent"] < 99
    outcome = run(capfd, "drape", tmp_path / "sphere.stl", "-o", net, "--spacing", 100, "--no-picture")
    assert outcome.code == 3
    assert f"WARNING  {warning}" in outcome.out


# --- the mould --------------------------------------------------------------------------------------------------------

COARSE = ("--spacing", 400, "--angle-tolerance", 1)


@pytest.mark.parametrize(
    ("faces", "ids"),
    [("1,2", [1, 2]), ("2,1,2", [1, 2]), ("wing,spar", [1, 2]), ("wing", [1]), ("%PLANE", [6, 7]), ("<Z", [4])],
)
def test_faces_by_id_name_and_selector(capfd, tmp_path, faces, ids):
    net = tmp_path / "net.ply"
    summary = draped(capfd, SAMPLES / "wing_spar_block.step", net, "--faces", faces, *COARSE)
    assert [face["id"] for face in summary["faces"]] == ids
    assert meshdrape.read_net(net).mould_faces == tuple(ids)
    areas = {1: 42294714.458, 2: 14173590.122, 4: 42e6, 6: 3.6e6, 7: 7_996_300.0}
    assert summary["mould"]["area_mm2"] == pytest.approx(sum(areas[face] for face in ids), rel=1e-4)


def test_parameters_of_a_mould_script(capfd, tmp_path):
    """Without deviation wing and spar make an origami fold: the net does not shear."""
    short = ("--spacing", 100, "--set", "span=3000", "--set", "chord=1000", "--set", "spar_height=500")
    sheared = draped(capfd, CAD / "wing_spar.py", tmp_path / "net.ply", *short, "--set", "c=0.3")
    assert sheared["max_shear_deg"] > 1
    folded = draped(capfd, CAD / "wing_spar.py", tmp_path / "net.ply", *short, "--set", "deviation=none")
    assert folded["max_shear_deg"] <= 2 * folded["mesh_noise_deg"] < 0.2
    assert folded["mould"]["size_mm"][1] == pytest.approx(3000)
    assert [face["max_shear_deg"] < 0.2 for face in folded["faces"]] == [True, True]


def test_script_of_a_few_lines(capfd, tmp_path):
    script = tmp_path / "plate.py"
    script.write_text(
        "import cadquery as cq\nlength = 100.0\nholes = 1\n"
        "plate = cq.Workplane().rect(length, 80).extrude(5)\n"
        "show_object(plate.faces('>Z'))\n"
    )
    summary = draped(capfd, script, tmp_path / "net.ply", "--spacing", 20, "--set", "length=300", "--set", "holes=2")
    assert summary["mould"]["size_mm"] == pytest.approx([300, 80, 0])
    assert "--set length=300" in summary["command"]


def test_unit_of_a_mesh(capfd, flat, tmp_path):
    summary = draped(capfd, flat, tmp_path / "net.ply", "--spacing", 10_000, "--unit", "m")
    assert summary["mould"]["unit"] == "m"
    assert summary["mould"]["size_mm"] == pytest.approx([200_000, 140_000, 0])
    assert summary["max_shear_deg"] < 1e-6


def test_a_torn_mesh_is_healed_on_request_alone(capfd, tmp_path):
    across = np.linspace(-70, 70, 8)
    left, right = (grid(x, across, lambda x, y: (x, y, 0.0)) for x in (np.linspace(-100, 0, 6), np.linspace(0, 100, 6)))
    tear = 1e-3
    halves = left.joined(right.moved(np.eye(3), (tear, 0, 0)))
    (tmp_path / "torn.stl").write_bytes(binary_stl(halves))
    start = ("--spacing", 10, "--seed", "-40,0,0")
    as_it_is = draped(capfd, tmp_path / "torn.stl", tmp_path / "net.ply", *start)
    assert as_it_is["mould"]["healing"] is None
    assert as_it_is["coverage_percent"] == pytest.approx(50, abs=1e-3)
    assert any("2 separate parts" in note for note in as_it_is["notes"])
    healed = draped(capfd, tmp_path / "torn.stl", tmp_path / "net.ply", *start, "--heal")
    assert healed["coverage_percent"] == pytest.approx(100)
    assert healed["mould"]["healing"]["moved"] <= 1.01 * tear


def test_tolerances_reach_the_tessellation(capfd, tmp_path):
    net = tmp_path / "net.ply"
    summary = draped(
        capfd, SAMPLES / "cylinder.step", net, "--spacing", 50, "--angle-tolerance", 3, "--chord-tolerance", 5
    )
    assert summary["mould"]["angle_tolerance_deg"] == pytest.approx(3)
    assert summary["mould"]["chord_tolerance_mm"] == 5
    assert summary["mould"]["triangles"] < 300


# --- the cloth and its start ------------------------------------------------------------------------------------------


def about_seed(stored, reach=8):
    """Positions and shear of the cells within so many cells of the seed."""
    i, j = stored.seed_index
    rows, columns = slice(i - reach, i + reach + 1), slice(j - reach, j + reach + 1)
    cells = slice(i - reach, i + reach), slice(j - reach, j + reach)
    return stored.node_position[rows, columns], stored.cell_shear[cells]


def test_flipped_normal_reverses_the_weft_and_the_sign_of_shear(capfd, dome, tmp_path):
    start = ("--spacing", SPACING, "--seed", words(SEED), "--direction", words(DIRECTION))
    draped(capfd, dome, tmp_path / "front.ply", *start)
    draped(capfd, dome, tmp_path / "back.ply", *start, "--flip-normal")
    front, back = (about_seed(meshdrape.read_net(tmp_path / name)) for name in ("front.ply", "back.ply"))
    np.testing.assert_allclose(back[0], front[0][:, ::-1], rtol=0, atol=1e-6)
    np.testing.assert_allclose(back[1], -front[1][:, ::-1], rtol=0, atol=1e-8)
    assert np.abs(front[1]).max() > 0.05


@pytest.mark.parametrize("angle", [60.0, 90.0, 115.0])
def test_initial_angle_and_direction(capfd, flat, tmp_path, angle):
    """On a plate warp and weft keep their angle, counter-clockwise about +z from warp to weft."""
    net = tmp_path / "net.ply"
    summary = draped(capfd, flat, net, "--spacing", "10,15", "--initial-angle", angle, "--direction", "3,4,0")
    stored = meshdrape.read_net(net)
    there = np.isfinite(stored.node_position[..., 0])
    np.testing.assert_allclose(stored.warp_direction[there] - [0.6, 0.8, 0], 0, atol=1e-9)
    turn = math.atan2(4, 3) + math.radians(angle)
    np.testing.assert_allclose(stored.weft_direction[there] - [math.cos(turn), math.sin(turn), 0], 0, atol=1e-9)
    steps = [np.diff(stored.node_position, axis=axis) for axis in (0, 1)]
    for step, length in zip(steps, (10, 15), strict=True):
        step = np.linalg.norm(step, axis=-1)
        np.testing.assert_allclose(step[np.isfinite(step)], length, rtol=1e-12)
    assert summary["fabric"] == {
        "spacing_mm": [10, 15],
        "initial_angle_deg": pytest.approx(angle),
        "locking_angle_deg": pytest.approx(7),
    }
    assert summary["cloth_mm"]["area_mm2"] == pytest.approx(summary["cells"] * 150 * math.sin(math.radians(angle)))


def test_locking_angle(capfd, dome, tmp_path):
    loose = draped(capfd, dome, tmp_path / "net.ply", "--spacing", SPACING, "--locking-angle", 60)
    assert loose["over_locking_percent"] == 0
    assert not any("locks" in warning for warning in loose["warnings"])
    tight = draped(capfd, dome, tmp_path / "net.ply", "--spacing", SPACING, "--locking-angle", 0.01)
    assert tight["over_locking_percent"] > 90
    assert any("no cloth locks at 0.01 degrees; were 0.573 meant" in warning for warning in tight["warnings"])
    assert not any("no cloth locks" in warning for warning in loose["warnings"])


def test_extent_bounds_the_cloth(capfd, flat, tmp_path):
    net = tmp_path / "net.ply"
    summary = draped(
        capfd, flat, net, "--spacing", 10, "--seed", "0,0,0", "--direction", "1,0,0", "--extent", "60,30,0,20"
    )
    stored = meshdrape.read_net(net)
    i, j = np.nonzero(stored.node_status == meshdrape.NodeStatus.PLACED)
    i, j = i - stored.seed_index[0], j - stored.seed_index[1]
    assert (i.min(), i.max(), j.min(), j.max()) == (-6, 3, 0, 2)
    assert summary["nodes"] == 10 * 3
    assert summary["cloth_mm"] == {"warp": 90, "weft": 20, "area_mm2": pytest.approx(1800)}
    assert summary["coverage_percent"] == pytest.approx(100 * 1800 / 28000, abs=1)


@pytest.mark.parametrize(("reference", "angle"), [("1,0,0", 30), ("0,1,0", -60), ("0,2,5", -60)])
def test_fibre_angles_are_told_from_the_reference(capfd, flat, tmp_path, reference, angle):
    """Right-hand about the normal, from the reference projected on the mould."""
    direction = f"{math.cos(math.radians(30))},{math.sin(math.radians(30))},0"
    summary = draped(
        capfd, flat, tmp_path / "net.ply", "--spacing", 10, "--direction", direction, "--reference", reference
    )
    # a fibre has no sense: from -90 to 90 degrees
    for name, expected in (("warp_angle_deg", angle), ("weft_angle_deg", angle - 90 if angle > 0 else angle + 90)):
        found = summary[name]
        assert (found["min"], found["mean"], found["max"]) == pytest.approx((expected,) * 3, abs=1e-6)


def test_angles_across_the_reference_are_not_cut_at_a_right_angle(capfd, dome, tmp_path):
    """The same cloth, counted from an axis along it and from one across it: the range turns with the axis."""
    start = ("--spacing", SPACING, "--seed", "50,30,990", "--direction", "1,0,0")
    along = draped(capfd, dome, tmp_path / "net.ply", *start, "--reference", "1,0,0")["warp_angle_deg"]
    weft = draped(capfd, dome, tmp_path / "net.ply", *start, "--reference", "1,0,0")["weft_angle_deg"]
    assert along["min"] < along["mean"] < along["max"] < along["min"] + 90
    assert 45 < weft["min"] < weft["mean"] < 90 < weft["max"] < 135 or -135 < weft["min"] < -90 < weft["max"] < -45


def test_seed_off_the_mould_is_projected_and_the_distance_told(capfd, flat, tmp_path):
    summary = draped(capfd, flat, tmp_path / "net.ply", "--spacing", 10, "--seed", "20,10,7.5")
    assert summary["seed_distance_mm"] == pytest.approx(7.5, abs=1e-6)
    assert summary["seed"] == pytest.approx([20, 10, 0], abs=1e-6)
    (warning,) = summary["warnings"]
    assert "7.5 mm off the mould" in warning
    on = draped(capfd, flat, tmp_path / "net.ply", "--spacing", 10, "--seed", "20,10,0")
    assert on["warnings"] == []
    outcome = run(
        capfd, "drape", flat, "-o", tmp_path / "net.ply", "--spacing", 10, "--seed", "20,10,7.5", "--no-picture"
    )
    assert outcome.code == 0
    assert f"WARNING  {warning}" in outcome.out


def test_engine_of_reference_agrees_with_the_fast_one(capfd, dome, tmp_path):
    few = ("--spacing", SPACING, "--extent", "120,120,120,120")
    for engine in ("fast", "libigl"):
        draped(capfd, dome, tmp_path / f"{engine}.ply", *few, "--engine", engine)
    fast, libigl = (meshdrape.read_net(tmp_path / f"{engine}.ply") for engine in ("fast", "libigl"))
    np.testing.assert_array_equal(fast.node_status, libigl.node_status)
    np.testing.assert_allclose(fast.node_position, libigl.node_position, rtol=0, atol=1e-9 * SPACING)
