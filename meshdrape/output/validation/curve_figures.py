"""Curves: the criteria against the largest shear, and how fast nets tend to their limit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshdrape.output.chart import BLUE, FAINT, GREEN, INK, ORANGE, VERMILION, mark_locking, new_figure, png, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from meshdrape.study.claims.views import ConvergenceView, CriteriaView

_SLACK = 0.02  # of a shear: within this a criterion is neither unsafe nor too strict


def draw_criteria(views: tuple[CriteriaView, ...], locking_angle: float) -> bytes:
    """Equations (20) and (29) against the largest shear of a sheet laid at its best, a panel for each family of f."""
    with styled():
        figure = new_figure(7.8, 5.6)
        axes = figure.subplots(2, 3).ravel()
        for ax, view in zip(axes, views, strict=False):
            _criteria(ax, view, locking_angle)
        for ax in axes[len(views) :]:
            ax.axis("off")
        axes[0].set_ylabel("largest shear (degrees)")
        axes[3].set_ylabel("largest shear (degrees)")
        handles, labels = axes[0].get_legend_handles_labels()
        axes[-1].legend(handles, labels, loc="center", fontsize=8.5, labelspacing=0.9)
        return png(figure)


def _criteria(ax: Axes, view: CriteriaView, locking_angle: float) -> None:
    slope, spread, best, upright = (np.degrees(values) for values in (view.slope, view.spread, view.best, view.upright))
    # amplitudes of a length in mm, of a slope as they are
    length = view.name.startswith(("bump", "sine"))
    c = view.amplitude * (1000 if length else 1)
    lower, upper = (1 - _SLACK) * best, (1 + _SLACK) * best
    ax.fill_between(c, slope, best, where=slope <= lower, color=VERMILION, alpha=0.20, linewidth=0,
                    label="(20) unsafe")  # fmt: skip
    ax.fill_between(c, slope, best, where=slope >= upper, color=BLUE, alpha=0.12, linewidth=0, label="(20) too strict")
    ax.plot(c, spread, color=GREEN, linestyle=(0, (6, 2, 1, 2)), label="(29), ψ_max - ψ_min")
    ax.plot(c, slope, color=ORANGE, linestyle=(0, (5, 2)), label="(20), arctan max |f'|")
    ax.plot(c, upright, color=FAINT, linewidth=1.0, label="within reach, γ = 0")
    ax.plot(c, best, color=INK, linewidth=2.0, label="within reach, best γ")
    ax.plot(view.draped[:, 0] * (1000 if length else 1), np.degrees(view.draped[:, 1]), "o", color=INK, markersize=4.5,
            markerfacecolor="white", clip_on=False, zorder=5, label="draped, best γ")  # fmt: skip
    mark_locking(ax, locking_angle)
    ax.set_title(view.name)
    ax.set_xlabel("c (mm)" if length else "c")
    ax.set_xlim(0, float(c[-1]))
    ax.set_ylim(0, 1.06 * max(float(slope.max()), float(spread.max()), float(best.max())))


def draw_convergence(view: ConvergenceView) -> bytes:
    """How far the largest shear of figure 4 lies below its limit, by spacing, in both regions."""
    with styled():
        figure = new_figure(6.4, 4.2)
        ax = figure.subplots()
        mm = 1000 * view.spacing
        for short, order, colour, mark, name, column in (
            (view.wing_fed, view.orders[1], ORANGE, "s", "region II, rows from the wing", 2),
            (view.ribbon_fed, view.orders[0], BLUE, "o", "region I, rows from the left ribbon", 1),
        ):
            ax.loglog(mm, np.degrees(short), color=colour, label=f"{name}: power {order:.2f}")
            ax.loglog(1000 * view.draped[:, 0], np.degrees(view.draped[:, column]), mark, color=colour, markersize=6,
                      markerfacecolor="white", label="the same, draped on a mesh")  # fmt: skip
        for power, reference in ((0.5, view.wing_fed[-1]), (1.0, view.ribbon_fed[-1])):
            line = np.degrees(reference) * (mm / mm[-1]) ** power * 0.72
            ax.loglog(mm, line, color=FAINT, linewidth=0.9, linestyle=(0, (2, 2)))
            words = "square root" if power == 0.5 else "first order"
            ax.annotate(words, (mm[-1], line[-1]), (2, -3), textcoords="offset points", color=FAINT, va="top")
        ax.set_xlabel("spacing (mm)")
        ax.set_ylabel("largest shear: short of the limit by (degrees)")
        ax.set_title("Figure 4: how the discrete net tends to its limit")
        ax.grid(visible=True, which="major")
        ax.minorticks_off()
        ticks = [1.25, 2.5, 5, 10, 20, 40, 80]
        ax.set_xticks([tick for tick in ticks if 0.95 * mm[-1] <= tick <= 1.05 * mm[0]])
        ax.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        ax.legend(loc="upper left")
        return png(figure)
