"""Creases of a mould: the edges at which a start fibre may be turned."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshdrape.kernels.facets import chords
from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]

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
    crease = np.zeros(surface.faces.shape, dtype=np.bool_)
    chord = _edge_chord(surface, 0)
    # few edges of a smooth mesh turn by so much at all; a little more are looked at, for round-off of the chord
    face, k = np.nonzero(chord > 0.99 * _chord(CAD_CREASE_ANGLE))
    between = cad_face[face] != cad_face[surface.face_neighbour[face, k] // 3]
    least = np.where(between, max(CAD_CREASE_ANGLE, 2.0 * (angle_tolerance or 0.0)), CREASE_ANGLE)
    crease[face, k] = _angle(chord[face, k]) > np.minimum(least, CREASE_ANGLE)
    return crease


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
    return np.concatenate([crease, touches & inner & (_angle(_edge_chord(surface, n)) > CAD_CREASE_ANGLE)])


def _edge_chord(surface: Surface, first: int) -> FloatArray:
    """Chord between the unit normals on both sides of each edge of the faces from `first` on, (m - first, 3).

    Twice the sine of half the angle between them, so sharp for small angles too; 0 at a border.
    """
    chord = np.empty((len(surface.faces) - first, 3))
    chords(surface.face_normal, surface.face_neighbour, first, chord)
    return chord


def _angle(chord: FloatArray) -> FloatArray:
    """Angle that a chord of the unit circle spans, rad."""
    return np.asarray(2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)))


def _chord(angle: float) -> float:
    """Chord of the unit circle that spans an angle, rad."""
    return 2.0 * math.sin(0.5 * angle)
