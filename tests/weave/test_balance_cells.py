"""Every vertex lies in the cell whose outline encloses it: Gauss and Bonnet hold for each cell of every net."""

import math

import numpy as np
import pytest
from cases import CASES, Case
from creased import facets, lay
from moulds import bumpy, hypar, plate, wing_spar
from references import Crease, CreaseNet

import meshdrape
from meshdrape.kernels.edges import WARP, WEFT, edge_ends
from meshdrape.weave.measures.balance import OPEN_SHARE, balance
from meshdrape.weave.measures.curvature import enclosed_curvature

LONG = (1.0, 0.0, 0.0)
# Fibres through vertices, along mesh edges and along a crease, from seeds on a vertex, an edge and a crease.
ALONG = {
    "rulings through vertices": Case(hypar(1.0, 1.0, 30, symmetric=True), 51.0, (0, 0, 0), LONG),
    "rulings beside vertices": Case(hypar(1.0, 1.0, 31), 51.0, (0, 0, 0), LONG),
    "crease as start fibre": Case(
        wing_spar(lambda t: 0 * t, lambda t: 0.2 * t**2 / 1000, np.linspace(0, 1000, 41), 900, 500),
        23.0, (0, 0, 0), (0, 1, 0),
    ),
    "edge as start fibre": Case(plate(cells=(10, 6), jitter_seed=3), 7.0, (-100, 0, 0), LONG),
    "far above triangles": Case(bumpy(3, n=48), 41.0, (3, 5, 0), LONG),
}  # fmt: skip
EVERY = {**CASES, **ALONG}
# Where the cloth folds back on itself a vertex lies in several cells.
FOLDED = {"closed sphere"}


def interior_angles(net):
    """Sum of each whole cell's interior angles less 2 pi, from the directions of its edges; NaN elsewhere."""
    mesh, lattice, start = net.surface.unfolding, net.lattice, net.start
    warp, weft = net.fabric.warp_spacing, net.fabric.weft_spacing
    i0, j0 = net.seed_index
    corner_of_seed = {(i0, j0): 0, (i0 - 1, j0): 1, (i0 - 1, j0 - 1): 2, (i0, j0 - 1): 3}
    on = net.node_status <= meshdrape.NodeStatus.OFF_MOULD
    whole = on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:]
    found = np.full(whole.shape, np.nan)

    def turn(u, v):
        return math.atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]) % (2 * math.pi)

    for i, j in np.argwhere(whole).tolist():
        low = edge_ends(mesh, lattice, start, WARP, i, j, 1, warp)
        high = edge_ends(mesh, lattice, start, WARP, i, j + 1, 1, warp)
        left = edge_ends(mesh, lattice, start, WEFT, i, j, 1, weft)
        right = edge_ends(mesh, lattice, start, WEFT, i + 1, j, 1, weft)
        back = {name: (-e[2], -e[3]) for name, e in (("low", low), ("high", high), ("left", left), ("right", right))}
        angles = [
            turn(low, left),
            turn(right, back["low"]),
            turn(back["high"], back["right"]),
            turn(back["left"], high),
        ]
        if (i, j) in corner_of_seed:
            k = corner_of_seed[i, j]
            angles[k] = start.sector[k]
        found[i, j] = sum(angles) - 2 * math.pi
    return found


@pytest.mark.parametrize("name", [name for name in EVERY if name not in FOLDED])
def test_gauss_bonnet_in_every_cell(name):
    net = EVERY[name].drape()
    enclosed = balance(meshdrape.measure(net)).cell_defect
    angles = interior_angles(net)
    known = np.isfinite(angles)
    assert known.sum() > 15
    np.testing.assert_allclose(enclosed[known], angles[known], atol=1e-9)


def test_gauss_bonnet_where_the_cloth_folds():
    """But for the cells that are turned over or lie under another: each vertex is counted once."""
    net = CASES["closed sphere"].drape()
    off = interior_angles(net) - balance(meshdrape.measure(net)).cell_defect
    assert np.mean(np.abs(off[np.isfinite(off)]) < 1e-9) > 0.99


@pytest.mark.parametrize("name", [name for name in EVERY if name not in FOLDED])
def test_residual_is_within_what_is_left_open(name):
    """A tenth of half the defects of the cell's own row and column: what lies inside is exact."""
    found = balance(meshdrape.measure(EVERY[name].drape()))
    size = np.abs(found.cell_defect)
    i0, j0 = found.measures.net.seed_index
    checked = 0
    for i, j in np.argwhere(np.isfinite(found.residual) & found.measures.cell_touches_mould):
        row = size[i, j0 : j + 1] if j >= j0 else size[i, j:j0]
        column = size[i0 : i + 1, j] if i >= i0 else size[i:i0, j]
        assert abs(found.residual[i, j]) <= OPEN_SHARE * (row.sum() + column.sum()) / 2 + 1e-8, (i - i0, j - j0)
        checked += 1
    assert checked > 10
    assert found.worst <= found.open + 1e-8
    # 0.13 degrees where a cell lies on some thirty triangles, a hundredth elsewhere
    assert np.degrees(found.worst) < 0.25


def test_the_generators_vertices_count_half_to_each_side():
    """The rulings of a hypar run through its vertices: their defects are in no cell whole."""
    net = ALONG["rulings through vertices"].drape()
    held = enclosed_curvature(net)
    assert np.count_nonzero(held.beside_warp) > 20
    np.testing.assert_allclose(held.beside_warp[0], held.beside_warp[1], atol=1e-12)
    np.testing.assert_allclose(held.beside_weft[0], held.beside_weft[1], atol=1e-12)
    # and the saddle is symmetric about both
    assert held.inside.sum() < 0
    assert held.seed < 0


def test_every_defect_is_counted_once():
    """On a mould wholly under cloth the cells, the start fibres and the seed hold all of the curvature there is."""
    net = ALONG["far above triangles"].drape()
    held = enclosed_curvature(net)
    inner = ~net.surface.border_vertex
    # the collar is flat but along the mould's border
    total = float(net.surface.vertex_defect[inner].sum())
    assert held.inside.sum() + held.beside_warp.sum() + held.beside_weft.sum() + held.seed == pytest.approx(
        total, abs=1e-9
    )


@pytest.mark.parametrize("spacing", [0.05, 0.02])
def test_crease_of_two_curved_sheets(spacing):
    """g_w = 0.2 y^2, g_s = 0.4 y^2 (study group report, section 3.4): the crease's vertices carry all curvature.

    A vertex on it turns everything behind by its defect, 19.26 degrees in all over a metre; by halves counted are at
    most the vertices of the cell's own row and column.
    """
    crease = Crease((lambda y: 0.2 * y**2, lambda y: 0.4 * y), (lambda y: 0.4 * y**2, lambda y: 0.8 * y), 1.0)
    reference = CreaseNet(crease, spacing, int(1.0 / spacing) + 1, -int(0.5 / spacing), int(1.1 / spacing), 0.0)
    net = lay(crease, reference, facets(1.0, 0.01), 2.0, 0.6, int(reference.x[-1] / spacing) - 2).net
    found = balance(meshdrape.measure(net))
    assert found.measures.max_shear > np.radians(10)
    assert np.degrees(found.worst) < 40 * spacing
    known = np.isfinite(found.residual) & found.measures.cell_touches_mould
    assert np.degrees(np.sqrt(np.mean(found.residual[known] ** 2))) < 5 * spacing
    i, j = found.worst_cell
    assert abs(found.residual[i, j]) == found.worst
    assert found.worst_position.shape == (3,)
