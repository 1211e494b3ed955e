"""A script's mould made in another process: the same to the last digit, and no process is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.mould.cad.library import build_script
from meshdrape.mould.cad.script_apart import ScriptApart

ROOT = Path(__file__).resolve().parents[2]
ASKED = ("cone", {}, 0.5, 0.05)
# more than a million triangles: it takes a minute, which nobody waits for
ENDLESS = ("hemisphere", {}, 1.0, 0.001)


@pytest.fixture
def apart(monkeypatch):
    """As if CadQuery had not been imported here: then a process is begun."""
    monkeypatch.delitem(sys.modules, "cadquery", raising=False)

    def begun(*asked):
        script = ScriptApart()
        script.ask(*asked)
        return script

    return begun


def test_it_is_the_mould_made_here(apart):
    with apart(*ASKED) as script:
        assert script._process is not None
        made = script.mould()
        assert script._process is None
    here = build_script(*ASKED)
    for name in ("vertices", "triangles", "triangle_face"):
        assert np.array_equal(getattr(made, name), getattr(here, name))
        assert not getattr(made, name).flags.writeable
    assert [face.name for face in made.cad_faces] == [face.name for face in here.cad_faces]
    assert (made.source, made.sha256) == (here.source, here.sha256)


def test_errors_are_those_of_the_script(apart):
    with apart("cone", {"half_angle": -1.0}, 0.5, 0.05) as script, pytest.raises(FileError) as there:
        script.mould()
    with pytest.raises(FileError) as here:
        build_script("cone", {"half_angle": -1.0}, 0.5, 0.05)
    assert str(there.value) == str(here.value)


def test_a_process_that_dies_is_made_good_here(apart):
    with apart(*ASKED) as script:
        script._process.kill()
        assert len(script.mould().triangles) == len(build_script(*ASKED).triangles)


@pytest.mark.usefixtures("apart")
def test_one_that_is_never_asked_ends_too():
    with ScriptApart() as script:
        process = script._process
    assert process.returncode == -signal.SIGKILL


def test_leaving_the_block_ends_the_process(apart):
    with apart(*ENDLESS) as script:
        process = script._process
        assert process.poll() is None
    assert process.returncode == -signal.SIGKILL


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_no_process_outlives_the_one_that_asked(how):
    code = (
        "import time; from meshdrape.mould.cad.script_apart import ScriptApart\n"
        "with ScriptApart() as script:\n"
        f"    script.ask(*{ENDLESS!r})\n"
        "    print(script._process.pid, flush=True); time.sleep(60)"
    )
    asking = subprocess.Popen(
        [sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(ROOT)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    assert asking.stdout is not None
    child = int(asking.stdout.readline())
    asking.send_signal(how)
    asking.communicate(timeout=30)
    assert asking.returncode == -how
    deadline = time.monotonic() + 15
    while _runs(child) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not _runs(child)


def _runs(pid: int) -> bool:
    """Whether a process is there and has not ended; one that nobody has waited for yet has."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
