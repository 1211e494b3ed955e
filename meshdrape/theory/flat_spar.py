"""Section 5: a flat upright spar under a curved wing, g_s = 0, and what an error in placing the sheet does to it.

The rows keep parallel to the edge, the cross-wise ribbons hang straight down, and the shear of a cell is that of the
edge on the spar, arctan |g_w'|, (21) with f = -g_w: exact. The report treats it as a solution of its own; it is the
ribbon-fed region with gamma = 0. (Its nodes at λ - b below the edge are first order: a link that hangs upright on both
sides of a slanting edge is not straight.)

"Any small deviation leads to large shear on the wing cover or the spar", the report finds. A sheet laid with a tilt ε
sees the edge rise or fall along its rows, by ε instead of 0. Where it rises, rows come onto the spar with the turn of
the edge they cross; where it falls, rows of the spar come up onto the wing, which can then not be laid undeformed: the
cells there shear by as much as those of the spar, however small the tilt. The largest shear hardly changes; where it
is does.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.errors import DesignError
from meshdrape.theory.fold import Fold
from meshdrape.theory.profiles import Profile, flat
from meshdrape.theory.quadrature import FloatArray


def flat_spar_shear(wing: Profile, y: ArrayLike) -> FloatArray:
    """Shear of the spar's cells under the edge at y, arctan |g_w'|, rad."""
    return np.asarray(np.arctan(np.abs(wing.slope(y))))


class Placements(NamedTuple):
    """Largest shear of a flat spar and its wing over random placements of the sheet, rad.

    Attributes
    ----------
    tilt, gamma : (trials,) float
        The errors: of the sheet on the wing, and of the left-most ribbon of the spar.
    spar, wing : (trials,) float
        Largest shear on the spar, and on the wing where rows of the spar come up onto it; 0 where none does.
    exact : float
        Largest shear of the sheet placed without error; none of it on the wing.
    """

    tilt: FloatArray
    gamma: FloatArray
    spar: FloatArray
    wing: FloatArray
    exact: float

    def spread(self) -> tuple[float, float]:
        """Standard deviation of the largest shear on the spar, and the part of placements that shear the wing."""
        return float(self.spar.std()), float((self.wing > 0).mean())


def random_placements(
    wing: Profile, spacing: float, height: float, sigma: float, trials: int = 1000, seed: int = 0
) -> Placements:
    """Place the sheet with errors of standard deviation sigma and report its largest shear.

    The sheet is laid as a whole, turned by a tilt ~ N(0, sigma), its rows anywhere over one spacing; the left-most spar
    ribbon is turned by gamma ~ N(0, sigma). In the frame of the tilted sheet the crease turns the net by ψ + tilt, and
    the edge lies at x = -s_w sin(tilt). Exact by section 6, in the smooth limit along the rows.

    Parameters
    ----------
    wing : Profile
    spacing, height : float
        Of the ribbons, and of the spar.
    sigma : float
        rad, at most 0.2.
    """
    if not 0 <= sigma <= 0.2:
        msg = f"sigma={sigma} rad: an error of placing lies between 0 and 0.2"
        raise DesignError(msg)
    random = np.random.default_rng(seed)
    tilt, gamma = sigma * random.standard_normal((2, trials))
    offset = random.uniform(0, 1, trials)
    y = np.linspace(0.0, wing.span, 2001)
    s, psi = wing.arc_length(y), Fold(wing, flat(wing.span)).psi(y)
    turn = psi + tilt[:, None]
    fall = np.sin(tilt)[:, None] * s  # how far below its start the edge lies, in the sheet's frame
    ribbon_fed = np.where(-fall <= height, np.abs(turn - gamma[:, None]), 0.0)
    # rows of the wing, from offset x spacing up, come onto the spar where the edge has risen to them
    fed = -fall >= (offset * spacing)[:, None]
    greatest = np.maximum.accumulate(np.where(fed, turn, -np.inf), axis=1)
    least = np.minimum.accumulate(np.where(fed, turn, np.inf), axis=1)
    with np.errstate(invalid="ignore"):
        wing_fed = np.where(fed, np.maximum(greatest - turn, turn - least), 0.0)
    # rows of the spar come up where it has fallen to them, with the turn of the ribbon less that of the edge there
    returned = fall >= ((1 - offset) * spacing)[:, None]
    on_wing = np.where(returned, np.abs(gamma[:, None] - turn), 0.0)
    return Placements(
        tilt,
        gamma,
        np.maximum(ribbon_fed.max(axis=1), wing_fed.max(axis=1)),
        on_wing.max(axis=1),
        float(np.abs(psi).max()),
    )
