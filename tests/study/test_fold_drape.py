"""One drape of a wing box against the nets computed without a mesh, and against itself seen otherwise.

Sources: study group report, sections 3.4 (figure 4), 2 and 4; numbers of the discrete nets by unrolling, as in
`tests/validation`. Regions are counted by each row's own history.
"""

from pathlib import Path

import numpy as np
import pytest
from fold_designs import FIGURE_4, design, draped, in_degrees

from meshdrape.study.fold.design import read_design
from meshdrape.study.fold.frame import Cloth, frame_of
from meshdrape.study.fold.lay import lay, regions
from meshdrape.study.fold.mould import cad_mould, facet_bounds, ruled_mould
from meshdrape.theory import characteristic_net, discrete_net, psi_range

# f: largest shear of the discrete net, wing-fed and ribbon-fed, spacing 20 mm, spar 1 m, gamma 0; degrees
REAL_WING = {"parabola": (3.008, 2.134), "linear": (0.169, 5.621), "sin2_slope": (5.669, 4.385)}


@pytest.mark.parametrize("name", REAL_WING)
def test_real_wing_on_its_cad_mould(name):
    """Published to the third digit; drape and characteristic construction agree with it to 0.02 degrees."""
    drape = draped(design(spar={"deviation": name, "c": 0.1}), cad=True)
    assert in_degrees(drape) == pytest.approx(REAL_WING[name], abs=0.02)
    frame = drape.cloth.frame
    net = characteristic_net(frame.fold, 20.0, 1000.0, 0.0)
    assert in_degrees(drape) == pytest.approx(np.degrees([net.max_shear(2).shear, net.max_shear(1).shear]), abs=0.02)
    assert np.degrees(drape.first_sheet) < 1e-6


@pytest.mark.parametrize(("gamma", "ribbon_fed", "cad"), [(0.0, 19.05227, False), (-9.6291, 9.42316, True)])
def test_figure_4(gamma, ribbon_fed, cad):
    drape = draped(design(FIGURE_4, start={"gamma_deg": gamma}), cad=cad)
    assert in_degrees(drape) == pytest.approx((14.03986, ribbon_fed), abs=0.001)


@pytest.mark.parametrize("changes", [
    {"spar": {"deviation": "sine", "c": 0.05, "wavelength": 7.0}},
    {"spar": {"deviation": "ripple", "c": 0.01, "wavelength": 2.0}},
    {"spar": {"deviation": "bump", "c": 0.05, "length": 4.0}, "row_offset": 0.2},
    {"wing": {"profile": "arc", "radius": 80.0}, "spar": {"profile": "arc", "radius": 60.0},
     "start": {"gamma_deg": "best"}},
    {"start": {"first": "spar", "end": "tip", "gamma_deg": "free"}},
    {"spacing": 0.05, "spar": {"deviation": "parabola", "c": 0.3}, "start": {"gamma_deg": 1.0}},
])  # fmt: skip
def test_every_cell_agrees_with_the_discrete_net(changes):
    """Region by region: the same tags, cell by cell the same shear, to the turn of a facet of the crease."""
    drape = draped(design(**changes))
    frame, cloth = drape.cloth.frame, drape.cloth
    net = discrete_net(frame.fold, cloth.spacing, frame.height, drape.gamma, cloth.row_offset)
    here = net.within & drape.within
    assert np.array_equal(net.region[here], drape.region[here])
    tagged = here & (net.region > 0)
    assert tagged.sum() > 0.98 * ((net.region > 0) & net.within).sum() > 0
    _, turn = facet_bounds(frame, np.radians(0.015), 2500)
    assert np.degrees(np.abs(net.shear - drape.shear)[tagged].max()) < np.degrees(turn) + 0.002
    assert in_degrees(drape) == pytest.approx(np.degrees([net.max_shear(2).shear, net.max_shear(1).shear]), abs=0.02)


@pytest.mark.parametrize("base", [None, FIGURE_4])
def test_rows_from_the_wing_do_not_change_by_one_bit(base):
    """Whatever gamma: every cell of rows that come over the crease."""
    of = design(base, spacing=0.05)
    cells = []
    for degrees in (0.0, -9.6291, 3.0):
        drape = draped(of, float(np.radians(degrees)))
        rows = int(np.argmax(drape.on_spar[0])) - 1  # those above the corner
        cells.append((drape.shear[:, :rows], (drape.region == 2)[:, :rows] & drape.within[:, :rows]))
    rows = min(shear.shape[1] for shear, _ in cells)
    first, tagged = cells[0]
    assert tagged.sum() > 30
    for shear, region in cells[1:]:
        assert np.array_equal(region[:, :rows], tagged[:, :rows])
        assert np.array_equal(shear[:, :rows][tagged[:, :rows]], first[:, :rows][tagged[:, :rows]])


@pytest.mark.parametrize(("seen", "changes"), [("reversed", {"end": "tip"}), ("swapped", {"first": "spar"})])
def test_the_same_mould_seen_otherwise(seen, changes):
    """The mirror image of the fold laid from its other end, or on its other side, is the same sheet."""
    of = design(spacing=0.05)
    one = draped(of)
    other_fold = getattr(of.fold, seen)()
    frame = frame_of(of, other_fold, **changes)
    frame = type(frame)(other_fold, frame.first, frame.end, of.spar_height)
    cloth = Cloth.of(frame, of.spacing, of.row_offset, 0.0)
    other = lay(cloth, ruled_mould(frame, cloth), 0.0, of.locking_angle)
    assert np.array_equal(one.region, other.region)
    assert np.degrees(one.shear) == pytest.approx(np.degrees(other.shear), abs=1e-6, nan_ok=True)


@pytest.mark.parametrize("first", ["wing", "spar"])
@pytest.mark.parametrize("end", ["root", "tip"])
def test_frames_lead_back_to_the_design(first, end):
    """The crease of the frame is the crease of the design, and both maps undo each other."""
    of = design()
    frame = frame_of(of, first=first, end=end)
    y = np.linspace(0, 14000, 29)
    crease = frame.to_design(np.stack([frame.fold.spar(y), y, frame.fold.wing(y)], axis=1))
    assert crease[:, 0] == pytest.approx(of.fold.spar(crease[:, 1]), abs=1e-9)
    assert crease[:, 2] == pytest.approx(of.fold.wing(crease[:, 1]), abs=1e-9)
    assert crease[:, 1] == pytest.approx([frame.station(at) for at in y])
    points = np.random.default_rng(0).normal(size=(5, 3))
    assert frame.from_design(frame.to_design(points)) == pytest.approx(points, abs=1e-9)
    # psi is a property of the fold, but for its sign
    least, greatest = psi_range(frame.fold)
    assert max(abs(least.value), abs(greatest.value)) == pytest.approx(np.radians(5.688), abs=1e-5)


def test_cad_mould_in_its_frame_is_outward_and_ends_in_the_crease():
    """Normals of the side laid first point up, those of the other towards smaller x, from whichever side it is seen."""
    of = design(start={"first": "spar", "end": "tip"})
    frame = frame_of(of)
    cloth = Cloth.of(frame, of.spacing, of.row_offset, 0.0)
    made = cad_mould(of, frame, cloth)
    normal = made.mould.surface.face_normal
    up = normal[:, 2] > 0.5
    assert up.any()
    assert (normal[~up, 0] < -0.5).all()
    y = made.crease[:, 1]
    assert (np.diff(y) > 0).all()
    assert (y[0], y[-1]) == pytest.approx((0, 14000), abs=1e-6)
    assert made.crease[:, 0] == pytest.approx(frame.fold.spar(y), abs=2e-4)
    assert np.degrees(made.psi_at_start()) == pytest.approx(np.degrees(frame.fold.psi(0.0)), abs=0.02)


def test_the_sample_that_the_readme_shows():
    """Its largest shear as printed there, and what (20) makes of it."""
    root = Path(__file__).parents[2]
    of = read_design(root / "samples" / "designs" / "real_wing_sine.toml")
    wing_fed, ribbon_fed = in_degrees(draped(of))
    shown = (root / "README.md").read_text(encoding="utf-8")
    assert f"the cloth shears by {wing_fed:.2f} deg and locks at 7.00 deg" in shown
    assert f"characteristics             {wing_fed:.2f}        {ribbon_fed:.2f}   right here" in shown
    steepest = np.degrees(np.arctan(np.abs(of.deviation_profile.slope(np.linspace(0, 14000, 14001))).max()))
    assert f"(20) arctan max|f'|             -        {steepest:.2f}   unsafe here" in shown


@pytest.mark.parametrize(("c", "wavelength"), [(0.15, 3.5), (-1.2, 14.0)])
def test_regions_where_rows_come_back(c, wavelength):
    """The tags of the net made without a mesh: a ribbon's row that went over the wing is wing-fed when it is back."""
    of = design(spar={"deviation": "sine", "c": c, "wavelength": wavelength}, spacing=0.05)
    net = characteristic_net(of.fold, 50.0, 1000.0)
    assert len(net.sheet.exit_row) > 10
    assert np.array_equal(regions(net.sheet.on_spar), net.region)
