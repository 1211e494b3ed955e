"""What stands around a picture of a net: title, colour scale, keys, scale bar, axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from meshdrape.output.colour import NO_CLOTH, WARP, WEFT, scale_position, shear_colour
from meshdrape.output.picture.camera import View
from meshdrape.output.picture.stage import Stage
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.weave.fabric import Fabric
    from meshdrape.weave.measures.cells import Measures
    from meshdrape.weave.net import Net

INK: Final = (28, 30, 36)
FAINT: Final = (100, 104, 112)

_BAR: Final = (70.0, 88.0, 900.0, 36.0)  # colour scale: left, bottom, width, height, pixels
_BAR_STEPS: Final = 450
_BELOW_STEPS: Final = (0.5, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0)  # degrees between ticks below the locking angle
_BEYOND: Final = (5, 10, 15, 20, 30, 45, 60, 90)  # degrees that may have a tick above it
_TICK_GAP: Final = 62.0  # pixels that a tick's figures need
_KEYS: Final = (1040.0, 146.0, 40.0)  # left, top row, from row to row
_SCALE: Final = (1930.0, 72.0, 320.0)  # right, height, most length
_AXES: Final = (1600.0, 106.0, 52.0)  # middle, length


def add_title(stage: Stage, net: Net, measures: Measures, left: float, top: float) -> None:
    """Write the largest shear, how that compares with the locking angle, and what was draped."""
    title, place = _verdict(net, measures)
    stage.add_text(title, (left, top - 34), 44, INK, bold=True)
    stage.add_text(place, (left, top - 88), 29, INK)
    stage.add_text(_draped(net), (left, top - 128), 25, FAINT)


def add_colour_scale(stage: Stage, locking_angle: float) -> None:
    """Draw the scale of shear with the locking angle marked on it."""
    left, bottom, width, height = _BAR
    position = (np.arange(_BAR_STEPS) + 0.5) / _BAR_STEPS
    edges = left + width * np.arange(_BAR_STEPS + 1) / _BAR_STEPS
    for k, colour in enumerate(shear_colour(_shear_at(position, locking_angle), locking_angle).tolist()):
        a, b = edges[k], edges[k + 1]
        stage.add_polygon([(a, bottom), (b, bottom), (b, bottom + height), (a, bottom + height)], colour)
    stage.add_text("Absolute shear, degrees", (left, bottom + height + 26), 25, INK)
    lock_deg = float(np.degrees(locking_angle))
    for shear_deg in _ticks(lock_deg):
        x = left + width * float(scale_position(np.radians(shear_deg), locking_angle))
        stage.add_stroke((x, bottom), (x, bottom - 8), INK, 2)
        stage.add_text(f"{shear_deg:g}", (x, bottom - 26), 25, INK, align="centre")
    x = left + 0.5 * width
    stage.add_stroke((x, bottom - 10), (x, bottom + height + 10), INK, 4)
    stage.add_text(f"{lock_deg:g}", (x, bottom - 26), 25, INK, align="centre", bold=True)
    stage.add_text("locking angle", (x, bottom + height + 26), 25, INK, align="centre", bold=True)


def add_keys(stage: Stage, step: tuple[int, int]) -> None:
    """Explain the lines, and the grey: `step` is how many fibres of warp and weft go for one drawn."""
    left, top, row = _KEYS
    for k, (name, colour, every) in enumerate((("Warp", WARP, step[0]), ("Weft", WEFT, step[1]))):
        stage.add_stroke((left, top - k * row), (left + 56, top - k * row), colour, 4)
        which = f", every {every}{_ordinal(every)} fibre" if every > 1 else ", every fibre"
        stage.add_text(name + which, (left + 76, top - k * row), 25, INK)
    y = top - 2 * row
    stage.add_polygon([(left, y - 12), (left + 56, y - 12), (left + 56, y + 12), (left, y + 12)], NO_CLOTH)
    stage.add_text("Mould without cloth", (left + 76, y), 25, INK)


def add_scale_bar(stage: Stage, view: View) -> None:
    """Draw a length to compare with."""
    right, y, most = _SCALE
    length = _round_down(most * view.mm_per_pixel)
    left = right - length / view.mm_per_pixel
    stage.add_stroke((left, y), (right, y), INK, 5)
    for x in (left, right):
        stage.add_stroke((x, y - 11), (x, y + 11), INK, 3)
    text = f"{length / 1000:g} m" if length >= 1000 else f"{length:g} mm"
    stage.add_text(text, (0.5 * (left + right), y + 30), 27, INK, align="centre")


def add_axes(stage: Stage, view: View) -> None:
    """Draw the directions of x, y and z."""
    middle, length = np.array(_AXES[:2]), _AXES[2]
    directions = view.axes[:2].T * length
    for k in np.argsort(view.axes[2]):  # those that point away first
        end = middle + directions[k]
        stage.add_stroke(middle, end, FAINT, 3)
        if np.linalg.norm(directions[k]) > 0.2 * length:
            outward = directions[k] / np.linalg.norm(directions[k])
            stage.add_text("xyz"[k], end + 17 * outward, 25, FAINT, align="centre")


def _verdict(net: Net, measures: Measures) -> tuple[str, str]:
    if not np.isfinite(measures.max_shear):
        return "No whole cell of cloth on the mould", ""
    shear_deg, lock_deg = np.degrees(measures.max_shear), np.degrees(net.fabric.locking_angle)
    side = "above" if shear_deg > lock_deg else "below"
    title = f"Largest shear {shear_deg:.1f}°, {abs(shear_deg - lock_deg):.1f}° {side} "
    title += f"the locking angle of {lock_deg:g}°"
    x, y, z = measures.max_shear_position
    face = f", face {measures.max_shear_face}" if measures.max_shear_face else ""
    over = 100 * measures.over_locking_fraction
    return (
        title,
        f"at ({x:.0f}, {y:.0f}, {z:.0f}) mm{face}; {over:.1f} % of the cloth is above the locking angle",
    )


def _draped(net: Net) -> str:
    placed = int(np.count_nonzero(net.node_status == NodeStatus.PLACED))
    name = f"{net.mould.source.name}, " if net.mould.source else ""
    return f"{name}{_weave(net.fabric)}, {placed:,} nodes on the mould"


def _weave(fabric: Fabric) -> str:
    if fabric.warp_spacing == fabric.weft_spacing:
        text = f"spacing {fabric.warp_spacing:g} mm"
    else:
        text = f"spacing {fabric.warp_spacing:g} mm along warp, {fabric.weft_spacing:g} mm along weft"
    angle = np.degrees(fabric.initial_angle)
    return text if np.isclose(angle, 90) else f"{text}, initial angle {angle:g}°"


def _shear_at(position: np.ndarray, locking_angle: float) -> np.ndarray:
    """Return the shear at positions of the scale's bar, the inverse of `scale_position`."""
    beyond = locking_angle * (0.5 * np.pi / locking_angle) ** (2.0 * position - 1.0)
    return np.where(position <= 0.5, 2.0 * position * locking_angle, beyond)


def _ticks(lock_deg: float) -> list[float]:
    """Return the degrees to write at the scale, but for the locking angle itself."""
    lock = np.radians(lock_deg)
    room = _TICK_GAP / _BAR[2]
    step = next((s for s in _BELOW_STEPS if 0.5 * s / lock_deg >= room), lock_deg)
    below = np.arange(0.0, lock_deg, step)
    ticks = [float(t) for t in below if float(scale_position(np.radians(t), lock)) < 0.5 - room]
    last = 0.5
    for tick in _BEYOND:
        at = float(scale_position(np.radians(tick), lock))
        if at > last + room and (tick == 90 or at < 1.0 - room):
            ticks.append(float(tick))
            last = at
    return ticks


def _round_down(length: float) -> float:
    """Return the largest of 1, 2 and 5 times a power of ten that is not above a length."""
    decade = 10.0 ** np.floor(np.log10(length))
    return float(max(digit * decade for digit in (1, 2, 5) if digit * decade <= length * (1 + 1e-12)))


def _ordinal(number: int) -> str:
    if number % 100 in (11, 12, 13):
        return "th"
    return {1: "st", 2: "nd", 3: "rd"}.get(number % 10, "th")
