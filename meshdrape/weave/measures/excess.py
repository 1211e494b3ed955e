"""By how much the corners of a cell are off those of a rhombus, for the curvature inside it.

A cell with no curvature and four equal sides is a rhombus: its corners beside the first one are half a turn less that
one. A vertex of defect d inside makes them larger, by parts of d that depend on where it lies; whatever lies beyond
that corner in the same row or column of cells is sheared by as much.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# A vertex this near to the cell's first corner, in sides, lies on it, and in no direction from it.
AT_CORNER = 1e-7
# Below this the cosine of a direction from the first corner is that along a side: its angle would be the root of
# round-off.
ON_SIDE = 1e-12


class Sides(NamedTuple):
    """Lengths of the four sides of cells, mm: `warp` and `weft` from the first corner, and the ones across."""

    warp: ArrayLike
    weft: ArrayLike
    warp_across: ArrayLike
    weft_across: ArrayLike


def corner_excess(
    sides: Sides, angle: ArrayLike, defect: ArrayLike = 0.0, vertex: ArrayLike = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Excess of the corners at the far end of the warp side and of the weft side, over half a turn less `angle`, rad.

    The cell is laid flat about its first corner and cut open from the vertex to the corner opposite, which is found
    from the two sides that reach it: exact for any defect.

    Parameters
    ----------
    sides : Sides
    angle : (...,)
        At the first corner, from the warp side to the weft side, rad.
    defect : (...,)
        Of the one vertex inside, rad.
    vertex : (...,) complex
        Its place, mm: the first corner is the origin and the warp side lies along the real axis.
    """
    angle, defect, vertex = np.asarray(angle), np.asarray(defect), np.asarray(vertex, dtype=np.complex128)
    along, up = np.asarray(sides.warp, dtype=np.float64), np.asarray(sides.weft, dtype=np.float64)
    top, right = np.asarray(sides.warp_across, dtype=np.float64), np.asarray(sides.weft_across, dtype=np.float64)
    closed = np.exp(-1j * defect)
    # the weft side as seen from the other bank of the cut
    first, end = vertex * (1 - closed), vertex + (up * np.exp(1j * angle) - vertex) * closed
    between = end - along
    distance = np.abs(between)
    # a cell folded flat has both of its far sides from one place
    folded = distance == 0
    apart = np.where(folded, 1.0, distance)
    ahead = np.where(folded, 1.0, between / apart)
    foot = np.where(folded, right, (distance**2 + right**2 - top**2) / (2 * apart))
    height = np.sqrt(np.maximum(right**2 - foot**2, 0.0))
    last = along + ahead * (foot - 1j * height)
    at_warp_end = np.angle(-along / (last - along) * np.exp(1j * (angle - np.pi)))
    at_weft_end = np.angle((last - end) / (first - end) * np.exp(1j * (angle - np.pi)))
    return np.asarray(at_warp_end), np.asarray(at_weft_end)


def laid_flat(sides: Sides, to_first: FloatArray, to_warp: FloatArray, to_weft: FloatArray) -> tuple[FloatArray, ...]:
    """Place of a vertex in its cell laid flat, (n,) complex mm, and the angle at the cell's first corner, (n,) rad.

    Parameters
    ----------
    sides : Sides
    to_first, to_warp, to_weft : (n,) mm
        Distances of the vertex from the first corner, and from the ends of its warp and weft sides.
    """
    warp, weft = np.asarray(sides.warp, dtype=np.float64), np.asarray(sides.weft, dtype=np.float64)
    near = np.maximum(to_first, AT_CORNER * warp)

    def between(side: FloatArray, far: FloatArray) -> FloatArray:
        cosine = (near**2 + side**2 - far**2) / (2 * near * side)
        found = np.arccos(np.where(np.abs(cosine) > 1 - ON_SIDE, np.sign(cosine), cosine))
        return np.asarray(np.where(near > to_first, np.pi / 4, found))

    turn = between(warp, to_warp)
    return to_first * np.exp(1j * turn), turn + between(weft, to_weft)
