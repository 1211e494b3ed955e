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
    columns = _text_columns(elements, body.split()) if not order else _binary_columns(elements, body, order)
    vertices: Floats | None = None
    faces: tuple[Ints, Ints] | None = None
    for element, values in columns:
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
            faces = found[0][0].astype(np.int64), found[0][1].astype(np.int64)
    if vertices is None or faces is None:
        msg = "it has no faces: a point cloud is no mould" if faces is None else "it has no vertices"
        raise ValueError(msg)
    return Polygons(vertices, *faces)


# A column holds one value a row; a list column, all rows' values and the length of each row's list.
_Column = NDArray[Any] | tuple[NDArray[Any], NDArray[Any]]
_Columns = Iterator[tuple[_Element, dict[str, _Column]]]


def _header(content: bytes) -> tuple[str, list[_Element], bytes]:
    """Byte order ("" for text), elements, and what follows the header."""
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
            case ["property", "list", count_type, value_type, name] if elements:
                elements[-1].properties.append(_Property(name, _CODE[value_type], _CODE[count_type]))
            case ["property", value_type, name] if elements:
                elements[-1].properties.append(_Property(name, _CODE[value_type], None))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                msg = f"its header has the line {ascii(line[:40])}"
                raise ValueError(msg)
    if order is None:
        msg = "its header names no format"
        raise ValueError(msg)
    return order, elements, content[newline + 1 :]


def _truncated(element: _Element) -> ValueError:
    return ValueError(
        f"truncated: its header says {element.count:,} of element {element.name}, there are fewer"
    )


def _text_columns(elements: list[_Element], words: list[bytes]) -> _Columns:
    at = 0
    for element in elements:
        if not element.has_lists():
            width = len(element.properties)
            end = at + element.count * width
            if end > len(words):
                raise _truncated(element)
            table = np.array([float(word) for word in words[at:end]]).reshape(element.count, width)
            yield element, {p.name: table[:, k] for k, p in enumerate(element.properties)}
            at = end
            continue
        rows: dict[str, tuple[list[float], list[int]]] = {p.name: ([], []) for p in element.properties}
        for _ in range(element.count):
            for p in element.properties:
                if at >= len(words):
                    raise _truncated(element)
                length = int(words[at]) if p.count_code else 1
                at += 1 if p.count_code else 0
                if length < 0 or at + length > len(words):
                    raise _truncated(element)
                rows[p.name][0].extend(map(float, words[at : at + length]))
                rows[p.name][1].append(length)
                at += length
        yield element, _columns(element, rows)


def _binary_columns(elements: list[_Element], body: bytes, order: str) -> _Columns:
    at = 0
    for element in elements:
        lengths = _first_lengths(element, body, at, order)
        dtype = np.dtype(
            [
                field
                for k, p in enumerate(element.properties)
                for field in ([(f"n{k}", order + p.count_code)] if p.count_code else [])
                + [(f"v{k}", order + p.code, (lengths[k],) if p.count_code else ())]
            ]
        )
        end = at + element.count * dtype.itemsize
        if end <= len(body):
            table = (
                np.frombuffer(body, dtype=dtype, count=element.count, offset=at)
                if dtype.itemsize
                else np.empty(0)
            )
            lists = [k for k, p in enumerate(element.properties) if p.count_code]
            if all((table[f"n{k}"] == lengths[k]).all() for k in lists):
                # every list of a property has the length of the first one
                yield (
                    element,
                    {
                        p.name: (table[f"v{k}"].ravel(), table[f"n{k}"]) if p.count_code else table[f"v{k}"]
                        for k, p in enumerate(element.properties)
                    },
                )
                at = end
                continue
        if not element.has_lists():
            raise _truncated(element)
        rows, at = _binary_rows(element, body, at, order)
        yield element, _columns(element, rows)


def _first_lengths(element: _Element, body: bytes, at: int, order: str) -> list[int]:
    """Lengths of the lists of an element's first row, 0 for single values."""
    lengths = []
    for p in element.properties:
        length = 0
        if p.count_code and element.count:
            size = np.dtype(p.count_code).itemsize
            if at + size > len(body):
                raise _truncated(element)
            length = int(np.frombuffer(body, dtype=order + p.count_code, count=1, offset=at)[0])
            if not 0 <= length <= len(body):
                raise _truncated(element)
            at += size
        lengths.append(length)
        at += np.dtype(p.code).itemsize * (length if p.count_code else 1)
    return lengths


def _binary_rows(
    element: _Element, body: bytes, at: int, order: str
) -> tuple[dict[str, tuple[list[float], list[int]]], int]:
    """All rows, one by one, of an element whose lists differ in length; and where it ends."""
    rows: dict[str, tuple[list[float], list[int]]] = {p.name: ([], []) for p in element.properties}
    plan = [
        (
            *rows[p.name],
            struct.Struct(order + _STRUCT[p.count_code]) if p.count_code else None,
            order,
            _STRUCT[p.code],
        )
        for p in element.properties
    ]
    try:
        for _ in range(element.count):
            for values, lengths, counter, byte_order, code in plan:
                length = 1
                if counter:
                    length = int(counter.unpack_from(body, at)[0])
                    at += counter.size
                form = f"{byte_order}{length}{code}"
                values.extend(struct.unpack_from(form, body, at))
                lengths.append(length)
                at += struct.calcsize(form)
    except struct.error as error:
        raise _truncated(element) from error
    return rows, at


def _columns(element: _Element, rows: dict[str, tuple[list[float], list[int]]]) -> dict[str, _Column]:
    return {
        p.name: (np.array(rows[p.name][0]), np.array(rows[p.name][1], dtype=np.int64))
        if p.count_code
        else np.array(rows[p.name][0])
        for p in element.properties
    }
