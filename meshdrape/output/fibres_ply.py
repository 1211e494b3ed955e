"""NET.fibres.ply: every n-th fibre of both families as a line."""

from __future__ import annotations

import os
from importlib.metadata import version
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.colour import WARP, WEFT
from meshdrape.output.columns import COLOUR, POSITION, fill
from meshdrape.output.comments import to_comments
from meshdrape.output.fibres import round_step, warp_fibres, weft_fibres
from meshdrape.output.ply import Element, ply_writer

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
    warp, weft = warp_fibres(net, every), weft_fibres(net, every)
    families = [(warp, True, WARP), (weft, False, WEFT)]
    present = [~np.isnan(fibres.position[..., 0]) for fibres, _, _ in families]
    nodes = Element("vertex", sum(int(p.sum()) for p in present), NODE)
    segments = Element("edge", sum(int((p[:, :-1] & p[:, 1:]).sum()) for p in present), SEGMENT)
    made = {"meshdrape": version("meshdrape"), "unit": "mm", "every": every}
    with ply_writer(path, [nodes, segments], to_comments(made)) as ply:
        for (fibres, is_warp, colour), there in zip(families, present, strict=True):
            rows = nodes.rows(int(there.sum()))
            fibre, along = np.nonzero(there)
            across = fibres.number[fibre]
            rows["i"], rows["j"] = (along, across) if is_warp else (across, along)
            fill(rows, POSITION, fibres.position[there])
            fill(rows, COLOUR, np.broadcast_to(colour, (len(rows), 4)))
            ply.write("vertex", rows)
        first = 0
        for (_, _, colour), there in zip(families, present, strict=True):
            rows = segments.rows(int((there[:, :-1] & there[:, 1:]).sum()))
            fill(rows, ("vertex1", "vertex2"), _segments(there, first))
            fill(rows, COLOUR, np.broadcast_to(colour, (len(rows), 4)))
            ply.write("edge", rows)
            first += int(there.sum())


def _segments(there: NDArray[np.bool_], first: int) -> NDArray[np.int64]:
    """Return the vertices at the two ends of each step along the fibres, (n, 2), where both ends are there."""
    vertex = (first - 1 + np.cumsum(there)).reshape(there.shape)
    both = there[:, :-1] & there[:, 1:]
    return np.stack([vertex[:, :-1][both], vertex[:, 1:][both]], axis=1)
