"""Question 3: how to lay it. Which side first, from which end, the left-most ribbon how."""

from __future__ import annotations

import math
from dataclasses import replace

from meshdrape.errors import MeshdrapeError
from meshdrape.study.fold.answer import RULES, WELL_POSED, Choice, Laying, Shear
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.frame import Frame, frame_of
from meshdrape.study.fold.lay import FOLDED
from meshdrape.study.fold.limits import draped
from meshdrape.theory import RIBBON_FED, WING_FED, characteristic_net, returning_rows


def ways(design: Design) -> Laying:
    """Every choice and what it costs, by the characteristic construction at the design's own spacing.

    The cheapest first, to a hundredth of a degree, and of two that cost the same the one that shears less in the other
    region; ill-posed ways come last, but for those that keep the locking angle where no well-posed one does. Of these
    the construction knows too little, the sheet laid first being no longer undeformed: they are draped.
    """
    choices = []
    for first in ("wing", "spar"):
        for end in ("root", "tip"):
            frame = frame_of(design, first=first, end=end)
            rules = list(RULES)
            if (first, end) == (design.first, design.end) and design.rule == "design":
                rules.append("design")
            choices += [_choice(design, frame, rule) for rule in rules]

    def rank(choice: Choice) -> tuple[bool, bool, float, float]:
        cost, both = choice.largest, (choice.shear.wing_fed or 0.0) + (choice.shear.ribbon_fed or 0.0)
        kept = cost <= design.locking_angle
        return not kept, not choice.well_posed, round(math.degrees(cost), 2), round(math.degrees(both), 2)

    choices.sort(key=rank)
    proven: set[Choice] = set()
    while not choices[0].well_posed and choices[0].largest <= design.locking_angle and choices[0] not in proven:
        choices[0] = _draped(design, choices[0])
        proven.add(choices[0])
        choices.sort(key=rank)
    return Laying(tuple(choices), choices[0], frame_of(design).gamma_best())


def _choice(design: Design, frame: Frame, rule: str) -> Choice:
    gamma = frame.gamma(design.gamma if rule == "design" else rule)
    net = characteristic_net(frame.fold, design.spacing, frame.height, gamma, design.row_offset)
    shear = Shear(net.max_shear(WING_FED).shear, net.max_shear(RIBBON_FED).shear)
    returning = max((one.turn for one in returning_rows(frame.fold, gamma)), default=0.0)
    return Choice(frame.first, frame.end, rule, gamma, shear, returning)


def _draped(design: Design, choice: Choice) -> Choice:
    """An ill-posed choice with what its drape shears by, the sheet laid first included."""
    try:
        drape = draped(frame_of(design, first=choice.first, end=choice.end), design, choice.gamma)
    except MeshdrapeError:
        return replace(choice, returning=FOLDED)
    cost = FOLDED if drape.lost else max(drape.first_sheet, 2 * WELL_POSED)
    return replace(choice, shear=drape.largest, returning=cost)
