"""Ctrl-C remembered: a library that is being imported may turn it into an error of its own, or lose it."""

from __future__ import annotations

import signal
import threading
from types import FrameType
from typing import Any

_seen = False


class Remembered:
    """While it lasts Ctrl-C raises KeyboardInterrupt as ever, and :func:`check` raises it again where it was lost."""

    def __init__(self) -> None:
        self._before: Any = None

    def __enter__(self) -> Remembered:
        global _seen
        _seen = False
        # another handler than Python's own is somebody's choice; and only the main thread has any
        if threading.current_thread() is threading.main_thread():
            handler = signal.getsignal(signal.SIGINT)
            if handler is signal.default_int_handler:
                self._before = handler
                signal.signal(signal.SIGINT, _interrupt)
        return self

    def __exit__(self, *_: object) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _seen
    _seen = True
    raise KeyboardInterrupt


def seen() -> bool:
    """Whether Ctrl-C was pressed since the command began."""
    return _seen


def check() -> None:
    """Raise KeyboardInterrupt if Ctrl-C was pressed, even if the exception it raised was lost."""
    if _seen:
        raise KeyboardInterrupt
