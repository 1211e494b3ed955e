"""Creases of a mould: the edges at which a start fibre may be turned."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

# Normals that differ by more than this, rad, make an edge of any mesh a crease: facets of a curved face stay below.
CREASE_ANGLE = math.radians(20.0)
# Between two faces of a CAD file the facets' own angle is known, and so little more is enough.
CAD_CREASE_ANGLE = math.radians(2.0)


def crease_edges(
    surface: Surface, cad_face: NDArray[np.int64], angle_tolerance: float | None = None
) -> NDArray[np.bool_]:
    """Whether each edge of each face is a crease, (m, 3).

    The normals of an edge's two triangles differ there by more than 20 degrees; where it parts two faces of a CAD
    file, by more than 2 degrees and twice the angle tolerance of the tessellation.

    Parameters
    ----------
    surface : Surface
    cad_face : (m,) int
        Id of the CAD face each triangle lies on, 0 where there is none.
    angle_tolerance : float, optional
        Of the tessellation, rad.
    """
    across = surface.face_neighbour // 3
    inner = surface.face_neighbour >= 0
    normal = surface.face_normal
    other = normal[np.where(inner, across, 0)]
    sine = np.linalg.norm(np.cross(normal[:, None], other), axis=2)
    angle = np.arctan2(sine, np.einsum("md,mkd->mk", normal, other))
    parted = cad_face[:, None] != cad_face[np.where(inner, across, 0)]
    least = np.where(parted, max(CAD_CREASE_ANGLE, 2.0 * (angle_tolerance or 0.0)), CREASE_ANGLE)
    return np.asarray(inner & (angle > np.minimum(least, CREASE_ANGLE)))
