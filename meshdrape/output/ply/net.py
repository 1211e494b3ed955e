"""NET.ply: the net with everything known at its nodes and cells, opened by MeshLab as it is.

The file is written by blocks of rows: a net of millions of nodes needs no more memory for it than a small one.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdrape import __version__
from meshdrape.output.ply.columns import POSITION, fill, fill_shear
from meshdrape.output.ply.comments import to_comments
from meshdrape.output.ply.net_elements import BALANCE, CELL, GAP, NODE, SEAL, WARP, WEFT, blocks
from meshdrape.output.ply.writer import Element, Rows, ply_writer
from meshdrape.weave.start.fibre import FAMILY
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.weave.measures.balance import Balance
    from meshdrape.weave.measures.cells import Measures
    from meshdrape.weave.net import Net


def write_ply(
    net: Net,
    path: str | os.PathLike[str],
    measures: Measures | None = None,
    foretold: Balance | None = None,
) -> None:
    """Write a net as binary little-endian PLY.

    Vertices are the nodes that have a position, in rows along the weft: `x y z` (mm), `i j`, colour,
    `quality` (absolute shear, deg; 0 where there is no whole cell), `s t` (mm of cloth from the seed along
    warp and weft), `shear_deg` (signed), `warp_x ... weft_z`, `status`. Faces are the cells, their corners
    counter-clockwise about the mould's normal, with colour, `quality`, `shear_deg` and the curvature balance:
    `predicted_shear_deg`, `balance_residual_deg` (NaN where the fabric rectangle has missing cells) and
    `defect_deg`, the angle defects the cell encloses. A third element, `gap`, holds the statuses of the nodes
    without position as runs; a fourth, `seal`, the SHA-256 of all bytes before it. The comments say how the net
    was made.

    Parameters
    ----------
    net : Net
    path : path-like
    measures : Measures, optional
        Of this net, if they are at hand; else they are taken here.
    foretold : Balance, optional
        Likewise.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    if measures is None:
        from meshdrape.weave.measures.cells import measure

        measures = measure(net)
    if foretold is None:
        from meshdrape.weave.measures.balance import balance

        foretold = balance(measures)
    status = net.node_status
    has_position = status <= NodeStatus.OFF_MOULD
    gaps = _gaps(status, has_position)
    cells = Element("face", _n_cells(has_position), CELL)
    nodes = Element("vertex", int(has_position.sum()), NODE)
    seal = Element("seal", 1, SEAL)
    elements = [nodes, cells, Element("gap", len(gaps), GAP), seal]
    with ply_writer(path, elements, to_comments(_provenance(net, path))) as ply:
        for start, end in blocks(*status.shape):
            ply.write("vertex", _node_rows(nodes, net, measures, has_position[start:end], start))
        first = 0  # vertex of the first node in the block
        for start, end in blocks(status.shape[0] - 1, status.shape[1]):
            ply.write("face", _cell_rows(cells, net, measures, foretold, has_position[start : end + 1], start, first))
            first += int(has_position[start:end].sum())
        ply.write("gap", gaps)
        digest = seal.rows(1)
        digest["sha256"] = np.frombuffer(ply.digest(), dtype=np.uint8)
        ply.write("seal", digest)


def _n_cells(has_position: NDArray[np.bool_]) -> int:
    """Count the cells that have all four corners."""
    return sum(
        int(_whole(has_position[start : end + 1]).sum())
        for start, end in blocks(has_position.shape[0] - 1, has_position.shape[1])
    )


def _whole(has_position: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Tell whether each cell has all four corners, shape one less than of the nodes."""
    along_warp = has_position[:-1] & has_position[1:]
    return along_warp[:, :-1] & along_warp[:, 1:]


def _node_rows(element: Element, net: Net, measures: Measures, has_position: NDArray[np.bool_], start: int) -> Rows:
    end = start + len(has_position)
    i, j = np.nonzero(has_position)
    rows = element.rows(len(i))
    fill(rows, POSITION, net.positions(start, end)[has_position])
    warp, weft = net.directions(start, end)
    fill(rows, WARP, warp[has_position])
    fill(rows, WEFT, weft[has_position])
    rows["i"] = i + start
    rows["j"] = j
    rows["s"] = (rows["i"] - net.seed_index[0]) * net.fabric.warp_spacing
    rows["t"] = (rows["j"] - net.seed_index[1]) * net.fabric.weft_spacing
    rows["status"] = net.node_status[start:end][has_position]
    fill_shear(rows, measures.node_shear(start, end)[has_position], net.fabric.locking_angle)
    return rows


def _cell_rows(
    element: Element,
    net: Net,
    measures: Measures,
    foretold: Balance,
    has_position: NDArray[np.bool_],
    start: int,
    first: int,
) -> Rows:
    whole = _whole(has_position)
    vertex = (first - 1 + np.cumsum(has_position, dtype=np.int32)).reshape(has_position.shape)
    rows = element.rows(int(whole.sum()))
    corners = (vertex[:-1, :-1], vertex[1:, :-1], vertex[1:, 1:], vertex[:-1, 1:])
    for k, corner in enumerate(corners):
        rows["vertex_indices"][:, k] = corner[whole]
    shear = measures.cell_shear[start : start + len(whole)][whole]
    fill_shear(rows, shear, net.fabric.locking_angle)
    for name, field in zip(BALANCE, (foretold.predicted, foretold.residual, foretold.cell_defect), strict=True):
        rows[name] = np.degrees(field[start : start + len(whole)][whole])
    return rows


def _gaps(status: NDArray[np.uint8], has_position: NDArray[np.bool_]) -> Rows:
    """Return the runs of one status among the nodes without position, row after row of the net."""
    without = np.where(has_position, np.uint8(NodeStatus.PLACED), status).ravel()
    start = np.flatnonzero(np.diff(without, prepend=np.uint8(NodeStatus.PLACED)))
    length = np.diff(start, append=without.size)
    kept = without[start] != NodeStatus.PLACED
    rows = Element("gap", int(kept.sum()), GAP).rows(int(kept.sum()))
    rows["i"], rows["j"] = np.divmod(start[kept], status.shape[1])
    rows["length"] = length[kept]
    rows["status"] = without[start[kept]]
    return rows


def _provenance(net: Net, path: str | os.PathLike[str]) -> dict[str, Any]:
    """Return how the net was made, for the comments of its file."""
    mould, fabric = net.mould, net.fabric
    source = None
    if mould.source is not None:
        # told from the net's file, so that the two can move together
        source = Path(os.path.relpath(mould.source, Path(path).parent)).as_posix()
    return {
        "meshdrape": __version__,
        "unit": "mm",
        "spacing": [fabric.warp_spacing, fabric.weft_spacing],
        "initial_angle_rad": fabric.initial_angle,
        "locking_angle_rad": fabric.locking_angle,
        "seed": np.asarray(net.seed).tolist(),
        "direction": np.asarray(net.direction).tolist(),
        **_prescribed(net),
        "generator_nodes": net.generator_nodes,
        "collar_depth": net.collar_depth,
        "seed_index": [int(index) for index in net.seed_index],
        "nodes": list(net.node_status.shape),
        "mould_file": source,
        "mould_sha256": mould.sha256,
        "mould_unit": mould.unit,
        "mould_faces": [face.id for face in mould.cad_faces],
        "mould_parameters": dict(mould.parameters),
        "mould_healed": mould.healing is not None,
        "mould_turned": mould.turned,
        "chord_tolerance": mould.chord_tolerance,
        "angle_tolerance_rad": mould.angle_tolerance,
    }


def _prescribed(net: Net) -> dict[str, Any]:
    """Return what was prescribed of the start fibres, by name; nothing for straight ones."""
    given = net.start_fibres
    values: dict[str, Any] = {}
    for name, turn, path in zip(FAMILY, given.turns, given.paths, strict=True):
        if turn is not None:
            values[f"{name}_turn_rad"] = turn
        if path is not None:
            values[f"{name}_path"] = path.tolist()
    return values
