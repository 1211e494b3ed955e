"""The scripts that come with the package: found, described, run, tessellated."""

from __future__ import annotations

import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from meshdrape.errors import FileError, MouldError, SelectionError
from meshdrape.mould.cad import library
from meshdrape.mould.cad.library import build_script, build_shape, script, scripts

CAD = Path(__file__).resolve().parents[2] / "cad"


def test_every_script_that_shows_something_is_a_mould():
    assert set(scripts()) == {path.stem for path in CAD.glob("*.py")} - {"make_samples"}
    assert len(scripts()) >= 16
    assert all(found.path == CAD / f"{name}.py" for name, found in scripts().items())


@pytest.mark.parametrize("name", sorted(path.stem for path in CAD.glob("*.py") if path.stem != "make_samples"))
def test_parameters_are_those_the_gateway_sets_each_with_its_meaning(name):
    from cadquery import cqgi

    described = script(name)
    offered = cqgi.parse(described.text).metadata.parameters
    assert {one.name: one.default for one in described.parameters} == {
        key: value.default_value for key, value in offered.items()
    }
    assert all(one.meaning for one in described.parameters)
    assert described.summary.endswith(".")


@pytest.mark.parametrize(
    ("default", "word", "value"),
    [
        (1.0, "2", 2.0),
        (1, "2", 2),
        (1, "2.5", 2.5),
        (False, "yes", True),
        (True, "no", False),
        ("a", "2", "2"),
        (1.0, 3, 3),
    ],
)
def test_words_become_values_of_the_type_of_the_default(default, word, value):
    found = library.Parameter("c", default, "").value(word)
    assert (found, type(found)) == (value, type(value))


def test_wing_and_spar_from_numbers():
    mould = build_script("wing_spar", {"deviation": "sine", "c": 50.0, "wavelength": 3500})
    assert [face.name for face in mould.cad_faces] == ["wing", "spar"]
    assert all(face.developable for face in mould.cad_faces)
    wing, spar = (np.unique(mould.triangles[mould.triangle_face == face.id]) for face in mould.cad_faces)
    x, y, z = mould.vertices.T
    g_w = 0.047227544 * y + 0.220721648 * 3731.291642 * (1 - np.exp(-y / 3731.291642))
    g_s = g_w + 50 * np.sin(2 * np.pi * y / 3500)
    assert np.abs(z - g_w)[wing].max() < 1e-4
    assert np.abs(x - g_s)[spar].max() < 1e-4
    assert mould.source == CAD / "wing_spar.py"
    assert len(mould.sha256) == 64


def test_wing_of_fourteen_metres_is_made_within_a_second():
    build_script("wing_spar")  # imports
    begun = time.process_time()
    build_script("wing_spar", {"c": 0.12})
    assert time.process_time() - begun < 1


def test_tables_may_be_sequences():
    """A pair of sequences makes what its text makes, to the last bit."""
    y, g = np.array([0, 5e3, 9e3, 14e3]), np.array([0, 100 / 3, 90.5, 200])
    text = ",".join(f"{at!r}:{value!r}" for at, value in zip(y.tolist(), g.tolist(), strict=True))
    by_sequence = build_script("wing_spar", {"deviation": "table", "deviation_table": (y, g)})
    by_text = build_script("wing_spar", {"deviation": "table", "deviation_table": text})
    np.testing.assert_array_equal(by_sequence.vertices, by_text.vertices)
    assert len(np.unique(by_sequence.vertices, axis=0)) > 100


def test_c_section_has_developable_sides():
    mould = build_script(
        "wing_spar", {"rear_spar": True, "span": 2000, "spar_height": 300, "fillet_radius": 50}, 1, 0.02
    )
    kinds = {face.name: face.developable for face in mould.cad_faces}
    assert kinds == {"wing": True, "spar": True, "rear_spar": True, "fillet": False, "rear_fillet": False}


def test_tolerances_are_passed_on():
    coarse, fine = (build_script("cylinder", None, 1.0, np.radians(angle)) for angle in (5.0, 1.0))
    assert len(fine.triangles) > 3 * len(coarse.triangles)
    with pytest.raises(MouldError, match="chord tolerance"):
        build_script("cylinder", None, -1.0)


@pytest.mark.parametrize(
    ("name", "parameters", "words"),
    [
        ("wing", None, ["no mould is called 'wing'", "wing_spar", "cylinder"]),
        ("make_samples", None, ["no mould is called"]),
        ("wing_spar", {"lenght": 3}, ["mould wing_spar has no parameter 'lenght'", "span, chord"]),
        ("wing_spar", {"span": 14}, ["mould wing_spar: span=14: lengths are in mm"]),
        ("wing_spar", {"span": "long"}, ["mould wing_spar: span=long is not a number"]),
        ("wing_spar", {"deviation_table": 3}, ["3 is neither a word nor a table"]),
        ("wing_spar", {"deviation_table": ([0, 1], [2])}, ["two sequences (y, g) of as many numbers"]),
        ("wing_spar", {"c": float("nan")}, ["mould wing_spar: c=nan is not a finite number"]),
        ("pyramid", {"slant": "inf"}, ["mould pyramid: slant=inf is not a finite number"]),
        ("pyramid", {"sides": 2}, ["mould pyramid: sides=2: must be a whole number, at least 3"]),
    ],
)
def test_failures_are_told_in_one_line(name, parameters, words):
    with pytest.raises(FileError) as caught:
        build_shape(name, parameters)
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_block_is_a_closed_solid():
    with pytest.raises(SelectionError, match="mould wing_spar is a closed solid of 7 faces"):
        build_script("wing_spar", {"block": True})


def test_scripts_are_found_where_a_wheel_puts_them(tmp_path, monkeypatch):
    """Away from the sources: beside the package (pip install --target), or where its record says."""
    package = tmp_path / "site" / "meshdrape" / "mould" / "cad"
    package.mkdir(parents=True)
    monkeypatch.setattr(library, "__file__", str(package / "library.py"))
    monkeypatch.setattr(library.metadata, "distributions", lambda name: [])
    with pytest.raises(FileError, match=r"not beside .* nor installed; install meshdrape anew"):
        library.script_folder()

    prefix = tmp_path.joinpath("prefix", *library.INSTALLED)
    shutil.copytree(CAD, prefix, ignore=shutil.ignore_patterns("__pycache__"))

    class Recorded:
        files = (type("File", (), {"locate": lambda self: prefix / "cone.py"})(),)

    monkeypatch.setattr(library.metadata, "distributions", lambda name: [type("Bare", (), {"files": None}), Recorded])
    assert library.script_folder() == prefix.resolve()
    assert set(scripts()) == {path.stem for path in CAD.glob("*.py")} - {"make_samples"}

    target = tmp_path.joinpath("site", *library.INSTALLED)
    shutil.copytree(prefix, target)
    assert library.script_folder() == target.resolve()
    assert build_script("cone").source == target.resolve() / "cone.py"


def test_wheel_packs_the_scripts():
    """The folder of the project file's data is the one looked for."""
    import tomllib

    project = tomllib.loads((CAD.parent / "pyproject.toml").read_text())
    assert project["tool"]["setuptools"]["data-files"] == {"/".join(library.INSTALLED): ["cad/*.py"]}
