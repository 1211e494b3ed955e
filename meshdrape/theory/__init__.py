"""Closed forms and smooth limits: the study group report in code, to hold draped nets against. Never feeds a drape.

Lengths are pure numbers of any one unit, angles radians. From profiles to answers:

    profiles -> fold -> sheet -> characteristics | discrete     the net over the fold (sections 3, 6)
                     -> criteria, reach                         the largest shear, by each formula (sections 4, 6)
"""

from meshdrape.theory.characteristics import characteristic_net
from meshdrape.theory.criteria import (
    PsiRange,
    Station,
    fits_everywhere,
    middle_gamma,
    psi_range,
    ribbon_fed_bound,
    slope_criterion,
    turning_points,
    wing_fed_bound,
)
from meshdrape.theory.discrete import discrete_net
from meshdrape.theory.fold import Fold
from meshdrape.theory.profiles import (
    DEVIATIONS,
    PROFILES,
    Profile,
    arc,
    bump_deviation,
    flat,
    linear_deviation,
    named_deviation,
    named_profile,
    no_deviation,
    parabola_deviation,
    quadratic,
    real_wing,
    ripple_deviation,
    sin2_slope_deviation,
    sine_deviation,
    table,
)
from meshdrape.theory.reach import Pair, Reach, last_column, within_reach
from meshdrape.theory.sheet import NEITHER, RIBBON_FED, WING_FED, FoldNet, Gamma, Sheet, Worst

__all__ = [
    "DEVIATIONS",
    "NEITHER",
    "PROFILES",
    "RIBBON_FED",
    "WING_FED",
    "Fold",
    "FoldNet",
    "Gamma",
    "Pair",
    "Profile",
    "PsiRange",
    "Reach",
    "Sheet",
    "Station",
    "Worst",
    "arc",
    "bump_deviation",
    "characteristic_net",
    "discrete_net",
    "fits_everywhere",
    "flat",
    "last_column",
    "linear_deviation",
    "middle_gamma",
    "named_deviation",
    "named_profile",
    "no_deviation",
    "parabola_deviation",
    "psi_range",
    "quadratic",
    "real_wing",
    "ribbon_fed_bound",
    "ripple_deviation",
    "sin2_slope_deviation",
    "sine_deviation",
    "slope_criterion",
    "table",
    "turning_points",
    "wing_fed_bound",
    "within_reach",
]
