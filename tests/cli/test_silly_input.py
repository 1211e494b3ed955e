"""No case is too silly: pipes, rings of links, names of any bytes, numbers beyond all measure, closed outputs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from command import ROOT, run
from meshfiles import binary_stl, obj, off, text_ply
from moulds import Mesh, plate

PLATE = plate()
READERS = {"drape": ("mould.stl", "-o", "net.ply", "--spacing", "20"), "inspect": ("mould.stl",)}


@pytest.fixture
def folder(monkeypatch, tmp_path) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mould.stl").write_bytes(binary_stl(PLATE))
    (tmp_path / "mould.ply").write_bytes(text_ply(PLATE))
    (tmp_path / "mould.obj").write_bytes(obj(PLATE))
    os.mkfifo(tmp_path / "pipe.stl")
    os.mkfifo(tmp_path / "pipe.ply")
    (tmp_path / "ring.stl").symlink_to("ring.stl")
    return tmp_path


def refused(capfd, *words: str) -> str:
    outcome = run(capfd, *words)
    assert outcome.code == 2, outcome
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert outcome.err.startswith("meshdrape")
    return outcome.err


DRAPE = "drape mould.stl --spacing 20 --quiet --no-picture -o "


@pytest.mark.parametrize(
    ("words", "culprit"),
    [
        ("inspect pipe.stl", ("pipe.stl is a pipe or a device",)),
        ("inspect ring.stl", ("ring.stl cannot be read", "symbolic links")),
        (f"inspect {'a' * 300}.stl", ("aaaa.stl cannot be read: File name too long",)),
        ("inspect mould.stl/part.stl", ("does not exist",)),
        ("audit pipe.ply", ("pipe.ply is a pipe or a device",)),
        ("audit /dev/zero", ("/dev/zero is a pipe or a device",)),
        ("fold pipe.ply", ("pipe.ply is a pipe or a device",)),
        (DRAPE + "net.ply --warp-path pipe.ply", ("pipe.ply is a pipe or a device",)),
        (DRAPE + "net.ply --warp-path ring.stl", ("ring.stl cannot be read",)),
        (DRAPE + "net.json", ("net.json has the suffix .json", ".ply")),
        (DRAPE + "net.png", ("net.png has the suffix .png",)),
        (DRAPE + "net", ("net has the suffix (none)",)),
        (DRAPE + "mould.stl", ("mould.stl has the suffix .stl",)),
        (DRAPE + f"{'a' * 300}.ply", ("File name too long",)),
        (DRAPE + f"{'a' * 248}.ply", ("File name too long",)),
        ("drape mould.ply --spacing 20 -o mould.ply", ("mould.ply is read and would be overwritten",)),
        ("drape mould.ply --spacing 20 -o ./mould.ply", ("is read and would be overwritten",)),
        (DRAPE + "net.ply --seed 1e300,0,0", ("seed [1e+300, 0.0, 0.0] is not a point within 1e+12 mm",)),
        ("mould cylinder --set radius=1e-300 -o c.stl", ("mould cylinder: the mesh has no triangles",)),
    ],
)
def test_one_line_and_nothing_lost(capfd, folder, words, culprit):
    before = {path.name: path.lstat().st_mtime_ns for path in folder.iterdir()}
    message = refused(capfd, *words.split())
    for word in culprit:
        assert word in message
    assert {path.name: path.lstat().st_mtime_ns for path in folder.iterdir()} == before


def test_the_mould_is_not_overwritten_by_a_companion_of_the_net(capfd, folder):
    """Draped from where a former run wrote it, NET.mould.ply would be the net's own mould."""
    (folder / "net.mould.ply").write_bytes(text_ply(PLATE))
    message = refused(capfd, *["drape", "net.mould.ply", "-o", "net.ply", "--spacing", "20"])
    assert "net.mould.ply is read and would be overwritten" in message
    assert (folder / "net.mould.ply").read_bytes() == text_ply(PLATE)
    (folder / "curve.obj").write_text("v -50 0 0\nv 50 0 0\n")
    (folder / "net.json").symlink_to("curve.obj")
    assert "net.json is read" in refused(capfd, *(DRAPE + "net.ply --warp-path curve.obj").split())


def test_a_folder_that_may_not_be_written_to_is_told_before_anything_is_read(capfd, folder, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert "not writable; choose another" in refused(
        capfd, *["drape", "missing.stl", "-o", "net.ply", "--spacing", "9"]
    )


@pytest.mark.parametrize("direction", ["1e300,0,0", "1e-320,0,0", "1,1e-300,0"])
def test_only_the_direction_of_a_direction_counts(capfd, folder, direction):
    outcome = run(capfd, *(DRAPE + f"net.ply --direction {direction} --reference {direction}").split())
    assert outcome == (0, "", "")
    assert json.loads((folder / "net.json").read_text())["max_shear_deg"] == pytest.approx(0, abs=1e-9)


def test_a_path_is_told_by_its_file(capfd, folder):
    (folder / "curve.csv").write_text("-50 0 0\n50 0 400\n")
    assert "curve.csv: point 2 at (50, 0, 400) lies 400 mm from" in refused(
        capfd, *(DRAPE + "net.ply --warp-path curve.csv").split()
    )
    (folder / "curve.csv").write_text("-50 0 0\n50 0 1e13\n")
    assert "curve.csv, line 2: '50 0 1e13' is no point" in refused(
        capfd, *(DRAPE + "net.ply --weft-path curve.csv").split()
    )
    (folder / "curve.csv").write_text("-50 0 0\n" + "(" * 100_000)
    assert len(refused(capfd, *(DRAPE + "net.ply --weft-path curve.csv").split())) < 200


@pytest.mark.parametrize("suffix", ["obj", "off", "ply"])
def test_text_as_editors_save_it(capfd, folder, suffix):
    """A byte order mark hid the first line: an OBJ file had one vertex less, in silence."""
    whole = {"obj": obj, "off": off, "ply": text_ply}[suffix](PLATE)
    path = folder / f"saved.{suffix}"
    facts = []
    for content in (whole, b"\xef\xbb\xbf" + whole, whole.replace(b"\n", b"\r\n")):
        path.write_bytes(content)
        outcome = run(capfd, "inspect", path, "--json")
        assert outcome.code == 0
        facts.append(json.loads(outcome.out))
    assert facts[0] == facts[1] == facts[2]
    path.write_bytes(whole.decode().encode("utf-16"))
    assert "UTF-16; save it in UTF-8" in refused(capfd, "inspect", str(path))


def test_a_million_vertices_in_eighty_places(capfd, folder):
    mesh = Mesh(np.tile(PLATE.vertices, (12_500, 1)), PLATE.triangles + len(PLATE.vertices) * 12_000)
    path = folder / "many.ply"
    head = text_ply(Mesh(PLATE.vertices, mesh.triangles)).partition(b"end_header")[0].decode()
    head = head.replace("ascii", "binary_little_endian").replace(f"vertex {len(PLATE.vertices)}", "vertex 1000000")
    rows = np.zeros(len(mesh.triangles), dtype=[("n", "u1"), ("corner", "<i4", (3,))])
    rows["n"], rows["corner"] = 3, mesh.triangles
    path.write_bytes(f"{head}end_header\n".encode() + mesh.vertices.astype("<f8").tobytes() + rows.tobytes())
    outcome = run(capfd, "inspect", path, "--json")
    assert outcome.code == 0
    assert json.loads(outcome.out)["triangles"] == len(PLATE.triangles)


def test_a_thread_a_million_kilometres_long_is_inspected_at_once(capfd, folder):
    far = PLATE.vertices * [1, 1e9, 1]
    (folder / "thread.obj").write_bytes(obj(Mesh(far, PLATE.triangles)))
    outcome = run(capfd, "inspect", "thread.obj", "--json", "--seed", "0,0,0", "--spacing", "30")
    assert outcome.code == 0
    assert json.loads(outcome.out)["forecast"]["max_shear_deg"] == pytest.approx(0, abs=1e-6)


def command(*words: str, **options: object) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        [sys.executable, "-m", "meshdrape", *words], env={**os.environ, "PYTHONPATH": str(ROOT)}, check=False,
        **{"stderr": subprocess.PIPE, **options},
    )  # fmt: skip


@pytest.mark.parametrize("words", [("mould", "--list"), ("inspect", "mould.obj", "--json")])
def test_standard_output_that_takes_nothing(folder, words):
    with open("/dev/full", "wb") as full:
        outcome = command(*words, stdout=full)
    assert outcome.returncode == 2
    assert outcome.stderr == (
        b"meshdrape: cannot write to the standard output: No space left on device; send it elsewhere\n"
    )
    closed = command(*words, preexec_fn=lambda: os.close(1))
    assert (closed.returncode, closed.stderr) == (0, b"")
    reader, writer = os.pipe()
    os.close(reader)
    nobody = command(*words, stdout=writer)
    os.close(writer)
    assert (nobody.returncode, nobody.stderr) == (0, b"")


def test_a_name_that_is_no_unicode(folder):
    name = b"m\xff\xe9.obj"
    Path(os.fsdecode(name)).write_bytes(obj(PLATE))
    for words in (["inspect", name], ["inspect", name, "--json"]):
        outcome = command(*words, stdout=subprocess.PIPE)
        assert (outcome.returncode, outcome.stderr) == (0, b"")
    assert json.loads(outcome.stdout)["file"] == os.fsdecode(name)
    gone = command("inspect", b"n\xff.obj", stdout=subprocess.PIPE)
    assert gone.returncode == 2
    assert gone.stderr.count(b"\n") == 1
