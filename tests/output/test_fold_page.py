"""The page of `meshdrape fold`, from a small answer made by hand."""

from __future__ import annotations

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.output.fold.charts import pictures
from meshdrape.output.fold.page import fold_page, write_fold_page
from meshdrape.output.fold.text import fold_text
from meshdrape.study.fold.answer import (
    Choice,
    Envelope,
    FoldAnswer,
    FoldWarning,
    Laying,
    Limit,
    NearestSpar,
    Pair,
    Shear,
    SparMap,
    Verdict,
    Where,
)
from meshdrape.study.fold.design import design_from

LOCK = np.radians(7.0)
DESIGN = {
    "unit": "m", "span": 10.0, "chord": 3.0, "spar_height": 1.0, "spacing": 0.1, "locking_angle_deg": 7.0,
    "wing": {"profile": "real"}, "spar": {"deviation": "parabola", "c": 0.1},
    "start": {"first": "wing", "gamma_deg": 0.0},
}  # fmt: skip


def spar_map():
    """Forty by ten cells, 250 by 100 mm, shear growing along y past locking at the end; the upper half wing-fed."""
    s, down = np.meshgrid(np.arange(41) * 250.0, np.arange(11) * 100.0, indexing="ij")
    flat = np.stack([s, -down], axis=-1)
    node = np.stack([0 * s, s, -down], axis=-1)
    shear = np.repeat(np.linspace(0, 1.2 * LOCK, 40)[:, None], 10, axis=1)
    shear[0, 0] = np.nan
    region = np.where(np.arange(10) < 5, 2, 1) * np.ones((40, 1), dtype=int)
    boundary = np.stack([0 * s[:, 5], s[:, 5], -down[:, 5]], axis=-1)
    return SparMap(node, flat, shear, LOCK - np.abs(shear), region.astype(np.int8), boundary)


@pytest.fixture
def answer():
    design = design_from(DESIGN)
    y = np.linspace(0, 10_000, 21)
    psi = -np.radians(8.0) * y / 10_000
    crease = np.stack([0.1 * y, y, 0.1 * y], axis=-1)
    worst = Pair(-np.radians(8.25), 1000.0, 9000.0, np.array([0.0, 9000.0, -200.0]))
    where = Where(y, crease, psi, -psi, -psi / 2, worst, None, spar_map())
    shear = Shear(np.radians(8.25), np.radians(3.5))
    criteria = {name: shear for name in ("eq20", "eq29", "within_reach", "characteristics", "drape")}
    criteria["eq20"] = Shear(None, np.radians(5.125))
    remarks = {name: "" for name in criteria} | {"eq20": "unsafe <here> & now"}
    verdict = Verdict(False, LOCK - shear.largest, LOCK, 0.0, criteria, remarks, 0.0)
    choices = (
        Choice("wing", "root", "best", -np.radians(2.0), shear, 0.0),
        Choice("spar", "tip", "free", np.radians(1.0), shear, np.radians(4.0)),
    )
    limits = (
        Limit("gamma 0", 0.75, 0.0, shear, 8.0),
        Limit("free", None, 0.0, shear, 8.0),
        Limit("best", None, 0.0, shear, float("inf")),
    )
    f = design.deviation_profile(y)
    nearest = NearestSpar("slope", y, f, 0.8 * f, False, 100.0, 10_000.0, 45.0, 0.0, Shear(0.1, 0.05), True, 7)
    warnings = (FoldWarning("returning", "rows <come> back", 2000.0, 3000.0),)
    return FoldAnswer(design, verdict, where, Laying(choices, choices[0], -0.03), limits, nearest, warnings)


class Reader(HTMLParser):
    """Text, table rows and pictures of a page; every tag closed."""

    void = frozenset({"meta", "img", "br"})

    def __init__(self):
        super().__init__()
        self.open, self.rows, self.sources, self.text = [], [], [], ""

    def handle_starttag(self, tag, attrs):
        if tag not in self.void:
            self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag == "img":
            self.sources.append(dict(attrs)["src"])

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" in self.open:
            return
        self.text += data
        if self.open and {"td", "th"} & set(self.open):
            self.rows[-1][-1] += data


def read(page):
    reader = Reader()
    reader.feed(page)
    reader.close()
    assert reader.open == []
    return reader


def image(source):
    from PIL import Image

    assert source.startswith("data:image/png;base64,")
    return Image.open(io.BytesIO(base64.b64decode(source.partition(",")[2])))


def test_page_says_what_the_answer_says(answer):
    page = read(fold_page(answer))
    assert "Cannot be made as it is: 1.25° past locking" in page.text
    assert page.text.index("Cannot be made") < page.text.index("Criteria")
    rows = {row[0]: row for row in page.rows if row}
    assert rows["Report (20), arctan max |f′|"][1:] == ["–", "5.12°", "unsafe <here> & now"]
    assert rows["Drape on the mould"][1:3] == ["8.25°", "3.50°"]
    assert rows["upright, γ = 0"][1] == "0.750"
    assert rows["straight on"][1] == "more than 8"
    assert rows["best γ"][1] == "no limit"
    assert ["spar", "tip", "straight on", "1.00°", "8.25°", "3.50°", "4.00°", ""] in page.rows
    assert "at most 100.0 mm" in page.text
    assert "its drape proves it (7 drapes)" in page.text
    assert "rows <come> back (y = 2.00 to 3.00 m)" in page.text
    assert "γ = −2.00°" in page.text


def test_page_names_the_stations_of_the_largest_shear(answer):
    page = read(fold_page(answer))
    assert "Rows from the first sheet: 8.25° at (0.00, 9.00, -0.20) m" in page.text
    assert "where the row that crosses at y = 1.00 m meets the column that crosses at y = 9.00 m" in page.text


def test_page_says_of_another_way_that_it_can_be_made(answer):
    """An ill-posed one, with what it costs the sheet laid first; and the design's own way, wherever it ranks."""
    low = Shear(np.radians(3.0), np.radians(2.0))
    best = Choice("wing", "tip", "best", np.radians(1.0), low, np.radians(4.5))
    own = Choice("wing", "root", "gamma 0", 0.0, answer.verdict.criteria["drape"], 0.0)
    others = tuple(Choice("spar", "root", "free", np.radians(k), own.shear, 0.0) for k in range(7))
    page = read(fold_page(replace(answer, laying=Laying((best, *others, own), best, 0.0))))
    assert "Laid on the wing first, from the tip, it takes 4.50°" in page.text
    assert "4.50°; rows come back to the wing, which shears by up to 4.50°" in page.text
    assert ["wing", "root", "upright, γ = 0", "0.00°", "8.25°", "3.50°", "–", "as designed"] in page.rows
    assert sum(row[-1:] == ["as designed"] for row in page.rows) == 1
    text = fold_text(replace(answer, laying=Laying((best, own), best, 0.0)))
    assert "lay it   first on the wing, from the tip, gamma = 1.00 deg: 4.50 deg, 2.50 to spare; ill-posed" in text
    assert "so it can be made, though not as laid in the design" in " ".join(text.split())
    assert max(map(len, text[text.index("lay it") : text.index("how far")].splitlines())) <= 120


def test_page_needs_nothing_else(answer):
    text = fold_page(answer)
    assert not re.search(r"https?://|<script|<link|url\(", text)
    page = read(text)
    assert len(page.sources) == 3
    for source in page.sources:
        assert min(image(source).size) > 300
    assert "@page { size: A4" in text
    assert len(text) < 1_500_000


def test_over_locking_is_marked(answer):
    text = fold_page(answer)
    assert '<td class="n over">8.25°</td>' in text
    assert '<td class="n">3.50°</td>' in text


def test_feasible_design(answer):
    verdict = replace(answer.verdict, feasible=True, margin=np.radians(0.5), first_sheet=np.radians(1.0))
    nearest = replace(answer.nearest, unchanged=True)
    page = read(fold_page(replace(answer, verdict=verdict, nearest=nearest, warnings=())))
    assert "Can be made: 0.50° below locking" in page.text
    assert "The sheet laid first shears by 1.00°" in page.text
    assert "can stay as it is" in page.text
    assert "Warnings" not in page.text


def test_spar_map_has_the_colours_of_shear(answer):
    from meshdrape.output.colour import shear_colour

    drawn = pictures(answer)
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(drawn["spar"])).convert("RGB")).astype(int)
    for part in (0.3, 0.6, 0.95, 1.1):
        k = int(part / 1.2 * 39)
        wanted = shear_colour(answer.where.spar.shear[k, 3], LOCK)[:3].astype(int)
        assert (np.abs(pixels - wanted).max(axis=-1) <= 3).mean() > 0.002, part


@pytest.mark.parametrize("spacing", ["geometric", "even"])
def test_envelope(answer, spacing):
    wavelength = np.array([1000.0, 2000.0, 4000.0, 8000.0]) if spacing == "geometric" else np.linspace(1000, 4000, 4)
    amplitude = np.array([0.001, 0.002, 0.004])[:, None] * wavelength
    shear = np.radians([[2.0], [6.0], [12.0]]) * np.ones((1, 4))
    shear[2, 0] = np.nan
    envelope = Envelope("sine", amplitude, wavelength, shear, 0.5 * shear, amplitude[1], "best", 40.0, 1.0)
    page = read(fold_page(replace(answer, envelope=envelope)))
    assert len(page.sources) == 4
    colours = np.asarray(image(page.sources[3]).convert("RGB")).reshape(-1, 3)
    from meshdrape.output.colour import NO_CLOTH, shear_colour

    for wanted in (NO_CLOTH[:3], *(shear_colour(np.radians(deg), LOCK)[:3] for deg in (2.0, 6.0, 12.0))):
        assert (np.abs(colours.astype(int) - np.array(wanted, dtype=int)).max(axis=-1) <= 2).mean() > 0.01


def test_regions_without_cells(answer):
    """A spar of which nothing was draped still makes a page."""
    spar = answer.where.spar
    nothing = replace(spar, shear=np.full_like(spar.shear, np.nan), boundary=np.empty((0, 3)))
    where = replace(answer.where, spar=nothing, worst_wing_fed=None)
    assert read(fold_page(replace(answer, where=where))).sources


def test_file(answer, tmp_path):
    target = tmp_path / "fold.html"
    write_fold_page(answer, target)
    assert target.read_text(encoding="utf-8") == fold_page(answer)
    with pytest.raises(FileError, match="does not exist"):
        write_fold_page(answer, tmp_path / "no" / "fold.html")
