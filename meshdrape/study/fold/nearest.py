"""Question 5: what to change. The spar nearest to the one wanted that can be made, then draped to prove it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import DesignError, MeshdrapeError
from meshdrape.study.fold.answer import NearestSpar
from meshdrape.study.fold.design import Design, Shape
from meshdrape.study.fold.frame import Frame, frame_of
from meshdrape.study.fold.lay import FoldDrape
from meshdrape.study.fold.least import least_distance
from meshdrape.study.fold.limits import draped
from meshdrape.theory import Fold, Profile, last_column, linear_deviation, table, turning_points

FloatArray = NDArray[np.float64]

MEASURES = ("slope", "position")
# Stations of the answer, and the most knots its change may have.
STATIONS, MOST_KNOTS = 401, 161
# The first try stays this far below the locking angle, rad; one that leaves more room than ROOM is tried again.
MARGIN, ROOM = math.radians(0.01), math.radians(0.02)
MOST_DRAPES, MOST_ROUNDS = 8, 60
# The pairs of a round are met to this, rad.
MET = math.radians(1e-4)


def nearest_spar(
    design: Design, drape: FoldDrape, measure: str = "slope", step: Callable[[int], None] | None = None
) -> NearestSpar:
    """The f* nearest to f whose cloth shears nowhere past the locking angle, gamma free to choose.

    Parameters
    ----------
    design : Design
    drape : FoldDrape
        Of the design as it is.
    measure : "slope" or "position"
        Of f* - f, by least squares along the span.
    step : callable, optional
        Called with the number of drapes so far.

    Notes
    -----
    In the smooth limit the cloth can be laid if |ψ(y1) - ψ(y0)| is no more than the locking angle for every row y0 and
    column y1 that meet within reach, and the range of ψ over the columns that come down to ribbon-fed rows no more than
    twice that. ψ hangs on the slope of f alone and nearly linearly, so each round is a least-squares problem under
    linear inequalities, solved exactly; only pairs found wanting so far are in it. What is left of the discrete net is
    found by draping: the angle asked for is moved until the drape sits just below the locking angle. Where a design is
    so far off that no round closes, f is shrunk until it fits.
    """
    if measure not in MEASURES:
        msg = f"no measure is called {measure!r}: {', '.join(MEASURES)}"
        raise DesignError(msg)
    say = step or (lambda _: None)
    f = design.deviation_profile
    y = np.linspace(0.0, design.span, STATIONS)
    locking = design.locking_angle
    if drape.asked <= locking:
        return _answer(measure, y, f(y), f(y), drape, 1, unchanged=True, locking=locking)
    say(1)
    turned = draped(frame_of(design), design, frame_of(design).gamma_best())
    if turned.asked <= locking:
        return _answer(measure, y, f(y), f(y), turned, 2, unchanged=True, locking=locking)
    problem = _Problem(design, measure)
    angle, drapes = locking - MARGIN, 2
    best: tuple[float, FloatArray, FoldDrape] | None = None
    tried: tuple[FloatArray, FoldDrape] | None = None
    while drapes < MOST_DRAPES:
        try:
            values = f(y) + problem.change(angle)(y)
        except DesignError:
            # too far off for psi to be taken for linear: f shrunk is no least change, but one that fits
            values = f(y) + problem.shrunk(angle)(y)
        candidate = design.with_deviation(Shape("table", {"y": y, "f": values}))
        frame = frame_of(candidate)
        drapes += 1
        say(drapes)
        try:
            made = draped(frame, candidate, frame.gamma_best())
        except MeshdrapeError:
            angle *= 0.9
            continue
        room = locking - made.asked
        tried = values, made
        if room >= 0 and (best is None or angle > best[0]):
            best = angle, values, made
        if 0 <= room <= ROOM:
            break
        # from below half way and a bit, so as not to step over again
        angle += room - MARGIN if room < 0 else 0.9 * room
        if best is not None and angle <= best[0] + MARGIN / 4:
            break
    if best is not None:
        return _answer(measure, y, f(y), best[1], best[2], drapes, unchanged=False, locking=locking)
    values, made = tried if tried is not None else (f(y), turned)
    return _answer(measure, y, f(y), values, made, drapes, unchanged=False, locking=locking)


def _answer(
    measure: str,
    y: FloatArray,
    wanted: FloatArray,
    nearest: FloatArray,
    drape: FoldDrape,
    drapes: int,
    *,
    unchanged: bool,
    locking: float,
) -> NearestSpar:
    loss = np.abs(nearest - wanted)
    worst = int(np.argmax(loss))
    return NearestSpar(
        measure=measure,
        y=y,
        wanted=wanted,
        nearest=nearest,
        unchanged=unchanged,
        largest_loss=float(loss[worst]),
        largest_loss_at=float(y[worst]),
        rms_loss=float(np.sqrt(np.trapezoid(loss**2, y) / (y[-1] - y[0]))),
        gamma=drape.gamma,
        shear=drape.largest,
        proven=drape.asked <= locking,
        drapes=drapes,
    )


@dataclass
class _Pairs:
    """Stations i, j of the frame where ψ(j) - ψ(i) times `sign` may be no more than `share` of the angle."""

    i: NDArray[np.int64]
    j: NDArray[np.int64]
    sign: FloatArray
    share: FloatArray

    def joined(self, other: _Pairs) -> _Pairs:
        mine, theirs = (np.stack([p.i, p.j, p.sign, p.share]) for p in (self, other))
        i, j, sign, share = np.unique(np.concatenate([mine, theirs], axis=1), axis=1)
        return _Pairs(i.astype(np.int64), j.astype(np.int64), sign, share)


class _Problem:
    """Least squares for the change f* - f, a cubic spline through its values at the knots."""

    def __init__(self, design: Design, measure: str) -> None:
        from scipy.interpolate import CubicSpline

        self.design = design
        frame = frame_of(design)
        turns = len(turning_points(frame.fold))
        count = min(41 + 12 * turns, MOST_KNOTS)
        self.knots = np.linspace(0.0, design.span, count)
        # stations of the frame, and where they are in the design
        self.y = np.linspace(0.0, design.span, 4 * (count - 1) + 1)
        at = np.array([frame.station(float(y)) for y in self.y])
        basis = CubicSpline(self.knots, np.eye(count))
        value, self.slope, bend = basis(at), basis(at, 1), basis(at, 2)
        step, width = self.y[1], self.knots[1]
        # roughness counts where it is finer than the knots: waves shorter than some six of them
        if measure == "position":
            parts = [value, width**2 * bend]
        else:
            # slope leaves the mean of the change open: it is made 0
            parts = [self.slope, width * bend, value.mean(axis=0, keepdims=True) / design.span]
        self.root: FloatArray = np.asarray(np.linalg.qr(np.sqrt(step) * np.concatenate(parts), mode="r"))
        self.pairs: _Pairs | None = None
        self.values = np.zeros(count)

    def frame(self, values: FloatArray, tilt: float = 0.0) -> Frame:
        """With the change of these values, and the spar's slope larger by `tilt` everywhere."""
        design = self.design
        spar = design.fold.spar + self.spline(values) + linear_deviation(tilt, design.span)
        return frame_of(design, Fold(design.wing_profile, spar))

    def spline(self, values: FloatArray) -> Profile:
        return table(self.knots, values, self.design.span)

    def change(self, angle: float) -> Profile:
        """The least change with which every pair within reach keeps the angle."""
        values = self.values
        for k in range(MOST_ROUNDS):
            frame = self.frame(values)
            psi = frame.fold.psi(self.y)
            found, worst = self._wanting(frame, psi, angle)
            # the pairs of an earlier angle are solved for this one before they are believed
            if worst <= MET and (k > 0 or self.pairs is None):
                break
            self.pairs = found if self.pairs is None else self.pairs.joined(found)
            tilt = 1e-6
            rate = (self.frame(values, tilt).fold.psi(self.y) - psi) / tilt
            pairs = self.pairs
            # psi of the new values, linear about the present ones
            turn = rate[:, None] * self.slope
            row = pairs.sign[:, None] * (turn[pairs.j] - turn[pairs.i])
            room = pairs.share * angle - pairs.sign * (psi[pairs.j] - psi[pairs.i]) + row @ values
            values = least_distance(self.root, -row, -room)
        self.values = values
        return self.spline(values)

    def shrunk(self, angle: float) -> Profile:
        """The change that leaves as much of f as keeps the angle: for designs many times over the limit."""
        f = self.design.deviation_profile(self.knots)
        low, high = 0.0, 1.0
        for _ in range(12):
            middle = (low + high) / 2
            frame = self.frame((middle - 1) * f)
            _, worst = self._wanting(frame, frame.fold.psi(self.y), angle)
            low, high = (middle, high) if worst <= MET else (low, middle)
        return self.spline((low - 1) * f)

    def _wanting(self, frame: Frame, psi: FloatArray, angle: float) -> tuple[_Pairs, float]:
        """For each row the columns that ask the most of it either way, where that is past the angle."""
        fold, y = frame.fold, self.y
        last = last_column(fold, frame.height, y)
        rises = fold.spar.slope(y) > 0
        meets = (y[:, None] < y[None]) & (y[None] <= last[:, None]) & rises[:, None]
        difference = psi[None] - psi[:, None]
        found, worst = [], 0.0
        for sign in (1.0, -1.0):
            asked = np.where(meets, sign * difference, -np.inf)
            j = asked.argmax(axis=1)
            excess = asked[np.arange(len(y)), j] - angle
            i = np.flatnonzero(excess > MET / 2)
            worst = max(worst, float(excess.max()))
            found.append(np.stack([i, j[i], np.full(len(i), sign), np.ones(len(i))]))
        place = fold.spar_edge(0.0) + fold.tables.drift(y)
        depth = fold.depth(np.stack([place.real, place.imag], axis=-1))
        down = np.flatnonzero((depth <= frame.height) & (place.real <= fold.spar.length * (1 + 1e-9)))
        if len(down):
            low, high = down[psi[down].argmin()], down[psi[down].argmax()]
            excess_range = float(psi[high] - psi[low]) - 2 * angle
            worst = max(worst, excess_range / 2)
            if excess_range > MET:
                found.append(np.array([[low], [high], [1.0], [2.0]]))
        i, j, sign_, share = np.concatenate(found, axis=1)
        return _Pairs(i.astype(np.int64), j.astype(np.int64), sign_, share), worst
