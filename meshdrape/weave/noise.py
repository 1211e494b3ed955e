"""The shear that a mesh adds of its own, for being made of flat triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]

# An edge bent by more than this is a crease of the mould, not a facet of a curved face.
CREASE = np.radians(10.0)
# A turn or a defect above this at one vertex is a corner or an apex of the mould, not noise.
FEATURE = np.radians(15.0)


def mesh_noise(surface: Surface) -> float:
    """Shear by which the facets alone can falsify a net, rad.

    A vertex carries its neighbourhood's curvature as one angle defect and shears every cell beyond it by as much,
    all at once; where a crease is cut into straight pieces, its direction errs by half the turn from piece to piece.
    The largest of the two over the mesh. Corners, apexes and ends of creases are the mould's own and do not count.
    """
    inner = ~surface.border_vertex
    sharp = _sharp_edges(surface)
    creases = np.zeros(len(surface.vertices), dtype=np.int64)
    face, k = np.nonzero(sharp)
    # each crease edge is met from both its faces and counted at its tail: once at each end
    np.add.at(creases, surface.faces[face, k], 1)
    defect = np.abs(surface.vertex_defect[inner & (creases == 0)])
    smooth = defect[defect < FEATURE]
    noise = float(smooth.max()) if len(smooth) else 0.0
    turns = _crease_turns(surface, sharp, np.flatnonzero(inner & (creases == 2)))
    turns = turns[turns < FEATURE]
    return max(noise, 0.5 * float(turns.max())) if len(turns) else noise


def _sharp_edges(surface: Surface) -> NDArray[np.bool_]:
    """Whether each half-edge, (m, 3), lies on a crease."""
    other = surface.face_neighbour // 3
    bend = np.einsum("md,mkd->mk", surface.face_normal, surface.face_normal[np.maximum(other, 0)])
    return np.asarray((surface.face_neighbour >= 0) & (bend < np.cos(CREASE)))


def _crease_turns(surface: Surface, sharp: NDArray[np.bool_], vertices: NDArray[np.int64]) -> FloatArray:
    """Turn of the crease at each vertex as seen on the flattened side on which it is larger, rad."""
    wanted = np.zeros(len(surface.vertices), dtype=np.bool_)
    wanted[vertices] = True
    face, k = np.nonzero(sharp & wanted[surface.faces])
    flat = surface.face_neighbour.ravel()
    largest = np.zeros(len(surface.vertices))
    for f, corner in zip(face.tolist(), k.tolist(), strict=True):
        # counter-clockwise from this crease edge to the next: one side's angle
        vertex = surface.faces[f, corner]
        side = 0.0
        for _ in range(1000):
            side += surface.corner_angle[f, corner]
            across = 3 * f + (corner + 2) % 3
            if sharp.ravel()[across] or flat[across] < 0:
                break
            f, corner = divmod(int(flat[across]), 3)
        largest[vertex] = max(largest[vertex], abs(np.pi - side))
    return largest[vertices]
