"""The halves of a start fibre, each a row of nodes outward from the seed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import StartError
from meshdrape.kernels.generator import NOT_TURNED, TURNED_BACK, trace
from meshdrape.surface import Surface
from meshdrape.weave.start import SeedStar

FloatArray = NDArray[np.float64]

FAMILY = ("warp", "weft")


@dataclass(frozen=True, eq=False)
class HalfFibre:
    """Nodes of one half of a start fibre, the seed left out, and the edges that reach them.

    Attributes
    ----------
    face : (n,) int32
    xy : (n, 2) in the frame of that face, mm
    out, into : (n, 2)
        Unit directions in which the fibre leaves and reaches each node, in the frame of its face.
    through : (n,) bool
        Whether a vertex lies on the edge that reaches the node.
    arc : (n,) bool
        Whether that edge bends, so that its ends lie nearer than one spacing.
    """

    face: NDArray[np.int32]
    xy: FloatArray
    out: FloatArray
    into: FloatArray
    through: NDArray[np.bool_]
    arc: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.face)


@dataclass(frozen=True, eq=False)
class Turn:
    """A turn at a crease.

    Attributes
    ----------
    angle : float
        Counter-clockwise about the mould's normal, rad.
    crease : (m, 3) bool
        Edges of the mould's faces at which the fibre may turn.
    """

    angle: float
    crease: NDArray[np.bool_]


Turns = tuple[Turn | None, Turn | None]
"""Turns of the warp and of the weft generator."""


def straight_half(
    surface: Surface, star: SeedStar, half: int, spacing: float, count: int, turn: Turn | None = None
) -> tuple[HalfFibre, bool]:
    """A half-fibre that runs straight, but for a turn where it first crosses a crease; and whether it turned.

    Parameters
    ----------
    half : int
        0 to 3: +warp, +weft, -warp, -weft.
    spacing : float
        mm along the fibre.
    count : int
        Most nodes.
    turn : Turn, optional

    Raises
    ------
    StartError
        If the turn leads back over the crease.
    """
    face = np.empty(count, dtype=np.int32)
    xy, out, into = (np.empty((count, 2)) for _ in range(3))
    through = np.zeros(count, dtype=np.bool_)
    crease = np.zeros((0 if turn is None else len(surface.faces), 3), dtype=np.bool_)
    if turn is not None:
        crease[: len(turn.crease)] = turn.crease
    code, n, _, turned = trace(
        surface.unfolding, crease, 0.0 if turn is None else turn.angle, star.face[half], *star.xy[half],
        *star.out[half], star.far_edge[half], 0.0, spacing, count, face, xy, out, into, through,
    )  # fmt: skip
    if turn is not None and code == TURNED_BACK:
        name = FAMILY[half % 2]
        msg = (
            f"a {name} turn of {math.degrees(turn.angle):g} degrees leads the {name} back over the crease; "
            f"give a smaller {name}_turn"
        )
        raise StartError(msg)
    arc = np.zeros(count, dtype=np.bool_)
    if 0 <= turned < n:
        arc[turned] = True
    fibre = HalfFibre(*_first(n, face, xy, out, into, through, arc))
    return fibre, turned != NOT_TURNED


def _first(n: int, *arrays: NDArray[Any]) -> list[NDArray[Any]]:
    return [array[:n] for array in arrays]
