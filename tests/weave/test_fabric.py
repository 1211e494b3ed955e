"""The weave as the draping sees it: its two spacings."""

import pytest

from meshdrape import Fabric


@pytest.mark.parametrize(("spacing", "longest", "shortest"), [(5.0, 5, 5), ((4.0, 7.0), 7, 4), ((7.0, 4.0), 7, 4)])
def test_the_wider_and_the_narrower_spacing(spacing, longest, shortest):
    fabric = Fabric(spacing)
    assert (fabric.longest, fabric.shortest) == (longest, shortest)
    assert {fabric.longest, fabric.shortest} == {fabric.warp_spacing, fabric.weft_spacing}
