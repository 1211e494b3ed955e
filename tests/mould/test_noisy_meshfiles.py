"""Mesh files of noise, damaged or cut short at any byte: a valid mould or one line, nothing else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshfiles import OBJ_SQUARE, SQUARE, binary_ply, binary_stl, off, ply_header, polygons_ply, stored, text_stl

from meshdrape.errors import FileError, MeshdrapeError, MouldError
from meshdrape.mould.formats.reader import MESH_SUFFIXES, read_mesh_mould

SEED = {
    ".stl": [binary_stl(SQUARE), text_stl(SQUARE)],
    ".obj": [OBJ_SQUARE + b"f 1 2 3\n"],
    ".ply": [binary_ply(SQUARE), polygons_ply("<")[2], polygons_ply("")[2]],
    ".off": [off(SQUARE)],
}
HEADS = {
    ".stl": [b"", b"solid x\nfacet\n", bytes(80)],
    ".obj": [b"", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf "],
    ".ply": [
        b"",
        b"ply\n",
        ply_header("ascii", 3, 1),
        ply_header("binary_big_endian", 3, 1),
        polygons_ply("<")[2][:300],
    ],
    ".off": [b"", b"OFF\n", b"OFF\n3 1 0\n"],
}


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
