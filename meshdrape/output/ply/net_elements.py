"""What a NET.ply is made of: the elements of the file, the names of their columns, and how much is handled at once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from meshdrape.output.ply.columns import COLOUR, POSITION, SHEAR_FIELDS

WARP: Final = ("warp_x", "warp_y", "warp_z")
WEFT: Final = ("weft_x", "weft_y", "weft_z")
BALANCE: Final = ("predicted_shear_deg", "balance_residual_deg", "defect_deg")
# Comments on the start fibres, in the order of `prescribe`.
PRESCRIBED: Final = ("warp_turn_rad", "weft_turn_rad", "warp_path", "weft_path")

NODE: Final = np.dtype(
    [
        *[(name, "f8") for name in POSITION],
        ("i", "i4"),
        ("j", "i4"),
        *[(name, "u1") for name in COLOUR],
        ("quality", "f4"),
        ("s", "f4"),  # MeshLab takes texture coordinates as float alone
        ("t", "f4"),
        ("shear_deg", "f8"),
        *[(name, "f8") for name in WARP + WEFT],
        ("status", "u1"),
    ]
)
CELL: Final = np.dtype(
    [
        ("vertex_indices", "i4", (4,)),
        *SHEAR_FIELDS,
        *[(name, "f8") for name in BALANCE],
    ]
)
GAP: Final = np.dtype([("i", "i4"), ("j", "i4"), ("length", "i4"), ("status", "u1")])
SEAL: Final = np.dtype([("sha256", "u1", (32,))])
NODES_PER_BLOCK = 1 << 16  # some 7 MB of rows


def blocks(n_rows: int, row_length: int = 1) -> Iterator[tuple[int, int]]:
    """Yield spans [start, end) of rows of so many nodes, each of a size that stays in the processor's cache."""
    step = max(1, NODES_PER_BLOCK // row_length)
    for start in range(0, n_rows, step):
        yield start, min(start + step, n_rows)
