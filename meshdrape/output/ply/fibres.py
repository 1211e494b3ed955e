"""NET.fibres.ply: every n-th fibre of both families as a line."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape import __version__
from meshdrape.output.colour import WARP, WEFT
from meshdrape.output.fibres import every_nth, round_step, warp_fibres, weft_fibres
from meshdrape.output.ply.columns import COLOUR, POSITION, fill
from meshdrape.output.ply.comments import to_comments
from meshdrape.output.ply.writer import Element, ply_writer

if TYPE_CHECKING:
    from meshdrape.weave.net import Net

_COLOUR_FIELDS: Final = [(name, "u1") for name in COLOUR]
NODE: Final = np.dtype([*[(name, "f8") for name in POSITION], ("i", "i4"), ("j", "i4"), *_COLOUR_FIELDS])
SEGMENT: Final = np.dtype([("vertex1", "i4"), ("vertex2", "i4"), *_COLOUR_FIELDS])
_FIBRES_PER_FAMILY: Final = 50  # lines that can still be told apart on a screen


def write_fibres_ply(net: Net, path: str | os.PathLike[str], every: int | None = None) -> None:
    """Write every n-th fibre of both families as edges, as binary little-endian PLY for MeshLab.

    Vertices are the nodes on the fibres, with `x y z` (mm), `i j` and the colour of their family, warp dark
    and weft purple; a node where two fibres cross is there once for each. Edges, `vertex1 vertex2`, join
    neighbours along a fibre. The fibres through the seed are among them.

    Parameters
    ----------
    net : Net
    path : path-like
    every : int, optional
        Fibres of the net for one in the file, for both families. Left out: as many as make 50 at most.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    if every is None:
        every = round_step(max(net.node_status.shape) / _FIBRES_PER_FAMILY)
    j = every_nth(net.node_status.shape[1], every, net.seed_index[1])
    i = every_nth(net.node_status.shape[0], every, net.seed_index[0])
    families = [_Family(j, warp_fibres(net, j), WARP), _Family(i, weft_fibres(net, i), WEFT)]
    nodes = Element("vertex", sum(int(family.there.sum()) for family in families), NODE)
    segments = Element("edge", sum(int(family.joined.sum()) for family in families), SEGMENT)
    made = {"meshdrape": __version__, "unit": "mm", "every": every}
    with ply_writer(path, [nodes, segments], to_comments(made)) as ply:
        for family, across, along in zip(families, ("j", "i"), ("i", "j"), strict=True):
            rows = nodes.rows(int(family.there.sum()))
            fibre, rows[along] = np.nonzero(family.there)
            rows[across] = family.number[fibre]
            fill(rows, POSITION, family.position[family.there])
            fill(rows, COLOUR, np.broadcast_to(family.colour, (len(rows), 4)))
            ply.write("vertex", rows)
        first = 0  # vertex of the family's first node
        for family in families:
            rows = segments.rows(int(family.joined.sum()))
            fill(rows, ("vertex1", "vertex2"), first + family.segments())
            fill(rows, COLOUR, np.broadcast_to(family.colour, (len(rows), 4)))
            ply.write("edge", rows)
            first += int(family.there.sum())


@dataclass(frozen=True, eq=False)
class _Family:
    """Fibres of one family, (n_fibres, n_nodes, 3), and their numbers in the net."""

    number: NDArray[np.int64]
    position: NDArray[np.float64]
    colour: tuple[int, int, int, int]

    @property
    def there(self) -> NDArray[np.bool_]:
        """Where there is a node, (n_fibres, n_nodes)."""
        return ~np.isnan(self.position[..., 0])

    @property
    def joined(self) -> NDArray[np.bool_]:
        """Where there is one and another after it, (n_fibres, n_nodes - 1)."""
        return self.there[:, :-1] & self.there[:, 1:]

    def segments(self) -> NDArray[np.int64]:
        """Return the nodes at the ends of each step along the fibres, counted over those there, (n, 2)."""
        node = (np.cumsum(self.there) - 1).reshape(self.there.shape)
        return np.stack([node[:, :-1][self.joined], node[:, 1:][self.joined]], axis=1)
