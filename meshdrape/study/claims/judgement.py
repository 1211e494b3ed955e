"""How a verdict follows from numbers: one rule a kind of claim, each with its threshold in words.

No verdict is written down anywhere else; a claim hands its measured numbers to one of these rules. They may be arrays
of any shape, of which the worst entry counts. Where one of them is missing, or not finite, no rule judges: NOT_FOUND.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import ParamSpec

import numpy as np
from numpy.typing import ArrayLike


class Verdict(Enum):
    """What can be said of a claim once it was recomputed."""

    HOLDS = "holds"
    FIRST_ORDER = "holds to first order"
    UPPER_BOUND = "an upper bound, not the value"
    SUFFICIENT = "sufficient, not necessary"
    NECESSARY = "necessary, not sufficient"
    CONDITIONAL = "only under that condition"
    MISPRINT = "misprint"
    SIGN = "sign dropped"
    SWAPPED = "regions swapped"
    UNSAFE = "unsafe"
    TOO_STRICT = "too strict"
    NOT_BEST = "not the best"
    UNSAFE_AND_STRICT = "unsafe here, too strict there"
    WRONG = "does not hold"
    NOT_FOUND = "not found: a number is missing"


@dataclass(frozen=True)
class Judgement:
    """A verdict with the error it rests on.

    Attributes
    ----------
    verdict : Verdict
    error : float
        Of the claim as the report states it; of something that is said to occur, how much of it there is. NaN where
        nothing was found.
    unit : str
        Of the error: "deg", "" for a ratio or a count.
    threshold : str
        The rule in words: what would have made it hold.
    """

    verdict: Verdict
    error: float
    unit: str
    threshold: str


_Given = ParamSpec("_Given")


def _needs_numbers(judge: Callable[_Given, Judgement]) -> Callable[_Given, Judgement]:
    """A rule that gives NOT_FOUND where anything it is given is empty or not finite.

    No comparison with NaN is true: whatever a rule inferred from that would be a verdict for want of numbers.
    """

    @functools.wraps(judge)
    def judged(*given: _Given.args, **named: _Given.kwargs) -> Judgement:
        numbers = [np.asarray(value, float) for value in (*given, *named.values()) if not isinstance(value, str)]
        if all(array.size and np.isfinite(array).all() for array in numbers):
            return judge(*given, **named)
        unit = next((value for value in (*given, *named.values()) if isinstance(value, str)), "")
        return Judgement(Verdict.NOT_FOUND, float("nan"), unit, "a finite number wherever one was to be measured")

    return judged


def _largest(values: ArrayLike) -> float:
    """The largest modulus."""
    return float(np.abs(np.asarray(values, dtype=np.float64)).max())


def _within(limit: float, unit: str) -> str:
    """A limit in words."""
    return f"error at most {limit:.3g} {unit}".rstrip() if limit > 0 else "no error at all"


@_needs_numbers
def equality(error: ArrayLike, limit: float, unit: str = "") -> Judgement:
    """Two numbers that should be the same: HOLDS within a limit, else WRONG."""
    worst = _largest(error)
    return Judgement(Verdict.HOLDS if worst <= limit else Verdict.WRONG, worst, unit, _within(limit, unit))


@_needs_numbers
def printed(as_printed: ArrayLike, corrected: ArrayLike, limit: float, unit: str = "") -> Judgement:
    """A formula and its obvious correction: HOLDS as printed, MISPRINT where only the correction is right, or WRONG."""
    first, second = _largest(as_printed), _largest(corrected)
    verdict = Verdict.HOLDS if first <= limit else Verdict.MISPRINT if second <= limit else Verdict.WRONG
    return Judgement(verdict, first, unit, _within(limit, unit) + ", as printed or corrected")


@_needs_numbers
def signed(with_sign: ArrayLike, modulus: ArrayLike, limit: float, unit: str = "") -> Judgement:
    """A signed formula: HOLDS with its sign, SIGN where only its modulus is right, or WRONG."""
    first, second = _largest(with_sign), _largest(modulus)
    verdict = Verdict.HOLDS if first <= limit else Verdict.SIGN if second <= limit else Verdict.WRONG
    return Judgement(verdict, first, unit, _within(limit, unit) + ", with or without the sign")


def order_of(errors: ArrayLike) -> float:
    """The power with which errors (n,) fall whose parameter was halved from one to the next, by the last two."""
    array = np.abs(np.asarray(errors, dtype=np.float64))
    return float(np.log2(array[-2] / array[-1])) if array[-1] > 0 else float("inf")


@_needs_numbers
def first_order(errors: ArrayLike, least: float, unit: str = "", exact: float = 1e-9) -> Judgement:
    """An expansion whose small parameter was halved from one error to the next.

    FIRST_ORDER where the errors fall with at least a power of it, HOLDS where there are none, else WRONG.
    """
    array = np.abs(np.asarray(errors, dtype=np.float64))
    worst = _largest(array)
    if worst <= exact:
        verdict = Verdict.HOLDS
    else:
        verdict = Verdict.FIRST_ORDER if order_of(array) >= least else Verdict.WRONG
    return Judgement(verdict, float(array[-1]), unit, f"error falls with a power of {least:g} or more")


@_needs_numbers
def criterion(estimate: ArrayLike, true: ArrayLike, slack: float) -> Judgement:
    """A largest shear as a criterion foretells it against the one found, of several designs, rad.

    UNSAFE where more is found than foretold by over `slack` of it, TOO_STRICT where less is; the error is that of the
    worst design on the unsafe side, else on the strict one, in degrees.
    """
    foretold, found = np.asarray(estimate, dtype=np.float64), np.asarray(true, dtype=np.float64)
    short, over = found - foretold, foretold - found
    reference = np.maximum(foretold, found)
    unsafe, strict = bool((short > slack * reference).any()), bool((over > slack * reference).any())
    if unsafe:
        verdict = Verdict.UNSAFE_AND_STRICT if strict else Verdict.UNSAFE
    else:
        verdict = Verdict.TOO_STRICT if strict else Verdict.HOLDS
    worst = float(short.max() if unsafe else np.abs(over).max())
    return Judgement(verdict, float(np.degrees(worst)), "deg", f"within {100 * slack:g} % of the shear found")


@_needs_numbers
def optimum(value: ArrayLike, best: ArrayLike, slack: float) -> Judgement:
    """A choice said to make a shear least, of several designs, rad: HOLDS, or NOT_BEST where another leaves less.

    The slack is an angle, for what is of no account.
    """
    more = float(np.max(np.asarray(value, dtype=np.float64) - np.asarray(best, dtype=np.float64)))
    most = float(np.degrees(slack))
    verdict = Verdict.HOLDS if more <= slack else Verdict.NOT_BEST
    return Judgement(verdict, float(np.degrees(more)), "deg", f"no other leaves {most:.3g} deg less")


@_needs_numbers
def bound(estimate: ArrayLike, true: ArrayLike, slack: float) -> Judgement:
    """A maximum that is claimed to be attained, rad: HOLDS, UPPER_BOUND where it is never exceeded, else UNSAFE."""
    judged = criterion(estimate, true, slack)
    verdict = Verdict.UPPER_BOUND if judged.verdict is Verdict.TOO_STRICT else judged.verdict
    if verdict is Verdict.UNSAFE_AND_STRICT:
        verdict = Verdict.UNSAFE
    return Judgement(verdict, judged.error, judged.unit, judged.threshold)


@_needs_numbers
def condition(passed_but_fails: int, refused_but_works: int, designs: int) -> Judgement:
    """A yes-or-no condition over a number of designs: HOLDS, SUFFICIENT, NECESSARY or WRONG."""
    if passed_but_fails:
        verdict = Verdict.WRONG if refused_but_works else Verdict.NECESSARY
    else:
        verdict = Verdict.SUFFICIENT if refused_but_works else Verdict.HOLDS
    return Judgement(
        verdict, (passed_but_fails + refused_but_works) / designs, "", "no design misjudged; the error is their share"
    )


@_needs_numbers
def named_region(error_there: float, error_elsewhere: float, limit: float) -> Judgement:
    """A statement about one region that may be true of the other, rad: HOLDS, SWAPPED or WRONG."""
    verdict = Verdict.HOLDS if error_there <= limit else Verdict.SWAPPED if error_elsewhere <= limit else Verdict.WRONG
    error, most = float(np.degrees(error_there)), float(np.degrees(limit))
    return Judgement(verdict, error, "deg", f"error at most {most:.2g} deg, in the region named or in the other")


@_needs_numbers
def conditional(error_under_it: ArrayLike, error_without: ArrayLike, limit: float, unit: str = "") -> Judgement:
    """A general statement that may need a condition: HOLDS without it, CONDITIONAL where it holds under it, or WRONG.

    The error is that without the condition.
    """
    under, without = _largest(error_under_it), _largest(error_without)
    verdict = Verdict.HOLDS if max(under, without) <= limit else Verdict.CONDITIONAL
    if under > limit:
        verdict = Verdict.WRONG
    return Judgement(verdict, without, unit, _within(limit, unit) + ", with or without it")


@_needs_numbers
def occurs(measure: float, least: float, unit: str = "") -> Judgement:
    """Something that is said to occur: HOLDS where at least so much of it was measured, else WRONG."""
    return Judgement(
        Verdict.HOLDS if measure >= least else Verdict.WRONG, measure, unit, f"at least {least:.3g} {unit}".rstrip()
    )


@_needs_numbers
def counterexample(exception: ArrayLike, limit: float, unit: str = "") -> Judgement:
    """A claim that there is no other: WRONG if all that it excludes was found, to within a limit of 0, else HOLDS."""
    worst = _largest(exception)
    verdict = Verdict.WRONG if worst <= limit else Verdict.HOLDS
    return Judgement(verdict, worst, unit, f"not contradicted within {limit:.3g} {unit}".rstrip())
