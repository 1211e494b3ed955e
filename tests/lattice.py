"""Reading a net by offsets from its seed, so that tests need not know how far it reaches."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

import meshdrape

FloatArray = NDArray[np.float64]


def _read(values: NDArray, i: ArrayLike, j: ArrayLike, missing: object) -> NDArray:
    i, j = np.broadcast_arrays(np.asarray(i), np.asarray(j))
    inside = (i >= 0) & (j >= 0) & (i < values.shape[0]) & (j < values.shape[1])
    found = np.full((*i.shape, *values.shape[2:]), missing, dtype=values.dtype)
    found[inside] = values[i[inside], j[inside]]
    return found


def nodes_at(net: meshdrape.Net, i: ArrayLike, j: ArrayLike) -> FloatArray:
    """Positions, mm, of the nodes (i, j) counted from the seed; NaN where there is none."""
    i0, j0 = net.seed_index
    return _read(net.node_position, np.asarray(i) + i0, np.asarray(j) + j0, np.nan)


def statuses_at(net: meshdrape.Net, i: ArrayLike, j: ArrayLike) -> NDArray[np.uint8]:
    """Statuses of the nodes (i, j) counted from the seed; OUTSIDE beyond the net's arrays."""
    i0, j0 = net.seed_index
    return _read(net.node_status, np.asarray(i) + i0, np.asarray(j) + j0, int(meshdrape.NodeStatus.OUTSIDE))


def cells_at(net: meshdrape.Net, shear: FloatArray, i: ArrayLike, j: ArrayLike) -> FloatArray:
    """Of an array by cell, the cells between the nodes (i, j) and (i + 1, j + 1) counted from the seed; NaN beyond."""
    i0, j0 = net.seed_index
    return _read(shear, np.asarray(i) + i0, np.asarray(j) + j0, np.nan)


def offsets(net: meshdrape.Net) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Lattice indices i, j of every node, counted from the seed, each (n_warp, n_weft)."""
    i, j = np.indices(net.shape)
    return i - net.seed_index[0], j - net.seed_index[1]


def placed(net: meshdrape.Net) -> NDArray[np.bool_]:
    """Nodes that have a position."""
    return net.node_status <= meshdrape.NodeStatus.OFF_MOULD


def planar_lattice(
    net: meshdrape.Net, origin: ArrayLike, warp_at: float, initial_angle: float = np.pi / 2
) -> FloatArray:
    """Where the nodes of an unsheared sheet lie in the plane z = 0, (n_warp, n_weft, 3)."""
    i, j = offsets(net)
    weft_at = warp_at + initial_angle
    warp = net.fabric.warp_spacing * np.array([np.cos(warp_at), np.sin(warp_at), 0.0])
    weft = net.fabric.weft_spacing * np.array([np.cos(weft_at), np.sin(weft_at), 0.0])
    return np.asarray(origin) + i[..., None] * warp + j[..., None] * weft


def shear_deg(net: meshdrape.Net) -> FloatArray:
    """Signed shear of every cell, degrees."""
    return np.degrees(meshdrape.measure(net).cell_shear)
