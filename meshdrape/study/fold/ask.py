"""All questions of a design, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable

from meshdrape.errors import MeshdrapeError
from meshdrape.study.fold.answer import FoldAnswer
from meshdrape.study.fold.chart import envelope
from meshdrape.study.fold.criteria import verdict
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.frame import Cloth, Frame, frame_of
from meshdrape.study.fold.lay import FoldDrape, lay
from meshdrape.study.fold.limits import limits
from meshdrape.study.fold.mould import CadMould, FoldMould, cad_mould, ruled_mould
from meshdrape.study.fold.nearest import nearest_spar
from meshdrape.study.fold.notices import notices
from meshdrape.study.fold.ways import ways
from meshdrape.study.fold.where import where

# Called with the name of a stage and how many steps it has, if that is known; and with the steps done.
Stage = Callable[[str, int | None], None]
Step = Callable[[int], None]


def drape_design(design: Design) -> FoldDrape:
    """The full drape of a design on its CAD mould, from a row that stays on the side laid first."""
    frame, gamma, cloth = _cloth(design)
    return _laid(design, frame, gamma, cloth, cad_mould(design, frame, cloth))


def _cloth(design: Design) -> tuple[Frame, float, Cloth]:
    frame = frame_of(design)
    gamma = frame.gamma(design.gamma)
    return frame, gamma, Cloth.of(frame, design.spacing, design.row_offset, gamma)


def _laid(design: Design, frame: Frame, gamma: float, cloth: Cloth, mould: FoldMould) -> FoldDrape:
    """The drape on a CAD mould.

    Where the cloth ends too early there, the facets of a tessellation being at fault for a row that runs along the
    very crease, the same surfaces are draped on facets along their rulings.
    """
    drape = lay(cloth, mould, gamma, design.locking_angle)
    if not drape.lost:
        return drape
    ruled = lay(cloth, ruled_mould(frame, cloth), gamma, design.locking_angle)
    return ruled if ruled.lost < drape.lost else drape


def fold_answer(
    design: Design,
    *,
    nearest: str = "slope",
    chart: tuple[int, int] | None = None,
    family: str = "sine",
    stage: Stage | None = None,
    step: Step | None = None,
) -> FoldAnswer:
    """Everything `meshdrape fold` tells of a design.

    Parameters
    ----------
    design : Design
    nearest : "slope" or "position"
        What the nearest spar is nearest in.
    chart : (amplitudes, wavelengths), optional
        Ask for the envelope over a family of f as well.
    family : str
        Of that.
    stage, step : callable, optional
        For a progress bar.

    Raises
    ------
    DesignError
        The design makes no mould, or no spar near it can be made.
    """
    stage = stage or (lambda name, total: None)
    step = step or (lambda done: None)
    seconds: dict[str, float] = {}
    begun = last = time.perf_counter()

    def lap(name: str) -> None:
        nonlocal last
        now = time.perf_counter()
        seconds[name], last = now - last, now

    with CadMould() as mould:
        frame, gamma, cloth = _cloth(design)
        mould.begin(design, frame, cloth)
        # what needs no CAD mould is found out while that is made
        stage("looking for the largest factor", None)
        try:
            found = limits(design, step)
            lap("limits")
            stage("comparing ways to lay it", None)
            laying = ways(design)
            lap("ways")
        except MeshdrapeError:
            mould.made()  # what keeps it from being a mould at all is told first
            raise
        stage("draping the design", None)
        drape = _laid(design, frame, gamma, cloth, mould.made())
        lap("drape")
    stage("comparing criteria", None)
    said = verdict(design, drape)
    places = where(drape, design.locking_angle)
    warned = notices(design, drape, said)
    lap("criteria")
    stage("looking for the nearest spar", None)
    near = nearest_spar(design, drape, nearest, step)
    lap("nearest")
    charted = None
    if chart is not None:
        stage("draping the chart", chart[0] * chart[1])
        charted = envelope(design, family, chart, step)
        lap("chart")
    seconds["total"] = time.perf_counter() - begun
    return FoldAnswer(
        design=design,
        verdict=said,
        where=places,
        laying=laying,
        limits=found,
        nearest=near,
        warnings=warned,
        envelope=charted,
        seconds=seconds,
    )
