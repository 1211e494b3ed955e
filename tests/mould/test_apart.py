"""Work in a process of its own: what it makes comes back, what it breaks stays there."""

from __future__ import annotations

import gc
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import meshdrape
from meshdrape.errors import FileError, MouldError, SelectionError
from meshdrape.mould import apart as module
from meshdrape.mould.apart import DiedError, allow, apart, step
from meshdrape.mould.cad import reader as cad

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
GIB = 2**30


def test_what_it_returns_comes_back():
    array = np.arange(300_000.0).reshape(-1, 3)
    found, process = apart(lambda: (2 * array, os.getpid()), 10, GIB)
    assert (found == 2 * array).all()
    assert process != os.getpid()


def test_what_it_raises_comes_back_with_all_it_carries():
    def choose():
        raise SelectionError("choose", ("a face",))

    with pytest.raises(SelectionError, match="choose") as caught:
        apart(choose, 10, GIB)
    assert caught.value.faces == ("a face",)
    # where a fault of ours arose is told
    with pytest.raises(ZeroDivisionError) as caught:
        apart(lambda: 1 / 0, 10, GIB)
    assert "test_apart.py" in "".join(caught.value.__notes__)


def endless():
    while True:
        pass


@pytest.mark.parametrize(
    ("work", "how"),
    [
        (lambda: os.kill(os.getpid(), signal.SIGSEGV), "crashes"),
        (os.abort, "crashes"),
        (lambda: os._exit(0), "crashes"),
        (lambda: sys.exit(3), "crashes"),
        (endless, "hangs"),
    ],
)
def test_what_ends_it_does_not_end_this_process(work, how):
    with pytest.raises(DiedError) as caught:
        apart(work, 0.2, GIB)
    assert caught.value.how == how


def test_one_that_waits_for_what_never_comes_hangs_too(monkeypatch):
    monkeypatch.setattr(module, "PATIENCE", 2)
    begun = time.perf_counter()
    with pytest.raises(DiedError, match="hangs"):
        apart(lambda: time.sleep(60), 0.1, GIB)
    assert time.perf_counter() - begun < 30


def test_each_step_begins_the_seconds_anew():
    def steps():
        for _ in range(4):
            until = time.process_time() + 0.2
            while time.process_time() < until:
                pass
            step()
        return "done"

    assert apart(steps, 0.5, GIB) == "done"
    step()
    allow(0.001, 1)
    assert signal.getitimer(signal.ITIMER_PROF) == (0.0, 0.0)  # neither does anything here


def test_memory_without_end():
    with pytest.raises((MemoryError, DiedError)):
        apart(lambda: len(np.ones(2 * GIB, dtype=np.uint8)), 10, GIB)
    assert apart(lambda: len(np.ones(GIB // 4, dtype=np.uint8)), 10, GIB) == GIB // 4


def test_threads_that_were_not_forked_are_not_waited_for():
    """Open CASCADE's pool of threads, once it has worked here, is empty in a fork, and would be waited for."""
    import cadquery

    def cut():
        box = cadquery.Workplane().box(30, 20, 10)
        for k in range(4):
            box = box.cut(cadquery.Workplane().center(k, 0).circle(1 + k).extrude(20))
        return box.val().Volume()

    here = cut()
    begun = time.perf_counter()
    assert apart(cut, 60, GIB) == pytest.approx(here, rel=1e-12)
    assert time.perf_counter() - begun < 50


def test_what_was_there_is_not_copied_to_look_for_garbage_in_it():
    """Its pages are shared until one is written to, and to look an object over is to write to it."""
    kept = [[number] for number in range(200_000)]

    def copied() -> int:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
        gc.collect()
        return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

    assert len(kept) * 2 * 40 > 1000 * resource.getpagesize()
    assert apart(copied, 10, GIB) < 500


IMPORTS = """
import sys
from pathlib import Path
from meshdrape.mould.cad import reader as cad

apart = cad.apart

def watched(work, seconds, memory):
    def watched_work():
        before = set(sys.modules)
        return work(), set(sys.modules) - before
    global there
    value, there = apart(watched_work, seconds, memory)
    return value

cad.apart = watched
cad.file_mould(Path(sys.argv[1]))
print(len(there), sorted(name for name in there if name in sys.modules))
"""


def test_nothing_is_imported_there_and_then_again_here():
    root = str(Path(meshdrape.__file__).parents[1])
    words = [sys.executable, "-c", IMPORTS, str(SAMPLES / "cube_corner.step")]
    found = subprocess.run(words, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": root})
    n_there, again = found.stdout.split(maxsplit=1)
    assert int(n_there) > 0
    assert again.strip() == "[]"


def children() -> set[str]:
    """Processes that this one has begun and not yet seen the end of."""
    return set(Path(f"/proc/self/task/{os.getpid()}/children").read_text().split())


def test_control_c_ends_it():
    before = children()
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        apart(endless, 60, GIB)
    assert children() == before  # nothing is left of it


ORPHAN = """
import os, time
from meshdrape.mould.apart import apart

def work():
    print(os.getpid(), flush=True)
    while True:
        pass

apart(work, 1.0, 2**30)
"""


def test_it_ends_though_nobody_waits_for_it():
    root = str(Path(meshdrape.__file__).parents[1])
    waiting = subprocess.Popen(
        [sys.executable, "-c", ORPHAN], stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": root}
    )
    assert waiting.stdout is not None
    child = int(waiting.stdout.readline())
    waiting.kill()
    waiting.wait()
    for _ in range(600):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        if Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
            return  # ended, and only its parent's parent has not looked
        time.sleep(0.1)
    os.kill(child, signal.SIGKILL)
    pytest.fail("it lives on")


@pytest.mark.parametrize(("end", "how"), [(os.abort, "crashes"), (endless, "hangs")])
def test_a_file_that_brings_open_cascade_down(monkeypatch, end, how):
    monkeypatch.setattr(cad, "read_step", lambda path: end())
    monkeypatch.setattr(cad, "SECONDS_TO_READ", 0.2)
    with pytest.raises(FileError, match=f"cone.step is damaged: Open CASCADE {how} on it; export it anew"):
        meshdrape.read_mould(SAMPLES / "cone.step")


@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ("import os; os.abort()", "brings Python or Open CASCADE down"),
        ("x = " + "(" * 100_000, "is not a Python script|brings Python or Open CASCADE down"),
        ("while True: pass", "does not come to an end in 0.005 minutes"),
    ],
)
def test_a_script_that_does(monkeypatch, tmp_path, statement, message):
    monkeypatch.setattr(cad, "SECONDS_TO_BUILD", 0.3)
    path = tmp_path / "box.py"
    path.write_text(f"import cadquery as cq\n{statement}\nshow_object(cq.Workplane().box(1, 1, 1).faces('>Z'))\n")
    with pytest.raises(FileError, match=message) as caught:
        meshdrape.read_mould(path)
    assert str(path) in str(caught.value)


def test_faces_that_bring_it_down_only_when_they_are_cut(monkeypatch):
    monkeypatch.setattr(cad, "SECONDS_A_STEP", 0.2)
    monkeypatch.setattr(cad, "cut_faces", lambda *_: endless())
    with pytest.raises(FileError, match="hangs"):
        meshdrape.read_mould(SAMPLES / "cube_corner.step")


def test_errors_of_faces_name_the_file(monkeypatch):
    def cut(*_):
        raise MouldError("face 1 is torn; mend it")

    monkeypatch.setattr(cad, "cut_faces", cut)
    with pytest.raises(MouldError, match=r"cube_corner\.step: face 1 is torn; mend it"):
        meshdrape.read_mould(SAMPLES / "cube_corner.step")
