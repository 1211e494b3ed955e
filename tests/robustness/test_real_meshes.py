"""Meshes of unknown make: those that come with pymeshlab, from scanners and from modellers, none made to be draped."""

from pathlib import Path

import numpy as np
import pymeshlab
import pytest

import meshdrape
from meshdrape import NodeStatus

MESHES = Path(pymeshlab.__file__).parent / "tests" / "sample_meshes"
# whether faults keep it from being draped unhealed
NAMES = {
    "bone.ply": False,
    "bunny.obj": False,
    "bunny10k_textured.obj": False,
    "colored_airplane.ply": False,
    "cow.obj": True,
    "rangemaps/face000.ply": True,
}


@pytest.mark.parametrize("name", NAMES)
def test_any_mesh_is_draped_to_round_off(name):
    """From two seeds at random, cells from many triangles wide to a few: edges as libigl has them, every loss told.

    Faceted so coarsely, most of them fold the cloth somewhere: what counts is that it ends there and not before.
    """
    if NAMES[name]:
        with pytest.raises(meshdrape.MeshdrapeError, match="--heal"):
            meshdrape.read_mould(MESHES / name)
    mould = meshdrape.read_mould(MESHES / name, heal=NAMES[name])
    surface = mould.surface
    rng = np.random.default_rng(len(name))
    for parts in (40, 150):
        fabric = meshdrape.Fabric(surface.diagonal / parts)
        face = surface.faces[rng.integers(len(surface.faces))]
        seed, direction = surface.vertices[face].mean(axis=0), rng.normal(size=3)
        net = meshdrape.drape(mould, fabric, seed=seed, direction=direction, threads=2)
        alone = meshdrape.drape(mould, fabric, seed=seed, direction=direction, threads=1)
        np.testing.assert_array_equal(net.node_position, alone.node_position)

        placed = net.node_status <= NodeStatus.OFF_MOULD
        np.testing.assert_array_equal(np.isfinite(net.node_position).all(axis=-1), placed)
        assert net.node_status[net.seed_index] == NodeStatus.PLACED
        assert net.count(NodeStatus.NOT_CONVERGED) == 0
        assert meshdrape.audit(net, edges=150).max_relative_error < 1e-11
        shear = meshdrape.measure(net).cell_shear
        assert np.nanmax(np.abs(shear)) < np.pi / 2
