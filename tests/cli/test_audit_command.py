"""meshdrape audit: what it finds in a net as written, and in one that was changed by hand."""

from __future__ import annotations

import hashlib
import json
import shutil

import numpy as np
import pytest
from command import CAD, SAMPLES, draped, run
from meshfiles import binary_stl, obj
from moulds import bumpy, holed_plate, icosphere, plate

import meshdrape
from meshdrape.output.ply.reader import read_ply


@pytest.fixture(scope="module")
def laid(tmp_path_factory):
    """A net on hills, small enough for every edge to be measured, beside its mould."""
    from meshdrape.cli.main import main

    folder = tmp_path_factory.mktemp("hills")
    (folder / "hills.obj").write_bytes(obj(bumpy(0)))
    net = folder / "net.ply"
    words = ["drape", folder / "hills.obj", "-o", net, "--spacing", "9", "--direction", "1,0.3,0"]
    assert main([str(word) for word in [*words, "--quiet", "--no-picture"]]) == 0
    return folder


@pytest.fixture
def folder(laid, tmp_path):
    """A copy of it to be spoilt."""
    return shutil.copytree(laid, tmp_path / "copy")


def audited(capfd, net, *options, code=0):
    outcome = run(capfd, "audit", net, *options, "--json")
    assert (outcome.code, outcome.err) == (code, "")
    return json.loads(outcome.out)


def change(net, element, field, row, by, *, seal=True):
    """Add to one number of a net's file, and seal the file anew, as one would who knew how."""
    rows = read_ply(net).elements[element]
    offset, dtype = rows.offset, rows.dtype
    del rows
    data = bytearray(net.read_bytes())
    at = offset + row * dtype.itemsize + dtype.fields[field][1]
    value = np.frombuffer(data, dtype=dtype[field], count=1, offset=at)[0] + by
    data[at : at + 8] = np.asarray(value, dtype=dtype[field]).tobytes()
    if seal:
        data[-32:] = hashlib.sha256(data[:-33]).digest()
    net.write_bytes(data)


def inner_node(net):
    """Row of a node on the mould, off the generators, with a neighbour on the mould on every side."""
    node = read_ply(net).elements["vertex"]
    on = {(int(i), int(j)) for i, j, status in node[["i", "j", "status"]].tolist() if status == 0}
    i0, j0 = json.loads(next(c for c in read_ply(net).comments if c.startswith("seed_index")).split(" ", 1)[1])
    for row, (i, j) in enumerate(node[["i", "j"]].tolist()):
        if i > i0 + 3 and j > j0 + 2 and {(i, j), (i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)} <= on:
            return row
    raise AssertionError


def test_a_net_as_written_holds(capfd, laid):
    outcome = run(capfd, "audit", laid / "net.ply")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines()[-1] == f"{laid / 'net.ply'} holds"
    facts = audited(capfd, laid / "net.ply")
    summary = json.loads((laid / "net.json").read_text())
    assert facts["nodes"] == summary["nodes"]
    assert facts["nodes_off_mould"] == summary["statuses"]["OFF_MOULD"]
    assert facts["audit"]["n_edges"] + facts["audit"]["n_through_vertex"] == facts["edges"]
    assert facts["audit_max_relative_error"] < 1e-9
    assert facts["edges_straight"] > 0.9 * facts["edges"]
    assert facts["edges_off_mould_unchecked"] > 0
    assert facts["balance_residual_deg"] <= summary["balance_residual_deg"] + 1e-9
    assert facts["shear_error_deg"] < 1e-8
    assert facts["cells_checked"] > 300


def test_a_sample_of_the_edges(capfd, laid):
    facts = audited(capfd, laid / "net.ply", "--edges", "20")
    assert facts["audit"]["n_edges"] + facts["audit"]["n_through_vertex"] + facts["audit"]["n_skipped"] == 20
    assert audited(capfd, laid / "net.ply", "--seconds", "1e-9")["audit"]["n_edges"] <= 1


@pytest.mark.parametrize("seal", [True, False])
def test_a_node_moved_by_a_thousandth_of_the_spacing(capfd, folder, seal):
    net = folder / "net.ply"
    change(net, "vertex", "x", inner_node(net), 9e-3, seal=seal)
    facts = audited(capfd, net, "--edges", "1", code=3)
    assert facts["unchanged_since_written"] == seal
    assert not facts["holds"]
    assert any("mm off the mould" in line or "of a spacing" in line for line in facts["failures"])


def test_a_node_moved_within_the_mould(capfd, tmp_path):
    """On a flat plate it stays on the mould: its edges give it away, whatever the sample."""
    (tmp_path / "plate.obj").write_bytes(obj(plate()))
    net = tmp_path / "net.ply"
    draped(capfd, tmp_path / "plate.obj", net, "--spacing", "9", "--direction", "1,0.3,0")
    change(net, "vertex", "x", inner_node(net), 9e-3)
    facts = audited(capfd, net, "--edges", "1", code=3)
    assert facts["off_mould_spacings"] < 1e-9
    (edge,) = (line for line in facts["failures"] if "the edge" in line)
    assert float(edge.split()[-4]) == pytest.approx(1e-3, rel=0.3)


def test_a_generator_moved_along_itself(capfd, folder):
    net = folder / "net.ply"
    node = read_ply(net).elements["vertex"]
    i0, j0 = json.loads(next(c for c in read_ply(net).comments if c.startswith("seed_index")).split(" ", 1)[1])
    row = int(np.flatnonzero((node["i"] == i0 + 4) & (node["j"] == j0))[0])
    del node
    change(net, "vertex", "y", row, 9e-3)
    assert any("generator" in line for line in audited(capfd, net, "--edges", "1", code=3)["failures"])


@pytest.mark.parametrize(
    ("field", "words"), [("shear_deg", "the shear of cell"), ("predicted_shear_deg", "the predicted shear")]
)
def test_a_column_altered(capfd, folder, field, words):
    net = folder / "net.ply"
    ply = read_ply(net)
    # a cell with all its corners on the mould
    on = ply.elements["vertex"]["status"][ply.elements["face"]["vertex_indices"]] == 0
    row = int(np.flatnonzero(on.all(axis=1))[100])
    del ply, on
    change(net, "face", field, row, 0.01)
    (failure,) = audited(capfd, net, "--edges", "1", code=3)["failures"]
    assert failure.startswith(words)
    assert failure.endswith("off by 0.01 degrees")


def test_the_mould_altered_missing_or_elsewhere(capfd, folder, tmp_path):
    net, mould = folder / "net.ply", folder / "hills.obj"
    whole = mould.read_bytes()
    mould.write_bytes(whole + b"\n")
    outcome = run(capfd, "audit", net)
    assert (outcome.code, outcome.out) == (2, "")
    assert f"{mould} is not the file {net} was laid on" in outcome.err
    assert outcome.err.count("\n") == 1
    mould.unlink()
    outcome = run(capfd, "audit", net)
    assert outcome.code == 2
    assert outcome.err == f"meshdrape: the mould of {net} is not at {mould}; say where it is with --mould FILE\n"
    (tmp_path / "elsewhere.obj").write_bytes(whole)
    assert audited(capfd, net, "--mould", tmp_path / "elsewhere.obj", "--edges", "5")["holds"]


def test_what_is_no_net(capfd, folder):
    for file, words in (
        (folder / "net.mould.ply", "is not a net that meshdrape wrote"),
        (folder / "hills.obj", "PLY"),
        (folder / "nothing.ply", "does not exist"),
    ):
        outcome = run(capfd, "audit", file)
        assert (outcome.code, outcome.out) == (2, "")
        assert words in outcome.err
        assert outcome.err.count("\n") == 1


def test_moulds_are_read_again_as_they_were(capfd, tmp_path):
    """Faces of a B-rep, tolerances, parameters of a script, a mesh in metres, its other side."""
    metres = tmp_path / "plate.stl"
    metres.write_bytes(binary_stl(holed_plate()))
    for number, words in enumerate(
        [
            (SAMPLES / "wing_spar_block.step", "--faces", "1,2", "--angle-tolerance", "1", "--spacing", "200"),
            (CAD / "cylinder.py", "--set", "radius=400", "--angle-tolerance", "2", "--chord-tolerance", "5",
             "--spacing", "50"),
            (metres, "--unit", "m", "--spacing", "7000"),
            (metres, "--flip-normal", "--spacing", "7", "--seed=-45,-31,0"),
            (SAMPLES / "cube_corner.step", "--seed", "0,0,0", "--direction=-1,-0.4,0", "--spacing", "90"),
        ]
    ):  # fmt: skip
        net = tmp_path / f"{number}.ply"
        draped(capfd, words[0], net, *words[1:])
        facts = audited(capfd, net, "--edges", "40")
        assert facts["holds"], facts["failures"]
        assert facts["edges_straight"] > 100


def test_edges_that_bend_at_a_saddle_are_left_to_libigl(capfd, tmp_path):
    (tmp_path / "hills.obj").write_bytes(obj(bumpy(1)))
    net = tmp_path / "net.ply"
    words = ("--spacing", "11,4", "--seed=-13,25,0", "--direction", "0.2,1,0", "--quiet", "--no-picture")
    assert run(capfd, "drape", tmp_path / "hills.obj", "-o", net, *words).err == ""
    facts = audited(capfd, net, "--edges", "50")
    assert facts["holds"]
    on = meshdrape.read_net(net).node_status == meshdrape.NodeStatus.PLACED
    i0, j0 = meshdrape.read_net(net).seed_index
    generators = sum(int(np.count_nonzero(row[1:] & row[:-1])) for row in (on[:, j0], on[i0]))
    assert facts["edges_straight"] < facts["edges"] - generators


def test_a_closed_mould(capfd, tmp_path):
    (tmp_path / "ball.obj").write_bytes(obj(icosphere(3)))
    net = tmp_path / "net.ply"
    run(capfd, "drape", tmp_path / "ball.obj", "-o", net, "--spacing", "100", "--quiet", "--no-picture",
        "--extent", "500,500,500,500")  # fmt: skip
    facts = audited(capfd, net, "--edges", "50")
    assert facts["holds"]
    assert facts["edges_off_mould_unchecked"] == 0


def test_noise_in_the_file_never_passes_and_never_breaks(capfd, folder):
    """Bytes changed at random, and the file sealed anew: one line of error, or a net that does not hold."""
    net = folder / "net.ply"
    whole = net.read_bytes()
    header = whole.index(b"end_header")
    random = np.random.default_rng(3)
    codes = []
    for trial in range(60):
        data = bytearray(whole)
        # half of them in the header, where mould, fabric and seed stand
        low, high = (0, header) if trial % 2 else (header, len(whole) - 33)
        for at in random.integers(low, high, 3 if trial % 2 else 40):
            data[at] = random.integers(256)
        data[-32:] = hashlib.sha256(data[:-33]).digest()
        net.write_bytes(data)
        outcome = run(capfd, "audit", net, "--edges", "3")
        assert outcome.code in (0, 2, 3)
        assert outcome.err.count("\n") == (outcome.code == 2)
        assert "Traceback" not in outcome.err
        codes.append(outcome.code)
        # colours, versions and the like are not the net; everything else is
        if outcome.code == 0:
            assert trial % 2
    assert 2 in codes


def test_a_fibre_and_no_more(capfd, tmp_path):
    """A net of a single row has no cells to check."""
    (tmp_path / "plate.obj").write_bytes(obj(plate()))
    net = tmp_path / "net.ply"
    run(capfd, "drape", tmp_path / "plate.obj", "-o", net, "--spacing", "9", "--extent", "0,0,40,40",
        "--quiet", "--no-picture")  # fmt: skip
    facts = audited(capfd, net)
    assert facts["holds"]
    assert (facts["nodes"], facts["cells_checked"]) == (9, 0)
