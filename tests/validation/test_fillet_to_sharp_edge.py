"""A rounded edge drapes ever more like the sharp one as its radius falls."""

import numpy as np

import meshdrape
from meshdrape.mould.cad.library import build_script

SPACING = 50.0
RADII = (160.0, 80.0, 40.0)


def drape(radius):
    """The wing and spar, 3 m of it, from a row that stays on the wing."""
    mould = build_script(
        "wing_spar",
        {
            "span": 3000.0,
            "chord": 1500.0,
            "spar_height": 800.0,
            "deviation": "parabola",
            "c": 0.4,
            "fillet_radius": radius,
        },
    )
    seed = mould.surface.closest_point((1300.0, 1500.0, 300.0))[0].position(mould.surface)
    return meshdrape.drape(mould, meshdrape.Fabric(SPACING), seed=seed, direction=(0, 1, 0), threads=1)


def spar_shear(net):
    """Largest shear of cells well down the spar, rad."""
    measures = meshdrape.measure(net)
    z = net.node_position[..., 2]
    down = np.fmax(np.fmax(z[:-1, :-1], z[1:, :-1]), np.fmax(z[:-1, 1:], z[1:, 1:])) < -250.0
    return float(np.abs(measures.cell_shear[measures.cell_touches_mould & down]).max())


def test_a_fillet_converges_to_the_sharp_edge():
    """The largest shear down the spar: the difference falls with the radius."""
    sharp = spar_shear(drape(0.0))
    off = [abs(spar_shear(drape(radius)) - sharp) for radius in RADII]
    assert np.degrees(sharp) > 1.0
    assert off[2] < off[0] / 2 + np.radians(0.02), np.degrees(off)
    assert np.degrees(off[2]) < 0.1
