"""The fold as it is laid: the side the sheet lies on first taken for the wing, the end it begins at for y = 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.design import Design
from meshdrape.theory import Fold, WingLattice, ribbon_reach, turning_points

FloatArray = NDArray[np.float64]

# A row that runs along the very crease is laid this far up the side laid first, in spacings: links along a facetted
# edge pass its vertices on either side, and which way is shorter hangs on round-off. More than the turn of a facet
# shifts them by, and a thousandth of a degree of shear at most.
BESIDE = 2e-4
# A row within this of the crease at three columns or more runs along it, spacings.
ALONG = 1e-6


@dataclass(frozen=True, eq=False)
class Frame:
    """A fold seen from the sheet that is laid first.

    All of the theory speaks of a sheet laid on the wing from y = 0. A sheet laid on the spar, or from the tip, is that
    on another fold: with the roles of wing and spar exchanged, or y' = span - y.

    Attributes
    ----------
    design : the fold in the design's coordinates
    first, end : str
        "wing" or "spar"; "root" or "tip".
    height : float
        How far the side laid second reaches from the crease, mm.
    """

    design: Fold
    first: str
    end: str
    height: float

    @cached_property
    def _from_end(self) -> Fold:
        return self.design.reversed() if self.end == "tip" else self.design

    @cached_property
    def fold(self) -> Fold:
        """In the coordinates of the frame."""
        return self._from_end.swapped() if self.first == "spar" else self._from_end

    @property
    def mirrored(self) -> bool:
        """Whether the frame is the design's mirror image rather than itself: triangles run round the other way."""
        return (self.first == "spar") != (self.end == "tip")

    def to_design(self, points: FloatArray) -> FloatArray:
        """Points (..., 3) of the frame in the design's coordinates."""
        if self.first == "spar":
            points = self._from_end.from_swapped(points)
        return self.design.from_reversed(points) if self.end == "tip" else np.asarray(points)

    def from_design(self, points: FloatArray) -> FloatArray:
        """The way back; both maps are their own inverse, but for the shift to the tip's corner."""
        if self.end == "tip":
            span = self.design.span
            corner = np.array([float(self.design.spar(span)), span, float(self.design.wing(span))])
            points = (points - corner) * np.array([1.0, -1.0, 1.0])
        return self._from_end.from_swapped(points) if self.first == "spar" else np.asarray(points)

    def station(self, y: float) -> float:
        """The y of the design at a y of the frame."""
        return self.design.span - y if self.end == "tip" else y

    def gamma_best(self) -> float:
        """The gamma that makes the ribbon-fed shear least within the height, rad.

        Which columns come down to ribbon-fed rows depends a little on gamma where the crease falls at first.
        """
        gamma, turns = 0.0, turning_points(self.fold)
        for _ in range(20):
            new = ribbon_reach(self.fold, self.height, gamma, turns).gamma_best
            if abs(new - gamma) < 1e-10:
                break
            gamma = new
        return gamma

    def gamma(self, rule: float | str) -> float:
        """Of a rule: "free", "best", "gamma 0" or a number of radians."""
        if rule == "free":
            return float(self.fold.psi(0.0))
        if rule == "best":
            return self.gamma_best()
        return 0.0 if isinstance(rule, str) else rule


@dataclass(frozen=True, eq=False)
class Cloth:
    """The lattice of a sheet in a frame: row 0 is the seed's, which stays on the side laid first all along.

    Attributes
    ----------
    frame : Frame
    spacing : float, mm
    row_offset : float
        The design's, but for a row that would run along the crease: `BESIDE`.
    columns, rows : int
        Nodes along and across the rows, so that the cloth covers the second side over its height.
    first_row : int
        j of row 0, which lies at (j + row_offset) spacing from the corner; row r is j = first_row - r.
    """

    frame: Frame
    spacing: float
    row_offset: float
    columns: int
    rows: int
    first_row: int

    @classmethod
    def of(cls, frame: Frame, spacing: float, row_offset: float, gamma: float) -> Cloth:
        """The lattice that covers a frame."""
        sheet = WingLattice(frame.fold, spacing, frame.height, gamma, row_offset)
        near = np.abs(sheet.edge[:, None] - sheet.x) < ALONG * spacing
        if near.sum(axis=0).max() > 2:
            row_offset = (row_offset + BESIDE) % 1.0
            sheet = WingLattice(frame.fold, spacing, frame.height, gamma, row_offset)
        return cls(frame, spacing, row_offset, len(sheet.s), len(sheet.x), sheet.first_row)

    @property
    def x(self) -> FloatArray:
        """Where each row lies on the side laid first, (rows,) mm."""
        j = self.first_row - np.arange(self.rows)
        return np.asarray(float(self.frame.fold.spar(0.0)) + (j + self.row_offset) * self.spacing)

    @cached_property
    def seed(self) -> FloatArray:
        """On row 0 at y = 0."""
        return np.array([self.x[0], 0.0, float(self.frame.fold.wing(0.0))])

    @property
    def direction(self) -> FloatArray:
        """Of the rows there."""
        return np.array([0.0, 1.0, float(self.frame.fold.wing.slope(0.0))])

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Of the cloth from the seed, mm."""
        return 0.0, (self.columns - 1) * self.spacing, 0.0, (self.rows - 1) * self.spacing

    @property
    def width(self) -> float:
        """How far from the crease the side laid first has to reach for row 0 to lie on it, mm."""
        y = np.linspace(0.0, self.frame.fold.span, 2001)
        return float(self.x[0] - self.frame.fold.spar(y).min()) + self.spacing


def frame_of(design: Design, fold: Fold | None = None, first: str | None = None, end: str | None = None) -> Frame:
    """The frame of a design, or of another fold, side or end of it."""
    first = first or design.first
    height = design.chord if first == "spar" else design.spar_height
    return Frame(fold or design.fold, first, end or design.end, height)
