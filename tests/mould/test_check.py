"""Faults that keep a mesh from being draped: each found, counted, placed and named in one line."""

import time

import numpy as np
import pytest
from moulds import Mesh, cut_plate, grid, holed_plate, moebius, plate, rotation, tiles

from meshdrape.errors import MouldError
from meshdrape.mould.mesh.check import FaultKind, as_arrays, examine, notes_on
from meshdrape.mould.mould import Mould
from meshdrape.surface import Surface

WAY_OUT = "repair it with --heal, or in CAD"


def added(mesh: Mesh, triangles: list[list[int]], vertices: list[list[float]] | None = None) -> Mesh:
    extra = np.array(vertices if vertices else np.empty((0, 3)))
    return Mesh(np.concatenate([mesh.vertices, extra]), np.concatenate([mesh.triangles, triangles]))


def turned(mesh: Mesh, which: slice | list[int]) -> Mesh:
    triangles = mesh.triangles.copy()
    triangles[which] = triangles[which][:, ::-1]
    return Mesh(mesh.vertices, triangles)


# --- arrays ---------------------------------------------------------------------------------------------------------

VERTICES = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
FACE = [[0, 1, 2]]
NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("vertices", "triangles", "message"),
    [
        (VERTICES, [], "the mesh has no triangles; a mould needs at least one"),
        ([], [], "the mesh has no triangles; a mould needs at least one"),
        (VERTICES, np.empty((0, 3), int), "the mesh has no triangles; a mould needs at least one"),
        (
            VERTICES,
            [[0, 1, 2], [0, 1, 940], [0, -1, 2]],
            "triangles[1] uses vertex 940 but there are 3 vertices; indices start at 0 (2 triangles out of range)",
        ),
        (
            VERTICES,
            [[1, 2, 3]],
            "triangles[0] uses vertex 3 but there are 3 vertices; indices start at 0 (1 triangle out of range)",
        ),
        (
            VERTICES,
            [[0, 1, 2], [2, -1, 0]],
            "triangles[1] uses vertex -1 but there are 3 vertices; indices start at 0 (1 triangle out of range)",
        ),
        (
            VERTICES,
            np.array([[0, 1, 2**63]], dtype=np.uint64),
            "triangles[0] uses vertex 9223372036854775808 but there are 3 vertices; indices start at 0 "
            "(1 triangle out of range)",
        ),
        ([], FACE, "triangles[0] uses vertex 0 but there are 0 vertices; indices start at 0 (1 triangle out of range)"),
        (
            [[0, 0, 0], [1, NAN, 0], [0, NAN, 0]],
            FACE,
            "vertices[1] is (1, nan, 0): 2 vertices not finite or farther out than 1e+12 mm; export the mesh anew",
        ),
        (
            [[0, 0, 0], [1, 0, 0], [0, 1, -INF]],
            FACE,
            "vertices[2] is (0, 1, -inf): 1 vertex not finite or farther out than 1e+12 mm; export the mesh anew",
        ),
        (
            [[0, 0, 0], [1e300, 0, 0], [0, 1, 0]],
            FACE,
            "vertices[1] is (1e+300, 0, 0): 1 vertex not finite or farther out than 1e+12 mm; export the mesh anew",
        ),
        ([[0, 0], [1, 0], [0, 1]], FACE, "vertices must be an array of numbers of shape (k, 3), got shape (3, 2)"),
        ([0.0, 1.0, 2.0], FACE, "vertices must be an array of numbers of shape (k, 3), got shape (3,)"),
        (5.0, FACE, "vertices must be an array of numbers of shape (k, 3), got shape ()"),
        (
            [[0, 0, 0], [1, 0]],
            FACE,
            "vertices must be an array of numbers of shape (k, 3), got rows of different lengths",
        ),
        ([["a", "b", "c"]] * 3, FACE, "vertices must be an array of numbers, got <U1"),
        (np.array(VERTICES) * 1j, FACE, "vertices must be an array of numbers, got complex128"),
        (VERTICES, [[0.0, 1.0, 2.0]], "triangles must be an array of integers, got float64"),
        (VERTICES, [[True, False, True]], "triangles must be an array of integers, got bool"),
        (
            VERTICES,
            [[0, 1, 2, 0]],
            "triangles must be an array of integers of shape (k, 3), got shape (1, 4); "
            "split polygons into triangles first",
        ),
    ],
)
def test_arrays_that_are_no_mesh(vertices, triangles, message):
    with pytest.raises(MouldError) as caught:
        Mould.from_arrays(vertices, triangles)
    assert str(caught.value) == message


def test_what_is_too_far_out_depends_on_the_unit():
    far = [[0, 0, 0], [2e9, 0, 0], [0, 1, 0]]
    assert as_arrays(far, FACE)[0][1, 0] == 2e9
    with pytest.raises(MouldError, match=r"^vertices\[1\] is \(2e\+09, 0, 0\): 1 vertex not finite or farther"):
        as_arrays(far, FACE, factor=1000.0)


# --- faults ---------------------------------------------------------------------------------------------------------

FAULTY = {
    "repeated vertex": (
        added(tiles(), [[3, 3, 4], [7, 8, 7]]),
        {FaultKind.REPEATED_VERTEX: 2},
        f"2 repeated-vertex triangles, the first at (0, 3.33333, 0); {WAY_OUT}",
    ),
    "zero area: three points on a line": (
        Mesh(np.array([[0, 0, 0], [1, 0, 0], [3, 0, 0.0]]), np.array([[0, 1, 2]])),
        {FaultKind.ZERO_AREA: 1},
        f"1 zero-area triangle, at (1.33333, 0, 0); {WAY_OUT}",
    ),
    "zero area: all in one point": (
        Mesh(np.array([[1, 2, 3.0]] * 3), np.array([[0, 1, 2]])),
        {FaultKind.ZERO_AREA: 1},
        f"1 zero-area triangle, at (1, 2, 3); {WAY_OUT}",
    ),
    "duplicate, also reversed or rotated": (
        added(tiles(), [tiles().triangles[5].tolist(), tiles().triangles[5, ::-1].tolist(), [5, 10, 11]]),
        {FaultKind.DUPLICATE: 3},
        f"3 duplicate triangles, the first at (1.66667, 1.33333, 0); {WAY_OUT}",
    ),
    "fin on an inner edge": (
        added(tiles(), [[6, 12, 25]], [[1, 2, 5]]),
        {FaultKind.NON_MANIFOLD_EDGE: 1},
        f"1 non-manifold edge, at (1.5, 1.5, 0); {WAY_OUT}",
    ),
    "two fins on one edge and one on another": (
        added(tiles(), [[6, 12, 25], [6, 12, 26], [12, 18, 25]], [[1, 2, 5], [1, 2, -5]]),
        {FaultKind.NON_MANIFOLD_EDGE: 2},
        f"2 non-manifold edges, the first at (1.5, 1.5, 0); {WAY_OUT}",
    ),
    "sheets that touch at a point": (
        added(tiles(), [[12, 25, 26]], [[2, 2, 5], [3, 2, 5]]),
        {FaultKind.BOW_TIE: 1},
        f"1 non-manifold vertex, at (2, 2, 0); {WAY_OUT}",
    ),
    "corners of two plates in one point": (
        added(tiles(), [[24, 25, 26], [0, 27, 28]], [[5, 4, 0], [5, 5, 0], [-1, 0, 0], [-1, -1, 0]]),
        {FaultKind.BOW_TIE: 2},
        f"2 non-manifold vertices, the first at (0, 0, 0); {WAY_OUT}",
    ),
    "a few triangles reversed": (
        turned(tiles(), [4, 9, 20]),
        {FaultKind.MIXED_ORIENTATION: 3},
        f"3 reversed triangles, the first at (1.66667, 0.333333, 0); {WAY_OUT}",
    ),
    "most triangles reversed: the rest is": (
        turned(tiles(), slice(2, None)),
        {FaultKind.MIXED_ORIENTATION: 2},
        f"2 reversed triangles, the first at (0.666667, 0.333333, 0); {WAY_OUT}",
    ),
    "one-sided": (
        moebius(),
        {FaultKind.ONE_SIDED: 1},
        "1 one-sided component, at (0.891792, 0.10429, 0); "
        "a one-sided surface has no normal side to lay cloth on: cut it in CAD",
    ),
    "several at once": (
        added(tiles(), [[3, 3, 4], [6, 12, 25], [24, 26, 27], [5, 10, 11]], [[1, 2, 5], [5, 4, 0], [5, 5, 0]]),
        {
            FaultKind.REPEATED_VERTEX: 1,
            FaultKind.DUPLICATE: 1,
            FaultKind.NON_MANIFOLD_EDGE: 1,
            FaultKind.BOW_TIE: 1,
        },
        "1 repeated-vertex triangle, at (0, 3.33333, 0); 1 duplicate triangle, at (1.66667, 0.333333, 0); "
        f"1 non-manifold edge, at (1.5, 1.5, 0); 1 non-manifold vertex, at (4, 4, 0); {WAY_OUT}",
    ),
}


@pytest.mark.parametrize("case", FAULTY)
def test_fault_is_counted_placed_and_named(case):
    mesh, counts, line = FAULTY[case]
    report = examine(*as_arrays(*mesh))
    assert {fault.kind: fault.count for fault in report.faults} == counts
    assert all(report.count(kind) == counts.get(kind, 0) for kind in FaultKind)
    with pytest.raises(MouldError) as caught:
        Mould.from_arrays(*mesh)
    assert str(caught.value) == f"the mesh cannot be draped: {line}"


@pytest.mark.parametrize("case", FAULTY)
def test_faults_do_not_depend_on_numbering_or_place(case):
    mesh, counts, _ = FAULTY[case]
    rng = np.random.default_rng(3)
    number = rng.permutation(len(mesh.vertices))
    vertices = np.empty_like(mesh.vertices)
    vertices[number] = mesh.vertices
    order = rng.permutation(len(mesh.triangles))
    shift = rng.integers(0, 3, len(order))[:, None]
    triangles = np.take_along_axis(number[mesh.triangles][order], (np.arange(3) + shift) % 3, axis=1)
    report = examine(*as_arrays(*Mesh(vertices, triangles).moved(rotation([1, 2, 3], 0.7), (5, -8, 3))))
    assert {fault.kind: fault.count for fault in report.faults} == counts


@pytest.mark.parametrize("shift", [0, 1, 2])
@pytest.mark.parametrize("scale", [1e-30, 1e-6, 1.0, 1e6, 1e10])
@pytest.mark.parametrize(("height", "flat"), [(2e-12, False), (5e-13, True)])
def test_zero_area_is_relative_to_the_longest_edge(scale, height, flat, shift):
    vertices = scale * np.array([[0, 0, 0], [1, 0, 0], [0.4, height, 0]])
    assert examine(vertices, np.roll([[0, 1, 2]], shift)).count(FaultKind.ZERO_AREA) == int(flat)


@pytest.mark.parametrize(
    "mesh",
    [
        tiles(),
        plate(),
        holed_plate(),
        tiles().joined(tiles().moved(np.eye(3), (10, 0, 0))),
        Mesh(np.eye(4)[:, :3], np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])),
        Mesh(np.array(VERTICES, float), np.array(FACE)),
    ],
    ids=["square", "plate", "hole", "two parts", "closed", "one triangle"],
)
def test_sound_meshes_have_no_faults(mesh):
    report = examine(*as_arrays(*mesh))
    assert report.faults == ()
    assert (report.n_vertices, report.n_triangles, report.n_unreferenced) == (
        len(mesh.vertices), len(mesh.triangles), 0,
    )  # fmt: skip
    report.require_drapable()


# --- notes ----------------------------------------------------------------------------------------------------------


def test_no_notes_on_a_plain_sheet_or_a_closed_mesh():
    assert plate().mould().notes == ()
    closed = Mesh(np.eye(4)[:, :3], np.array([[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))
    assert notes_on(Surface.from_arrays(*closed)) == ()


def test_hole_is_noted_with_its_size_and_place():
    assert holed_plate().mould().notes == ("1 hole, its border 240 mm long about (25, 5, 0)",)


def test_holes_are_counted_and_the_longest_placed():
    mesh = cut_plate(
        lambda x, y: (np.maximum(np.abs(x + 50), np.abs(y)) > 20) & (np.maximum(np.abs(x - 50), np.abs(y)) > 10)
    )
    assert mesh.mould().notes == ("2 holes, the longest border 160 mm long about (-50, 0, 0)",)


def test_ends_of_a_tube_are_no_holes():
    t = np.linspace(0, 2 * np.pi, 33)
    tube = grid(t, np.linspace(0, 5, 4), lambda t, z: (np.cos(t), np.sin(t), z)).welded()
    assert len(tube.mould().surface.border_loops) == 2
    assert tube.mould().notes == ()


def test_components_are_noted_with_their_sizes():
    parts = tiles(3).joined(tiles(1).moved(np.eye(3), (10, 0, 0)))
    assert parts.mould().notes == (
        "2 components, of 18 and 2 triangles, the smallest about (10.5, 0.5, 0); the seed's is draped",
    )
    many = tiles(3)
    for k in range(1, 6):
        many = many.joined(tiles(1).moved(np.eye(3), (10 * k, 0, 0)))
    (note,) = many.mould().notes
    assert note.startswith("6 components, of 18 triangles down to 2, the smallest about (")


# --- speed ----------------------------------------------------------------------------------------------------------


def test_a_hundred_thousand_triangles_are_checked_at_once():
    mesh = grid(np.linspace(0, 1, 225), np.linspace(0, 1, 225), lambda x, y: (x, y, x * y))
    vertices, triangles = as_arrays(*mesh)
    assert len(triangles) > 100_000
    examine(vertices, triangles)  # scipy is loaded now
    seconds = []
    for _ in range(5):
        start = time.process_time()
        examine(vertices, triangles)
        seconds.append(time.process_time() - start)
    assert min(seconds) < 0.3
