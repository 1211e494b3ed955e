"""The picture: that it is there, shows what it must and is drawn from few quads."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.output import draw_net
from meshdrape.output.colour import shear_colour
from meshdrape.output.picture import draw as picture
from meshdrape.output.picture.camera import View, fitted, view_axes
from meshdrape.output.picture.scene import drawn_cells, drawn_fibres
from meshdrape.output.picture.stage import Stage
from meshdrape.weave.status import NodeStatus

HELPERS = [str(folder) for folder in Path(__file__).parents[:2]]  # where a process of its own finds the known nets


@pytest.fixture(scope="module")
def pixels(tmp_path_factory):
    """Draw a net and return the picture, (height, width, 3)."""

    def draw(net, measures):
        path = tmp_path_factory.mktemp("picture") / "net.png"
        draw_net(net, measures, path)
        assert [p.name for p in path.parent.iterdir()] == ["net.png"]
        return read_png(path)

    return draw


def read_png(path):
    """The picture in a file, (height, width, 3), from the top."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    values = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    return values.reshape(height, width, -1)[::-1, :, :3].astype(int)


def share_near(picture, colour, within):
    return (np.abs(picture - np.asarray(colour)[:3]).max(axis=2) < within).mean()


def test_a_dome_over_the_locking_angle_shows_both_sides_of_the_scale(sphere, pixels):
    picture = pixels(*sphere)
    assert picture.shape[1] == 2000
    assert 900 < picture.shape[0] <= 1500
    assert (picture[:5] == 255).all()
    drawing = picture[200:-220]
    assert 0.15 < (np.ptp(drawing, axis=2) > 12).mean() < 0.9  # coloured, not grey
    is_red = (drawing[..., 0] > 100) & (drawing[..., 1] < 80) & (drawing[..., 2] < 60)
    assert 0.005 < is_red.mean() < 0.2
    assert share_near(drawing, (190, 190, 190), 70) > 0.05  # the mould where no cloth is


def test_a_net_below_the_locking_angle_has_no_red_on_it(flat, pixels):
    drawing = pixels(*flat)[200:-220]
    assert not ((drawing[..., 0] > 150) & (drawing[..., 2] < 60)).any()
    assert share_near(drawing, shear_colour(np.radians(5.0), np.radians(7.0)), 40) > 0.1


def test_a_long_wing_fills_the_width_of_a_low_picture(wing, pixels):
    picture = pixels(*wing)
    assert picture.shape[0] < 1000
    drawn = (picture[200:-220] < 200).any(axis=2).any(axis=0)
    assert np.ptp(np.flatnonzero(drawn)) > 1800


def test_nothing_is_said_on_stderr_and_nothing_drawn_is_imported_early(tmp_path):
    """In a process of its own: VTK comes only with the drawing, and nothing else does."""
    script = """
import sys
sys.path[:0] = sys.argv[2:]
import meshdrape.output
assert not [name for name in sys.modules if name.startswith(("vtk", "pyvista", "matplotlib"))]
from known_nets import flat_net, measured
net = flat_net()
meshdrape.output.draw_net(net, measured(net), sys.argv[1])
assert not [name for name in sys.modules if name.startswith(("pyvista", "matplotlib"))]
"""
    run = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "net.png"), *HELPERS],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stderr, run.stdout) == (0, "", "")
    assert (tmp_path / "net.png").read_bytes().startswith(b"\x89PNG")


def test_a_machine_without_opengl_is_told_what_to_install(tmp_path):
    script = """
import sys
sys.path[:0] = sys.argv[2:]
from known_nets import flat_net, measured
from meshdrape.errors import MissingLibraryError
from meshdrape.output import draw_net
from meshdrape.output.picture import draw as picture
net = flat_net()
try:
    draw_net(net, measured(net), sys.argv[1])
except MissingLibraryError as error:
    print(error)
"""
    run = subprocess.run(
        [sys.executable, "-c", script, str(tmp_path / "net.png"), *HELPERS],
        capture_output=True,
        text=True,
        check=False,
        env={"__EGL_VENDOR_LIBRARY_DIRS": str(tmp_path), "PATH": ""},
    )
    assert (run.returncode, run.stderr) == (0, "")
    assert "apt install libegl1" in run.stdout
    assert not list(tmp_path.iterdir())


def test_a_net_without_a_whole_cell_is_a_picture_of_the_mould(flat, pixels):
    net, measures = flat
    status = np.full_like(net.node_status, NodeStatus.NOT_REACHED)
    status[net.seed_index] = NodeStatus.PLACED
    position = np.where(status[..., None] == NodeStatus.PLACED, net.node_position, np.nan)
    bare = type(net)(net.mould, net.fabric, net.seed, net.direction, net.seed_index, position, status)
    drawing = pixels(bare, replace(measures, cell_shear=np.full_like(measures.cell_shear, np.nan), max_shear=np.nan))
    assert share_near(drawing, (190, 190, 190), 40) > 0.1


@pytest.mark.parametrize(("cull", "middle"), [(False, (98, 164, 224)), (True, (255, 255, 255))])
def test_cells_are_drawn_on_the_side_of_the_cloth(tmp_path, cull, middle):
    """A square seen from behind: to be left out, so that it cannot come through the mould it lies under."""
    square = np.array([[[0.0, 0, 0], [0, 10, 0], [10, 10, 0], [10, 0, 0]]])
    view, _ = fitted(np.eye(3), square[0], square[0], (50.0, 50.0), 100.0, (100.0, 100.0))
    stage = Stage(200, 200, view)
    stage.add_faces(square, np.array([[0.0, 0, -1]]), (98, 164, 224, 255), cull=cull)
    (tmp_path / "square.png").write_bytes(stage.png())
    picture = read_png(tmp_path / "square.png")
    assert np.abs(picture[100, 100] - middle).max() < 12
    is_blue = picture[..., 0] < 200
    assert is_blue.sum() == (0 if cull else 100 * 100)


def test_a_missing_folder_is_told(flat, tmp_path):
    with pytest.raises(FileError, match="does not exist"):
        draw_net(*flat, tmp_path / "no" / "net.png")


def test_a_net_of_few_cells_is_drawn_cell_by_cell(flat):
    net, measures = flat
    cells = drawn_cells(net, measures)
    whole = ~np.isnan(measures.cell_shear)
    assert cells.block == 1
    assert len(cells.corners) == whole.sum()
    np.testing.assert_allclose(cells.shear, np.radians(5.0))
    np.testing.assert_allclose(cells.areas.sum(), whole.sum() * 6.0 * np.cos(np.radians(5.0)))
    np.testing.assert_allclose(cells.normals, np.tile([0.0, 0, 1], (whole.sum(), 1)), atol=1e-12)


@pytest.mark.parametrize("most", [500, 2000])
def test_blocks_keep_every_peak_and_the_outline(wing, most):
    net, measures = wing
    one = drawn_cells(net, measures)
    blocks = drawn_cells(net, measures, most=most)
    assert blocks.block > 1
    assert len(blocks.corners) <= most
    assert blocks.shear.max() == one.shear.max()
    assert blocks.areas.sum() == pytest.approx(one.areas.sum(), rel=0.03)  # a block across the crease cuts it off
    np.testing.assert_array_equal(blocks.corners.min(axis=(0, 1)), one.corners.min(axis=(0, 1)))


def test_blocks_round_a_hole_are_drawn_cell_by_cell(flat):
    net, measures = flat
    one, blocks = drawn_cells(net, measures), drawn_cells(net, measures, most=250)
    assert blocks.block == 2
    assert blocks.areas.sum() == pytest.approx(one.areas.sum(), rel=1e-12)


def test_fibres_run_along_the_drawn_quads_and_keep_their_gap(wing):
    net, measures = wing
    blocks = drawn_cells(net, measures, most=2000)
    warp, weft, step = drawn_fibres(net, 400.0, blocks.block)
    assert min(step) * 50.0 >= 400.0
    assert step[0] % blocks.block == 0
    corners = {tuple(point) for point in blocks.corners.reshape(-1, 3).tolist()}
    for family in (warp, weft):
        assert {tuple(point) for point in family.reshape(-1, 3).tolist()} <= corners


def test_the_view_looks_at_the_cloth_with_z_up_and_the_wing_along_the_picture(wing):
    net, measures = wing
    cells = drawn_cells(net, measures)
    axes = view_axes(cells.normals, cells.areas, cells.corners.reshape(-1, 3))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert (cells.normals @ axes[2] > 0.1).all()  # cover and spar both turn to the eye
    assert abs(axes[0, 1]) > 0.9
    assert axes[1, 2] > 0.3


def test_a_fitted_view_holds_its_subject_and_lets_the_far_go():
    square = np.array([[0.0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]])
    far = 1000.0 * (square - 5.0)
    view, height = fitted(np.eye(3), square, far, (50.0, 100.0), 400.0, (100.0, 900.0))
    seen = view.pixels(square)
    assert height == pytest.approx(400)
    assert seen.min(axis=0) == pytest.approx([50 + 400 * 4 / 18, 100 + 400 * 4 / 18])
    view, _ = fitted(np.eye(3), square, square, (50.0, 100.0), 400.0, (100.0, 900.0))
    np.testing.assert_allclose(view.pixels(square[2]), [450, 500])
    assert view.mm_per_pixel == pytest.approx(10 / 400)


def test_what_hides_a_point_lies_on_its_line_of_sight():
    """Against a linear system for each triangle: point + t towards the eye = one of its points."""
    rng = np.random.default_rng(3)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    view = View(axes, rng.normal(size=3), np.zeros(2), 0.1)
    hidden = 0
    for _ in range(300):
        point, corners = rng.normal(size=3), rng.normal(size=(1, 3, 3))
        a, b, c = corners[0]
        t, u, v = np.linalg.solve(np.stack([-view.toward, b - a, c - a], axis=1), point - a)
        expected = u >= 0 and v >= 0 and u + v <= 1 and t > 0.3
        assert view.hides(point, corners, 0.3) == expected
        assert view.hides(point, corners[:, ::-1], 0.3) == expected
        hidden += expected
    assert hidden > 10


def test_a_maximum_on_the_far_side_is_said_to_be_there(sphere, tmp_path, monkeypatch):
    """At the foot of a dome seen from above: behind on one side, in view on the other."""
    net, measures = sphere
    texts = []
    write = Stage.add_text
    monkeypatch.setattr(
        Stage, "add_text", lambda stage, text, *a, **k: texts.append(text) or write(stage, text, *a, **k)
    )
    view, _ = picture._view(net.mould, drawn_cells(net, measures))
    for away, said in ((1.0, False), (-1.0, True)):
        vertex = net.mould.vertices[np.argmax(net.mould.vertices @ (away * view.toward))]
        draw_net(net, replace(measures, max_shear_position=vertex), tmp_path / "net.png")
        assert [text.endswith(", behind") for text in texts if text.startswith("max")] == [said]
        texts.clear()
