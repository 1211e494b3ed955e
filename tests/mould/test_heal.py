"""Healing: what it repairs, what it says of it, and how far it moves the surface."""

import sys

import numpy as np
import pytest
from moulds import Mesh, bumpy, cut_plate, grid, holed_plate, icosphere, moebius, plate, tiles

from meshdrape.errors import MissingLibraryError, MouldError, missing_library
from meshdrape.mould.mesh.check import FaultKind, examine
from meshdrape.mould.mesh.heal import HealReport, heal
from meshdrape.mould.mould import Mould
from meshdrape.surface import Surface


def torn(mesh: Mesh, gap: float) -> Mesh:
    """Every triangle with corners of its own, each moved by up to `gap` a coordinate."""
    soup = mesh.vertices[mesh.triangles].reshape(-1, 3)
    shift = np.random.default_rng(0).uniform(-gap, gap, soup.shape)
    return Mesh(soup + shift, np.arange(len(soup)).reshape(-1, 3))


def corners(vertices, triangles):
    """The triangles as a sorted list of their corners, each triangle from its least corner on."""
    rows = []
    for a, b, c in vertices[triangles].tolist():
        rows.append(min((a, b, c), (b, c, a), (c, a, b)))
    return sorted(rows)


def changes(report: HealReport) -> dict[str, int]:
    names = ("vertices_merged", "vertices_split", "edges_turned", "triangles_removed", "triangles_reversed")
    return {name: getattr(report, name) for name in names if getattr(report, name)}


@pytest.mark.parametrize("mesh", [plate(), holed_plate(), bumpy(), icosphere(2)])
def test_a_sound_mesh_is_left_as_it_is(mesh):
    vertices, triangles, report = heal(*mesh)
    assert np.allclose(vertices, mesh.vertices, rtol=1e-15, atol=0)
    assert np.array_equal(triangles, mesh.triangles)
    assert changes(report) == {}
    assert (report.faults, report.moved) == ((), 0.0)
    assert str(report) == "healing found nothing to repair"


@pytest.mark.parametrize("gap", [1e-6, 1e-5, 2e-4])
def test_a_torn_mesh_is_closed(gap):
    mesh = bumpy()
    vertices, triangles, report = heal(*torn(mesh, gap))
    healed = Surface.from_arrays(vertices, triangles)
    assert len(triangles) == len(mesh.triangles)
    assert len(vertices) == len(mesh.vertices)
    assert healed.n_components == 1
    assert len(healed.border_loops) == 1
    assert changes(report) == {"vertices_merged": 3 * len(mesh.triangles) - len(mesh.vertices)}
    # a corner goes to another of its own, at most the diagonal of the box of shifts away
    assert gap / 2 < report.moved < 2 * np.sqrt(3) * gap
    distance = np.linalg.norm(vertices - mesh.vertices[_nearest(vertices, mesh.vertices)], axis=1)
    assert distance.max() <= np.sqrt(3) * gap


def _nearest(points, others):
    return np.array([np.argmin(np.linalg.norm(others - p, axis=1)) for p in points])


def test_a_tear_wider_than_close_stays_open():
    mesh = tiles()
    left = mesh.vertices[mesh.triangles].mean(axis=1)[:, 0] < 2
    right = mesh.kept(~left).moved(np.eye(3), (2e-4, 0, 0))
    vertices, _, report = heal(*mesh.kept(left).joined(right))
    assert len(vertices) == 30
    assert changes(report) == {}


def test_small_triangles_are_not_merged_away():
    """On a large mould with small triangles 1e-5 of its size is more than their edges."""
    mesh = grid(np.linspace(0, 0.02, 5), np.linspace(0, 0.02, 5), lambda x, y: (x, y, 0))
    far = Mesh(np.array([[1e4, 0, 0], [1e4 + 0.01, 0, 0], [1e4, 0.01, 0]]), np.array([[0, 1, 2]]))
    _, triangles, report = heal(*mesh.joined(far))
    assert len(triangles) == 33
    assert changes(report) == {}


def test_duplicates_and_collapsed_triangles_are_removed():
    mesh = tiles()
    extra = [mesh.triangles[5], mesh.triangles[9, ::-1], [7, 7, 8], [3, 3, 3]]
    vertices, triangles, report = heal(mesh.vertices, np.concatenate([mesh.triangles, extra]))
    assert corners(vertices, triangles) == corners(*mesh)
    assert changes(report) == {"triangles_removed": 4}
    assert report.moved == 0
    assert {fault.kind: fault.count for fault in report.faults} == {
        FaultKind.REPEATED_VERTEX: 2,
        FaultKind.DUPLICATE: 2,
    }
    assert str(report) == "healed: 4 triangles removed; the surface moved by 0 mm at most"


@pytest.mark.parametrize("which", [[0], [4, 9, 20], range(16)])
def test_reversed_triangles_are_turned_to_the_majority(which):
    mesh = plate()
    wrong = mesh.triangles.copy()
    wrong[list(which)] = wrong[list(which)][:, ::-1]
    vertices, triangles, report = heal(mesh.vertices, wrong)
    assert corners(vertices, triangles) == corners(*mesh)
    assert changes(report) == {"triangles_reversed": len(which)}
    assert report.moved == 0


def test_each_component_is_turned_by_itself():
    two = tiles().joined(tiles().reversed().moved(np.eye(3), (10, 0, 0)))
    wrong = two.triangles.copy()
    wrong[[0, 40]] = wrong[[0, 40]][:, ::-1]
    vertices, triangles, report = heal(two.vertices, wrong)
    assert corners(vertices, triangles) == corners(*two)
    assert changes(report) == {"triangles_reversed": 2}


@pytest.mark.parametrize("height", [0.5, 3.0])
def test_a_fin_is_taken_off_and_the_sheet_it_stood_on_is_whole(height):
    mesh = tiles()
    vertices = np.concatenate([mesh.vertices, [[1.5, 1.5, height]]])
    healed, triangles, report = heal(vertices, np.concatenate([[[6, 12, 25]], mesh.triangles]))
    assert corners(healed, triangles) == corners(*mesh)
    assert changes(report) == {"triangles_removed": 1}
    assert report.moved == pytest.approx(height, rel=1e-6)
    assert str(report) == f"healed: 1 triangle removed; the surface moved by {height:.3g} mm at most"


def test_a_needle_is_turned_not_cut_out():
    """A corner of two triangles on an edge of their neighbour, the gap filled by a triangle without area."""
    vertices = np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 1, 0], [1, -1, 0.0]])
    triangles = np.array([[0, 2, 3], [2, 1, 3], [0, 1, 2], [1, 0, 4]])
    healed, found, report = heal(vertices, triangles)
    surface = Surface.from_arrays(healed, found)
    assert changes(report) == {"edges_turned": 1}
    assert report.moved == 0
    assert len(surface.border_loops) == 1
    assert surface.face_area.sum() == pytest.approx(2.0, rel=1e-12)
    assert surface.face_area.min() == pytest.approx(0.5, rel=1e-12)


def test_sheets_that_touch_at_a_point_are_parted():
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]
    healed, triangles, report = heal(vertices, [[0, 1, 2], [0, 3, 4]])
    assert changes(report) == {"vertices_split": 1}
    assert report.moved == 0
    assert Surface.from_arrays(healed, triangles).n_components == 2
    assert len(healed) == 6


def test_a_wall_on_a_sheet_becomes_drapable():
    side = np.linspace(0, 1, 6)
    wall = grid(side, side, lambda x, z: (x, 0.4, z))
    both = grid(side, side, lambda x, y: (x, y, 0)).joined(wall).welded()
    assert examine(both.vertices, both.triangles).count(FaultKind.NON_MANIFOLD_EDGE) == 5
    vertices, triangles, report = heal(*both)
    assert examine(vertices, triangles).faults == ()
    assert len(triangles) == len(both.triangles) - report.triangles_removed
    assert 0 < report.moved < 0.2


def test_holes_are_left_open():
    mesh = cut_plate(lambda x, y: np.maximum(np.abs(x - 5), np.abs(y - 5)) > 6)
    vertices, triangles, report = heal(*mesh)
    assert changes(report) == {}
    assert Mould.from_arrays(vertices, triangles).notes[0].startswith("1 hole,")


def test_everything_at_once():
    mesh = bumpy()
    soup = torn(mesh, 1e-5)
    wrong = soup.triangles.copy()
    wrong[:7] = wrong[:7, ::-1]
    vertices = np.concatenate([soup.vertices, [[0, 0, 500], [9, 9, 9]]])
    fin = [soup.triangles[20, 0], soup.triangles[20, 1], len(soup.vertices)]
    triangles = np.concatenate([wrong, wrong[50:53], [fin, [4, 4, 5]]])
    healed, found, report = heal(vertices, triangles)
    surface = Surface.from_arrays(healed, found)
    assert (len(healed), len(found)) == (len(mesh.vertices), len(mesh.triangles))
    assert (surface.n_components, len(surface.border_loops)) == (1, 1)
    assert report.triangles_removed == 5
    assert report.triangles_reversed == 7
    assert report.vertices_merged == len(soup.vertices) - len(mesh.vertices)
    assert 400 < report.moved <= 520
    assert (surface.face_normal[:, 2] > 0).all()


def test_what_is_lost_counts_as_moved():
    """Two fins are lost: the farther counts, though nothing of the new surface is far from the old."""
    mesh = tiles()
    vertices = np.concatenate([mesh.vertices, [[1.5, 1.5, 100], [1.5, 1.5, -40]]])
    healed, triangles, report = heal(vertices, np.concatenate([mesh.triangles, [[6, 12, 25], [6, 12, 26]]]))
    assert corners(healed, triangles) == corners(*mesh)
    assert report.moved == pytest.approx(100, rel=1e-6)


def test_four_triangles_about_one_edge():
    """None of them is the sheet more than another; two are left, whichever."""
    vertices = [[0, 0, 0], [4, 0, 0], [2, 3, 0], [2, -3, 0], [2, 0, 2], [2, 0, -2]]
    healed, triangles, report = heal(vertices, [[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]])
    assert len(triangles) == 4 - report.triangles_removed >= 2
    assert examine(healed, triangles).faults == ()


def test_numbers_after_another_order_of_the_triangles():
    mesh = torn(bumpy(n=8), 1e-5)
    order = np.random.default_rng(1).permutation(len(mesh.triangles))
    one, other = heal(*mesh)[2], heal(mesh.vertices, mesh.triangles[order])[2]
    assert changes(one) == changes(other)


# --- what cannot be healed ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (
            moebius(),
            "the mesh cannot be draped: 1 one-sided component, at (0.891792, 0.10429, 0); "
            "a one-sided surface has no normal side to lay cloth on: cut it in CAD",
        ),
        (
            Mesh(np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]]), np.array([[0, 1, 2]])),
            "nothing is left after healing; repair the mesh in CAD",
        ),
        (
            Mesh(np.array([[0, 0, 0], [1, 0, 0], [2, 1, 0.0]]), np.array([[0, 1, 1]])),
            "nothing is left after healing; repair the mesh in CAD",
        ),
        (
            Mesh(np.array([[0, 0, 0], [1, 0, 0], [2, 1, 0.0]]), np.array([[0, 1, 7]])),
            "triangles[0] uses vertex 7 but there are 3 vertices; indices start at 0 (1 triangle out of range)",
        ),
        (
            Mesh(np.array([[0, 0, 0], [1, 0, 0], [2, np.nan, 0]]), np.array([[0, 1, 2]])),
            "vertices[2] is (2, nan, 0): 1 vertex not finite or farther out than 1e+12 mm; export the mesh anew",
        ),
    ],
)
def test_what_cannot_be_healed_is_said(mesh, message):
    with pytest.raises(MouldError) as caught:
        heal(*mesh)
    assert str(caught.value) == message


@pytest.mark.parametrize(
    ("reason", "line"),
    [
        ("libGL.so.1: cannot open shared object file: No such file", "libGL.so.1 is missing; apt-get install libgl1"),
        ("libOpenGL.so.0: cannot open shared object file", "libOpenGL.so.0 is missing; apt-get install libopengl0"),
    ],
)
def test_a_library_of_the_system_that_is_missing_is_named_with_its_package(monkeypatch, reason, line):
    class Missing:
        def find_spec(self, name, path=None, target=None):
            if name == "pymeshlab":
                raise ImportError(reason)

    monkeypatch.delitem(sys.modules, "pymeshlab", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Missing(), *sys.meta_path])
    with pytest.raises(MissingLibraryError) as caught:
        heal(*tiles())
    assert str(caught.value) == line
    assert str(missing_library(ImportError(reason))) == line
