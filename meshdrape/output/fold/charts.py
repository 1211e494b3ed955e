"""Pictures of the page of `meshdrape fold`: shear along the crease, map of the spar, limits, nearest spar."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.chart import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    VERMILION,
    mark_locking,
    new_figure,
    png,
    shear_map,
    styled,
)
from meshdrape.output.colour import NO_CLOTH, shear_colour

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from meshdrape.study.fold import Design, Envelope, FoldAnswer, Limit, NearestSpar, Pair, SparMap, Where

FloatArray = NDArray[np.float64]

METRE: Final = 1000.0  # pictures are in metres, answers in millimetres
_WIDTH: Final = 7.6  # inches, that of the page's text
_CELLS: Final = 24_000  # at most so many are drawn of a map
_NAMES_CLOSE: Final = 0.15  # of the span: stations nearer than this share one label
_AT_BEGIN: Final = 0.07  # of the span: a label there stands to the right of its station, clear of the axis
RULES: Final = {"gamma 0": "upright, γ = 0", "free": "straight on", "best": "best γ", "design": "as designed"}


def draw_along(where: Where, locking_angle: float, gamma: float) -> bytes:
    """ψ and the shear of both regions along the crease, with the pair of stations that sets each maximum."""
    with styled():
        figure = new_figure(_WIDTH, 3.8)
        turn, shear = figure.subplots(2, 1, sharex=True)
        y = where.y / METRE
        turn.plot(y, np.degrees(where.psi), color=INK)
        turn.set_ylabel("ψ (degrees)")
        turn.set_title("Turn of the net where it crosses the crease")
        shear.set_title("Largest shear down each column")
        for values, pair, turned, colour, name in (
            (where.wing_fed, where.worst_wing_fed, None, ORANGE, "rows from the sheet laid first"),
            (where.ribbon_fed, where.worst_ribbon_fed, gamma, BLUE, "rows from the left-most ribbon"),
        ):
            shear.plot(y, np.degrees(values), color=colour, label=name)
            if pair is not None:
                _mark_pair(turn, shear, where, pair, turned, colour)
        mark_locking(shear, locking_angle)
        shear.set_ylabel("shear (degrees)")
        shear.set_xlabel("y along the span (m)")
        shear.set_xlim(float(y.min()), float(y.max()))
        shear.set_ylim(0.0, 1.2 * max(shear.get_ylim()[1] / 1.05, 1e-3))
        low, high = turn.get_ylim()
        room = 0.12 * max(high - low, 1e-3)
        turn.set_ylim(low - room, high + room)
        figure.legend(*shear.get_legend_handles_labels(), loc="outside lower center", ncols=3)
        return png(figure)


def _mark_pair(turn: Axes, shear: Axes, where: Where, pair: Pair, gamma: float | None, colour: str) -> None:
    """The stations of the row and of the column, with the turn each brings, and the shear at the column's.

    A row brings the ψ of its own crossing, one from the left-most ribbon that ribbon's gamma.
    """
    order = np.argsort(where.y)
    stations = np.array([pair.y_row, pair.y_column])
    psi = np.degrees(np.interp(stations, where.y[order], where.psi[order]))
    if gamma is not None:
        psi[0] = np.degrees(gamma)
    turn.plot(stations / METRE, psi, "o--", color=colour, markersize=6, markerfacecolor="white", linewidth=1.0,
              clip_on=False, zorder=5)  # fmt: skip
    # one pair is named above its stations and one below: both may have the same
    above = gamma is None
    left, right = sorted(zip(stations / METRE, psi, ("row" if above else "left ribbon, γ", "column"), strict=True))
    span = float(np.ptp(where.y)) / METRE
    labels = [left, right]
    if right[0] - left[0] < _NAMES_CLOSE * span:
        labels = [(left[0], (max if above else min)(left[1], right[1]), f"{left[2]}, {right[2]}")]
    begin = float(where.y.min()) / METRE + _AT_BEGIN * span
    for at, height, name in labels:
        turn.annotate(name, (at, height), (0, 6 if above else -6), textcoords="offset points", color=colour,
                      fontsize=7.5, ha="left" if at < begin else "center", va="bottom" if above else "top",
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.8})  # fmt: skip
    at, value = stations[1] / METRE, abs(np.degrees(pair.shear))
    shear.plot(at, value, "o", color=colour, markersize=6, markerfacecolor="white", clip_on=False, zorder=5)
    aside, align = (6, "left") if at < begin else (-6, "right")
    shear.annotate(f"{value:.2f}°", (at, value), (aside, 3), textcoords="offset points", color=colour, fontsize=8,
                   weight="bold", ha=align)  # fmt: skip


def draw_spar(spar: SparMap, where: Where, locking_angle: float, second: str) -> bytes:
    """The sheet laid second, rolled out, coloured by its margin to locking, with the border of its regions."""
    from matplotlib.collections import PolyCollection

    with styled():
        figure = new_figure(_WIDTH, 2.6)
        ax = figure.subplots()
        corners, shear = _blocks(spar)
        colours = shear_colour(shear, locking_angle) / 255.0
        ax.add_collection(PolyCollection(list(corners / METRE), facecolors=colours, edgecolors="face", linewidths=0.25))
        ax.plot(*(_rolled(spar, where.crease, second) / METRE).T, color=FAINT, linewidth=0.9)
        boundary = _rolled(spar, spar.boundary, second)
        if len(boundary):
            ax.plot(*(boundary / METRE).T, color=INK, linewidth=1.6)
        for pair, colour in ((where.worst_wing_fed, ORANGE), (where.worst_ribbon_fed, BLUE)):
            if pair is not None:
                place = _rolled(spar, pair.place[None], second) / METRE
                ax.plot(*place.T, "o", color=colour, markersize=8, markerfacecolor="white", markeredgewidth=2.0)
        if len(corners):
            low, high = corners.reshape(-1, 2).min(axis=0) / METRE, corners.reshape(-1, 2).max(axis=0) / METRE
            room = 0.02 * (high - low)
            ax.set_xlim(low[0] - room[0], high[0] + room[0])
            ax.set_ylim(low[1] - 2 * room[1], high[1] + 2 * room[1])
        ax.grid(visible=False)
        ax.set_xlabel("arc length along the span (m)")
        ax.set_ylabel("z (m)" if second == "spar" else "x (m)")
        ax.set_title(f"Margin to locking on the {second}, rolled out; grey: crease, black: border of the two regions")
        _margin_bar(figure, ax, locking_angle, float(np.nanmax(shear)) if len(shear) else 0.0)
        return png(figure, palette=False)


def _margin_bar(figure: Any, ax: Axes, locking_angle: float, largest: float) -> None:
    """The colours of shear, told as what is left of the locking angle."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    top = max(locking_angle, 1.02 * largest)
    scale = ScalarMappable(Normalize(0.0, np.degrees(top)), shear_map(locking_angle, top))
    bar = figure.colorbar(scale, ax=ax, pad=0.015, aspect=14)
    bar.outline.set_linewidth(0.6)
    lock = np.degrees(locking_angle)
    step = next(s for s in (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 45.0) if np.degrees(top) / s <= 7)
    margins = np.arange(np.floor((lock - np.degrees(top)) / step) * step, lock + step, step)
    margins = margins[(margins <= lock + 1e-9) & (lock - margins <= np.degrees(top) + 1e-9)]
    bar.set_ticks([float(lock - margin) for margin in margins], labels=[f"{margin:g}" for margin in margins])
    bar.ax.invert_yaxis()
    bar.set_label("margin (degrees)")


def _blocks(spar: SparMap) -> tuple[FloatArray, FloatArray]:
    """Corners (m, 4, 2) of cells, or of blocks of them, and the largest |shear| in each, rad."""
    n, rows = spar.shear.shape
    step = int(np.ceil(np.sqrt(max(n * rows, 1) / _CELLS)))
    shear = np.abs(spar.shear)
    if step > 1:
        padded = np.full((-(-n // step) * step, -(-rows // step) * step), np.nan)
        padded[:n, :rows] = shear
        tiles = padded.reshape(padded.shape[0] // step, step, padded.shape[1] // step, step)
        shear = np.fmax.reduce(np.fmax.reduce(tiles, axis=3), axis=1)
        # a border block may be cut short; its far corners are the last nodes
    i = np.minimum(np.arange(shear.shape[0] + 1) * step, n)
    j = np.minimum(np.arange(shear.shape[1] + 1) * step, rows)
    node = spar.flat[np.ix_(i, j)]
    corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=2).reshape(-1, 4, 2)
    values = shear.reshape(-1)
    whole = np.isfinite(values) & np.isfinite(corners).all(axis=(1, 2))
    return corners[whole], values[whole]


def _rolled(spar: SparMap, points: FloatArray, second: str) -> FloatArray:
    """Points (k, 3) of the sheet laid second, on it rolled out, (k, 2)."""
    points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    y, s = spar.node[..., 1].ravel(), spar.flat[..., 0].ravel()
    known = np.isfinite(y) & np.isfinite(s)
    if not known.any():
        return np.empty((0, 2))
    order = np.argsort(y[known])
    along = np.interp(points[:, 1], y[known][order], s[known][order])
    return np.stack([along, points[:, 2 if second == "spar" else 0]], axis=1)


def draw_limits(design: Design, limits: tuple[Limit, ...], nearest: NearestSpar) -> bytes:
    """The wanted f, how far it may go by each rule for the left-most ribbon, and the nearest f that can be made."""
    with styled():
        figure = new_figure(_WIDTH, 3.2)
        panels = figure.subplots(1, 1 if nearest.unchanged else 2, squeeze=False)[0]
        _allowed(panels[0], design, limits)
        if not nearest.unchanged:
            _loss(panels[1], nearest)
        for ax in panels:
            ax.set_xlabel("y along the span (m)")
            ax.set_xlim(0.0, design.span / METRE)
            # below: inside, a wave leaves it no place
            ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=7.5)
        return png(figure)


def _allowed(ax: Axes, design: Design, limits: tuple[Limit, ...]) -> None:
    """The wanted f, and f as far as it may go by each rule."""
    y = np.linspace(0.0, design.span, 301)
    f = design.deviation_profile(y)
    ax.plot(y / METRE, f, color=INK, linewidth=2.2, label="wanted, f")
    for limit, colour, dash in zip(limits, (BLUE, GREEN, PURPLE, ORANGE), ("-", "--", "-.", ":"), strict=False):
        if limit.factor is not None:
            name = f"{RULES.get(limit.rule, limit.rule)}: {limit.factor:.2f} f"
            ax.plot(y / METRE, limit.factor * f, color=colour, linestyle=dash, label=name)
    ax.set_title("Allowable deviation")
    ax.set_ylabel("f = g_s - g_w (mm)")


def _loss(ax: Axes, nearest: NearestSpar) -> None:
    """The wanted f and the nearest, what is lost between them shaded."""
    y = nearest.y / METRE
    ax.plot(y, nearest.wanted, color=INK, linewidth=2.2, label="wanted, f")
    ax.plot(y, nearest.nearest, color=BLUE, label="nearest, f*")
    loss = f"loss, at most {nearest.largest_loss:.1f} mm"
    ax.fill_between(y, nearest.wanted, nearest.nearest, color=VERMILION, alpha=0.2, linewidth=0, label=loss)
    ax.set_title("Nearest spar that can be made")


def draw_envelope(envelope: Envelope, locking_angle: float) -> bytes:
    """Largest shear over amplitude and wavelength, every design draped, and the amplitude that is allowed."""
    from matplotlib.ticker import LogLocator

    with styled():
        figure = new_figure(_WIDTH, 3.3)
        ax = figure.subplots()
        largest = envelope.largest
        colours = shear_colour(largest, locking_angle)
        colours[~np.isfinite(largest)] = NO_CLOTH
        across = _borders(envelope.wavelength / METRE)
        up = np.stack([_borders(column) for column in envelope.amplitude.T], axis=1)
        for j, (left, right) in enumerate(pairwise(across.tolist())):
            ax.pcolormesh([left, right], up[:, j], colours[:, j : j + 1] / 255.0, shading="flat")
        for scale, values in ((ax.set_xscale, envelope.wavelength), (ax.set_yscale, envelope.amplitude[:, 0])):
            if _geometric(values):
                scale("log")
        for axis in (ax.xaxis, ax.yaxis):
            if axis.get_scale() == "log":
                axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.set_major_formatter(lambda value, _: f"{value:g}")
        ax.minorticks_off()
        ax.set_xlim(across[0], across[-1])
        ax.set_ylim(float(up.min()), float(up.max()))
        known = np.isfinite(envelope.allowed)
        ax.plot(envelope.wavelength[known] / METRE, envelope.allowed[known], color=INK, linewidth=2.2,
                label="allowed amplitude")  # fmt: skip
        ax.set_xlabel("length of the bump (m)" if envelope.family == "bump" else "wavelength (m)")
        ax.set_ylabel("amplitude c (mm)")
        rule = RULES.get(envelope.rule, envelope.rule)
        ax.set_title(f"Allowable {envelope.family}: {largest.size} designs draped at {envelope.spacing:.3g} mm, {rule}")
        ax.grid(visible=False)
        ax.legend(loc="best", frameon=True, framealpha=0.9, edgecolor=FAINT)
        finite = largest[np.isfinite(largest)]
        _margin_bar(figure, ax, locking_angle, min(float(finite.max()), 3 * locking_angle) if finite.size else 0.0)
        return png(figure, palette=False)


def _geometric(values: FloatArray) -> bool:
    """Whether values grow by one factor rather than by one step."""
    if len(values) < 3 or not (values > 0).all():
        return False
    return bool(np.ptp(np.diff(np.log(values))) < np.ptp(np.diff(values)) / values.mean())


def _borders(values: FloatArray) -> FloatArray:
    """Borders of the fields (n + 1,) about values (n,), halfway by the scale they are spaced on."""
    if _geometric(values):
        return np.asarray(np.exp(_borders(np.log(values))))
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def pictures(answer: FoldAnswer) -> dict[str, bytes]:
    """All of an answer's pictures by name; no envelope where none was asked for."""
    design, locking_angle = answer.design, answer.verdict.locking_angle
    second = "spar" if design.first == "wing" else "wing"
    drawn = {
        "along": draw_along(answer.where, locking_angle, answer.verdict.gamma),
        "spar": draw_spar(answer.where.spar, answer.where, locking_angle, second),
        "limits": draw_limits(design, answer.limits, answer.nearest),
    }
    if answer.envelope is not None:
        drawn["envelope"] = draw_envelope(answer.envelope, locking_angle)
    return drawn
