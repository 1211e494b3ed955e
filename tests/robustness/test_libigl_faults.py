"""What makes libigl crash, hang or answer zero never reaches a user: a right answer, or one line of MeshdrapeError."""

import json
import os
import subprocess
import sys
from pathlib import Path

import igl_faults
import numpy as np
import pytest
from moulds import bumpy, grid, plate
from wild import WildDrape

import meshdrape
from meshdrape.geodesic import guarded
from meshdrape.geodesic.distance import exact_distances, surface_distance
from meshdrape.geodesic.patch import Patch
from meshdrape.geodesic.screen import LOWEST, relative_heights, screened
from meshdrape.surface import Surface

ROOT = Path(__file__).resolve().parents[2]
# of a coarse lattice of the reference engine on moulds without edges to fall over
REFUSED = {
    "non-manifold edge", "duplicate face", "duplicate face, turned", "face and its reverse", "repeated index", "empty",
    "no triangles", "index out of range", "negative index", "edge of length zero", "edge of 1e-13", "height of zero",
    "NaN", "infinity", "bow tie",
}  # fmt: skip


@pytest.fixture(scope="module")
def outcomes():
    """By mesh and function, from one process: had it died or hung, the last line would be of the call that did it."""
    path = os.pathsep.join([str(ROOT), str(ROOT / "tests")])
    process = subprocess.run(
        [sys.executable, igl_faults.__file__],
        capture_output=True,
        text=True,
        timeout=100,
        env={**os.environ, "PYTHONPATH": path},
        check=False,
    )
    lines = [json.loads(line) for line in process.stdout.splitlines()]
    assert process.returncode == 0, (process.returncode, lines[-1], process.stderr[-2000:])
    return {(mesh, function): outcome for mesh, function, *rest in lines for outcome in rest}


def test_no_call_crashes_or_takes_long(outcomes):
    assert not {call: found for call, found in outcomes.items() if "crashed" in found}
    assert not {call: found for call, found in outcomes.items() if found["seconds"] > 20}


def test_refusals_are_one_line_that_names_a_way_out(outcomes):
    refused = {call: found["refused"] for call, found in outcomes.items() if "refused" in found}
    assert len(refused) > 100
    for call, message in refused.items():
        assert "\n" not in message, call
        assert 20 < len(message) < 400, call


@pytest.mark.parametrize("mesh", sorted(REFUSED))
def test_refused_wherever_a_mould_is_made(outcomes, mesh):
    for (name, function), found in outcomes.items():
        # an STL file has no indices to be out of range, and leaves a NaN that no triangle uses behind
        if name == mesh and function != "Surface.from_arrays" and not function.endswith(".stl"):
            assert "refused" in found, function


@pytest.mark.parametrize("mesh", [name for name, fault in igl_faults.faults().items() if fault.distance is not None])
def test_distance_is_right(outcomes, mesh):
    """On a sheet it is the straight line, whatever lies in the way."""
    expected = igl_faults.faults()[mesh].distance
    for function in ("geodesic_distance", *(f"geodesic_distance {s}" for s in (".obj", ".ply", ".off"))):
        assert outcomes[mesh, function]["result"] == pytest.approx(expected, rel=1e-9), function


def test_no_distance_between_separate_parts(outcomes):
    for function in ("geodesic_distance", *(f"geodesic_distance {s}" for s in (".obj", ".ply", ".off", ".stl"))):
        assert "separate parts" in outcomes["separate parts", function]["refused"]


@pytest.mark.parametrize("engine", ["fast", "libigl"])
@pytest.mark.parametrize(
    "mesh",
    [n for n, f in igl_faults.faults().items() if n not in REFUSED and n not in ("closed", "unreferenced NaN")],
)
def test_sheet_is_laid_without_shear(outcomes, mesh, engine):
    result = outcomes[mesh, f"drape {engine}"]["result"]
    assert result["nodes"] > (100 if engine == "fast" else 15)
    assert result["lost"] == 0
    assert result["zero"] == 0
    assert result["shear"] < 1e-6
    assert result["edges"] > 50
    assert result["edge_error"] < 1e-9


# --- points to insert -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("offset", [0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-3])
def test_ends_near_vertices_and_edges(offset):
    """On a plate the distance is Euclid's; an end within a millionth of a vertex, in edges, may become that vertex."""
    mould = plate().mould()
    rng = np.random.default_rng(3)
    for _ in range(8):
        ends = []
        for where in rng.integers(2, size=2):
            corners = mould.vertices[mould.triangles[rng.integers(len(mould.triangles))]]
            near = np.array([1.0, rng.random() * offset, offset] if where else [rng.random(), offset, 1.0])
            ends.append(rng.permutation(near / near.sum()) @ corners)
        found = meshdrape.geodesic_distance(mould, *ends)
        assert found == pytest.approx(np.linalg.norm(ends[0] - ends[1]), abs=240 * max(min(offset, 1e-6), 1e-13))


@pytest.mark.parametrize("apart", [1e-9, 1e-6, 1e-3])
def test_points_close_together_are_not_at_distance_zero(apart):
    mould = plate().mould()
    corners = mould.vertices[mould.triangles]
    for face in range(0, len(corners), 17):
        for weight in ([1, 0, 0], [0.5, 0.5, 0], [0.2, 0.3, 0.5]):
            p = np.array(weight) @ corners[face]
            q = p + apart * (corners[face].mean(axis=0) - corners[face, 0] + [1.0, 0.7, 0.0])
            if np.abs(q[0]) < 100 and np.abs(q[1]) < 70:
                found = meshdrape.geodesic_distance(mould, p, q)
                assert found == pytest.approx(np.linalg.norm(p - q), rel=1e-4)


# --- screening ------------------------------------------------------------------------------------------------------


def needle_sheet(thin: float) -> tuple[np.ndarray, np.ndarray]:
    """A flat sheet with a row and a column as thin as that."""
    line = np.array([0.0, thin, 0.4, 0.7, 1.0])
    mesh = grid(line, line, lambda x, y: (x, y, 0))
    return mesh.vertices, mesh.triangles


@pytest.mark.parametrize("thin", [1e-12, 1e-10, 3e-9])
def test_flat_triangles_are_taken_out(thin):
    vertices, faces = needle_sheet(thin)
    assert relative_heights(vertices, faces).min() < LOWEST
    clean = screened(vertices, faces)
    assert clean is not None
    assert relative_heights(vertices, clean.faces).min() >= LOWEST
    assert clean.lowest == relative_heights(vertices, clean.faces).min()
    assert 0 < clean.moved < 100 * thin
    Surface.from_arrays(vertices, clean.faces)  # manifold
    area = Surface.from_arrays(vertices, clean.faces).area
    assert area == pytest.approx(1, abs=4 * thin)
    # every vertex is where it was, but for what it was drawn into
    assert np.abs(vertices[clean.image] - vertices).max() <= 2 * thin


def test_sound_meshes_pass_untouched():
    mesh = bumpy(0)
    clean = screened(mesh.vertices, mesh.triangles)
    assert clean is not None
    assert clean.faces is mesh.triangles
    assert clean.moved == 0
    assert np.array_equal(clean.image, np.arange(len(mesh.vertices)))


def test_nothing_is_left_of_a_flat_triangle_alone():
    assert screened(np.array([[0.0, 0, 0], [1, 0, 0], [0.5, 1e-12, 0]]), np.array([[0, 1, 2]])) is None


# --- a process of its own -------------------------------------------------------------------------------------------


def test_guarded_answers_are_libigls_own():
    mesh = bumpy(2, n=6)
    targets = np.array([3, 17, 40])
    here = guarded.solve(mesh.vertices, mesh.triangles, 24, targets)
    assert np.array_equal(guarded.solve_guarded(mesh.vertices, mesh.triangles, 24, targets), here)
    assert (here > 0).all()


def solver_that(does: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> guarded._Solver:
    """The guarded process with something else in place of libigl."""
    source = Path(guarded.__file__).read_text()
    program = source.replace("    import igl\n\n", f"    import igl\n\n    {does}\n", 1)
    program = program.replace("SECONDS, SECONDS_A_FACE = 0.5", "SECONDS, SECONDS_A_FACE = 0.2")
    script = tmp_path / "program.py"
    script.write_text(program)
    monkeypatch.setattr(guarded, "Path", lambda _: script)
    solver = guarded._Solver()
    monkeypatch.setattr(guarded, "_SOLVER", solver)
    return solver


@pytest.mark.parametrize(
    "does",
    [
        "while True: pass",
        "__import__('ctypes').string_at(0)",
        "np.ones(1 << 40)",
        "raise ValueError('no mesh')",
        "if source == 24: np.linalg.norm(np.ones(3)); __import__('time').sleep(9)",
    ],
    ids=["hangs", "crashes", "fills the memory", "raises", "hangs from one end"],
)
def test_a_solver_that_never_answers_is_ended(does, tmp_path, monkeypatch):
    """Both ends are tried; the answer is infinite where neither comes through, and the next question is asked anew."""
    solver = solver_that(does, tmp_path, monkeypatch)
    mesh = bumpy(2, n=6)
    question = (mesh.vertices, mesh.triangles, 24, np.array([3]))
    expected = guarded.solve(*question) if "source" in does else np.array([np.inf])
    assert guarded.solve_guarded(*question) == pytest.approx(expected, rel=1e-12)
    monkeypatch.setattr(guarded, "Path", Path)
    solver.stop()
    assert guarded.solve_guarded(*question) == pytest.approx(guarded.solve(*question), rel=1e-12)
    solver.stop()


def test_patch_with_corners_kept_by_other_edges():
    """Two faces must have the same vertices on their common edge though only one of them keeps all of it."""
    case = WildDrape.drawn("bumpy grid", 1820, most_nodes=900)
    mould = case.mesh.mould()
    surface = mould.surface
    rng = np.random.default_rng(0)
    for _ in range(150):
        ends = [surface.closest_point(case.seed + rng.normal(size=3) * 0.3 * surface.diagonal)[0] for _ in "ab"]
        whole = Patch(surface, np.arange(len(surface.faces)))
        a, b = (whole.insert(end.face, end.position(surface))[0] for end in ends)
        assert surface_distance(surface, *ends)[0] == pytest.approx(exact_distances(whole, a, [b])[0], rel=1e-8)
