"""How a kernel is compiled, and where the machine code is kept between runs.

numba keeps a compiled function as fresh as the file it stands in, and does not notice that a function it calls, which
is compiled into it, has changed in another file: after an upgrade it would compute as before. The folder of the cache
is therefore named by the text of all kernels.
"""

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

import numba
from numba.core import event

from meshdrape.kernels import blas

HERE = Path(__file__).parent
PREFIX = "kernels-"

blas.leave_out_if_unwanted()


def kernel(function=None, *, inline="never", nogil=False, makes_arrays=False):
    """A function for arrays, compiled when it is first called and kept for the next run.

    Parameters
    ----------
    makes_arrays : bool
        Whether it makes any. Else arrays are only lent to it, and numba need not count who holds them, which takes
        several times as long as what a small function does that is called with all tables of a net.
    """
    if function is None:
        return lambda function: kernel(function, inline=inline, nogil=nogil, makes_arrays=makes_arrays)
    place, told = folder(), numba.config.CACHE_DIR
    try:
        numba.config.CACHE_DIR = str(place or told)
        return _in_one_form(
            numba.njit(cache=place is not None, error_model="numpy", inline=inline, nogil=nogil, _nrt=makes_arrays)(
                function
            )
        )
    finally:
        numba.config.CACHE_DIR = told


def _in_one_form(compiled):
    """A compiled function that kernels which call it share, whatever integers they call it with.

    Left to itself numba compiles it anew for every constant, and for every width of integer, in every combination: a
    quarter of all time spent on compiling.
    """
    if not hasattr(compiled, "get_call_template"):  # under NUMBA_DISABLE_JIT
        return compiled
    as_called = compiled.get_call_template

    def widened(kinds, named_kinds):
        return as_called([_widest(kind) for kind in kinds], {name: _widest(k) for name, k in named_kinds.items()})

    compiled.get_call_template = widened
    return compiled


def _widest(kind):
    """The type of an argument, of a constant that of a variable, of an integer that of the longest."""
    kind = numba.types.unliteral(kind)
    return numba.types.int64 if isinstance(kind, numba.types.Integer) and kind.signed else kind


@contextmanager
def compilation_told(tell: Callable[[], object]) -> Iterator[None]:
    """Have `tell` called once, before the first kernel that no earlier run has left compiled."""
    with event.install_listener("numba:compile", _Once(tell)):
        yield


class _Once(event.Listener):
    """Passes the first event on, whichever thread it comes from."""

    def __init__(self, tell):
        self._left = [tell]

    def on_start(self, event):
        with suppress(IndexError):
            self._left.pop()()

    def on_end(self, event):
        pass


@cache
def folder() -> Path | None:
    """Where compiled kernels are kept: where numba was told, else beside the sources, else among the user's caches.

    None where nothing can be written: the kernels are then compiled for each run.
    """
    told = numba.config.CACHE_DIR
    users = Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()) / "meshdrape"
    name = PREFIX + digest()
    for place in [Path(told)] if told else [HERE / "__pycache__", users]:
        if _can_write(place / name):
            if not told:
                _forget_others(place, name)
            return place / name
    return None


def digest() -> str:
    """(16,) hexadecimal digits that change with a letter of any kernel."""
    text = hashlib.sha256()
    for path in sorted(HERE.glob("*.py")):
        text.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return text.hexdigest()[:16]


def _can_write(place: Path) -> bool:
    try:
        place.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=place).close()
    except OSError:
        return False
    return True


def _forget_others(place: Path, name: str) -> None:
    """Remove what was compiled from kernels that are no more; a process that still runs them has them in memory."""
    for other in place.glob(PREFIX + "*"):
        if other.name != name:
            shutil.rmtree(other, ignore_errors=True)
