"""The allowable deviation over amplitude and wavelength: a family of designs, every one draped."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import DesignError, MeshdrapeError
from meshdrape.study.fold.answer import Envelope, Shear
from meshdrape.study.fold.design import Design, Shape
from meshdrape.study.fold.frame import Cloth, frame_of
from meshdrape.study.fold.lay import lay
from meshdrape.study.fold.mould import ruled_mould

FloatArray = NDArray[np.float64]

# Families of f by what their second parameter is called.
FAMILIES = {"sine": "wavelength", "ripple": "wavelength", "bump": "length"}
# Their steepest slope is this times c / wavelength; of a bump where r² = (5 - √17) / 4.
_BUMP = (5 - math.sqrt(17)) / 4
_STEEPNESS = {
    "sine": 2 * math.pi,
    "ripple": 2 * math.pi,
    "bump": 2 * math.sqrt(_BUMP) * (1 - _BUMP) * math.exp(1 - _BUMP),
}
# The chart's drapes have no more columns than this: it asks where the border is, not for the last hundredth.
MOST_COLUMNS = 280
# For the same reason: turn of the crease from facet to facet, rad, and the most facets.
TURN, FACETS = math.radians(0.06), 800
# Steepest slope of the family's first and last member, in tangents of the locking angle. Where f' changes sign the
# cloth sees its range: the limit lies near one half.
GENTLEST, STEEPEST = 0.2, 1.4


def envelope(
    design: Design,
    family: str = "sine",
    shape: tuple[int, int] = (20, 20),
    step: Callable[[int], None] | None = None,
    threads: int | None = None,
) -> Envelope:
    """Drape every design of a grid of amplitudes and wavelengths on the design's wing.

    Parameters
    ----------
    design : Design
    family : "sine", "ripple" or "bump"
    shape : (amplitudes, wavelengths)
        Both evenly spaced in their logarithm. The amplitudes of each wavelength are those of the same slopes, so that
        the locking angle is passed at every wavelength.
    step : callable, optional
        Called with the number of designs done.
    threads : int, optional
        Default the number of cores: the drapes let go of the interpreter.
    """
    if family not in FAMILIES:
        msg = f"no family is called {family!r}: {', '.join(FAMILIES)}"
        raise DesignError(msg)
    begun = time.perf_counter()
    wavelength = np.geomspace(design.span / 14, 2 * design.span, shape[1])
    slope = math.tan(design.locking_angle) * np.geomspace(GENTLEST, STEEPEST, shape[0])
    amplitude = slope[:, None] * wavelength / _STEEPNESS[family]
    spacing = max(design.spacing, design.fold.wing.length / MOST_COLUMNS)
    wing_fed, ribbon_fed = np.full((2, *shape), np.nan)
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        tasks = {
            pool.submit(_draped, design, family, float(amplitude[a, b]), float(w), spacing): (a, b)
            for a in range(shape[0])
            for b, w in enumerate(wavelength)
        }
        try:
            for done, task in enumerate(as_completed(tasks), start=1):
                shear = task.result()
                if shear is not None:
                    wing_fed[tasks[task]], ribbon_fed[tasks[task]] = shear.wing_fed, shear.ribbon_fed
                if step is not None:
                    step(done)
        except BaseException:
            pool.shutdown(cancel_futures=True)  # Ctrl-C, above all, must not wait for the rest of the chart
            raise
    return Envelope(
        family=family,
        amplitude=amplitude,
        wavelength=wavelength,
        wing_fed=wing_fed,
        ribbon_fed=ribbon_fed,
        allowed=allowed(amplitude, np.fmax(wing_fed, ribbon_fed), design.locking_angle),
        rule=design.rule,
        spacing=spacing,
        seconds=time.perf_counter() - begun,
    )


def _draped(design: Design, family: str, amplitude: float, wavelength: float, spacing: float) -> Shear | None:
    made = design.with_deviation(Shape(family, {"c": amplitude, FAMILIES[family]: wavelength}))
    try:
        frame = frame_of(made)
        gamma = frame.gamma(made.gamma)
        cloth = Cloth.of(frame, spacing, made.row_offset, gamma)
        return lay(cloth, ruled_mould(frame, cloth, TURN, FACETS), gamma, made.locking_angle, threads=1).largest
    except MeshdrapeError:
        return None  # too steep to lay a net over at all


def allowed(amplitude: FloatArray, largest: FloatArray, locking_angle: float) -> FloatArray:
    """Amplitude of each column at which its shear, (a, b) rad, first passes the angle, between two of its designs."""
    out = np.full(largest.shape[1], np.nan)
    for b in range(largest.shape[1]):
        over = np.flatnonzero(~(largest[:, b] <= locking_angle))
        if not len(over):
            continue
        k = int(over[0])
        if k == 0:
            out[b] = 0.0
            continue
        low, high = largest[k - 1, b], largest[k, b]
        part = (locking_angle - low) / (high - low) if np.isfinite(high) else 0.0
        out[b] = amplitude[k - 1, b] * (amplitude[k, b] / amplitude[k - 1, b]) ** part
    return out
