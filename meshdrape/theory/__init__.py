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
from meshdrape.theory.flat_spar import Placements, flat_spar_shear, random_placements
from meshdrape.theory.fold import Fold
from meshdrape.theory.perturbation import (
    ScaleCheck,
    SlopeValidity,
    expanded_psi,
    lateral_approach,
    lateral_approach_linear,
    origami_advance,
    separation_of_scales,
    slope_shear,
    slope_validity,
)
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
from meshdrape.theory.ribbons import gap, locking_angle, locking_range, width_for
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
    "Placements",
    "Profile",
    "PsiRange",
    "Reach",
    "ScaleCheck",
    "Sheet",
    "SlopeValidity",
    "Station",
    "Worst",
    "arc",
    "bump_deviation",
    "characteristic_net",
    "discrete_net",
    "expanded_psi",
    "fits_everywhere",
    "flat",
    "flat_spar_shear",
    "gap",
    "last_column",
    "lateral_approach",
    "lateral_approach_linear",
    "linear_deviation",
    "locking_angle",
    "locking_range",
    "middle_gamma",
    "named_deviation",
    "named_profile",
    "no_deviation",
    "origami_advance",
    "parabola_deviation",
    "psi_range",
    "quadratic",
    "random_placements",
    "real_wing",
    "ribbon_fed_bound",
    "ripple_deviation",
    "separation_of_scales",
    "sin2_slope_deviation",
    "sine_deviation",
    "slope_criterion",
    "slope_shear",
    "slope_validity",
    "table",
    "turning_points",
    "width_for",
    "wing_fed_bound",
    "within_reach",
]
