"""Units of length a mould may come in, and what each is in millimetres."""

from typing import Final

from meshdrape.errors import MouldError

MILLIMETRES: Final = {
    "um": 0.001,
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "in": 25.4,
    "inch": 25.4,
    "ft": 304.8,
}


def millimetres(unit: str) -> float:
    """Return how many millimetres one `unit` is.

    Raises
    ------
    MouldError
        The unit is not one of ``MILLIMETRES``.
    """
    if unit not in MILLIMETRES:
        msg = f"unknown unit {unit!r}; the units are {', '.join(MILLIMETRES)}"
        raise MouldError(msg)
    return MILLIMETRES[unit]
