"""Options that several commands share, and how their words become values."""

from __future__ import annotations

import argparse
import math
from typing import TYPE_CHECKING, Any

from meshdrape.errors import FileError

if TYPE_CHECKING:
    from meshdrape.mould import Mould


POINT = "a point X,Y,Z in mm"
VECTOR = "a direction X,Y,Z"


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


def axis(text: str) -> tuple[float, ...]:
    """A direction X,Y,Z that is not zero."""
    values: tuple[float, ...] = numbers(3, VECTOR)(text)
    if not any(values):
        msg = f"{text!r} is no direction: its three numbers must not all be zero"
        raise argparse.ArgumentTypeError(msg)
    return values


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


def positive(text: str) -> float:
    """A number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0):
        msg = f"{text!r} is not a number above 0"
        raise argparse.ArgumentTypeError(msg)
    return value


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
    add_tolerances(group)
    add_parameters(group)
    return group


def add_tolerances(group: argparse._ArgumentGroup) -> None:
    """How finely CAD faces are cut into triangles."""
    group.add_argument(
        "--chord-tolerance", type=float, metavar="MM", help="largest gap between facets and CAD face (0.1)"
    )
    group.add_argument(
        "--angle-tolerance",
        type=degrees,
        metavar="DEG",
        help="largest angle between neighbouring facets (0.2); wider on doubly curved faces, where it errs no more",
    )


def add_parameters(group: argparse._ArgumentGroup) -> None:
    """Parameters of a script."""
    group.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="parameter of a CadQuery script; repeatable"
    )


def add_cloth_options(parser: argparse.ArgumentParser, *, spacing_required: bool) -> None:
    """The fabric and how far it reaches."""
    cloth = parser.add_argument_group("the cloth")
    cloth.add_argument(
        "--spacing",
        type=spacing,
        required=spacing_required,
        metavar="MM",
        help="from node to node, such as 5; or WARP,WEFT",
    )
    cloth.add_argument(
        "--initial-angle",
        type=degrees,
        default=math.pi / 2,
        metavar="DEG",
        help="from warp to weft before it shears (90)",
    )
    cloth.add_argument(
        "--locking-angle",
        type=degrees,
        default=math.radians(7),
        metavar="DEG",
        help="shear at which it can shear no further (7)",
    )
    cloth.add_argument(
        "--extent", type=numbers(4, "four lengths in mm: WARP-,WARP+,WEFT-,WEFT+"), metavar="A,B,C,D",
        help="how far it reaches from the seed, mm: warp-, warp+, weft-, weft+ (as far as the mould)",
    )  # fmt: skip


def add_start_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Where the cloth is begun."""
    start = parser.add_argument_group("the start")
    start.add_argument(
        "--seed",
        type=numbers(3, POINT),
        metavar="X,Y,Z",
        help="where warp and weft start fibre cross, mm (near the middle)",
    )
    start.add_argument(
        "--direction",
        type=numbers(3, VECTOR),
        metavar="X,Y,Z",
        help="of the warp there, projected on the mould (its long way)",
    )
    return start


def add_mould_options(parser: argparse.ArgumentParser) -> None:
    """The mould's file, how it is read, and what of it is draped."""
    group = add_reading_options(parser)
    add_faces_option(group)
    group.add_argument("--heal", action="store_true", help="repair a mesh file, and say what changed")


def add_faces_option(group: argparse._ArgumentGroup) -> None:
    """The part of a B-rep that is draped."""
    group.add_argument(
        "--faces", help='CAD faces to drape: a CadQuery selector (">Z"), ids ("1,3"; see inspect) or names'
    )


def parameters_set(options: argparse.Namespace) -> dict[str, str]:
    """The words of every --set, by name."""
    parameters = {}
    for word in options.set:
        name, equals, value = word.partition("=")
        if not equals or not name:
            msg = f"--set {word}: give NAME=VALUE, such as --set span=14000"
            raise FileError(msg)
        parameters[name] = value
    return parameters


def reading(options: argparse.Namespace) -> dict[str, Any]:
    """What the reading options say, as arguments of `read_mould` and `inspect_mould`."""
    parameters = parameters_set(options)
    said = {name: getattr(options, name) for name in ("unit", "chord_tolerance", "angle_tolerance")}
    return {"parameters": parameters or None, **{name: value for name, value in said.items() if value is not None}}


def read_mould(options: argparse.Namespace) -> Mould:
    """The mould that the options name."""
    from meshdrape.mould import read_mould as read

    return read(options.mould, faces=options.faces, heal=options.heal, **reading(options))


def read_path(file: str | None) -> Any:
    """Points (n, 3) of a start fibre in a file; None where none is named."""
    from meshdrape.mould.formats.points import read_points

    return None if file is None else read_points(file)
