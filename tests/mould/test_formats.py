"""Mesh files of every format and dialect, read back to the last bit."""

import struct

import numpy as np
import pytest
from meshfiles import (
    OBJ_SQUARE,
    OFF_SQUARE,
    SQUARE,
    binary_ply,
    binary_stl,
    obj,
    off,
    ply_header,
    polygons_ply,
    same_triangles,
    stored,
    text_ply,
    text_stl,
)
from moulds import Mesh, bumpy, holed_plate, plate

from meshdrape.mould.formats.reader import MESH_SUFFIXES, read_mesh

# neither a double of few digits nor a float32
ODD = np.array([[0.1, 1 / 3, -2e-7], [1e5 / 7, 0.3, np.pi], [1.1, 2.0**-40, 5]])

WRITERS = {
    "binary.stl": binary_stl,
    "text.stl": text_stl,
    "x.obj": obj,
    "x.off": off,
    "text.ply": text_ply,
    "little.ply": binary_ply,
    "big.ply": lambda mesh: binary_ply(mesh, ">"),
}


@pytest.mark.parametrize("mesh", [plate(), holed_plate(), Mesh(ODD, np.array([[0, 1, 2]]))])
@pytest.mark.parametrize("name", WRITERS)
def test_reads_back_what_was_written(tmp_path, name, mesh):
    found = read_mesh(stored(tmp_path, name, WRITERS[name](mesh)))
    single = name == "binary.stl"
    meant = Mesh(mesh.vertices.astype(np.float32).astype(float), mesh.triangles) if single else mesh
    assert same_triangles(meant, found.vertices, found.triangles)
    assert len(found.vertices) == len(mesh.vertices)
    assert found.notes == ()
    if not name.endswith("stl"):
        assert np.array_equal(found.vertices, mesh.vertices)
        assert np.array_equal(found.triangles, mesh.triangles)


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_reads_what_other_programs_write(tmp_path, suffix):
    pymeshlab = pytest.importorskip("pymeshlab")
    mesh = bumpy(n=10)
    single = Mesh(mesh.vertices.astype(np.float32).astype(float), mesh.triangles)
    workshop = pymeshlab.MeshSet(verbose=False)
    workshop.add_mesh(pymeshlab.Mesh(vertex_matrix=single.vertices, face_matrix=single.triangles))
    path = tmp_path / f"mesh{suffix}"
    workshop.save_current_mesh(str(path))
    found = read_mesh(path)
    assert len(found.vertices) == len(mesh.vertices)
    assert np.allclose(found.vertices[found.triangles], single.vertices[single.triangles], rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("header", [b"solid", b"solid mould\nfacet normal 0 0 1\n", b"\xff" * 80, b""])
def test_a_binary_stl_is_known_by_its_length(tmp_path, header):
    found = read_mesh(stored(tmp_path, "a.stl", binary_stl(SQUARE, header)))
    assert same_triangles(SQUARE, found.vertices, found.triangles)


def test_text_stl_of_several_solids_in_capitals(tmp_path):
    apart = Mesh(SQUARE.vertices + np.array([5, 0, 0]), SQUARE.triangles)
    content = text_stl(SQUARE) + text_stl(apart, "second part").replace(b"vertex", b"VERTEX")
    found = read_mesh(stored(tmp_path, "a.STL", b"\n " + content.replace(b"\n", b"\r\n") + b"\n\n"))
    assert same_triangles(SQUARE.joined(apart), found.vertices, found.triangles)


@pytest.mark.parametrize(
    ("faces", "triangles"),
    [
        (b"f 1 2 3\nf 1 3 4\n", [[0, 1, 2], [0, 2, 3]]),
        (b"f 1/1 2/1 3/1\nf 1//1 3//1 4//1\n", [[0, 1, 2], [0, 2, 3]]),
        (b"f 1/1/1 2/1/1 3/1/1 4/1/1\n", [[0, 1, 2], [0, 2, 3]]),
        (b"f -4 -3 -2\nf -4//-1 -2//-1 -1//-1\n", [[0, 1, 2], [0, 2, 3]]),
        (b"f -1 -2 -3\nv 9 9 9\nf -2 -4 -5\n", [[3, 2, 1], [3, 1, 0]]),
        (b"o one\ng a\nusemtl red\nf 1 2 3\no two\ng b\nusemtl blue\ns off\nf 1 3 4 # last\n", [[0, 1, 2], [0, 2, 3]]),
        (b"f 1 2 \\\n 3\r\nf 1 3 \\\r\n4\n", [[0, 1, 2], [0, 2, 3]]),
        (b"l 1 2\np 3\nf 1 2 3\n", [[0, 1, 2]]),
        (b"f 5 6 7\nv 7 0 0\nv 8 0 0\nv 7 1 0\n", [[4, 5, 6]]),
    ],
)
def test_obj_faces(tmp_path, faces, triangles):
    found = read_mesh(stored(tmp_path, "a.obj", OBJ_SQUARE + faces))
    assert found.triangles.tolist() == triangles
    assert np.array_equal(found.vertices[:4], SQUARE.vertices)


@pytest.mark.parametrize(
    "content",
    [
        b"OFF\n4 2 0\n" + OFF_SQUARE + b"3 0 1 2\n3 0 2 3\n",
        b"# first\nOFF # this\n# counts\n4 2 0 # here\n\n"
        + OFF_SQUARE.replace(b"\n", b" # at\n\n")
        + b"3 0 1 2\n#\n3 0 2 3",
        b"OFF 4 2\n" + OFF_SQUARE + b"3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 0.5 1\n",
        b"COFF\r\n4 1 0\r\n" + OFF_SQUARE.replace(b"\n", b" 255 0 0 1\r\n") + b"4 0 1 2 3\r\n",
        b"STCNOFF\n4 1 5\n" + OFF_SQUARE.replace(b"\n", b" 0 0 1 1 0 0 1 0 0\n") + b"4 0 1 2 3\n",
    ],
)
def test_off_dialects(tmp_path, content):
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert np.array_equal(found.vertices, SQUARE.vertices)
    assert found.triangles.tolist() == SQUARE.triangles.tolist()


@pytest.mark.parametrize("order", ["", "<", ">"])
def test_ply_of_mixed_polygons_and_other_properties(tmp_path, order):
    vertices, faces, content = polygons_ply(order)
    found = read_mesh(stored(tmp_path, "a.ply", content))
    assert found.vertices.tolist() == vertices
    assert found.triangles[:3].tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    assert sorted(set(found.triangles[3:].ravel().tolist())) == sorted(faces[2])
    assert found.notes == ("2 polygons cut into triangles",)


def test_ply_lists_counted_in_four_bytes(tmp_path):
    content = binary_ply(SQUARE, ">").replace(b"list uchar", b"list uint")
    content = content.replace(b"\3\0\0", b"\0\0\0\3\0\0")
    found = read_mesh(stored(tmp_path, "a.ply", content))
    assert np.array_equal(found.vertices, SQUARE.vertices)
    assert found.triangles.tolist() == SQUARE.triangles.tolist()


def test_our_own_net_of_quads_can_be_read(tmp_path):
    """Cells as quads with properties of every kind around them, in the layout of NET.ply."""
    head = ply_header(
        "binary_little_endian", 4, 1, vertex_more="property int i\nproperty float quality\n",
        face_after="property float quality\nproperty uchar red\n",
    )  # fmt: skip
    body = b"".join(struct.pack("<3dif", *v, 1, 2.0) for v in SQUARE.vertices) + struct.pack(
        "<B4ifB", 4, 0, 1, 2, 3, 1.0, 9
    )
    found = read_mesh(stored(tmp_path, "a.ply", head + body))
    assert np.array_equal(found.vertices, SQUARE.vertices)
    assert found.triangles.tolist() == SQUARE.triangles.tolist()
