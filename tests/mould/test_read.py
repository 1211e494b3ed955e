"""read_mould(): every CAD format, its units, and files that are not what their name says."""

from __future__ import annotations

import hashlib
import re

import cadquery as cq
import numpy as np
import pytest
from brep_shapes import SAMPLES
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

import meshdrape
from meshdrape import MeshdrapeError, read_mould
from meshdrape.errors import FileError, MouldError, SelectionError


def tray() -> cq.Shape:
    """Five sides of a box of 100 x 80 x 20 mm, rounded: an open shell."""
    box = cq.Workplane().box(100, 80, 20).edges("|Z").fillet(8)
    return cq.Shell.makeShell(box.faces("not >Z").vals())


def write_step(shape, path, unit="MM"):
    """CadQuery's writer always states mm; Open CASCADE's asks this."""
    Interface_Static.SetCVal_s("write.step.unit", unit)
    try:
        writer = STEPControl_Writer()
        writer.Transfer(shape.wrapped, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(str(path))
    finally:
        Interface_Static.SetCVal_s("write.step.unit", "MM")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    for suffix in (".step", ".stp", ".STEP"):
        write_step(tray(), folder / f"tray{suffix}")
    for suffix in (".brep", ".brp"):
        tray().exportBrep(str(folder / f"tray{suffix}"))
    return folder


@pytest.mark.parametrize("suffix", [".step", ".stp", ".STEP", ".brep", ".brp"])
def test_formats_agree(files, suffix):
    path = files / f"tray{suffix}"
    mould = read_mould(path)
    assert mould.size == pytest.approx([100, 80, 20], abs=1e-6)
    assert mould.surface.area == pytest.approx(tray().Area(), rel=1e-5)
    assert len(mould.cad_faces) == 9
    assert mould.source == path
    assert mould.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert mould.unit == "mm"
    first = read_mould(files / "tray.step")
    assert sorted(face.area for face in mould.cad_faces) == pytest.approx(sorted(f.area for f in first.cad_faces))


@pytest.mark.parametrize(("unit", "word"), [("INCH", "INCH"), ("M", "METRE"), ("CM", "CENTI"), ("FT", "FOOT")])
def test_step_comes_in_mm_whatever_its_unit(tmp_path, unit, word):
    path = tmp_path / "tray.step"
    write_step(tray(), path, unit)
    assert word in path.read_text()
    mould = read_mould(path)
    assert mould.size == pytest.approx([100, 80, 20], abs=1e-5)
    assert mould.unit == "mm"


def test_unit_of_an_inch_file_holds_inches(tmp_path):
    """The file of the test above really has other numbers in it."""
    write_step(tray(), tmp_path / "tray.step", "INCH")
    numbers = re.findall(r"CARTESIAN_POINT\('',\((-?[\d.]+),[^,)]+,[^,)]+\)", (tmp_path / "tray.step").read_text())
    assert max(map(float, numbers)) == pytest.approx(50 / 25.4)


def test_every_sample_is_read():
    for path in sorted(SAMPLES.glob("*.step")):
        if path.stem == "wing_spar_block":
            with pytest.raises(SelectionError):
                read_mould(path)
        else:
            assert read_mould(path, chord_tolerance=5, angle_tolerance=0.1).surface.n_components == 1


def test_step_and_stl_of_a_sample_agree():
    for name in ("wing_spar", "cube_corner", "cone"):
        step, stl = (read_mould(SAMPLES / f"{name}.{suffix}") for suffix in ("step", "stl"))
        np.testing.assert_allclose(step.bounds, stl.bounds, atol=0.5)
        assert step.surface.area == pytest.approx(stl.surface.area, rel=1e-3)


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"unit": "inch"}, FileError, "--unit"),
        ({"heal": True}, FileError, "--heal"),
        ({"parameters": {"a": 1}}, FileError, "--set"),
        ({"faces": "99"}, SelectionError, "no face 99"),
        ({"chord_tolerance": -1.0}, MouldError, "chord tolerance"),
    ],
)
def test_option_that_does_not_go_with_a_step_file(files, options, error, words):
    path = files / "tray.step"
    with pytest.raises(error) as caught:
        read_mould(path, **options)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["mould.iges", "mould", "mould.step.txt", ".step"])
def test_unknown_suffix(tmp_path, name):
    (tmp_path / name).write_text("x")
    with pytest.raises(FileError, match=r"a mould is one of \.step \.stp \.brep"):
        read_mould(tmp_path / name)


def test_curves_alone_are_no_mould(tmp_path):
    write_step(cq.Edge.makeCircle(10), tmp_path / "a.step")
    cq.Edge.makeCircle(10).exportBrep(str(tmp_path / "a.brep"))
    for path in tmp_path.iterdir():
        with pytest.raises(FileError, match="has no faces, only curves or points"):
            read_mould(path)


def explained(path, capfd) -> str:
    """The one line of the error that reading a file raises; nothing is printed, not even from C++."""
    with pytest.raises(MeshdrapeError) as caught:
        read_mould(path)
    assert capfd.readouterr() == ("", "")
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    return message


@pytest.mark.parametrize("share", [0.001, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.97])
@pytest.mark.parametrize("suffix", [".step", ".brep"])
def test_truncated(files, tmp_path, capfd, suffix, share):
    content = (files / f"tray{suffix}").read_bytes()
    path = tmp_path / f"cut{suffix}"
    path.write_bytes(content[: max(1, int(share * len(content)))])
    assert "export it anew" in explained(path, capfd)


@pytest.mark.parametrize("suffix", [".step", ".brep"])
@pytest.mark.parametrize("seed", range(6))
def test_noise(files, tmp_path, capfd, suffix, seed):
    """Noise from the first byte on, or after a head that promises a good file."""
    generator = np.random.default_rng(seed)
    content = (files / f"tray{suffix}").read_bytes()
    head = content[: [0, 20, 200][seed % 3]]
    path = tmp_path / f"noise{suffix}"
    path.write_bytes(head + generator.bytes(2000))
    explained(path, capfd)


def test_text_of_another_kind(tmp_path, capfd):
    for suffix in (".step", ".brep"):
        path = tmp_path / f"a{suffix}"
        path.write_text("Dear colleague,\nattached the mould.\n")
        explained(path, capfd)


def test_reading_is_quiet(files, capfd):
    read_mould(files / "tray.step")
    read_mould(files / "tray.brep")
    assert capfd.readouterr() == ("", "")
    assert meshdrape.read_mould is read_mould
