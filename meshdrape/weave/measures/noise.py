"""The shear that a mesh adds of its own, for being made of flat triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# An edge bent by more than this is a crease of the mould, not a facet of a curved face.
CREASE = np.radians(10.0)
# A turn or a defect above this at one vertex is a corner or an apex of the mould, not noise.
FEATURE = np.radians(15.0)
# A triangle less high over an edge than this share of it is a needle: how it stands tells nothing of a crease.
NEEDLE = 0.02
# Standard deviations stated. Fibres along rows of vertices meet with many errors of one sign, so a normal law's two are
# too few: of some sixty pairs of net and mesh with known shear, one had a cell beyond three.
SIGMAS = 3.0


def mesh_noise(surface: Surface) -> float:
    """Shear by which hardly a cell of a net is off for being laid on facets, rad.

    Three standard deviations of what angle defects do, together with half the largest turn of a crease from one
    straight piece to the next, by which its direction errs. Corners, apexes and ends of creases are the mould's own and
    do not count. A net's typical error is a third of it; the largest of any cell is near it, or below.

    Notes
    -----
    A cell's shear is the curvature in its fabric rectangle (Hazzidakis 1879). A vertex carries its neighbourhood's all
    at once, so where the rectangle's outline cuts through that neighbourhood the share it takes is all or nothing: an
    error of variance d^2 / 12 for a defect d. An outline of length P cuts P w / A of the neighbourhoods of width w on
    an area A, each vertex's own being about as wide as its edges are long. P is that of a rectangle as long as the
    mould and of its area; or, where only a part of the mould is curved, of a square of that part.
    """
    sharp = _sharp_edges(surface)
    inner = ~surface.border_vertex
    face, k = np.nonzero(sharp)
    # each crease edge is met from both its faces and counted at its tail: once at each end
    creases = np.bincount(surface.faces[face, k], minlength=len(surface.vertices))
    facets = _coarse(surface, sharp, creases)
    spread = _spread(surface, inner & ((creases == 0) | facets))
    turns = _crease_turns(surface, sharp, np.flatnonzero(inner & (creases == 2)))
    turns = turns[turns < FEATURE]
    return float(np.hypot(SIGMAS * spread, 0.5 * turns.max() if len(turns) else 0.0))


def _spread(surface: Surface, counted: BoolArray) -> float:
    """Standard deviation of the curvature in a fabric rectangle, by the defects of the vertices counted, rad."""
    n, faces = len(surface.vertices), surface.faces
    defect = np.where(counted & (np.abs(surface.vertex_defect) < FEATURE), surface.vertex_defect, 0.0)
    corners = np.maximum(np.bincount(faces.ravel(), minlength=n), 1)
    edge = np.linalg.norm(surface.vertices[faces] - surface.vertices[np.roll(faces, -1, axis=1)], axis=2)
    width = np.bincount(faces.ravel(), edge.ravel(), minlength=n) / corners
    area = np.bincount(faces.ravel(), np.repeat(surface.face_area / 3, 3), minlength=n)
    error = defect**2 / 12 * width
    total = float(error.sum())
    if total == 0.0:
        return 0.0
    # the area that would hold as much, were it everywhere as on the average
    curved = total**2 / float((error**2 / np.maximum(area, np.finfo(float).tiny)).sum())
    length = surface.diagonal
    per_area = max(2 * (length + surface.area / length) / surface.area, 4 / np.sqrt(curved))
    return float(np.sqrt(total * per_area))


def _sharp_edges(surface: Surface) -> BoolArray:
    """Whether each half-edge, (m, 3), lies on a crease."""
    other = surface.face_neighbour // 3
    bend = np.einsum("md,mkd->mk", surface.face_normal, surface.face_normal[np.maximum(other, 0)])
    edge = surface.vertices[np.roll(surface.faces, -1, axis=1)] - surface.vertices[surface.faces]
    height = 2 * surface.face_area[:, None] / np.einsum("mkd,mkd->mk", edge, edge)
    stands = height > NEEDLE
    across = stands.ravel()[np.maximum(surface.face_neighbour, 0)]
    return np.asarray((surface.face_neighbour >= 0) & (bend < np.cos(CREASE)) & stands & across)


def _coarse(surface: Surface, sharp: BoolArray, creases: NDArray[np.int64]) -> BoolArray:
    """Whether each vertex is one of a curved face cut so coarsely that all its edges are sharp, (n,).

    It has three of them or more, to three or more vertices alike; a corner of the mould has few such neighbours.
    """
    many = (creases >= 3) & ~surface.border_vertex
    face, k = np.nonzero(sharp)
    alike = many[surface.faces[face, (k + 1) % 3]].astype(np.float64)
    return np.asarray(many & (np.bincount(surface.faces[face, k], alike, minlength=len(many)) >= 3))


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
