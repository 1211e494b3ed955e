"""NET.mould.ply and NET.fibres.ply, read back by ourselves and by MeshLab's own reader."""

import numpy as np
import pytest

from meshdrape.output import write_fibres_ply, write_mould_ply
from meshdrape.output.colour import NO_CLOTH, WARP, WEFT, shear_colour
from meshdrape.output.fibres import round_step
from meshdrape.output.ply.reader import read_ply


def test_the_mould_carries_its_field(field, tmp_path, meshlab):
    lock = np.radians(7)
    write_mould_ply(field, tmp_path / "mould.ply", lock)
    faces = read_ply(tmp_path / "mould.ply").elements["face"]
    assert faces["vertex_indices"].tolist() == field.triangles.tolist()
    for name in ("warp_angle", "weft_angle", "shear"):
        np.testing.assert_array_equal(faces[f"{name}_deg"], np.degrees(getattr(field, name)))
    mesh = meshlab(tmp_path / "mould.ply")
    assert mesh.vertex_matrix().tobytes() == field.vertices.tobytes()
    np.testing.assert_allclose(mesh.face_scalar_array(), [5.0, 12.5, 0.0, 0.0], rtol=1e-6)
    colours = np.rint(255 * mesh.face_color_matrix())
    assert (colours == shear_colour(field.shear, lock)).all()
    assert tuple(colours[3]) == NO_CLOTH


def test_meshlab_sees_the_fibres_as_edges(flat, tmp_path, meshlab):
    net, _ = flat
    write_fibres_ply(net, tmp_path / "fibres.ply", every=4)
    mesh = meshlab(tmp_path / "fibres.ply")
    there = ~np.isnan(net.node_position[..., 0])
    i = np.arange(net.seed_index[0] % 4, there.shape[0], 4)
    j = np.arange(net.seed_index[1] % 4, there.shape[1], 4)
    assert mesh.vertex_number() == there[i].sum() + there[:, j].sum()
    n_warp = (there[:-1] & there[1:])[:, j].sum()
    n_weft = (there[:, :-1] & there[:, 1:])[i].sum()
    assert mesh.edge_number() == n_warp + n_weft
    ends = mesh.vertex_matrix()[mesh.edge_matrix()]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    np.testing.assert_allclose(length[:n_warp], net.fabric.warp_spacing)
    np.testing.assert_allclose(length[n_warp:], net.fabric.weft_spacing)
    colours = np.rint(255 * mesh.vertex_color_matrix())[mesh.edge_matrix()[:, 0]]
    assert (colours[:n_warp] == WARP).all()
    assert (colours[n_warp:] == WEFT).all()


def test_fibre_nodes_say_which_they_are(sphere, tmp_path):
    net, _ = sphere
    write_fibres_ply(net, tmp_path / "fibres.ply", every=7)
    nodes = read_ply(tmp_path / "fibres.ply").elements["vertex"]
    position = np.stack([nodes[axis] for axis in "xyz"], axis=1)
    assert position.tobytes() == net.node_position[nodes["i"], nodes["j"]].tobytes()
    assert set(net.seed_index) <= set(nodes["i"]) | set(nodes["j"])


def test_without_a_wish_there_are_at_most_fifty_fibres_a_family(wing, tmp_path):
    net, _ = wing
    write_fibres_ply(net, tmp_path / "fibres.ply")
    nodes = read_ply(tmp_path / "fibres.ply").elements["vertex"]
    is_warp = (nodes["red"] == WARP[0]) & (nodes["green"] == WARP[1])
    assert 20 <= len(np.unique(nodes["i"][~is_warp])) <= 50
    assert 1 <= len(np.unique(nodes["j"][is_warp])) <= 50


@pytest.mark.parametrize(("least", "step"), [(0.01, 1), (1, 1), (1.1, 2), (3, 5), (5.1, 10), (11, 20), (120, 200)])
def test_round_steps(least, step):
    assert round_step(least) == step
