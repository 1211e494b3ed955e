"""NET.ply: the net with everything known at its nodes and cells, opened by MeshLab as it is.

The file is written and read by blocks of rows: a net of millions of nodes needs no more memory for it than
a small one.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape import __version__
from meshdrape.errors import MeshdrapeError, NetError
from meshdrape.mould.check import FARTHEST
from meshdrape.mould.files import brief
from meshdrape.output.columns import COLOUR, POSITION, SHEAR_FIELDS, fill, fill_shear
from meshdrape.output.comments import from_comments, to_comments
from meshdrape.output.ply import Element, Rows, ply_writer
from meshdrape.output.ply_reader import PlyFile, read_ply
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.fibre import FAMILY
from meshdrape.weave.prescribed import StartFibres, prescribe
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from meshdrape.weave.balance import Balance
    from meshdrape.weave.measures import Measures
    from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]

_PRESCRIBED: Final = ("warp_turn_rad", "weft_turn_rad", "warp_path", "weft_path")
_WARP: Final = ("warp_x", "warp_y", "warp_z")
_WEFT: Final = ("weft_x", "weft_y", "weft_z")

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
        *[(name, "f8") for name in _WARP + _WEFT],
        ("status", "u1"),
    ]
)
CELL: Final = np.dtype(
    [
        ("vertex_indices", "i4", (4,)),
        *SHEAR_FIELDS,
        ("predicted_shear_deg", "f8"),
        ("balance_residual_deg", "f8"),
        ("defect_deg", "f8"),
    ]
)
GAP: Final = np.dtype([("i", "i4"), ("j", "i4"), ("length", "i4"), ("status", "u1")])
SEAL: Final = np.dtype([("sha256", "u1", (32,))])
_BALANCE: Final = ("predicted_shear_deg", "balance_residual_deg", "defect_deg")
LONGEST: Final = 1.1  # a unit direction, and room for round-off
_NODES_PER_BLOCK: Final = 1 << 16  # some 7 MB of rows


@dataclass(frozen=True, eq=False)
class StoredNet:
    """A net read from its file; the names and shapes of the arrays are those of a draped :class:`Net`.

    Attributes
    ----------
    fabric : Fabric
    seed : (3,) float64, mm, on the mould
    direction : (3,) float64
        Unit warp direction at the seed.
    start_fibres : StartFibres
        What was prescribed of the generators.
    generator_nodes : (4,) int
        Nodes on +warp, +weft, -warp, -weft.
    collar_depth : float
        How far the surface went on past the mould's border, mm.
    seed_index : (int, int)
        Indices of the seed node, along warp and along weft.
    node_position : (n_warp, n_weft, 3) float64, mm
        Bit for bit as written; NaN where there is no node.
    node_status : (n_warp, n_weft) uint8, NodeStatus
    warp_direction, weft_direction : (n_warp, n_weft, 3) float64
        Unit tangents, NaN where there is no node.
    cell_shear : (n_warp - 1, n_weft - 1) float64, rad
        Signed; NaN where a corner is missing. The file holds degrees, so the last bit may differ.
    mould_file : Path or None
        The mould's file, found from where the net's file lies now.
    mould_sha256 : str or None
    mould_unit : str
        The unit the mould's file was read in.
    mould_faces : tuple of int
        Ids of the CAD faces chosen; empty for a mesh.
    mould_parameters : tuple of (name, value)
        That a CadQuery script was run with.
    mould_healed, mould_turned : bool
        Whether the mesh was repaired on reading, and whether the cloth lies on the other side of it.
    chord_tolerance, angle_tolerance : float or None
        mm and rad, of the tessellation.
    predicted_shear, balance_residual, cell_defect : (n_warp - 1, n_weft - 1) float64, rad
        The curvature balance as it was written; NaN where there is no whole cell.
    version : str
        Of the meshdrape that wrote the file.
    sealed : bool
        Whether the file still is, byte for byte, what was written.
    """

    fabric: Fabric
    seed: FloatArray
    direction: FloatArray
    start_fibres: StartFibres
    generator_nodes: list[int]
    collar_depth: float
    seed_index: tuple[int, int]
    node_position: FloatArray
    node_status: NDArray[np.uint8]
    warp_direction: FloatArray
    weft_direction: FloatArray
    cell_shear: FloatArray
    mould_file: Path | None
    mould_sha256: str | None
    mould_unit: str
    mould_faces: tuple[int, ...]
    mould_parameters: tuple[tuple[str, Any], ...]
    mould_healed: bool
    mould_turned: bool
    chord_tolerance: float | None
    angle_tolerance: float | None
    predicted_shear: FloatArray
    balance_residual: FloatArray
    cell_defect: FloatArray
    version: str
    sealed: bool


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
        from meshdrape.weave.measures import measure

        measures = measure(net)
    if foretold is None:
        from meshdrape.weave.balance import balance

        foretold = balance(measures)
    status = net.node_status
    has_position = status <= NodeStatus.OFF_MOULD
    gaps = _gaps(status, has_position)
    cells = Element("face", _n_cells(has_position), CELL)
    nodes = Element("vertex", int(has_position.sum()), NODE)
    seal = Element("seal", 1, SEAL)
    elements = [nodes, cells, Element("gap", len(gaps), GAP), seal]
    with ply_writer(path, elements, to_comments(_provenance(net, path))) as ply:
        for start, end in _blocks(*status.shape):
            ply.write("vertex", _node_rows(nodes, net, measures, has_position[start:end], start))
        first = 0  # vertex of the first node in the block
        for start, end in _blocks(status.shape[0] - 1, status.shape[1]):
            ply.write("face", _cell_rows(cells, net, measures, foretold, has_position[start : end + 1], start, first))
            first += int(has_position[start:end].sum())
        ply.write("gap", gaps)
        digest = seal.rows(1)
        digest["sha256"] = np.frombuffer(ply.digest(), dtype=np.uint8)
        ply.write("seal", digest)


def read_net(path: str | os.PathLike[str]) -> StoredNet:
    """Return the net in a PLY file that `write_ply` made.

    Raises
    ------
    FileError
        The file is missing, truncated or not a PLY.
    NetError
        It is a PLY, but not of a net.
    """
    ply = read_ply(path)
    try:
        return _stored_net(Path(path), ply)
    except (KeyError, ValueError, IndexError, TypeError, AttributeError, OverflowError, MeshdrapeError) as error:
        msg = f"{path} is not a net that meshdrape wrote ({brief(_reason(error))}); give the NET.ply of a drape"
        raise NetError(msg) from None


def _reason(error: Exception) -> str:
    return f"it has no {error.args[0]}" if isinstance(error, KeyError) else str(error)


def _blocks(n_rows: int, row_length: int) -> Iterator[tuple[int, int]]:
    """Yield spans of rows of the net, each of a size that stays in the processor's cache."""
    step = max(1, _NODES_PER_BLOCK // row_length)
    for start in range(0, n_rows, step):
        yield start, min(start + step, n_rows)


def _n_cells(has_position: NDArray[np.bool_]) -> int:
    """Count the cells that have all four corners."""
    return sum(
        int(_whole(has_position[start : end + 1]).sum())
        for start, end in _blocks(has_position.shape[0] - 1, has_position.shape[1])
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
    fill(rows, _WARP, warp[has_position])
    fill(rows, _WEFT, weft[has_position])
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
    for name, field in zip(_BALANCE, (foretold.predicted, foretold.residual, foretold.cell_defect), strict=True):
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


def _require_places(node: Rows, arrays: list[FloatArray]) -> None:
    """Raise ValueError for a node whose place is none, or whose directions are longer than one.

    A node alone has none, NaN.
    """
    at = node["i"], node["j"]
    place, warp, weft = (np.abs(array[at]) for array in arrays)
    for what, wrong_at in (
        ("place", ~(place <= FARTHEST).all(axis=1)),  # NaN fails the comparison too
        ("warp direction", (warp > LONGEST).any(axis=1)),
        ("weft direction", (weft > LONGEST).any(axis=1)),
    ):
        wrong = np.flatnonzero(wrong_at)
        if len(wrong):
            msg = f"its node {int(at[0][wrong[0]])}, {int(at[1][wrong[0]])} has no {what}"
            raise ValueError(msg)


def _number(value: Any) -> float | None:
    return None if value is None else float(value)


def _sealed(path: Path, ply: PlyFile) -> bool:
    """Tell whether the file's last bytes are the SHA-256 of all before them."""
    seal = ply.elements["seal"]
    left = path.stat().st_size - seal.nbytes
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while left > 0 and (block := file.read(min(left, 1 << 22))):
            digest.update(block)
            left -= len(block)
    return len(seal) == 1 and seal["sha256"][0].tobytes() == digest.digest()


def _stored_net(path: Path, ply: PlyFile) -> StoredNet:
    made = from_comments(ply.comments)
    n_warp, n_weft = made["nodes"]
    seed, direction = (np.array(made[name], dtype=np.float64) for name in ("seed", "direction"))
    origin = (int(made["seed_index"][0]), int(made["seed_index"][1]))
    if not (seed.shape == direction.shape == (3,) and np.isfinite(direction).all() and direction.any()):
        msg = "its seed or direction is none"
        raise ValueError(msg)
    if not (np.abs(seed) <= FARTHEST).all():
        msg = f"its seed {seed.tolist()} is not a point within {FARTHEST:g} mm"
        raise ValueError(msg)
    if not (0 <= origin[0] < n_warp and 0 <= origin[1] < n_weft):
        msg = f"its seed has the index {origin} in {n_warp} x {n_weft} nodes"
        raise ValueError(msg)
    node, cell, gap = (ply.elements[name] for name in ("vertex", "face", "gap"))
    n_gaps = int(gap["length"].sum())
    if n_warp * n_weft != len(node) + n_gaps:
        msg = f"its {len(node):,} nodes and {n_gaps:,} gaps do not fill {n_warp} x {n_weft}"
        raise ValueError(msg)
    status = np.full((n_warp, n_weft), NodeStatus.NOT_REACHED, dtype=np.uint8)
    arrays = [np.full((n_warp, n_weft, 3), np.nan) for _ in range(3)]
    for start in range(0, len(node), _NODES_PER_BLOCK):
        rows = node[start : start + _NODES_PER_BLOCK]
        at = rows["i"], rows["j"]
        status[at] = rows["status"]
        for array, names in zip(arrays, (POSITION, _WARP, _WEFT), strict=True):
            for k, name in enumerate(names):
                array[(*at, k)] = rows[name]
    _require_places(node, arrays)
    flat = status.ravel()
    for i, j, length, value in gap[["i", "j", "length", "status"]].tolist():
        flat[i * n_weft + j : i * n_weft + j + length] = value
    if int((status <= NodeStatus.OFF_MOULD).sum()) != len(node):
        msg = "some of its nodes share a place"
        raise ValueError(msg)
    shear, *foretold = (np.full((max(n_warp - 1, 0), max(n_weft - 1, 0)), np.nan) for _ in range(4))
    for start in range(0, len(cell), _NODES_PER_BLOCK):
        rows = cell[start : start + _NODES_PER_BLOCK]
        corner = node[rows["vertex_indices"][:, 0]]
        at = corner["i"], corner["j"]
        for field, name in zip((shear, *foretold), ("shear_deg", *_BALANCE), strict=True):
            field[at] = np.radians(rows[name])
    return StoredNet(
        fabric=Fabric(tuple(made["spacing"]), made["initial_angle_rad"], made["locking_angle_rad"]),
        seed=seed,
        direction=direction,
        seed_index=origin,
        start_fibres=prescribe(*(made.get(name) for name in _PRESCRIBED)),
        generator_nodes=[int(n) for n in made["generator_nodes"]],
        collar_depth=float(made["collar_depth"]),
        node_position=arrays[0],
        node_status=status,
        warp_direction=arrays[1],
        weft_direction=arrays[2],
        cell_shear=shear,
        mould_file=None if made["mould_file"] is None else path.parent / made["mould_file"],
        mould_sha256=None if made["mould_sha256"] is None else str(made["mould_sha256"]),
        mould_unit=str(made["mould_unit"]),
        mould_faces=tuple(int(number) for number in made["mould_faces"]),
        mould_parameters=tuple(made["mould_parameters"].items()),
        mould_healed=bool(made["mould_healed"]),
        mould_turned=bool(made["mould_turned"]),
        chord_tolerance=_number(made["chord_tolerance"]),
        angle_tolerance=_number(made["angle_tolerance_rad"]),
        predicted_shear=foretold[0],
        balance_residual=foretold[1],
        cell_defect=foretold[2],
        version=made["meshdrape"],
        sealed=_sealed(path, ply),
    )
