"""What gamma cannot touch: rows that come over the edge, whichever side is laid first, from whichever end."""

import numpy as np
import pytest
from fold_designs import design, draped

from meshdrape.weave.status import NodeStatus

DESIGNS = {
    "from the tip on the spar": {"start": {"first": "spar", "end": "tip"}},
    "a row at the corner": {"spar": {"deviation": "sin2_slope", "c": 0.2}, "row_offset": 0.0},
    "waves": {"spar": {"deviation": "sine", "c": 0.05, "wavelength": 7.0}, "row_offset": 0.7},
    "a flat spar": {"spar": {"profile": "flat"}, "row_offset": 1.0},
    "arcs": {"wing": {"profile": "arc", "radius": 80.0}, "spar": {"profile": "arc", "radius": 50.0}},
}


@pytest.mark.parametrize("name", DESIGNS)
def test_rows_from_the_sheet_laid_first_keep_every_bit(name):
    """Status of every node of them, past the mould's border too; place of those on the mould; shear of their cells."""
    of = design(spacing=0.15, **DESIGNS[name])
    found = []
    for degrees in (0.0, -9.6291, 4.0, 15.0):
        drape = draped(of, float(np.radians(degrees)))
        rows = int(np.argmax(drape.on_spar[0]))  # the first that starts on the left-most ribbon
        j = drape.net.seed_index[1]
        status = drape.net.node_status[:, j : j + rows]
        placed = status == NodeStatus.PLACED
        whole = drape.within & (drape.region == 2)
        node = np.where(placed[..., None], drape.node[: len(status), :rows], 0.0)
        shear = np.where(whole, drape.shear, 0.0)[:, : rows - 1]
        found.append((status, node, shear, whole[:, : rows - 1], drape.largest.wing_fed))
    assert np.count_nonzero(found[0][0] == NodeStatus.PLACED) > 90
    for other in found[1:]:
        for mine, theirs in zip(found[0], other, strict=True):
            assert np.array_equal(mine, theirs)


def test_gamma_turns_the_others():
    """The test above is no tautology: rows of the left-most ribbon do move."""
    of = design(spacing=0.15)
    one, other = (draped(of, float(np.radians(degrees))) for degrees in (0.0, -4.0))
    ribbon_fed = (one.region == 1) & (other.region[: len(one.region), : one.region.shape[1]] == 1)
    turned = np.abs(one.shear - other.shear[:, : one.shear.shape[1]])[ribbon_fed]
    assert np.degrees(np.nanmedian(turned)) == pytest.approx(4.0, abs=0.1)


def test_all_lengths_doubled_shear_alike():
    of = {"unit": "m", "span": 7.0, "chord": 1.5, "spar_height": 0.5, "spacing": 0.075}
    shape = {"wing": {"profile": "quadratic", "a": 0.02}, "spar": {"deviation": "bump", "c": 0.1, "length": 3.5}}
    twice = {"unit": "m", "span": 14.0, "chord": 3.0, "spar_height": 1.0, "spacing": 0.15}
    doubled = {"wing": {"profile": "quadratic", "a": 0.01}, "spar": {"deviation": "bump", "c": 0.2, "length": 7.0}}
    one, other = draped(design(**of, **shape)), draped(design(**twice, **doubled))
    assert np.array_equal(one.region, other.region)
    assert np.array_equal(one.within, other.within)
    shear, larger = (np.degrees(drape.shear[drape.within]) for drape in (one, other))
    assert larger == pytest.approx(shear, abs=1e-6)
    assert one.largest.ribbon_fed > 0
