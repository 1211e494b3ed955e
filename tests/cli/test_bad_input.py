"""Bad input: exit code 2, one line on stderr that names the culprit, and no file written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from command import run
from meshfiles import binary_stl, obj, off, text_ply, text_stl
from moulds import Mesh, plate

import meshdrape.output

PLATE = plate()
BOX = """\
import cadquery as cq

length = 100.0
holes = 0
name = "box"
rounded = False
show_object(cq.Workplane().box(length, 80, 20).faces("{selector}"))
"""
FIN = Mesh(
    np.vstack([PLATE.vertices, [[0.0, 0.0, 90.0]]]), np.vstack([PLATE.triangles, [[12, 20, len(PLATE.vertices)]]])
)
NOISE = np.random.default_rng(0).bytes(3000)
MESHES = {"stl": binary_stl(PLATE), "obj": obj(PLATE), "off": off(PLATE), "ply": text_ply(PLATE)}
SUFFIXES = ("step", "stp", "brep", "stl", "obj", "ply", "off", "py")


@pytest.fixture(scope="module")
def moulds(tmp_path_factory) -> Path:
    """A folder of good moulds and of bad ones, which the commands are run in."""
    import cadquery as cq

    folder = tmp_path_factory.mktemp("moulds")
    box = cq.Workplane().box(100, 80, 20)
    cq.exporters.export(box, str(folder / "box.step"))
    top = box.faces(">Z").val()
    top.exportBrep(str(folder / "top.brep"))
    cq.exporters.export(cq.Workplane(top), str(folder / "top.stp"), "STEP")
    cq.exporters.export(cq.Workplane(top), str(folder / "top.step"))
    cq.exporters.export(cq.Workplane().circle(50).extrude(10).edges(), str(folder / "curves.step"))
    cq.Edge.makeLine(cq.Vector(), cq.Vector(1, 2, 3)).exportBrep(str(folder / "curves.brep"))
    (folder / "top.py").write_text(BOX.format(selector=">Z"))
    whole = {suffix: (folder / f"top.{suffix}").read_bytes() for suffix in ("step", "stp", "brep", "py")} | MESHES
    for suffix in SUFFIXES:
        content = whole[suffix]
        (folder / f"top.{suffix}").write_bytes(content)
        (folder / f"empty.{suffix}").write_bytes(b"")
        (folder / f"truncated.{suffix}").write_bytes(content[: 2 * len(content) // 5])
        (folder / f"noise.{suffix}").write_bytes(NOISE)
        (folder / f"folder.{suffix}").mkdir()
    for name, content in CONTENT.items():
        (folder / name).write_bytes(content)
    return folder


def with_nan(content: bytes) -> bytes:
    number = repr(float(PLATE.vertices[12, 0])).encode()
    assert number in content
    return content.replace(number, b"nan", 1)


CONTENT = {
    "nothing.stl": binary_stl(Mesh(PLATE.vertices, PLATE.triangles[:0])),
    "nothing-in-it.stl": b"solid a\nendsolid a\n",
    "nothing.obj": obj(Mesh(PLATE.vertices, PLATE.triangles[:0])),
    "nothing.off": off(Mesh(PLATE.vertices, PLATE.triangles[:0])),
    "nothing.ply": text_ply(Mesh(PLATE.vertices, PLATE.triangles[:0])),
    "nan.obj": with_nan(obj(PLATE)),
    "nan.off": with_nan(off(PLATE)),
    "nan.ply": with_nan(text_ply(PLATE)),
    "nan-in-words.stl": with_nan(text_stl(PLATE)),
    "nan.stl": MESHES["stl"][:96] + np.float32(np.nan).tobytes() + MESHES["stl"][100:],
    "index.obj": MESHES["obj"] + b"f 1 2 940\n",
    "index.off": MESHES["off"].replace(b"\n3 0 ", b"\n3 940 ", 1),
    "index.ply": MESHES["ply"].replace(b"\n3 0 ", b"\n3 940 ", 1),
    "fin.stl": binary_stl(FIN),
    "fin.obj": obj(FIN),
    "turned.obj": obj(Mesh(PLATE.vertices, np.vstack([PLATE.triangles[:-9], PLATE.triangles[-9:, ::-1]]))),
    "part.igs": b"IGES",
    "part": b"no suffix",
    "raises.py": b"import cadquery as cq\nlength = 0.0\nside = 1 / length\n",
    "silent.py": b"import cadquery as cq\nlength = 1.0\nbox = cq.Workplane().box(1, 1, 1)\n",
    "grammar.py": b"import cadquery as cq\nlength = = 1\n",
    "empty-result.py": b"import cadquery as cq\nshow_object(cq.Workplane().pushPoints([(0, 0)]))\n",
    "no-module.py": b"import no_such_module\n",
}


class Bad(NamedTuple):
    mould: str
    options: str
    culprit: tuple[str, ...]
    """All of these are in the line."""


def cases() -> list[Bad]:
    found = []
    for suffix in SUFFIXES:
        found += [
            Bad(f"missing.{suffix}", "", (f"missing.{suffix}", "does not exist")),
            Bad(f"empty.{suffix}", "", (f"empty.{suffix}", "is empty")),
            Bad(f"truncated.{suffix}", "", (f"truncated.{suffix}",)),
            Bad(f"noise.{suffix}", "", (f"noise.{suffix}",)),
            Bad(f"folder.{suffix}", "", (f"folder.{suffix}", "is a directory")),
        ]
    found += [Bad(name, "", (name, "no triangles")) for name in ("nothing.stl", "nothing.obj", "nothing.off")]
    found += [
        Bad("nothing-in-it.stl", "", ("nothing-in-it.stl",)),
        Bad("nothing.ply", "", ("nothing.ply", "no triangles")),
        Bad("curves.step", "", ("curves.step", "no faces")),
        Bad("curves.brep", "", ("curves.brep", "no faces")),
    ]
    found += [Bad(name, "", (name, "not finite")) for name in ("nan.obj", "nan.off", "nan.ply", "nan.stl")]
    found += [Bad("nan-in-words.stl", "", ("nan-in-words.stl", "not finite"))]
    found += [Bad(name, "", (name, "uses vertex 940", f"{len(PLATE.vertices)} vertices")) for name in ("index.obj", "index.off", "index.ply")]  # fmt: skip  # noqa: E501
    found += [Bad(name, "", (name, "1 non-manifold edge", "(-71.2424, 7.21409, 0)")) for name in ("fin.stl", "fin.obj")]
    found += [
        Bad("turned.obj", "", ("turned.obj", "--heal")),
        Bad("part.igs", "", ("part.igs", "suffix .igs", ".step")),
        Bad("part", "", ("part has the suffix (none)", ".stl")),
        # faces
        Bad("box.step", "", ("box.step", "closed solid of 6 faces", "--faces")),
        Bad("box.step", "--faces 7", ("no face 7", "1 to 6")),
        Bad("box.step", "--faces 1,0", ("no face 0", "1 to 6")),
        Bad("box.step", "--faces 1,x", ("'1,x'", "no CadQuery selector", "inspect")),
        Bad("box.step", "--faces %SPHERE", ("%SPHERE", "matches none of the 6 faces")),
        Bad("box.step", "--faces >Q", ("'>Q'", "no CadQuery selector")),
        Bad("box.step", "--faces wing", ("'wing'", "no CadQuery selector")),
        Bad("top.stl", "--faces 1", ("top.stl is a mesh", "--faces")),
        # units and healing
        Bad("top.step", "--unit m", ("top.step", "--unit")),
        Bad("top.py", "--unit m", ("top.py", "--unit")),
        Bad("top.stl", "--unit parsec", ("'parsec'", "mm, cm, m")),
        Bad("top.step", "--heal", ("top.step", "--heal")),
        Bad("top.step", "--set length=3", ("top.step has no parameters", "--set")),
        Bad("top.step", "--chord-tolerance 0", ("chord tolerance 0 mm",)),
        Bad("top.step", "--chord-tolerance nan", ("chord tolerance nan mm",)),
        Bad("top.step", "--angle-tolerance 90", ("angle tolerance 90 degrees", "60")),
        Bad("top.step", "--angle-tolerance 0", ("angle tolerance 0 degrees",)),
        # scripts
        Bad("top.py", "--set lenght=3", ("no parameter 'lenght'", "length=100.0", "holes=0", "name=box")),
        Bad("top.py", "--set length=long", ("length=long is not a number", "100.0")),
        Bad("top.py", "--set rounded=perhaps", ("rounded=perhaps", "true or false")),
        Bad("top.py", "--set length", ("--set length", "NAME=VALUE")),
        Bad("top.py", "--set =3", ("--set =3", "NAME=VALUE")),
        Bad("top.py", "--set length=-5", ("top.py", "line 7")),
        Bad("raises.py", "", ("raises.py, line 3", "ZeroDivisionError")),
        Bad("silent.py", "", ("silent.py shows no shape", "show_object")),
        Bad("empty-result.py", "", ("empty-result.py", "show_object")),
        Bad("grammar.py", "", ("grammar.py, line 2", "not a Python script")),
        Bad("no-module.py", "", ("no-module.py, line 1", "no_such_module")),
        Bad("top.stl", "--angle-tolerance 1", ("top.stl is a mesh", "--angle-tolerance", "STEP")),
        Bad("top.stl", "--chord-tolerance 1", ("top.stl is a mesh", "--chord-tolerance", "STEP")),
        Bad("top.stl", "--refine", ("top.stl is a mesh, its own truth", "STEP")),
        # seed and direction
        Bad("top.stl", "--seed 0,0,12.5", ("seed (0, 0, 12.5)", "lies 12.5 mm", "one spacing (10 mm)", "nearest")),
        Bad("top.stl", "--seed 150,0,0", ("lies 50 mm",)),
        Bad("top.stl", "--seed 1,2", ("--seed", "'1,2' is not a point")),
        Bad("top.stl", "--seed 1,2,nan", ("--seed", "'1,2,nan'")),
        Bad("top.stl", "--seed a,b,c", ("--seed", "'a,b,c'")),
        Bad("top.stl", "--direction 0,0,0", ("direction (0, 0, 0)", "zero")),
        Bad("top.stl", "--direction 0,0,-1", ("direction (0, 0, -1)", "along the mould's normal")),
        Bad("top.stl", "--direction 1,0", ("--direction", "'1,0' is not a direction")),
        Bad("top.stl", "--direction inf,0,0", ("--direction", "'inf,0,0'")),
        # said before the mould is even looked for
        Bad("missing.stl", "--reference 0,0,0", ("--reference", "'0,0,0'", "must not all be zero")),
        Bad("top.stl", "--reference x", ("--reference", "'x'")),
        # cloth
        Bad("top.stl", "--spacing 0", ("spacing is 0 mm",)),
        Bad("top.stl", "--spacing -1", ("spacing is -1 mm",)),
        Bad("top.stl", "--spacing nan", ("spacing is nan mm",)),
        Bad("top.stl", "--spacing inf", ("spacing is inf mm",)),
        Bad("top.stl", "--spacing 5,0", ("weft spacing is 0 mm",)),
        Bad("top.stl", "--spacing 1,2,3", ("--spacing", "'1,2,3'")),
        Bad("top.stl", "--spacing wide", ("--spacing", "'wide'")),
        Bad("top.stl", "--spacing 1000", ("spacing 1000 mm", "larger than the mould")),
        Bad("top.stl", "--spacing 0.0001", ("2,800,000,000,000 nodes", "GiB", "--extent")),
        Bad("top.stl", "--spacing 1e-12", ("nodes", "GiB", "--extent")),
        Bad("top.stl", "--spacing 1e-300", ("spacing 1e-300 mm", "round-off", "unit")),
        Bad("top.stl", "--initial-angle 0", ("initial angle is 0 degrees",)),
        Bad("top.stl", "--initial-angle 180", ("initial angle is 180 degrees",)),
        Bad("top.stl", "--initial-angle right", ("--initial-angle", "'right'")),
        Bad("top.stl", "--locking-angle 0", ("locking angle is 0 degrees",)),
        Bad("top.stl", "--locking-angle 90", ("locking angle is 90 degrees",)),
        Bad("top.stl", "--extent 1,2,3", ("--extent", "'1,2,3'")),
        Bad("top.stl", "--extent -1,2,3,4", ("extent",)),
        Bad("top.stl", "--engine slow", ("--engine", "'slow'", "libigl")),
        Bad("top.stl", "--threads two", ("--threads", "'two'")),
        Bad("top.stl", "--threads 0", ("--threads", "'0'")),
        Bad("top.stl", "--threads -2", ("--threads", "'-2'")),
        Bad("top.stl", "--colour red", ("--colour",)),
    ]  # fmt: skip
    return found


def in_one_line(outcome, *culprit):
    assert outcome.code == 2
    assert outcome.out == ""
    assert outcome.err.endswith("\n")
    assert len(outcome.err.splitlines()) == 1
    assert "Traceback" not in outcome.err
    for word in culprit:
        assert word in outcome.err


@pytest.mark.parametrize("case", cases(), ids=lambda case: f"{case.mould} {case.options}".strip())
def test_drape(capfd, monkeypatch, tmp_path, moulds, case):
    monkeypatch.chdir(moulds)
    spacing = [] if "--spacing" in case.options else ["--spacing", "10"]
    words = ["drape", case.mould, "-o", tmp_path / "net.ply", *spacing, *case.options.split()]
    in_one_line(run(capfd, *words), *case.culprit)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "case",
    [
        case
        for case in cases()
        if case.options.split("=")[0].split(" ")[0] in ("", "--unit", "--set", "--chord-tolerance", "--angle-tolerance")
        and case.mould not in ("box.step", "turned.obj", "fin.stl", "fin.obj")
    ],
    ids=lambda case: f"{case.mould} {case.options}".strip(),
)
def test_inspect(capfd, monkeypatch, moulds, case):
    monkeypatch.chdir(moulds)
    in_one_line(run(capfd, "inspect", case.mould, *case.options.split()), *case.culprit)


@pytest.mark.parametrize(
    ("words", "culprit"),
    [
        ("", ("COMMAND",)),
        ("weave top.stl", ("'weave'", "drape")),
        ("drape", ("MOULD", "--output", "--spacing")),
        ("drape top.stl -o OUT/net.ply", ("--spacing",)),
        ("drape top.stl --spacing 10", ("--output",)),
        ("drape -o OUT/net.ply --spacing 10", ("MOULD",)),
        ("drape top.stl -o", ("--output",)),
        ("drape top.stl top.obj -o OUT/net.ply --spacing 10", ("top.obj",)),
        ("inspect", ("MOULD",)),
        ("inspect top.stl --heal", ("--heal",)),
        ("inspect top.stl --seed 0,0,900", ("seed", "900 mm")),
        ("audit", ("NET.ply",)),
        ("audit missing.ply", ("missing.ply", "does not exist")),
        ("audit top.stl --edges 0", ("--edges", "'0'")),
        ("audit top.stl --seconds -1", ("--seconds", "'-1'")),
        ("audit top.stl --seconds 1 --edges 1", ("--edges", "not allowed with")),
        ("drape top.stl -o OUT/nowhere/net.ply --spacing 10", ("nowhere", "does not exist")),
        ("drape top.stl -o OUT --spacing 10", ("it is a folder",)),
        ("drape top.stl -o /dev/null --spacing 10", ("/dev/null", "not a regular file")),
        # the mould is not read in vain where the net could not be written
        ("drape missing.step -o OUT/nowhere/net.ply --spacing 10", ("nowhere", "does not exist")),
    ],
)
def test_words_of_the_command(capfd, monkeypatch, tmp_path, moulds, words, culprit):
    monkeypatch.chdir(moulds)
    in_one_line(run(capfd, *words.replace("OUT", str(tmp_path)).split()), *culprit)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".json", ".png", ".mould.ply", ".fibres.ply"])
def test_companion_that_cannot_be_written(capfd, monkeypatch, tmp_path, moulds, suffix):
    """A folder stands where a companion of the net is to go."""
    monkeypatch.chdir(moulds)
    (tmp_path / f"net{suffix}").mkdir()
    outcome = run(capfd, "drape", "top.stl", "-o", tmp_path / "net.ply", "--spacing", "40", "--quiet")
    in_one_line(outcome, f"net{suffix}", "it is a folder")
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize("mould", ["box.step", "fin.stl", "turned.obj"])
def test_what_inspect_can_tell_of_it_all_the_same(capfd, monkeypatch, moulds, mould):
    """A closed solid is no fault of the file; of a mesh with faults the list is printed, and the one line."""
    monkeypatch.chdir(moulds)
    outcome = run(capfd, "inspect", mould)
    assert outcome.code == (0 if mould == "box.step" else 2)
    assert mould in outcome.out
    assert outcome.err.count("\n") == (0 if mould == "box.step" else 1)


# --- interrupted ------------------------------------------------------------------------------------------------------


def half_then(interruption: type[BaseException]) -> Callable[..., None]:
    """A writer that stops in the middle of its file."""

    def write(*arguments: object) -> None:
        path = next(argument for argument in arguments if isinstance(argument, Path))
        with meshdrape.output.files.atomic_write(path) as file:
            file.write(b"half")
            raise interruption

    return write


@pytest.mark.parametrize("writer", ["write_ply", "write_mould_ply", "write_fibres_ply", "draw_net", "write_json"])
def test_interrupted_write_leaves_no_part_of_a_file(capfd, monkeypatch, tmp_path, moulds, writer):
    monkeypatch.setattr(meshdrape.output, writer, half_then(KeyboardInterrupt))
    if writer != "draw_net":
        monkeypatch.setattr(meshdrape.output, "draw_net", lambda *_: None)
    outcome = run(capfd, "drape", moulds / "top.stl", "-o", tmp_path / "net.ply", "--spacing", "20", "--quiet")
    assert outcome.code == 130
    assert outcome.out == ""
    assert outcome.err == "meshdrape: interrupted; no file was left half written\n"
    written = sorted(path.name for path in tmp_path.iterdir())
    order = ["net.ply", "net.mould.ply", "net.fibres.ply", "net.png", "net.json"]
    at = ["write_ply", "write_mould_ply", "write_fibres_ply", "draw_net", "write_json"].index(writer)
    assert written == sorted(name for name in order[:at] if name != "net.png")
    assert all((tmp_path / name).read_bytes() != b"half" for name in written)


IN_DRAPE = """
import os, signal, sys, threading
import meshdrape.weave
from meshdrape.cli.main import main

drape = meshdrape.weave.drape


def soon_interrupted(*arguments, **options):
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    return drape(*arguments, **options)


meshdrape.weave.drape = soon_interrupted
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("stage", "spacing"), [("drape", "0.05"), ("write", "0.15")])
def test_control_c_in_a_process_of_its_own(tmp_path, moulds, stage, spacing):
    """Millions of nodes: neither stage is over when the signal comes."""
    code = ["-c", IN_DRAPE] if stage == "drape" else ["-m", "meshdrape"]
    words = ["drape", str(moulds / "top.stl"), "-o", str(tmp_path / "net.ply"), "--spacing", spacing, "--no-picture"]
    process = subprocess.Popen(
        [sys.executable, *code, *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(Path(meshdrape.__file__).parents[1])},
    )
    if stage == "write":
        while process.poll() is None and not list(tmp_path.iterdir()):
            time.sleep(0.005)
        process.send_signal(signal.SIGINT)
    # the kernels may be compiled meanwhile, on a machine that is busy
    out, err = process.communicate(timeout=400)
    # an interpreter that was interrupted within an import ends by the signal itself: a shell reports 130 for both
    assert process.returncode in (130, -signal.SIGINT)
    assert out == ""
    assert err.splitlines()[-1] == "meshdrape: interrupted; no file was left half written"
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
