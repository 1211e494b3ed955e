"""Thousands of drapes in one process take no more memory than the first hundred did."""

import gc
from pathlib import Path

import numpy as np
import pytest
from moulds import bumpy, cap, cube_corner

import meshdrape

N_DRAPES = 800
GROWTH = 6.0  # MiB; one net kept from each drape would be 30


def resident() -> float:
    """Memory of this process now, MiB."""
    gc.collect()
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return float("nan")


@pytest.mark.parametrize("moulds", ["one mould", "another mould each time"])
def test_memory_does_not_grow(moulds):
    fabric = meshdrape.Fabric(14.0)
    meshes = [bumpy(1, n=5), cap(1, 100.0), cube_corner(100, 1)]
    mould = meshes[0].mould()

    def drape(number: int) -> None:
        here = mould if moulds == "one mould" else meshes[number % 3].mould()
        net = meshdrape.drape(here, fabric, direction=(np.cos(number), np.sin(number), 0.2), threads=2)
        measures = meshdrape.measure(net)
        assert net.node_position.shape == (*net.shape, 3)
        assert measures.n_cells > 3
        if number % 50 == 0:
            meshdrape.audit(net, 3)

    for number in range(100):
        drape(number)
    before = resident()
    for number in range(N_DRAPES // 2):
        drape(number)
    assert resident() < before + GROWTH
