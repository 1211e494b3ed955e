"""Files are there whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from meshdrape.errors import FileError
from meshdrape.output import files
from meshdrape.output.files import atomic_write


def test_the_file_appears_only_when_the_block_ends(tmp_path):
    path = tmp_path / "net.ply"
    with atomic_write(path) as file:
        file.write(b"whole")
        assert not path.exists()
    assert path.read_bytes() == b"whole"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, RuntimeError, SystemExit])
def test_whatever_ends_the_block_early_leaves_the_folder_as_it_was(tmp_path, interruption):
    path = tmp_path / "net.ply"
    path.write_bytes(b"before")

    def write():
        with atomic_write(path) as file:
            file.write(b"half")
            raise interruption

    with pytest.raises(interruption):
        write()
    assert path.read_bytes() == b"before"
    assert list(tmp_path.iterdir()) == [path]


def test_the_permissions_are_those_of_any_new_file(tmp_path):
    mask = os.umask(0o022)
    try:
        with atomic_write(tmp_path / "a") as file:
            file.write(b"x")
    finally:
        os.umask(mask)
    assert (tmp_path / "a").stat().st_mode & 0o777 == 0o644


def test_a_link_is_followed(tmp_path):
    (tmp_path / "real").write_bytes(b"old")
    (tmp_path / "link").symlink_to("real")
    with atomic_write(tmp_path / "link") as file:
        file.write(b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_bytes() == b"new"


def left_behind(folder, name="net.ply", digits="0123abcd"):
    path = folder / f".{name}.{digits}.part"
    path.write_bytes(b"half")
    return path


def test_what_a_killed_process_left_is_swept_by_the_next_that_writes_there(tmp_path):
    left_behind(tmp_path)
    left_behind(tmp_path, digits="ffffffff")
    others = [
        left_behind(tmp_path, "net.json"),
        left_behind(tmp_path, "a.net.ply"),
        left_behind(tmp_path, digits="0123abcdef"),
        left_behind(tmp_path, "netXply"),
    ]
    with atomic_write(tmp_path / "net.ply") as file:
        file.write(b"whole")
    assert sorted(tmp_path.iterdir()) == sorted([*others, tmp_path / "net.ply"])


def test_what_another_process_still_writes_is_left_to_it(tmp_path):
    path = tmp_path / "net.ply"
    with atomic_write(path) as one:
        one.write(b"one")
        with atomic_write(path) as other:
            other.write(b"other")
        assert path.read_bytes() == b"other"
        assert len(list(tmp_path.iterdir())) == 2
    assert path.read_bytes() == b"one"
    assert list(tmp_path.iterdir()) == [path]


def test_a_part_swept_before_it_was_locked_is_begun_anew(tmp_path, monkeypatch):
    lock, swept = files.fcntl.flock, []

    def late(file, how):
        if not swept:
            swept.extend(tmp_path.iterdir())
            swept[0].unlink()
        lock(file, how)

    monkeypatch.setattr(files.fcntl, "flock", late)
    with atomic_write(tmp_path / "net.ply") as file:
        file.write(b"whole")
    assert len(swept) == 1
    assert (tmp_path / "net.ply").read_bytes() == b"whole"
    assert list(tmp_path.iterdir()) == [tmp_path / "net.ply"]


def test_names_that_no_file_can_have(tmp_path):
    assert "File name too long" in refusal(tmp_path / ("a" * 300))
    # the name itself would do, the hidden one beside it is longer
    assert "File name too long; choose another name" in refusal(tmp_path / ("a" * 250))
    (tmp_path / "ring").symlink_to("ring")
    assert "symbolic links" in refusal(tmp_path / "ring")
    assert [path.name for path in tmp_path.iterdir()] == ["ring"]


def refusal(path):
    with pytest.raises(FileError) as caught, atomic_write(path):
        pass
    message = str(caught.value)
    assert str(path) in message
    assert "\n" not in message
    return message


def test_a_missing_folder_is_named(tmp_path):
    message = refusal(tmp_path / "no" / "net.ply")
    assert f"the folder {tmp_path / 'no'} does not exist; create it" in message


def test_a_folder_is_no_file(tmp_path):
    assert "it is a folder" in refusal(tmp_path)


def test_a_device_is_left_alone():
    assert "not a regular file" in refusal("/dev/null")
    assert Path("/dev/null").is_char_device()


def test_a_folder_that_cannot_be_written_to_is_named(tmp_path, monkeypatch):
    def forbidden(*_):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "open", forbidden)
    assert f"the folder {tmp_path} is not writable" in refusal(tmp_path / "net.ply")


def test_a_full_disk_is_an_error_of_the_file_and_leaves_nothing(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert "No space left on device; free some space" in refusal(tmp_path / "net.ply")
    assert not list(tmp_path.iterdir())
