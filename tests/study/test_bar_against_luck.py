"""Error bars of random starts: two maxima that agree by chance are not taken for convergence.

The tolerances are coarse, so that facets err visibly. The exact discrete net on the sphere is known to round-off, the
smooth net on a saddle to a hundredth of what facets err by.
"""

from pathlib import Path

import numpy as np
import pytest
from references import sphere_cell_shear, sphere_net_of

import meshdrape
from meshdrape.theory.continuum import HeightField, geodesic, smooth_net

HEMISPHERE = Path(__file__).parents[2] / "samples" / "hemisphere.step"
RADIUS = 500.0


# of 200 starts six had a bar that missed while maxima alone were compared; these are two of them
@pytest.mark.parametrize("number", [9, 191])
def test_bar_contains_the_exact_maximum(number):
    rng = np.random.default_rng(number)
    spacing = tuple(RADIUS * rng.uniform(0.04, 0.12, 2))
    initial = np.radians(rng.uniform(60, 120))
    up = np.array([0, 0, 1.0]) + rng.normal(0, 0.1, 3)
    up /= np.linalg.norm(up)
    warp = np.cross(up, rng.normal(size=3))
    warp /= np.linalg.norm(warp)
    # all on the sphere: the cloth ends well within the border
    extent = tuple(RADIUS * rng.uniform(0.3, 0.65, 4))
    mould = meshdrape.read_mould(HEMISPHERE, chord_tolerance=0.3, angle_tolerance=np.radians(2))
    fabric = meshdrape.Fabric(spacing, initial)
    net = meshdrape.drape(mould, fabric, RADIUS * up, warp, extent=extent)
    found = meshdrape.refine(mould, fabric, extent=extent, net=net)
    measures = meshdrape.measure(net)
    assert (net.node_status == meshdrape.NodeStatus.PLACED).all()
    exact = sphere_cell_shear(sphere_net_of(RADIUS, spacing, initial, 0.65 * RADIUS), initial)
    i0, j0 = net.seed_index
    truth = max(abs(exact[i - i0, j - j0]) for i, j in np.argwhere(measures.cell_touches_mould))
    assert found.max_shear[-1] == measures.max_shear
    assert abs(measures.max_shear - truth) <= found.error_bar
    assert found.error_bar < np.radians(1)


# z in units of 1000 mm, and half the width of the sample
GRAPHS = {
    "hypar": (
        HeightField(lambda x, y: x * y, lambda x, y: (y, x), lambda x, y: (0 * x, 1 + 0 * x, 0 * x)), 1.3, 1.0
    ),
    "saddle": (
        HeightField(lambda x, y: (x * x - y * y) / 2, lambda x, y: (x, -y), lambda x, y: (1 + 0 * x, 0 * x, 0 * x - 1)),
        1.2,
        1.0,
    ),
}  # fmt: skip


def largest_shear(field, seed, turn, spacing, counts):
    """Of the smooth net at the middles of the cells of all four quadrants, each so many cells from the seed, rad."""
    p, q = field.gradient(*seed)
    metric = np.array([[1 + p * p, p * q], [p * q, 1 + q * q]])
    warp = np.array([np.cos(turn), np.sin(turn)])
    warp /= np.sqrt(warp @ metric @ warp)
    g = metric @ warp
    weft = np.array([-g[1], g[0]])
    weft /= np.sqrt(weft @ metric @ weft)
    largest = 0.0
    for si, n in ((1, counts[0]), (-1, counts[2])):
        for sj, m in ((1, counts[1]), (-1, counts[3])):
            fibres = [
                geodesic(field, tuple(sense * along), 1.001 * count * spacing, seed)
                for sense, along, count in ((si, warp, n), (sj, weft, m))
            ]
            net = smooth_net(field, *fibres, (n * spacing, m * spacing), (2 * n, 2 * m), levels=3)
            largest = max(largest, float(np.abs(net.shear[1::2, 1::2]).max()))
    return largest


@pytest.mark.parametrize(("name", "number"), [("hypar", 1), ("hypar", 41), ("saddle", 2), ("saddle", 6)])
def test_bar_contains_the_maximum_of_the_smooth_net(name, number):
    field, half, chord = GRAPHS[name]
    rng = np.random.default_rng(number)
    degrees = (2.0, 3.0)[number % 2]
    mould = meshdrape.read_mould(
        HEMISPHERE.with_name(f"{name}.step"), chord_tolerance=chord * degrees / 2, angle_tolerance=np.radians(degrees)
    )
    spacing, turn = rng.uniform(0.025, 0.05), rng.uniform(0, 2 * np.pi)
    seed = tuple(rng.uniform(-0.2, 0.2, 2) * half)
    counts = [int(length / spacing) for length in rng.uniform(0.3, 0.5, 4) * half]
    truth = largest_shear(field, seed, turn, spacing, counts)
    p, q = field.gradient(*seed)
    place = mould.surface.closest_point(1000 * np.array([*seed, field.z(*seed)]))[0].position(mould.surface)
    along = (np.cos(turn), np.sin(turn), p * np.cos(turn) + q * np.sin(turn))
    extent = tuple(1000 * spacing * (counts[k] + 0.2) for k in (2, 0, 3, 1))
    net = meshdrape.drape(mould, meshdrape.Fabric(1000 * spacing), place, along, extent=extent)
    assert (net.node_status == meshdrape.NodeStatus.PLACED).all()
    found = meshdrape.refine(mould, net.fabric, net=net)
    off = abs(found.max_shear[-1] - truth)
    assert off <= found.error_bar, np.degrees([off, found.error_bar])
    assert found.error_bar < 0.15 * truth
