"""Files that are there whole or not at all."""

import errno
import fcntl
import os
import re
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from meshdrape.errors import FileError

# what the disk, rather than the data, can have against a write
_DISK_ERRORS = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EROFS}


@contextmanager
def atomic_write(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a binary file that appears under its name when the block ends well, and never otherwise.

    The bytes go to a hidden file beside the target, `.NAME.xxxxxxxx.part`, which is renamed at the end. Whatever
    ends the block early, Ctrl-C too, removes it, and a file that stood at `path` before is left as it was. What a
    process that was killed left there is removed by the next that writes the same file.

    Parameters
    ----------
    path : path-like
        The target. A symbolic link is followed, so that the file it points to is replaced.

    Raises
    ------
    FileError
        The folder does not exist or cannot be written to, the target is a folder or a device, or the disk
        is full.
    """
    check_target(path)
    target = Path(os.path.realpath(path))
    _sweep(target)
    try:
        file, partial = _partial(target)
    except OSError as error:
        raise FileError(_refusal(path, target, error)) from None
    try:
        with file:
            yield file
        os.replace(partial, target)
    except OSError as error:
        if error.errno not in _DISK_ERRORS:
            raise
        msg = f"cannot write {path}: {error.strerror}; free some space or choose another folder"
        raise FileError(msg) from None
    finally:
        with suppress(FileNotFoundError):  # renamed, when all went well
            partial.unlink()


def _partial(target: Path) -> tuple[BinaryIO, Path]:
    """A hidden file beside the target, open for writing and locked for as long as its process lives."""
    while True:
        partial = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
        file = partial.open("xb")
        with suppress(OSError):  # a file system without locks: nothing is swept there either
            fcntl.flock(file, fcntl.LOCK_EX)
        # swept away by another before it was locked
        if os.fstat(file.fileno()).st_nlink:
            return file, partial
        file.close()


def _sweep(target: Path) -> None:
    """Remove what processes that are no more left of this file; who still writes one holds its lock."""
    ours = re.compile(rf"\.{re.escape(target.name)}\.[0-9a-f]{{8}}\.part")
    for left in target.parent.iterdir():
        if ours.fullmatch(left.name):
            with suppress(OSError), left.open("r+b") as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                left.unlink()


def check_target(path: str | os.PathLike[str]) -> None:
    """Raise FileError now if a file could not be written under this name later."""
    target = Path(os.path.realpath(path))
    try:
        target.stat()
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:  # too long a name, a ring of links
        raise FileError(_refusal(path, target, error)) from None
    if not target.parent.is_dir():
        msg = f"cannot write {path}: the folder {target.parent} does not exist; create it or choose another"
        raise FileError(msg)
    if not os.access(target.parent, os.W_OK | os.X_OK):
        raise FileError(_refusal(path, target, PermissionError()))
    if target.is_dir():
        msg = f"cannot write {path}: it is a folder; give the name of a file in it"
        raise FileError(msg)
    if target.exists() and not target.is_file():
        # renaming over a device such as /dev/null would replace the device
        msg = f"cannot write {path}: it is not a regular file; give the name of a file"
        raise FileError(msg)


def check_suffix(path: str | os.PathLike[str], suffixes: Sequence[str], what: str) -> None:
    """Raise FileError if a file's name does not end as that of `what` does: (".md",), "a page"."""
    suffix = Path(path).suffix
    if suffix.lower() not in suffixes:
        msg = f"{path} has the suffix {suffix or '(none)'}; {what} is written as {' '.join(suffixes)}"
        raise FileError(msg)


def _refusal(path: str | os.PathLike[str], target: Path, error: OSError) -> str:
    if isinstance(error, PermissionError):
        return f"cannot write {path}: the folder {target.parent} is not writable; choose another"
    return f"cannot write {path}: {error.strerror}; choose another name or folder"
