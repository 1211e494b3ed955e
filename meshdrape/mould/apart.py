"""Work of C++ libraries done in a process of its own, where it may crash, hang or ask for all the memory.

What a damaged file makes Open CASCADE do, nobody foresees. The process is forked, so that what is imported is there
at once; what comes back through a pipe are plain arrays. It ends itself, by its timers and its memory, also when
nobody is left to wait for it.
"""

from __future__ import annotations

import faulthandler
import gc
import os
import pickle
import resource
import select
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import IO, Final, NoReturn, TypeVar

from meshdrape.errors import MeshdrapeError

T = TypeVar("T")

# Time of the processor is what is measured, for others may use it too; a process that sleeps ends after so many times
# as long by the clock.
PATIENCE: Final = 20
# A library that had threads of its own may wait in the fork for one that was not forked with it: it stands still then.
STILL_SECONDS: Final = 2.0
_GLANCE: Final = 0.25
_TIMERS: Final = (signal.SIGPROF, signal.SIGALRM)

# Of a forked process: the address space it had when it was forked, bytes, and the seconds its work has at a time.
_had: int | None = None
_seconds = 0.0


class DiedError(Exception):
    """The process ended without an answer.

    Attributes
    ----------
    how : str
        "crashes" or "hangs", as a word of a message.
    """

    def __init__(self, how: str) -> None:
        super().__init__(how)
        self.how = how


def apart(work: Callable[[], T], seconds: float, memory: int) -> T:
    """What a function returns or raises, called in a process forked for it.

    Where processes cannot be forked it is called in this one; also where the fork waits for threads of a library, such
    as those of Open CASCADE once it has worked in this process, which do not live there.

    Parameters
    ----------
    work : callable
        What it returns must be possible to pickle.
    seconds : float
        Of the processor, until it ends or calls :func:`step` or :func:`allow`.
    memory : int
        Bytes it may take on top of what this process has.

    Raises
    ------
    DiedError
        It crashes, hangs, or kills itself for want of memory.
    """
    if not hasattr(os, "fork"):
        return work()
    sys.stdout.flush()
    sys.stderr.flush()
    answers, answer = os.pipe()
    child = os.fork()
    if child == 0:
        _work_and_exit(work, answer, seconds, memory)
    os.close(answer)
    status = None
    try:
        with os.fdopen(answers, "rb") as pipe:
            stuck = _stands_still(child, pipe)
            if not stuck:
                raised, value = pickle.load(pipe)
    except (EOFError, pickle.UnpicklingError):
        _, status = os.waitpid(child, 0)
        timed_out = os.WIFSIGNALED(status) and os.WTERMSIG(status) in _TIMERS
        raise DiedError("hangs" if timed_out else "crashes") from None
    finally:
        if status is None:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
    if stuck:
        return work()
    if raised:
        raise value
    return value  # type: ignore[no-any-return]


def _stands_still(child: int, pipe: IO[bytes]) -> bool:
    """Wait for the answer of a fork; True if it waits for a lock instead, and nothing in it moves."""
    glances, before = 0, ""
    while not select.select([pipe], [], [], _GLANCE)[0]:
        try:
            waits_in = Path(f"/proc/{child}/wchan").read_text()
            fields = Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()
        except OSError:  # the system does not say: its timers will end it
            continue
        state, now = fields[0], " ".join(fields[11:13])  # of the processor, its own and the system's
        still = state == "S" and now == before and ("futex" in waits_in or waits_in in ("", "0"))
        glances, before = glances + 1 if still else 0, now
        if glances * _GLANCE >= STILL_SECONDS:
            return True
    return False


def allow(seconds: float, memory: int) -> None:
    """Within :func:`apart`, give what follows so many seconds from now and so much memory; elsewhere do nothing."""
    global _seconds
    if _had is None:
        return
    _seconds = seconds
    step()
    if _had:
        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        wanted = _had + memory
        resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


def step() -> None:
    """Within :func:`apart`, begin the seconds anew, for something has got done; elsewhere do nothing."""
    if _had is not None:
        signal.setitimer(signal.ITIMER_PROF, _seconds)
        signal.setitimer(signal.ITIMER_REAL, PATIENCE * _seconds)


def _work_and_exit(work: Callable[[], object], answer: int, seconds: float, memory: int) -> NoReturn:
    """The life of the forked process."""
    global _had
    try:
        _had = _address_space()
        # what a crash means here is known, and Ctrl-C is for the one who waits
        faulthandler.disable()
        # what was there lives as long as this process: to look for garbage in it would copy all of its pages
        gc.freeze()
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        for timer in _TIMERS:
            signal.signal(timer, signal.SIG_DFL)
        allow(seconds, memory)
        with os.fdopen(answer, "wb") as pipe:
            _answer(work, pipe)
    finally:
        os._exit(0)


def _answer(work: Callable[[], object], pipe: IO[bytes]) -> None:
    try:
        said: tuple[bool, object] = (False, work())
    except Exception as error:
        if not isinstance(error, MeshdrapeError):
            error.add_note("".join(traceback.format_exception(error)))  # its frames stay here
        said = (True, error)
    step()
    sys.stdout.flush()
    sys.stderr.flush()
    pickle.dump(said, pipe, protocol=pickle.HIGHEST_PROTOCOL)


def _address_space() -> int:
    """Bytes of address space in use; 0 where the system does not say."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except OSError:
        return 0
