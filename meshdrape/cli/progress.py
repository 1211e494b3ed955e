"""A line on the terminal for what takes longer than two seconds."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from meshdrape.cli.interrupt import check

PATIENCE = 2.0
# What input that cannot be draped needs of kernels is compiled well within this, s: its one line stays alone.
A_FEW_KERNELS = 1.5
NOTICE = "meshdrape: compiling the kernels, once; this takes up to a minute\n"


@contextmanager
def compilation_told(quiet: bool) -> Iterator[None]:
    """Say that kernels are being compiled, if they are and it takes its time."""
    if quiet:
        yield
        return
    from meshdrape.kernels import cache

    timer = threading.Timer(A_FEW_KERNELS, sys.stderr.write, [NOTICE])
    timer.daemon = True
    try:
        with cache.compilation_told(timer.start):
            yield
    finally:
        timer.cancel()


class Progress:
    """Stages of a command; a bar appears on a terminal once two seconds have gone by.

    Parameters
    ----------
    quiet : bool
        Never show anything.
    """

    def __init__(self, quiet: bool) -> None:
        self._shown = not quiet and sys.stderr.isatty()
        self._begun = time.perf_counter()
        self._bar: Any = None
        self._task: Any = None

    def stage(self, name: str, total: int | None = None) -> None:
        """Begin a stage; `total` steps where they can be counted. A Ctrl-C that a library lost ends it here."""
        check()
        self._name, self._total = name, total
        if self._bar is not None:
            self._bar.update(self._task, description=name, total=total, completed=0)

    def step(self, done: int) -> None:
        """So many steps of the stage are done."""
        if not self._shown or time.perf_counter() - self._begun < PATIENCE:
            return
        if self._bar is None:
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.completed:,}"),
                TimeElapsedColumn(),
            )
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(self._name, total=self._total)
            self._bar.start()
        self._bar.update(self._task, completed=done)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
