"""Options that several commands share, and how their words become values."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from meshdrape.errors import FileError

if TYPE_CHECKING:
    from meshdrape.mould import Mould


def numbers(count: int, what: str) -> Any:
    """A converter for exactly `count` finite numbers separated by commas."""

    def convert(text: str) -> tuple[float, ...]:
        try:
            values = tuple(float(part) for part in text.split(","))
        except ValueError:
            values = ()
        if len(values) != count or not all(math.isfinite(value) for value in values):
            msg = f"{text!r} is not {what}"
            raise argparse.ArgumentTypeError(msg)
        return values

    return convert


def spacing(text: str) -> float | tuple[float, float]:
    """One spacing, or two separated by a comma: along warp and along weft."""
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in (1, 2):
        msg = f"{text!r} is not a spacing in mm: give 5, or 5,4 for warp and weft"
        raise argparse.ArgumentTypeError(msg)
    return values[0] if len(values) == 1 else (values[0], values[1])


def degrees(text: str) -> float:
    """An angle in degrees, as radians."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        msg = f"{text!r} is not an angle in degrees"
        raise argparse.ArgumentTypeError(msg)
    return math.radians(value)


def count(text: str) -> int:
    """A whole number from 1 on."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        msg = f"{text!r} is not a whole number from 1 on"
        raise argparse.ArgumentTypeError(msg)
    return value


def add_reading_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """The mould's file and how it is read."""
    parser.add_argument("mould", metavar="MOULD", help="STEP, BREP, STL, OBJ, PLY or OFF file, or a CadQuery script")
    group = parser.add_argument_group("the mould")
    group.add_argument("--unit", help="unit of a mesh file: mm (default), cm, m, um, in, ft")
    group.add_argument("--chord-tolerance", type=float, metavar="MM", help="largest gap from facets to CAD face (0.1)")
    group.add_argument(
        "--angle-tolerance",
        type=degrees,
        metavar="DEG",
        help="largest angle between facets (0.2); wider, for the same error of shear, on doubly curved faces",
    )
    group.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter of a CadQuery script; repeatable"
    )
    return group


def add_mould_options(parser: argparse.ArgumentParser) -> None:
    """The mould's file, how it is read, and what of it is draped."""
    group = add_reading_options(parser)
    group.add_argument(
        "--faces", help='CAD faces to drape: a CadQuery selector (">Z"), ids ("1,3"; see inspect) or names'
    )
    group.add_argument("--heal", action="store_true", help="repair a mesh file, and say what changed")


def reading(options: argparse.Namespace) -> dict[str, Any]:
    """What the reading options say, as arguments of `read_mould` and `inspect_mould`."""
    parameters = {}
    for word in options.set:
        name, equals, value = word.partition("=")
        if not equals or not name:
            msg = f"--set {word}: give NAME=VALUE, such as --set span=14000"
            raise FileError(msg)
        parameters[name] = value
    said = {name: getattr(options, name) for name in ("unit", "chord_tolerance", "angle_tolerance")}
    return {"parameters": parameters or None, **{name: value for name, value in said.items() if value is not None}}


def read_mould(options: argparse.Namespace) -> Mould:
    """The mould that the options name."""
    from meshdrape.mould import read_mould as read

    return read(options.mould, faces=options.faces, heal=options.heal, **reading(options))


def read_path(file: str) -> list[tuple[float, float, float]]:
    """Points of a start fibre, mm.

    A text file has one a line, x y z separated by blanks, commas or semicolons; # begins a comment and a line of the
    words x y z is passed over. An OBJ file has them as `v`, in the order of its line `l`, if there is one.

    Raises
    ------
    FileError
        If the file cannot be read, or a line is no point: with its number.
    """
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
        msg = f"{file} has {len(points)} points; a fibre needs at least two, x y z a line, in mm"
        raise FileError(msg)
    return [points[n] for n in order] if order else points


def _point(words: list[str], file: str, number: int) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words)
        if all(math.isfinite(value) for value in (x, y, z)):
            return x, y, z
    except ValueError:
        pass
    msg = f"{file}, line {number}: {' '.join(words)!r} is no point; give x y z in mm, such as 120.5 0 33"
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
    msg = f"{file}, line {number}: l {' '.join(words)} names points it does not have; there are {n_points} before it"
    raise FileError(msg)
