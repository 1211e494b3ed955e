"""inspect_mould(): what there is in a file, drapable or not."""

from __future__ import annotations

import numpy as np
import pytest
from brep_shapes import SAMPLES
from meshfiles import off, stored
from moulds import Mesh, icosphere, plate

from meshdrape import MeshdrapeError, read_mould
from meshdrape.errors import MouldError
from meshdrape.mould.inspect import inspect_mould


def test_closed_solid():
    path = SAMPLES / "wing_spar_block.step"
    found = inspect_mould(path, chord_tolerance=5.0, angle_tolerance=0.05)
    assert found.closed
    assert [face.name for face in found.cad_faces] == ["wing", "spar", "skirt", "floor", "back", "root", "tip"]
    assert set(found.mould.triangle_face) == {1, 2, 3, 4, 5, 6, 7}
    assert (found.mould.surface.face_neighbour >= 0).all()
    assert (found.mould.chord_tolerance, found.mould.angle_tolerance) == (5.0, 0.05)
    assert found.faults == ()


def test_open_shell_is_the_mould_that_is_read():
    path = SAMPLES / "wing_spar.step"
    found, mould = inspect_mould(path), read_mould(path)
    assert not found.closed
    np.testing.assert_array_equal(found.mould.vertices, mould.vertices)
    assert [face.area for face in found.cad_faces] == [face.area for face in mould.cad_faces]


def test_script_with_parameters(tmp_path):
    path = tmp_path / "box.py"
    path.write_text("import cadquery as cq\nsize = 10.0\nshow_object(cq.Workplane().box(size, size, size))\n")
    found = inspect_mould(path, parameters={"size": "30"})
    assert found.closed
    assert found.mould.size == pytest.approx([30, 30, 30])
    assert len(found.cad_faces) == 6


@pytest.mark.parametrize("mesh", [plate(), icosphere(1)])
def test_sound_mesh(tmp_path, mesh):
    found = inspect_mould(stored(tmp_path, "a.off", off(mesh)), unit="cm")
    assert found.faults == ()
    assert found.cad_faces == ()
    assert not found.closed
    assert len(found.mould.triangles) == len(mesh.triangles)
    assert found.mould.size == pytest.approx(10 * np.ptp(mesh.vertices, axis=0))


def test_faults_of_a_mesh(tmp_path):
    mesh = plate()
    turned = Mesh(mesh.vertices, np.vstack([mesh.triangles[1:], mesh.triangles[:1, ::-1]]))
    found = inspect_mould(stored(tmp_path, "a.off", off(turned)))
    assert found.mould is None
    assert sum(fault.count for fault in found.faults) > 0
    with pytest.raises(MouldError):
        read_mould(tmp_path / "a.off")


@pytest.mark.parametrize("content", ["OFF\n1 0 0\n0 0 0\n", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", "OFF\n"])
def test_a_mesh_that_is_none_is_named(tmp_path, content):
    path = tmp_path / "a.off"
    path.write_text(content)
    with pytest.raises(MeshdrapeError) as caught:
        inspect_mould(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_unknown_unit(tmp_path):
    with pytest.raises(MouldError, match="unknown unit 'ell'; the units are"):
        inspect_mould(stored(tmp_path, "a.off", off(plate())), unit="ell")
