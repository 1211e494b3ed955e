"""The mould as scripts make and see it."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from moulds import holed_plate, plate

import meshdrape
from meshdrape.errors import MeshdrapeError, MouldError
from meshdrape.mould import CadFace, Mould
from meshdrape.mould.units import MILLIMETRES, millimetres

SQUARE = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]]
TWO = [[0, 1, 2], [0, 2, 3]]


def test_holds_what_it_was_given_and_nothing_else():
    mould = Mould.from_arrays(SQUARE, TWO)
    assert mould.vertices.dtype == np.float64
    assert mould.triangles.dtype == mould.triangle_face.dtype == np.int64
    assert mould.vertices.tolist() == SQUARE
    assert mould.triangles.tolist() == TWO
    assert mould.triangle_face.tolist() == [0, 0]
    assert (mould.cad_faces, mould.source, mould.sha256, mould.unit, mould.notes, mould.healing) == (
        (), None, None, "mm", (), None,
    )  # fmt: skip
    assert mould.size.tolist() == [2, 3, 0]
    assert mould.bounds.tolist() == [[0, 0, 0], [2, 3, 0]]
    assert repr(mould) == "<Mould 2 triangles, 2 x 3 x 0 mm>"
    assert meshdrape.Mould is Mould


def test_arrays_are_copies_and_read_only():
    vertices, triangles = np.array(SQUARE, dtype=float), np.array(TWO)
    mould = Mould.from_arrays(vertices, triangles)
    vertices[0], triangles[0] = 99, 0
    assert mould.vertices.tolist() == SQUARE
    assert mould.triangles.tolist() == TWO
    for array in (mould.vertices, mould.triangles, mould.triangle_face, mould.surface.vertices):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_arrays_given_to_the_class_itself_are_copied_too():
    faces = np.array([7, 8])
    mould = replace(Mould.from_arrays(SQUARE, TWO), triangle_face=faces)
    faces[0] = 1
    assert mould.triangle_face.tolist() == [7, 8]
    assert not mould.triangle_face.flags.writeable


@pytest.mark.parametrize("kind", [np.float32, np.int16, np.uint8, list])
def test_takes_numbers_of_any_kind(kind):
    vertices = SQUARE if kind is list else np.array(SQUARE, dtype=kind)
    triangles = TWO if kind is list else np.array(TWO, dtype=np.uint64)
    mould = Mould.from_arrays(vertices, triangles)
    assert mould.vertices.tolist() == SQUARE
    assert mould.triangles.tolist() == TWO


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("um", 0.001), ("mm", 1), ("cm", 10), ("m", 1000), ("in", 25.4), ("inch", 25.4), ("ft", 304.8)],
)
def test_units(unit, factor):
    mould = Mould.from_arrays(SQUARE, TWO, unit=unit)
    assert mould.unit == unit
    assert mould.vertices.tolist() == (factor * np.array(SQUARE, dtype=float)).tolist()
    assert millimetres(unit) == factor


def test_unknown_unit_is_answered_with_the_known_ones():
    with pytest.raises(MouldError) as caught:
        Mould.from_arrays(SQUARE, TWO, unit="furlong")
    assert str(caught.value) == "unknown unit 'furlong'; the units are um, mm, cm, m, in, inch, ft"
    assert list(MILLIMETRES) == str(caught.value).partition("are ")[2].split(", ")


def test_unreferenced_vertices_are_dropped_and_said():
    vertices = [[9, 9, 9], *SQUARE[:2], [8, 8, 8], *SQUARE[2:], [7, 7, 7]]
    mould = Mould.from_arrays(vertices, [[1, 2, 4], [1, 4, 5]])
    assert mould.vertices.tolist() == SQUARE
    assert mould.triangles.tolist() == TWO
    assert mould.notes == ("3 vertices of no triangle dropped",)
    assert mould.size.tolist() == [2, 3, 0]


def test_other_side_of_the_tool():
    mould = replace(Mould.from_arrays(*holed_plate()), source=Path("plate.stl"), sha256="ab")
    other = mould.flipped()
    assert (other.surface.face_normal == -mould.surface.face_normal).all()
    assert (other.vertices == mould.vertices).all()
    assert np.sort(other.triangles).tolist() == np.sort(mould.triangles).tolist()
    assert (other.source, other.sha256, other.notes) == (mould.source, "ab", mould.notes)
    assert (other.flipped().triangles == mould.triangles).all()


def test_surface_is_made_once():
    mould = Mould.from_arrays(*plate())
    assert mould.surface is mould.surface
    assert (mould.surface.faces == mould.triangles).all()


def test_repr_names_file_and_cad_faces():
    face = CadFace(1, None, "PLANE", 6.0, np.array([0, 0, 1.0]), np.zeros(3), (), True)
    mould = replace(Mould.from_arrays(SQUARE, TWO), source=Path("/a/tool.step"), cad_faces=(face,))
    assert repr(mould) == "<Mould tool.step: 2 triangles on 1 CAD face, 2 x 3 x 0 mm>"


def test_moulds_are_equal_only_to_themselves():
    mould = Mould.from_arrays(SQUARE, TWO)
    assert mould == mould
    assert mould != Mould.from_arrays(SQUARE, TWO)
    assert len({mould, mould}) == 1


@pytest.mark.parametrize("name", ["vertices", "unit", "notes"])
def test_cannot_be_changed(name):
    with pytest.raises(AttributeError):
        setattr(Mould.from_arrays(SQUARE, TWO), name, None)


def test_errors_share_one_class():
    with pytest.raises(MeshdrapeError):
        Mould.from_arrays([], [])


def test_heavy_libraries_come_late():
    code = (
        "import sys, meshdrape.mould, meshdrape.mould.formats.reader, meshdrape.mould.mesh.heal\n"
        "print(*sorted({'cadquery', 'OCP', 'pymeshlab', 'trimesh', 'scipy', 'mapbox_earcut'} & set(sys.modules)))"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []
