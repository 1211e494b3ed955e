"""The files in ``samples/`` are what the scripts make, and read back as what was written."""

from __future__ import annotations

from pathlib import Path

import cadquery as cq
import make_samples
import numpy as np
import pytest
from OCP.STEPControl import STEPControl_Reader

SAMPLES = Path(make_samples.__file__).resolve().parent.parent / "samples"
each_sample = pytest.mark.parametrize("sample", make_samples.SAMPLES, ids=lambda sample: sample.name)


@pytest.fixture(scope="module")
def fresh(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("samples")
    make_samples.main(["--folder", str(folder)])
    return folder


def read_step(path: Path) -> cq.Shape:
    (shape,) = cq.importers.importStep(str(path)).vals()
    return shape


def read_stl(path: Path) -> np.ndarray:
    """Corners of the triangles of a binary STL, (m, 3, 3)."""
    layout = np.dtype([("normal", "<f4", 3), ("corner", "<f4", (3, 3)), ("attribute", "<u2")])
    data = path.read_bytes()
    triangles = np.frombuffer(data, layout, offset=84)
    assert len(triangles) == int.from_bytes(data[80:84], "little")
    return triangles["corner"].astype(np.float64)


def area_of(corner: np.ndarray) -> float:
    return float(np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2)


def test_folder_holds_these_files_and_no_others(fresh):
    assert {path.name for path in SAMPLES.iterdir() if path.is_file()} == {path.name for path in fresh.iterdir()}
    assert sum(path.stat().st_size for path in SAMPLES.iterdir()) < 6_000_000


@each_sample
def test_step_reads_back_as_what_was_built(sample):
    built = sample.script.build(**sample.parameters).val()
    found = read_step(SAMPLES / f"{sample.name}.step")
    assert found.isValid()
    assert found.ShapeType() == ("Solid" if sample.parameters.get("block") else "Shell")
    # Domes bounded by curves that Open CASCADE fits to the fillet: it integrates their area to five digits only.
    rel = 1e-4 if sample.name == "double_dome" else 1e-9
    assert [face.Area() for face in found.Faces()] == pytest.approx([face.Area() for face in built.Faces()], rel=rel)
    for face, original in zip(found.Faces(), built.Faces(), strict=True):
        assert face.normalAt().toTuple() == pytest.approx(original.normalAt().toTuple(), abs=1e-9)
        assert face.Center().toTuple() == pytest.approx(original.Center().toTuple(), abs=max(1e-4, 10 * rel))
    assert len(found.Edges()) == len(built.Edges())  # shared edges are still shared


@pytest.mark.parametrize(
    ("name", "faces"),
    [
        ("wing_spar", ["wing", "spar"]),
        ("wing_spar_block", ["wing", "spar", "skirt", "floor", "back", "root", "tip"]),
        ("cube_corner", ["yz", "zx", "xy"]),
        ("cone", [""]),
        ("hat", ["dome", "fillet", "rim"]),
        ("joggle", ["upper", "convex", "ramp", "concave", "lower"]),
        ("c_spar", ["lower_flange", "lower_fillet", "web", "upper_flange", "upper_fillet"]),
        ("double_dome", ["waist", "left", "fillet", "fillet", "right", "fillet", "rim", "fillet"]),
        ("leading_edge", ["upper", "lower"]),
    ],
)
def test_step_faces_carry_their_names(name, faces, fresh):
    for folder in (SAMPLES, fresh):
        reader = STEPControl_Reader()
        reader.ReadFile(str(folder / f"{name}.step"))
        reader.TransferRoots()
        transferred = reader.WS().TransferReader()
        shape = cq.Shape.cast(reader.OneShape())
        items = [transferred.EntityFromShapeResult(face.wrapped, 1) for face in shape.Faces()]
        assert [item.Name().ToCString() for item in items] == faces


@each_sample
def test_stl_is_the_tessellation_of_the_step(sample, fresh):
    if not sample.chord_tolerance:
        assert not (SAMPLES / f"{sample.name}.stl").exists()
        return
    corner = read_stl(SAMPLES / f"{sample.name}.stl")
    assert area_of(corner) == pytest.approx(area_of(read_stl(fresh / f"{sample.name}.stl")), rel=1e-6)
    assert area_of(corner) == pytest.approx(sample.script.build(**sample.parameters).val().Area(), rel=5e-4)
    assert (np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1) > 0).all()
    # Single precision rounds shared vertices alike: they weld exactly.
    vertices, number = np.unique(corner.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    edges = number.reshape(-1, 3)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    uses = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)[1]
    assert uses.max() <= 2
    assert len(vertices) - len(uses) + len(corner) == 1  # a disk


def test_step_files_do_not_depend_on_the_time(fresh, tmp_path):
    """The second file of one process has the bytes of the first: no clock, no counter."""
    sample = make_samples.SAMPLES[0]
    again = tmp_path / f"{sample.name}.step"
    make_samples.write_step(sample.script.build(), sample.name, again)
    assert again.read_bytes() == (fresh / again.name).read_bytes()
    assert b"2000-01-01T00:00:00" in again.read_bytes()


@each_sample
def test_readme_tells_of_the_sample(sample, fresh):
    on_disk, made = ((folder / "README.md").read_text(encoding="utf-8") for folder in (SAMPLES, fresh))
    assert on_disk.split("## Files")[0] == made.split("## Files")[0]
    (row,) = [line for line in on_disk.splitlines() if line.startswith(f"| {sample.name}.step ")]
    faces = row.split("|")[2].split(";")
    assert [float(face.split()[-1]) for face in faces] == pytest.approx(
        [face.Area() for face in read_step(SAMPLES / f"{sample.name}.step").Faces()], abs=0.06
    )
    if sample.chord_tolerance:
        assert f"| {sample.chord_tolerance:g} mm, {sample.angle_tolerance_deg:g}° |" in row
        assert row.endswith(f" {len(read_stl(SAMPLES / f'{sample.name}.stl'))} |")
    for value in make_samples.facts(sample.script.__doc__).values():
        assert value in on_disk


def test_a_folder_that_cannot_be_written_is_an_error(tmp_path):
    sample = make_samples.SAMPLES[-1]
    with pytest.raises(OSError, match="cannot be written"):
        make_samples.write_step(sample.script.build(), sample.name, tmp_path / "nowhere" / "x.step")
