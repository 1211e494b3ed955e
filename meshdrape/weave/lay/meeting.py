"""A net on a closed or tubular mould ends where it meets itself."""

from __future__ import annotations

import numpy as np

from meshdrape.kernels.meet import spread_on_faces, stop_where_met
from meshdrape.kernels.tables import Lattice, Start
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.status import NodeStatus

# A quadrant folds once it encloses pi / 2 of curvature. A disk with less than this in all, rad, cannot bring a sheet
# round on itself.
HARMLESS_CURVATURE = np.pi
# On faces below this many spacings across, but not below this share of a cell, where two layers would hardly ever have
# nodes on one face, far-apart indices on one face are proof either way,
SMALL_FACE = 4.0
SMALLEST_FACE = 0.1
# and worth looking for in a net of more than this many nodes.
LARGE_NET = 30_000


def end_where_met(mould: Surface, surface: Surface, fabric: Fabric, lattice: Lattice, start: Start) -> int:
    """Mark MET_ITSELF every node that lies where the net already lies, and all behind it; their number.

    Nodes are gone through by their distance from the seed in the lattice, so the outcome is one, whatever the order
    in which they were placed.

    Parameters
    ----------
    mould : Surface
        The draped part, without its collar.
    surface : Surface
        With it.
    """
    if _cannot_meet(mould):
        return 0
    mesh = surface.unfolding
    spacing = fabric.shortest
    diameter = surface.face_diameter
    cell = fabric.warp_spacing * fabric.weft_spacing
    largest = float(diameter[: len(mould.faces)].max())
    small = largest < SMALL_FACE * spacing and float(np.median(mould.face_area)) > SMALLEST_FACE * cell
    window = np.empty((len(diameter), 4), dtype=np.int64)
    # collar faces reach far out; on them windows say nothing
    measured = np.where(np.arange(len(diameter)) < len(mould.faces), diameter, np.inf)
    if (
        small
        and np.count_nonzero(lattice.status <= NodeStatus.OFF_MOULD) > LARGE_NET
        and not spread_on_faces(lattice, window, measured, spacing)
    ):
        return 0
    i, j = np.nonzero(lattice.status <= NodeStatus.OFF_MOULD)
    i0, j0 = start.origin
    ring = np.abs(i - i0) + np.abs(j - j0)
    order = np.stack([i, j], axis=1)[np.lexsort((j, i, ring))]
    position = np.full((*lattice.status.shape, 3), np.nan)
    frame = mesh.frame[lattice.face[i, j]]
    position[i, j] = frame[:, :3] + lattice.xy[i, j, :1] * frame[:, 3:6] + lattice.xy[i, j, 1:] * frame[:, 6:9]
    spacings = (fabric.warp_spacing, fabric.weft_spacing)
    return int(stop_where_met(mesh, lattice, start.origin, position, order, *spacings))


def _cannot_meet(mould: Surface) -> bool:
    """Whether the mould is a disk, holes apart, with too little curvature to bring a sheet back to itself."""
    outlines = [loop for loop in mould.border_loops if not mould.is_hole(loop)]
    if len(outlines) != 1:
        return False
    inner = ~mould.border_vertex
    return float(np.abs(mould.vertex_defect[inner]).sum()) < HARMLESS_CURVATURE
