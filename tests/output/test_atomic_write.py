"""Files are there whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from meshdrape.errors import FileError
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
