"""Seeds on the apex of pyramids of any total angle, convex and saddle: four flat sectors, each a lattice of rhombi.

The half-fibres leave at initial_angle x A / 2 pi, A / 2 and so on, so in each sector the net is the planar one: every
node's distance from the apex, its azimuth in the unfolded star and every cell's shear are closed forms.
"""

import numpy as np
import pytest
from lattice import offsets
from moulds import FloatArray, IntArray, rotation

import meshdrape
from meshdrape import NodeStatus

RADIUS = 100.0


def pyramid(rng: np.random.Generator, saddle: bool) -> tuple[FloatArray, IntArray, FloatArray]:
    """Vertices, apex first, and triangles of a star of spokes, each ring cut at random; unit spokes (n, 3)."""
    n = int(rng.integers(4, 10)) // 2 * 2 if saddle else int(rng.integers(3, 10))
    azimuth = (np.arange(n) + rng.uniform(-0.3, 0.3, n)) * 2 * np.pi / n
    down = np.where(np.arange(n) % 2, 1, -1) * rng.uniform(0.2, 0.7) if saddle else np.full(n, rng.uniform(0.05, 1.2))
    down = down + rng.normal(0, 0.1 if saddle else 0.02, n)
    spoke = np.stack([np.cos(azimuth) * np.cos(down), np.sin(azimuth) * np.cos(down), -np.sin(down)], axis=-1)
    rings = np.append(np.sort(rng.uniform(0.2, 0.9, rng.integers(3))), 1.0)
    vertices = np.concatenate([np.zeros((1, 3)), *(RADIUS * r * spoke for r in rings)])
    k = np.arange(n)
    after = (k + 1) % n
    triangles = [np.stack([0 * k, 1 + k, 1 + after], axis=-1)]
    for ring in range(len(rings) - 1):
        a, b = 1 + n * ring, 1 + n * (ring + 1)
        triangles += [np.stack([a + k, b + k, b + after], -1), np.stack([a + k, b + after, a + after], -1)]
    return vertices, np.concatenate(triangles), spoke


def unfolded(spoke: FloatArray, position: FloatArray) -> tuple[float, float]:
    """Distance from the apex, and azimuth in the unfolded star from the first spoke, of a point on a pyramid."""
    best, off = (0.0, 0.0), np.inf
    before = 0.0
    for a, b in zip(spoke, np.roll(spoke, -1, axis=0), strict=True):
        pair = np.stack([a, b], axis=1)
        share, *_ = np.linalg.lstsq(pair, position, rcond=None)
        miss = float(np.linalg.norm(pair @ share - position) + max(0.0, -share.min()))
        if miss < off:
            away = position / np.linalg.norm(position)
            angle = np.arctan2(np.linalg.norm(np.cross(a, away)), a @ away)
            best, off = (float(np.linalg.norm(position)), before + float(angle)), miss
        before += float(np.arccos(a @ b))
    assert off < 1e-9 * RADIUS
    return best


@pytest.mark.parametrize("saddle", [False, True], ids=["convex", "saddle"])
@pytest.mark.parametrize("number", range(12))
def test_every_sector_is_a_planar_lattice(number, saddle):
    rng = np.random.default_rng([number, saddle])
    vertices, triangles, spoke = pyramid(rng, saddle)
    sides = np.arccos(np.einsum("ij,ij->i", spoke, np.roll(spoke, -1, axis=0)))
    total, reach = float(sides.sum()), RADIUS * float(np.cos(sides / 2).min())
    assert (total > 2 * np.pi) == saddle
    initial = float(rng.choice([np.pi / 2, rng.uniform(np.pi / 6, np.pi * 5 / 6)]))
    sector = np.array([initial, np.pi - initial] * 2) * total / (2 * np.pi)
    spacing = reach * 10 ** rng.uniform(-1.1, -0.3) * 10 ** rng.uniform(-0.15, 0.15, 2)
    share, side = rng.choice([0.0, rng.uniform()]), int(rng.integers(len(spoke)))
    if np.degrees(sector).max() > 175:
        share = rng.uniform(0.1, 0.9)
    along = (1 - share) * spoke[side] + share * spoke[(side + 1) % len(spoke)]
    turn, shift = rotation(rng.normal(size=3), float(rng.uniform(0, 6))), rng.normal(0, 100, 3)
    net = meshdrape.drape(
        meshdrape.Mould.from_arrays(vertices @ turn.T + shift, rng.permutation(triangles)),
        meshdrape.Fabric(tuple(spacing), initial),
        shift,
        turn @ along,
    )
    i, j = offsets(net)
    # within reach a node and all behind it lie on the pyramid
    within = np.abs(i) * spacing[0] + np.abs(j) * spacing[1] < 0.999 * reach
    quadrant = np.select([(i > 0) & (j >= 0), (i <= 0) & (j > 0), (i < 0) & (j <= 0)], [0, 1, 2], 3)
    local = (net.node_position - shift) @ turn
    first = unfolded(spoke, local[net.seed_index[0] + 1, net.seed_index[1]])[1]
    for at in np.argwhere(within & ((i != 0) | (j != 0))):
        a, b, q = i[*at], j[*at], quadrant[*at]
        if a and b and np.degrees(sector[q]) > 179:
            assert net.node_status[*at] in (NodeStatus.FOLDED, NodeStatus.NOT_REACHED)
            continue
        assert net.node_status[*at] == NodeStatus.PLACED
        steps = abs(a) * spacing[0], abs(b) * spacing[1]
        ahead, across = steps if q % 2 == 0 else steps[::-1]
        plane = ahead + across * np.exp(1j * sector[q])
        distance, azimuth = unfolded(spoke, local[*at])
        off = azimuth - first - sector[:q].sum() - np.angle(plane)
        assert distance == pytest.approx(abs(plane), abs=1e-9 * RADIUS)
        assert (off + total / 2) % total - total / 2 == pytest.approx(0.0, abs=1e-9)
    shear = meshdrape.measure(net).cell_shear
    cell = within[:-1, :-1] & within[1:, 1:] & within[1:, :-1] & within[:-1, 1:] & np.isfinite(shear)
    same = (i[:-1, :-1] >= 0) == (j[:-1, :-1] >= 0)
    wanted = np.where(same, initial - sector[0], initial - (np.pi - sector[1]))
    assert shear[cell] == pytest.approx(wanted[cell], abs=1e-9)
