"""Open CASCADE kept from the terminal, from crashing this process, and from being interrupted half-way."""

from __future__ import annotations

import faulthandler
import os
import resource
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType


def survives(action: Callable[[], object], seconds: float) -> bool:
    """Whether C++ code comes back at all: tried in a process of its own, which noise may crash or hang.

    Exceptions count as coming back. Where processes cannot be forked, nothing is tried.
    """
    if not hasattr(os, "fork"):
        return True
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        try:
            # what a crash means here is known
            faulthandler.disable()
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            with quiet():
                action()
        finally:
            os._exit(0)
    deadline = time.monotonic() + seconds
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.WIFEXITED(status)
        if time.monotonic() > deadline:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return False
        time.sleep(0.005)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back for the length of the block: the import of some C++ libraries crashes on it."""
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGINT) is None:
        yield
        return
    pressed: list[tuple[int, FrameType | None]] = []
    before = signal.signal(signal.SIGINT, lambda number, frame: pressed.append((number, frame)))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
    if pressed and callable(before):
        before(*pressed[0])


@contextmanager
def quiet() -> Iterator[None]:
    """Send what C++ code writes to standard output and standard error nowhere, for the length of the block."""
    sys.stdout.flush()
    sys.stderr.flush()
    kept = [os.dup(fd) for fd in (1, 2)]
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        for fd, copy in zip((1, 2), kept, strict=True):
            os.dup2(copy, fd)
            os.close(copy)
        os.close(nowhere)
