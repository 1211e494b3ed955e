"""Hundreds of files read, nets measured, audited and written in one process take no more memory than the first did."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from meshfiles import binary_stl, obj, off, text_ply, text_stl
from moulds import bumpy
from test_many_drapes import resident

import meshdrape
from meshdrape.geodesic.guarded import _SOLVER, solve_guarded

ROOT = Path(__file__).resolve().parents[2]
CAD, SAMPLES = ROOT / "cad", ROOT / "samples"

MESH = bumpy(1, n=12)
COARSE = {"chord_tolerance": 1.0, "angle_tolerance": np.radians(5)}
MESHES = {"binary.stl": binary_stl, "text.stl": text_stl, "mesh.obj": obj, "mesh.off": off, "text.ply": text_ply}


def growth(do: Callable[[int], object], warm: int, times: int) -> float:
    """MiB by which this process has grown after so many calls, the first ones apart."""
    for number in range(warm):
        do(number)
    before = resident()
    for number in range(warm, warm + times):
        do(number)
    return resident() - before


@pytest.mark.parametrize("name", MESHES)
def test_mesh_files_read(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(MESHES[name](MESH))
    assert growth(lambda _: meshdrape.read_mould(path), 10, 60) < 3.0


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".step", ".brep", ".py"])
def test_cad_files_read(tmp_path, suffix):
    """Open CASCADE keeps some of what it has read; here it keeps it in a process that ends."""
    path = CAD / "cube_corner.py" if suffix == ".py" else SAMPLES / "cube_corner.step"
    if suffix == ".brep":
        import cadquery as cq

        path = tmp_path / "top.brep"
        cq.Workplane().box(30, 20, 10).faces(">Z").val().exportBrep(str(path))
    assert growth(lambda _: meshdrape.read_mould(path, **COARSE), 5, 25) < 2.0


def test_nets_measured_written_and_read(tmp_path):
    net = meshdrape.drape(MESH.mould(), meshdrape.Fabric(4.0))

    def round_trip(_: int) -> None:
        measures = meshdrape.measure(net)
        meshdrape.write_ply(net, tmp_path / "net.ply", measures)
        assert meshdrape.read_net(tmp_path / "net.ply").sealed

    assert growth(round_trip, 10, 60) < 5.0
    assert [path.name for path in tmp_path.iterdir()] == ["net.ply"]


def test_the_process_that_libigl_runs_in():
    """Its own memory, asked thousands of times; of files kept open there are as many as before."""
    mesh = bumpy(0, n=6)
    targets = np.arange(1, 9)

    def ask(number: int) -> None:
        found = solve_guarded(mesh.vertices, mesh.triangles, number % len(mesh.vertices), targets)
        assert np.isfinite(found).all()

    def there() -> float:
        assert _SOLVER._process is not None
        status = Path(f"/proc/{_SOLVER._process.pid}/status").read_text()
        return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")) / 1024

    for number in range(300):
        ask(number)
    before, here, files = there(), resident(), len(list(Path("/proc/self/fd").iterdir()))
    for number in range(3000):
        ask(number)
    assert there() - before < 3.0
    assert resident() - here < 3.0
    assert len(list(Path("/proc/self/fd").iterdir())) == files
