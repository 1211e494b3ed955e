"""Some fibres of a net: every n-th of a family, from end to end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from meshdrape.weave.net import Net

_ROWS_PER_BLOCK: Final = 64
_ROUND: Final = (1, 2, 5)


def warp_fibres(net: Net, number: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the nodes along warp fibres, (n_fibres, n_warp, 3), mm; NaN where there is none.

    Parameters
    ----------
    net : Net
    number : (n_fibres,) int64
        The j of each fibre.
    """
    n_warp = net.node_status.shape[0]
    position = np.empty((len(number), n_warp, 3))
    for start in range(0, n_warp, _ROWS_PER_BLOCK):
        end = min(start + _ROWS_PER_BLOCK, n_warp)
        position[:, start:end] = net.positions(start, end)[:, number].swapaxes(0, 1)
    return position


def weft_fibres(net: Net, number: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the nodes along weft fibres, (n_fibres, n_weft, 3), mm; NaN where there is none.

    Parameters
    ----------
    net : Net
    number : (n_fibres,) int64
        The i of each fibre.
    """
    return np.concatenate([net.positions(i, i + 1) for i in number.tolist()])


def every_nth(n_fibres: int, every: int, through: int) -> NDArray[np.int64]:
    """Return the numbers of every n-th fibre of a family, (k,), the one numbered `through` among them."""
    return np.arange(through % every, n_fibres, every)


def round_step(least: float) -> int:
    """Return the smallest of 1, 2, 5, 10, 20, 50 ... that is not below `least`."""
    decade = 1
    while decade * _ROUND[-1] < least:
        decade *= 10
    return next(digit * decade for digit in _ROUND if digit * decade >= least)
