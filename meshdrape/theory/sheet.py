"""A sheet laid undeformed on the wing and folded over the crease: what both constructions of its net start from.

Columns (cross-wise ribbons, weft) stand on the wing at s_w = i spacing; rows (span-wise ribbons, warp) run there at
x = corner + (j + row_offset) spacing. Rows of negative j start on the left-most ribbon of the spar. Row index r counts
along the weft, from the wing over the crease and down the spar: j = first_row - r.

On the spar all cells between two columns have the same row link and all cells between two rows the same column link
(section 6.1: cells are parallelograms). So every node there is the place where its row entered the spar plus what the
columns have added since, ``entry place + drift of the columns``, however the two are found.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import DesignError, NetError
from meshdrape.theory.fold import ComplexArray, Fold
from meshdrape.theory.quadrature import FloatArray, root_between

Gamma = float | Literal["free"]

NEITHER, RIBBON_FED, WING_FED = 0, 1, 2
MOST_NODES = 15_000_000  # some 2 GB of arrays


class Worst(NamedTuple):
    """The largest |shear| of a region: rad, the cell (column, row index) and its place (x, y, z); NaN of no cell."""

    shear: float
    cell: tuple[int, int]
    place: FloatArray


class WingLattice:
    """The lattice on the wing.

    Parameters
    ----------
    fold : Fold
    spacing : float
        Of both families of ribbons, in the unit of the fold.
    height : float
        The spar reaches this far below the crease: rows are followed that far.
    gamma : float or "free"
        Turn of the left-most spar ribbon from the vertical towards larger y, rad; "free": straight on over the crease.
    row_offset : float
        First wing row at this many spacings from the corner, 0 <= row_offset <= 1. At 0 row j = 0 starts on the corner.

    Attributes
    ----------
    y : (n,) where each column crosses the crease
    x : (rows,) where each row lies on the wing
    on_spar : (n, rows) bool
    """

    def __init__(self, fold: Fold, spacing: float, height: float, gamma: Gamma = 0.0, row_offset: float = 0.5) -> None:
        self.fold, self.spacing, self.height, self.row_offset = fold, spacing, height, row_offset
        self.gamma = _checked(fold, spacing, height, gamma, row_offset)
        count = int(np.floor(fold.wing.length / spacing * (1 + 1e-12))) + 1
        least = count * int(height / spacing)
        if least > MOST_NODES:
            raise _too_large(spacing, least)
        self.s = spacing * np.arange(count)
        self.y = fold.wing.at_arc_length(self.s)
        self.edge = fold.spar(self.y)
        self.corner = float(fold.spar(0.0))
        self.spar_corner = complex(0.0, float(fold.wing(0.0)))
        self.first_row = int(np.ceil((self.edge.max() - self.corner) / spacing - row_offset)) + 1
        self.row = np.arange(self.first_row, self._last_row() - 1, -1)
        if count * len(self.row) > MOST_NODES:
            raise _too_large(spacing, count * len(self.row))
        self.x = self.corner + (self.row + row_offset) * spacing
        # a node within 1e-9 spacings of the crease counts as on the spar: its link has no direction on the wing
        self.on_spar = self.x < self.edge[:, None] + 1e-9 * spacing

    @cached_property
    def drift(self) -> ComplexArray:
        """The smooth drift H at the columns, (n,)."""
        return self.fold.drift(self.y)

    def _last_row(self) -> int:
        """The row whose every node lies deeper than the spar's height."""
        path = self.spar_corner + self.drift - self.drift[0]
        down = -1j * np.exp(1j * self.gamma)
        length = self.height
        for _ in range(8):
            reached = path + length * down
            depth = self.fold.depth(np.stack([reached.real, reached.imag], axis=-1))
            short = self.height - float(depth.min())
            if short <= 0:
                break
            length += 1.1 * short / np.cos(self.gamma)
        return -int(np.ceil(length / self.spacing + self.row_offset)) - 1


class Sheet(WingLattice):
    """The lattice on the wing and where its rows and columns cross the crease.

    Parameters are those of `WingLattice`, and so are the further attributes.

    Attributes
    ----------
    entry : (n, rows) int
        Column at which the row's stretch on the spar began; 0 where it starts on the left ribbon.
    entry_column, entry_row : (m,) int
        The nodes at which rows come over the crease, and
    entry_y : (m,) float
        where they cross it.
    exit_column, exit_row : (k,) int
        Nodes where a row comes back to the wing: the ill-posed case at the end of section 3.4. The sheet is taken to
        lie undeformed on the wing all the same; the row's link to such a node has not the right length.
    last_exit : (n, rows) int
        Column of the row's latest exit, 0 for none.
    """

    def __init__(self, fold: Fold, spacing: float, height: float, gamma: Gamma = 0.0, row_offset: float = 0.5) -> None:
        super().__init__(fold, spacing, height, gamma, row_offset)
        self._cross()

    def _cross(self) -> None:
        """Find where rows come over the crease and where they go back."""
        new = self.on_spar.copy()
        new[1:] &= ~self.on_spar[:-1]
        self.entry = np.maximum.accumulate(np.where(new, np.arange(len(self.s))[:, None], 0), axis=0)
        self.entry_column, self.entry_row = (index + 0 for index in np.nonzero(new[1:]))
        self.entry_column += 1
        x, k = self.x[self.entry_row], self.entry_column
        spar = self.fold.spar
        self.entry_y = root_between(lambda y: spar(y) - x, spar.slope, self.y[k - 1], self.y[k])
        self.exit_column, self.exit_row = np.nonzero(self.on_spar[:-1] & ~self.on_spar[1:])
        self.exit_column = self.exit_column + 1
        left = np.zeros(self.on_spar.shape, dtype=np.int64)
        left[self.exit_column, self.exit_row] = self.exit_column
        self.last_exit = np.maximum.accumulate(left, axis=0)

    def ribbon(self) -> ComplexArray:
        """Places of the left-most spar ribbon's nodes, (rows,); only those on the spar mean anything."""
        return np.asarray(self.spar_corner - 1j * np.exp(1j * self.gamma) * (self.corner - self.x))

    def net(self, entry_place: ComplexArray, drift: ComplexArray) -> FoldNet:
        """The net, from where its rows enter the spar, (m,), and what its columns add, (n,)."""
        start = np.zeros(self.on_spar.shape, dtype=np.complex128)
        start[0] = self.ribbon() - drift[0]
        start[self.entry_column, self.entry_row] = entry_place - drift[self.entry_column]
        rows = np.arange(len(self.x))
        origin = start[self.entry, rows]
        place = np.where(self.on_spar, origin + drift[:, None], self.s[:, None] + 1j * self.x)
        on = self.on_spar
        straddles = on[:-1, :-1].astype(np.int8) + on[1:, :-1] + on[:-1, 1:] + on[1:, 1:]
        along = np.diff(drift)[:, None]
        # the row's origin does not change along a cell that lies on the spar
        across = np.diff(origin, axis=1)[:-1]
        shear = np.pi / 2 - np.angle(along * np.conj(across))
        shear = np.where(straddles == 4, shear, np.where(straddles == 0, 0.0, np.nan))
        upper, lower = self.entry[:-1, :-1] == 0, self.entry[:-1, 1:] == 0
        fed = np.where(upper & lower, RIBBON_FED, np.where(upper | lower, NEITHER, WING_FED))
        # the upper row has been back on the wing since the lower one came over: they are not linked by one spacing;
        # nor does a column keep its links through which a row goes back
        torn = self.last_exit[:-1, :-1] > self.entry[:-1, 1:]
        torn[self.exit_column - 1] = True
        fed = np.where(torn, NEITHER, fed)
        region = np.where(straddles == 4, fed, NEITHER).astype(np.int8)
        return FoldNet(self, place, shear, region)


def _too_large(spacing: float, nodes: int) -> NetError:
    return NetError(f"spacing={spacing:g}: a net of {nodes:,} nodes is too large; raise the spacing")


def _checked(fold: Fold, spacing: float, height: float, gamma: float | str, row_offset: float) -> float:
    """Refuse what makes no sheet; return gamma in radians."""
    if not 0 < spacing <= fold.span / 2:
        msg = f"spacing={spacing}: must be positive and at most half the span, {fold.span / 2}"
        raise DesignError(msg)
    if not height > 0:
        msg = f"height={height}: must be positive"
        raise DesignError(msg)
    if not 0 <= row_offset <= 1:
        msg = f"row_offset={row_offset}: must lie between 0 and 1"
        raise DesignError(msg)
    if isinstance(gamma, str) and gamma != "free":
        msg = f"gamma={gamma!r}: give a number of radians or 'free'; within_reach finds the best one"
        raise DesignError(msg)
    turn = float(fold.psi(0.0)) if isinstance(gamma, str) else float(gamma)
    if not abs(turn) < np.pi / 2:
        msg = f"gamma={turn} rad: the left-most ribbon must run down the spar, less than π/2 from the vertical"
        raise DesignError(msg)
    return turn


@dataclass(frozen=True, eq=False)
class FoldNet:
    """A net over the fold.

    Attributes
    ----------
    sheet : Sheet
    plane : (n, rows) complex
        Nodes on their flat sheet: s_w + i x where ``sheet.on_spar`` is false, s_s + i z where it is true.
    shear : (n - 1, rows - 1) float
        Initial angle less that between +warp (along rows, to larger y) and +weft (from the wing down the spar), rad;
        that is ψ of the row less ψ of the column. 0 on the wing, NaN in cells that straddle the crease.
    region : (n - 1, rows - 1) int8
        1 where both rows of a cell of the spar start on the left ribbon, 2 where both come from the wing, 0 neither:
        on the wing, across the crease, between a row of either kind, and beside rows that have been back on the wing.
    """

    sheet: Sheet
    plane: ComplexArray
    shear: FloatArray
    region: NDArray[np.int8]

    @property
    def place(self) -> FloatArray:
        """Flat coordinates (n, rows, 2): (s_w, x) on the wing, (s_s, z) on the spar."""
        return np.stack([self.plane.real, self.plane.imag], axis=-1)

    @cached_property
    def node(self) -> FloatArray:
        """Nodes in space, (n, rows, 3)."""
        place, fold = self.place, self.sheet.fold
        on = self.sheet.on_spar
        out = np.empty((*on.shape, 3))
        out[~on] = fold.wing_to_space(place[~on])
        out[on] = fold.spar_to_space(place[on])
        return out

    @cached_property
    def depth(self) -> FloatArray:
        """How far below the crease each node of the spar lies, (n, rows); -1 on the wing."""
        on = self.sheet.on_spar
        out = np.full(on.shape, -1.0)
        out[on] = self.sheet.fold.depth(self.place[on])
        return out

    @cached_property
    def within(self) -> NDArray[np.bool_]:
        """Cells of which all corners lie within the spar's height and the span, (n - 1, rows - 1)."""
        fold, on = self.sheet.fold, self.sheet.on_spar
        s = self.plane.real
        inside = (self.depth <= self.sheet.height * (1 + 1e-12)) & (~on | ((s >= 0) & (s <= fold.spar.length)))
        return np.asarray(inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:])

    def max_shear(self, region: int, *, everywhere: bool = False) -> Worst:
        """The largest |shear| of the cells of a region (1 ribbon-fed, 2 wing-fed) and where it is.

        Cells beyond the spar's height or span count only `everywhere`. A region without a cell has shear 0.
        """
        cells = self.region == region
        if not everywhere:
            cells = cells & self.within
        if not cells.any():
            return Worst(0.0, (-1, -1), np.full(3, np.nan))
        value = np.where(cells, np.abs(self.shear), -1.0)
        i, r = (int(k) for k in np.unravel_index(int(np.argmax(value)), value.shape))
        middle = self.plane[i : i + 2, r : r + 2].mean()
        place = self.sheet.fold.spar_to_space(np.array([middle.real, middle.imag]))
        return Worst(float(value[i, r]), (i, r), place)
