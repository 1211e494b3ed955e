"""Bad mesh files of every format: each refused in one line that names the file, the fault and the way out."""

import numpy as np
import pytest
from meshfiles import (
    OFF_SQUARE,
    SQUARE,
    binary_ply,
    binary_stl,
    off,
    ply_header,
    polygons_ply,
    stored,
    text_ply,
    text_stl,
)
from moulds import Mesh

from meshdrape.errors import FileError, MeshdrapeError, MouldError
from meshdrape.mould.formats.reader import read_mesh_mould

STL = binary_stl(SQUARE)
TEXT = text_stl(SQUARE)
PLY = binary_ply(SQUARE)
MIXED = polygons_ply("<")[2]
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
        binary_stl(SQUARE, b"solid")[:-20],
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
        binary_stl(Mesh(SQUARE.vertices * [1, np.nan, 1], SQUARE.triangles)),
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
        text_ply(SQUARE)[:-4],
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
        binary_ply(Mesh(SQUARE.vertices, np.array([[0, 1, 2], [0, 2, 940]]))),
        MouldError,
        "face 1 uses vertex 940 but there are 4 vertices; indices start at 0",
    ),
    "ply index not whole": (
        "a.ply",
        text_ply(SQUARE).replace(b"3 0 2 3", b"3 0 2 nan"),
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
        off(SQUARE)[:-8],
        FileError,
        "is not a whole OFF file (truncated: 4 vertices and 2 faces announced, 5 lines there)",
    ),
    "off face cut short": (
        "a.off",
        off(SQUARE)[:-3],
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
