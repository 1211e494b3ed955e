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
from meshdrape.mould.formats.points import read_points
from meshdrape.study.fold.design import read_design

ROOT = Path(__file__).resolve().parents[2]
CAD, SAMPLES = ROOT / "cad", ROOT / "samples"
MESH = bumpy(1, n=4)
SECONDS = 40.0
MORE_MEMORY = 600  # MiB


def net_ply(folder: Path) -> bytes:
    net = meshdrape.drape(MESH.mould(), meshdrape.Fabric(30.0))
    meshdrape.write_ply(net, folder / "net.ply")
    return (folder / "net.ply").read_bytes()


MESHES: dict[str, Callable[[], bytes]] = {
    "binary.stl": lambda: binary_stl(MESH),
    "text.stl": lambda: text_stl(MESH),
    "mesh.obj": lambda: obj(MESH),
    "mesh.off": lambda: off(MESH),
    "text.ply": lambda: text_ply(MESH),
    "little.ply": lambda: binary_ply(MESH),
    "big.ply": lambda: binary_ply(MESH, ">"),
}


def inspected(path: Path, capfd: pytest.CaptureFixture[str], *options: str) -> int:
    """The exit code of inspecting a file, after what it printed has been looked at."""
    capfd.readouterr()
    begun = time.perf_counter()
    code = main(["inspect", str(path), "--json", *options])
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


def cad_files(folder: Path, suffix: str) -> list[bytes]:
    """A plane, a cylinder and a free-form face as STEP or BREP; a script of ours and a small one."""
    import cadquery as cq

    if suffix == ".py":
        box = b"import cadquery as cq\n\nlength = 90.0\nshow_object(cq.Workplane().box(length, 8, 20).faces('>Z'))\n"
        return [(CAD / "cylinder.py").read_bytes(), box]
    waves = [[cq.Vector(x, y, 3 * np.sin(x / 9) * np.cos(y / 7)) for y in (0, 10, 20, 30)] for x in (0, 20, 40, 60)]
    faces = [
        cq.Workplane().box(30, 20, 10).faces(">Z").val(),
        cq.Workplane().circle(20).extrude(30).faces("%CYLINDER").val(),
        cq.Face.makeSplineApprox(waves),
    ]
    contents = []
    for face in faces:
        path = folder / f"face{suffix}"
        if suffix == ".step":
            cq.exporters.export(cq.Workplane(face), str(path))
        else:
            face.exportBrep(str(path))
        contents.append(path.read_bytes())
    return contents


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".step", ".brep", ".py"])
def test_cad_file(capfd, tmp_path, suffix):
    """Open CASCADE may crash, hang or take all memory: it does so in a process of its own."""
    wholes = cad_files(tmp_path, suffix)
    path = tmp_path / f"damaged{suffix}"
    coarse = ("--angle-tolerance", "5", "--chord-tolerance", "1")
    for whole in wholes:
        path.write_bytes(whole)
        assert inspected(path, capfd, *coarse) == 0
    before = peak()
    codes = []
    for number, damage in enumerate(DAMAGE):
        path.write_bytes(DAMAGE[damage](wholes[number % len(wholes)], np.random.default_rng(number)))
        codes.append(inspected(path, capfd, *coarse))
    assert codes.count(2) > 5
    assert peak() < before + MORE_MEMORY


@pytest.mark.parametrize("damage", DAMAGE)
def test_design_file(tmp_path, damage):
    """A design that is read all the same is one: profiles that are numbers everywhere, of a size that wings have."""
    wholes = [path.read_bytes() for path in sorted((SAMPLES / "designs").glob("*.toml"))]
    rng = np.random.default_rng(sorted(DAMAGE).index(damage))
    path = tmp_path / "damaged.toml"
    for number in range(20):
        path.write_bytes(DAMAGE[damage](wholes[number % len(wholes)], rng))
        message = refusal(lambda: read_design(path))
        if message:
            assert path.name in message
            continue
        design = read_design(path)
        y = np.linspace(0, design.span, 11)
        assert np.isfinite([design.fold.wing(y), design.fold.spar(y)]).all()


@pytest.mark.parametrize("suffix", [".csv", ".obj"])
@pytest.mark.parametrize("damage", DAMAGE)
def test_file_of_points(tmp_path, damage, suffix):
    whole = (SAMPLES / "fibres" / "krogh_warp.csv").read_bytes()
    if suffix == ".obj":
        rows = [b"v " + line.replace(b",", b" ") for line in whole.splitlines() if line[:1] in b"0123456789-"]
        whole = b"\n".join([*rows, b"l " + b" ".join(b"%d" % (n + 1) for n in range(len(rows)))])
    rng = np.random.default_rng(sorted(DAMAGE).index(damage))
    path = tmp_path / f"damaged{suffix}"
    for _ in range(20):
        path.write_bytes(DAMAGE[damage](whole, rng))
        message = refusal(lambda: read_points(path))
        if message:
            assert path.name in message
        else:
            assert (np.abs(read_points(path)) <= 1e12).all()


def refusal(read: Callable[[], object]) -> str:
    """The one line in which what was read is refused; none if it is not."""
    message = ""
    try:
        read()
    except meshdrape.MeshdrapeError as error:
        message = str(error)
    assert message == "" or message.isprintable()
    assert len(message) < 600
    return message


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


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("direction", b"[0.5, 0.1, -3.6e+299]", ""),
        ("direction", b"[0, 0, 0]", "direction"),
        ("seed", b"[1e+300, 0, 0]", "seed [1e+300, 0.0, 0.0] is not a point within 1e+12 mm"),
        ("spacing", b"[5, 0]", "weft spacing is 0 mm"),
        ("initial_angle_rad", b"1e300", "initial angle"),
        ("locking_angle_rad", b'"wide"', "not a net that meshdrape wrote"),
        ("warp_path", b"[[0, 0, 0], [1e300, 0, 0]]", "warp_path: point 2"),
        ("warp_path", b"[[0, 0, 0], [0, 0, 400]]", "warp_path: point 2"),
    ],
)
def test_net_of_numbers_that_no_net_has(capfd, tmp_path, name, value, told):
    """What is said of it names its file, in one line; what is not refused does not hold."""
    (tmp_path / "hills.off").write_bytes(off(MESH))
    net = meshdrape.drape(meshdrape.read_mould(tmp_path / "hills.off"), meshdrape.Fabric(30.0))
    meshdrape.write_ply(net, tmp_path / "net.ply")
    head, end, rows = (tmp_path / "net.ply").read_bytes().partition(b"end_header")
    lines = [line for line in head.split(b"\n") if not line.startswith(f"comment {name} ".encode())]
    lines.insert(2, f"comment {name} ".encode() + value)
    (tmp_path / "other.ply").write_bytes(b"\n".join(lines) + end + rows)
    capfd.readouterr()
    code = main(["audit", str(tmp_path / "other.ply"), "--edges", "3"])
    out, err = capfd.readouterr()
    if told:
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert str(tmp_path / "other.ply") in err
        assert told in err
    else:
        assert (code, err) == (3, "")
        assert "does not hold" in out
