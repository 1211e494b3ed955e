"""How sure the maximum shear is: the same drape on three tessellations of the mould."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.errors import MouldError, StartError
from meshdrape.mould.read import read_mould
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import Measures, measure
from meshdrape.weave.measures.noise import SIGMAS, mesh_noise

if TYPE_CHECKING:
    from meshdrape.mould import Mould
    from meshdrape.weave.net import Net

# Both tolerances from one tessellation to the next.
RATIO = 2.0
# Observed orders that may be believed, in powers of the tolerances. No error of facets falls faster than their width
# squared, which is the chord tolerance: a larger order is luck, and the first is taken.
LOWEST_ORDER, HIGHEST_ORDER, SUREST_ORDER = 0.4, 2.2, 1.0
# Safety factor of a bar from three grids of believable order
# (Roache, Perspective: A method for uniform reporting of grid refinement studies, J. Fluids Eng. 116, 1994); where the
# order is not to be believed the bar is their spread.
SAFETY = 1.25
# One and a half standard deviations, from a median of absolute values, of what cells change by.
LEAST_SIGMA = 1.5 * 1.4826
# Coarsest facets, rad.
COARSEST = math.radians(60.0)
# Angles between directions carried along a net err by this, rad: the least a bar can be.
ROUND_OFF = 1e-8


@dataclass(frozen=True)
class Convergence:
    """The maximum shear on three tessellations, and what follows from them.

    Attributes
    ----------
    triangles : (int, int, int)
        Of the mould, coarse to fine.
    angle_tolerance, chord_tolerance : (float, float, float)
        rad and mm.
    max_shear : (float, float, float)
        rad, coarse to fine.
    order : float or None
        In which power of the tolerances the error falls, where the three agree on one; None where they do not, and
        the bar is their spread.
    noise : float
        Shear by which the facets of the finest mesh can falsify a cell, rad
        (:func:`meshdrape.weave.measures.noise.mesh_noise`).
    error_bar : float
        By how much the finest maximum may be off for being measured on facets, rad, for this spacing.
    spacing_error : float
        By how much it may be off the limit of ever finer cloth, rad: its change from twice this spacing, times 1.25. Of
        first order where the largest shear is at the cloth's end, for the middle of the last cell lies half a spacing
        before it.
    """

    triangles: tuple[int, int, int]
    angle_tolerance: tuple[float, float, float]
    chord_tolerance: tuple[float, float, float]
    max_shear: tuple[float, float, float]
    order: float | None
    noise: float
    error_bar: float
    spacing_error: float

    def facts(self) -> dict[str, Any]:
        """All of it in plain types, angles in degrees (``_deg``)."""
        return {
            "triangles": list(self.triangles),
            "angle_tolerance_deg": [math.degrees(value) for value in self.angle_tolerance],
            "chord_tolerance_mm": list(self.chord_tolerance),
            "max_shear_deg": [math.degrees(value) for value in self.max_shear],
            "order": self.order,
            "mesh_noise_deg": math.degrees(self.noise),
            "error_bar_deg": math.degrees(self.error_bar),
            "spacing_error_deg": math.degrees(self.spacing_error),
        }


def refine(
    mould: Mould,
    fabric: Fabric,
    seed: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    extent: tuple[float, float, float, float] | None = None,
    *,
    engine: str = "fast",
    warp_turn: float | None = None,
    weft_turn: float | None = None,
    warp_path: ArrayLike | None = None,
    weft_path: ArrayLike | None = None,
    recrossing: bool = False,
    net: Net | None = None,
    threads: int | None = None,
) -> Convergence:
    """The error of the maximum shear, from draping on two coarser tessellations of the mould as well.

    Parameters
    ----------
    mould : Mould
        Of a B-rep or a script, read from its file: the file is read again with both tolerances doubled, and doubled
        once more.
    fabric, seed, direction, extent, engine, warp_turn, weft_turn, warp_path, weft_path, recrossing, threads
        As for :func:`meshdrape.drape`.
    net : Net, optional
        The drape on `mould` itself, where it is at hand: what was asked for it is asked again, start fibres and all,
        and nothing else given here counts but the threads.

    Raises
    ------
    MouldError
        If the mould is a mesh, which has nothing finer behind it.
    StartError
        If `net` was told at which shear to stop, which is then its largest, whatever the facets.

    Notes
    -----
    Where the three maxima fall monotonically with a believable order p, the error of the finest is that of Richardson's
    extrapolation, |f3 - f2| / (2^p - 1) with p at most 1, times 1.25; elsewhere their spread. The
    maximum wanders from cell to cell and facets err at random, so two maxima may agree by chance: the bar is never
    below one standard deviation of the mesh's own noise, nor below one and a half of the change from one tessellation
    to the next in the cells that shear at least half as much, the first change taken by half. Of 300 random drapes of
    moulds with known nets none was off by more, while three maxima alone missed 21; the bar was 5 times the mean error.
    """
    if net is None:
        require_refinable(mould)
        net = drape(
            mould,
            fabric,
            seed,
            direction,
            engine,
            extent,
            warp_turn=warp_turn,
            weft_turn=weft_turn,
            warp_path=warp_path,
            weft_path=weft_path,
            recrossing=recrossing,
            threads=threads,
        )
    require_refinable(mould, net.request.stop_at)
    nets = [net]
    for power in (1, 2):
        coarse = _read_again(mould, RATIO**power)
        # the very same start, on the coarser facets
        at = coarse.surface.closest_point(net.seed)[0].position(coarse.surface)
        nets.insert(0, _laid_alike(net, coarse, fabric, at, threads))
    taken = [measure(each) for each in nets]
    maxima = [_max_shear(each) for each in taken]
    change = max(change_of_cells(taken[1], taken[2]), change_of_cells(taken[0], taken[1]) / RATIO)
    noise = mesh_noise(net.surface.mould_part)
    order, error = extrapolated(*maxima)
    twice = Fabric((2 * fabric.warp_spacing, 2 * fabric.weft_spacing), fabric.initial_angle, fabric.locking_angle)
    wide = _laid_alike(net, mould, twice, net.seed, threads)
    moulds = [each.mould for each in nets]
    return Convergence(
        triangles=_three(len(each.triangles) for each in moulds),
        angle_tolerance=_three(each.angle_tolerance for each in moulds),
        chord_tolerance=_three(each.chord_tolerance for each in moulds),
        max_shear=_three(maxima),
        order=order,
        noise=noise,
        error_bar=max(error, noise / SIGMAS, LEAST_SIGMA * change, ROUND_OFF),
        spacing_error=SAFETY * abs(_max_shear(measure(wide)) - maxima[-1]),
    )


def change_of_cells(middle: Measures, fine: Measures) -> float:
    """Median absolute change from one net to another of the cells that shear at least half the largest, rad.

    The nets have one start and one fabric, so a cell is the same in both by its place from the seed.
    """
    if not fine.n_cells:
        return 0.0
    i, j = np.nonzero(fine.cell_touches_mould & (np.abs(fine.cell_shear) >= 0.5 * fine.max_shear))
    at = np.stack([i, j]) + np.subtract(middle.net.seed_index, fine.net.seed_index)[:, None]
    inside = ((at >= 0) & (at < np.reshape(middle.cell_shear.shape, (2, 1)))).all(axis=0)
    i, j, at = i[inside], j[inside], at[:, inside]
    both = middle.cell_touches_mould[at[0], at[1]]
    change = fine.cell_shear[i[both], j[both]] - middle.cell_shear[at[0, both], at[1, both]]
    return float(np.median(np.abs(change))) if len(change) else 0.0


def _laid_alike(net: Net, mould: Mould, fabric: Fabric, seed: ArrayLike, threads: int | None) -> Net:
    """Another mould or fabric, with all that was asked for a net."""
    fibres, request = net.start_fibres, net.request
    return drape(
        mould,
        fabric,
        seed,
        net.direction,
        request.engine,
        request.extent,
        warp_turn=fibres.warp_turn,
        weft_turn=fibres.weft_turn,
        warp_path=fibres.warp_path,
        weft_path=fibres.weft_path,
        stop_at=request.stop_at,
        recrossing=request.recrossing,
        threads=threads,
    )


def require_refinable(mould: Mould, stop_at: float | None = None) -> None:
    """Raise MouldError if a mould has no file of exact faces behind it, StartError if the cloth is told to stop."""
    if stop_at is not None:
        msg = (
            f"cloth that stops at {math.degrees(stop_at):g} degrees of shear has that for its largest, however fine "
            f"the facets: refine it without a shear to stop at"
        )
        raise StartError(msg)
    if mould.source is None or mould.angle_tolerance is None:
        msg = (
            f"{mould.source or 'the mould'} is a mesh, its own truth: there is nothing finer to compare it with; "
            f"refine the STEP, BREP or CadQuery script it was made from"
        )
        raise MouldError(msg)


def extrapolated(coarse: float, middle: float, fine: float, ratio: float = RATIO) -> tuple[float | None, float]:
    """Observed order and error of the finest of three values whose tolerances differ by a ratio.

    Returns
    -------
    order : float or None
        None where the three are not in the asymptotic range.
    error : float
        With its safety factor.
    """
    first, second = middle - coarse, fine - middle
    spread = max(coarse, middle, fine) - min(coarse, middle, fine)
    if first * second > 0:
        order = math.log(abs(first) / abs(second)) / math.log(ratio)
        if LOWEST_ORDER <= order <= HIGHEST_ORDER:
            return order, SAFETY * abs(second) / (ratio ** min(order, SUREST_ORDER) - 1)
    return None, spread


def _read_again(mould: Mould, factor: float) -> Mould:
    """The same faces of the same file with both tolerances larger by a factor."""
    assert mould.source is not None
    assert mould.angle_tolerance is not None
    assert mould.chord_tolerance is not None
    coarse = read_mould(
        mould.source,
        faces=[face.id for face in mould.cad_faces],
        chord_tolerance=factor * mould.chord_tolerance,
        angle_tolerance=min(factor * mould.angle_tolerance, COARSEST),
        parameters=dict(mould.parameters) or None,
    )
    return coarse.flipped() if mould.turned else coarse


def _max_shear(measures: Measures) -> float:
    return measures.max_shear if measures.n_cells else 0.0


def _three(values: Any) -> Any:
    a, b, c = values
    return a, b, c
