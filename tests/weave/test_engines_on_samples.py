"""The reference engine on every sample mould, on a piece it can do: node by node the same net."""

from pathlib import Path

import numpy as np
import pytest

import meshdrape

SAMPLES = Path(__file__).parents[2] / "samples"
# spacing, mm, and a seed off the middle, so that creases and facets are met
STARTS = {
    "wing_spar": (60.0, (330.0, 1200.0, 250.0), (0, 1, 0.1)),
    "hemisphere": (60.0, None, (1, 0.3, 0)),
    "cone": (40.0, None, (0.2, 0.6, 1)),
    "cylinder": (40.0, None, (0.2, 0.6, 1)),
    "hypar": (70.0, None, (1, 0.2, 0)),
    "cube_corner": (60.0, (150.0, 120.0, 0.0), (-1, 0.2, 0)),
    "krogh_double_curved": (20.0, None, (1, 0.4, 0)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", STARTS)
def test_fast_engine_equals_the_reference_on_samples(name):
    """To 1e-9 of the spacing, with the same statuses."""
    spacing, seed, direction = STARTS[name]
    mould = meshdrape.read_mould(SAMPLES / f"{name}.stl")
    if seed is not None:
        seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    fabric = meshdrape.Fabric(spacing)
    extent = (3 * spacing,) * 4
    fast, reference = (
        meshdrape.drape(mould, fabric, seed=seed, direction=direction, extent=extent, engine=engine)
        for engine in ("fast", "libigl")
    )
    assert np.array_equal(fast.node_status, reference.node_status)
    assert np.count_nonzero(np.isfinite(fast.node_position[..., 0])) > 20
    off = np.linalg.norm(fast.node_position - reference.node_position, axis=-1)
    assert np.nanmax(off) < 1e-9 * spacing
