"""A net read back from its NET.ply, by blocks of rows: of millions of nodes it takes no memory but its arrays."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import MeshdrapeError, NetError
from meshdrape.mould.files import brief
from meshdrape.mould.mesh.check import FARTHEST
from meshdrape.output.ply.columns import POSITION
from meshdrape.output.ply.comments import from_comments
from meshdrape.output.ply.net_elements import BALANCE, PRESCRIBED, WARP, WEFT, blocks
from meshdrape.output.ply.reader import PlyFile, read_ply
from meshdrape.output.ply.writer import Rows
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.prescribed import StartFibres, prescribe
from meshdrape.weave.status import NodeStatus

FloatArray = NDArray[np.float64]

# A unit direction, and room for round-off.
LONGEST: Final = 1.1


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
    for start, end in blocks(len(node)):
        rows = node[start:end]
        at = rows["i"], rows["j"]
        status[at] = rows["status"]
        for array, names in zip(arrays, (POSITION, WARP, WEFT), strict=True):
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
    for start, end in blocks(len(cell)):
        rows = cell[start:end]
        corner = node[rows["vertex_indices"][:, 0]]
        at = corner["i"], corner["j"]
        for field, name in zip((shear, *foretold), ("shear_deg", *BALANCE), strict=True):
            field[at] = np.radians(rows[name])
    return StoredNet(
        fabric=Fabric(tuple(made["spacing"]), made["initial_angle_rad"], made["locking_angle_rad"]),
        seed=seed,
        direction=direction,
        seed_index=origin,
        start_fibres=prescribe(*(made.get(name) for name in PRESCRIBED)),
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
