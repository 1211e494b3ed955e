"""Question 4: how far the design can go. The largest factor on f that still drapes, found on the drape itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from meshdrape.errors import MeshdrapeError
from meshdrape.study.fold.answer import RULES, Limit, Shear
from meshdrape.study.fold.design import Design
from meshdrape.study.fold.frame import Cloth, Frame, frame_of
from meshdrape.study.fold.lay import FoldDrape, lay
from meshdrape.study.fold.mould import ruled_mould
from meshdrape.theory import Fold, Reach, ribbon_reach, within_reach

# The drape at the factor found locks within this of the angle, rad, and not past it.
TOLERANCE = math.radians(0.004)
# Factors are tried up to the one at which f is this steep, and grow by this from one to the next.
STEEPEST, GROWTH = 1.5, 1.3
MOST_DRAPES = 16


def draped(frame: Frame, design: Design, gamma: float, spacing: float | None = None, **options: object) -> FoldDrape:
    """A drape on facets along the rulings."""
    cloth = Cloth.of(frame, spacing or design.spacing, design.row_offset, gamma)
    return lay(cloth, ruled_mould(frame, cloth), gamma, design.locking_angle, **options)  # type: ignore[arg-type]


def limits(design: Design, step: Callable[[int], None] | None = None) -> tuple[Limit, ...]:
    """The largest factor for every rule, and for the design's own where that is another.

    Parameters
    ----------
    step : callable, optional
        Called with the number of drapes so far.
    """
    rules = [*RULES, *(["design"] if design.rule == "design" else [])]
    search = _Search(design, step or (lambda _: None))
    found: list[Limit] = []
    for rule in rules:
        same = next((limit for limit in found if search.alike(limit, rule)), None)
        found.append(search.limit(rule) if same is None else replace(same, rule=rule))
    return tuple(found)


def scaled(design: Design, factor: float) -> Frame:
    """The frame of a design with f times a factor."""
    wing = design.wing_profile
    return frame_of(design, Fold(wing, wing + factor * design.deviation_profile))


@dataclass
class _Search:
    """Shear over the factor: foretold in the smooth limit to begin with, draped to decide."""

    design: Design
    step: Callable[[int], None]
    drapes: int = 0
    spacing_hides: float = 0.0  # by how much the last drape found stayed below what was foretold, rad
    _reach: dict[float, tuple[Frame, Reach]] = field(default_factory=dict)
    _laid: dict[tuple[float, float], FoldDrape | None] = field(default_factory=dict)

    def gamma(self, frame: Frame, rule: str) -> float:
        return frame.gamma(self.design.gamma if rule == "design" else rule)

    def alike(self, limit: Limit, rule: str) -> bool:
        """Whether a rule gives the gamma of the one whose limit is known, there and half way."""
        if not limit.factor:
            return False
        frames = [scaled(self.design, part * limit.factor) for part in (1.0, 0.5)]
        return all(abs(self.gamma(frame, rule) - self.gamma(frame, limit.rule)) < 1e-12 for frame in frames)

    def foretold(self, factor: float, rule: str) -> float:
        """Largest shear within reach, rad."""
        if factor not in self._reach:
            frame = scaled(self.design, factor)
            self._reach[factor] = frame, within_reach(frame.fold, frame.height)
        frame, reach = self._reach[factor]
        if rule == "best":
            ribbon_fed = reach.ribbon_fed_best
        elif (gamma := self.gamma(frame, rule)) == 0:
            ribbon_fed = reach.ribbon_fed.shear
        else:
            ribbon_fed = ribbon_reach(frame.fold, frame.height, gamma).ribbon_fed.shear
        return max(reach.wing_fed.shear, ribbon_fed)

    def lay(self, factor: float, rule: str) -> FoldDrape | None:
        """The drape, None where none can be laid."""
        frame = scaled(self.design, factor)
        gamma = self.gamma(frame, rule)
        if (factor, gamma) not in self._laid:
            self.drapes += 1
            self.step(self.drapes)
            try:
                self._laid[factor, gamma] = draped(frame, self.design, gamma)
            except MeshdrapeError:
                self._laid[factor, gamma] = None
        return self._laid[factor, gamma]

    def limit(self, rule: str) -> Limit:
        design = self.design
        y = np.linspace(0.0, design.span, 2001)
        steepest = float(np.abs(design.deviation_profile.slope(y)).max())
        if not design.deviates:
            frame = scaled(design, 1.0)
            return Limit(rule, None, self.gamma(frame, rule), Shear(None, None), math.inf)
        locking, most = design.locking_angle, STEEPEST / steepest
        # from far below any limit; nothing locks there but a ribbon turned for a larger factor
        factor, before = min(0.2 * math.tan(locking) / steepest, 0.5), None
        while factor <= most:
            locks = self.foretold(factor, rule) > locking
            if locks and before is not None:
                return self._between(rule, before, factor)
            before = before if locks else factor
            factor *= GROWTH
        if before is None:
            return Limit(rule, 0.0, self.gamma(scaled(design, 0.0), rule), Shear(None, None), most)
        at_most = self.lay(before, rule)
        shear = Shear(None, None) if at_most is None else at_most.largest
        return Limit(rule, None, self.gamma(scaled(design, before), rule), shear, before)

    def _between(self, rule: str, low: float, high: float) -> Limit:
        """Root of locking angle - TOLERANCE / 2 - drape's shear: foretold, then corrected drape by drape."""
        target = self.design.locking_angle - TOLERANCE / 2
        for _ in range(9):
            middle = (low + high) / 2
            near = self.foretold(middle, rule) - self.spacing_hides <= target
            low, high = (middle, high) if near else (low, middle)
        slope = (self.foretold(1.01 * high, rule) - self.foretold(0.99 * high, rule)) / (0.02 * high)
        factor, below, above = high, None, None
        best: tuple[float, FoldDrape] | None = None
        for _ in range(MOST_DRAPES):
            drape = self.lay(factor, rule)
            room = target - drape.asked if drape is not None else -1.0
            if drape is not None and room >= -TOLERANCE / 2 and (best is None or factor > best[0]):
                best = factor, drape
            if abs(room) <= TOLERANCE / 2:
                break
            if room > 0:
                below = factor, room
            else:
                above = factor, room
            if below is not None and above is not None:
                if above[0] - below[0] < 1e-7 * above[0]:
                    break  # a cell comes in here whose shear jumps past the angle
                part = below[1] / (below[1] - above[1])
                # never nearer to an end than a tenth: regula falsi creeps where the shear bends
                part = min(max(part, 0.1), 0.9)
                factor = below[0] + part * (above[0] - below[0])
            else:
                change = room / max(slope, 1e-9)
                factor = min(max(factor + change, 0.5 * factor), 1.5 * factor)
        if best is None:
            return Limit(rule, 0.0, self.gamma(scaled(self.design, 0.0), rule), Shear(None, None), high)
        self.spacing_hides = self.foretold(best[0], rule) - best[1].asked
        return Limit(rule, best[0], best[1].gamma, best[1].largest, high)
