"""A curve as points in a text file or an OBJ line."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import FileError
from meshdrape.mould.files import existing_file
from meshdrape.mould.mesh.check import FARTHEST


def read_points(path: str | os.PathLike[str]) -> NDArray[np.float64]:
    """Points of a curve in a file, (n, 3), in the file's order.

    A text file has one a line, x y z separated by blanks, commas or semicolons; # begins a comment and a line of the
    words x y z is passed over. An OBJ file has them as `v`, in the order of its line `l`, if there is one.

    Raises
    ------
    FileError
        If the file cannot be read, or a line is no point: with its number.
    """
    file = os.fspath(existing_file(path, "curve"))
    try:
        with open(file, encoding="utf-8-sig") as text:
            lines = text.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        msg = f"{file} cannot be read: {reason}; give a text file of points, x y z a line"
        raise FileError(msg) from None
    obj = file.lower().endswith(".obj")
    points: list[tuple[float, float, float]] = []
    order: list[int] = []
    for number, line in enumerate(lines, start=1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words or [word.lower() for word in words] == ["x", "y", "z"]:
            continue
        if obj:
            kind, *words = words
            if kind == "l":
                order += _indices(words, len(points), file, number)
            if kind != "v":
                continue
        points.append(_point(words, file, number))
    if len(points) < 2:
        msg = f"{file} has {len(points)} points; a curve needs at least two, x y z a line, in mm"
        raise FileError(msg)
    return np.array([points[n] for n in order] if order else points)


def _point(words: list[str], file: str, number: int) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words)
        # NaN fails the comparison too
        if all(abs(value) <= FARTHEST for value in (x, y, z)):
            return x, y, z
    except ValueError:
        pass
    msg = f"{file}, line {number}: {_shown(words)} is no point; give x y z in mm, such as 120.5 0 33"
    raise FileError(msg)


def _indices(words: list[str], n_points: int, file: str, number: int) -> list[int]:
    """Indices from 0 of an OBJ line, which counts from 1, or back from the last."""
    try:
        # a texture index may follow a slash
        given = [int(word.partition("/")[0]) for word in words]
        found = [n - 1 if n > 0 else n_points + n for n in given]
        if all(0 <= n < n_points for n in found) and 0 not in given:
            return found
    except ValueError:
        pass
    msg = (
        f"{file}, line {number}: l {_shown(words)[1:-1]} names points it does not have; there are {n_points} before it"
    )
    raise FileError(msg)


def _shown(words: list[str]) -> str:
    """The words in quotes, in ASCII and cut short: what is no text may hold anything at any length."""
    return ascii(" ".join(words)[:60])
