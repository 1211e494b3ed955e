"""Locally shortest paths: the string pulled tight between two points of a surface.

A corridor of triangles is unfolded and the string in it pulled tight by the funnel algorithm; where it then bends about
a vertex that is nearer the other way round, the corridor is led there, until nothing gives.

References
----------
S.-Q. Xin, G.-J. Wang, Efficiently determining a locally exact shortest path on polyhedral surfaces, 2007.
D. T. Lee, F. P. Preparata, Euclidean shortest paths in the presence of rectilinear barriers, 1984 (the funnel).
"""

from __future__ import annotations

import cmath
import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import StartError
from meshdrape.geodesic.corridor import corridor_between
from meshdrape.surface import Surface, SurfacePoint

# A point this near to a side of its triangle, relative to the triangle, lies on it: round-off.
ON_EDGE = 1e-10
# The other way round a vertex is shorter if it is below half a turn by more than this, rad: round-off.
STRAIGHT = 1e-9
# Pieces shorter than this share of the longest are round-off where a path touches a triangle.
SPECK = 1e-9
# Rounds of leading the corridor about vertices; each shortens the path, so only a broken mesh needs as many.
MAX_ROUNDS = 10_000


class Piece(NamedTuple):
    """A straight piece of a path in one triangle, its ends in the triangle's frame as complex numbers x + iy, mm."""

    face: int
    tail: complex
    head: complex

    @property
    def direction(self) -> complex:
        """Unit direction; 0 of a piece of no length."""
        along = self.head - self.tail
        return along / (abs(along) or 1.0)


class _Gate(NamedTuple):
    """A side between the corridor's triangles: its ends left and right of the path in the plane, and as vertices."""

    left: complex
    right: complex
    left_vertex: int
    right_vertex: int


class _Bend(NamedTuple):
    """Where the path may bend: a place in the plane, the gate it was found at, and its vertex (-1 at both ends)."""

    place: complex
    gate: int
    vertex: int


def shortest_path(surface: Surface, a: SurfacePoint, b: SurfacePoint, corridor: list[int] | None = None) -> list[Piece]:
    """A locally shortest path from a to b, as straight pieces from triangle to triangle.

    It bends only at vertices where neither side has less than half a turn, or at the border. Nearby points get the
    shortest path; far ones one that no small move shortens.

    Parameters
    ----------
    surface : Surface
    a, b : SurfacePoint
    corridor : list of int, optional
        Faces, each next to the one before, from a's to b's: where to look first.

    Returns
    -------
    list of Piece
        At least one, of no length where a and b are one point.

    Raises
    ------
    StartError
        If the points lie on separate parts of the surface.
    """
    faces = corridor_between(surface, a, b) if corridor is None else list(corridor)
    if not faces:
        msg = f"the points on faces {a.face} and {b.face} lie on separate parts of the surface: no path joins them"
        raise StartError(msg)
    start, end = _in_face(surface, a, faces[0]), _in_face(surface, b, faces[-1])
    for _ in range(MAX_ROUNDS):
        faces, start, end = _trimmed(surface, _without_returns(faces), start, end)
        gates, to_plane = _unfolded(surface, faces)
        finish = _into_plane(to_plane[-1], end)
        bends = _funnel(start, finish, gates)
        led = _led_round(surface, faces, gates, bends)
        if led is None:
            break
        faces = led
    return _pieces(faces, gates, to_plane, bends)


def path_length(pieces: list[Piece]) -> float:
    """Length of a path, mm."""
    return math.fsum(abs(piece.head - piece.tail) for piece in pieces)


def _in_face(surface: Surface, point: SurfacePoint, face: int) -> complex:
    """A point in the frame of a face that holds it."""
    if point.face == face:
        return complex(*point.in_frame(surface))
    frame = surface.unfolding.frame[face]
    off = point.position(surface) - frame[:3]
    return complex(float(off @ frame[3:6]), float(off @ frame[6:9]))


Motion = tuple[complex, complex]


def _crossing(surface: Surface, face: int, edge: int) -> Motion:
    """Rigid motion z -> r z + t from the frame of a face to that across one of its edges."""
    c, s, tx, ty = surface.unfolding.crossing[face, 4 * edge : 4 * edge + 4].tolist()
    return complex(c, s), complex(tx, ty)


def _into_plane(motion: Motion, place: complex) -> complex:
    return motion[0] * place + motion[1]


def _edge_between(surface: Surface, face: int, other: int) -> int:
    for edge, code in enumerate(surface.face_neighbour[face].tolist()):
        if code >= 0 and code // 3 == other:
            return edge
    msg = f"faces {face} and {other} share no edge"
    raise ValueError(msg)


def _on_edge(surface: Surface, face: int, edge: int, place: complex) -> bool:
    nx, ny, offset = surface.unfolding.line[face, 3 * edge : 3 * edge + 3].tolist()
    return bool(nx * place.real + ny * place.imag - offset <= ON_EDGE * float(surface.face_diameter[face]))


def _without_returns(faces: list[int]) -> list[int]:
    """The corridor without dead ends, triangles it enters and leaves by one side."""
    kept: list[int] = []
    for face in faces:
        if len(kept) > 1 and kept[-2] == face:
            kept.pop()
        else:
            kept.append(face)
    return kept


def _trimmed(surface: Surface, faces: list[int], start: complex, end: complex) -> tuple[list[int], complex, complex]:
    """The corridor without first and last triangles that the path only touches, and its ends in the frames left."""
    first, last = 0, len(faces) - 1
    while first < last:
        edge = _edge_between(surface, faces[first], faces[first + 1])
        if not _on_edge(surface, faces[first], edge, start):
            break
        r, t = _crossing(surface, faces[first], edge)
        start = r * start + t
        first += 1
    while first < last:
        edge = _edge_between(surface, faces[last], faces[last - 1])
        if not _on_edge(surface, faces[last], edge, end):
            break
        r, t = _crossing(surface, faces[last], edge)
        end = r * end + t
        last -= 1
    return faces[first : last + 1], start, end


def _unfolded(surface: Surface, faces: list[int]) -> tuple[list[_Gate], list[Motion]]:
    """Gates of the corridor in the plane of its first triangle, and the motion from each triangle's frame to it."""
    motion: Motion = (1.0 + 0.0j, 0.0j)
    motions = [motion]
    gates: list[_Gate] = []
    place: dict[int, complex] = {}
    for face, following in pairwise(faces):
        edge = _edge_between(surface, face, following)
        x1, x2, y2 = surface.unfolding.corner[face].tolist()
        corners = (0.0j, complex(x1, 0.0), complex(x2, y2))
        known, place = place, {}
        for k in (edge, (edge + 1) % 3):
            vertex = int(surface.faces[face, k])
            # a vertex of the gate before keeps its place to the bit
            place[vertex] = known[vertex] if vertex in known else _into_plane(motion, corners[k])
        right, left = int(surface.faces[face, edge]), int(surface.faces[face, (edge + 1) % 3])
        gates.append(_Gate(place[left], place[right], left, right))
        r, t = _crossing(surface, face, edge)
        turn = motion[0] * r.conjugate()
        motion = (turn, motion[1] - turn * t)
        motions.append(motion)
    return gates, motions


def _side(a: complex, b: complex) -> float:
    """Positive where b lies counter-clockwise of a."""
    return a.real * b.imag - a.imag * b.real


def _funnel(start: complex, end: complex, gates: list[_Gate]) -> list[_Bend]:
    """The shortest path through all gates, by its bends, both ends among them."""
    doors = [*gates, _Gate(end, end, -1, -1)]
    apex = left = right = _Bend(start, -1, -1)
    bends = [apex]
    n = 0
    while n < len(doors):
        door = doors[n]
        if _side(right.place - apex.place, door.right - apex.place) >= 0:
            if apex.place in (left.place, right.place) or _side(left.place - apex.place, door.right - apex.place) < 0:
                right = _Bend(door.right, n, door.right_vertex)
            else:
                bends.append(left)
                n = left.gate + 1
                apex = right = left
                continue
        if _side(left.place - apex.place, door.left - apex.place) <= 0:
            if apex.place in (left.place, right.place) or _side(right.place - apex.place, door.left - apex.place) > 0:
                left = _Bend(door.left, n, door.left_vertex)
            else:
                bends.append(right)
                n = right.gate + 1
                apex = left = right
                continue
        n += 1
    bends.append(_Bend(end, len(gates), -1))
    return bends


def _led_round(surface: Surface, faces: list[int], gates: list[_Gate], bends: list[_Bend]) -> list[int] | None:
    """The corridor led the other way round every vertex where that is shorter; None where there is none."""
    found = False
    # from the end, so that what lies before keeps its numbers; a triangle belongs to one change at most
    free = len(faces)
    for before, bend, after in reversed(list(zip(bends, bends[1:], bends[2:], strict=False))):
        incoming, outgoing = bend.place - before.place, after.place - bend.place
        if incoming == 0 or outgoing == 0:
            continue
        gate = gates[bend.gate]
        on_left = gate.left_vertex == bend.vertex
        turn = abs(cmath.phase(outgoing / incoming))
        total = float(surface.unfolding.vertex_angle[bend.vertex])
        if total <= 0 or total - math.pi - turn >= math.pi - STRAIGHT:
            continue
        low = high = bend.gate
        while low > 0 and bend.vertex in gates[low - 1][2:]:
            low -= 1
        while high + 1 < len(gates) and bend.vertex in gates[high + 1][2:]:
            high += 1
        if high + 1 >= free:
            continue
        other = _other_way(surface, bend.vertex, faces[low], faces[high + 1], clockwise=on_left)
        if other is None:
            continue
        faces = faces[:low] + other + faces[high + 2 :]
        free = low
        found = True
    return faces if found else None


def _other_way(surface: Surface, vertex: int, first: int, last: int, *, clockwise: bool) -> list[int] | None:
    """Faces about a vertex from `first` to `last`; None where a border lies between."""
    face, k = first, surface.faces[first].tolist().index(vertex)
    faces = [face]
    while face != last:
        code = int(surface.face_neighbour[face, k if clockwise else (k + 2) % 3])
        if code < 0:
            return None
        face, k = code // 3, (code % 3 + 1) % 3 if clockwise else code % 3
        faces.append(face)
    return faces


def _pieces(faces: list[int], gates: list[_Gate], to_plane: list[Motion], bends: list[_Bend]) -> list[Piece]:
    """The path through the corridor cut at its gates, each piece in the frame of its triangle."""
    pieces: list[Piece] = []
    leg = 0
    tail = bends[0].place
    for n, face in enumerate(faces):
        while leg + 2 < len(bends) and bends[leg + 1].gate < n:
            leg += 1
        head = bends[-1].place if n == len(gates) else _through(gates[n], bends[leg], bends[leg + 1])
        r, t = to_plane[n]
        pieces.append(Piece(face, r.conjugate() * (tail - t), r.conjugate() * (head - t)))
        tail = head
    return [piece for piece in pieces if piece.head != piece.tail] or pieces[:1]


def _through(gate: _Gate, before: _Bend, after: _Bend) -> complex:
    """Where the leg between two bends crosses a gate."""
    for bend in (before, after):
        if bend.vertex >= 0 and bend.vertex in (gate.left_vertex, gate.right_vertex):
            return gate.left if bend.vertex == gate.left_vertex else gate.right
    along, across = after.place - before.place, gate.left - gate.right
    rate = _side(along, across)
    at = 0.5 if rate == 0 else _side(along, before.place - gate.right) / rate
    return gate.right + min(max(at, 0.0), 1.0) * across


def without_specks(pieces: list[Piece]) -> list[Piece]:
    """The pieces long enough to have a direction."""
    longest = max(abs(piece.head - piece.tail) for piece in pieces)
    return [piece for piece in pieces if abs(piece.head - piece.tail) > SPECK * longest] or pieces


def place_of(surface: Surface, face: int, place: complex) -> NDArray[np.float64]:
    """A place in the frame of a face, in space, (3,) mm."""
    frame = surface.unfolding.frame[face]
    return np.asarray(frame[:3] + place.real * frame[3:6] + place.imag * frame[6:9])
