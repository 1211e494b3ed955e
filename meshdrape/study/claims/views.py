"""What the report's figures show, from real runs, as plain arrays for drawing. Metres and radians."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.claims.drapes import DrapedFold, drape_fold
from meshdrape.study.claims.runs import FAMILIES, HEIGHT, LOCKING, SPAN, Runs
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    characteristic_net,
    discrete_net,
    gap,
    linear_deviation,
    slope_criterion,
    width_for,
    wing_fed_bound,
    within_reach,
)

FloatArray = NDArray[np.float64]

CHORD = 4.5  # x at which the wing of figure 5 ends, m


@dataclass(frozen=True)
class WeaveView:
    """Figure 2: ribbons of a width at a pitch, without shear and where they touch."""

    pitch: float
    width: float
    locking_angle: float
    gaps: tuple[float, float]


@dataclass(frozen=True, eq=False)
class SheetView:
    """A draped net on both surfaces rolled out: figures 4 and 7.

    Attributes
    ----------
    wing, spar : (n, rows, 2)
        Nodes: arc length along y, and x on the wing or z on the spar; NaN where a node lies on the other.
    wing_edge, spar_edge : (k, 2)
        The crease on either.
    wing_crossings, spar_crossings : tuple of two (m, 2, 2)
        Pieces of the rows' and of the columns' links from a node to the crease.
    region : (n - 1, rows - 1) int8
        1 rows from the left ribbon, 2 from the wing, 0 neither.
    shear : (n - 1, rows - 1) rad
    gamma : float
    height : float
    """

    wing: FloatArray
    spar: FloatArray
    wing_edge: FloatArray
    spar_edge: FloatArray
    wing_crossings: tuple[FloatArray, FloatArray]
    spar_crossings: tuple[FloatArray, FloatArray]
    region: NDArray[np.int8]
    shear: FloatArray
    gamma: float
    height: float


@dataclass(frozen=True, eq=False)
class ProfileView:
    """Figures 5 and 6: the origami spar, deviations f and f' from it by name, and a deformed one draped."""

    y: FloatArray
    origami: FloatArray
    deviations: dict[str, tuple[FloatArray, FloatArray]]
    draped: DrapedFold


@dataclass(frozen=True, eq=False)
class TurnView:
    """Figure 9: the discrete net about one crossing of a straight crease, both sheets rolled out about it.

    Attributes
    ----------
    wing, spar : (n, rows, 2)
        Nodes about the crossing, spacings; NaN on the other side.
    alpha, beta : float
    """

    wing: FloatArray
    spar: FloatArray
    alpha: float
    beta: float


@dataclass(frozen=True, eq=False)
class CriteriaView:
    """The criteria against the largest shear, over the amplitude of one family.

    Attributes
    ----------
    name : str
    amplitude : (n,)
    slope : (n,) eq. (20); spread : (n,) eq. (29); rad
    upright, best : (n,)
        Largest shear within reach with the left ribbon upright and at its best, rad.
    draped : (k, 2)
        Amplitude and largest shear of drapes, left ribbon at its best, rad.
    """

    name: str
    amplitude: FloatArray
    slope: FloatArray
    spread: FloatArray
    upright: FloatArray
    best: FloatArray
    draped: FloatArray


@dataclass(frozen=True, eq=False)
class ConvergenceView:
    """How far the largest shear of figure 4 lies below its limit, by spacing.

    Attributes
    ----------
    spacing : (n,) m
    ribbon_fed, wing_fed : (n,) rad
        Of the discrete net.
    orders : (float, float)
        Powers fitted to the two.
    draped : (k, 3)
        Spacing, and the same two of drapes on a mesh.
    """

    spacing: FloatArray
    ribbon_fed: FloatArray
    wing_fed: FloatArray
    orders: tuple[float, float]
    draped: FloatArray


@dataclass(frozen=True, eq=False)
class Views:
    """All of them."""

    weaves: tuple[WeaveView, ...]
    figure_4: SheetView
    profiles: ProfileView
    flat_spar: SheetView
    turn: TurnView
    criteria: tuple[CriteriaView, ...]
    convergence: ConvergenceView
    locking_angle: float


def make_views(runs: Runs) -> Views:
    """Run and gather them."""
    return Views(
        (_weave(LOCKING), _weave(float(np.radians(30.0)))),
        sheet_view(drape_fold(runs.figure_4, 0.05, 0.6, 5e-4)),
        _profiles(runs),
        sheet_view(drape_fold(runs.flat_spar, 0.1, 0.6, 1e-3)),
        _turn(),
        tuple(_criteria(runs, k) for k in range(len(FAMILIES))),
        _convergence(runs),
        LOCKING,
    )


def _weave(locking_angle: float, pitch: float = 5.0) -> WeaveView:
    width = width_for(locking_angle, pitch)
    return WeaveView(pitch, width, locking_angle, (gap(width, pitch, 0.0), gap(width, pitch, locking_angle)))


def sheet_view(draped: DrapedFold) -> SheetView:
    """A drape rolled out."""
    sheet, fold, node = draped.reference.sheet, draped.reference.sheet.fold, draped.node
    on, placed = sheet.on_spar, np.isfinite(node[..., 0])
    y = np.nan_to_num(node[..., 1])
    wing = np.stack([fold.wing.arc_length(y), node[..., 0]], axis=-1)
    spar = np.stack([fold.spar.arc_length(y), node[..., 2]], axis=-1)
    wing[on | ~placed], spar[~on | ~placed] = np.nan, np.nan
    fine = np.linspace(0.0, fold.span, 401)
    crossings: list[tuple[FloatArray, FloatArray]] = []
    edges = (fold.wing_edge, fold.spar_edge)
    # rows come over between the columns i - 1 and i, columns between the rows r - 1 and r
    i, r = sheet.entry_column, sheet.entry_row
    k = np.arange(len(sheet.y))
    first = on.argmax(axis=1)
    k = k[(first > 0) & on.any(axis=1)]
    for flat, edge, back in ((wing, edges[0], 1), (spar, edges[1], 0)):
        at_row, at_column = (np.stack([z.real, z.imag], axis=-1) for z in (edge(sheet.entry_y), edge(sheet.y[k])))
        crossings.append(
            (np.stack([flat[i - back, r], at_row], axis=1), np.stack([flat[k, first[k] - back], at_column], axis=1))
        )
    along = [np.stack([z.real, z.imag], axis=-1) for z in (edges[0](fine), edges[1](fine))]
    return SheetView(
        wing,
        spar,
        along[0],
        along[1],
        crossings[0],
        crossings[1],
        draped.reference.region,
        draped.shear,
        sheet.gamma,
        sheet.height,
    )


def _profiles(runs: Runs) -> ProfileView:
    y = np.linspace(0.0, SPAN, 401)
    made = {family.name: family.make(family.amplitudes[1]) for family in FAMILIES}
    chosen = {name: (f(y), f.slope(y)) for name, f in made.items()}
    draped = drape_fold(runs.real(2), runs.spacing, HEIGHT, runs.facet, chord=CHORD)
    return ProfileView(y, runs.wing(y), chosen, draped)


def _turn() -> TurnView:
    """A straight crease of slopes like 14 and 27 degrees, and the net about one of its crossings."""
    span, spacing = 1.0, 0.05
    fold = Fold(linear_deviation(0.25, span), linear_deviation(0.5, span))
    net = discrete_net(fold, spacing, 0.6, "free")
    # on a straight crease every crossing is like every other: take a column's in the middle
    y = float(net.sheet.y[len(net.sheet.y) // 2])
    wing, spar = net.place.copy(), net.place.copy()
    on = net.sheet.on_spar
    wing[on], spar[~on] = np.nan, np.nan
    origin = [np.array([z.real, z.imag]) for z in (complex(fold.wing_edge(y)), complex(fold.spar_edge(y)))]
    return TurnView(
        (wing - origin[0]) / spacing, (spar - origin[1]) / spacing, float(fold.alpha(y)), float(fold.beta(y))
    )


def _criteria(runs: Runs, k: int) -> CriteriaView:
    family = FAMILIES[k]
    amplitude = np.linspace(0.0, 1.25, 5 if runs.quick else 16) * family.amplitudes[1]
    slope, spread, upright, best = [], [], [], []
    for c in amplitude:
        fold = family.fold(float(c))
        reach = within_reach(fold, HEIGHT)
        slope.append(slope_criterion(family.make(float(c))).value)
        spread.append(wing_fed_bound(fold))
        upright.append(max(reach.wing_fed.shear, reach.ribbon_fed.shear))
        best.append(max(reach.wing_fed.shear, reach.ribbon_fed_best))
    draped = []
    for c in amplitude[[3] if runs.quick else [3, 6, 9, 12]]:
        fold = family.fold(float(c))
        one = drape_fold(fold, 0.05, HEIGHT, 7e-3, within_reach(fold, HEIGHT).gamma_best)
        draped.append((float(c), max(one.max_shear(WING_FED), one.max_shear(RIBBON_FED))))
    found = [np.array(values) for values in (slope, spread, upright, best)]
    return CriteriaView(family.name, amplitude, found[0], found[1], found[2], found[3], np.array(draped))


def _convergence(runs: Runs) -> ConvergenceView:
    limit = within_reach(runs.figure_4, 0.6)
    # whole columns to the span's end, so that the last one always lies there
    spacing = np.array([runs.figure_4.wing.length / (13 << k) for k in range(4 if runs.quick else 7)])
    nets = [characteristic_net(runs.figure_4, float(h), 0.6) for h in spacing]
    ribbon, wing = (
        region.shear - np.array([net.max_shear(k).shear for net in nets])
        for k, region in ((RIBBON_FED, limit.ribbon_fed), (WING_FED, limit.wing_fed))
    )
    tail = slice(1, None)
    orders = [float(np.polyfit(np.log(spacing[tail]), np.log(short[tail]), 1)[0]) for short in (ribbon, wing)]
    draped = []
    for h in spacing[: 1 if runs.quick else 4]:
        one = drape_fold(runs.figure_4, float(h), 0.6, 5e-4)
        draped.append(
            (
                float(h),
                limit.ribbon_fed.shear - one.max_shear(RIBBON_FED),
                limit.wing_fed.shear - one.max_shear(WING_FED),
            )
        )
    return ConvergenceView(spacing, ribbon, wing, (orders[0], orders[1]), np.array(draped))
