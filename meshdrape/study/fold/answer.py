"""What `meshdrape fold` answers, as plain data. Lengths mm, angles rad; places in the design's coordinates.

x runs along the chord, y along the span from the root, z up; the crease is (g_s(y), y, g_w(y)).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from meshdrape.study.fold.design import Design

FloatArray = NDArray[np.float64]

CRITERIA = ("eq20", "eq29", "within_reach", "characteristics", "drape")
RULES = ("gamma 0", "free", "best")
# Rows that come back turned by less, rad, come back as they went.
WELL_POSED = 1e-6


@dataclass(frozen=True)
class Shear:
    """The largest |shear| of either region of the spar, rad; None where a criterion does not speak of it.

    Attributes
    ----------
    wing_fed : float or None
        Where the spar's rows come over the crease from the sheet that is laid first, the wing (region II of section
        3.4 of the study group report).
    ribbon_fed : float or None
        Where they start on the left-most ribbon (region I).
    """

    wing_fed: float | None
    ribbon_fed: float | None

    @property
    def largest(self) -> float:
        """Of the two."""
        return max(value for value in (self.wing_fed, self.ribbon_fed, 0.0) if value is not None)


@dataclass(frozen=True)
class Verdict:
    """Question 1: can it be made.

    Attributes
    ----------
    feasible : bool
        Whether no cell of the drape shears past the locking angle.
    margin : float
        Locking angle less the drape's largest shear, rad.
    locking_angle : float
    gamma : float
        Of the left-most ribbon, as draped, rad.
    criteria : dict of Shear
        By `CRITERIA`, the drape last.
    remarks : dict of str
        By criterion: whether it is safe here, and why it differs from the drape.
    first_sheet : float
        Largest |shear| on the sheet that is laid undeformed, of the drape, rad: not 0 where rows come back to it.
    """

    feasible: bool
    margin: float
    locking_angle: float
    gamma: float
    criteria: dict[str, Shear]
    remarks: dict[str, str]
    first_sheet: float


@dataclass(frozen=True)
class Pair:
    """The cell that sets the maximum of a region.

    Attributes
    ----------
    shear : float
        Signed, rad.
    y_row, y_column : float
        Where its row and its column cross the crease, mm; a ribbon-fed row has y_row = the end the ribbon lies at.
    place : (3,) mm, the middle of the cell
    """

    shear: float
    y_row: float
    y_column: float
    place: FloatArray


@dataclass(frozen=True, eq=False)
class SparMap:
    """The drape on the spar, for pictures: the sheet laid second, be it the spar or, for a spar-first sheet, the wing.

    Attributes
    ----------
    node : (n, rows, 3) mm
        Rows run along the first index. NaN where there is no node.
    flat : (n, rows, 2) mm
        The same on the spar rolled out: arc length along y, and height z (x where the wing is laid second).
    shear : (n - 1, rows - 1) rad
        Signed; NaN where a cell does not lie wholly on the spar within its height.
    margin : (n - 1, rows - 1) rad
        Locking angle less |shear|.
    region : (n - 1, rows - 1) int8
        1 ribbon-fed, 2 wing-fed, 0 neither.
    boundary : (k, 3) mm
        Between the two regions: the first row that starts on the left-most ribbon.
    """

    node: FloatArray
    flat: FloatArray
    shear: FloatArray
    margin: FloatArray
    region: NDArray[np.int8]
    boundary: FloatArray


@dataclass(frozen=True, eq=False)
class Where:
    """Question 2: where the shear is.

    Attributes
    ----------
    y : (n,) mm
        Stations of the crease.
    crease : (n, 3) mm
    psi : (n,) rad
        Turn of the net at each station.
    wing_fed, ribbon_fed : (n,) rad
        Largest |shear| down the column of each station over the rows of either region it meets within the spar's
        height, in the smooth limit; NaN where it meets none.
    worst_wing_fed, worst_ribbon_fed : Pair or None
        Of the drape; None of a region without cells.
    spar : SparMap
    """

    y: FloatArray
    crease: FloatArray
    psi: FloatArray
    wing_fed: FloatArray
    ribbon_fed: FloatArray
    worst_wing_fed: Pair | None
    worst_ribbon_fed: Pair | None
    spar: SparMap


@dataclass(frozen=True)
class Choice:
    """One way to lay the sheet and what it costs, by the characteristic construction.

    Attributes
    ----------
    first : "wing" or "spar"
        The side the sheet is laid on undeformed.
    end : "root" or "tip"
        Where it begins: y = 0 or y = span.
    rule : str
        Of the left-most ribbon: "gamma 0", "free", "best", or "design" for the number in the design.
    gamma : float
        rad
    shear : Shear
    returning : float
        Turn, rad, with which rows come back to the sheet laid first; 0 where none does. Past 0 the start is ill-posed.
        Of a choice that was draped, the largest shear of that sheet.
    """

    first: str
    end: str
    rule: str
    gamma: float
    shear: Shear
    returning: float

    @property
    def well_posed(self) -> bool:
        """Whether no row comes back turned."""
        return self.returning < WELL_POSED

    @property
    def largest(self) -> float:
        """What the cloth has to shear by, rad."""
        return max(self.shear.largest, self.returning)


@dataclass(frozen=True)
class Laying:
    """Question 3: how to lay it.

    Attributes
    ----------
    choices : tuple of Choice
        Every first side, end and rule: those that keep the locking angle first, well-posed before ill-posed, cheap
        before dear.
    best : Choice
        The first of them: the cheapest well-posed one that keeps the locking angle; where none does, an ill-posed one
        that does, the sheet laid first shearing too; else the cheapest well-posed one.
    gamma_best : float
        The gamma that makes the ribbon-fed shear least for the design's own first side and end, rad.
    """

    choices: tuple[Choice, ...]
    best: Choice
    gamma_best: float


@dataclass(frozen=True)
class Limit:
    """Question 4: how far f can go under one rule for the left-most ribbon; found on the drape itself.

    Attributes
    ----------
    rule : str
        As in `Choice`.
    factor : float or None
        The largest factor on f that drapes; None where f = 0 or no factor up to `tried` locks.
    gamma : float
        There, rad.
    shear : Shear
        Of the drape at the factor.
    tried : float
        The largest factor looked at.
    """

    rule: str
    factor: float | None
    gamma: float
    shear: Shear
    tried: float


@dataclass(frozen=True, eq=False)
class Envelope:
    """The allowable deviation over amplitude and wavelength of a family of f, every design draped.

    Attributes
    ----------
    family : str
        "sine", "ripple" or "bump".
    amplitude : (a, b) mm
        Values of c: at every wavelength those of the same slopes.
    wavelength : (b,) mm
        Or length, of a bump.
    wing_fed, ribbon_fed : (a, b) rad
        Largest |shear| of the drape; NaN where no net could be laid.
    allowed : (b,) mm
        Amplitude at which the largest shear passes the locking angle; NaN where it does at none of them, 0 at all.
    rule : str
        For gamma.
    spacing : float
        The drapes', mm.
    seconds : float
    """

    family: str
    amplitude: FloatArray
    wavelength: FloatArray
    wing_fed: FloatArray
    ribbon_fed: FloatArray
    allowed: FloatArray
    rule: str
    spacing: float
    seconds: float

    @property
    def largest(self) -> FloatArray:
        """Largest |shear| of each design, (a, b) rad."""
        return np.fmax(self.wing_fed, self.ribbon_fed)


@dataclass(frozen=True, eq=False)
class NearestSpar:
    """Question 5: the spar nearest to the one wanted that can be made, and the drape that proves it.

    Attributes
    ----------
    measure : "slope" or "position"
        What is least squares.
    y : (n,) mm
    wanted, nearest : (n,) mm
        f and f*.
    unchanged : bool
        The design can be made as it is, with the gamma given here: f* = f.
    largest_loss, largest_loss_at : float
        The largest |f* - f| and its station, mm.
    rms_loss : float
        mm
    gamma : float
        To lay f* with, rad.
    shear : Shear
        Of its drape.
    proven : bool
        Whether that is within the locking angle.
    drapes : int
        How many it took.
    """

    measure: str
    y: FloatArray
    wanted: FloatArray
    nearest: FloatArray
    unchanged: bool
    largest_loss: float
    largest_loss_at: float
    rms_loss: float
    gamma: float
    shear: Shear
    proven: bool
    drapes: int

    @property
    def loss(self) -> FloatArray:
        """f* - f along the span, (n,) mm."""
        return np.asarray(self.nearest - self.wanted)


@dataclass(frozen=True)
class FoldWarning:
    """Question 6: something to look at, with its place.

    Attributes
    ----------
    kind : str
        "returning", "grazing", "coarse", "verdict", "mould", ...
    text : str
        One line.
    start, end : float or None
        Stations y, mm.
    """

    kind: str
    text: str
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True, eq=False)
class FoldAnswer:
    """All of it.

    Attributes
    ----------
    seconds : dict of float
        By stage.
    envelope : Envelope or None
        Only where it was asked for.
    """

    design: Design
    verdict: Verdict
    where: Where
    laying: Laying
    limits: tuple[Limit, ...]
    nearest: NearestSpar
    warnings: tuple[FoldWarning, ...]
    envelope: Envelope | None = None
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def largest_factor(self) -> float | None:
        """Of the design's own rule."""
        return next(limit.factor for limit in self.limits if limit.rule == self.design.rule)
