"""A command killed at any moment leaves whole files under their names or none, and the next one is not disturbed."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from moulds import bumpy

import meshdrape
from meshdrape.output.ply.reader import read_ply

ROOT = Path(__file__).resolve().parents[2]
COMPLETE = {"net.ply", "net.mould.ply", "net.fibres.ply", "net.json"}

# The command with every call that opens, renames or removes a file told to a counter, which ends it before or after.
PROGRAM = """
import os, pathlib, signal, sys

count, last = 0, int(sys.argv[1])

def tick():
    global count
    count += 1
    if count == last:
        os.kill(os.getpid(), signal.SIGKILL)

def counted(call):
    def wrapped(*arguments, **options):
        tick()
        result = call(*arguments, **options)
        tick()
        return result
    return wrapped

from meshdrape.cli import drape, main
from meshdrape.output import files
os.replace = counted(os.replace)
pathlib.Path.open = counted(pathlib.Path.open)
pathlib.Path.unlink = counted(pathlib.Path.unlink)
code = main.main(sys.argv[2:])
print(count)
sys.exit(code)
"""


@pytest.fixture(scope="module")
def mould(tmp_path_factory):
    path = tmp_path_factory.mktemp("mould") / "hills.off"
    mesh = bumpy(0, n=8)
    rows = ["OFF", f"{len(mesh.vertices)} {len(mesh.triangles)} 0"]
    rows += [" ".join(map(repr, row)) for row in mesh.vertices.tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in mesh.triangles.tolist()]
    path.write_text("\n".join(rows))
    return path


def words(mould: Path) -> list[str]:
    return ["drape", str(mould), "--spacing", "9", "--no-picture", "--quiet", "--threads", "1"]


def run(program: list[str], *arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, *program, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )


def assert_whole_or_none(folder: Path) -> list[str]:
    """Every file under a name that was asked for is whole; names of all files there."""
    names = sorted(path.name for path in folder.iterdir())
    names = [name for name in names if not name.isdecimal()]
    for name in names:
        if name.endswith(".part"):
            # hidden, beside its target, and taken for no file of ours by anyone
            assert name.startswith(".net."), name
        elif name == "net.json":
            assert json.loads((folder / name).read_text())["nodes"] > 0
        elif name == "net.ply":
            assert (meshdrape.read_net(folder / name).node_status == 0).any()
        else:
            assert name in ("net.mould.ply", "net.fibres.ply"), name
            assert len(read_ply(folder / name).elements["vertex"]) > 0
    return names


@pytest.mark.slow
def test_between_two_steps(mould, tmp_path):
    """Before and after files are opened, renamed and removed, and once more where another was killed half-way."""
    whole = run(["-c", PROGRAM], "-1", *words(mould), "-o", str(tmp_path / "net.ply"))
    out, err = whole.communicate(timeout=100)
    assert whole.returncode == 0, err
    steps = int(out.split()[-1])
    assert steps >= 4 * 4
    assert set(assert_whole_or_none(tmp_path)) == COMPLETE
    left = []
    # at the start, and three times just before a file that is written gets its name
    for last in (2, steps - 12, steps - 7, steps - 2):
        folder = tmp_path / str(last)
        folder.mkdir()
        killed = run(["-c", PROGRAM], str(last), *words(mould), "-o", str(folder / "net.ply"))
        killed.communicate(timeout=100)
        assert killed.returncode == -signal.SIGKILL
        left.append(set(assert_whole_or_none(folder)))
    assert len({len(COMPLETE & names) for names in left}) > 2, left
    assert any(name.endswith(".part") for names in left for name in names), left
    next_run = run(["-m", "meshdrape"], *words(mould), "-o", str(folder / "net.ply"))
    next_run.communicate(timeout=100)
    # it has swept up what the killed one left
    assert set(assert_whole_or_none(folder)) == COMPLETE


@pytest.mark.slow
def test_at_random_times(mould, tmp_path):
    begun = time.perf_counter()
    process = run(["-m", "meshdrape"], *words(mould), "-o", str(tmp_path / "net.ply"))
    process.communicate(timeout=100)
    duration = time.perf_counter() - begun
    assert set(assert_whole_or_none(tmp_path)) == COMPLETE
    for share in np.random.default_rng(0).uniform(0.6, 1.02, 3):
        process = run(["-m", "meshdrape"], *words(mould), "-o", str(tmp_path / "net.ply"))
        time.sleep(share * duration)
        process.kill()
        process.communicate(timeout=100)
        # the files of the run before stand where this one had not come to replace them
        assert set(assert_whole_or_none(tmp_path)) >= COMPLETE
