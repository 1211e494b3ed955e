"""meshdrape COMMAND: one file a command, imported when it is called."""

from __future__ import annotations

import argparse
import errno
import gc
import importlib
import io
import os
import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from meshdrape import __version__
from meshdrape.cli import interrupt
from meshdrape.errors import MeshdrapeError
from meshdrape.kernels import blas

# So many objects are made from one look for unreachable ones to the next; Python's own 700 are those of one import.
SELDOM = 50_000

DONE, BAD_INPUT, FABRIC_MISSING, UNJUDGED, INTERRUPTED = 0, 2, 3, 3, 130

COMMANDS = {
    "drape": "lay a fabric on a mould and write the net",
    "audit": "check a finished net again, from its file and the mould's",
    "inspect": "list the faces of a mould, check its mesh, foretell the shear of a start",
    "fold": "say how far a spar may leave the origami fold",
    "mould": "make a mould by one of the scripts that come with meshdrape",
    "validate": "recompute the study group report: every claim, its error and a verdict",
}


class _Parser(argparse.ArgumentParser):
    """Errors in one line, and points that begin with a minus sign."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        # argparse takes -5 for a number but -5,0,0 for an option
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> None:  # type: ignore[override]
        """Name what is wrong and where the help is; exit with 2."""
        self.exit(BAD_INPUT, f"{self.prog}: {message}; see {self.prog} --help\n")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Parameters
    ----------
    argv : list of str, optional
        The arguments; default those of the process.

    Returns
    -------
    int
        0 done; 2 bad input, one line on stderr; 3 it ran, but fabric that should lie on the mould is missing;
        130 interrupted.
    """
    arguments = list(sys.argv[1:] if argv is None else argv)
    _make_printable()
    blas.unwanted = True
    with interrupt.Remembered(), _seldom_collected():
        try:
            code = _run(arguments)
            sys.stdout.flush()
            return code
        except SystemExit as stop:
            return int(stop.code or 0)
        except BrokenPipeError:
            _drop_output()
            return DONE
        except KeyboardInterrupt:
            return _interrupted()
        except Exception as error:
            # a library interrupted while it is imported raises something of its own
            if interrupt.seen():
                return _interrupted()
            message = _message(error)
            if message is None:
                raise
            sys.stderr.write(f"meshdrape: {message}\n")
            return BAD_INPUT


@contextmanager
def _seldom_collected() -> Iterator[None]:
    """A short run leaves little to collect; looking for it as often as Python does takes a tenth of the time."""
    often = gc.get_threshold()
    gc.set_threshold(SELDOM, *often[1:])
    try:
        yield
    finally:
        gc.set_threshold(*often)


def _message(error: Exception) -> str | None:
    """What to tell the user in one line; None for an error that is none of his."""
    if isinstance(error, MeshdrapeError):
        return " ".join(str(error).split())
    if isinstance(error, MemoryError):
        return "there is not enough memory for this; a larger spacing, or a coarser or smaller mould, needs less"
    # of every file its reader or writer says so itself
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EIO, errno.EBADF):
        _drop_output()
        return f"cannot write to the standard output: {error.strerror}; send it elsewhere"
    return None


def _make_printable() -> None:
    """Let standard output and error take any name of a file, and be there even where they were closed."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - for as long as the process
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _drop_output() -> None:
    """Nobody takes what is left of the output: the interpreter must not try again when it ends."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)


def _interrupted() -> int:
    sys.stderr.write("meshdrape: interrupted; no file was left half written\n")
    return INTERRUPTED


def _run(arguments: list[str]) -> int:
    """Import the command that is named, and run it."""
    parser = _Parser(prog="meshdrape", description="Drape woven cloth over CAD and mesh moulds.")
    parser.add_argument("--version", action="version", version=f"meshdrape {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", dest="command", required=True)
    named = next((word for word in arguments if word in COMMANDS), None)
    modules = {}
    for name, does in COMMANDS.items():
        command = commands.add_parser(name, help=does, description=does[0].upper() + does[1:] + ".")
        if name == named:
            modules[name] = importlib.import_module(f"meshdrape.cli.{name}")
            modules[name].add_arguments(command)
    options = parser.parse_args(arguments)
    return int(modules[options.command].run(options, arguments))


if __name__ == "__main__":
    sys.exit(main())
