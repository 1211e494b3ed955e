"""PLY files of any properties, written and read back."""

import numpy as np
import pytest

from meshdrape.errors import FileError
from meshdrape.output.ply.comments import from_comments, to_comments
from meshdrape.output.ply.reader import read_ply
from meshdrape.output.ply.writer import Element, ply_writer

POINT = np.dtype([("x", "f8"), ("flag", "u1"), ("weights", "f4", (3,)), ("n", "i4")])
FACE = np.dtype([("vertex_indices", "i4", (4,)), ("quality", "f4")])


@pytest.fixture
def file(tmp_path):
    """A file of 1000 points and 10 faces, with their rows."""
    random = np.random.default_rng(5)
    points, faces, nothing = (
        Element("vertex", 1000, POINT),
        Element("face", 10, FACE),
        Element("edge", 0, FACE),
    )
    point_rows, face_rows = points.rows(1000), faces.rows(10)
    for name in POINT.names:
        shape = point_rows[name].shape
        point_rows[name] = random.integers(0, 200, shape) if name in ("flag", "n") else random.normal(size=shape)
    face_rows["vertex_indices"] = random.integers(0, 1000, (10, 4))
    path = tmp_path / "file.ply"
    with ply_writer(path, [points, nothing, faces], ["first comment", " and  spaces "]) as ply:
        for start in range(0, 1000, 300):
            ply.write("vertex", point_rows[start : start + 300])
        ply.write("face", face_rows)
    return path, point_rows, face_rows


def test_what_was_written_comes_back_bit_for_bit(file):
    path, points, faces = file
    ply = read_ply(path)
    assert ply.comments == ("first comment", " and  spaces ")
    assert list(ply.elements) == ["vertex", "edge", "face"]
    assert ply.elements["vertex"].tobytes() == points.tobytes()
    assert ply.elements["face"]["vertex_indices"].tolist() == faces["vertex_indices"].tolist()
    assert len(ply.elements["edge"]) == 0


def test_the_header_is_plain(file):
    header = file[0].read_bytes().split(b"end_header\n")[0].decode()
    assert header.startswith("ply\nformat binary_little_endian 1.0\ncomment first comment\n")
    assert "element vertex 1000\nproperty double x\nproperty uchar flag\nproperty list uchar float weights\n" in header
    assert "property list uchar int vertex_indices\nproperty float quality\n" in header


def test_big_endian_and_any_order_of_properties_are_read(tmp_path):
    rows = np.zeros(3, dtype=[("z", ">f4"), ("length", ">u2"), ("vertex_indices", ">i4", (2,)), ("x", ">f8")])
    rows["z"], rows["x"], rows["length"], rows["vertex_indices"] = (
        [1, 2, 3],
        [1 / 3, 2, 3],
        2,
        [[1, 2], [3, 4], [5, 6]],
    )
    header = "ply\r\nformat binary_big_endian 1.0\r\nobj_info hello\r\nelement thing 3\r\nproperty float32 z\r\n"
    header += "property list ushort int32 vertex_indices\r\nproperty double x\r\nend_header\r\n"
    path = tmp_path / "big.ply"
    path.write_bytes(header.encode() + rows.tobytes())
    thing = read_ply(path).elements["thing"]
    assert thing["x"].tolist() == [1 / 3, 2, 3]
    assert thing["z"].tolist() == [1, 2, 3]
    assert thing["vertex_indices"].tolist() == [[1, 2], [3, 4], [5, 6]]


def refused(path):
    with pytest.raises(FileError) as caught:
        read_ply(path)
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    return message


def test_every_truncation_is_told(file):
    path = file[0]
    whole = path.read_bytes()
    for length in [0, 1, 3, 50, 200, *range(300, len(whole), 1777), len(whole) - 1]:
        path.write_bytes(whole[:length])
        refused(path)
    path.write_bytes(whole[:-1])
    assert "truncated: at least 1 bytes are missing" in refused(path)


def test_bytes_too_many_are_told(file):
    path = file[0]
    path.write_bytes(path.read_bytes() + b"\n")
    assert "goes on for 1 bytes" in refused(path)


def test_noise_is_told(tmp_path):
    random = np.random.default_rng(3)
    for start in (b"", b"ply\n", b"ply\nformat binary_little_endian 1.0\n"):
        path = tmp_path / "noise.ply"
        path.write_bytes(start + random.bytes(200_000))
        refused(path)


@pytest.mark.parametrize(
    "header",
    [
        "format ascii 1.0\nelement vertex 1\nproperty float x",
        "format binary_little_endian 2.0",
        "element vertex 1\nproperty float x",
        "format binary_little_endian 1.0\nproperty float x",
        "format binary_little_endian 1.0\nelement vertex -1",
        "format binary_little_endian 1.0\nelement vertex 99999999999999999999\nproperty float x",
        "format binary_little_endian 1.0\nelement vertex 1\nproperty quaternion x",
        "format binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float x",
        "format binary_little_endian 1.0\nelement face 1\nproperty list float int vertex_indices",
    ],
)
def test_headers_that_make_no_sense_are_told(tmp_path, header):
    path = tmp_path / "file.ply"
    path.write_bytes(f"ply\n{header}\nend_header\n".encode())
    refused(path)


def test_lists_of_differing_lengths_are_told(file):
    path, _, faces = file
    whole = bytearray(path.read_bytes())
    whole[-faces.itemsize] = 3
    path.write_bytes(whole)
    assert "the lists vertex_indices differ in length" in refused(path)


def test_missing_files_and_folders_are_told(tmp_path):
    assert "does not exist" in refused(tmp_path / "no.ply")
    assert "is a directory" in refused(tmp_path)


def test_a_writer_that_stops_early_leaves_nothing(tmp_path):
    points = Element("vertex", 10, POINT)

    def write(n_rows):
        with ply_writer(tmp_path / "file.ply", [points]) as ply:
            ply.write("vertex", points.rows(n_rows))

    with pytest.raises(ValueError, match="announced and not written: 3 of vertex"):
        write(7)
    with pytest.raises(ValueError, match="11 rows of vertex do not fit"):
        write(11)
    assert not list(tmp_path.iterdir())


def test_comments_hold_values_exactly_and_stay_short():
    values = {
        "spacing": [0.1 + 0.2, 1e-300],
        "file": "Flügel\n 1  .step" + " " * 300,
        "none": None,
        "ids": list(range(2000)),
    }
    comments = to_comments(values)
    assert from_comments(comments) == values
    assert max(len(comment) for comment in comments) < 250  # MeshLab refuses longer lines than some 500
    assert all(comment.isascii() for comment in comments)
    assert "\n" not in "".join(comments)
    assert from_comments(["VCGLIB generated", "nothing"]) == {}
