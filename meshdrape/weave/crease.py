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
    angle = _edge_angle(surface)
    other = cad_face[surface.face_neighbour // 3]
    least = np.where(cad_face[:, None] != other, max(CAD_CREASE_ANGLE, 2.0 * (angle_tolerance or 0.0)), CREASE_ANGLE)
    return np.asarray(angle > np.minimum(least, CREASE_ANGLE))


def continued(surface: Surface, crease: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The creases of a mould on its extension too, (m, 3): a crease goes on past the border it ends at.

    Parameters
    ----------
    surface : Surface
        With its extension.
    crease : (n, 3) bool
        Of the mould's own faces, which come first.
    """
    n = len(crease)
    on_crease = np.zeros(len(surface.vertices), dtype=np.bool_)
    face, k = np.nonzero(crease)
    on_crease[surface.faces[face, k]] = on_crease[surface.faces[face, (k + 1) % 3]] = True
    outer = surface.faces[n:]
    touches = on_crease[outer] | on_crease[np.roll(outer, -1, axis=1)]
    # between two faces of the extension: the border itself is none
    inner = surface.face_neighbour[n:] >= 3 * n
    return np.concatenate([crease, touches & inner & (_edge_angle(surface)[n:] > CAD_CREASE_ANGLE)])


def _edge_angle(surface: Surface) -> NDArray[np.float64]:
    """Angle between the normals on both sides of each edge of each face, (m, 3) rad; 0 at a border."""
    inner = surface.face_neighbour >= 0
    normal = surface.face_normal
    other = normal[np.where(inner, surface.face_neighbour // 3, 0)]
    # the chord between two unit vectors is twice the sine of half their angle: sharp for small angles too
    chord = np.linalg.norm(other - normal[:, None], axis=2)
    return np.asarray(np.where(inner, 2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)), 0.0))
