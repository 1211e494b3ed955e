"""What the report's figures 2, 4, 5, 6, 7 and 9 show, drawn from real runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshdrape.output.chart import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PURPLE,
    VERMILION,
    equal_scale,
    new_figure,
    png,
    segments,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from meshdrape.study.claims.views import ProfileView, SheetView, TurnView, WeaveView

_TINTS = {1: "#DCE9F5", 2: "#FBEBD0"}  # region I, region II


def draw_weave(weaves: tuple[WeaveView, ...]) -> bytes:
    """Figure 2: ribbons without shear and at the critical shear."""
    with styled():
        figure = new_figure(7.6, 2.85 * len(weaves))
        axes = figure.subplots(len(weaves), 2, squeeze=False)
        for row, weave in zip(axes, weaves, strict=True):
            for ax, shear in zip(row, (0.0, weave.locking_angle), strict=True):
                _ribbons(ax, weave, shear)
                free = weave.pitch * np.cos(shear) - weave.width
                gap = "ribbons touch" if abs(free) < 1e-9 else f"gap {100 * free / weave.pitch:.1f} % of the pitch"
                ax.set_title(f"Shear {np.degrees(shear):.3g}°: {gap}")
            row[0].text(
                -0.03, 0.5, f"width {100 * weave.width / weave.pitch:.1f} % of pitch", transform=row[0].transAxes,
                rotation=90, va="center", ha="right", color=FAINT,
            )  # fmt: skip
        return png(figure)


def _ribbons(ax: Axes, weave: WeaveView, shear: float) -> None:
    """Plain weave of 5 by 5 ribbons: warp over weft, and the weft again where it lies above."""
    from matplotlib.patches import Polygon

    count = 5
    along, lean = np.array([1.0, 0.0]), np.array([np.sin(shear), np.cos(shear)])
    places = (np.arange(count) - (count - 1) / 2) * weave.pitch
    ends = np.array([-0.5, 0.5]) * count * weave.pitch
    half = weave.width / 2 / np.cos(shear)  # from the middle of a ribbon to its side, along the other family
    for run, across, fill in ((lean, along, "#35B08B"), (along, lean, "#3F8FC4")):
        for place in places:
            side = [
                place * across + end * run + part * half * across
                for end, part in zip(ends[[0, 1, 1, 0]], (1, 1, -1, -1), strict=True)
            ]
            ax.add_patch(Polygon(np.array(side), facecolor=fill, edgecolor="white", linewidth=0.7))
    for i, u in enumerate(places):
        for j, v in enumerate(places):
            if (i + j) % 2:
                continue
            at = u * along + v * lean
            corners = [at + half * (p * along + q * lean) for p, q in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
            ax.add_patch(Polygon(np.array(corners), facecolor="#35B08B", edgecolor="none"))
            for pair in (corners[:2], corners[2:]):
                ax.plot(*np.transpose(pair), color="white", linewidth=0.7, solid_capstyle="butt")
    reach = weave.pitch * count / 2
    ax.set_xlim(-1.5 * reach, 1.5 * reach)
    ax.set_ylim(-1.02 * reach, 1.02 * reach)
    equal_scale(ax)
    ax.axis("off")


def draw_flattened(view: SheetView) -> bytes:
    """Figure 4: wing and spar rolled out, with the ribbons of both families and the two regions of the spar."""
    with styled():
        figure = new_figure(7.0, 8.35)
        # one scale for both: room in proportion to their heights
        heights = np.nanmax(view.wing[..., 1]) + 0.03, view.height + view.spar_edge[-1, 1] + 0.05
        axes = figure.subplots(2, 1, height_ratios=heights, sharex=True)
        _wing_sheet(axes[0], view)
        _spar_sheet(axes[1], view)
        for ax in axes:
            equal_scale(ax)
            ax.set_xlim(-0.03, float(view.spar_edge[-1, 0]) + 0.03)
        axes[0].set_ylim(-0.02, float(np.nanmax(view.wing[..., 1])) + 0.01)
        axes[0].set_ylabel("x (m)")
        axes[1].set_ylabel("z (m)")
        axes[1].set_ylim(-view.height - 0.02, float(view.spar_edge[-1, 1]) + 0.03)
        axes[1].set_xlabel("arc length along the span, of the wing above, of the spar below (m)")
        axes[0].set_title("Wing, rolled out: the sheet lies undeformed")
        axes[1].set_title("Spar, rolled out")
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        handles = [
            Line2D([], [], color=BLUE, label="along the wing"),
            Line2D([], [], color=GREEN, label="across the wing"),
            Line2D([], [], color=INK, linewidth=2.4, label="edge"),
            Patch(color=_TINTS[1], label="region I: rows from the left ribbon"),
            Patch(color=_TINTS[2], label="region II: rows from the wing"),
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3, handlelength=1.4, columnspacing=1.2)
        return png(figure)


def _wing_sheet(ax: Axes, view: SheetView) -> None:
    segments(ax, view.wing.transpose(1, 0, 2), BLUE, 1.0)
    segments(ax, view.wing, GREEN, 1.0)
    segments(ax, view.wing_crossings[0], BLUE, 1.0)
    segments(ax, view.wing_crossings[1], GREEN, 1.0)
    ax.plot(*view.wing_edge.T, color=INK, linewidth=2.4)


def _spar_sheet(ax: Axes, view: SheetView, tints: bool = True) -> None:
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Polygon

    edge = view.spar_edge
    outline = Polygon(np.concatenate([edge, edge[::-1] - [0.0, view.height]]), transform=ax.transData, fill=False, lw=0)
    drawn = []
    if tints:
        node = view.spar
        corners = np.stack([node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]], axis=2)
        for region, tint in _TINTS.items():
            cells = corners[view.region == region]
            cells = cells[np.isfinite(cells).all(axis=(1, 2))]
            drawn.append(PolyCollection(list(cells), facecolors=tint, edgecolors=tint, linewidths=0.5))
            ax.add_collection(drawn[-1], autolim=False)
    for lines, colour in (
        (view.spar.transpose(1, 0, 2), BLUE),
        (view.spar, GREEN),
        (view.spar_crossings[0], BLUE),
        (view.spar_crossings[1], GREEN),
    ):
        drawn.append(segments(ax, lines, colour, 1.0))
    ax.add_patch(outline)
    for collection in drawn:
        collection.set_clip_path(outline)
    ax.plot(*edge.T, color=INK if tints else VERMILION, linewidth=2.4)
    below = edge - [0.0, view.height]
    ax.plot(*below.T, color=FAINT, linewidth=0.8)
    for k in (0, -1):
        ax.plot(*np.stack([edge[k], below[k]]).T, color=FAINT, linewidth=0.8)
    if not tints:
        return
    for region, name in ((1, "I"), (2, "II")):
        here = view.region == region
        middle = np.nanmean(np.stack([view.spar[:-1, :-1][here], view.spar[1:, 1:][here]]), axis=(0, 1))
        inside = max(float(middle[1]), float(np.interp(middle[0], *below.T)) + 0.15)
        plate = {"boxstyle": "circle,pad=0.25", "facecolor": "white", "edgecolor": FAINT, "linewidth": 0.8}
        ax.text(middle[0], inside, name, fontsize=20, weight="bold", ha="center", va="center", bbox=plate)


def draw_profiles(view: ProfileView) -> bytes:
    """Figure 6: the spar's profile from above, origami and modified, and how far they are apart."""
    with styled():
        figure = new_figure(7.6, 5.2)
        top, bottom = figure.subplots(2, 1, sharex=True)
        top.plot(view.y, view.origami, color=INK, linewidth=2.2, label="origami, g_s = g_w")
        for (name, (f, slope)), colour in zip(
            view.deviations.items(), (ORANGE, BLUE, GREEN, VERMILION, PURPLE), strict=True
        ):
            top.plot(view.y, view.origami + f, color=colour, label=name)
            bottom.plot(view.y, slope, color=colour)
        top.set_ylabel("x = g_s (m)")
        top.set_title("Profiles of the spar, from above")
        bottom.axhline(0.0, color=INK, linewidth=2.2)
        bottom.set_ylabel("f'")
        bottom.set_title("Slope of the deviation from the origami spar: its variation is what costs shear")
        bottom.set_xlabel("y along the span (m)")
        bottom.set_xlim(0.0, float(view.y[-1]))
        top.legend(loc="upper left")
        return png(figure)


def draw_flat_spar(view: SheetView) -> bytes:
    """Figure 7: the net on a flat spar, front view; its rows are parallel to the edge."""
    with styled():
        figure = new_figure(7.6, 3.55)
        ax = figure.subplots()
        _spar_sheet(ax, view, tints=False)
        equal_scale(ax)
        rows = np.flatnonzero(np.isfinite(view.spar[..., 0]).all(axis=0))[:2]
        for k, (i, r) in enumerate(((0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (2, 1)), start=1):
            x, z = view.spar[i, rows[r]]
            ax.plot(x, z, "o", color=INK, markersize=3.5)
            ax.annotate(str(k), (x, z), (4, -9), textcoords="offset points", fontsize=8, weight="bold")
        ax.set_xlim(-0.03, float(view.spar_edge[-1, 0]) + 0.03)
        ax.set_ylim(-view.height - 0.02, float(view.spar_edge[-1, 1]) + 0.03)
        ax.set_xlabel("y along the span (m)")
        ax.set_ylabel("z (m)")
        ax.set_title("Flat spar, front view: rows parallel to the edge (red), cross-wise ribbons upright")
        return png(figure)


def draw_turn(view: TurnView) -> bytes:
    """Figure 9: the cells at the edge, on the wing and turned by ψ = β - α on the spar."""
    with styled():
        figure = new_figure(7.6, 4.0)
        wing, spar = figure.subplots(1, 2)
        psi = view.beta - view.alpha
        _lattice(wing, view.wing, view.alpha, 0.0, above=True)
        _lattice(spar, view.spar, view.beta, psi, above=False)
        wing.set_title("Wing, rolled out")
        spar.set_title("Spar, rolled out")
        _angle(wing, 0.0, view.alpha, 1.3, f"α = {np.degrees(view.alpha):.1f}°", (1.4, 0.22))
        _angle(spar, 0.0, view.beta, 1.3, f"β = {np.degrees(view.beta):.1f}°", (1.4, -0.22))
        words = f"ψ = β - α = {np.degrees(psi):.1f}°".replace("-", "\N{MINUS SIGN}")
        _angle(spar, -np.pi / 2, -np.pi / 2 + psi, 1.5, words, (0.12, -1.75))
        wing.set_xlabel("arc length s_w, spacings")
        wing.set_ylabel("x, spacings")
        spar.set_xlabel("arc length s_s, spacings")
        spar.set_ylabel("z, spacings")
        return png(figure)


def _lattice(ax: Axes, node: np.ndarray, edge: float, turn: float, *, above: bool) -> None:
    """The straight ribbons through the nodes of one side, up to the edge through the origin."""
    from matplotlib.patches import Polygon

    reach = 2.6
    near = node[np.isfinite(node[..., 0]) & (np.abs(node) < 4 * reach).all(axis=-1)]
    along, normal = np.array([np.cos(edge), np.sin(edge)]), np.array([-np.sin(edge), np.cos(edge)])
    far = 4 * reach * (normal if above else -normal)
    side = np.array([-4 * reach * along, 4 * reach * along, 4 * reach * along + far, -4 * reach * along + far])
    clip = Polygon(side, transform=ax.transData, facecolor="#F4F6F9", edgecolor="none")
    ax.add_patch(clip)
    for direction, colour in ((turn, BLUE), (turn + np.pi / 2, GREEN)):
        d = 8 * reach * np.array([np.cos(direction), np.sin(direction)])
        segments(ax, np.stack([near - d, near + d], axis=1), colour, 1.0).set_clip_path(clip)
    ax.plot(*near.T, "o", color=INK, markersize=2.6)
    ax.plot(*np.stack([-4 * reach * along, 4 * reach * along]).T, color=INK, linewidth=2.4)
    for angle in (0.0, np.pi / 2):
        d = reach * np.array([np.cos(angle), np.sin(angle)])
        ax.plot(*np.stack([-d, d]).T, color=FAINT, linewidth=0.8, linestyle=(0, (4, 3)))
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-reach, reach)
    equal_scale(ax)


def _angle(ax: Axes, start: float, end: float, radius: float, text: str, at: tuple[float, float]) -> None:
    """An arc between two directions about the origin, with its value."""
    turn = np.linspace(start, end, 40)
    ax.plot(radius * np.cos(turn), radius * np.sin(turn), color=VERMILION, linewidth=2.0)
    plate = {"facecolor": "white", "edgecolor": "none", "alpha": 0.9, "pad": 1.2}
    ax.text(*at, text, color=VERMILION, weight="bold", ha="left", va="center", bbox=plate)
