"""Closed forms and smooth limits: the study group report in code, to hold draped nets against. Never feeds a drape.

Lengths are pure numbers of any one unit, angles radians. From profiles to answers:

    profiles -> fold -> sheet -> characteristics | discrete     the net over the fold (sections 3, 6)
                     -> criteria, reach                         the largest shear, by each formula (sections 4, 6)
                     -> posedness                               where rows come back or graze (section 3.4)
                     -> perturbation, flat_spar                 near the origami fold; the flat spar (sections 4, 5)
    ribbons                                                     the locking angle (figure 2)
    continuum -> weak, apex, reference_nets                     the smooth net on a surface (section 7)

Where the report errs, the function that is right says so.
"""

from meshdrape.theory.apex import apex_net, apex_shear, pyramid_angle, pyramid_edges
from meshdrape.theory.characteristics import characteristic_net
from meshdrape.theory.continuum import HeightField, SmoothNet, curve_fibre, geodesic, plane_section, smooth_net
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
from meshdrape.theory.posedness import Return, grazing_rows, returning_rows
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
from meshdrape.theory.reach import Pair, Reach, RibbonReach, last_column, ribbon_reach, within_reach
from meshdrape.theory.reference_nets import (
    constant_curvature_angle,
    hypar,
    hypar_net,
    locking_extent,
    pseudosphere_net,
    sphere_net,
)
from meshdrape.theory.ribbons import gap, locking_angle, locking_range, width_for
from meshdrape.theory.sheet import NEITHER, RIBBON_FED, WING_FED, FoldNet, Gamma, Sheet, WingLattice, Worst
from meshdrape.theory.weak import (
    straight_edge_node,
    straight_edge_sine,
    straight_edge_turn,
    weak_nodes,
    weak_origami_sine,
    weak_origami_surface,
    weak_sine,
    weak_sine_geodesic,
    weak_surface,
)

__all__ = [
    "DEVIATIONS",
    "NEITHER",
    "PROFILES",
    "RIBBON_FED",
    "WING_FED",
    "Fold",
    "FoldNet",
    "Gamma",
    "HeightField",
    "Pair",
    "Placements",
    "Profile",
    "PsiRange",
    "Reach",
    "Return",
    "RibbonReach",
    "ScaleCheck",
    "Sheet",
    "SlopeValidity",
    "SmoothNet",
    "Station",
    "WingLattice",
    "Worst",
    "apex_net",
    "apex_shear",
    "arc",
    "bump_deviation",
    "characteristic_net",
    "constant_curvature_angle",
    "curve_fibre",
    "discrete_net",
    "expanded_psi",
    "fits_everywhere",
    "flat",
    "flat_spar_shear",
    "gap",
    "geodesic",
    "grazing_rows",
    "hypar",
    "hypar_net",
    "last_column",
    "lateral_approach",
    "lateral_approach_linear",
    "linear_deviation",
    "locking_angle",
    "locking_extent",
    "locking_range",
    "middle_gamma",
    "named_deviation",
    "named_profile",
    "no_deviation",
    "origami_advance",
    "parabola_deviation",
    "plane_section",
    "pseudosphere_net",
    "psi_range",
    "pyramid_angle",
    "pyramid_edges",
    "quadratic",
    "random_placements",
    "real_wing",
    "returning_rows",
    "ribbon_fed_bound",
    "ribbon_reach",
    "ripple_deviation",
    "separation_of_scales",
    "sin2_slope_deviation",
    "sine_deviation",
    "slope_criterion",
    "slope_shear",
    "slope_validity",
    "smooth_net",
    "sphere_net",
    "straight_edge_node",
    "straight_edge_sine",
    "straight_edge_turn",
    "table",
    "turning_points",
    "weak_nodes",
    "weak_origami_sine",
    "weak_origami_surface",
    "weak_sine",
    "weak_sine_geodesic",
    "weak_surface",
    "width_for",
    "wing_fed_bound",
    "within_reach",
]
