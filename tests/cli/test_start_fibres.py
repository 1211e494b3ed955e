"""Start fibres at the command line: turns in degrees, curves from files, and what is written of them."""

import numpy as np
import pytest
from command import draped, run
from meshfiles import binary_stl
from moulds import grid, wing_spar

import meshdrape
from meshdrape.mould.formats.points import read_points

WING = wing_spar(lambda t: 0 * t, lambda t: 0.12 * t, np.array([-700.0, 2000.0]), 900, 900)
START = ("--seed", "420,0,0", "--direction", "0,1,0", "--spacing", "40")
CURVE = np.array([[200.0, 30.0, 0.0], [600.0, 90.0, 0.0], [800.0, 300.0, 0.0]])


@pytest.fixture
def wing(tmp_path):
    path = tmp_path / "wing.stl"
    path.write_bytes(binary_stl(WING))
    return path


def test_turn_in_degrees_is_the_turn_of_drape(wing, tmp_path, capfd):
    summary = draped(capfd, wing, tmp_path / "net.ply", *START, "--weft-turn-deg", "-7.5")
    assert summary["start_fibres"]["weft"] == {"turn_deg": pytest.approx(-7.5), "path_points": None}
    assert summary["start_fibres"]["warp"] == {"turn_deg": None, "path_points": None}
    stored = meshdrape.read_net(tmp_path / "net.ply")
    same = meshdrape.drape(
        meshdrape.read_mould(wing), meshdrape.Fabric(40.0), (420, 0, 0), (0, 1, 0), weft_turn=np.radians(-7.5)
    )
    assert np.array_equal(stored.node_position, same.node_position, equal_nan=True)
    assert stored.start_fibres.turns == (None, np.radians(-7.5))
    assert stored.start_fibres.paths == (None, None)


@pytest.mark.parametrize("family", ["warp", "weft"])
def test_path_from_a_file_is_the_path_of_drape(wing, tmp_path, capfd, family):
    file = tmp_path / "fibre.csv"
    file.write_text("x, y, z\n# along the wing\n" + "\n".join(", ".join(map(str, p)) for p in CURVE.tolist()) + "\n\n")
    summary = draped(capfd, wing, tmp_path / "net.ply", "--spacing", "40", f"--{family}-path", file)
    assert summary["start_fibres"][family] == {"turn_deg": None, "path_points": 3}
    stored = meshdrape.read_net(tmp_path / "net.ply")
    same = meshdrape.drape(meshdrape.read_mould(wing), meshdrape.Fabric(40.0), **{f"{family}_path": CURVE})
    assert np.array_equal(stored.node_position, same.node_position, equal_nan=True)
    assert np.array_equal(stored.start_fibres.paths[("warp", "weft").index(family)], CURVE)
    # laid again from what the file holds
    given = stored.start_fibres
    again = meshdrape.drape(
        meshdrape.read_mould(wing), stored.fabric, stored.seed, stored.direction,
        warp_path=given.warp_path, weft_path=given.weft_path,
    )  # fmt: skip
    assert again.node_position == pytest.approx(stored.node_position, abs=1e-6, nan_ok=True)


def test_the_report_speaks_of_them_and_of_straight_ones_not(wing, tmp_path, capfd):
    file = tmp_path / "fibre.txt"
    np.savetxt(file, [[420, -300, 0], [420, 0, 0], [500, 600, 0]])
    options = ("drape", wing, "-o", tmp_path / "net.ply", "--no-picture", *START)
    bent = run(capfd, *options[:-6], "--spacing", "40", "--warp-path", file, "--weft-turn-deg", "3")
    assert bent.code == 0
    assert "warp fibre  drawn through 3 points" in bent.out
    assert "weft fibre  turned by 3 deg at the crease" in bent.out
    plain = run(capfd, *options)
    assert plain.code == 0
    assert "fibre  " not in plain.out


def test_long_path_survives_the_header(tmp_path, capfd):
    mould = tmp_path / "flat.stl"
    side = np.linspace(0, 100, 5)
    mould.write_bytes(binary_stl(grid(side, side, lambda x, y: (x, y, 0))))
    s = np.linspace(5, 95, 500)
    curve = np.stack([s, 50 + 6 * np.sin(s / 25), 0 * s], axis=1)
    np.savetxt(tmp_path / "curve.txt", curve)
    draped(capfd, mould, tmp_path / "net.ply", "--spacing", "5", "--warp-path", tmp_path / "curve.txt")
    assert meshdrape.read_net(tmp_path / "net.ply").start_fibres.warp_path == pytest.approx(curve, abs=1e-12)


# --- files of points -------------------------------------------------------------------------------------------------

FILES = {
    "blanks.txt": "0 0 0\n  1.5\t2e1   -3\n",
    "commas.csv": "0,0,0\n1.5, 20, -3\n",
    "semicolons.csv": "0;0;0\r\n1.5;20;-3\r\n",
    "comments.txt": "# a fibre\n\n0 0 0 # its begin\n1.5 20 -3\n",
    "header.csv": "X,Y,Z\n0,0,0\n1.5,20,-3\n",
    "line.obj": "# made by hand\no fibre\nv 1.5 20 -3\nv 9 9 9\nv 0 0 0\nl 3 1\n",
    "back.obj": "v 1.5 20 -3\nv 0 0 0\nl -1 -2\n",
    "points.obj": "v 0 0 0\nv 1.5 20 -3\n",
    "marked.txt": "\ufeff0 0 0\n1.5 20 -3\n",
}


@pytest.mark.parametrize("name", FILES)
def test_points_are_read_in_their_order(tmp_path, name):
    (tmp_path / name).write_text(FILES[name], encoding="utf-8")
    assert np.array_equal(read_points(tmp_path / name), [[0, 0, 0], [1.5, 20, -3]])


BAD = {
    "word.txt": ("0 0 0\n1 two 3\n", "word.txt, line 2: '1 two 3' is no point"),
    "plane.csv": ("# x y\n0,0\n1,1\n", "plane.csv, line 2: '0 0' is no point"),
    "nan.txt": ("0 0 0\n1 nan 3\n", "nan.txt, line 2"),
    "one.txt": ("0 0 0\n", "has 1 points"),
    "empty.txt": ("", "is empty; export the curve anew"),
    "beyond.obj": ("v 0 0 0\nv 1 1 1\nl 1 3\n", "beyond.obj, line 3: l 1 3"),
    "zero.obj": ("v 0 0 0\nv 1 1 1\nl 0 1\n", "zero.obj, line 3"),
    "short.obj": ("v 0 0\nv 1 1 1\n", "short.obj, line 1"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_file_is_named_with_its_line(wing, tmp_path, capfd, name):
    text, message = BAD[name]
    (tmp_path / name).write_text(text)
    outcome = run(capfd, "drape", wing, "-o", tmp_path / "net.ply", *START, "--warp-path", tmp_path / name)
    assert outcome.code == 2
    assert message in outcome.err
    assert outcome.err.count("\n") == 1
    assert not (tmp_path / "net.ply").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--weft-turn-deg", "steep"), "'steep' is not an angle in degrees"),
        (("--warp-turn-deg", "10"), "the warp meets no crease to turn at"),
        (("--warp-path", "missing.txt"), "missing.txt does not exist; check the path"),
        (("--warp-path", "binary.txt"), "binary.txt cannot be read: it is not text"),
    ],
)
def test_refused_in_one_line(wing, tmp_path, capfd, monkeypatch, options, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "binary.txt").write_bytes(bytes(range(256)))
    outcome = run(capfd, "drape", wing, "-o", tmp_path / "net.ply", *START, *options)
    assert outcome.code == 2
    assert message in outcome.err
    assert "Traceback" not in outcome.err
    assert not (tmp_path / "net.ply").exists()
