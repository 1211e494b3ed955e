"""A script's mould made in a process of its own: CadQuery alone takes seconds to import, time for other questions."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from queue import SimpleQueue
from types import TracebackType
from typing import Any, Final

from meshdrape.mould.cad.library import build_script
from meshdrape.mould.cad.shape import cadquery_module
from meshdrape.mould.mould import Mould

# What is called there; the modules are found where this process found them.
_SERVE: Final = "import sys; sys.path[:] = {path!r}; from meshdrape.mould.cad.script_apart import serve; serve()"


class ScriptApart:
    """Another process for one :func:`meshdrape.mould.cad.library.build_script`, begun before it is known what to ask.

    It ends when the block is left, and with this process however that ends.
    """

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._asked: tuple[str, dict[str, Any], float, float] | None = None
        if "cadquery" in sys.modules:
            return  # there is nothing to gain: the mould is made here when it is wanted
        with suppress(OSError):  # where there are no other processes it is made here, too
            self._process = subprocess.Popen(
                [sys.executable, "-c", _SERVE.format(path=sys.path)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )

    def ask(self, name: str, parameters: Mapping[str, Any], chord_tolerance: float, angle_tolerance: float) -> None:
        """Have it made; arguments as of ``build_script``."""
        self._asked = (name, dict(parameters), chord_tolerance, angle_tolerance)
        if self._process is not None:
            assert self._process.stdin is not None
            with suppress(OSError):  # it has ended: that is told when the mould is wanted
                pickle.dump(self._asked, self._process.stdin)
                self._process.stdin.flush()

    def mould(self) -> Mould:
        """Wait for the mould that was asked for; the errors are those of ``build_script``."""
        assert self._asked is not None
        if self._process is not None:
            assert self._process.stdout is not None
            made = self._process.stdout.read()
            code = self._process.wait()
            self.close()
            if code == 0:
                mould: Mould = pickle.loads(made)
                return replace(mould)  # made anew, its arrays are read-only again
        # whatever kept the other process from making it is told best by trying here
        return build_script(*self._asked)

    def close(self) -> None:
        """End the process, if it still runs."""
        process, self._process = self._process, None
        if process is None:
            return
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(OSError):  # what was not sent before the process ended
                    pipe.close()

    def __enter__(self) -> ScriptApart:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def serve() -> None:
    """Make the mould that is asked for on standard input and write it to standard output; nothing of what fails."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that asks: it ends this one
    answer = os.dup(1)
    os.dup2(2, 1)  # what the script or Open CASCADE prints is no part of the answer
    asked: SimpleQueue[tuple[str, dict[str, Any], float, float]] = SimpleQueue()
    threading.Thread(target=_listen, args=(asked,), daemon=True).start()
    try:
        cadquery_module()
        made = pickle.dumps(build_script(*asked.get()), protocol=pickle.HIGHEST_PROTOCOL)
    except Exception:
        os._exit(1)
    with os.fdopen(answer, "wb") as out:
        out.write(made)
    os._exit(0)


def _listen(asked: SimpleQueue[tuple[str, dict[str, Any], float, float]]) -> None:
    """Pass on what is asked; end with standard input: whoever asked is gone."""
    try:
        asked.put(pickle.load(sys.stdin.buffer))
        sys.stdin.buffer.read()
    finally:
        os._exit(1)
