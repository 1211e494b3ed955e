"""The command as its user meets it: words in; exit code, stdout and stderr out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from meshdrape.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
CAD = ROOT / "cad"


class Outcome(NamedTuple):
    code: int
    out: str
    err: str


def run(capfd: pytest.CaptureFixture[str], *words: object) -> Outcome:
    """The command run in this process; what C++ code prints is caught too."""
    capfd.readouterr()
    code = main([str(word) for word in words])
    return Outcome(code, *capfd.readouterr())


def draped(capfd: pytest.CaptureFixture[str], mould: object, net: Path, *options: object, code: int = 0) -> Any:
    """The summary read back from beside the net; no picture."""
    outcome = run(capfd, "drape", mould, "-o", net, "--quiet", "--no-picture", *options)
    assert outcome == (code, "", "")
    return json.loads(net.with_suffix(".json").read_text())
