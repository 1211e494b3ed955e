"""libigl's exact solver in a process of its own, for meshes on which it may hang or run out of memory.

Of meshes with a triangle lower than a ten-thousandth of its longest side about one in a thousand makes it go on for
ever. A call in this process could not be ended; one in another can. That process ends itself: with its alarm, with its
memory, or when nobody is left to answer.
"""

from __future__ import annotations

import atexit
import os
import pickle
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# Of the processor: a solution takes milliseconds on a patch of some hundred triangles, and a millisecond a triangle on
# a whole mould.
SECONDS, SECONDS_A_FACE = 0.5, 1e-3
# Address space of the process, bytes.
MEMORY = 4 * 2**30


def solve(vertices: FloatArray, faces: IntArray, source: int, targets: IntArray) -> FloatArray:
    """Shortest distances from one vertex to others, mm, as libigl says; infinite where it runs out of memory.

    Parameters
    ----------
    vertices : (n, 3), mm
    faces : (m, 3)
        Manifold and connected; every vertex in use.
    """
    import igl

    none = np.empty(0, dtype=np.int64)
    # all by keyword: given positionally without targets the binding returns an empty array, silently
    try:
        found = igl.exact_geodesic(V=vertices, F=faces, VS=np.array([source]), FS=none, VT=np.asarray(targets), FT=none)
    except MemoryError:
        # its windows may multiply without end: it does not know
        return np.full(len(targets), np.inf)
    return np.asarray(found, dtype=np.float64)


def solve_guarded(vertices: FloatArray, faces: IntArray, source: int, targets: IntArray) -> FloatArray:
    """The same; infinite where libigl hangs from either end, or runs out of memory."""
    found = _SOLVER.ask(vertices, faces, source, targets)
    if found is None and len(targets) == 1:
        # it walks the other way over other windows, and may come through
        found = _SOLVER.ask(vertices, faces, int(targets[0]), np.array([source]))
    return np.full(len(targets), np.inf) if found is None else found


def prepare() -> None:
    """Start the other process now, while something else is done, so that the first question need not wait for it."""
    _SOLVER.start()


def answers_sooner() -> bool:
    """Whether the other process is there already and libigl, which takes a while to load, is not in this one."""
    return _SOLVER.is_running() and "igl" not in sys.modules


class _Solver:
    """The process, started when it is first needed and again when it has ended."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0
        self._lock = threading.RLock()

    def ask(self, *question: Any) -> FloatArray | None:
        """The answer of :func:`solve`; None if there was none."""
        with self._lock:
            self.start()
            process = self._process
            assert process is not None
            assert process.stdin is not None
            assert process.stdout is not None
            with suppress(BrokenPipeError):
                pickle.dump(question, process.stdin)
                process.stdin.flush()
            try:
                return np.asarray(pickle.load(process.stdout), dtype=np.float64)
            except (EOFError, pickle.UnpicklingError):
                self.stop()
                return None

    def start(self) -> None:
        """Start the process unless it runs."""
        with self._lock:
            if self.is_running():
                return
            known = os.pathsep.join(path for path in sys.path if path)
            self._process = subprocess.Popen(
                [sys.executable, "-P", str(Path(__file__))],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": known},
            )
            self._owner = os.getpid()

    def is_running(self) -> bool:
        """Whether the process was started, and by this one: a forked process must not share its parent's."""
        return self._process is not None and self._owner == os.getpid()

    def stop(self) -> None:
        """End the process, if it is ours."""
        process, self._process = self._process, None
        if process is None or self._owner != os.getpid():
            return
        process.kill()
        process.communicate()


_SOLVER = _Solver()
atexit.register(_SOLVER.stop)


def _serve(questions: IO[bytes], answers: IO[bytes]) -> None:
    """Answer until nobody asks; nothing but an answer leaves by `answers`."""
    import resource
    import signal

    import igl  # noqa: F401 - before the clock runs

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    while True:
        try:
            question = pickle.load(questions)
        except EOFError:
            return
        # not caught: it ends the process. It counts the processor's time, or a busy machine would change a net
        signal.setitimer(signal.ITIMER_PROF, SECONDS + SECONDS_A_FACE * len(question[1]))
        found = solve(*question)
        signal.setitimer(signal.ITIMER_PROF, 0)
        pickle.dump(found, answers)
        answers.flush()


if __name__ == "__main__":
    _serve(sys.stdin.buffer, sys.stdout.buffer)
