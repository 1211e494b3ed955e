"""The study group report recomputed, claim by claim: what it says, what was found, and the verdict that follows.

runs, drapes -> sections_2_3 ... section_7_edges -> claim + judgement     a Claim for each statement
             -> views                                               what the report's figures show, from the same runs
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from meshdrape.study.claims import section_4, section_5, section_6, section_7, section_7_edges, sections_2_3
from meshdrape.study.claims.claim import Claim, Section
from meshdrape.study.claims.judgement import Judgement, Verdict
from meshdrape.study.claims.runs import Runs
from meshdrape.study.claims.views import Views, make_views

__all__ = ["Claim", "Judgement", "Recomputed", "Runs", "Section", "Verdict", "Views", "n_steps", "recompute"]

_GROUPS: tuple[tuple[str, tuple[Callable[[Runs], Claim], ...]], ...] = (
    ("Sections 2 and 3: the wing, the weave, the model problem", sections_2_3.CLAIMS),
    ("Section 4: perturbation of the origami solution", section_4.CLAIMS),
    ("Section 5: a simple special solution", section_5.CLAIMS),
    ("Section 6: alternative analytic treatment", section_6.CLAIMS),
    ("Section 7: a continuum model", section_7.CLAIMS + section_7_edges.CLAIMS),
)


@dataclass(frozen=True, eq=False)
class Recomputed:
    """The whole report.

    Attributes
    ----------
    sections : tuple of Section
    views : Views
        Data of the pictures.
    quick : bool
        Coarser runs and fewer of them.
    """

    sections: tuple[Section, ...]
    views: Views
    quick: bool

    @property
    def claims(self) -> tuple[Claim, ...]:
        """All of them, in the report's order."""
        return tuple(claim for section in self.sections for claim in section.claims)


def n_steps() -> int:
    """How many steps `recompute` reports: one a claim, and one for the pictures' data."""
    return sum(len(claims) for _, claims in _GROUPS) + 1


def recompute(*, quick: bool = False, progress: Callable[[int], None] | None = None) -> Recomputed:
    """Every claim of the report from runs made now.

    Parameters
    ----------
    quick : bool
        Drapes at 50 mm in place of 20, fewer designs: the same verdicts, rounder numbers.
    progress : callable
        Called with the number of steps done, of `n_steps`.
    """
    runs, done, sections = Runs(quick), 0, []
    for title, makers in _GROUPS:
        claims = []
        for make in makers:
            claims.append(make(runs))
            done += 1
            if progress:
                progress(done)
        sections.append(Section(title, tuple(claims)))
    views = make_views(runs)
    if progress:
        progress(done + 1)
    return Recomputed(tuple(sections), views, quick)
