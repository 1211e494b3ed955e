"""Triangles against the CAD faces they stand for: where they lie, how they face, how they join."""

from __future__ import annotations

import math

import cadquery as cq
import numpy as np
import pytest
from brep_shapes import SAMPLES, SOLIDS, VOLUME, all_faces, distance_to, normals_at, signed_volume, solid

import meshdrape
from meshdrape.mould.cad.brep import ANGLE_TOLERANCE, CHORD_TOLERANCE
from meshdrape.mould.cad.shape import read_step
from meshdrape.weave.measures.noise import mesh_noise

OPEN = ("cone", "cube_corner", "cylinder", "hemisphere", "hypar", "krogh_double_curved", "wing_spar")
COARSE = {"chord_tolerance": 1.0, "angle_tolerance": math.radians(2)}


@pytest.fixture(scope="module", params=OPEN)
def sample(request):
    """The mould of a sample at the default tolerances, and its CAD faces."""
    path = SAMPLES / f"{request.param}.step"
    return meshdrape.read_mould(path), read_step(path).faces


@pytest.fixture(scope="module", params=SOLIDS)
def closed(request):
    """All faces of a solid."""
    return request.param, all_faces(solid(request.param), **COARSE), solid(request.param)


def some(items, count=40):
    return items[:: max(1, len(items) // count)]


def gaps_and_turns(mould, faces):
    """Of some triangles: distance of corners and centre from the face, mm; angle of the normal from the face's."""
    corner, centre, turn = [], [], []
    for number in np.unique(mould.triangle_face):
        face = faces[number - 1]
        mine = some(np.flatnonzero(mould.triangle_face == number))
        places = mould.vertices[mould.triangles[mine]]
        corner.append(distance_to(face, places.reshape(-1, 3)))
        centre.append(distance_to(face, places.mean(axis=1)))
        cosine = np.einsum("ij,ij->i", mould.surface.face_normal[mine], normals_at(face, places.mean(axis=1)))
        turn.append(np.arccos(np.clip(cosine, -1, 1)))
    return map(np.concatenate, (corner, centre, turn))


def test_samples_lie_on_their_faces(sample):
    mould, faces = sample
    corner, centre, turn = gaps_and_turns(mould, faces)
    assert corner.max() < 1e-5  # mm: nodes of common edges lie within the precision of those
    assert centre.max() <= CHORD_TOLERANCE
    # doubly curved faces get the angle that makes the same error of shear: Tolerances.gauss_angle
    curved = not all(face.developable for face in mould.cad_faces)
    assert np.nanmax(turn) <= (ANGLE_TOLERANCE ** (2 / 3) if curved else ANGLE_TOLERANCE)


def test_solids_lie_on_their_faces(closed):
    name, mould, shape = closed
    corner, centre, turn = gaps_and_turns(mould, shape.Faces())
    assert corner.max() < 1e-5
    assert centre.max() <= COARSE["chord_tolerance"]
    # on a torus, whose curvature changes sign, the mesh is held to the limit only on the whole
    limit = (2.0 if "torus" in name else 1.0) * COARSE["angle_tolerance"] ** (2 / 3)
    assert np.nanmax(turn) <= limit, name


def test_samples_are_whole(sample):
    """One disk each, without holes or tears between faces, of the area of its faces."""
    mould, faces = sample
    surface = mould.surface
    assert surface.n_components == 1
    assert len(surface.border_loops) == 1
    edges = (3 * len(mould.triangles) + np.count_nonzero(surface.face_neighbour < 0)) // 2
    assert len(mould.vertices) - edges + len(mould.triangles) == 1
    assert mould.notes == ()
    for face in faces:
        area = surface.face_area[mould.triangle_face == faces.index(face) + 1].sum()
        assert area == pytest.approx(face.Area(), rel=2e-4)


def test_border_of_a_sample_is_its_outline(sample):
    """Edges of one triangle lie on CAD edges of one face."""
    mould, faces = sample
    face, edge = np.nonzero(mould.surface.face_neighbour < 0)
    ends = mould.vertices[mould.triangles[face, edge]]
    rim = [
        e for f in faces for e in f.Edges() if sum(e.wrapped.IsSame(o.wrapped) for g in faces for o in g.Edges()) == 1
    ]
    outline = cq.Compound.makeCompound(rim)
    away = [outline.distance(cq.Vertex.makeVertex(*end)) for end in some(ends)]
    assert max(away) < 1e-5


def test_samples_are_tractable_and_quiet(sample):
    mould, _ = sample
    assert len(mould.triangles) <= 200_000
    assert math.degrees(mesh_noise(mould.surface)) < 0.35


def test_developable_faces_unroll_flat(sample):
    """Vertices on their outline alone, and no angle defect within."""
    mould, _ = sample
    surface = mould.surface
    for face in mould.cad_faces:
        if not face.developable:
            continue
        mine, others = (np.unique(mould.triangles[mould.triangle_face == k]) for k in (face.id, 0))
        elsewhere = np.unique(mould.triangles[mould.triangle_face != face.id])
        inside = np.setdiff1d(mine, elsewhere)
        inside = inside[~surface.border_vertex[inside]]
        assert len(inside) == 0 or np.abs(surface.vertex_defect[inside]).max() < 1e-9
        assert len(others) == 0


def test_solids_are_closed_and_face_outwards(closed):
    name, mould, shape = closed
    surface = mould.surface
    assert (surface.face_neighbour >= 0).all()
    assert surface.n_components == 1
    defect = float(surface.vertex_defect.sum())  # Gauss and Bonnet: 2 pi times the Euler characteristic
    holes = 1 if "torus" in name or "hole" in name else 0
    assert defect == pytest.approx(4 * math.pi * (1 - holes), abs=1e-6)
    assert signed_volume(mould) == pytest.approx(VOLUME.get(name, shape.Volume()), rel=0.01)
    assert mould.surface.area == pytest.approx(shape.Area(), rel=0.01)


@pytest.mark.parametrize("name", ["sphere", "torus", "cylinder", "cone", "fillet box"])
def test_finer_angles_converge(name):
    """The error of area falls with the square of the angle between nodes."""
    angles = np.radians([6.0, 3.0, 1.5])
    error, count = [], []
    for angle in angles:
        mould = all_faces(solid(name), chord_tolerance=50.0, angle_tolerance=angle)
        error.append(abs(mould.surface.area / solid(name).Area() - 1))
        count.append(len(mould.triangles))
    table = list(zip(np.degrees(angles), count, error, strict=True))
    assert count == sorted(count), table
    # nodes on doubly curved faces are angle^(2/3) apart: a rate of 4/3 there, 2 where the face unrolls
    rate = np.log(error[0] / error[2]) / np.log(angles[0] / angles[2])
    assert 1.0 < rate < 2.6, table
    assert error[2] < 2e-3, table


def test_finer_chords_converge():
    for chord in (2.0, 0.5, 0.1):
        mould = all_faces(solid("cylinder"), chord_tolerance=chord, angle_tolerance=math.radians(60))
        side = next(face for face in mould.cad_faces if face.kind == "CYLINDER")
        rims = mould.vertices[mould.triangles[mould.triangle_face == side.id]]
        sagitta = 30 - np.linalg.norm((rims + np.roll(rims, 1, axis=1))[..., :2] / 2, axis=-1)
        assert -1e-9 < sagitta.max() <= chord
    assert sagitta.max() > 0.02  # no finer than asked for


def test_tolerances_are_taken_as_given():
    mould = all_faces(solid("sphere"), **COARSE)
    assert (mould.chord_tolerance, mould.angle_tolerance) == (1.0, COARSE["angle_tolerance"])
    fine, coarse = (all_faces(solid("box"), chord_tolerance=chord) for chord in (1e-3, 10.0))
    assert len(fine.triangles) == len(coarse.triangles) < 40  # planes gain nothing from a tolerance


@pytest.mark.parametrize("name", ["sphere", "torus", "cylinder", "cone"])
def test_seams_and_poles_are_welded(name):
    """Each place once: no vertex of a seam is there twice, and no triangle shrank at a pole."""
    mould = all_faces(solid(name), **COARSE)
    apart = np.unique(np.round(mould.vertices / 1e-7).astype(np.int64), axis=0)
    assert len(apart) == len(mould.vertices)
    assert mould.surface.face_area.min() > 1e-4


def test_apex_of_a_cone_carries_its_defect():
    mould = all_faces(solid("cone"), chord_tolerance=0.1, angle_tolerance=math.radians(1))
    apex = int(np.argmax(mould.vertices[:, 2]))
    np.testing.assert_allclose(mould.vertices[apex], [0, 0, 90], atol=1e-7)
    exact = 2 * math.pi * (1 - 40 / math.hypot(40, 90))
    assert mould.surface.vertex_defect[apex] == pytest.approx(exact, abs=2e-3)


def test_tessellation_is_the_same_every_time():
    first, second = (all_faces(solid("fillet box"), **COARSE) for _ in range(2))
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.triangles, second.triangles)


def test_no_facet_of_a_fillet_lies_face_down():
    """Where it runs out in the rim its normal does not turn along it: chords there are long, and pass beyond nodes."""
    surface = meshdrape.read_mould(SAMPLES / "hat.step", faces="fillet").surface
    face, k = np.nonzero(surface.face_neighbour >= 0)
    other = surface.face_neighbour[face, k] // 3
    turn = np.linalg.norm(surface.face_normal[face] - surface.face_normal[other], axis=1)
    assert turn.max() < 4 * ANGLE_TOLERANCE ** (2 / 3)
