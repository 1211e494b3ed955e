"""Plates folded along rulings, however meshed: isometric to a rectangle, so every node is known to round-off.

Nothing is approximate: a polyhedron without angle defects is unrolled, whatever its triangles, folds of any angle, the
seed (a vertex, an edge, a fold, the border, a corner), the direction, both spacings and the angle of the fabric.
"""

import numpy as np
import pytest
from lattice import offsets
from moulds import FloatArray, IntArray, rotation
from scipy.spatial import Delaunay

import meshdrape
from meshdrape import NodeStatus

SEEDS = ["inside", "vertex", "edge", "fold", "border", "corner"]


class Rolled:
    """A rectangle of given rulings (s = const) and width, meshed at random, folded along the rulings, in space."""

    def __init__(self, rng: np.random.Generator) -> None:
        n = int(rng.integers(1, 14))
        self.ruling = np.concatenate([[0.0], np.cumsum(rng.uniform(0.02, 1, n))])
        self.ruling *= 10 ** rng.uniform(0, 4) / self.ruling[-1]
        self.length = float(self.ruling[-1])
        self.width = self.length * float(rng.uniform(0.4, 1.5))
        slope = np.concatenate([[0.0], np.cumsum(rng.normal(0, rng.choice([0, 0.05, 0.4, 1.0]), n - 1))])
        self.along = np.stack([np.cos(slope), 0 * slope, np.sin(slope)], axis=-1)
        self.corner = np.concatenate([np.zeros((1, 3)), np.cumsum(np.diff(self.ruling)[:, None] * self.along, axis=0)])
        self.turn = rotation(rng.normal(size=3), float(rng.uniform(0, 6)))
        self.shift = rng.normal(size=3) * self.length * rng.choice([0, 1, 30])
        self.plane, self.triangles = self._meshed(rng)

    def _meshed(self, rng: np.random.Generator) -> tuple[FloatArray, IntArray]:
        """Delaunay triangles of each strip between two rulings, with points on the rulings and inside."""
        points: dict[tuple[float, float], int] = {}
        triangles = []
        on_ruling = [np.unique(np.concatenate([[0, 1], rng.uniform(0.01, 0.99, rng.integers(6))])) for _ in self.ruling]
        for k in range(len(self.ruling) - 1):
            inside = np.column_stack([rng.uniform(0.05, 0.95, 4), rng.uniform(0.02, 0.98, 4)])[: rng.integers(5)]
            strip = [[0.0, t] for t in on_ruling[k]] + [[1.0, t] for t in on_ruling[k + 1]] + inside.tolist()
            unit = np.array(strip)
            corners = unit[Delaunay(unit).simplices]
            u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
            # to the bit the same on a ruling from both its sides
            across = self.ruling[k] * (1 - corners[..., 0]) + self.ruling[k + 1] * corners[..., 0]
            for s, t, size in zip(across, self.width * corners[..., 1], area, strict=True):
                if abs(size) > 1e-12:
                    ring = [points.setdefault((float(a), float(b)), len(points)) for a, b in zip(s, t, strict=True)]
                    triangles.append(ring if size > 0 else ring[::-1])
        return np.array(list(points)), np.array(triangles)

    def strip(self, s: FloatArray | float) -> IntArray:
        return np.clip(np.searchsorted(self.ruling, s, side="right") - 1, 0, len(self.along) - 1)

    def place(self, plane: FloatArray) -> FloatArray:
        """Points of the rectangle in space."""
        k = self.strip(plane[..., 0])
        bent = self.corner[k] + (plane[..., 0] - self.ruling[k])[..., None] * self.along[k]
        bent[..., 1] = plane[..., 1]
        return bent @ self.turn.T + self.shift

    def direct(self, plane: FloatArray, angle: float) -> FloatArray:
        """A direction of the rectangle as it lies in space at a point; on a ruling, in the strip it points into."""
        k = self.strip(plane[..., 0] + 1e-6 * self.length * np.sign(np.cos(angle)))
        direction = np.cos(angle) * self.along[k]
        direction[..., 1] = np.sin(angle)
        return direction @ self.turn.T

    def seed(self, kind: str, rng: np.random.Generator) -> FloatArray:
        size = np.array([self.length, self.width])
        if kind == "vertex":
            return self.plane[rng.integers(len(self.plane))]
        if kind == "edge":
            ring = self.triangles[rng.integers(len(self.triangles))]
            share = rng.uniform(0.1, 0.9)
            return share * self.plane[ring[0]] + (1 - share) * self.plane[ring[1]]
        if kind == "fold":
            return np.array([rng.choice(self.ruling), rng.uniform(0, self.width)])
        if kind == "border":
            return np.array([rng.uniform(0, self.length), rng.choice([0.0, self.width])])
        if kind == "corner":
            return rng.integers(0, 2, 2) * size
        return rng.uniform(0.1, 0.9, 2) * size


@pytest.mark.parametrize("number", range(10))
@pytest.mark.parametrize("kind", SEEDS)
def test_net_is_the_lattice_of_the_unrolled_sheet(kind, number):
    rng = np.random.default_rng([number, SEEDS.index(kind)])
    sheet = Rolled(rng)
    other_side = bool(rng.random() < 0.3)
    order = rng.permutation(len(sheet.triangles))
    mould = meshdrape.Mould.from_arrays(
        sheet.place(sheet.plane), sheet.triangles[order, ::-1] if other_side else sheet.triangles[order]
    )
    spacing = sheet.length * 10 ** rng.uniform(-1.6, -0.4) * 10 ** rng.uniform(-0.3, 0.3, 2)
    initial = rng.choice([np.pi / 2, rng.uniform(np.pi / 6, np.pi * 5 / 6)])
    warp_at = float(rng.choice([rng.uniform(0, 2 * np.pi), np.pi / 4, np.pi / 2]))
    weft_at = warp_at - initial if other_side else warp_at + initial
    seed = sheet.seed(kind, rng)
    net = meshdrape.drape(
        mould, meshdrape.Fabric(tuple(spacing), float(initial)), sheet.place(seed), sheet.direct(seed, warp_at)
    )
    warp = spacing[0] * np.array([np.cos(warp_at), np.sin(warp_at)])
    weft = spacing[1] * np.array([np.cos(weft_at), np.sin(weft_at)])
    i, j = offsets(net)
    plane = seed + i[..., None] * warp + j[..., None] * weft
    clearance = np.minimum(plane, [sheet.length, sheet.width] - plane).min(axis=-1) / sheet.length
    # on the plate everything lies, and nothing else is said to
    assert (net.node_status[clearance > 1e-6] == NodeStatus.PLACED).all()
    assert (net.node_status[clearance < -1e-5] != NodeStatus.PLACED).all()
    # the array leaves nothing out
    reach = np.linalg.solve(
        np.stack([warp, weft], axis=1),
        (np.array(np.meshgrid([0, sheet.length], [0, sheet.width])).reshape(2, 4).T - seed).T,
    )
    (i_low, j_low), (i_high, j_high) = np.floor(reach.min(axis=1)), np.ceil(reach.max(axis=1))
    every = np.stack(np.meshgrid(np.arange(i_low, i_high + 1), np.arange(j_low, j_high + 1), indexing="ij"), axis=-1)
    lattice = seed + every[..., :1] * warp + every[..., 1:] * weft
    inside = np.minimum(lattice, [sheet.length, sheet.width] - lattice).min(axis=-1) / sheet.length > 1e-6
    assert np.count_nonzero(inside) == np.count_nonzero(clearance > 1e-6)
    # to round-off, of the coordinates where the plate lies far from the origin
    round_off = 1e-9 * (sheet.length + np.linalg.norm(sheet.shift))
    on = clearance > 1e-6
    assert net.node_position[on] == pytest.approx(sheet.place(plane[on]), abs=round_off)
    shear = meshdrape.measure(net).cell_shear
    assert np.nanmax(np.abs(shear), initial=0.0) < 1e-8
    # fibre directions away from the folds, where they are the mean of two sides
    clear = on & (np.abs(plane[..., :1] - sheet.ruling).min(axis=-1) > 1.01 * spacing.max())
    for found, angle in ((net.warp_direction, warp_at), (net.weft_direction, weft_at)):
        assert found[clear] == pytest.approx(sheet.direct(plane[clear], angle), abs=1e-8)


@pytest.mark.parametrize("extent", [(60, 90, 0, 0), (0, 0, 40, 0), (0, 80, 0, 0)])
def test_a_single_ribbon_has_both_directions(extent):
    """Weft at the initial angle to a ribbon that nothing crosses, folds on its way or not."""
    rng = np.random.default_rng(3)
    slope = np.concatenate([[0.0], np.cumsum(rng.normal(0, 0.3, 7))])
    x = np.concatenate([[0.0], np.cumsum(25 * np.cos(slope))])
    z = np.concatenate([[0.0], np.cumsum(25 * np.sin(slope))])
    k = np.arange(len(x))
    vertices = np.concatenate([np.stack([x, 0 * x + y, z], axis=-1) for y in (0.0, 90.0)])
    a, b, c, d = k[:-1], k[1:], k[1:] + len(x), k[:-1] + len(x)
    triangles = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    initial = 1.2
    mould = meshdrape.Mould.from_arrays(vertices, triangles)
    seed = 0.5 * (vertices[a[3]] + vertices[c[3]])
    net = meshdrape.drape(mould, meshdrape.Fabric(6.0, initial), seed, (1, 0.4, 0), extent=extent)
    assert min(net.shape) == 1
    assert max(net.shape) > 5
    assert (net.node_status == NodeStatus.PLACED).all()
    normal = mould.surface.face_normal[net.surface_face[net.lattice.face]]
    for direction in (net.warp_direction, net.weft_direction):
        assert np.linalg.norm(direction, axis=-1) == pytest.approx(1.0, abs=1e-12)
    crossed = np.cross(net.warp_direction, net.weft_direction)
    assert np.einsum("ijk,ijk->ij", crossed, normal) == pytest.approx(np.sin(initial), abs=1e-9)
    cosine = np.einsum("ijk,ijk->ij", net.warp_direction, net.weft_direction)
    assert cosine == pytest.approx(np.cos(initial), abs=1e-9)
    # and it takes its length of cloth, without a cell
    measures = meshdrape.measure(net)
    assert measures.n_cells == 0
    assert measures.cloth == (6.0 * (net.shape[0] - 1), 6.0 * (net.shape[1] - 1), 0.0)
