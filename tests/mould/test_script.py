"""A CadQuery script as a mould: parameters by name, what it shows, and how it fails."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meshdrape import read_mould
from meshdrape.errors import FileError, SelectionError

CAD = Path(__file__).resolve().parents[2] / "cad"
PLATE = """\
import cadquery as cq

length = 100.0
count = 2
kind = "plain"
rounded = False

assert kind in ("plain", "fancy"), kind
plate = cq.Workplane().rect(length if not rounded else 7.0, 80).extrude(count)
"""


def script(folder, text):
    path = folder / "mould.py"
    path.write_text(text)
    return path


@pytest.mark.parametrize(
    "show",
    ["show_object(plate.faces('>Z'))", "show_object(plate.faces('>Z').val())", "show_object(plate.val().Faces()[5])"],
)
def test_what_is_shown_is_the_mould(tmp_path, show):
    mould = read_mould(script(tmp_path, PLATE + show))
    assert mould.size == pytest.approx([100, 80, 0])
    assert len(mould.cad_faces) == 1
    assert mould.source == tmp_path / "mould.py"


def test_all_that_is_shown_is_one_mould(tmp_path):
    path = script(tmp_path, PLATE + "show_object(plate.faces('>Z'))\nshow_object(plate.faces('>X'))\n")
    mould = read_mould(path)
    assert len(mould.cad_faces) == 2
    assert mould.size == pytest.approx([100, 80, 2])


def test_assembly(tmp_path):
    path = script(tmp_path, PLATE + "show_object(cq.Assembly(plate, loc=cq.Location((10, 20, 30))))\n")
    mould = read_mould(path, ">Z")
    np.testing.assert_allclose(mould.bounds, [[-40, -20, 32], [60, 60, 32]], atol=1e-9)


@pytest.mark.parametrize(
    ("parameters", "size"),
    [
        ({"length": "250"}, [250, 80, 2]),
        ({"length": 250.0}, [250, 80, 2]),
        ({"count": "5"}, [100, 80, 5]),
        ({"kind": "fancy", "length": "1e2"}, [100, 80, 2]),
        ({"rounded": "yes"}, [7, 80, 2]),
        ({"rounded": "False"}, [100, 80, 2]),
        ({"rounded": True, "count": 3}, [7, 80, 3]),
    ],
)
def test_parameters(tmp_path, parameters, size):
    path = script(tmp_path, PLATE + "show_object(plate)\n")
    assert read_mould(path, "1,2,3,4,5,6", parameters=parameters).size == pytest.approx(size)


def test_solid_needs_a_choice_and_takes_selectors(tmp_path):
    path = script(tmp_path, PLATE + "show_object(plate)\n")
    with pytest.raises(SelectionError, match="closed solid of 6 faces"):
        read_mould(path)
    assert len(read_mould(path, "|Z").cad_faces) == 2


@pytest.mark.parametrize(
    ("text", "parameters", "words"),
    [
        (
            PLATE + "show_object(plate)",
            {"lenght": "3"},
            ["no parameter 'lenght'", "length=100.0", "count=2", "kind=plain"],
        ),
        ("x = [1, 2]\n", {"x": "3"}, ["no parameter 'x'", "it has none"]),
        (PLATE + "show_object(plate)", {"length": "long"}, ["length=long is not a number", "100.0"]),
        (PLATE + "show_object(plate)", {"rounded": "maybe"}, ["rounded=maybe is not true or false"]),
        (PLATE + "show_object(plate)", {"kind": "odd"}, ["line 8", "AssertionError: odd"]),
        (PLATE, None, ["shows no shape", "show_object(shape)"]),
        (PLATE + "show_object(plate.edges('|Z'))", None, ["no faces, only curves"]),
        (PLATE + "show_object(3.5)", None, ["shows no shape"]),
        (PLATE + "show_object(cq.Workplane())", None, ["show_object(shape)"]),
        (PLATE + "1 / 0\n", None, ["line 10", "ZeroDivisionError"]),
        ("def f():\n    raise OSError('a\\nb')\n\n\nf()\n", None, ["line 2", "OSError: a b"]),
        ("import nothing_of_the_name\n", None, ["line 1", "nothing_of_the_name"]),
        ("length = = 3\n", None, ["line 1", "not a Python script"]),
        ("", None, ["is empty"]),
        ("# nothing but words\n", None, ["shows no shape"]),
        ("\x00", None, ["not a Python script"]),
    ],
)
def test_failures_are_told_in_one_line(tmp_path, capfd, text, parameters, words):
    path = script(tmp_path, text)
    with pytest.raises(FileError) as caught:
        read_mould(path, parameters=parameters)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    for word in words:
        assert word in message
    assert capfd.readouterr() == ("", "")


def test_bytes_that_are_no_text(tmp_path):
    (tmp_path / "mould.py").write_bytes(b"\xff\xfe\x00length")
    with pytest.raises(FileError, match="not a Python script"):
        read_mould(tmp_path / "mould.py")


def test_moulds_of_the_repository_take_their_parameters():
    mould = read_mould(CAD / "wing_spar.py", parameters={"span": "3000", "chord": "1000", "fillet_radius": "20"})
    assert mould.size[1] == pytest.approx(3000)
    assert len(mould.cad_faces) == 3
    assert mould.surface.n_components == 1
