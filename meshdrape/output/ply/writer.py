"""PLY files with named properties, written block by block.

A row of an element is a row of a numpy structured array; a field of shape (k,) is a list property whose lists
all have k entries. Doubles stay doubles and every property is kept, which the PLY writers and readers of the
usual mesh libraries do not do. The reader is in :mod:`meshdrape.output.ply.reader`.
"""

import hashlib
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.files import atomic_write

Rows = NDArray[np.void]

_MOST_WAITING: Final = 4  # blocks whose digest is still to be taken

_TYPE_NAME: Final = {
    "i1": "char",
    "u1": "uchar",
    "i2": "short",
    "u2": "ushort",
    "i4": "int",
    "u4": "uint",
    "f4": "float",
    "f8": "double",
}


@dataclass(frozen=True)
class Element:
    """An element of a PLY file to be written: its name, how many rows it has and what a row holds.

    The fields of `row` become the properties, in their order; a field of shape (k,) becomes a list.
    """

    name: str
    count: int
    row: np.dtype[Any]

    def rows(self, n_rows: int) -> Rows:
        """Return `n_rows` rows to be filled, shape (n_rows,), zero but for the lengths of the lists."""
        rows = np.zeros(n_rows, dtype=self._packed())
        for name, kind in _fields(self.row):
            if kind.shape:
                rows[f"{name} length"] = kind.shape[0]
        return rows

    def header(self) -> str:
        """Return the element's lines of the header."""
        lines = [f"element {self.name} {self.count}\n"]
        for name, kind in _fields(self.row):
            prefix = "list uchar " if kind.shape else ""
            lines.append(f"property {prefix}{_TYPE_NAME[kind.base.str[1:]]} {name}\n")
        return "".join(lines)

    def _packed(self) -> np.dtype[Any]:
        """Return the row as the file holds it: little endian, no gaps, each list after its length."""
        packed: list[tuple[Any, ...]] = []
        for name, kind in _fields(self.row):
            if kind.shape:  # a name no property can have: PLY's names have no space
                packed.append((f"{name} length", "u1"))
            packed.append((name, kind.base.newbyteorder("<"), kind.shape))
        return np.dtype(packed)


def _fields(row: np.dtype[Any]) -> list[tuple[str, np.dtype[Any]]]:
    return [(name, row[name]) for name in row.names or ()]


class PlyWriter:
    """Rows on their way into a PLY file, element by element in the order of the header.

    Rows that were handed over must not be changed afterwards.
    """

    def __init__(self, file: BinaryIO, elements: Sequence[Element], comments: Sequence[str] = ()) -> None:
        self._file = file
        self._digest = hashlib.sha256()
        self._worker = ThreadPoolExecutor(1)
        self._digested: list[Future[None]] = []
        self._expected = [(element.name, element.count) for element in elements]
        header = "".join(f"comment {comment}\n" for comment in comments)
        header += "".join(element.header() for element in elements)
        self._put(f"ply\nformat binary_little_endian 1.0\n{header}end_header\n".encode("ascii"))

    def _put(self, data: bytes | memoryview) -> None:
        # beside the writing: a digest of a gigabyte takes as long as the gigabyte
        self._digested.append(self._worker.submit(self._digest.update, data))
        self._file.write(data)
        while len(self._digested) > _MOST_WAITING:
            self._digested.pop(0).result()

    def digest(self) -> bytes:
        """Return the SHA-256 of all bytes written so far."""
        while self._digested:
            self._digested.pop(0).result()
        return self._digest.digest()

    def close(self) -> None:
        """Let go of the thread that takes the digest."""
        self._worker.shutdown()

    def write(self, name: str, rows: Rows) -> None:
        """Append rows, made by `Element.rows`, to the element called `name`.

        Raises
        ------
        ValueError
            The element before is not complete, or this one would get more rows than announced.
        """
        while self._expected and self._expected[0][1] == 0 and self._expected[0][0] != name:
            self._expected.pop(0)
        if not self._expected or self._expected[0][0] != name or len(rows) > self._expected[0][1]:
            msg = f"{len(rows)} rows of {name} do not fit where {self._expected[:1]} are expected"
            raise ValueError(msg)
        self._expected[0] = (name, self._expected[0][1] - len(rows))
        self._put(rows.data)

    def check_complete(self) -> None:
        """Raise ValueError if rows that the header announces were not written."""
        missing = [f"{count} of {name}" for name, count in self._expected if count]
        if missing:
            msg = f"rows announced and not written: {', '.join(missing)}"
            raise ValueError(msg)


@contextmanager
def ply_writer(
    path: str | os.PathLike[str], elements: Sequence[Element], comments: Sequence[str] = ()
) -> Iterator[PlyWriter]:
    """Write a binary little-endian PLY file that is there whole or not at all.

    Parameters
    ----------
    path : path-like
        The file.
    elements : sequence of Element
        What is written, in this order. The counts must be right: the header comes first.
    comments : sequence of str
        Lines of ASCII text for the header.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    with atomic_write(path) as file:
        writer = PlyWriter(file, elements, comments)
        try:
            yield writer
            writer.check_complete()
        finally:
            writer.close()
