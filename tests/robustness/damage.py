"""Ways in which bytes go wrong between two machines: cut short, flipped, shuffled, counted wrongly, in another code."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
from numpy.random import Generator

_NUMBER = re.compile(rb"(?<![\w.#])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w.])")
_DECIMAL = re.compile(rb"(?<![\w.#'])[-+]?\d+\.\d*(?:[eE][-+]?\d+)?(?![\w.])")
_REFERENCE = re.compile(rb"#\d+")
_ODD = [
    b"-1", b"0", b"1", b"99999999999", b"2147483647", b"4294967296", b"18446744073709551616", b"1e308", b"-1e309",
    b"nan", b"inf", b"1e-320", b"0x10", b"1_000", b"9" * 5000, b"1.2.3", b"--1", b"", b"\xff\xfe", b"0.5", b"1e12",
    b"1" + b"0" * 400,
]  # fmt: skip


def truncated(data: bytes, rng: Generator) -> bytes:
    return data[: int(rng.integers(len(data)))]


def truncated_near_the_end(data: bytes, rng: Generator) -> bytes:
    return data[: -int(rng.integers(1, 60))]


def truncated_in_the_header(data: bytes, rng: Generator) -> bytes:
    return data[: int(rng.integers(min(400, len(data))))]


def flipped(data: bytes, rng: Generator) -> bytes:
    out = bytearray(data)
    for at in rng.integers(len(out), size=int(rng.choice([1, 2, 5, 50]))):
        out[at] ^= 1 << int(rng.integers(8))
    return bytes(out)


def flipped_in_the_header(data: bytes, rng: Generator) -> bytes:
    out = bytearray(data)
    for at in rng.integers(min(len(out), 400), size=int(rng.integers(1, 4))):
        out[at] ^= 1 << int(rng.integers(8))
    return bytes(out)


def cut_out(data: bytes, rng: Generator) -> bytes:
    a = int(rng.integers(len(data)))
    return data[:a] + data[a + int(rng.integers(1, 300)) :]


def doubled(data: bytes, rng: Generator) -> bytes:
    a = int(rng.integers(len(data)))
    b = a + int(rng.integers(1, 300))
    return data[:b] + data[a:]


def lines_swapped(data: bytes, rng: Generator) -> bytes:
    lines = data.split(b"\n")
    for _ in range(3):
        a, b = rng.integers(len(lines), size=2)
        lines[a], lines[b] = lines[b], lines[a]
    return b"\n".join(lines)


def noise(data: bytes, rng: Generator) -> bytes:
    a = int(rng.integers(len(data)))
    return data[:a] + rng.bytes(int(rng.integers(1, 200))) + data[a:]


def zeros(data: bytes, rng: Generator) -> bytes:
    a, n = int(rng.integers(len(data))), int(rng.integers(1, 200))
    return data[:a] + bytes(n) + data[a + n :]


def odd_number(data: bytes, rng: Generator) -> bytes:
    found = list(_NUMBER.finditer(data))
    if not found:
        return zeros(data, rng)
    # counts stand at the beginning
    at = found[int(rng.integers(min(len(found), 30) if rng.random() < 0.5 else len(found)))]
    return data[: at.start()] + _ODD[int(rng.integers(len(_ODD)))] + data[at.end() :]


def another_code(data: bytes, rng: Generator) -> bytes:
    kind = int(rng.integers(5))
    text = data.decode("latin-1")
    if kind == 0:
        return text.encode("utf-16")
    if kind == 1:
        return b"\xef\xbb\xbf" + data
    if kind == 2:
        return data.replace(b"\n", b"\r\n")
    if kind == 3:
        return data.replace(b"\n", b"\r")
    return data.replace(b".", b",")


def nested(data: bytes, rng: Generator) -> bytes:
    a = int(rng.integers(len(data)))
    return (
        data[:a]
        + [b"(", b"[", b"{", b"((1,", b"not "][int(rng.integers(5))] * int(rng.choice([50, 5000, 200_000]))
        + data[a:]
    )


def appended(data: bytes, rng: Generator) -> bytes:
    return data + [rng.bytes(33), data, b"\n\n\n", b"\0" * 1000][int(rng.integers(4))]


def changed_number(data: bytes, rng: Generator) -> bytes:
    """A number that is one still, but another."""
    for _ in range(int(rng.choice([1, 1, 2, 5, 20]))):
        found = list(_DECIMAL.finditer(data))
        if not found:
            return truncated(data, rng)
        at = found[int(rng.integers(len(found)))]
        factor = float(rng.choice([1e3, -1.0, 0.0, 1e-6, 1e12, 1 + 1e-9, 1e300, 0.5]))
        with np.errstate(over="ignore"):
            text = b"%.17g" % (np.float64(at.group()) * factor)
        text = text if b"." in text or b"e" in text or b"n" in text else text + b"."
        data = data[: at.start()] + text.replace(b"e", b"E") + data[at.end() :]
    return data


def changed_reference(data: bytes, rng: Generator) -> bytes:
    """A line of a STEP file that speaks of another than it should."""
    for _ in range(int(rng.choice([1, 1, 2, 5]))):
        found = list(_REFERENCE.finditer(data))
        if not found:
            return changed_number(data, rng)
        one, other = (found[int(at)] for at in rng.integers(len(found), size=2))
        data = data[: one.start()] + other.group() + data[one.end() :]
    return data


def line_out(data: bytes, rng: Generator) -> bytes:
    lines = data.split(b"\n")
    for _ in range(int(rng.choice([1, 2, 10]))):
        del lines[int(rng.integers(len(lines)))]
        if not lines:
            break
    return b"\n".join(lines)


def words_swapped(data: bytes, rng: Generator) -> bytes:
    words = re.split(rb"(\s+|[(),;=])", data)
    for _ in range(int(rng.choice([1, 2, 5]))):
        one, other = rng.integers(len(words), size=2)
        words[one], words[other] = words[other], words[one]
    return b"".join(words)


def changed_digit(data: bytes, rng: Generator) -> bytes:
    out = bytearray(data)
    digits = [at for at, byte in enumerate(data) if 48 <= byte <= 57]
    for at in rng.choice(digits, size=int(rng.choice([1, 1, 2, 10]))) if digits else []:
        out[at] = 48 + int(rng.integers(10))
    return bytes(out)


DAMAGE: dict[str, Callable[[bytes, Generator], bytes]] = {
    f.__name__: f
    for f in (
        truncated, truncated_near_the_end, truncated_in_the_header, flipped, flipped_in_the_header, cut_out, doubled,
        lines_swapped, noise, zeros, odd_number, another_code, nested, appended,
        changed_number, changed_reference, line_out, words_swapped, changed_digit,
    )
}  # fmt: skip
