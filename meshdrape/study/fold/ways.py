"""Question 3: how to lay it. Which side first, from which end, the left-most ribbon how."""

from __future__ import annotations

from meshdrape.study.fold.answer import RULES, Choice, Laying, Shear
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.frame import Frame, frame_of
from meshdrape.theory import RIBBON_FED, WING_FED, characteristic_net, returning_rows


def ways(design: Design) -> Laying:
    """Every choice and what it costs, by the characteristic construction at the design's own spacing."""
    choices = []
    for first in ("wing", "spar"):
        for end in ("root", "tip"):
            frame = frame_of(design, first=first, end=end)
            rules = list(RULES)
            if (first, end) == (design.first, design.end) and design.rule == "design":
                rules.append("design")
            choices += [_choice(design, frame, rule) for rule in rules]
    choices.sort(key=lambda choice: (not choice.well_posed, round(choice.largest, 6)))
    return Laying(tuple(choices), choices[0], frame_of(design).gamma_best())


def _choice(design: Design, frame: Frame, rule: str) -> Choice:
    gamma = frame.gamma(design.gamma if rule == "design" else rule)
    net = characteristic_net(frame.fold, design.spacing, frame.height, gamma, design.row_offset)
    shear = Shear(net.max_shear(WING_FED).shear, net.max_shear(RIBBON_FED).shear)
    returning = max((one.turn for one in returning_rows(frame.fold, gamma)), default=0.0)
    return Choice(frame.first, frame.end, rule, gamma, shear, returning)
