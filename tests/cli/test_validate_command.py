"""meshdrape validate: the report recomputed from the command line."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from command import run

from meshdrape.study.claims import Verdict, judgement, n_steps


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """One quick run; the facts it prints and the page it writes."""
    from contextlib import redirect_stdout
    from io import StringIO

    from meshdrape.cli.main import main

    page = tmp_path_factory.mktemp("validate") / "page.md"
    said = StringIO()
    with redirect_stdout(said):
        assert main(["validate", "--quick", "--json", "-o", str(page)]) == 0
    return json.loads(said.getvalue()), page


def test_every_claim_is_on_the_page(written):
    facts, page = written
    text = page.read_text()
    assert len(facts["claims"]) == n_steps() - 1 > 45
    assert "meshdrape validate --quick" in text
    for claim in facts["claims"]:
        assert claim["verdict"] in {verdict.value for verdict in Verdict}
        assert claim["found"].replace("|", "\\|") in text
        assert re.search(r"\d", claim["found"]), claim
    places = " ".join(claim["place"] for claim in facts["claims"])
    equations = [3, 10, *range(17, 22), 24, *range(26, 33), 33, 34, 35, *range(38, 41), 42, 43]
    assert [f"({n})" for n in equations if f"({n})" not in places] == []
    assert all(section in places for section in ("3.2", "3.3", "3.4", "4, end", "6.1", "7.3"))


def test_what_is_wrong_with_the_report_is_found(written):
    """Quick runs come to the same verdicts as full ones; these are the ones that matter to a designer."""
    verdicts = {claim["place"]: claim["verdict"] for claim in written[0]["claims"]}
    assert verdicts["(20), best γ"] == "unsafe here, too strict there"
    assert verdicts["(29)"] == verdicts["(30)"] == "an upper bound, not the value"
    assert verdicts["(32)"] == "sufficient, not necessary"
    assert verdicts["(28)"] == verdicts["6.4, sharpened"] == "holds"
    assert verdicts["(10)"] == verdicts["(27)"] == verdicts["(35)"] == "misprint"


def test_pictures_stand_beside_the_page(written):
    facts, page = written
    named = re.findall(r"\]\((.*?\.png)\)", page.read_text())
    assert len(named) == len(facts["files"]) - 1 == 8
    for name in named:
        content = (page.parent / name).read_bytes()
        assert content.startswith(b"\x89PNG")
        assert 5_000 < len(content) < 300_000


def test_a_claim_without_numbers_is_told_loudly(capfd, tmp_path, monkeypatch):
    """A number that is not found gives no verdict, and no success."""
    from meshdrape.output import validation
    from meshdrape.study import claims

    lost = claims.Claim("(99)", "Something.", "nan.", judgement.criterion([1.0], [np.nan], 0.05))
    held = claims.Claim("(98)", "Something else.", "0.", judgement.equality(0.0, 0.1))
    for found, code in (((held, lost), 3), ((held,), 0)):
        recomputed = claims.Recomputed((claims.Section("Part", found),), None, True)
        monkeypatch.setattr(claims, "recompute", lambda recomputed=recomputed, **_: recomputed)
        monkeypatch.setattr(validation, "write_validation", lambda recomputed, page, command: [page])
        outcome = run(capfd, "validate", "-o", tmp_path / "page.md")
        assert outcome.code == code
        assert ("WARNING  no verdict for want of numbers: (99)\n" in outcome.out) == bool(code)


@pytest.mark.parametrize(("name", "suffix"), [("x.txt", ".txt"), ("page", "(none)"), ("page.html", ".html")])
def test_the_page_is_markdown(capfd, tmp_path, name, suffix):
    """Nothing is computed for a page that no reader of Markdown would open, or whose pictures have no folder."""
    outcome = run(capfd, "validate", "-o", tmp_path / name)
    assert (outcome.code, outcome.out) == (2, "")
    said = f"{tmp_path / name} has the suffix {suffix}; the page is written as .md .markdown\n"
    assert outcome.err == f"meshdrape: {said}"
    assert not list(tmp_path.iterdir())


def test_refused_before_anything_is_computed(capfd, tmp_path):
    outcome = run(capfd, "validate", "-o", tmp_path / "no" / "page.md")
    assert outcome.code == 2
    assert outcome.out == ""
    assert outcome.err.count("\n") == 1
    assert "does not exist" in outcome.err
