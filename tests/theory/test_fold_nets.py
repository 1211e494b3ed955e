"""The net over the fold by characteristics (section 6) and exactly, against numbers found without either.

Source of the figures: Barton et al., New Techniques for Composite Wing Manufacture (the study group report), figure 4
and section 2 for the moulds; the largest shears of the discrete net were computed by unrolling both sheets.
"""

from functools import cache

import numpy as np
import pytest
from rates import orders
from references import Crease, CreaseNet

from meshdrape.errors import DesignError, NetError
from meshdrape.theory import (
    RIBBON_FED,
    WING_FED,
    Fold,
    Profile,
    characteristic_net,
    discrete_net,
    flat,
    linear_deviation,
    named_deviation,
    quadratic,
    real_wing,
    ripple_deviation,
    wing_fed_bound,
)

FIGURE_4 = Fold(quadratic(0.2, 1.0), quadratic(0.4, 1.0))
# spacing: largest shear, degrees, ribbon-fed at gamma = 0, ribbon-fed at gamma = -9.6291 degrees, wing-fed
FIGURE_4_SHEAR = {
    0.05: (18.59268, 8.96357, 10.79419),
    0.02: (19.05227, 9.42316, 14.03986),
    0.01: (19.11677, 9.48766, 15.55281),
    0.005: (19.21283, 9.58373, 16.68569),
}
WING = real_wing()
# f: largest shear of the discrete net, spacing 0.02, spar height 1, degrees: wing-fed, ribbon-fed at gamma = 0
REAL_SHEAR = {"parabola": (3.008, 2.134), "linear": (0.169, 5.621), "sin2_slope": (5.669, 4.385)}
BOTH = (discrete_net, characteristic_net)


def real_fold(name, **parameters):
    return Fold(WING, WING + named_deviation(name, 14.0, **(parameters or {"c": 0.1})))


def largest_deg(net, region, **options):
    return float(np.degrees(net.max_shear(region, **options).shear))


@cache
def figure_4_net(build, spacing, gamma_deg=0.0):
    return build(FIGURE_4, spacing, 0.6, float(np.radians(gamma_deg)))


@pytest.mark.parametrize("spacing", FIGURE_4_SHEAR)
def test_discrete_net_of_figure_4(spacing):
    straight, turned, wing_fed = FIGURE_4_SHEAR[spacing]
    net, other = figure_4_net(discrete_net, spacing), figure_4_net(discrete_net, spacing, -9.6291)
    assert largest_deg(net, RIBBON_FED, everywhere=True) == pytest.approx(straight, abs=6e-6)
    assert largest_deg(other, RIBBON_FED, everywhere=True) == pytest.approx(turned, abs=1.2e-5)
    assert largest_deg(net, WING_FED, everywhere=True) == pytest.approx(wing_fed, abs=6e-6)


@pytest.mark.parametrize("spacing", FIGURE_4_SHEAR)
def test_characteristic_net_of_figure_4(spacing):
    straight, turned, wing_fed = FIGURE_4_SHEAR[spacing]
    net, other = figure_4_net(characteristic_net, spacing), figure_4_net(characteristic_net, spacing, -9.6291)
    assert largest_deg(other, RIBBON_FED, everywhere=True) == pytest.approx(turned, abs=0.002)
    assert largest_deg(net, RIBBON_FED, everywhere=True) == pytest.approx(straight, abs=0.001)
    assert largest_deg(net, WING_FED, everywhere=True) == pytest.approx(wing_fed, abs=0.004)


@pytest.mark.parametrize("name", REAL_SHEAR)
@pytest.mark.parametrize("build", BOTH)
def test_real_wing(build, name):
    net = build(real_fold(name), 0.02, 1.0)
    for region, published in zip((WING_FED, RIBBON_FED), REAL_SHEAR[name], strict=True):
        assert largest_deg(net, region) == pytest.approx(published, abs=6e-4)


def reference(fold, net, height_rows, first_row):
    crease = Crease((fold.wing, fold.wing.slope), (fold.spar, fold.spar.slope), fold.span)
    sheet = net.sheet
    return CreaseNet(crease, sheet.spacing, len(sheet.s), first_row, height_rows, sheet.gamma)


@pytest.mark.parametrize(
    ("fold", "spacing", "height", "gamma"),
    [
        (FIGURE_4, 0.05, 0.6, 0.0),
        (FIGURE_4, 0.02, 0.3, -0.2),
        (Fold(quadratic(0.1, 2.0), quadratic(0.45, 2.0)), 0.05, 0.4, 0.1),
        (real_fold("parabola"), 0.2, 1.0, 0.0),
        (real_fold("linear"), 0.1, 0.5, "free"),
    ],
    ids=["figure 4", "figure 4 turned", "steep", "parabola", "linear free"],
)
def test_discrete_net_is_the_one_found_node_by_node(fold, spacing, height, gamma):
    """Against two-circle intersections by Newton's method with a search for the shortest way over the crease."""
    net = discrete_net(fold, spacing, height, gamma)
    j = net.sheet.row
    other = reference(fold, net, len(j), int(j[-1]))
    flip = slice(None, None, -1)  # its rows run from smaller x to larger
    assert (other.side[:, flip] == net.sheet.on_spar).all()
    assert np.abs(net.place[..., ::-1] - other.place[:, flip]).max() < 1e-11 * fold.span
    assert np.abs(net.node - other.node[:, flip]).max() < 1e-8 * fold.span  # its unrolling is a table
    assert np.array_equal(np.isnan(net.shear), np.isnan(other.shear[:, flip]))
    assert np.nanmax(np.abs(net.shear - other.shear[:, flip])) < 1e-9
    assert (net.region == np.maximum(other.region[:, flip], 0)).all()


def links(net):
    """Length of every link on the spar, along rows and along columns, over the spacing."""
    on, plane = net.sheet.on_spar, net.plane
    for axis in (0, 1):
        both = np.delete(on, -1, axis) & np.delete(on, 0, axis)
        yield np.abs(np.diff(plane, axis=axis))[both] / net.sheet.spacing


@pytest.mark.parametrize("name", REAL_SHEAR)
def test_links_are_one_spacing_long(name):
    fold = real_fold(name)
    for length in links(discrete_net(fold, 0.02, 1.0)):
        assert np.abs(length - 1).max() < 1e-9
    # of the characteristic net to second order in the spacing
    worst = [max(np.abs(k - 1).max() for k in links(characteristic_net(fold, h, 1.0, "free"))) for h in (0.08, 0.04)]
    assert np.log2(worst[0] / worst[1]) > 1.8, worst


def test_both_constructions_agree_at_20_mm():
    """Nodes to a hundredth of the spacing, shear to 0.02 degrees, cell by cell."""
    for fold, height, gamma in (
        (FIGURE_4, 0.6, 0.0),
        (real_fold("parabola"), 1.0, 0.0),
        (real_fold("linear"), 1.0, "free"),
        (real_fold("sin2_slope"), 1.0, -0.03),
        (FIGURE_4, 0.6, -0.168),
    ):
        exact, closed = (build(fold, 0.02, height, gamma) for build in BOTH)
        assert np.array_equal(exact.region, closed.region)
        assert np.abs(exact.plane - closed.plane).max() < 0.01 * 0.02
        assert np.degrees(np.abs(exact.shear - closed.shear)[exact.region > 0].max()) < 0.02


def test_nodes_of_the_two_constructions_converge():
    """Second order, nearly: the first row leaves the crease of figure 4 tangentially."""
    gap = [
        np.abs(figure_4_net(discrete_net, h).plane - figure_4_net(characteristic_net, h).plane).max()
        for h in (0.02, 0.01, 0.005)
    ]
    assert (orders(gap) > 1.6).all(), gap


def test_limits_of_figure_4():
    """Ribbon-fed first order, wing-fed like the root of the spacing; both towards |ψ(1)| = 19.25821 degrees."""
    spacing = np.array(list(FIGURE_4_SHEAR))
    ribbon, wing = (
        19.25821 - np.array([largest_deg(figure_4_net(discrete_net, h), k, everywhere=True) for h in spacing])
        for k in (RIBBON_FED, WING_FED)
    )
    # how far the last column lies from the end changes with the spacing: within two columns of the end
    assert (ribbon < 2 * spacing * 25).all()
    rate = np.log(wing[0] / wing[-1]) / np.log(spacing[0] / spacing[-1])
    assert 0.45 < rate < 0.55, wing


@pytest.mark.parametrize("build", BOTH)
def test_gamma_moves_only_ribbon_fed_cells(build):
    """Rows from the wing do not change by one bit."""
    fold = real_fold("parabola")
    first, second = (build(fold, 0.02, 1.0, gamma) for gamma in (0.0, -0.02))
    rows = min(len(first.sheet.x), len(second.sheet.x)) - 1
    fed = first.region[:, :rows] == WING_FED
    assert np.array_equal(fed, second.region[:, :rows] == WING_FED)
    assert fed.sum() > 1000
    assert np.array_equal(first.shear[:, :rows][fed], second.shear[:, :rows][fed])
    ribbon = (first.region == RIBBON_FED)[:, :rows] & (second.region == RIBBON_FED)[:, :rows]
    turned = second.shear[:, :rows][ribbon] - first.shear[:, :rows][ribbon]
    assert turned == pytest.approx(-0.02, abs=1e-4)


@pytest.mark.parametrize("build", BOTH)
def test_flat_wing_and_straight_skew_spar(build):
    """psi = -arctan 0.12 = -6.842773 degrees. Turned along with it, no shear at all; upright, that where rows start
    on the left ribbon and none elsewhere."""
    fold = Fold(flat(2.0), linear_deviation(0.12, 2.0))
    free = build(fold, 0.04, 0.5, "free", row_offset=0.0)
    assert np.nanmax(np.abs(free.shear)) < 1e-11
    upright = build(fold, 0.04, 0.5, 0.0, row_offset=0.0)
    fed = upright.region == RIBBON_FED
    wing_fed = upright.region == WING_FED
    assert fed.sum() > 300
    assert wing_fed.sum() > 20
    assert np.abs(upright.shear[wing_fed]).max() < 1e-11
    assert np.degrees(upright.shear[fed]) == pytest.approx(6.842773, abs=5e-7)


def test_kink_at_the_corner_turns_the_first_column():
    """Rows half a spacing off the corner: the ribbon's link over it is bent, in the first column alone, whatever the
    spacing; both constructions agree to round-off on this polyhedron."""
    fold = Fold(flat(2.0), linear_deviation(0.12, 2.0))
    for spacing in (0.04, 0.01):
        exact, closed = (build(fold, spacing, 0.3, 0.0) for build in BOTH)
        fed = exact.region == RIBBON_FED
        assert np.degrees(exact.shear[0][fed[0]]) == pytest.approx(6.945084, abs=1e-6)
        assert np.degrees(exact.shear[1:][fed[1:]]) == pytest.approx(6.842773, abs=1e-6)
        assert np.abs(exact.plane - closed.plane).max() < 1e-12


@pytest.mark.parametrize("build", BOTH)
def test_origami(build):
    fold = Fold(quadratic(0.3, 1.0), quadratic(0.3, 1.0))
    assert np.nanmax(np.abs(build(fold, 0.03, 0.8).shear)) < 1e-10


@pytest.mark.parametrize("build", BOTH)
def test_flat_spar_of_section_5(build):
    """g_s = 0: all rows keep parallel to the edge, shear is |ψ| = arctan |g_w'|, and (21) is exact."""
    wing = quadratic(0.05, 2.0)
    fold = Fold(wing, flat(2.0))
    for offset in (0.0, 0.5, 1.0):
        net = build(fold, 0.02, 0.5, 0.0, row_offset=offset)
        assert not (net.region == WING_FED).any()
        depth = net.depth[:, net.sheet.row < 0]
        # the discrete net's links over the edge are straight, not upright on both sides: shorter by ψ² / 4 of it
        assert np.ptp(depth, axis=0).max() < (0.01 if build is discrete_net else 1e-9) * 0.02
        middle = (net.sheet.y[:-1] + net.sheet.y[1:]) / 2
        shear = net.shear[:, -2]
        # g_w' is a mean over the column, which its middle meets to second order
        assert np.abs(shear + np.arctan(wing.slope(middle))).max() < 1e-4


def test_sheet_laid_on_the_spar_first():
    """Swapped twice it is the same; an upward wing then has to be started at the tip, where its crease falls away."""
    fold = real_fold("parabola")
    laid = fold.swapped()
    from_root = characteristic_net(laid, 0.1, 1.0)
    assert len(from_root.sheet.exit_row) > 5
    from_tip = characteristic_net(laid.reversed(), 0.1, 1.0)
    assert len(from_tip.sheet.exit_row) == 0
    node = fold.from_swapped(laid.from_reversed(from_tip.node))
    on_wing = from_tip.sheet.on_spar
    # within the span both halves lie on the mould
    inside = (node[..., 1] >= 0) & (node[..., 1] <= 14)
    assert node[on_wing & inside][:, 2] == pytest.approx(fold.wing(node[on_wing & inside][:, 1]), abs=1e-9)
    assert node[~on_wing][:, 0] == pytest.approx(fold.spar(node[~on_wing][:, 1]), abs=1e-9)
    assert (node[on_wing & inside][:, 0] > fold.spar(node[on_wing & inside][:, 1]) - 1e-9).all()


def test_rows_that_come_back_to_the_wing_are_named():
    """Section 3.4: ill-posed. A ripple whose slope outweighs the wing's lets rows cross the edge twice."""
    fold = Fold(flat(4.0), ripple_deviation(0.05, 2.0, 4.0))
    sheet = characteristic_net(fold, 0.02, 0.5).sheet
    y = sheet.y[sheet.exit_column]
    assert len(y) > 4
    falling = ((y > 1) & (y < 2.03)) | ((y > 3) & (y < 4.03))
    assert falling.all()
    assert (fold.spar.slope(sheet.entry_y) > 0).all()


@pytest.mark.parametrize("build", BOTH)
@pytest.mark.parametrize("spacing", [0.02, 0.01])
def test_regions_leave_out_what_rows_that_come_back_tear(build, spacing):
    """No cell that is counted shears by more than all of ψ, though of the others some may."""
    fold = real_fold("sine", c=0.05, wavelength=3.5)
    net = build(fold, spacing, 1.0)
    assert len(net.sheet.exit_row) > 0
    bound = wing_fed_bound(fold)
    assert net.max_shear(WING_FED).shear == pytest.approx(bound, rel=0.02)
    assert net.max_shear(WING_FED).shear < bound * 1.0005
    if build is discrete_net:
        torn = (net.region == 0) & np.isfinite(net.shear)
        assert np.abs(net.shear[torn]).max() > bound


def test_row_offset_moves_the_rows():
    for offset in (0.0, 0.25, 1.0):
        sheet = characteristic_net(FIGURE_4, 0.05, 0.3, row_offset=offset).sheet
        assert sheet.x == pytest.approx((sheet.row + offset) * 0.05, abs=1e-15)
        assert (sheet.x[0] - FIGURE_4.spar(1.0)) >= 0


@pytest.mark.parametrize("gamma", [-0.4, 0.0, 0.3])
def test_rows_reach_below_the_spar(gamma):
    net = characteristic_net(real_fold("linear"), 0.1, 1.0, gamma)
    assert net.depth[:, -1].min() >= 1.0
    assert net.depth[:, -4].min() < 1.0


def test_place_of_the_largest_shear():
    net = figure_4_net(discrete_net, 0.02)
    worst = net.max_shear(WING_FED)
    i, r = worst.cell
    assert abs(net.shear[i, r]) == worst.shear
    corners = net.node[i : i + 2, r : r + 2].reshape(-1, 3)
    assert np.abs(corners.mean(axis=0) - worst.place).max() < 0.02
    assert net.within[i, r]


def test_refused():
    for parameters, culprit in (
        ((0.0, 1.0), "spacing=0.0"),
        ((0.9, 1.0), "spacing=0.9"),
        ((0.1, 0.0), "height=0.0"),
        ((0.1, 1.0, 2.0), "gamma=2.0"),
        ((0.1, 1.0, "best"), "gamma='best'"),
        ((0.1, 1.0, 0.0, 1.5), "row_offset=1.5"),
    ):
        with pytest.raises(DesignError, match=culprit):
            discrete_net(FIGURE_4, *parameters)
    with pytest.raises(NetError, match=r"too large; raise the spacing"):
        characteristic_net(FIGURE_4, 1e-4, 1.0)
    with pytest.raises(NetError, match=r"rows come back .* from y = .* start at the other end"):
        discrete_net(Fold(flat(2.0), linear_deviation(-0.5, 2.0)), 0.02, 0.5, 0.4)
    tilted = linear_deviation(0.2, 2.0)
    with pytest.raises(NetError, match=r"near y = .*lower the spacing"):
        discrete_net(Fold(flat(2.0), tilted + named_deviation("sine", 2.0, c=0.02, wavelength=0.1)), 0.1, 0.3)


@pytest.mark.parametrize("build", BOTH)
def test_unit_and_origin_do_not_matter(build):
    """Millimetres for metres, and both profiles lifted off 0 at y = 0."""
    plain = build(real_fold("sin2_slope"), 0.1, 1.0, -0.01)
    wing = real_wing(14000.0, metre=1000.0)
    scaled = build(Fold(wing, wing + named_deviation("sin2_slope", 14000.0, c=0.1)), 100.0, 1000.0, -0.01)
    assert np.nanmax(np.abs(scaled.shear - plain.shear)) < 1e-9
    assert np.abs(scaled.node - 1000 * plain.node).max() < 1e-6

    def lifted(profile, by):
        return Profile(
            profile.span, lambda y: profile.value(y) + by, profile.derivative, profile.second_derivative
        )  # fmt: skip

    fold = real_fold("sin2_slope")
    moved = build(Fold(lifted(fold.wing, 0.7), lifted(fold.spar, -0.4)), 0.1, 1.0, -0.01)
    assert np.array_equal(moved.region, plain.region)
    assert np.nanmax(np.abs(moved.shear - plain.shear)) < 1e-9
    assert np.abs(moved.node - plain.node - [-0.4, 0, 0.7]).max() < 1e-9
