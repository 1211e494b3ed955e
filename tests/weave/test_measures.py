"""What is measured on a net: signed shear, its maximum and place, share above locking, cloth, fibre angles."""

import numpy as np
import pytest
from cases import CASES
from lattice import offsets
from moulds import cube_corner, cylinder, holed_plate, icosphere, parallelogram, plate

import meshdrape
from meshdrape.weave import read_off


@pytest.fixture(scope="module")
def corner():
    """Every cell sheared by 22.5 degrees, of either sign."""
    net = meshdrape.drape(cube_corner(300).mould(), meshdrape.Fabric(23.0), (0, 0, 0), (1, 0.7, 0))
    return meshdrape.measure(net)


@pytest.fixture(scope="module")
def dome():
    mould = icosphere(4).mould()
    net = meshdrape.drape(
        mould,
        meshdrape.Fabric(40.0, locking_angle=np.radians(20)),
        (0, 0, 1000),
        (1, 0.2, 0),
        extent=(800,) * 4,
    )
    return meshdrape.measure(net)


def test_arrays_have_one_entry_a_cell(dome):
    n_warp, n_weft = dome.net.shape
    assert dome.cell_shear.shape == dome.cell_touches_mould.shape == (n_warp - 1, n_weft - 1)
    assert dome.cell_shear.dtype == np.float64
    assert dome.cell_touches_mould.dtype == np.bool_
    assert np.isfinite(dome.cell_shear[dome.cell_touches_mould]).all()


def test_shear_is_missing_where_a_corner_is():
    for name in ("hills", "plate with a hole", "closed sphere"):
        measures = meshdrape.measure(CASES[name].drape())
        there = np.isfinite(measures.net.node_position[..., 0])
        whole = there[:-1, :-1] & there[1:, :-1] & there[:-1, 1:] & there[1:, 1:]
        assert np.array_equal(np.isfinite(measures.cell_shear), whole)
        assert not (measures.cell_touches_mould & ~whole).any()


def test_largest_shear_and_its_place(dome):
    shear = np.abs(dome.cell_shear[dome.cell_touches_mould])
    assert dome.max_shear == shear.max()
    i, j = dome.max_shear_cell
    assert abs(dome.cell_shear[i, j]) == dome.max_shear
    corners = dome.net.node_position[i : i + 2, j : j + 2].reshape(-1, 3)
    assert dome.max_shear_position == pytest.approx(corners.mean(axis=0))
    # at the far corners of the cloth
    oi, oj = offsets(dome.net)
    assert min(abs(oi[i, j]), abs(oj[i, j])) > 15
    assert dome.max_shear_face == 0


def test_largest_shear_speaks_of_the_mould_alone(corner):
    outside = np.isfinite(corner.cell_shear) & ~corner.cell_touches_mould
    assert outside.any()
    assert corner.n_cells == corner.cell_touches_mould.sum()
    assert np.degrees(corner.max_shear) == pytest.approx(22.5, abs=1e-6)


def test_share_above_the_locking_angle(corner, dome):
    assert corner.over_locking_fraction == 1.0
    loose = meshdrape.drape(
        corner.net.mould, meshdrape.Fabric(23.0, locking_angle=np.radians(23)), (0, 0, 0), (1, 0.7, 0)
    )
    assert meshdrape.measure(loose).over_locking_fraction == 0.0
    # by area: a cell sheared by s covers cos s of its own
    shear = dome.cell_shear[dome.cell_touches_mould]
    over = np.abs(shear) > np.radians(20)
    assert 0.05 < over.mean() < 0.95
    assert dome.over_locking_fraction == pytest.approx(np.cos(shear[over]).sum() / np.cos(shear).sum())


def test_cloth_needed():
    """Lengths of the flat sheet that hold all cells on the mould, and their area undeformed."""
    measures = meshdrape.measure(meshdrape.drape(plate().mould(), meshdrape.Fabric((10.0, 7.0)), (3, 4, 0), (1, 0, 0)))
    warp, weft, area = measures.cloth
    rows, columns = np.nonzero(measures.cell_touches_mould)
    assert warp == pytest.approx(10 * (np.ptp(rows) + 1))
    assert weft == pytest.approx(7 * (np.ptp(columns) + 1))
    assert 200 <= warp <= 220
    assert 140 <= weft <= 154
    assert area == pytest.approx(70 * measures.n_cells)
    assert 200 * 140 <= area <= 220 * 154


def test_cloth_of_60_degrees_is_less_of_an_area():
    fabric = meshdrape.Fabric(7.0, initial_angle=np.radians(60))
    measures = meshdrape.measure(meshdrape.drape(plate().mould(), fabric, (3, 4, 0), (1, 0, 0)))
    assert measures.cloth[2] == pytest.approx(49 * np.sin(np.radians(60)) * measures.n_cells)


def test_shear_at_nodes_is_the_mean_of_the_cells_around(dome):
    n_warp, n_weft = dome.net.shape
    padded = np.pad(dome.cell_shear, 1, constant_values=np.nan)
    around = np.stack([padded[a : a + n_warp, b : b + n_weft] for a in (0, 1) for b in (0, 1)])
    known = np.isfinite(around).any(axis=0)
    expected = np.where(known, np.nansum(around, axis=0) / np.maximum(np.isfinite(around).sum(axis=0), 1), np.nan)
    assert dome.node_shear(0, n_warp) == pytest.approx(expected, nan_ok=True, abs=1e-12)
    # and by blocks of rows
    blocks = [dome.node_shear(first, min(first + 7, n_warp)) for first in range(0, n_warp, 7)]
    assert np.concatenate(blocks) == pytest.approx(expected, nan_ok=True, abs=1e-12)


def test_positions_and_directions_by_rows_are_the_whole_arrays(dome):
    net = dome.net
    rows = range(0, net.shape[0], 5)
    position = np.concatenate([net.positions(a, min(a + 5, net.shape[0])) for a in rows])
    assert np.array_equal(position, net.node_position, equal_nan=True)
    parts = [net.directions(a, min(a + 5, net.shape[0])) for a in rows]
    for k, whole in enumerate((net.warp_direction, net.weft_direction)):
        assert np.array_equal(np.concatenate([part[k] for part in parts]), whole, equal_nan=True)


def test_directions_are_the_fibres():
    """On a cylinder 30 degrees off the axis, in the plane of each facet."""
    eta = np.radians(30)
    net = meshdrape.drape(
        cylinder(200, (-1.2, 1.4), 250, 50).mould(), meshdrape.Fabric(21.0), (200, 0, 11),
        (0, np.sin(eta), np.cos(eta)), extent=(150,) * 4,
    )  # fmt: skip
    on = net.node_status == meshdrape.NodeStatus.PLACED
    warp, weft = net.warp_direction[on], net.weft_direction[on]
    assert np.abs(warp[:, 2] - np.cos(eta)).max() < 1e-3
    assert np.abs(np.abs(weft[:, 2]) - np.sin(eta)).max() < 1e-3
    normal = net.surface.face_normal[net.lattice.face[on]]
    assert np.cross(warp, weft) == pytest.approx(normal, abs=0.01)


# --- read off on the mould's own triangles ---------------------------------------------------------------------------


def test_fibre_angles_on_a_plane():
    """From the reference axis to the fibre, right-handed about the normal, in (-90, 90] degrees."""
    for degrees, reference, warp in [
        (20, (1, 0, 0), 20),
        (20, (0, 1, 0), -70),
        (110, (1, 0, 0), -70),
        (20, (1, 1, 5), -25),
    ]:
        angle = np.radians(degrees)
        net = meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0), (3, 5, 0), (np.cos(angle), np.sin(angle), 0))
        field = read_off(meshdrape.measure(net), reference=reference)
        assert field.covered.all()
        assert field.coverage_fraction == pytest.approx(1)
        assert np.degrees(field.warp_angle) == pytest.approx(np.full(len(field.triangles), warp), abs=1e-6)
        assert np.degrees(field.weft_angle) == pytest.approx(
            np.full(len(field.triangles), warp + 90 if warp <= 0 else warp - 90), abs=1e-6
        )
        assert np.abs(field.shear).max() < 1e-9


def test_reference_along_the_normal_gives_way_to_y():
    turned = plate().moved([[0, 0, 1], [1, 0, 0], [0, 1, 0]])  # the plate's normal along global x
    net = meshdrape.drape(turned.mould(), meshdrape.Fabric(7.0), (0, 3, 5), (0, np.cos(0.3), np.sin(0.3)))
    field = read_off(meshdrape.measure(net))
    assert field.warp_angle[field.covered] == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize(("mesh", "area"), [
    (plate(), 200 * 140), (holed_plate(), 200**2 - 60**2), (parallelogram(), 300 * 100),
])  # fmt: skip
def test_read_off_covers_the_mould_and_keeps_its_area(mesh, area):
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(9.0), (-45, 3, 0), (1, 0.3, 0))
    field = read_off(meshdrape.measure(net))
    assert field.area.sum() == pytest.approx(area)
    assert field.coverage_fraction > 0.99
    corners = field.vertices[field.triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(doubled, axis=1) / 2 == pytest.approx(field.area)
    assert np.isin(field.parent, np.arange(len(net.mould.triangles))).all()
    assert np.array_equal(np.isfinite(field.shear), field.covered)


def test_half_the_mould_under_cloth():
    """Cloth bounded to x < 0 covers half, but for the cells that straddle the line."""
    net = meshdrape.drape(plate().mould(), meshdrape.Fabric(2.0), (0, 0, 0), (1, 0, 0), extent=(200, 0, 200, 200))
    field = read_off(meshdrape.measure(net))
    assert field.coverage_fraction == pytest.approx(0.5, abs=0.02)


def test_shear_read_off_is_that_of_the_cell_above(corner):
    field = read_off(corner)
    assert np.abs(np.degrees(np.abs(field.shear[field.covered])) - 22.5).max() < 1e-6
    assert {-1.0, 1.0} == set(np.sign(field.shear[field.covered]))
