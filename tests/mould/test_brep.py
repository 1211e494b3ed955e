"""Faces of a B-rep: listed, chosen, sewn, and remembered by their triangles."""

from __future__ import annotations

import math
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from brep_shapes import SAMPLES, SOLIDS, distance_to, solid

from meshdrape import read_mould
from meshdrape.errors import MouldError, SelectionError
from meshdrape.mould.cad.brep import brep_mould, cad_faces
from meshdrape.mould.cad.shape import of_shape

COARSE = {"chord_tolerance": 2.0, "angle_tolerance": math.radians(4)}


def named(shape):
    return of_shape(shape, Path("part.step"))


def chosen(shape, faces=None):
    return brep_mould(named(shape), "part.step", faces, **COARSE)


@pytest.mark.parametrize("name", SOLIDS)
def test_list_of_faces(name):
    """Areas are those of the solid, normals point out of it, neighbours know each other."""
    shape = solid(name)
    listed = cad_faces(named(shape))
    assert [face.id for face in listed] == list(range(1, len(shape.Faces()) + 1))
    assert sum(face.area for face in listed) == pytest.approx(shape.Area(), rel=1e-9)
    beside = {face.id: set(face.neighbours) for face in listed}
    for face, cad in zip(listed, shape.Faces(), strict=True):
        assert face.kind == cad.geomType()
        assert distance_to(cad, face.centre)[0] < 1e-6
        assert np.linalg.norm(face.normal) == pytest.approx(1)
        reach = 1e-3
        outside, inside = (cq.Vector(*(face.centre + side * reach * face.normal)) for side in (1, -1))
        assert shape.isInside(inside, 1e-6)
        assert not shape.isInside(outside, 1e-6)
        assert face.id not in beside[face.id]
        assert all(face.id in beside[other] for other in beside[face.id])
        assert face.developable == (face.kind in ("PLANE", "CYLINDER", "CONE"))


def test_neighbours_of_a_box():
    listed = cad_faces(named(solid("box")))
    assert all(len(face.neighbours) == 4 for face in listed)
    for face in listed:
        (opposite,) = {1, 2, 3, 4, 5, 6} - {face.id, *face.neighbours}
        np.testing.assert_allclose(listed[opposite - 1].normal, -face.normal, atol=1e-12)


@pytest.mark.parametrize("name", ["wing_spar", "wing_spar_block", "hemisphere"])
def test_triangles_know_their_face(name):
    """The centre of each lies nearer to its own face than to any other."""
    path = SAMPLES / f"{name}.step"
    shape = cq.importers.importStep(str(path)).val()
    faces = shape.Faces()
    mould = brep_mould(named(shape), name, list(range(1, len(faces) + 1)), **COARSE)
    assert set(mould.triangle_face) == {face.id for face in mould.cad_faces}
    some = slice(None, None, max(1, len(mould.triangles) // 60))
    centre = mould.vertices[mould.triangles].mean(axis=1)[some]
    away = np.stack([distance_to(face, centre) for face in faces], axis=1)
    own = np.take_along_axis(away, mould.triangle_face[some, None] - 1, axis=1)[:, 0]
    assert (own <= away.min(axis=1) + 1e-6).all()
    assert own.max() <= COARSE["chord_tolerance"]


@pytest.mark.parametrize(
    ("faces", "count"),
    [(">Z", 1), ("<Z", 1), ("|Z", 2), ("#Z", 4), ("%CYLINDER", 4), ("%PLANE", 6), (">Z or <Z", 2), ("not %PLANE", 4)],
)
def test_selectors(faces, count):
    shape = cq.Workplane().box(100, 80, 40).edges("|Z").fillet(8)
    mould = chosen(shape.val(), faces)
    assert len(mould.cad_faces) == count
    wanted = {f.hashCode() for f in shape.faces(faces).vals()}
    listed = shape.val().Faces()
    assert {listed[face.id - 1].hashCode() for face in mould.cad_faces} == wanted


@pytest.mark.parametrize(
    ("faces", "ids"),
    [
        ("3", (3,)), ("1,3", (1, 3)), (" 3 , 1 ", (1, 3)), ("3,3,1", (1, 3)), ([3, 1], (1, 3)), ((2,), (2,)),
        (np.array([5, 4]), (4, 5)),
    ],
)  # fmt: skip
def test_ids(faces, ids):
    mould = chosen(solid("box"), faces)
    assert tuple(face.id for face in mould.cad_faces) == ids
    assert set(mould.triangle_face) == set(ids)
    assert mould.surface.area == pytest.approx(sum(face.area for face in mould.cad_faces))


@pytest.mark.parametrize("name", SOLIDS)
def test_a_closed_solid_needs_a_choice(name):
    with pytest.raises(SelectionError, match=r"part\.step is a closed solid of \d+ faces.*--faces") as caught:
        chosen(solid(name))
    assert [face.id for face in caught.value.faces] == list(range(1, len(solid(name).Faces()) + 1))


@pytest.mark.parametrize(
    ("faces", "words"),
    [
        ("7", "no face 7: its faces are 1 to 6"),
        ("0,2", "no face 0"),
        ([-1], "no face -1"),
        ([], "1 to 6"),
        ("", "part.step"),
        ("%SPHERE", "'%SPHERE' matches none of the 6 faces"),
        (">W", "'>W' is no CadQuery selector"),
        ("wing", "'wing' is no CadQuery selector"),
        ("1;3", "'1;3' is no CadQuery selector"),
    ],
)
def test_a_choice_that_is_not_there(faces, words):
    with pytest.raises(SelectionError) as caught:
        chosen(solid("box"), faces)
    assert words in str(caught.value)
    assert "meshdrape inspect part.step" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert len(caught.value.faces) == 6


def test_the_only_face_is_named_as_one():
    with pytest.raises(SelectionError, match=r"has no face 2: its only face is 1; meshdrape inspect part\.step"):
        chosen(solid("box").Faces()[0], "2")


@pytest.mark.parametrize(
    "tolerances",
    [
        {"chord_tolerance": 0.0}, {"chord_tolerance": -1.0}, {"chord_tolerance": math.nan},
        {"chord_tolerance": math.inf}, {"angle_tolerance": 0.0}, {"angle_tolerance": 2.0},
        {"angle_tolerance": math.nan},
    ],
)  # fmt: skip
def test_tolerances_out_of_range(tolerances):
    ((name, _),) = tolerances.items()
    with pytest.raises(MouldError, match=name.replace("_", " ")):
        brep_mould(named(solid("box")), "part.step", "1", **tolerances)


def test_names_of_a_step_file():
    mould = read_mould(SAMPLES / "wing_spar_block.step", "wing,spar", **COARSE)
    assert [(face.id, face.name) for face in mould.cad_faces] == [(1, "wing"), (2, "spar")]
    assert [face.neighbours for face in mould.cad_faces] == [(2, 5, 6, 7), (1, 3, 6, 7)]
    assert read_mould(SAMPLES / "hypar.step", **COARSE).cad_faces[0].name in (None, "")


def test_faces_of_a_shell_face_alike():
    """Wing and spar of the block, one of them stored the other way round, both have the outside in front."""
    mould = read_mould(SAMPLES / "wing_spar_block.step", [1, 2], **COARSE)
    normal = [mould.surface.face_normal[mould.triangle_face == face] for face in (1, 2)]
    assert (normal[0][:, 2] > 0.9).all()
    assert (normal[1][:, 0] < -0.9).all()
    alone = read_mould(SAMPLES / "wing_spar.step", **COARSE)
    np.testing.assert_allclose(np.sort(alone.surface.face_area), np.sort(mould.surface.face_area), rtol=1e-6)


def loose(*faces):
    """Copies of faces that share no edge."""
    return cq.Compound.makeCompound([face.copy() for face in faces])


def test_loose_faces_are_sewn_and_said():
    faces = solid("box").Faces()
    mould = chosen(loose(*(faces[number] for number in (0, 2, 4))))
    assert mould.surface.n_components == 1
    assert mould.notes == ("3 loose faces sewn along 3 edges",)
    assert set(mould.triangle_face) == {1, 2, 3}
    areas = [mould.surface.face_area[mould.triangle_face == number].sum() for number in (1, 2, 3)]
    assert areas == pytest.approx([face.area for face in mould.cad_faces])


def test_loose_faces_turned_each_way_are_made_to_face_alike():
    """Two halves of a strip, the second with its normal down."""
    first = cq.Face.makePlane(100, 50, (0, 0, 0), (0, 0, 1))
    second = cq.Face.makePlane(100, 50, (50, 0, 0), (0, 0, -1))
    mould = chosen(loose(first, second))
    assert mould.surface.n_components == 1
    assert len(np.unique(np.sign(mould.surface.face_normal[:, 2]))) == 1


def test_faces_apart_stay_apart():
    faces = solid("box").Faces()
    mould = chosen(loose(faces[0], faces[1]))
    assert mould.surface.n_components == 2
    assert any("2 components" in note for note in mould.notes)


def test_faces_of_a_solid_that_share_edges_are_not_sewn():
    mould = chosen(solid("fillet box"), "not <Z")
    assert mould.surface.n_components == 1
    assert len(mould.surface.border_loops) == 1
    assert not any("sewn" in note for note in mould.notes)


def test_a_hole_is_noted():
    mould = chosen(solid("plate with a hole"), ">Z")
    assert len(mould.surface.border_loops) == 2
    assert any("hole" in note for note in mould.notes)
    assert mould.surface.area == pytest.approx(100 * 80 - math.pi * 15**2, rel=0.01)


def test_open_shell_needs_no_choice():
    shell = cq.Shell.makeShell([solid("box").Faces()[number] for number in (0, 2, 4)])
    mould = chosen(shell)
    assert [face.id for face in mould.cad_faces] == [1, 2, 3]
    assert mould.surface.area == pytest.approx(shell.Area())
