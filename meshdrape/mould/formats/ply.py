"""PLY files, text and binary, of any properties; vertices and faces are taken."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.mould.formats.polygons import Floats, Ints, Polygons

_CODE: Final = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_STRUCT: Final = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I", "f4": "f", "f8": "d"}
_FORMATS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_CORNERS: Final = ("vertex_indices", "vertex_index")


# A column holds one value a row; a list column, all rows' values and the length of each row's list.
_Column = NDArray[Any] | tuple[NDArray[Any], NDArray[Any]]
_Columns = dict[str, _Column]


@dataclass(frozen=True)
class _Property:
    name: str
    code: str
    count_code: str | None  # of the length of a list; None for a single value


@dataclass(frozen=True)
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)

    def has_lists(self) -> bool:
        return any(p.count_code for p in self.properties)


def read_ply(content: bytes) -> Polygons:
    """Return the polygons of a PLY file, coordinates to the last bit."""
    order, elements, body = _header(content)
    decoded = _from_bytes(elements, body, order) if order else _from_text(elements, body.split())
    vertices: Floats | None = None
    faces: tuple[Ints, Ints] | None = None
    for element, values in decoded:
        if element.name == "vertex":
            missing = [axis for axis in "xyz" if axis not in values]
            if missing:
                msg = f"its vertices have no {missing[0]}"
                raise ValueError(msg)
            vertices = np.stack([np.asarray(values[axis], dtype=np.float64) for axis in "xyz"], axis=1)
        elif element.name == "face":
            found = [values[name] for name in _CORNERS if name in values]
            if not found or not isinstance(found[0], tuple):
                msg = "its faces have no list vertex_indices"
                raise ValueError(msg)
            faces = _whole(found[0][0]), _whole(found[0][1])
    if vertices is None or faces is None:
        msg = "it has no faces: a point cloud is no mould" if faces is None else "it has no vertices"
        raise ValueError(msg)
    return Polygons(vertices, *faces)


def _whole(numbers: NDArray[Any]) -> Ints:
    """Return numbers that must be whole as integers."""
    # beyond 2^53 a float64 is whole but may be another number than was written
    if not ((np.floor(numbers) == numbers) & (np.abs(numbers) < 2.0**53)).all():
        msg = "a face uses a vertex whose number is not whole"
        raise ValueError(msg)
    return numbers.astype(np.int64)


def _header(content: bytes) -> tuple[str, list[_Element], bytes]:
    """Return the byte order ("" for text), the elements, and what follows the header."""
    end = content.find(b"end_header")
    newline = content.find(b"\n", end)
    if not content.startswith(b"ply") or end < 0 or newline < 0:
        msg = "no PLY file: it has no PLY header"
        raise ValueError(msg)
    order: str | None = None
    elements: list[_Element] = []
    for line in content[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, _] if name in _FORMATS:
                order = _FORMATS[name]
            case ["element", name, count] if count.isdecimal():
                elements.append(_Element(name, int(count)))
            case ["property", "list", count_type, value_type, name] if (
                elements and _CODE.get(count_type, "f")[0] != "f" and value_type in _CODE
            ):
                elements[-1].properties.append(_Property(name, _CODE[value_type], _CODE[count_type]))
            case ["property", value_type, name] if elements and value_type in _CODE:
                elements[-1].properties.append(_Property(name, _CODE[value_type], None))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                msg = f"its header has the line {line[:40]!a}"
                raise ValueError(msg)
    if order is None:
        msg = "its header names no format"
        raise ValueError(msg)
    return order, elements, content[newline + 1 :]


def _truncated(element: _Element) -> ValueError:
    return ValueError(f"truncated: its header says {element.count:,} of element {element.name}, there are fewer")


def _from_text(elements: list[_Element], words: list[bytes]) -> Iterator[tuple[_Element, _Columns]]:
    at = 0
    for element in elements:
        if not element.has_lists():
            width = len(element.properties)
            end = at + element.count * width
            if end > len(words):
                raise _truncated(element)
            table = np.array([float(word) for word in words[at:end]]).reshape(-1, max(width, 1))
            yield element, {p.name: table[:, k] for k, p in enumerate(element.properties)}
            at = end
            continue
        rows = _Rows(element)
        for _ in range(element.count):
            for p, values, lengths in rows.columns:
                length = 1
                if p.count_code:
                    length = int(words[at]) if at < len(words) else -1
                    at += 1
                if length < 0 or at + length > len(words):
                    raise _truncated(element)
                values.extend(map(float, words[at : at + length]))
                lengths.append(length)
                at += length
        yield element, rows.arrays()


def _from_bytes(elements: list[_Element], body: bytes, order: str) -> Iterator[tuple[_Element, _Columns]]:
    at = 0
    for element in elements:
        if not element.properties or not element.count:
            yield element, _Rows(element).arrays()
            continue
        columns, end = _equal_rows(element, body, at, order)
        if columns is None:
            if not element.has_lists():
                raise _truncated(element)
            columns, end = _unequal_rows(element, body, at, order)
        yield element, columns
        at = end


def _equal_rows(element: _Element, body: bytes, at: int, order: str) -> tuple[_Columns | None, int]:
    """Columns of an element each of whose lists is as long in every row as in the first, and where it ends.

    None where that is not so, or the body is too short for it.
    """
    lengths: list[int] = []
    fields: list[tuple[Any, ...]] = []
    start = at
    for k, p in enumerate(element.properties):
        length = 1
        if p.count_code:
            size = int(p.count_code[1])
            length = int.from_bytes(body[start : start + size], "little" if order == "<" else "big")
            fields.append((f"length{k}", order + p.count_code))
            start += size
        fields.append((f"values{k}", order + p.code, (length,)))
        lengths.append(length)
        start += int(p.code[1]) * length
    end = at + element.count * (start - at)
    if end > len(body):
        return None, at
    table: Any = np.frombuffer(body, np.dtype(fields), element.count, at)
    columns: _Columns = {}
    for k, p in enumerate(element.properties):
        values = table[f"values{k}"]
        if not p.count_code:
            columns[p.name] = values[:, 0]
        elif (table[f"length{k}"] == lengths[k]).all():
            columns[p.name] = values.ravel(), table[f"length{k}"]
        else:
            return None, at
    return columns, end


def _unequal_rows(element: _Element, body: bytes, at: int, order: str) -> tuple[_Columns, int]:
    """Columns of an element, row by row, and where it ends."""
    rows = _Rows(element)
    try:
        for _ in range(element.count):
            for p, values, lengths in rows.columns:
                length = 1
                if p.count_code:
                    (length,) = struct.unpack_from(order + _STRUCT[p.count_code], body, at)
                    at += int(p.count_code[1])
                if length < 0:
                    raise _truncated(element)
                values.extend(struct.unpack_from(f"{order}{length}{_STRUCT[p.code]}", body, at))
                lengths.append(length)
                at += length * int(p.code[1])
    except struct.error as error:
        raise _truncated(element) from error
    return rows.arrays(), at


class _Rows:
    """Columns that grow row by row."""

    def __init__(self, element: _Element) -> None:
        self.columns: list[tuple[_Property, list[float], list[int]]] = [(p, [], []) for p in element.properties]

    def arrays(self) -> _Columns:
        return {
            p.name: (np.array(values), np.array(lengths, dtype=np.int64)) if p.count_code else np.array(values)
            for p, values, lengths in self.columns
        }
