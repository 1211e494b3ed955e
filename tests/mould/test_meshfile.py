"""Mesh files of every format: what is read, what is welded, and what is said of a bad file."""

import hashlib
import os
import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from moulds import Mesh, bumpy, holed_plate, plate, rotation

from meshdrape.errors import FileError, MeshdrapeError, MouldError
from meshdrape.mould.files import file_sha256
from meshdrape.mould.meshfile import MESH_SUFFIXES, read_mesh, read_mesh_mould

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TWO = np.array([[0, 1, 2], [0, 2, 3]])
# neither a double of few digits nor a float32
ODD = np.array([[0.1, 1 / 3, -2e-7], [1e5 / 7, 0.3, np.pi], [1.1, 2.0**-40, 5]])


# --- writers, as plain as the formats ---------------------------------------------------------------------------------


def binary_stl(mesh, header=b"made by hand"):
    corner = mesh.vertices[mesh.triangles].astype("<f4")
    facets = b"".join(struct.pack("<3f", 0, 0, 0) + rows.tobytes() + b"\0\0" for rows in corner)
    return header.ljust(80, b" ") + struct.pack("<I", len(corner)) + facets


def text_stl(mesh, name="mould"):
    lines = [f"solid {name}"]
    for triangle in mesh.vertices[mesh.triangles].tolist():
        lines += ["  facet normal 0 0 0", "    outer loop"]
        lines += [f"      vertex {x!r} {y!r} {z!r}" for x, y, z in triangle]
        lines += ["    endloop", "  endfacet"]
    return "\n".join([*lines, f"endsolid {name}\n"]).encode()


def obj(mesh):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.triangles.tolist()]
    return "\n".join([*lines, ""]).encode()


def off(mesh):
    lines = ["OFF", f"{len(mesh.vertices)} {len(mesh.triangles)} 0"]
    lines += [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.triangles.tolist()]
    return "\n".join([*lines, ""]).encode()


def ply_header(form, n_vertices, n_faces, real="double", vertex_more="", face_before="", face_after=""):
    return (
        f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {n_vertices}\n"
        f"property {real} x\nproperty {real} y\nproperty {real} z\n{vertex_more}element face {n_faces}\n"
        f"{face_before}property list uchar int vertex_indices\n{face_after}end_header\n"
    ).encode()


def text_ply(mesh):
    lines = [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.triangles.tolist()]
    return ply_header("ascii", len(mesh.vertices), len(mesh.triangles)) + "\n".join([*lines, ""]).encode()


def binary_ply(mesh, order="<"):
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    faces = b"".join(struct.pack(f"{order}B3i", 3, *triangle) for triangle in mesh.triangles.tolist())
    return (
        ply_header(form, len(mesh.vertices), len(mesh.triangles)) + mesh.vertices.astype(f"{order}f8").tobytes() + faces
    )


WRITERS = {
    "binary.stl": binary_stl,
    "text.stl": text_stl,
    "x.obj": obj,
    "x.off": off,
    "text.ply": text_ply,
    "little.ply": binary_ply,
    "big.ply": lambda mesh: binary_ply(mesh, ">"),
}
DOUBLE = [name for name in WRITERS if name != "binary.stl"]


def stored(folder, name, content):
    path = folder / name
    path.write_bytes(content)
    return path


def same_triangles(mesh, vertices, triangles):
    """Whether both have the same corners, triangle by triangle, to the last bit."""
    return np.array_equal(vertices[triangles], mesh.vertices[mesh.triangles])


# --- what is read -----------------------------------------------------------------------------------------------------


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
    found = read_mesh(stored(tmp_path, "a.stl", binary_stl(Mesh(SQUARE, TWO), header)))
    assert same_triangles(Mesh(SQUARE, TWO), found.vertices, found.triangles)


def test_text_stl_of_several_solids_in_capitals(tmp_path):
    apart = Mesh(SQUARE + np.array([5, 0, 0]), TWO)
    content = text_stl(Mesh(SQUARE, TWO)) + text_stl(apart, "second part").replace(b"vertex", b"VERTEX")
    found = read_mesh(stored(tmp_path, "a.STL", b"\n " + content.replace(b"\n", b"\r\n") + b"\n\n"))
    assert same_triangles(Mesh(SQUARE, TWO).joined(apart), found.vertices, found.triangles)


OBJ_SQUARE = b"v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0\nvn 0 0 1\nvt 0 0\n"
PENTAGON = b"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\n"


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
    assert np.array_equal(found.vertices[:4], SQUARE)


OFF_SQUARE = b"0 0 0\n1 0 0\n1 1 0\n0 1 0\n"


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
    assert np.array_equal(found.vertices, SQUARE)
    assert found.triangles.tolist() == TWO.tolist()


def ply_rows(order):
    """Vertices with a colour, faces of 4, 3 and 5 corners with a colour before and texture coordinates behind."""
    vertices = [*SQUARE.tolist(), [2, 0, 0], [2, 1, 0], [1, 2, 0], [0, 2, 0]]
    faces = [[0, 1, 2, 3], [1, 4, 2], [4, 5, 6, 7, 2]]
    head = ply_header(
        {"<": "binary_little_endian", ">": "binary_big_endian", "": "ascii"}[order],
        len(vertices), len(faces), "float", "property uchar red\n",
        "property uchar red\n", "property list uchar float texcoord\nelement edge 1\nproperty int vertex1\n",
    )  # fmt: skip
    if not order:
        rows = [" ".join(map(repr, [*map(float, v), 7])) for v in vertices]
        rows += [" ".join(map(str, [9, len(f), *f, 2, 0.5, 0.25])) for f in faces]
        return vertices, faces, head + "\n".join([*rows, "3", ""]).encode()
    body = b"".join(struct.pack(f"{order}3fB", *v, 7) for v in vertices)
    body += b"".join(struct.pack(f"{order}BB{len(f)}iB2f", 9, len(f), *f, 2, 0.5, 0.25) for f in faces)
    return vertices, faces, head + body + struct.pack(f"{order}i", 3)


@pytest.mark.parametrize("order", ["", "<", ">"])
def test_ply_of_mixed_polygons_and_other_properties(tmp_path, order):
    vertices, faces, content = ply_rows(order)
    found = read_mesh(stored(tmp_path, "a.ply", content))
    assert found.vertices.tolist() == vertices
    assert found.triangles[:3].tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    assert sorted(set(found.triangles[3:].ravel().tolist())) == sorted(faces[2])
    assert found.notes == ("2 polygons cut into triangles",)


def test_ply_lists_counted_in_four_bytes(tmp_path):
    content = binary_ply(Mesh(SQUARE, TWO), ">").replace(b"list uchar", b"list uint")
    content = content.replace(b"\3\0\0", b"\0\0\0\3\0\0")
    found = read_mesh(stored(tmp_path, "a.ply", content))
    assert np.array_equal(found.vertices, SQUARE)
    assert found.triangles.tolist() == TWO.tolist()


def test_our_own_net_of_quads_can_be_read(tmp_path):
    """Cells as quads with properties of every kind around them, in the layout of NET.ply."""
    head = ply_header(
        "binary_little_endian", 4, 1, vertex_more="property int i\nproperty float quality\n",
        face_after="property float quality\nproperty uchar red\n",
    )  # fmt: skip
    body = b"".join(struct.pack("<3dif", *v, 1, 2.0) for v in SQUARE) + struct.pack("<B4ifB", 4, 0, 1, 2, 3, 1.0, 9)
    found = read_mesh(stored(tmp_path, "a.ply", head + body))
    assert np.array_equal(found.vertices, SQUARE)
    assert found.triangles.tolist() == TWO.tolist()


# --- polygons ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("shift", range(5))
@pytest.mark.parametrize(
    ("outline", "area"),
    [
        ([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)], 10.0),
        ([(0, 0), (4, 0), (1, 1), (0, 4)], 4.0),
        ([(0, -1), (10, 0), (0, 1), (1, 0)], 9.0),
        ([(0, 0), (3, 0), (4, 2), (0, 4)], 11.0),
        ([(0, 0), (5, 0), (5, 5), (4, 5), (4, 1), (1, 1), (1, 5), (0, 5)], 13.0),
    ],
    ids=["M", "arrow", "long arrow", "convex quad", "U"],
)
def test_polygons_are_cut_without_overlap_or_turning_over(tmp_path, outline, area, shift):
    points = np.roll(np.array([[*p, 0.0] for p in outline]), shift, axis=0)
    turn = rotation([1, 2, 3], 0.8)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (points @ turn.T).tolist()]
    lines.append("f " + " ".join(str(i + 1) for i in range(len(outline))))
    found = read_mesh(stored(tmp_path, "a.obj", "\n".join(lines).encode()))
    a, b, c = (found.vertices[found.triangles[:, k]] @ turn for k in range(3))
    doubled = np.cross(b - a, c - a)[:, 2]
    assert len(doubled) == len(outline) - 2
    assert (doubled > 1e-9).all()
    assert doubled.sum() / 2 == pytest.approx(area, rel=1e-12)
    assert found.notes == ("1 polygon cut into triangles",)


def test_a_warped_quadrilateral_is_cut_along_its_shorter_diagonal(tmp_path):
    content = b"OFF\n4 1 0\n0 0 0\n3 0 0\n4 1 0\n1 1 0.1\n4 0 1 2 3\n"
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert found.triangles.tolist() == [[0, 1, 3], [1, 2, 3]]


def test_faces_of_two_corners_are_left_out_and_said(tmp_path):
    content = b"OFF\n4 3 0\n" + OFF_SQUARE + b"2 0 1\n3 0 1 2\n1 3\n"
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert found.triangles.tolist() == [[0, 1, 2]]
    assert found.notes == ("2 faces of fewer than three corners left out",)


# --- welding ----------------------------------------------------------------------------------------------------------


def test_stl_corners_are_welded_into_the_mesh_they_came_from(tmp_path):
    mesh = plate()
    found = read_mesh(stored(tmp_path, "a.stl", binary_stl(mesh)))
    mould = read_mesh_mould(tmp_path / "a.stl")
    assert len(found.vertices) == len(mesh.vertices)
    assert mould.notes == ()
    border = mesh.mould().surface.border_loops
    assert [len(loop) for loop in mould.surface.border_loops] == [len(loop) for loop in border]


def test_minus_zero_is_zero(tmp_path):
    content = b"OFF\n6 2 0\n0 0 0\n1 0 0\n1 1 0\n-0.0 0 0\n1 1 -0.0\n0 1 0\n3 0 1 2\n3 3 4 5\n"
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert found.vertices.tolist() == SQUARE.tolist()
    assert found.triangles.tolist() == TWO.tolist()
    assert found.notes == ("2 vertices with the coordinates of another welded to it",)


@pytest.mark.parametrize("places", [1, 2, 3])
def test_stl_corners_apart_by_single_precision_are_welded(tmp_path, places):
    """Each corner moved by up to some last places of single precision, as if worked out anew for each facet."""
    mesh = plate().moved(np.eye(3), (1000, 2000, 300))
    corner = mesh.vertices[mesh.triangles].astype(np.float32)
    steps = np.random.default_rng(places).integers(0, places + 1, corner.shape)
    moved = (corner + steps * np.spacing(np.float32(1000))).reshape(-1, 3).astype(float)
    soup = Mesh(moved, np.arange(len(moved)).reshape(-1, 3))
    mould = read_mesh_mould(stored(tmp_path, "a.stl", binary_stl(soup)))
    assert len(mould.vertices) == len(mesh.vertices)
    assert mould.surface.n_components == 1
    assert len(mould.surface.border_loops) == 1
    (note,) = mould.notes
    assert note.endswith("vertices apart by round-off of the file welded")


def test_what_is_farther_apart_stays_apart(tmp_path):
    gap = 100 * 1000 * np.finfo(np.float32).eps
    two = Mesh(1000 * SQUARE, TWO[:1]).joined(Mesh(1000 * SQUARE + (-gap, gap, 0), TWO[1:]))
    found = read_mesh(stored(tmp_path, "a.stl", text_stl(two)))
    assert len(found.vertices) == 6


def test_short_edges_are_not_welded_away(tmp_path):
    thin = 1000 * np.array([[0, 0, 0], [1, 0, 0], [1, 1e-7, 0]])
    found = read_mesh(stored(tmp_path, "a.stl", text_stl(Mesh(thin, np.array([[0, 1, 2]])))))
    assert found.triangles.tolist() == [[0, 1, 2]]
    assert np.array_equal(found.vertices, thin)


# --- the mould --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("unit", "factor"), [(None, 1.0), ("mm", 1.0), ("m", 1000.0), ("inch", 25.4)])
@pytest.mark.parametrize("heal", [False, True])
def test_mould_of_a_file(tmp_path, unit, factor, heal):
    content = off(holed_plate())
    path = stored(tmp_path, "a.off", content)
    mould = read_mesh_mould(os.fspath(path), unit=unit, heal=heal)
    assert np.allclose(mould.vertices, factor * holed_plate().vertices, rtol=1e-15, atol=0)
    assert np.array_equal(mould.triangles, holed_plate().triangles)
    assert mould.unit == (unit or "mm")
    assert mould.source == path
    assert mould.sha256 == file_sha256(path) == hashlib.sha256(content).hexdigest()
    assert [note.split(",")[0] for note in mould.notes] == ["1 hole"]
    assert (mould.healing is not None) == heal


def test_notes_of_reading_come_first(tmp_path):
    parts = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 9 9 9\nf 1 2 3 4\nf 5 6 7\n"
    mould = read_mesh_mould(stored(tmp_path, "a.obj", parts))
    assert mould.notes == (
        "1 polygon cut into triangles",
        "1 vertex of no triangle dropped",
        "2 components, of 2 and 1 triangles, the smallest about (5.33333, 0.333333, 0); the seed's is draped",
    )


def test_fault_of_a_file_names_the_file(tmp_path):
    path = stored(tmp_path, "a.off", b"OFF\n4 2 0\n" + OFF_SQUARE + b"3 0 1 2\n3 2 3 0\n".replace(b"2 3 0", b"0 3 2"))
    with pytest.raises(MouldError) as caught:
        read_mesh_mould(path)
    assert str(caught.value) == (
        f"{path}: the mesh cannot be draped: 1 reversed triangle, at (0.333333, 0.666667, 0); "
        "repair it with --heal, or in CAD"
    )
    assert read_mesh_mould(path, heal=True).healing.triangles_reversed == 1


# --- bad files --------------------------------------------------------------------------------------------------------

STL = binary_stl(Mesh(SQUARE, TWO))
TEXT = text_stl(Mesh(SQUARE, TWO))
PLY = binary_ply(Mesh(SQUARE, TWO))
MIXED = ply_rows("<")[2]
VERTICES = b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"

BAD = {
    "stl cut short": (
        "a.stl",
        STL[:-20],
        FileError,
        "is not a whole STL file (truncated: its header says 2 triangles, 184 bytes, but it has 164 bytes)",
    ),
    "stl cut short, header solid": (
        "a.stl",
        binary_stl(Mesh(SQUARE, TWO), b"solid")[:-20],
        FileError,
        "is not a whole STL file (truncated: its header says 2 triangles, 184 bytes, but it has 164 bytes)",
    ),
    "stl too long": (
        "a.stl",
        STL + b"more",
        FileError,
        "is not a whole STL file (damaged, or no STL file: its header says 2 triangles, 184 bytes, but it has 188",
    ),
    "stl of three bytes": ("a.stl", b"xyz", FileError, "is not a whole STL file (no STL file: 3 bytes, too few even"),
    "stl of no triangles": ("a.stl", bytes(84), MouldError, "has no triangles; a mould needs at least one"),
    "text stl cut in a facet": (
        "a.stl",
        TEXT[:-80],
        FileError,
        "is not a whole STL file (truncated or damaged: whole facets 1, vertices 4)",
    ),
    "text stl cut after a facet": (
        "a.stl",
        TEXT[: TEXT.rindex(b"endsolid")],
        FileError,
        "is not a whole STL file (truncated or damaged: whole facets 2, vertices 6)",
    ),
    "text stl with a word for a number": (
        "a.stl",
        TEXT.replace(b"1.0 1.0", b"1.0 one", 1),
        FileError,
        "is not a whole STL file (could not convert",
    ),
    "text stl without one vertex": (
        "a.stl",
        TEXT.replace(b"vertex 1.0 1.0 0.0", b"", 1),
        FileError,
        "is not a whole STL file (truncated or damaged: whole facets 2, vertices 5)",
    ),
    "text stl of nothing": ("a.stl", b"solid x\nendsolid x\n", MouldError, "has no triangles; a mould needs at least"),
    "stl with nan": (
        "a.stl",
        binary_stl(Mesh(SQUARE * [1, np.nan, 1], TWO)),
        MouldError,
        "vertices[0] is (0, nan, 0): ",
    ),
    "obj face 0": (
        "a.obj",
        VERTICES + b"f 0 1 2\n",
        FileError,
        "is not a whole OBJ file (line 4 is not a face: 'f 0 1 2')",
    ),
    "obj index too large": (
        "a.obj",
        VERTICES + b"f 1 2 3\nf 1 2 9\n",
        MouldError,
        "face 2 uses vertex 9 but there are 3 vertices; indices start at 1",
    ),
    "obj index too negative": (
        "a.obj",
        VERTICES + b"f -1 -2 -4\n",
        FileError,
        "is not a whole OBJ file (line 4 is not a face: 'f -1 -2 -4')",
    ),
    "obj vertex of two numbers": (
        "a.obj",
        b"v 0 0\n",
        FileError,
        "is not a whole OBJ file (line 1 is not a vertex: 'v 0 0')",
    ),
    "obj vertex of words": (
        "a.obj",
        b"# x\nv a b c\n",
        FileError,
        "is not a whole OBJ file (line 2 is not a vertex: 'v a b c')",
    ),
    "obj of points": ("a.obj", VERTICES, MouldError, "has no triangles; a mould needs at least one"),
    "obj of text": ("a.obj", b"hello\nworld\n", FileError, "is not a whole OBJ file (no OBJ file: it has neither"),
    "ply header cut": ("a.ply", PLY[:60], FileError, "is not a whole PLY file (no PLY file: it has no PLY header)"),
    "ply cut in its vertices": (
        "a.ply",
        PLY[:-60],
        FileError,
        "is not a whole PLY file (truncated: its header says 4 of element vertex, there are fewer)",
    ),
    "ply cut in its faces": (
        "a.ply",
        PLY[:-4],
        FileError,
        "is not a whole PLY file (truncated: its header says 2 of element face, there are fewer)",
    ),
    "ply of mixed polygons cut": (
        "a.ply",
        MIXED[:-30],
        FileError,
        "is not a whole PLY file (truncated: its header says 3",
    ),
    "ply in text cut": (
        "a.ply",
        text_ply(Mesh(SQUARE, TWO))[:-4],
        FileError,
        "is not a whole PLY file (truncated: its",
    ),
    "ply of unknown type": (
        "a.ply",
        PLY.replace(b"double x", b"quad x"),
        FileError,
        "is not a whole PLY file (its header has the line 'property quad x')",
    ),
    "ply of unknown format": (
        "a.ply",
        PLY.replace(b"binary_little", b"binary_mixed"),
        FileError,
        "is not a whole PLY file (its header has the line 'format binary_mixed_endian 1.0')",
    ),
    "ply without z": (
        "a.ply",
        PLY.replace(b"double z", b"double w"),
        FileError,
        "is not a whole PLY file (its vertices have no z)",
    ),
    "ply of points": (
        "a.ply",
        ply_header("ascii", 1, 0).replace(b"element face 0\nproperty list uchar int vertex_indices\n", b"")
        + b"0 0 0\n",
        FileError,
        "is not a whole PLY file (it has no faces: a point cloud is no mould)",
    ),
    "ply of no faces": ("a.ply", ply_header("ascii", 1, 0) + b"0 0 0\n", MouldError, "has no triangles; a mould needs"),
    "ply index out of range": (
        "a.ply",
        binary_ply(Mesh(SQUARE, np.array([[0, 1, 2], [0, 2, 940]]))),
        MouldError,
        "face 1 uses vertex 940 but there are 4 vertices; indices start at 0",
    ),
    "ply index not whole": (
        "a.ply",
        text_ply(Mesh(SQUARE, TWO)).replace(b"3 0 2 3", b"3 0 2 nan"),
        FileError,
        "is not a whole PLY file (a face uses a vertex whose number is not whole)",
    ),
    "ply with a huge count": (
        "a.ply",
        ply_header("binary_little_endian", 10**15, 1) + b"\0" * 100,
        FileError,
        "is not a whole PLY file (truncated: its header says 1,000,000,000,000,000 of element vertex, there are fewer)",
    ),
    "off of another program": (
        "a.off",
        b"offset 3\n",
        FileError,
        "is not a whole OFF file (no OFF file: it does not begin",
    ),
    "off in four dimensions": (
        "a.off",
        b"4OFF\n1 0 0\n",
        FileError,
        "is not a whole OFF file (no OFF file: it does not",
    ),
    "off in bytes": ("a.off", b"OFF BINARY\n\0\0\0\1", FileError, "is not a whole OFF file (binary or without counts"),
    "off cut short": (
        "a.off",
        off(Mesh(SQUARE, TWO))[:-8],
        FileError,
        "is not a whole OFF file (truncated: 4 vertices and 2 faces announced, 5 lines there)",
    ),
    "off face cut short": (
        "a.off",
        off(Mesh(SQUARE, TWO))[:-3],
        FileError,
        "is not a whole OFF file (face 1 announces 3 corners and has 2)",
    ),
    "off vertex of two numbers": (
        "a.off",
        b"OFF\n1 0 0\n0 0\n",
        FileError,
        "is not a whole OFF file (vertex 0 has 2 coordinates)",
    ),
    "off negative counts": (
        "a.off",
        b"OFF\n-1 1 0\n3 0 1 2\n",
        FileError,
        "is not a whole OFF file (truncated: -1 vert",
    ),
    "off index out of range": (
        "a.off",
        b"OFF\n4 1 0\n" + OFF_SQUARE + b"3 0 1 -1\n",
        MouldError,
        "face 0 uses vertex -1 but there are 4 vertices; indices start at 0",
    ),
    "off of no faces": (
        "a.off",
        b"OFF\n4 0 0\n" + OFF_SQUARE,
        MouldError,
        "has no triangles; a mould needs at least one",
    ),
    "empty": ("a.ply", b"", FileError, "is empty; export the mould anew"),
    "unknown suffix": ("a.3mf", b"PK", FileError, "is no mesh file; its suffix must be one of .stl .obj .ply .off"),
    "no suffix": ("mould", b"OFF\n", FileError, "is no mesh file; its suffix must be one of .stl .obj .ply .off"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_file_is_named_in_one_line(tmp_path, case):
    name, content, kind, line = BAD[case]
    path = stored(tmp_path, name, content)
    with pytest.raises(MeshdrapeError) as caught:
        read_mesh_mould(path)
    message = str(caught.value)
    assert type(caught.value) is kind
    assert message.startswith(f"{path}")
    assert message[len(str(path)) :].lstrip(": ").startswith(line)
    assert "\n" not in message
    if kind is FileError and "is not a whole" in message:
        assert message.endswith("; export it anew")


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_missing_file_directory_and_unreadable(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    with pytest.raises(FileError) as caught:
        read_mesh(path)
    assert str(caught.value) == f"{path} does not exist; check the path"
    path.mkdir()
    with pytest.raises(FileError) as caught:
        read_mesh(path)
    assert str(caught.value) == f"{path} is a directory; give the mould file in it"


def test_file_that_may_not_be_read(tmp_path, monkeypatch):
    path = stored(tmp_path, "a.off", b"OFF")
    monkeypatch.setattr(os, "access", lambda *_: False)  # root may read everything
    with pytest.raises(FileError) as caught:
        read_mesh(path)
    assert str(caught.value) == f"{path} may not be read; check its permissions"


# --- noise ------------------------------------------------------------------------------------------------------------


def reads_or_explains(path):
    """A valid mould, or an error of meshdrape of one line that names the file."""
    try:
        mould = read_mesh_mould(path)
    except MeshdrapeError as error:
        assert str(error).startswith(str(path))  # noqa: PT017
        assert "\n" not in str(error)  # noqa: PT017
        assert isinstance(error, FileError | MouldError)  # noqa: PT017
    else:
        assert np.isfinite(mould.vertices).all()
        assert 0 <= mould.triangles.min() <= mould.triangles.max() < len(mould.vertices)
        assert (mould.surface.face_area > 0).all()


SEED = {
    ".stl": [STL, TEXT],
    ".obj": [OBJ_SQUARE + b"f 1 2 3\n"],
    ".ply": [PLY, MIXED, ply_rows("")[2]],
    ".off": [off(Mesh(SQUARE, TWO))],
}
HEADS = {
    ".stl": [b"", b"solid x\nfacet\n", bytes(80)],
    ".obj": [b"", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf "],
    ".ply": [b"", b"ply\n", ply_header("ascii", 3, 1), ply_header("binary_big_endian", 3, 1), ply_rows("<")[2][:300]],
    ".off": [b"", b"OFF\n", b"OFF\n3 1 0\n"],
}


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
@settings(max_examples=150)
@given(data=st.data())
def test_noise(tmp_path, suffix, data):
    head = data.draw(st.sampled_from(HEADS[suffix]))
    words = st.sampled_from([b"0", b"1", b"2", b"3", b"-1", b"1e999", b"nan", b"\n", b" ", b"f", b"v", b"/", b"vertex"])
    tail = data.draw(st.one_of(st.binary(max_size=300), st.lists(words, max_size=60).map(b" ".join)))
    reads_or_explains(stored(tmp_path, f"a{suffix}", head + tail))


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
@settings(max_examples=150)
@given(data=st.data())
def test_damage(tmp_path, suffix, data):
    """A good file with some bytes put in place of others."""
    content = bytearray(data.draw(st.sampled_from(SEED[suffix])))
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.integers(0, 8))
        content[at : at + length] = data.draw(
            st.binary(max_size=8) | st.sampled_from([b"-", b"9999999999", b"\xff" * 4])
        )
        content = content or bytearray(b"x")
    reads_or_explains(stored(tmp_path, f"a{suffix}", bytes(content)))


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_every_truncation_of_a_good_file(tmp_path, suffix):
    for content in SEED[suffix]:
        for length in range(1, len(content)):
            reads_or_explains(stored(tmp_path, f"a{suffix}", content[:length]))
