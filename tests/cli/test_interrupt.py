"""Ctrl-C at any moment of a command: exit code 130, one line, no file left half written."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time

import pytest
from command import ROOT, SAMPLES

import meshdrape
from meshdrape.cli import main as command

INTERRUPTED = "meshdrape: interrupted; no file was left half written\n"


@pytest.mark.parametrize("delay", [0.1, 0.4, 0.7, 1.0, 1.5, 2.5])
def test_while_importing_or_draping(tmp_path, delay):
    net = tmp_path / "net.ply"
    words = ["drape", SAMPLES / "hypar.step", "-o", net, "--spacing", "0.8", "--quiet", "--no-picture"]
    # the line that says the command has begun is printed before anything heavy is imported
    begin = "import sys; from meshdrape.cli.main import main; print('begun', flush=True); sys.exit(main())"
    process = subprocess.Popen(
        [sys.executable, "-c", begin, *map(str, words)], env={**os.environ, "PYTHONPATH": str(ROOT)}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (130, "", INTERRUPTED)
    assert not list(tmp_path.iterdir())


def test_while_a_command_is_imported(monkeypatch, capfd):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(command.importlib, "import_module", interrupted)
    assert command.main(["drape", "mould.stl"]) == 130
    assert capfd.readouterr() == ("", INTERRUPTED)


def test_where_a_library_makes_an_error_of_its_own_of_it(monkeypatch, capfd):
    """As some do that are interrupted while they are imported."""

    def importing(name):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)
        except KeyboardInterrupt:
            raise ImportError(name) from None

    monkeypatch.setattr(command.importlib, "import_module", importing)
    assert command.main(["drape", "mould.stl"]) == 130
    assert capfd.readouterr() == ("", INTERRUPTED)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_where_a_library_loses_it(tmp_path, monkeypatch, capfd):
    """The command ends at its next stage, before a file is written."""
    from meshdrape.cli import drape

    def reading(options):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(1)
        except KeyboardInterrupt:
            return meshdrape.read_mould(options.mould)

    monkeypatch.setattr(drape, "read_mould", reading)
    words = ["drape", SAMPLES / "cone.stl", "-o", tmp_path / "net.ply", "--spacing", "100"]
    assert command.main([str(word) for word in words]) == 130
    assert capfd.readouterr() == ("", INTERRUPTED)
    assert not list(tmp_path.iterdir())
