"""Places where a simple kernel goes wrong, that no other folder of the tests has: the rest of the list is found under

seeds on vertices, edges, borders: weave/test_border.py; crease: weave/test_border.py; along edges and through vertices:
weave/test_border.py, kernels/test_generator.py; slivers, spacings, holes, concave outlines, closed moulds:
weave/test_border.py; folding: weave/test_statuses.py; symmetry: weave/test_invariance.py.
"""

import numpy as np
import pytest
from lattice import offsets, placed, shear_deg
from moulds import Mesh, cube_corner, grid, hypar, plate

import meshdrape


@pytest.mark.parametrize("degrees", np.random.default_rng(5).uniform(-180, 180, 16).round(3))
def test_cube_corner_is_sheared_by_22_5_whatever_direction_the_first_fibre_takes(degrees):
    """Net origin on the vertex of angle 3 pi / 2: half-fibres 3 pi / 8 apart, cells of 67.5 and 112.5 (closed form)."""
    along = np.array([1, -1, 0]) / np.sqrt(2) * np.cos(np.radians(degrees))
    along = along + np.array([1, 1, -2]) / np.sqrt(6) * np.sin(np.radians(degrees))
    net = meshdrape.drape(cube_corner(300, 2).mould(), meshdrape.Fabric(21.0), (0, 0, 0), along)
    shear = shear_deg(net)
    touching = meshdrape.measure(net).cell_touches_mould
    assert touching.sum() > 300
    assert np.abs(shear[touching]) == pytest.approx(22.5, abs=1e-8)


@pytest.mark.parametrize("n", [4, 7, 12])
def test_half_fibres_at_a_vertex_share_its_angle(n):
    """At the tip of a pyramid of any number of sides, and of a saddle: neighbours A / 4 apart, unfolded."""
    for lift in (60.0, 0.0, -35.0):
        at = np.arange(n) * 2 * np.pi / n
        wave = 40 * np.cos(2 * at) if lift == -35.0 else 0.0
        rim = np.stack([100 * np.cos(at), 100 * np.sin(at), wave - lift + 0 * at], axis=1)
        k = np.arange(n)
        mesh = Mesh(np.vstack([[0.0, 0, 0], rim]), np.stack([0 * k, 1 + k, 1 + (k + 1) % n], axis=1))
        mould = mesh.mould()
        total = float(mould.surface.vertex_angle[0])
        net = meshdrape.drape(mould, meshdrape.Fabric(7.0), (0, 0, 0), (1, 0.3, 0.1), extent=(7, 7, 7, 7))
        assert net.start.sector == pytest.approx(total / 4, abs=1e-12)
        i, j = net.seed_index
        tips = [net.node_position[i + a, j + b] for a, b in ((1, 0), (0, 1), (-1, 0), (0, -1))]
        bearing = [_unfolded(tip, rim) for tip in tips]
        apart = np.mod(np.diff([*bearing, bearing[0]]), total)
        assert apart == pytest.approx(total / 4, abs=1e-9)


def _unfolded(point: np.ndarray, rim: np.ndarray) -> float:
    """Angle about the origin, unfolded from the first rim vertex, of a point on a fan of triangles."""
    along = 0.0
    for a, b in zip(rim, np.roll(rim, -1, axis=0), strict=True):
        normal = np.cross(a, b)
        weight = np.linalg.lstsq(np.stack([a, b], axis=1), point, rcond=None)[0]
        sector = np.arctan2(np.linalg.norm(normal), a @ b)
        if weight.min() > -1e-9 and abs(normal @ point) < 1e-9 * np.linalg.norm(normal):
            return along + float(np.arctan2(np.linalg.norm(np.cross(a, point)), a @ point))
        along += sector
    msg = "the point is on none of the triangles"
    raise AssertionError(msg)


@pytest.mark.parametrize("ratio", [0.01, 0.1, 1.0, 10.0, 100.0])
def test_spacing_from_a_hundredth_of_a_triangle_to_a_hundred(ratio):
    """On a plate of squares a mm wide the net is the flat lattice, whatever the cells."""
    edge = 1.0 if ratio > 1 else 100.0
    n = 220 if ratio == 100 else 30 if ratio > 1 else 3
    side = np.linspace(0, n * edge, n + 1)
    mould = grid(side, side, lambda x, y: (x, y, 0)).mould()
    spacing = ratio * edge
    reach = (20 * spacing,) * 4
    middle = 0.5 * n * edge
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), (middle, middle, 0), (1, 0.37, 0), extent=reach)
    i, j = offsets(net)
    c, s = np.array([1, 0.37]) / np.hypot(1, 0.37)
    flat = np.stack([middle + spacing * (i * c - j * s), middle + spacing * (i * s + j * c), 0 * i], axis=-1)
    here = placed(net) & (net.node_status == meshdrape.NodeStatus.PLACED)
    assert here.sum() >= min(1000, 0.7 * (n * edge / spacing) ** 2)
    assert net.node_position[here] == pytest.approx(flat[here], abs=1e-9 * n * edge)


@pytest.mark.parametrize("aspect", [1e3, 1e6, 1e9])
def test_slivers_do_not_shear(aspect):
    """Strips a million times longer than wide, lengthwise, across and both."""
    thin = 200.0 / aspect
    line = np.sort(np.concatenate([np.linspace(-100, 100, 5), [13.0, 13.0 + thin, -57.0, -57.0 - thin]]))
    mould = grid(line, line, lambda x, y: (x, y, 0)).mould()
    for degrees in (0, 31, 90):
        along = (np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0)
        net = meshdrape.drape(mould, meshdrape.Fabric(9.0), (13.0 + 0.5 * thin, 2.0, 0), along)
        measures = meshdrape.measure(net)
        assert measures.n_cells > 400
        assert measures.max_shear < 1e-8
        assert not (net.node_status > meshdrape.NodeStatus.OUTSIDE).any()


@pytest.mark.parametrize("number", range(3))
def test_symmetric_about_both_diagonals(number):
    """Seed on the middle vertex of a symmetric saddle, fibres along its lines: the net is its own mirror image."""
    mould = hypar(0.4 + 0.3 * number, n=20, symmetric=True).mould()
    net = meshdrape.drape(mould, meshdrape.Fabric(90.0 + 17 * number), (0, 0, 0), (1, 0, 0))
    i, j = net.seed_index
    reach = min(i, j, net.shape[0] - 1 - i, net.shape[1] - 1 - j)
    square = net.node_position[i - reach : i + reach + 1, j - reach : j + reach + 1]
    assert np.isfinite(square).any(axis=-1).sum() > 60
    for image, mirror in (
        (square[::-1], (-1, 1, -1)),
        (square[:, ::-1], (1, -1, -1)),
        (np.swapaxes(square, 0, 1)[..., [1, 0, 2]], (1, 1, 1)),
    ):
        assert image * mirror == pytest.approx(square, abs=1e-8, nan_ok=True)


@pytest.mark.parametrize("offset", [0.0, 1e-13, 1e-9, 1e-7, 1e-4])
def test_seed_beside_a_vertex_or_an_edge(offset):
    """No cell of a plate shears however near to an edge or a vertex the sheet begins."""
    mould = plate().mould()
    inner = int(np.argmin(np.linalg.norm(mould.vertices, axis=1)))
    for at in (mould.vertices[inner], mould.vertices[mould.triangles[30, :2]].mean(axis=0)):
        seed = at + offset * np.array([0.6, 0.8, 0.0])
        net = meshdrape.drape(mould, meshdrape.Fabric(6.0), seed, (1, 0.2, 0))
        assert net.seed == pytest.approx(seed, abs=1e-11)
        measures = meshdrape.measure(net)
        assert measures.n_cells > 700
        assert measures.max_shear < 1e-9
        assert net.count(meshdrape.NodeStatus.OFF_MOULD) > 0
