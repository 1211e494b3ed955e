"""One statement of the report, recomputed."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, isfinite

from meshdrape.study.claims.judgement import Judgement, Verdict


@dataclass(frozen=True)
class Claim:
    """What the report says, what was found, and the verdict that follows.

    Attributes
    ----------
    place : str
        Equation or section, as the report numbers them.
    says : str
        The claim in a sentence.
    found : str
        What was computed, with its numbers; one sentence or two.
    judgement : Judgement
    remarks : tuple of (Verdict, str)
        What follows from a verdict: shown only if that is the one the numbers gave.
    """

    place: str
    says: str
    found: str
    judgement: Judgement
    remarks: tuple[tuple[Verdict, str], ...] = ()

    @property
    def verdict(self) -> Verdict:
        """What the numbers say."""
        return self.judgement.verdict

    @property
    def remark(self) -> str:
        """What follows from the verdict, empty if nothing was prepared for it."""
        return next((text for verdict, text in self.remarks if verdict is self.verdict), "")


@dataclass(frozen=True)
class Section:
    """The claims of one section of the report.

    Attributes
    ----------
    title : str
    claims : tuple of Claim
    """

    title: str
    claims: tuple[Claim, ...]


def angle(value: float, digits: int = 2) -> str:
    """An angle in rad as text in degrees; in powers of ten where it is next to nothing."""
    return number(degrees(value), digits) + "°"


def number(value: float, digits: int = 2) -> str:
    """A number with so many decimals; in powers of ten where these would show none of it."""
    if abs(value) < 1e-300:
        value = 0.0  # without a sign
    if not isfinite(value):
        return f"{value}"
    if value == 0 or abs(value) >= 0.5 * 10.0**-digits:
        return f"{value:.{digits}f}"
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}·10^{int(exponent)}"
