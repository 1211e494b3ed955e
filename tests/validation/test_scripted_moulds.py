"""Nets on the scripted moulds against what their scripts say of shear: none, one angle everywhere, or a closed form."""

from __future__ import annotations

import numpy as np
import pytest

import meshdrape
from meshdrape.mould.cad.library import build_script

DIAGONAL = (1.0, 1.0, 0.0)
SHORT_WING = {"span": 3000, "chord": 1500, "spar_height": 500, "deviation": "none"}


@pytest.mark.parametrize(
    ("name", "parameters", "spacing", "direction"),
    [
        ("joggle", {}, 7.0, DIAGONAL),
        ("l_corner", {}, 7.0, DIAGONAL),
        ("l_corner", {"concave": True, "angle_deg": 120}, 7.0, (1.0, 3.0, 0.0)),
        ("c_spar", {}, 25.0, (0.0, 1.0, 0.3)),
        ("leading_edge", {}, 25.0, (1.0, 1.0, 0.2)),
        ("leading_edge", {"tip_chord": 500}, 25.0, (0.0, 1.0, 0.0)),
        ("wing_spar", SHORT_WING, 40.0, DIAGONAL),
        ("wing_spar", {**SHORT_WING, "spar_angle_deg": 50}, 40.0, DIAGONAL),
        ("wing_spar", {**SHORT_WING, "spar_angle_deg": 120}, 40.0, (0.0, 1.0, 0.0)),
        ("wing_spar", {**SHORT_WING, "rear_spar": True, "chord": 2500}, 40.0, DIAGONAL),
    ],
)
def test_developable_moulds_do_not_shear(name, parameters, spacing, direction):
    """From any seed in any direction, over joints and origami folds."""
    net = meshdrape.drape(build_script(name, parameters), meshdrape.Fabric(spacing), direction=direction)
    measures = meshdrape.measure(net)
    assert np.isfinite(measures.cell_shear).sum() > 500
    # The nodes of the wing's far border do not all lie on the rulings of those of its crease: facets tilt by 3e-5 rad.
    assert np.degrees(measures.max_shear) < (5e-4 if name == "wing_spar" else 1e-6)


def test_a_spar_that_is_no_origami_shears():
    """The check above can fail: the fold of a perpendicular spar, taken for one at 50 degrees."""
    table = {"spar_profile": "real", "spar_angle_deg": 50}
    net = meshdrape.drape(
        build_script("wing_spar", {**SHORT_WING, **table}), meshdrape.Fabric(40.0), direction=DIAGONAL
    )
    assert np.degrees(meshdrape.measure(net).max_shear) > 0.5


@pytest.mark.parametrize(("sides", "apex_angle_deg"), [(4, 60.0), (3, 100.0), (5, 50.0)])
def test_pyramid_shears_alike_everywhere(sides, apex_angle_deg):
    mould = build_script("pyramid", {"sides": sides, "apex_angle_deg": apex_angle_deg})
    net = meshdrape.drape(mould, meshdrape.Fabric(50.0), seed=(0, 0, 0), direction=(1, 0.2, 0))
    shear = np.degrees(meshdrape.measure(net).cell_shear)
    shear = shear[np.isfinite(shear)]
    assert len(shear) > 300
    assert np.abs(shear) == pytest.approx(np.full(len(shear), 90 - sides * apex_angle_deg / 4), abs=1e-6)


def test_saddle_along_its_lines_is_the_hyperbolic_paraboloid():
    """A spacing of 50 mm and facets of 0.1 mm: the node is off by less than a thousandth of its fabric coordinates."""
    net = meshdrape.drape(build_script("saddle"), meshdrape.Fabric(50.0), seed=(0, 0, 0), direction=DIAGONAL)
    i, j = net.seed_index
    # weft = normal x warp points to (-1, 1): back along weft is the way to +x
    assert np.linalg.norm(net.node_position[i + 20, j - 20] - [1078.4965, 0, 581.5774]) < 1.0
    straight = net.node_position[i + 20, j]
    assert np.linalg.norm(straight - [1000 / np.sqrt(2), 1000 / np.sqrt(2), 0]) < 0.5


def test_dome_of_the_hat_shears_as_the_sphere():
    mould = build_script("hat", None, 0.05, np.radians(0.5))
    net = meshdrape.drape(mould, meshdrape.Fabric(4.0), seed=(0, 0, 100), direction=(1, 0, 0))
    i, j = net.seed_index
    # the cell about u = v = 12.5 spacings = R / 2
    assert np.degrees(meshdrape.measure(net).cell_shear[i + 12, j + 12]) == pytest.approx(14.27443, abs=0.15)
