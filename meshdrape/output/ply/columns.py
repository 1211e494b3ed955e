"""Columns that the PLY files share: position, colour and shear."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.colour import shear_colour
from meshdrape.output.ply.writer import Rows

POSITION: Final = ("x", "y", "z")
COLOUR: Final = ("red", "green", "blue", "alpha")
SHEAR_FIELDS: Final = (*[(name, "u1") for name in COLOUR], ("quality", "f4"), ("shear_deg", "f8"))


def fill(rows: Rows, names: Sequence[str], columns: NDArray[Any]) -> None:
    """Fill the named fields of `rows` (n,) from the columns of an array (n, len(names))."""
    for k, name in enumerate(names):
        rows[name] = columns[:, k]


def fill_shear(rows: Rows, shear: NDArray[np.float64], locking_angle: float) -> None:
    """Fill `shear_deg`, `quality` and the colour of `rows` (n,) from their shear (n,), rad.

    `quality` is the absolute shear; it is 0 where there is none, as a NaN there makes MeshLab fall over.
    """
    rows["shear_deg"] = np.degrees(shear)
    rows["quality"] = np.abs(np.nan_to_num(rows["shear_deg"]))
    fill(rows, COLOUR, shear_colour(shear, locking_angle))
