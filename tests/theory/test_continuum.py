"""The smooth net on a height field, section 7 of the study group report: (33) to (35)."""

import numpy as np
import pytest
from rates import orders

from meshdrape.errors import DesignError, NetError
from meshdrape.theory import (
    HeightField,
    curve_fibre,
    geodesic,
    hypar,
    plane_section,
    smooth_net,
    sphere_net,
    weak_surface,
)


def cap(x, y):
    return np.sqrt(1 - x * x - y * y)


# the unit sphere's upper half, by formulas
HALF_SPHERE = HeightField(
    cap,
    lambda x, y: (-x / cap(x, y), -y / cap(x, y)),
    lambda x, y: (
        -(1 - y * y) / cap(x, y) ** 3,
        -x * y / cap(x, y) ** 3,
        -(1 - x * x) / cap(x, y) ** 3,
    ),
)


def mould(x, y):
    """The generic double-curved mould of KinDrape (Krogh et al. 2021, doi 10.1007/s00158-021-02925-z), metres."""
    return (
        1.004 * x + 1.089 * y - 3.667 * x**2 - 4.4 * x * y - 3.75 * y**2
        + 3.086 * x**3 + 8.889 * x**2 * y + 4.321 * y**3
    )  # fmt: skip


MOULD = HeightField(
    mould,
    lambda x, y: (
        1.004 - 7.334 * x - 4.4 * y + 9.258 * x**2 + 17.778 * x * y,
        1.089 - 4.4 * x - 7.5 * y + 8.889 * x**2 + 12.963 * y**2,
    ),
    lambda x, y: (-7.334 + 18.516 * x + 17.778 * y, -4.4 + 17.778 * x, -7.5 + 25.926 * y),
)


def net_of(field, make, extent, cells, levels=1):
    warp, weft = make(field, (1, 0), extent), make(field, (0, 1), extent)
    return smooth_net(field, warp, weft, (extent, extent), (cells, cells), levels)


@pytest.mark.parametrize(("levels", "order"), [(1, 2), (2, 4), (3, 6)])
def test_convergence_on_the_sphere(levels, order):
    """Against the power series of the sphere's own net, which knows nothing of height fields."""
    error = []
    for cells in (8, 16, 32):
        net = net_of(HALF_SPHERE, geodesic, 0.8, cells, levels)
        error.append(np.abs(net.node - sphere_net(1.0, net.u, net.v)).max())
    assert orders(error)[-1] == pytest.approx(order, abs=0.3), error
    assert error[-1] < (1e-3, 1e-6, 1e-8)[levels - 1]


@pytest.mark.parametrize("make", [plane_section, geodesic])
def test_fibres_keep_their_length(make):
    """(33), (34): |r_u| = |r_v| = 1 everywhere, to the order of the scheme."""
    worst = []
    for cells in (10, 20, 40):
        net = net_of(MOULD, make, 0.3, cells)
        worst.append(max(np.abs(speed - 1).max() for speed in net.speeds))
    assert orders(worst)[-1] > 1.7, worst
    fine = net_of(MOULD, make, 0.3, 40, 3)
    assert max(np.abs(speed - 1).max() for speed in fine.speeds) < 1e-6


def test_shear_is_the_curvature_enclosed():
    """Hazzidakis: from geodesics at right angles the shear at (u, v) is the integral of K over the rectangle."""
    field = HeightField(
        lambda x, y: mould(x, y) - 1.004 * x - 1.089 * y,
        lambda x, y: tuple(g - flat for g, flat in zip(MOULD.gradient(x, y), (1.004, 1.089), strict=True)),
        MOULD.hessian,
    )
    net = net_of(field, geodesic, 0.25, 24, 4)
    weight = np.tile([2.0, 4.0], 12)
    weight = np.append(weight, 1.0)
    weight[0] = 1.0
    weight *= 0.25 / 24 / 3  # Simpson
    area = np.cos(net.shear)  # sin of the angle
    enclosed = weight @ (field.curvature(*np.moveaxis(net.plane, -1, 0)) * area) @ weight
    assert net.shear[-1, -1] == pytest.approx(enclosed, rel=2e-5)
    assert abs(np.degrees(enclosed)) > 5


def test_developable_surfaces_need_no_shear_from_geodesics():
    """z = -sqrt(ε) (x + y)² is a cylinder laid askew; a cone; from geodesics at right angles neither shears."""
    cone = HeightField.numerical(lambda x, y: -np.hypot(x + 2.0, y), 1e-3)
    net = smooth_net(cone, geodesic(cone, (1, 0), 0.8), geodesic(cone, (0, 1), 0.8), (0.8, 0.8), (8, 8), levels=3)
    assert np.abs(net.shear).max() < 1e-6
    net = net_of(weak_surface(1, 1, 1, 0.05), geodesic, 1.0, 16, 4)
    assert np.abs(net.shear).max() < 1e-7  # the spline that tells the tangents


def test_start_fibres_are_what_they_say():
    s = np.linspace(0, 0.3, 61)
    for make in (plane_section, geodesic):
        fibre = make(MOULD, (0.6, 0.8), 0.3)(s)
        space = np.concatenate([fibre, MOULD.z(*fibre.T)[:, None]], axis=1)
        rate = np.gradient(space, s, axis=0, edge_order=2)
        assert np.linalg.norm(rate[2:-2], axis=1) == pytest.approx(1, abs=1e-3)
        if make is plane_section:
            assert fibre @ [0.8, -0.6] == pytest.approx(0, abs=1e-15)
        else:  # its curvature is along the normal
            bend = np.gradient(rate, s, axis=0, edge_order=2)
            p, q = MOULD.gradient(*fibre.T)
            normal = np.stack([-p, -q, 1 + 0 * p], axis=1) / np.sqrt(1 + p * p + q * q)[:, None]
            sideways = bend - np.sum(bend * normal, axis=1)[:, None] * normal
            assert np.abs(sideways[3:-3]).max() < 0.01 * np.linalg.norm(bend[3:-3], axis=1).max()


def test_any_curve_as_start_fibre():
    """A straight line given with a parameter of its own is the plane section."""
    line = curve_fibre(
        MOULD,
        lambda t: np.stack([np.sinh(t), 0 * np.asarray(t)], axis=-1),
        lambda t: np.stack([np.cosh(t), 0 * np.asarray(t)], axis=-1),
        0.3,
    )
    s = np.linspace(0, 0.3, 17)
    assert line(s) == pytest.approx(plane_section(MOULD, (1, 0), 0.3)(s), abs=1e-12)


def test_numerical_derivatives():
    rough = HeightField.numerical(mould, 1e-3)
    x, y = np.random.default_rng(2).uniform(0, 0.5, (2, 50))
    assert np.stack(rough.gradient(x, y)) == pytest.approx(np.stack(MOULD.gradient(x, y)), abs=1e-11)
    assert np.stack(rough.hessian(x, y)) == pytest.approx(np.stack(MOULD.hessian(x, y)), abs=1e-8)
    assert hypar(0.7).curvature(0.3, 0.2) == pytest.approx(-(0.7**2) / (1 + 0.49 * 0.13) ** 2, rel=1e-14)


def test_shear_limit():
    net = net_of(HALF_SPHERE, geodesic, 0.8, 16, 2)
    over = net.over(np.radians(20))
    assert np.array_equal(over, np.abs(net.shear) > np.radians(20))
    assert over[-1, -1]
    assert not over[0].any()


def test_refused():
    field = weak_surface(1, 0, 1, 0.1)
    warp = plane_section(field, (1, 0), 1.0)
    with pytest.raises(DesignError, match="must leave one seed"):
        smooth_net(field, warp, geodesic(field, (0, 1), 1.0, seed=(0.1, 0.0)), (1, 1), (8, 8))
    with pytest.raises(DesignError, match="at least 4 cells"):
        smooth_net(field, warp, warp, (1, 1), (2, 8))
    steep = HeightField(cap, lambda x, y: (-x / cap(x, y), -y / cap(x, y)), HALF_SPHERE.hessian)
    with (
        np.errstate(invalid="ignore"),
        pytest.raises(NetError, match=r"cannot be continued at cell .* lower the extent"),
    ):
        net_of(steep, geodesic, 1.45, 16)
