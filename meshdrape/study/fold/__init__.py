"""How far a spar may leave the origami fold: the questions of a wing box, answered by draping."""

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
from meshdrape.study.fold.ask import drape_design, fold_answer
from meshdrape.study.fold.design import Design, read_design
from meshdrape.study.fold.facts import facts

__all__ = [
    "Choice",
    "Design",
    "Envelope",
    "FoldAnswer",
    "FoldWarning",
    "Laying",
    "Limit",
    "NearestSpar",
    "Pair",
    "Shear",
    "SparMap",
    "Verdict",
    "Where",
    "drape_design",
    "facts",
    "fold_answer",
    "read_design",
]
