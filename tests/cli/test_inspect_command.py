"""meshdrape inspect: what it lists of a B-rep and of a mesh."""

from __future__ import annotations

import json

import numpy as np
import pytest
from command import CAD, SAMPLES, run
from meshfiles import binary_stl, obj
from moulds import Mesh, plate

import meshdrape


def inspected(capfd, *words):
    outcome = run(capfd, "inspect", *words, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    return json.loads(outcome.out)


def test_every_face_of_a_closed_solid(capfd):
    facts = inspected(capfd, SAMPLES / "wing_spar_block.step")
    assert facts["closed_solid"]
    assert [face["id"] for face in facts["faces"]] == [1, 2, 3, 4, 5, 6, 7]
    assert [face["name"] for face in facts["faces"]] == ["wing", "spar", "skirt", "floor", "back", "root", "tip"]
    assert [face["kind"] for face in facts["faces"]] == ["BSPLINE"] * 5 + ["PLANE"] * 2
    assert all(face["developable"] for face in facts["faces"])
    wing, spar, _, floor, *_, root, tip = facts["faces"]
    # areas of the exact facts in the docstring of cad/wing_spar.py
    assert wing["area_mm2"] == pytest.approx(42294714.458, rel=1e-6)
    assert spar["area_mm2"] == pytest.approx(14173590.122, rel=1e-6)
    assert floor["area_mm2"] == pytest.approx(3000 * 14000, rel=1e-9)
    np.testing.assert_allclose(floor["normal"], [0, 0, -1], atol=1e-9)
    np.testing.assert_allclose([root["normal"], tip["normal"]], [[0, -1, 0], [0, 1, 0]], atol=1e-9)
    assert wing["normal"][2] > 0.9
    assert spar["normal"][0] < -0.9
    beside = {face["id"]: face["neighbours"] for face in facts["faces"]}
    assert beside[1] == [2, 5, 6, 7]
    assert all(face in beside[other] for face in beside for other in beside[face])
    assert facts["mesh_noise_deg"] < 0.35
    assert facts["faults"] == []


def test_the_list_for_people_says_the_same(capfd):
    facts = inspected(capfd, SAMPLES / "wing_spar_block.step")
    outcome = run(capfd, "inspect", SAMPLES / "wing_spar_block.step")
    assert (outcome.code, outcome.err) == (0, "")
    assert "a closed solid: choose the faces" in outcome.out
    rows = outcome.out.splitlines()[-7:]
    for row, face in zip(rows, facts["faces"], strict=True):
        words = row.split()
        assert words[:4] == [str(face["id"]), face["name"], face["kind"], f"{face['area_mm2']:,.0f}"]
        assert words[-2:] == [",".join(map(str, face["neighbours"])), "yes"]


def test_open_shell(capfd):
    facts = inspected(capfd, SAMPLES / "hypar.step")
    assert not facts["closed_solid"]
    assert [face["developable"] for face in facts["faces"]] == [False]
    mould = meshdrape.read_mould(SAMPLES / "hypar.step")
    assert facts["triangles"] == len(mould.triangles)
    assert facts["size_mm"] == pytest.approx(mould.size.tolist())
    assert facts["area_mm2"] == pytest.approx(mould.surface.face_area.sum())
    assert facts["angle_tolerance_deg"] == pytest.approx(0.2)
    assert facts["chord_tolerance_mm"] == pytest.approx(0.1)


def test_tolerances_and_parameters(capfd):
    script = CAD / "cylinder.py"
    coarse = inspected(capfd, script, "--angle-tolerance", "5", "--chord-tolerance", "50")
    fine = inspected(capfd, script)
    assert coarse["triangles"] < fine["triangles"] / 10
    assert coarse["angle_tolerance_deg"] == pytest.approx(5)
    wing = inspected(capfd, CAD / "wing_spar.py", "--set", "span=2000", "--set", "spar_height=300")
    assert wing["size_mm"][1] == pytest.approx(2000)


def test_sound_mesh(capfd, tmp_path):
    file = tmp_path / "plate.stl"
    file.write_bytes(binary_stl(plate()))
    facts = inspected(capfd, file, "--unit", "m")
    assert facts["size_mm"] == pytest.approx([200_000, 140_000, 0])
    assert facts["triangles"] == len(plate().triangles)
    assert (facts["faces"], facts["faults"], facts["closed_solid"]) == ([], [], False)
    assert facts["chord_tolerance_mm"] is None
    outcome = run(capfd, "inspect", file)
    assert (outcome.code, outcome.err) == (0, "")
    assert "  triangles   126\n" in outcome.out


def test_faults_of_a_mesh_are_counted_and_placed(capfd, tmp_path):
    mesh = plate()
    fin = Mesh(np.vstack([mesh.vertices, [[0, 0, 90.0]]]), np.vstack([mesh.triangles, [[12, 20, len(mesh.vertices)]]]))
    file = tmp_path / "fin.obj"
    file.write_bytes(obj(fin))
    outcome = run(capfd, "inspect", file, "--json")
    assert outcome.code == 2
    assert outcome.err == f"meshdrape: {file} cannot be draped as it is: repair it with --heal, or in CAD\n"
    (fault,) = json.loads(outcome.out)["faults"]
    assert fault["count"] == 1
    assert "non-manifold" in fault["kind"]
    np.testing.assert_allclose(fault["first_at"], mesh.vertices[[12, 20]].mean(axis=0), atol=1e-6)
    assert f"FAULT       1 x {fault['kind']}" in run(capfd, "inspect", file).out
