"""The error bar of the maximum shear contains what is known without a mesh, at the same spacing."""

import math
from pathlib import Path

import numpy as np
import pytest
from creased import read
from references import Crease, CreaseNet, hypar_net, sphere_angle, sphere_net

import meshdrape
from meshdrape.errors import MouldError, StartError
from meshdrape.study import convergence
from meshdrape.study.convergence import extrapolated
from meshdrape.weave.measures.noise import SIGMAS

SAMPLES = Path(__file__).parents[2] / "samples"


def sample(name, **tolerances):
    return meshdrape.read_mould(SAMPLES / f"{name}.step", **tolerances)


def held(found, truth):
    """Whether the bar about the finest maximum contains a known one; a bar of no use contains anything."""
    assert found.error_bar >= found.noise / SIGMAS
    assert found.error_bar < max(0.05 * truth, 1e-7)
    return abs(found.max_shear[-1] - truth) <= found.error_bar


def last_cell_on_the_sphere(radius, spacing, n):
    """Shear of the exact discrete net's last cell: pi / 2 less the mean of its corners, two as supplements."""
    p = sphere_net(radius, spacing, n)
    ring = [p[-2, -2], p[-1, -2], p[-1, -1], p[-2, -1]]
    angles = []
    for k in range(4):
        normal = ring[k] / radius
        u, v = (other - (other @ normal) * normal for other in (ring[(k + 1) % 4], ring[k - 1]))
        angles.append(np.arctan2(np.cross(u, v) @ normal, u @ v))
    return np.pi / 2 - (angles[0] + angles[2] + 2 * np.pi - angles[1] - angles[3]) / 4


@pytest.mark.parametrize(("spacing", "turn"), [(25.0, 1.2), (50.0, 0.3)])
def test_hemisphere(spacing, turn):
    """The exact discrete net over 0.8 x 0.8 radii; its smooth limit, with the spacing's own error on top."""
    found = meshdrape.refine(
        sample("hemisphere"), meshdrape.Fabric(spacing), (0, 0, 500), (np.cos(turn), np.sin(turn), 0), (400,) * 4
    )
    assert held(found, last_cell_on_the_sphere(500.0, spacing, round(400 / spacing)))
    smooth = np.pi / 2 - float(sphere_angle(0.64))
    assert abs(found.max_shear[-1] - smooth) <= found.error_bar + found.spacing_error
    assert found.spacing_error < 2.5 * abs(found.max_shear[-1] - smooth)


def test_hypar():
    """From its two straight lines over 1000 x 1000 mm: the smooth net at the last cell's middle."""
    spacing = 50.0
    found = meshdrape.refine(sample("hypar"), meshdrape.Fabric(spacing), (0, 0, 0), (1, 0, 0), (1000,) * 4)
    _, angle = hypar_net(1.0, 1 - spacing / 2000, 40)
    assert held(found, float(angle[-1, -1]) - np.pi / 2)


def test_cube_corner():
    found = meshdrape.refine(sample("cube_corner"), meshdrape.Fabric(50.0), (0, 0, 0), (-1, -0.4, 0))
    assert held(found, math.radians(22.5))
    assert found.spacing_error < 1e-9


@pytest.mark.parametrize("name", ["cylinder", "cone"])
def test_no_shear(name):
    found = meshdrape.refine(sample(name), meshdrape.Fabric(50.0))
    assert held(found, 0.0)
    assert found.triangles[0] < found.triangles[1] < found.triangles[2]


@pytest.mark.parametrize("spacing", [0.1, 0.05])
def test_wing_and_spar(spacing):
    """The sheet laid undeformed on the wing, against the net on the two unfolded sheets."""
    a, b, length, span = 0.047227544, 0.220721648, 3.731291642, 14.0

    def wing(y):
        return a * y + b * length * (1 - np.exp(-y / length))

    def slope(y):
        return a + b * np.exp(-y / length)

    crease = Crease((wing, slope), (lambda y: wing(y) + 0.1 * y**2 / 28, lambda y: slope(y) + 0.1 * y / 14), span)
    n = int(crease.arc[0](span) / spacing) + 1
    first, rows = -int(1.4 / spacing), int((1.4 + float(crease.profile[1](np.float64(span)))) / spacing) + 4
    reference = CreaseNet(crease, spacing, n, first, rows, 0.0)
    row = int(reference.x[-1] / spacing)
    start = ((1000 * (row + 0.5) * spacing, 0, 0), (0, 1, slope(0)))
    mould, fabric = sample("wing_spar"), meshdrape.Fabric(1000 * spacing)
    net = meshdrape.drape(mould, fabric, *start)
    measures = meshdrape.measure(net)
    draped = read(net, reference, row)
    i, j = measures.max_shear_cell
    cell = (i - net.seed_index[0], row - (j - net.seed_index[1]) - first - 1)
    assert reference.region[cell] > 0
    assert draped.shear[cell] == measures.cell_shear[i, j]
    assert held(meshdrape.refine(mould, fabric, *start, net=net), abs(reference.shear[cell]))


def test_a_mesh_has_nothing_finer():
    with pytest.raises(MouldError, match=r"cone\.stl is a mesh, its own truth"):
        meshdrape.refine(meshdrape.read_mould(SAMPLES / "cone.stl"), meshdrape.Fabric(50.0))


def test_the_other_side_of_chosen_faces():
    """The file is read again as it was: tolerances in the ratio of two, the same faces, turned."""
    mould = meshdrape.read_mould(SAMPLES / "wing_spar_block.step", faces=">Z or <X").flipped()
    found = meshdrape.refine(mould, meshdrape.Fabric(200.0), direction=(0, 1, 0))
    assert found.angle_tolerance == pytest.approx(np.radians([0.8, 0.4, 0.2]))
    assert found.chord_tolerance == pytest.approx((0.4, 0.2, 0.1))
    assert np.ptp(found.max_shear) < np.radians(1)


@pytest.mark.parametrize("family", ["warp", "weft"])
@pytest.mark.parametrize("known", [True, False])
def test_turned_start_fibres(family, known):
    """A bent fibre is bent on every tessellation: the maxima are those of drapes asked for one by one."""
    mould, fabric, seed = sample("wing_spar"), meshdrape.Fabric(200.0), (2000.0, 7000.0, 1000.0)
    # the one that runs over the edge
    direction = (0.0, 1.0, 0.0) if family == "weft" else (1.0, 0.0, 0.0)
    asked = {f"{family}_turn": math.radians(-8.0), "extent": (2000.0,) * 4}
    net = meshdrape.drape(mould, fabric, seed, direction, **asked)
    found = meshdrape.refine(mould, fabric, net=net) if known else meshdrape.refine(
        mould, fabric, seed, direction, **asked)  # fmt: skip
    for power, maximum in ((4, found.max_shear[0]), (2, found.max_shear[1]), (1, found.max_shear[2])):
        same = sample(
            "wing_spar",
            angle_tolerance=power * mould.angle_tolerance,
            chord_tolerance=power * mould.chord_tolerance,
        )
        at = same.surface.closest_point(net.seed)[0].position(same.surface)
        alone = meshdrape.measure(meshdrape.drape(same, fabric, at, net.direction, **asked)).max_shear
        assert maximum == pytest.approx(alone, abs=1e-12)
    straight = meshdrape.measure(meshdrape.drape(mould, fabric, seed, direction, extent=asked["extent"])).max_shear
    assert abs(straight - found.max_shear[-1]) > math.radians(1.0) > 5 * found.error_bar


@pytest.mark.parametrize("known", [True, False])
def test_all_that_was_asked_is_asked_again(monkeypatch, known):
    """Two drawn fibres, cloth of a given length, fibres that come back, the other engine: of all four drapes."""
    asked = {
        "extent": (100.0, 50.0, 50.0, 0.0),
        "warp_path": ((-300.0, 0.0, 0.0), (0.0, 10.0, 0.0), (300.0, 0.0, 0.0)),
        "weft_path": ((0.0, -300.0, 0.0), (5.0, 0.0, 0.0), (0.0, 300.0, 0.0)),
        "recrossing": True,
        "engine": "libigl",
    }
    mould, fabric = sample("hypar"), meshdrape.Fabric(50.0)
    # drawn on the mould, wherever it lies
    for name in ("warp_path", "weft_path"):
        asked[name] = [mould.surface.closest_point(np.array(p))[0].position(mould.surface) for p in asked[name]]
    net = meshdrape.drape(mould, fabric, **asked) if known else None
    nets = []
    monkeypatch.setattr(convergence, "drape", lambda *words, **named: nets.append(meshdrape.drape(*words, **named))
                        or nets[-1])  # fmt: skip
    meshdrape.refine(mould, fabric, **({"net": net} if known else asked))
    assert len(nets) == (3 if known else 4)
    for one in nets:
        assert (one.request.extent, one.request.recrossing, one.request.engine) == (asked["extent"], True, "libigl")
        for name, path in zip(("warp_path", "weft_path"), one.start_fibres.paths, strict=True):
            np.testing.assert_array_equal(path, asked[name])
    assert sorted(one.fabric.spacing for one in nets) == [50.0] * (len(nets) - 1) + [100.0]


def test_cloth_that_stops_has_its_largest_shear():
    mould, fabric = sample("hypar"), meshdrape.Fabric(50.0)
    net = meshdrape.drape(mould, fabric, (0, 0, 0), (1, 0, 0), extent=(200,) * 4, stop_at=0.1)
    with pytest.raises(StartError, match="refine it without a shear to stop at"):
        meshdrape.refine(mould, fabric, net=net)


# --- the arithmetic ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("order", [0.5, 0.75, 1.0])
def test_richardson_is_exact_where_one_power_rules(order):
    values = [3.0 + 0.2 * (4.0 / 2**k) ** order for k in range(3)]
    found, error = extrapolated(*values)
    assert found == pytest.approx(order)
    assert error == pytest.approx(1.25 * (values[-1] - 3.0))


def test_the_order_is_not_believed_past_the_first():
    values = [3.0 + 0.2 * (4.0 / 2**k) ** 2 for k in range(3)]
    found, error = extrapolated(*values)
    assert found == pytest.approx(2)
    assert error == pytest.approx(1.25 * (values[1] - values[2]))


@pytest.mark.parametrize("values", [(1.0, 3.0, 2.0), (1.0, 1.1, 2.0), (1.0, 2.0, 2.0), (1.0, 2.0, 2.001)])
def test_elsewhere_it_is_the_spread(values):
    assert extrapolated(*values) == (None, pytest.approx(np.ptp(values)))
