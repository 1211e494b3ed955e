"""Files damaged in every way: exit 2 and one line, or a right result. No traceback, no hang, no memory without end."""

import resource
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from damage import DAMAGE
from meshfiles import binary_ply, binary_stl, obj, off, text_ply, text_stl
from moulds import bumpy

import meshdrape
from meshdrape.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
MESH = bumpy(1, n=4)
CAD_DAMAGE = ("truncated", "truncated_near_the_end", "flipped", "cut_out", "noise", "zeros", "another_code", "nested")
SECONDS = 40.0
MORE_MEMORY = 600  # MiB


def net_ply(folder: Path) -> bytes:
    net = meshdrape.drape(MESH.mould(), meshdrape.Fabric(30.0))
    meshdrape.write_ply(net, folder / "net.ply")
    return (folder / "net.ply").read_bytes()


def brep(folder: Path) -> bytes:
    import cadquery

    cadquery.Workplane().box(30, 20, 10).faces(">Z").val().exportBrep(str(folder / "top.brep"))
    return (folder / "top.brep").read_bytes()


MESHES: dict[str, Callable[[], bytes]] = {
    "binary.stl": lambda: binary_stl(MESH),
    "text.stl": lambda: text_stl(MESH),
    "mesh.obj": lambda: obj(MESH),
    "mesh.off": lambda: off(MESH),
    "text.ply": lambda: text_ply(MESH),
    "little.ply": lambda: binary_ply(MESH),
    "big.ply": lambda: binary_ply(MESH, ">"),
}


def inspected(path: Path, capfd: pytest.CaptureFixture[str]) -> int:
    """The exit code of inspecting a file, after what it printed has been looked at."""
    capfd.readouterr()
    begun = time.perf_counter()
    code = main(["inspect", str(path), "--json"])
    out, err = capfd.readouterr()
    assert time.perf_counter() - begun < SECONDS
    assert code in (0, 2)
    if code:
        # what can be told of a mesh that is read but cannot be draped is told all the same
        assert out == "" or '"faults"' in out
        assert err.count("\n") == 1
        assert err.startswith("meshdrape: ")
        assert path.name in err
        assert len(err) < 400 + 2 * len(str(path))
    else:
        assert err == ""
        assert out.startswith("{")
    return code


def peak() -> float:
    """Most memory this process ever had, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("name", MESHES)
def test_mesh_file(capfd, tmp_path, name, damage):
    whole = MESHES[name]()
    rng = np.random.default_rng([sorted(MESHES).index(name), sorted(DAMAGE).index(damage)])
    before = peak()
    path = tmp_path / f"damaged.{name.rpartition('.')[2]}"
    codes = []
    for _ in range(4):
        path.write_bytes(DAMAGE[damage](whole, rng))
        codes.append(inspected(path, capfd))
    if damage.startswith("truncated") and name not in ("mesh.obj", "text.stl"):
        # neither of those two says how much there is to come
        assert codes.count(2) > 2
    assert peak() < before + MORE_MEMORY


def test_whole_files_are_read(capfd, tmp_path):
    for name, make in MESHES.items():
        path = tmp_path / name
        path.write_bytes(make())
        assert inspected(path, capfd) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["cylinder.step", "top.brep", "cylinder.py"])
def test_cad_file(capfd, tmp_path, name):
    """A process is forked for each file, so that Open CASCADE may crash in it."""
    if name.endswith(".brep"):
        whole = brep(tmp_path)
    else:
        whole = (ROOT / ("samples" if name.endswith(".step") else "cad") / name).read_bytes()
    path = tmp_path / f"damaged{Path(name).suffix}"
    path.write_bytes(whole)
    assert inspected(path, capfd) == 0
    before = peak()
    refused = 0
    for number, damage in enumerate(CAD_DAMAGE):
        path.write_bytes(DAMAGE[damage](whole, np.random.default_rng(number)))
        refused += inspected(path, capfd) == 2
    assert refused > 3
    assert peak() < before + MORE_MEMORY


def test_script_nested_too_deeply(capfd, tmp_path):
    path = tmp_path / "deep.py"
    for text in ("(" * 100_000, "-" * 100_000 + "1", "x = " + "1 + " * 100_000 + "1", "\0" * 9):
        path.write_text(text)
        assert inspected(path, capfd) == 2


@pytest.mark.parametrize("damage", DAMAGE)
def test_net_file(tmp_path, damage):
    """A net that is read all the same has what it says: arrays of one shape, places where the statuses say."""
    whole = net_ply(tmp_path)
    rng = np.random.default_rng(sorted(DAMAGE).index(damage))
    path = tmp_path / "damaged.ply"
    before = peak()
    for _ in range(12):
        path.write_bytes(DAMAGE[damage](whole, rng))
        begun = time.perf_counter()
        message, net = "", None
        try:
            net = meshdrape.read_net(path)
        except meshdrape.MeshdrapeError as error:
            message = str(error)
        assert "\n" not in message
        assert len(message) < 400 + 2 * len(str(path))
        if net is not None:
            assert net.node_position.shape == (*net.node_status.shape, 3)
            assert net.cell_shear.shape == tuple(n - 1 for n in net.node_status.shape)
        assert time.perf_counter() - begun < SECONDS
    assert peak() < before + MORE_MEMORY
