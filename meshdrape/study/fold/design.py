"""A wing box on paper: the design file of `meshdrape fold`, read strictly, in millimetres from then on."""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from meshdrape.errors import DesignError, FileError
from meshdrape.mould.files import brief, existing_file
from meshdrape.theory import Fold, Profile, named_deviation, named_profile
from meshdrape.theory.profiles import DEVIATIONS, PROFILES
from meshdrape.theory.sheet import MOST_NODES

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "ft": 304.8}

# Parameters by the power of length in them: what the unit does to each.
_POWER = {"a": -1, "radius": 1, "y": 1, "g": 1, "f": 1, "wavelength": 1, "length": 1}
_LENGTH_C = ("sine", "bump", "ripple")  # c is a length there, elsewhere a slope

# A wing shorter than this, or longer, mm, has its lengths in another unit than it says.
SHORTEST_SPAN, LONGEST_SPAN = 100.0, 200e3
# No number of a wing is larger, in whatever unit.
LARGEST = 1e9

# A chord or a wave so many spans long has forgotten its unit; so has a chord or a height of a thousandth of the span.
FAR_LONGER = 50.0

_SIZES = ("span", "chord", "spar_height", "spacing")
_TOP = ("unit", *_SIZES, "locking_angle_deg", "row_offset", "wing", "spar", "start")
_START = ("first", "gamma_deg", "end")


@dataclass(frozen=True, eq=False)
class Shape:
    """A profile or a deviation as the file names it: its kind and its parameters, lengths in mm."""

    name: str
    parameters: dict[str, Any] = field(default_factory=dict)

    def profile(self, span: float) -> Profile:
        """As a profile of a part."""
        given = {**self.parameters, **({"metre": 1000.0} if self.name == "real" else {})}
        return named_profile(self.name, span, **given)

    def deviation(self, span: float) -> Profile:
        """As a deviation f."""
        return named_deviation(self.name, span, **self.parameters)


@dataclass(frozen=True, eq=False)
class Design:
    """A wing, a spar, a fabric, and how the sheet is begun. Lengths mm, angles rad.

    Attributes
    ----------
    span, chord, spar_height, spacing : float
    locking_angle : float
    row_offset : float
        First row of the sheet laid first at this many spacings from the corner.
    wing : Shape
        g_w.
    spar : Shape or None
        g_s where the file gives it whole.
    deviation : Shape or None
        f where the file gives that: g_s = g_w + f.
    first : "wing" or "spar"
        The side the sheet is laid on undeformed.
    end : "root" or "tip"
        Where the left-most ribbon lies: y = 0 or y = span.
    gamma : float, "free" or "best"
        Turn of the left-most ribbon of the other side, rad.
    unit : str
        Of the file.
    source : Path or None
    """

    span: float
    chord: float
    spar_height: float
    spacing: float
    locking_angle: float
    row_offset: float
    wing: Shape
    spar: Shape | None
    deviation: Shape | None
    first: str = "wing"
    end: str = "root"
    gamma: float | str = 0.0
    unit: str = "mm"
    source: Path | None = None

    @cached_property
    def wing_profile(self) -> Profile:
        """g_w."""
        return self.wing.profile(self.span)

    @cached_property
    def deviation_profile(self) -> Profile:
        """F = g_s - g_w."""
        if self.deviation is not None:
            return self.deviation.deviation(self.span)
        assert self.spar is not None
        return self.spar.profile(self.span) - self.wing_profile

    @cached_property
    def fold(self) -> Fold:
        """The mould as designed: x along the chord, y from the root."""
        return Fold(self.wing_profile, self.wing_profile + self.deviation_profile)

    @property
    def deviates(self) -> bool:
        """Whether there is any f to speak of."""
        f = self.deviation_profile
        y = np.linspace(0.0, self.span, 1001)
        return bool(np.abs(f.slope(y)).max() > 1e-12)

    @property
    def rule(self) -> str:
        """Name of the rule for gamma: "gamma 0", "free", "best", or "design" for another number."""
        if isinstance(self.gamma, str):
            return self.gamma
        return "gamma 0" if self.gamma == 0 else "design"

    def with_deviation(self, deviation: Shape) -> Design:
        """The same wing with another f."""
        other = replace(self, spar=None, deviation=deviation)
        vars(other)["wing_profile"] = self.wing_profile  # with what is known of it: its arc lengths
        return other


def read_design(path: str | PathLike[str]) -> Design:
    """The design in a TOML file.

    Raises
    ------
    FileError
        The file cannot be read or is no TOML.
    DesignError
        It makes no wing box: one line that names the key and the way out.
    """
    source = existing_file(path, "design")
    try:
        table = tomllib.loads(source.read_bytes().decode("utf-8"))
    except (ValueError, RecursionError) as error:  # TOML's and UTF-8's are ValueErrors, as are endless integers
        msg = f"{path} is no TOML: {brief(error)}; write it as samples/designs have it"
        raise FileError(msg) from None
    try:
        return replace(design_from(table), source=source)
    except DesignError as error:
        msg = f"{source.name}: {error}"
        raise DesignError(msg) from None


def design_from(table: dict[str, Any]) -> Design:
    """The design that a parsed file describes; see :func:`read_design`."""
    _only(table, _TOP, "the design")
    unit = _word(table, "unit", None, UNITS)
    mm = UNITS[unit]
    size = {name: mm * _number(table, name, positive=True) for name in _SIZES}
    locking = _number(table, "locking_angle_deg", positive=True)
    if locking >= 90:
        msg = f"locking_angle_deg = {locking:g}: must lie below 90"
        raise DesignError(msg)
    offset = _number(table, "row_offset", 0.5)
    if not 0 <= offset <= 1:
        msg = f"row_offset = {offset:g}: must lie between 0 and 1"
        raise DesignError(msg)
    _check_sizes(size, unit)
    wing = _shape(_part(table, "wing"), "profile", PROFILES, "[wing]", size, unit)
    spar, deviation = _spar(_part(table, "spar"), size, unit)
    start = _part(table, "start", {})
    _only(start, _START, "[start]")
    design = Design(
        span=size["span"],
        chord=size["chord"],
        spar_height=size["spar_height"],
        spacing=size["spacing"],
        locking_angle=math.radians(locking),
        row_offset=offset,
        wing=wing,
        spar=spar,
        deviation=deviation,
        first=_word(start, "first", "wing", ("wing", "spar"), "[start] "),
        end=_word(start, "end", "root", ("root", "tip"), "[start] "),
        gamma=_gamma(start),
        unit=unit,
    )
    _check_profiles(design)
    return design


def _spar(part: dict[str, Any], size: dict[str, float], unit: str) -> tuple[Shape | None, Shape | None]:
    if "profile" in part and "deviation" in part:
        msg = "[spar] has both a profile and a deviation: give g_s by its profile, or f = g_s - g_w by deviation"
        raise DesignError(msg)
    if "profile" in part:
        return _shape(part, "profile", PROFILES, "[spar]", size, unit), None
    return None, _shape(part, "deviation", DEVIATIONS, "[spar]", size, unit)


def _shape(part: dict[str, Any], key: str, known: Any, where: str, size: dict[str, float], unit: str) -> Shape:
    name = _word(part, key, None, known, f"{where} ")
    given: dict[str, Any] = {}
    for parameter, value in part.items():
        if parameter == key:
            continue
        if parameter == "metre" or parameter == "span":
            msg = f"{where} {key} {name!r} does not take {_shown(parameter)}"
            raise DesignError(msg)
        if isinstance(value, list):
            given[parameter] = np.array([_real(one, f"{where} {parameter}[{k}]") for k, one in enumerate(value)])
        else:
            given[parameter] = _real(value, f"{where} {parameter}")
    for column in ("y", "g", "f"):
        if name == "table" and column in given and np.ndim(given[column]) != 1:
            msg = f"{where} {column} must be a list of numbers, such as {column} = [0.0, 1.0, 2.0, 3.0]"
            raise DesignError(msg)
    for parameter, value in given.items():
        if name != "table" and np.ndim(value):
            msg = f'{where} {parameter} must be a number, not a list; a list belongs to {key} = "table"'
            raise DesignError(msg)
    _check_shape(Shape(name, given), key, where, size, unit)
    return Shape(
        name, {parameter: value * UNITS[unit] ** _power(name, parameter) for parameter, value in given.items()}
    )


def _power(name: str, parameter: str) -> int:
    """Of length, in a parameter of a profile or a deviation."""
    if parameter == "c":
        return 1 if name in _LENGTH_C else 0
    return _POWER.get(parameter, 0)


def _check_shape(shape: Shape, key: str, where: str, size: dict[str, float], unit: str) -> None:
    """Make the shape once in the file's own unit, so that what is wrong with it is said in its numbers."""
    span, spacing = size["span"] / UNITS[unit], size["spacing"] / UNITS[unit]
    try:
        (named_profile if key == "profile" else named_deviation)(shape.name, span, **shape.parameters)
    except DesignError as error:
        msg = f"{where} {error}"
        raise DesignError(msg) from None
    for parameter in ("wavelength", "length", "y"):
        if parameter not in shape.parameters:
            continue
        longest = float(np.max(np.abs(shape.parameters[parameter])))
        what = f"{where} {parameter} = {longest:g}" if parameter != "y" else f"{where} y reaches {longest:g}"
        if longest > FAR_LONGER * span:
            msg = f"{what} {unit} on a span of {span:g} {unit}; is it in {unit}?"
            raise DesignError(msg)
        if parameter != "y" and longest < 2 * spacing:
            msg = f"{what} {unit} is shorter than two ribbons, which lie {spacing:g} {unit} apart; is it in {unit}?"
            raise DesignError(msg)


def _gamma(start: dict[str, Any]) -> float | str:
    value = start.get("gamma_deg", 0.0)
    if isinstance(value, str):
        if value not in ("free", "best"):
            msg = f'[start] gamma_deg = {_shown(value)}: give a number of degrees, "free" or "best"'
            raise DesignError(msg)
        return value
    degrees = _real(value, "[start] gamma_deg")
    if not abs(degrees) < 90:
        msg = f"[start] gamma_deg = {degrees:g}: the left-most ribbon must run down the spar; give less than 90"
        raise DesignError(msg)
    return math.radians(degrees)


def _check_sizes(size: dict[str, float], unit: str) -> None:
    span, chord, height, spacing = (size[name] for name in _SIZES)
    if not SHORTEST_SPAN <= span <= LONGEST_SPAN:
        msg = (
            f"span: a wing of {span / UNITS[unit]:g} {unit} is {'too short' if span < LONGEST_SPAN else 'too long'}; "
            f"is unit = {unit!r} right? known units: {', '.join(UNITS)}"
        )
        raise DesignError(msg)
    for name, value, what in (("chord", chord, "wide"), ("spar_height", height, "high")):
        if not span / (20 * FAR_LONGER) <= value <= FAR_LONGER * span:
            msg = (
                f"{name}: {value / UNITS[unit]:g} {unit} {what} on a span of {span / UNITS[unit]:g} {unit}; "
                f"are both in {unit}?"
            )
            raise DesignError(msg)
    if height > chord:
        msg = (
            f"spar_height = {height / UNITS[unit]:g}: the spar is higher than the wing is wide "
            f"(chord = {chord / UNITS[unit]:g}); are both in {unit}?"
        )
        raise DesignError(msg)
    nodes = span / spacing * (height / spacing)
    if nodes > MOST_NODES:
        msg = (
            f"spacing = {spacing / UNITS[unit]:g} {unit} makes {nodes:.2g} nodes on a spar of "
            f"{height / UNITS[unit]:g} {unit}, more than {MOST_NODES:.2g}; is it in {unit}?"
        )
        raise DesignError(msg)
    if spacing > min(height, span) / 4:
        msg = (
            f"spacing = {spacing / UNITS[unit]:g} {unit} leaves no four ribbons on a spar of "
            f"{height / UNITS[unit]:g} {unit}; is it in {unit}?"
        )
        raise DesignError(msg)


def _check_profiles(design: Design) -> None:
    """The profiles exist, are finite, and leave a wing and a spar."""
    fold, unit = design.fold, UNITS[design.unit]
    y = np.linspace(0.0, design.span, 2001)
    for name, profile in (("wing", fold.wing), ("spar", fold.spar)):
        slope, value = profile.slope(y), profile(y)
        if not (np.isfinite(slope).all() and np.isfinite(value).all()):
            k = int(np.argmin(np.isfinite(slope) & np.isfinite(value)))
            msg = f"[{name}] the profile has no value at y = {y[k] / unit:g}"
            raise DesignError(msg)
        steep = int(np.argmax(np.abs(slope)))
        if abs(slope[steep]) > 5:
            msg = (
                f"[{name}] the profile has a slope of {slope[steep]:.3g} at y = {y[steep] / unit:g} {design.unit}; "
                "no wing is that steep: check the unit of its parameters"
            )
            raise DesignError(msg)
    f = fold.spar(y) - fold.wing(y)
    away = int(np.argmax(np.abs(f)))
    # the far edge keeps its distance from the spar; what leaves by twice that has crossed the whole wing
    if abs(f[away]) > 2 * design.chord:
        msg = (
            f"[spar] the profiles cross: f = {f[away] / unit:.4g} {design.unit} at y = {y[away] / unit:g} takes the "
            f"spar right across the wing (chord = {design.chord / unit:g}); lower f"
        )
        raise DesignError(msg)


# --- values of a table ------------------------------------------------------------------------------------------------


def _only(table: dict[str, Any], known: tuple[str, ...], where: str) -> None:
    for key in table:
        if key not in known:
            msg = f"{where} has no key {_shown(key)}: {', '.join(known)}"
            raise DesignError(msg)


def _part(table: dict[str, Any], name: str, default: dict[str, Any] | None = None) -> dict[str, Any]:
    part = table.get(name, default)
    if part is None:
        msg = f"[{name}] is missing"
        raise DesignError(msg)
    if not isinstance(part, dict):
        msg = f"{name} must be a table: write [{name}] and its keys below"
        raise DesignError(msg)
    return part


def _word(table: dict[str, Any], key: str, default: str | None, known: Any, where: str = "") -> str:
    value = table.get(key, default)
    if value is None:
        msg = f"{where}{key} is missing; one of {', '.join(known)}"
        raise DesignError(msg)
    if not isinstance(value, str) or value not in known:
        msg = f"{where}{key} = {_shown(value)} is not known: {', '.join(known)}"
        raise DesignError(msg)
    return value


def _number(table: dict[str, Any], key: str, default: float | None = None, *, positive: bool = False) -> float:
    if key not in table and default is None:
        msg = f"{key} is missing"
        raise DesignError(msg)
    value = _real(table.get(key, default), key)
    if positive and not value > 0:
        msg = f"{key} = {value:g}: must be positive"
        raise DesignError(msg)
    return value


def _real(value: Any, what: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        msg = f"{what} = {_shown(value)} is not a number"
        raise DesignError(msg)
    # NaN fails the comparison too, and whole numbers may be too long for a float
    if not abs(value) <= LARGEST:
        finite = isinstance(value, int) or math.isfinite(value)
        msg = f"{what} = {_shown(value)} is {f'beyond {LARGEST:g}' if finite else 'not finite'}; check its unit"
        raise DesignError(msg)
    return float(value)


def _shown(value: Any) -> str:
    """A value as it stands in a message: whatever it is, in a few words."""
    try:
        text = repr(value)
    except ValueError:  # a whole number of thousands of digits
        return "a whole number of thousands of digits"
    return text if len(text) <= 60 else f"{text[:56]} ..."
