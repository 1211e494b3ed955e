"""Vertices that a file repeats: welded where they differ by its round-off, kept apart where by more."""

import numpy as np
import pytest
from meshfiles import SQUARE, binary_stl, stored, text_stl
from moulds import Mesh, plate

from meshdrape.mould.formats.reader import read_mesh, read_mesh_mould


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
    assert found.vertices.tolist() == SQUARE.vertices.tolist()
    assert found.triangles.tolist() == SQUARE.triangles.tolist()
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
    two = Mesh(1000 * SQUARE.vertices, SQUARE.triangles[:1]).joined(
        Mesh(1000 * SQUARE.vertices + (-gap, gap, 0), SQUARE.triangles[1:])
    )
    found = read_mesh(stored(tmp_path, "a.stl", text_stl(two)))
    assert len(found.vertices) == 6


def test_short_edges_are_not_welded_away(tmp_path):
    thin = 1000 * np.array([[0, 0, 0], [1, 0, 0], [1, 1e-7, 0]])
    found = read_mesh(stored(tmp_path, "a.stl", text_stl(Mesh(thin, np.array([[0, 1, 2]])))))
    assert found.triangles.tolist() == [[0, 1, 2]]
    assert np.array_equal(found.vertices, thin)
