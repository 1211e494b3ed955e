"""The shear that a start is told to need, against what it takes: random starts on the samples, in other cloth too."""

from pathlib import Path

import numpy as np
import pytest

import meshdrape

SAMPLES = Path(__file__).parents[2] / "samples"
LOCK = np.radians(7.0)
NAMES = ("hemisphere", "saddle", "hypar", "krogh_double_curved", "blade_root", "wing_spar", "pyramid", "cube_corner")


@pytest.mark.parametrize("name", NAMES)
def test_a_random_start_needs_what_it_is_told(name):
    """From a fifth less to two fifths more, mostly within a twentieth; where the cloth folds it is told to."""
    mould = meshdrape.read_mould(SAMPLES / f"{name}.step", angle_tolerance=np.radians(1), chord_tolerance=0.5)
    surface = mould.surface
    for number in range(4):
        rng = np.random.default_rng(number)
        middle = surface.vertices.mean(axis=0) + rng.uniform(-0.25, 0.25, 3) * mould.size
        seed = surface.closest_point(middle)[0].position(surface)
        direction = rng.normal(size=3)
        fabric = meshdrape.Fabric(surface.diagonal / rng.uniform(80, 150), np.radians(rng.choice([90.0, 75.0])))
        told = meshdrape.forecast(mould, fabric, seed, direction)
        net = meshdrape.drape(mould, fabric, seed, direction)
        shear = meshdrape.measure(net).max_shear
        case = f"{number}: told {np.degrees(told.max_shear):.2f}, drapes with {np.degrees(shear):.2f}"
        if net.count(meshdrape.NodeStatus.FOLDED):
            assert told.max_shear > np.radians(80), case
            assert not told.complete, case
        else:
            assert 0.8 * shear - 1e-6 < told.max_shear < 1.4 * shear + 1e-6, case
        # the warning is right but for what lies within the forecast's own error
        if not 0.7 * LOCK < shear < 1.25 * LOCK:
            assert (told.max_shear > LOCK) == (shear > LOCK or net.count(meshdrape.NodeStatus.FOLDED) > 0), case
