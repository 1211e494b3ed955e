"""meshdrape mould: lists, parameters, files read back, bad input."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from command import CAD, ROOT, run

import meshdrape
from meshdrape.mould.cad.shape import read_step


def made(capfd, *words):
    outcome = run(capfd, "mould", *words, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    return json.loads(outcome.out)


@pytest.mark.parametrize("words", [(), ("--list",)])
def test_list(capfd, words):
    outcome = run(capfd, "mould", *words)
    assert (outcome.code, outcome.err) == (0, "")
    rows = dict(line.split(maxsplit=1) for line in outcome.out.splitlines())
    assert set(rows) == {path.stem for path in CAD.glob("*.py")} - {"make_samples"}
    assert rows["cube_corner"].startswith("Cube corner: the three faces of a cube")
    assert made(capfd, *words) == rows


def test_parameters(capfd):
    outcome = run(capfd, "mould", "cone", "--parameters")
    assert (outcome.code, outcome.err) == (0, "")
    head, *rows = outcome.out.splitlines()
    assert head.startswith("Cone: ")
    assert rows[1].split(maxsplit=1) == ["slant_from=300.0", "distance from the apex to the small rim, along a ruling"]
    facts = made(capfd, "cone", "--parameters")
    assert [one["name"] for one in facts["parameters"]] == ["half_angle_deg", "slant_from", "slant_to", "arc_deg"]
    assert facts["parameters"][0]["default"] == 25


def test_step_keeps_what_was_set_and_the_names(capfd, tmp_path):
    file = tmp_path / "wing.step"
    facts = made(capfd, "wing_spar", "--set", "deviation=sine", "--set", "c=50", "--set", "wavelength=3500", "-o", file)
    shape = read_step(file)
    assert shape.names == ("wing", "spar")
    assert [face["name"] for face in facts["faces"]] == ["wing", "spar"]
    assert all(face["developable"] for face in facts["faces"])
    assert facts["parameters"]["c"] == 50
    assert facts["parameters"]["deviation"] == "sine"
    assert facts["parameters"]["span"] == 14000
    assert facts["triangles"] is None
    assert facts["file"] == str(file)
    assert facts["area_mm2"] == pytest.approx(sum(face.Area() for face in shape.faces), rel=1e-9)
    mould = meshdrape.read_mould(file)
    assert facts["size_mm"] == pytest.approx(mould.size.tolist(), abs=1e-3)
    y = mould.vertices[:, 1]
    g_w = 0.047227544 * y + 0.220721648 * 3731.291642 * (1 - np.exp(-y / 3731.291642))
    spar = np.unique(mould.triangles[mould.triangle_face == 2])
    assert np.abs(mould.vertices[:, 0] - g_w - 50 * np.sin(2 * np.pi * y / 3500))[spar].max() < 1e-4
    assert list(tmp_path.iterdir()) == [file]


def test_file_drapes_as_the_script_does(capfd, tmp_path):
    """Through STEP and straight from the script: the same nodes on the same faces, if in another order."""
    file = tmp_path / "corner.stp"
    made(capfd, "l_corner", "--set", "concave=yes", "--set", "radius=15", "-o", file)
    by_file = meshdrape.read_mould(file)
    by_script = meshdrape.read_mould(CAD / "l_corner.py", parameters={"concave": True, "radius": 15.0})
    assert [face.name for face in by_file.cad_faces] == [face.name for face in by_script.cad_faces]
    for face in (1, 2, 3):
        read, meant = (
            np.unique(
                mould.vertices[mould.triangles[mould.triangle_face == face]].reshape(-1, 3).round(6) + 0.0, axis=0
            )
            for mould in (by_file, by_script)
        )
        np.testing.assert_allclose(read, meant, atol=1.5e-6)
    normal = by_file.surface.face_normal[by_file.triangle_face == 1]
    np.testing.assert_allclose(normal, np.tile([0, 0, -1.0], (len(normal), 1)), atol=1e-12)


def test_stl_is_our_own_tessellation(capfd, tmp_path):
    file = tmp_path / "cylinder.stl"
    words = ("--set", "radius=300", "--chord-tolerance", "0.5", "--angle-tolerance", "3")
    facts = made(capfd, "cylinder", *words, "-o", file)
    read = meshdrape.read_mould(file)
    meant = meshdrape.read_mould(
        CAD / "cylinder.py", parameters={"radius": 300}, chord_tolerance=0.5, angle_tolerance=np.radians(3)
    )
    assert facts["triangles"] == len(read.triangles) == len(meant.triangles)
    np.testing.assert_allclose(
        read.vertices[read.triangles], meant.vertices[meant.triangles], rtol=0, atol=300 * 2.0**-20
    )
    assert len(read.vertices) == len(meant.vertices)  # common vertices are common in the file
    finer = made(capfd, "cylinder", "--set", "radius=300", "-o", file)
    assert finer["triangles"] > 2 * facts["triangles"]


def test_brep_and_block(capfd, tmp_path):
    brep, stl = tmp_path / "block.brep", tmp_path / "block.stl"
    for file in (brep, stl):
        facts = made(capfd, "wing_spar", "--set", "block=true", "-o", file)
        assert [face["name"] for face in facts["faces"]] == ["wing", "spar", "skirt", "floor", "back", "root", "tip"]
    mould = meshdrape.read_mould(brep, faces=">Z or <X")
    assert [round(face.area) for face in mould.cad_faces] == [round(face["area_mm2"]) for face in facts["faces"][:2]]
    closed = meshdrape.read_mould(stl)
    assert closed.surface.area == pytest.approx(facts["area_mm2"], rel=1e-4)


def test_report_for_people(capfd, tmp_path):
    file = tmp_path / "cube.step"
    outcome = run(capfd, "mould", "cube_corner", "-o", file)
    assert (outcome.code, outcome.err) == (0, "")
    assert "cube_corner: 1,000.0 x 1,000.0 x 1,000.0 mm, area 3 m2" in outcome.out
    assert outcome.out.count("unrolls") == 3
    assert outcome.out.splitlines()[-1].endswith(str(file))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["nope", "-o", "a.step"], ["no mould is called 'nope'", "cone, cube_corner", "wing_spar"]),
        (["nope", "--parameters"], ["no mould is called 'nope'"]),
        (
            ["cone", "--set", "size=3", "-o", "a.step"],
            ["mould cone has no parameter 'size'", "half_angle_deg, slant_from"],
        ),
        (["cone", "--set", "size", "-o", "a.step"], ["--set size: give NAME=VALUE"]),
        (["cone", "--set", "arc_deg=wide", "-o", "a.step"], ["mould cone: arc_deg=wide is not a number", "240"]),
        (["cone", "--set", "arc_deg=400", "-o", "a.step"], ["mould cone: arc_deg=400.0: must lie between"]),
        (["wing_spar", "--set", "span=14", "-o", "a.step"], ["span=14.0: lengths are in mm", "give 14000"]),
        (
            ["wing_spar", "--set", "wing_profile=naca", "-o", "a.step"],
            ["'naca' is not known: real, flat, quadratic, arc"],
        ),
        (["wing_spar", "--set", "block=maybe", "-o", "a.step"], ["block=maybe is not true or false"]),
        (["cone", "-o", "a.obj"], ["a.obj has the suffix .obj", ".step .stp .brep .brp .stl"]),
        (["cone", "-o", "a"], ["the suffix (none)"]),
        (["cone", "-o", "nowhere/a.step"], ["the folder", "does not exist"]),
        (["cone", "--chord-tolerance", "0", "-o", "a.stl"], ["chord tolerance 0 mm must be a positive length"]),
        (["cone"], ["where to? give -o cone.step"]),
        (["-o", "a.step"], ["which mould? give one of blade_root"]),
        (["--parameters"], ["which mould?"]),
    ],
)
def test_bad_input_is_one_line_and_leaves_no_file(capfd, tmp_path, monkeypatch, words, told):
    monkeypatch.chdir(tmp_path)
    outcome = run(capfd, "mould", *words)
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.count("\n") == 1
    for word in told:
        assert word in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_lists_without_cadquery():
    """What there is is told without the seconds that importing a CAD kernel takes."""
    code = "import sys; from meshdrape.cli.main import main; main(['mould', 'cone', '--parameters']); main(['mould']); "
    code += "assert not {'cadquery', 'OCP', 'numba', 'scipy'} & set(sys.modules), 'a heavy library'"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=ROOT)
    assert (done.returncode, done.stderr) == (0, "")
