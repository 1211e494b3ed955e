"""The page of claims: its tables say what the claims say, and nothing breaks them."""

from __future__ import annotations

import io

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.output import chart
from meshdrape.output.validation import page as page_module
from meshdrape.output.validation.curve_figures import draw_convergence, draw_criteria
from meshdrape.output.validation.fold_figures import draw_flat_spar, draw_flattened, draw_turn, draw_weave
from meshdrape.output.validation.page import write_validation
from meshdrape.study.claims import Claim, Recomputed, Section, Verdict
from meshdrape.study.claims.drapes import drape_fold
from meshdrape.study.claims.judgement import Judgement, equality
from meshdrape.study.claims.views import ConvergenceView, CriteriaView, TurnView, WeaveView, sheet_view
from meshdrape.theory import Fold, quadratic

CLAIMS = (
    Claim("(1)", "a |f'| of |x|", "Found 3.", Judgement(Verdict.HOLDS, 0.0, "", "at most 1")),
    Claim("(2)", "b", "Found 4.", Judgement(Verdict.UNSAFE, 2.5e-7, "deg", "at most 2"),
          ((Verdict.UNSAFE, "Take care."), (Verdict.HOLDS, "All is well."))),
)  # fmt: skip


def pixels(content):
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(content)).convert("RGB")).astype(int)


def has_colour(image, colour, share=0.0002):
    from matplotlib.colors import to_rgb

    near = np.abs(image - 255 * np.array(to_rgb(colour))).max(axis=-1) < 12
    return near.mean() > share


@pytest.fixture
def written(tmp_path, monkeypatch):
    picture = page_module._Picture("one", "A title", "A caption.", b"\x89PNG")
    monkeypatch.setattr(page_module, "_pictures", lambda views: iter([picture]))
    target = tmp_path / "page.md"
    files = write_validation(Recomputed((Section("Part", CLAIMS),), None, False), target, "meshdrape validate")
    return target.read_text(), files


def test_tables(written):
    text, files = written
    rows = [line for line in text.splitlines() if line.startswith("| (")]
    assert len(rows) == 2
    # five cells each, however many bars the claim has
    assert [len(row.replace("\\|", "").split("|")) - 2 for row in rows] == [5, 5]
    assert "a \\|f'\\| of \\|x\\|" in rows[0]
    assert "**unsafe**. Take care.<br><sub>at most 2</sub>" in rows[1]
    assert "2.5·10^-7°" in rows[1]
    assert "All is well" not in text
    assert "| unsafe | 1 |" in text
    assert [file.name for file in files] == ["page.md", "one.png"]
    assert "![A title](page/one.png)" in text


def test_a_claim_without_a_verdict_is_on_the_page(tmp_path, monkeypatch):
    monkeypatch.setattr(page_module, "_pictures", lambda views: iter(()))
    claim = Claim("(3)", "c", "Found nan.", equality([np.nan], 1.0, "deg"), ((Verdict.HOLDS, "All is well."),))
    write_validation(Recomputed((Section("Part", (claim,)),), None, False), tmp_path / "page.md", "meshdrape validate")
    text = (tmp_path / "page.md").read_text()
    assert "| Found nan. | none found | **not found: a number is missing**<br>" in text
    assert "| not found: a number is missing | 1 |" in text
    assert "All is well" not in text


def test_folder_that_is_not_there(tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        write_validation(Recomputed((), None, False), tmp_path / "no" / "page.md", "x")


# --- the pictures -----------------------------------------------------------------------------------------------------


def test_sheets_show_both_families_and_regions():
    view = sheet_view(drape_fold(Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0)), 0.1, 0.6, 5e-3))
    image = pixels(draw_flattened(view))
    for colour in (chart.BLUE, chart.GREEN, chart.INK):
        assert has_colour(image, colour), colour
    for tint in ("#DCE9F5", "#FBEBD0"):
        assert has_colour(image, tint, 0.01), tint
    front = pixels(draw_flat_spar(view))
    assert has_colour(front, chart.VERMILION)
    assert not has_colour(front, "#DCE9F5", 0.01)


def test_ribbons_cover_more_as_they_close():
    """White is what the gaps leave: next to none at the critical shear but for outlines."""
    width = 5 * np.cos(np.radians(30.0))
    image = pixels(draw_weave((WeaveView(5.0, width, float(np.radians(30.0)), (5 - width, 0.0)),)))
    white = (image > 250).all(axis=-1)
    middle, quarter = image.shape[0] // 2, image.shape[1] // 4
    about = np.s_[middle - 60 : middle + 60]
    open_share, shut_share = (
        white[about, quarter - 60 : quarter + 60],
        white[about, 3 * quarter - 30 : 3 * quarter + 30],
    )
    assert open_share.mean() > 1.5 * shut_share.mean()


def test_turn_and_curves_are_drawn():
    at = np.stack(np.meshgrid(np.arange(-3.0, 4), np.arange(-3.0, 4), indexing="ij"), axis=-1)
    assert has_colour(pixels(draw_turn(TurnView(at, at, 0.4, 0.2))), chart.VERMILION)
    c = np.linspace(0, 0.1, 5)
    safe = CriteriaView("tilt", c, 2 * c, 1.5 * c, c, c, np.array([[0.05, 0.05]]))
    unsafe = CriteriaView("bump", c, 0.5 * c, 1.5 * c, c, c, np.array([[0.05, 0.05]]))
    strict_tint, unsafe_tint = "#E0EEF6", "#F7DFCC"
    shown = [pixels(draw_criteria((view,) * 4, 0.12)) for view in (safe, unsafe)]
    assert [has_colour(image, strict_tint, 0.02) for image in shown] == [True, False]
    assert [has_colour(image, unsafe_tint, 0.02) for image in shown] == [False, True]
    h = 0.08 / 2.0 ** np.arange(4)
    view = ConvergenceView(h, h, np.sqrt(h), (1.0, 0.5), np.array([[0.08, 0.08, 0.28]]))
    assert has_colour(pixels(draw_convergence(view)), chart.ORANGE)


def test_charts_do_not_touch_matplotlibs_global_state():
    import matplotlib

    before = dict(matplotlib.rcParams)
    with chart.styled():
        assert matplotlib.rcParams["axes.spines.top"] is False
        content = chart.png(chart.new_figure(2, 1), dpi=50)
    assert dict(matplotlib.rcParams) == before
    assert pixels(content).shape == (50, 100, 3)


def test_shear_map_is_the_packages_own():
    from meshdrape.output.colour import shear_colour

    colours = chart.shear_map(0.1, 0.2)
    assert np.allclose(np.array(colours(0.0)) * 255, shear_colour(0.0, 0.1), atol=1)
    assert np.allclose(np.array(colours(1.0)) * 255, shear_colour(0.2, 0.1), atol=1)
