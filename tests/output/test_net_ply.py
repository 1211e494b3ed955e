"""NET.ply, read back by ourselves and by MeshLab's own reader."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from meshdrape.errors import FileError, MeshdrapeError, NetError
from meshdrape.output import read_net, write_ply
from meshdrape.output.colour import shear_colour
from meshdrape.output.ply import net_elements
from meshdrape.output.ply.reader import read_ply
from meshdrape.weave.status import NodeStatus


def foretold(measures):
    """A balance that is off by a little more from row to row, and known nowhere in the first."""
    predicted = measures.cell_shear - 1e-3 * np.arange(len(measures.cell_shear))[:, None]
    predicted[0] = np.nan
    return SimpleNamespace(
        predicted=predicted, residual=measures.cell_shear - predicted, cell_defect=0.1 * measures.cell_shear
    )


@pytest.fixture(params=["flat", "sphere", "wing"])
def written(request, tmp_path):
    net, measures = request.getfixturevalue(request.param)
    path = tmp_path / "net.ply"
    write_ply(net, path, measures, foretold(measures))
    return net, measures, path


def test_the_round_trip_is_exact(written):
    net, measures, path = written
    stored = read_net(path)
    for name in ("node_position", "warp_direction", "weft_direction"):
        there = ~np.isnan(net.node_position[..., 0])
        assert getattr(stored, name)[there].tobytes() == getattr(net, name)[there].tobytes()
        assert np.isnan(getattr(stored, name)[~there]).all()
    assert (stored.node_status == net.node_status).all()
    assert stored.node_status.dtype == np.uint8
    np.testing.assert_allclose(stored.cell_shear, measures.cell_shear, rtol=1e-15, atol=0)
    assert stored.fabric == net.fabric
    assert stored.seed.tobytes() == net.seed.tobytes()
    assert stored.direction.tobytes() == net.direction.tobytes()
    assert stored.seed_index == net.seed_index
    assert stored.generator_nodes == net.generator_nodes
    assert stored.collar_depth == net.collar_depth
    assert stored.start_fibres.turns == net.start_fibres.turns
    assert stored.start_fibres.warp_path is None
    assert np.array_equal(stored.start_fibres.weft_path, net.start_fibres.weft_path)
    balance = foretold(measures)
    for name, wanted in (
        ("predicted_shear", balance.predicted),
        ("balance_residual", balance.residual),
        ("cell_defect", balance.cell_defect),
    ):
        np.testing.assert_allclose(getattr(stored, name), wanted, rtol=1e-15, atol=0)


def test_any_byte_changed_breaks_the_seal(flat, tmp_path):
    net, measures = flat
    path = tmp_path / "net.ply"
    write_ply(net, path, measures, foretold(measures))
    assert read_net(path).sealed
    whole = path.read_bytes()
    for at in (whole.index(b"comment spacing [") + 17, len(whole) // 2, len(whole) - 1):
        changed = bytearray(whole)
        changed[at] ^= 1
        path.write_bytes(changed)
        assert not read_net(path).sealed


def test_meshlab_sees_nodes_cells_shear_colours_and_the_flat_sheet(written, meshlab):
    net, measures, path = written
    mesh = meshlab(path)
    there = net.node_status <= NodeStatus.OFF_MOULD
    assert mesh.vertex_matrix().tobytes() == net.node_position[there].tobytes()
    shear = measures.node_shear(0, len(there))[there]
    np.testing.assert_allclose(mesh.vertex_scalar_array(), np.abs(np.degrees(np.nan_to_num(shear))), rtol=1e-6)
    colours = np.rint(255 * mesh.vertex_color_matrix())
    assert (colours == shear_colour(shear, net.fabric.locking_angle)).all()
    i, j = np.nonzero(there)
    spacing = [net.fabric.warp_spacing, net.fabric.weft_spacing]
    flat = (np.stack([i, j], axis=1) - net.seed_index) * spacing
    np.testing.assert_allclose(mesh.vertex_tex_coord_matrix(), flat, rtol=1e-6)

    whole = ~np.isnan(measures.cell_shear)
    assert mesh.face_number() == 2 * whole.sum()  # MeshLab cuts each quad in two
    cell_shear = measures.cell_shear[whole].repeat(2)
    order = np.lexsort((np.arange(2 * whole.sum()) % whole.sum(), mesh.face_matrix().min(axis=1)))
    np.testing.assert_allclose(mesh.face_scalar_array()[order], np.abs(np.degrees(cell_shear)), rtol=1e-6)
    colours = np.rint(255 * mesh.face_color_matrix()[order])
    assert (colours == shear_colour(cell_shear, net.fabric.locking_angle)).all()


def test_cells_run_about_the_normal(written):
    net, _, path = written
    elements = read_ply(path).elements
    points = np.stack([elements["vertex"][axis] for axis in "xyz"], axis=1)[elements["face"]["vertex_indices"]]
    normal = np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1])
    first = elements["face"]["vertex_indices"][:, 0]
    i, j = elements["vertex"]["i"][first], elements["vertex"]["j"][first]
    expected = np.cross(net.warp_direction[i, j], net.weft_direction[i, j])
    known = ~np.isnan(expected[:, 0])
    assert (np.einsum("ij,ij->i", normal, expected)[known] > 0).all()


def test_columns_are_those_of_the_design(flat, tmp_path):
    net, measures = flat
    write_ply(net, tmp_path / "net.ply", measures, foretold(measures))
    node, cell = (read_ply(tmp_path / "net.ply").elements[name] for name in ("vertex", "face"))
    directions = "warp_x warp_y warp_z weft_x weft_y weft_z"
    names = f"x y z i j red green blue alpha quality s t shear_deg {directions} status"
    assert " ".join(node.dtype.names) == names
    assert (node.dtype["x"], node.dtype["warp_x"], node.dtype["i"]) == (np.float64, np.float64, np.int32)
    names = "red green blue alpha quality shear_deg predicted_shear_deg balance_residual_deg defect_deg"
    assert " ".join(cell.dtype.names[1:]) == f"vertex_indices {names}"
    np.testing.assert_allclose(cell["shear_deg"], 5.0, rtol=1e-12)
    np.testing.assert_allclose(cell["quality"], 5.0, rtol=1e-6)
    assert np.isfinite(node["quality"]).all()


def test_a_node_without_a_whole_cell_is_grey_and_its_quality_is_a_number(flat, tmp_path, meshlab):
    net, measures = flat
    lonely = replace(measures, shear_of_nodes=np.where(np.indices(net.node_status.shape)[0] == 3, np.nan, 0.1))
    write_ply(net, tmp_path / "net.ply", lonely, foretold(measures))
    node = read_ply(tmp_path / "net.ply").elements["vertex"]
    there = node["i"] == 3
    assert np.isnan(node["shear_deg"][there]).all()
    assert (node["quality"][there] == 0).all()
    assert len({tuple(colour) for colour in node[["red", "green", "blue"]][there].tolist()}) == 1
    assert np.isfinite(meshlab(tmp_path / "net.ply").vertex_scalar_array()).all()


def test_the_mould_is_found_from_where_the_file_lies(flat, tmp_path):
    net, measures = flat
    folder = tmp_path / "moulds and tools"
    (tmp_path / "out").mkdir()
    mould = replace(net.mould, source=folder / "Flügel.step", sha256="ab" * 32, chord_tolerance=0.1, unit="inch")
    mould = replace(mould, parameters=(("span", "14000"),), turned=True)
    write_ply(replace_mould(net, mould), tmp_path / "out" / "net.ply", measures, foretold(measures))
    (tmp_path / "out").rename(tmp_path / "results")
    stored = read_net(tmp_path / "results" / "net.ply")
    assert stored.mould_file.resolve() == (folder / "Flügel.step").resolve()
    assert stored.mould_sha256 == "ab" * 32
    assert (stored.mould_unit, stored.mould_faces, stored.chord_tolerance) == ("inch", (), 0.1)
    assert stored.angle_tolerance is None
    assert (stored.mould_parameters, stored.mould_healed, stored.mould_turned) == ((("span", "14000"),), False, True)
    assert stored.version


def test_a_mould_of_thousands_of_faces_still_opens_in_meshlab(flat, tmp_path, meshlab):
    net, measures = flat
    faces = tuple(SimpleNamespace(id=number) for number in range(1, 3000))
    path = tmp_path / "net.ply"
    write_ply(replace_mould(net, replace(net.mould, cad_faces=faces)), path, measures, foretold(measures))
    assert meshlab(path).vertex_number() == (net.node_status <= NodeStatus.OFF_MOULD).sum()
    assert read_net(path).mould_faces == tuple(range(1, 3000))


def test_a_net_that_does_not_fill_its_array_is_refused(flat, tmp_path):
    net, measures = flat
    path = tmp_path / "net.ply"
    write_ply(net, path, measures, foretold(measures))
    whole = path.read_bytes()
    for nodes in (b"[31, 20]", b"[20, 30]", b"[99999999, 99999999]"):
        path.write_bytes(whole.replace(b"comment nodes [30, 20]", b"comment nodes " + nodes))
        with pytest.raises(NetError, match="is not a net that meshdrape wrote"):
            read_net(path)


def replace_mould(net, mould):
    return type(net)(mould, net.fabric, net.seed, net.direction, net.seed_index, net.node_position, net.node_status)


def test_blocks_make_no_difference(flat, tmp_path, monkeypatch):
    net, measures = flat
    write_ply(net, tmp_path / "one.ply", measures, foretold(measures))
    monkeypatch.setattr(net_elements, "NODES_PER_BLOCK", 64)
    write_ply(net, tmp_path / "many.ply", measures, foretold(measures))
    assert (tmp_path / "one.ply").read_bytes() == (tmp_path / "many.ply").read_bytes()
    assert (read_net(tmp_path / "many.ply").node_status == net.node_status).all()


def test_truncated_and_foreign_files_are_refused(flat, tmp_path, field):
    net, measures = flat
    path = tmp_path / "net.ply"
    write_ply(net, path, measures, foretold(measures))
    whole = path.read_bytes()
    for length in range(0, len(whole), len(whole) // 37):
        path.write_bytes(whole[:length])
        with pytest.raises(FileError):
            read_net(path)
    net_ply_like = tmp_path / "mould.ply"
    from meshdrape.output import write_mould_ply

    write_mould_ply(field, net_ply_like, 0.1)
    with pytest.raises(NetError, match=r"is not a net that meshdrape wrote \(it has no nodes\)"):
        read_net(net_ply_like)


def test_noise_in_the_file_is_refused_or_changes_values_only(flat, tmp_path):
    net, measures = flat
    path = tmp_path / "net.ply"
    write_ply(net, path, measures, foretold(measures))
    whole = path.read_bytes()
    random = np.random.default_rng(11)
    messages = set()
    for _ in range(300):
        noisy = bytearray(whole)
        for at in random.integers(0, len(whole), 40):
            noisy[at] = random.integers(256)
        path.write_bytes(noisy)
        try:
            assert read_net(path).node_status.ndim == 2
        except MeshdrapeError as error:
            messages.add(str(error))
    assert len(messages) > 30
    assert not any("\n" in message for message in messages)


def test_an_interrupted_write_leaves_no_file(flat, tmp_path):
    net, measures = flat

    class Interrupted(type(measures)):
        def node_shear(self, first, last):
            raise KeyboardInterrupt

    stopped = Interrupted(**vars(measures))
    with pytest.raises(KeyboardInterrupt):
        write_ply(net, tmp_path / "net.ply", stopped, foretold(measures))
    assert not list(tmp_path.iterdir())
