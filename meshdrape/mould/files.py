"""The file a mould comes in, before anyone reads it, and what is said of one that nobody can."""

import hashlib
import os
import stat
from pathlib import Path

from meshdrape.errors import FileError


def existing_file(path: str | os.PathLike[str], what: str = "mould") -> Path:
    """Return the path of a file that is there, may be read and is not empty.

    Parameters
    ----------
    path : path
    what : str
        What it should hold, for the message.

    Raises
    ------
    FileError
        It is missing, a directory, a pipe or a device, empty or not readable.
    """
    file = Path(path)
    try:
        found = file.stat()
    except (FileNotFoundError, NotADirectoryError):
        msg = f"{file} does not exist; check the path"
        raise FileError(msg) from None
    except (OSError, ValueError) as error:  # too long a name, a ring of links, a null character
        msg = f"{file} cannot be read: {getattr(error, 'strerror', None) or error}; check the path"
        raise FileError(msg) from None
    if stat.S_ISDIR(found.st_mode):
        msg = f"{file} is a directory; give the {what} file in it"
        raise FileError(msg)
    if not stat.S_ISREG(found.st_mode):
        msg = f"{file} is a pipe or a device; write the {what} to a file first"
        raise FileError(msg)
    if not os.access(file, os.R_OK):
        msg = f"{file} may not be read; check its permissions"
        raise FileError(msg)
    if not found.st_size:
        msg = f"{file} is empty; export the {what} anew"
        raise FileError(msg)
    return file


def brief(error: object) -> str:
    """Return an error's message in one line of at most 200 characters, for it may quote the file at any length."""
    text = " ".join(str(error).split()) or "no reason given"
    return text if len(text) <= 200 else f"{text[:196]} ..."


def file_sha256(path: str | os.PathLike[str]) -> str:
    """Return the SHA-256 of a file's bytes, in hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
