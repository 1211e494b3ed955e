"""What the README says can be done: its code runs, its options exist, its links lead somewhere, its keys are all."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

import meshdrape
from meshdrape.cli.main import COMMANDS, main
from meshdrape.study.fold import design
from meshdrape.theory import profiles

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def commands() -> list[list[str]]:
    lines = "".join(blocks("sh")).splitlines()
    return [shlex.split(line, comments=True)[1:] for line in lines if line.startswith("meshdrape ")]


@pytest.mark.slow
def test_ten_lines_run(tmp_path, monkeypatch, capsys):
    (code,) = blocks("python")
    assert len([line for line in code.splitlines() if line]) <= 10
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {})
    shear, edges, bar = (line.split()[0] for line in capsys.readouterr().out.splitlines())
    assert 0.04 < float(shear) < 0.06
    assert float(edges) < 1e-9
    assert 0 < float(bar) < 0.01
    assert meshdrape.read_net(tmp_path / "out" / "wing.ply").sealed


def test_every_command_is_shown():
    assert {words[0] for words in commands()} == COMMANDS.keys()


@pytest.mark.parametrize("words", commands(), ids=" ".join)
def test_commands_name_options_and_files_that_there_are(words, capfd):
    assert main([words[0], "--help"]) == 0
    known = re.findall(r"(?<![\w-])--?[a-z-]+", capfd.readouterr().out)
    for word in words[1:]:
        if re.match(r"--?[a-z]", word):
            assert word in known
        elif word.startswith(("samples/", "cad/")):
            assert (ROOT / word).is_file(), word


def test_options_in_the_text_exist(capfd):
    for name in COMMANDS:
        main([name, "--help"])
    known = set(re.findall(r"--[a-z-]+", capfd.readouterr().out))
    named = set(re.findall(r"--[a-z-]+", "".join(re.findall(r"`[^`\n]+`", README))))
    assert len(named) >= 10
    assert named <= known


@pytest.mark.parametrize("page", ["README.md", "samples/README.md", "docs/validation.md"])
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)#]+)\)", (ROOT / page).read_text(encoding="utf-8"))
    assert links
    for link in links:
        assert (ROOT / page).parent.joinpath(link).exists(), link


def test_every_picture_is_shown():
    assert {f"docs/{path.name}" for path in (ROOT / "docs").glob("*.png")} <= set(re.findall(r"\((docs/\S+)\)", README))


def test_every_key_of_a_design_is_in_the_table():
    table = README[README.index("| key of a design |") :].partition("\n\n")[0]
    said = set(re.findall(r"`\[?(\w+)\]?`", table))
    keys = {*design._TOP, *design._START, *profiles.PROFILES, *profiles.DEVIATIONS, "free", "best", "root", "tip"}
    assert keys - {"start"} <= said | {"wing", "spar"}
    assert all(unit in table for unit in design.UNITS)
