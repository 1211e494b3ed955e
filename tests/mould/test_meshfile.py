"""The mould of a mesh file: its unit, what is said of it, and what of a path that is none."""

import hashlib
import os

import numpy as np
import pytest
from meshfiles import OFF_SQUARE, off, stored
from moulds import holed_plate

from meshdrape.errors import FileError, MouldError
from meshdrape.mould.files import file_sha256
from meshdrape.mould.formats.reader import MESH_SUFFIXES, read_mesh, read_mesh_mould


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
