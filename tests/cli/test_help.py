"""Help, version and usage: what they say, and that they import nothing heavy for it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command import run

import meshdrape
from meshdrape.cli.main import COMMANDS

HEAVY = ("numpy", "scipy", "numba", "cadquery", "OCP", "vtkmodules", "pymeshlab", "igl", "rich")


def imported(code: str) -> set[str]:
    """Top-level packages a fresh interpreter has imported after the code."""
    tail = "\nimport sys\nsys.stderr.write(' '.join({name.partition('.')[0] for name in sys.modules}))"
    process = subprocess.run(
        [sys.executable, "-c", code + tail],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(Path(meshdrape.__file__).parents[1])},
    )
    return set(process.stderr.split())


@pytest.mark.parametrize("words", ["--help", "--version", "drape --help", "inspect --help", "drape", "drape --wrong"])
def test_help_and_usage_import_nothing_heavy(words):
    code = (
        "import contextlib, io\nfrom meshdrape.cli.main import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):\n"
        f"    main({words.split()!r})"
    )
    assert imported(code).isdisjoint(HEAVY)


def test_importing_the_package_is_light():
    assert imported("import meshdrape").isdisjoint(HEAVY)
    assert imported("import meshdrape; dir(meshdrape)").isdisjoint(HEAVY)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("--help", "drape     lay a fabric on a mould and write the net"),
        ("--version", f"meshdrape {meshdrape.__version__}"),
        ("drape --help", "--initial-angle DEG"),
        ("inspect --help", "--angle-tolerance DEG"),
    ],
)
def test_help_says(capfd, words, text):
    outcome = run(capfd, *words.split())
    assert (outcome.code, outcome.err) == (0, "")
    assert text in outcome.out


@pytest.mark.parametrize("name", COMMANDS)
def test_every_option_is_told_of(capfd, name):
    """Each argument has a line of its own words, not its name alone."""
    outcome = run(capfd, name, "--help")
    assert (outcome.code, outcome.err) == (0, "")
    told = outcome.out.partition("\n\n")[2].split("\n  -")[1:]
    assert len(told) >= 3
    for option in told:
        words = option.partition("\n\n")[0].split()
        assert len([word for word in words if word[0].islower()]) >= 2, option
