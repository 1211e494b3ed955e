"""Corridors: triangles, each next to the one before, from one point of a surface to another."""

from __future__ import annotations

import heapq

import numpy as np
from numpy.typing import NDArray

from meshdrape.surface import Surface, SurfacePoint

# Barycentric distance below which a point lies on an edge or a vertex: round-off.
SNAP = 1e-9
# A section this much longer than the chord may not be the short way; over a right-angled crease it is 1.4 times that.
DETOUR = 1.5


def faces_about(surface: Surface, point: SurfacePoint) -> list[int]:
    """Faces that hold a point: one, two on an edge, all about a vertex."""
    low = np.flatnonzero(point.barycentric <= SNAP)
    face = point.face
    if len(low) == 0:
        return [face]
    if len(low) == 1:
        other = int(surface.face_neighbour[face, (int(low[0]) + 1) % 3])
        return [face] if other < 0 else [face, other // 3]
    corner = int(np.argmax(point.barycentric))
    faces = [face]
    for clockwise in (False, True):
        f, k = face, corner
        while True:
            code = int(surface.face_neighbour[f, k if clockwise else (k + 2) % 3])
            if code < 0:
                break
            f, k = code // 3, (code % 3 + 1) % 3 if clockwise else code % 3
            if f == face:
                return faces
            faces.append(f)
    return faces


def corridor_between(surface: Surface, a: SurfacePoint, b: SurfacePoint) -> list[int]:
    """Faces from a to b, each next to the one before; empty if a and b lie on separate parts.

    Along the plane section through both points and the surface's normal there; where that section runs off the
    surface, or takes a detour, along the chain of faces whose centres are nearest.
    """
    last = set(faces_about(surface, b))
    if a.face in last:
        return [a.face]
    first = faces_about(surface, a)
    for face in first:
        if face in last:
            return [face]
    section = _along_section(surface, a, b, first, last)
    return section if section else _by_centres(surface, a, b, first, last)


def _along_section(surface: Surface, a: SurfacePoint, b: SurfacePoint, first: list[int], last: set[int]) -> list[int]:
    start, end = a.position(surface), b.position(surface)
    chord = end - start
    up = surface.face_normal[a.face] + surface.face_normal[b.face]
    across = np.cross(chord, up)
    size = float(np.linalg.norm(across))
    if size <= 1e-9 * float(np.linalg.norm(chord)):
        return []
    across /= size
    # of the faces that hold a, the one in which the section leads farthest towards b
    leads = [(_exit(surface, face, -1, start, across, chord), face) for face in first]
    (progress, edge, at), face = max(leads, key=lambda lead: lead[0][0])
    if not progress > 0:
        return []
    faces, length, before = [face], 0.0, start
    bound = DETOUR * float(np.linalg.norm(chord))
    while face not in last:
        code = int(surface.face_neighbour[face, edge])
        length += float(np.linalg.norm(at - before))
        if code < 0 or length > bound:
            return []
        face, before = code // 3, at
        _, edge, at = _exit(surface, face, code % 3, start, across, chord)
        if edge < 0:
            return []
        faces.append(face)
    return faces


def _exit(
    surface: Surface,
    face: int,
    entered: int,
    start: NDArray[np.float64],
    across: NDArray[np.float64],
    chord: NDArray[np.float64],
) -> tuple[float, int, NDArray[np.float64]]:
    """Where the section leaves a face: how far along the chord, over which edge, and the place; edge -1 if nowhere."""
    corners = surface.vertices[surface.faces[face]]
    height = (corners - start) @ across
    best: tuple[float, int, NDArray[np.float64]] = (-np.inf, -1, start)
    for k in range(3):
        h, g = float(height[k]), float(height[(k + 1) % 3])
        if k == entered or (h >= 0) == (g >= 0):
            continue
        at = corners[k] + h / (h - g) * (corners[(k + 1) % 3] - corners[k])
        progress = float((at - start) @ chord)
        if progress > best[0]:
            best = (progress, k, at)
    return best


def _by_centres(surface: Surface, a: SurfacePoint, b: SurfacePoint, first: list[int], last: set[int]) -> list[int]:
    """The chain of faces from centre to centre of least length (A* search)."""
    start, end = a.position(surface), b.position(surface)

    def centre(face: int) -> NDArray[np.float64]:
        return np.asarray(surface.vertices[surface.faces[face]].mean(axis=0))

    parent: dict[int, int] = {}
    cost = {face: float(np.linalg.norm(centre(face) - start)) for face in first}
    queue = [(length + float(np.linalg.norm(centre(face) - end)), face) for face, length in cost.items()]
    heapq.heapify(queue)
    done: set[int] = set()
    while queue:
        _, face = heapq.heappop(queue)
        if face in done:
            continue
        done.add(face)
        if face in last:
            faces = [face]
            while faces[-1] in parent:
                faces.append(parent[faces[-1]])
            return faces[::-1]
        here = centre(face)
        for code in surface.face_neighbour[face].tolist():
            if code < 0 or code // 3 in done:
                continue
            there = centre(code // 3)
            length = cost[face] + float(np.linalg.norm(there - here))
            if length < cost.get(code // 3, np.inf):
                cost[code // 3] = length
                parent[code // 3] = face
                heapq.heappush(queue, (length + float(np.linalg.norm(there - end)), code // 3))
    return []
