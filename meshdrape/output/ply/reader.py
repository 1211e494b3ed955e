"""Binary PLY files of any properties, read by mapping them into memory."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO, Final

import numpy as np

from meshdrape.errors import FileError
from meshdrape.mould.files import existing_file
from meshdrape.output.ply.writer import Rows

_TYPE_CODE: Final = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
_LENGTH_CODE: Final = {name: code for name, code in _TYPE_CODE.items() if code[0] != "f"}
_BYTE_ORDER: Final = {"binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_LINE: Final = 1 << 16  # bytes; noise may have no end of line
_LONGEST_HEADER: Final = 10_000  # lines
_LONGEST_LIST: Final = 255  # entries; a triangle has 3, a cell 4


@dataclass(frozen=True, eq=False)
class PlyFile:
    """The content of a PLY file: lines of comment, and rows by the name of the element.

    The rows are mapped, not loaded: they are read from the disk as they are used.
    """

    comments: tuple[str, ...]
    elements: Mapping[str, Rows]


def read_ply(path: str | os.PathLike[str]) -> PlyFile:
    """Return the content of a binary PLY file of either byte order.

    The lists of one property must all have one length, as in every file meshdrape writes; they come as
    fields of shape (k,).

    Raises
    ------
    FileError
        The file is missing, not a binary PLY, truncated, or has lists of differing lengths.
    """
    with existing_file(path, "PLY").open("rb") as file:
        header = _read_header(path, file)
        return PlyFile(tuple(header.comments), _map_elements(path, file, header))


@dataclass
class _Element:
    name: str
    count: int
    properties: dict[str, tuple[str, str]]  # type, and the type of the length where it is a list


@dataclass
class _Header:
    byte_order: str
    comments: list[str]
    elements: list[_Element]


def _read_header(path: str | os.PathLike[str], file: BinaryIO) -> _Header:
    if file.readline(_LONGEST_LINE).strip() != b"ply":
        msg = f"{path} is not a PLY file: its first line is not 'ply'; give a PLY that meshdrape wrote"
        raise FileError(msg)
    header = _Header("", [], [])
    for number in range(2, _LONGEST_HEADER):
        line = file.readline(_LONGEST_LINE).decode("utf-8", "replace").rstrip("\r\n")
        if line == "end_header" and header.byte_order:
            return header
        try:
            _take_line(header, line)
        except (ValueError, KeyError, IndexError):
            msg = f"{path}: line {number} of the PLY header is {line[:40]!r}, not PLY; write it again"
            raise FileError(msg) from None
    msg = f"{path}: the PLY header has no end in {_LONGEST_HEADER:,} lines; give a PLY that meshdrape wrote"
    raise FileError(msg)


def _take_line(header: _Header, line: str) -> None:
    """Add one line to the header; ValueError, KeyError or IndexError where it makes no sense."""
    match line.split():
        case ["format", kind, "1.0"]:
            header.byte_order = _BYTE_ORDER[kind]
        case ["comment", *_]:
            header.comments.append(line.removeprefix("comment").removeprefix(" "))
        case ["obj_info", *_]:
            pass
        case ["element", name, count] if count.isdecimal():
            header.elements.append(_Element(name, int(count), {}))
        case ["property", "list", length_kind, kind, name] if name not in header.elements[-1].properties:
            header.elements[-1].properties[name] = (_TYPE_CODE[kind], _LENGTH_CODE[length_kind])
        case ["property", kind, name] if name not in header.elements[-1].properties:
            header.elements[-1].properties[name] = (_TYPE_CODE[kind], "")
        case _:
            msg = f"not a line of a PLY header: {line}"
            raise ValueError(msg)


def _map_elements(path: str | os.PathLike[str], file: BinaryIO, header: _Header) -> dict[str, Rows]:
    start = file.tell()
    size = os.fstat(file.fileno()).st_size
    elements: dict[str, Rows] = {}
    for element in header.elements:
        row = _row(path, file, start, element, header.byte_order)
        end = start + element.count * row.itemsize
        if end > size:
            msg = f"{path} is truncated: at least {end - size:,} bytes are missing; write it again"
            raise FileError(msg)
        rows: Rows = np.zeros(0, dtype=row)  # nothing cannot be mapped
        if end > start:
            rows = np.memmap(file, dtype=row, mode="r", offset=start, shape=(element.count,))
        for name, (_, length_code) in element.properties.items():
            if length_code and (rows[f"{name} length"] != row[name].shape[0]).any():
                msg = f"{path}: the lists {name} differ in length; give a PLY that meshdrape wrote"
                raise FileError(msg)
        elements[element.name] = rows
        start = end
    if start != size:
        msg = f"{path} goes on for {size - start:,} bytes after its last element; write it again"
        raise FileError(msg)
    return elements


def _row(path: str | os.PathLike[str], file: BinaryIO, start: int, element: _Element, byte_order: str) -> np.dtype[Any]:
    """Return the dtype of an element's rows, the lengths of its lists taken from the first row."""
    fields: list[tuple[Any, ...]] = []
    for name, (code, length_code) in element.properties.items():
        if not length_code:
            fields.append((name, byte_order + code))
            continue
        length_type = np.dtype(byte_order + length_code)
        file.seek(start + np.dtype(fields).itemsize)
        first = file.read(length_type.itemsize) if element.count else b""
        length = int.from_bytes(first, "big" if byte_order == ">" else "little")
        if length > _LONGEST_LIST:
            msg = f"{path}: a list {name} of {length:,} entries; give a PLY that meshdrape wrote"
            raise FileError(msg)
        fields.append((f"{name} length", length_type))
        fields.append((name, byte_order + code, (length,)))
    return np.dtype(fields)
