"""Some fibres of a net: every n-th of a family, from end to end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdrape.weave.net import Net

_ROWS_PER_BLOCK: Final = 64
_ROUND: Final = (1, 2, 5)


@dataclass(frozen=True, eq=False)
class Fibres:
    """Fibres of one family.

    Attributes
    ----------
    every : int
        How many fibres of the net there are for one of these.
    number : (n_fibres,) int64
        Index of each across its family: j of a warp fibre, i of a weft fibre. The seed's is among them.
    position : (n_fibres, n_nodes, 3) float64, mm
        The nodes along each, NaN where there is none.
    """

    every: int
    number: NDArray[np.int64]
    position: NDArray[np.float64]


def warp_fibres(net: Net, every: int) -> Fibres:
    """Return every n-th warp fibre (of constant j), counted from the seed's."""
    number = _counted_from(net.seed_index[1], net.node_status.shape[1], every)
    n_warp = net.node_status.shape[0]
    position = np.empty((len(number), n_warp, 3))
    for start in range(0, n_warp, _ROWS_PER_BLOCK):
        end = min(start + _ROWS_PER_BLOCK, n_warp)
        position[:, start:end] = net.positions(start, end)[:, number].swapaxes(0, 1)
    return Fibres(every, number, position)


def weft_fibres(net: Net, every: int) -> Fibres:
    """Return every n-th weft fibre (of constant i), counted from the seed's."""
    number = _counted_from(net.seed_index[0], net.node_status.shape[0], every)
    position = np.concatenate([net.positions(int(i), int(i) + 1) for i in number])
    return Fibres(every, number, position)


def round_step(least: float) -> int:
    """Return the smallest of 1, 2, 5, 10, 20, 50 ... that is not below `least`."""
    decade = 1
    while True:
        for digit in _ROUND:
            if digit * decade >= least:
                return digit * decade
        decade *= 10


def _counted_from(seed: int, n_fibres: int, every: int) -> NDArray[np.int64]:
    return np.arange(seed % every, n_fibres, every)
