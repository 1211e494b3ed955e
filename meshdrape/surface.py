"""The one surface everything runs on: an immutable, oriented, manifold triangle mesh with its unfolding tables."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import MouldError
from meshdrape.kernels.tables import Unfolding

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A mould this many of its own diagonals from the origin is far off: its coordinates keep their offset's digits, not
# its own. Less it by a number within a factor of two and nothing is rounded.
FAR_OFF = 4.0


@dataclass(frozen=True)
class SurfacePoint:
    """A place on a surface: a face and barycentric coordinates that sum to one.

    Attributes
    ----------
    face : int
    barycentric : (3,) float
    """

    face: int
    barycentric: FloatArray

    @classmethod
    def from_frame(cls, surface: Surface, face: int, x: float, y: float) -> SurfacePoint:
        """The point (x, y), mm, in the frame of a face."""
        x1, x2, y2 = surface.unfolding.corner[face]
        c = y / y2
        b = (x - c * x2) / x1
        return cls(int(face), np.array([1 - b - c, b, c]))

    def position(self, surface: Surface) -> FloatArray:
        """The point in space, shape (3,), mm."""
        return np.asarray(self.barycentric @ surface.vertices[surface.faces[self.face]])

    def in_frame(self, surface: Surface) -> tuple[float, float]:
        """The point in the frame of its face (corner 0 the origin, corner 1 on the x axis), mm."""
        x1, x2, y2 = surface.unfolding.corner[self.face]
        _, b, c = self.barycentric
        return float(b * x1 + c * x2), float(c * y2)


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles, each with the neighbour across each edge.

    Build it with :meth:`from_arrays`, which checks the mesh. Edge k of a face runs from corner k to corner k + 1.

    Attributes
    ----------
    vertices : (n, 3) float64, mm
    faces : (m, 3) int64, counter-clockwise about the normal
    face_neighbour : (m, 3) int64
        3 g + l where edge l of face g lies on the other side; -1 at a border.
    face_rim : (m,) int8
        -1 on the mould; on an extension the edges and corners shared with it (see ``Unfolding.rim``).
    """

    vertices: FloatArray
    faces: IntArray
    face_neighbour: IntArray
    face_rim: NDArray[np.int8]

    @classmethod
    def from_arrays(cls, vertices: ArrayLike, faces: ArrayLike, n_mould_faces: int | None = None) -> Surface:
        """The surface of the given triangles.

        Parameters
        ----------
        vertices : (n, 3) float, mm
        faces : (m, 3) int
        n_mould_faces : int, optional
            Faces from here on are an extension of the mould, not the mould. Default: all are the mould.

        Raises
        ------
        MouldError
            If there are no triangles, an index is out of range, a coordinate is not finite, or an edge has more than
            two triangles, or two that run round it the same way.
        """
        vertices = np.array(vertices, dtype=np.float64, order="C")
        faces = np.array(faces, dtype=np.int64, order="C")
        if not len(faces):
            msg = "the surface has no triangles; it needs at least one"
            raise MouldError(msg)
        if faces.min() < 0 or faces.max() >= len(vertices):
            msg = f"triangles use vertices {faces.min()} to {faces.max()} but there are 0 to {len(vertices) - 1}"
            raise MouldError(msg)
        if not np.isfinite(vertices).all():
            msg = f"vertex {int(np.argmin(np.isfinite(vertices).all(axis=1)))} is not finite; export the mesh anew"
            raise MouldError(msg)
        neighbour = _neighbours(faces)
        rim = _rim(faces, neighbour, len(faces) if n_mould_faces is None else n_mould_faces)
        for array in (vertices, faces, neighbour, rim):
            array.setflags(write=False)
        return cls(vertices, faces, neighbour, rim)

    def continued(self, vertices: FloatArray, faces: IntArray, n_mould_faces: int) -> Surface:
        """The surface with further vertices (k, 3), mm, and faces (l, 3), which follow its own.

        What was measured of its faces one by one holds there too and is handed on.

        Raises
        ------
        MouldError
            As for :meth:`from_arrays`.
        """
        larger = Surface.from_arrays(
            np.concatenate([self.vertices, vertices]), np.concatenate([self.faces, faces]), n_mould_faces
        )
        added = _facets(larger.vertices, larger.faces[len(self.faces) :])
        facets = tuple(np.concatenate(pair) for pair in zip(self._facets, added, strict=True))
        vars(larger)["_facets"] = facets
        return larger

    @cached_property
    def _facets(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Unit normals (m, 3), areas (m,), mm2, and angles at the corners (m, 3), rad."""
        return _facets(self.vertices, self.faces)

    @property
    def face_normal(self) -> FloatArray:
        """Unit normals, (m, 3)."""
        return self._facets[0]

    @property
    def face_area(self) -> FloatArray:
        """Areas, (m,), mm2."""
        return self._facets[1]

    @cached_property
    def area(self) -> float:
        """Area of all faces, mm2."""
        return float(self.face_area.sum())

    @cached_property
    def extent(self) -> FloatArray:
        """Sides of the bounding box, (3,) mm."""
        return np.asarray(np.ptp(self.vertices, axis=0))

    @cached_property
    def diagonal(self) -> float:
        """Diagonal of the bounding box, mm."""
        return float(np.linalg.norm(self.extent))

    @cached_property
    def middle(self) -> SurfacePoint:
        """The point of the surface nearest to its centroid."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return self.closest_point(np.average((a + b + c) / 3, axis=0, weights=self.face_area))[0]

    @cached_property
    def face_diameter(self) -> FloatArray:
        """Longest edge of each face, (m,), mm."""
        x1, x2, y2 = self.unfolding.corner.T
        return np.asarray(np.maximum(x1, np.maximum(np.hypot(x2, y2), np.hypot(x2 - x1, y2))))

    @cached_property
    def longest_edge(self) -> float:
        """Length of the longest edge, mm."""
        return float(self.face_diameter.max())

    @property
    def corner_angle(self) -> FloatArray:
        """Angle of each face at each of its corners, (m, 3), rad."""
        return self._facets[2]

    @cached_property
    def vertex_angle(self) -> FloatArray:
        """Sum of the face angles at each vertex, (n,), rad."""
        weights = self.corner_angle.ravel()
        return np.asarray(np.bincount(self.faces.ravel(), weights, minlength=len(self.vertices)), dtype=np.float64)

    @cached_property
    def border_vertex(self) -> NDArray[np.bool_]:
        """Whether each vertex lies on a border, (n,)."""
        on_border = np.zeros(len(self.vertices), dtype=bool)
        face, k = np.nonzero(self.face_neighbour < 0)
        on_border[self.faces[face, k]] = True
        on_border[self.faces[face, (k + 1) % 3]] = True
        return on_border

    @cached_property
    def vertex_defect(self) -> FloatArray:
        """Angle defect of each vertex, (n,), rad: 2 pi less the face angles inside, pi less them on a border."""
        return np.asarray(np.where(self.border_vertex, np.pi, 2 * np.pi) - self.vertex_angle)

    @cached_property
    def border_loops(self) -> list[IntArray]:
        """Half-edges 3 f + k along each border, the mould on their left; longest loop first."""
        flat = self.face_neighbour.ravel()
        half = np.flatnonzero(flat < 0)
        # turn about the end vertex until the next border edge
        after = _next_in_face(half)
        turning = np.flatnonzero(flat[after] >= 0)
        while len(turning):
            after[turning] = _next_in_face(flat[after[turning]])
            turning = turning[flat[after[turning]] >= 0]
        following = np.searchsorted(half, after).tolist()
        loops = []
        left = [True] * len(half)
        for first in range(len(half)):
            at, loop = first, []
            while left[at]:
                left[at] = False
                loop.append(at)
                at = following[at]
            if loop:
                loops.append(half[loop])
        loops.sort(key=lambda loop: -float(self.half_edge_length(loop).sum()))
        return loops

    def is_hole(self, loop: IntArray) -> bool:
        """Whether a border loop, (k,) half-edges, turns backwards in all.

        By about -2 pi round a hole, 0 round a tube's end, 2 pi round an outline.
        """
        tails = self.faces[loop // 3, loop % 3]
        return float(np.sum(np.pi - self.vertex_angle[tails])) < -np.pi

    def half_edge_length(self, half: IntArray) -> FloatArray:
        """Lengths of half-edges 3 f + k, (k,) mm."""
        face, k = half // 3, half % 3
        ends = self.vertices[self.faces[face, (k + 1) % 3]] - self.vertices[self.faces[face, k]]
        return np.asarray(np.linalg.norm(ends, axis=-1))

    @cached_property
    def face_component(self) -> IntArray:
        """Number of the connected part each face belongs to, (m,), parts in order of their first face."""
        from meshdrape.kernels.components import connected_parts

        face, k = np.nonzero(self.face_neighbour >= 0)
        return connected_parts(face, self.face_neighbour[face, k] // 3, len(self.faces))

    @cached_property
    def mould_part(self) -> Surface:
        """The surface without its extension."""
        n = int(np.count_nonzero(self.face_rim < 0))
        if n == len(self.faces):
            return self
        faces = self.faces[:n]
        return Surface.from_arrays(self.vertices[: int(faces.max()) + 1], faces)

    @cached_property
    def brought_near(self) -> tuple[Surface, FloatArray]:
        """The same surface near the origin, and by how much it was moved, (3,) mm; itself and 0 if it is near.

        Places in space then have the digits that places within a face have. Along each axis the mould is moved only
        from so far off that no coordinate is rounded.
        """
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        middle = 0.5 * low + 0.5 * high
        by = np.where(np.abs(middle) > FAR_OFF * self.diagonal, -middle, 0.0)
        return (self.moved(by) if by.any() else self), by

    def moved(self, by: FloatArray) -> Surface:
        """The surface shifted by (3,) mm; what lies within its faces stays the same to the bit."""
        vertices = self.vertices + by
        vertices.setflags(write=False)
        surface = Surface(vertices, self.faces, self.face_neighbour, self.face_rim)
        frame = self.unfolding.frame.copy()
        frame[:, :3] += by
        vars(surface)["unfolding"] = self.unfolding._replace(frame=frame)
        return surface

    @property
    def n_components(self) -> int:
        """Number of connected parts."""
        return int(self.face_component.max()) + 1

    def component(self, number: int) -> tuple[Surface, IntArray]:
        """One connected part, and the face of this surface behind each of its m faces, (m,)."""
        kept = np.flatnonzero(self.face_component == number)
        used, compact = np.unique(self.faces[kept], return_inverse=True)
        return Surface.from_arrays(self.vertices[used], compact.reshape(-1, 3)), kept

    @cached_property
    def unfolding(self) -> Unfolding:
        """The tables the kernels walk on."""
        return _unfold(self)

    def closest_point(self, position: ArrayLike) -> tuple[SurfacePoint, float]:
        """The point of the surface nearest to `position` (3,), and its distance, mm. O(n_faces)."""
        from meshdrape.kernels.facets import may_be_nearest

        p = np.array(position, dtype=np.float64)
        near = may_be_nearest(self.vertices, self.faces, p)
        faces = self.faces[near]
        weights = _closest_on_triangles(p, *(self.vertices[faces[:, k]] for k in range(3)))
        found = np.einsum("mk,mkd->md", weights, self.vertices[faces])
        distance = np.linalg.norm(found - p, axis=1)
        best = int(np.argmin(distance))
        return SurfacePoint(int(near[best]), weights[best]), float(distance[best])


def _next_in_face(half: IntArray) -> IntArray:
    """The half-edge after each of 3 f + k, round the same face."""
    return np.asarray(half + np.where(half % 3 == 2, -2, 1))


def _neighbours(faces: IntArray) -> IntArray:
    """3 g + l across each edge, (m, 3); -1 at a border."""
    from meshdrape.kernels.facets import pair_edges

    found = np.empty_like(faces)
    if not pair_edges(faces, found):
        _refuse(faces)
    return found


def _refuse(faces: IntArray) -> NoReturn:
    """Name the first half-edge that there is twice."""
    tail = faces.ravel()
    head = faces[:, [1, 2, 0]].ravel()
    key = tail * (int(faces.max()) + 1) + head
    order = np.argsort(key, kind="stable")
    repeated = np.flatnonzero(key[order][1:] == key[order][:-1])
    h = int(order[repeated[0]])
    msg = (
        f"{len(repeated)} edges are run through twice in the same sense, first the edge of vertices {tail[h]} and "
        f"{head[h]}: the mesh is non-manifold or its triangles are not oriented alike; repair it with --heal"
    )
    raise MouldError(msg)


def _rim(faces: IntArray, neighbour: IntArray, n_mould_faces: int) -> NDArray[np.int8]:
    """What each face of an extension shares with the mould: bits 0 to 2 edges, 3 to 5 corners; -1 on the mould."""
    rim = np.full(len(faces), -1, dtype=np.int8)
    outer = faces[n_mould_faces:]
    if len(outer):
        on_mould = np.isin(outer, faces[:n_mould_faces])
        across = neighbour[n_mould_faces:]
        shared = (across >= 0) & (across < 3 * n_mould_faces)
        rim[n_mould_faces:] = np.hstack([shared, on_mould]) @ (1 << np.arange(6))
    return rim


def _facets(vertices: FloatArray, faces: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    from meshdrape.kernels.facets import measure_facets

    m = len(faces)
    normal, area, angle = np.empty((m, 3)), np.empty(m), np.empty((m, 3))
    measure_facets(vertices, faces, normal, area, angle)
    return normal, area, angle


def _unfold(surface: Surface) -> Unfolding:
    from meshdrape.kernels.unfold import unfold

    m = len(surface.faces)
    corner, frame = np.empty((m, 3)), np.empty((m, 9))
    line, crossing, plane = np.empty((m, 9)), np.empty((m, 12)), np.empty((m, 24))
    unfold(surface.vertices, surface.faces, surface.face_neighbour, corner, frame, line, crossing, plane)
    return Unfolding(
        plane=plane,
        line=line,
        crossing=crossing,
        neighbour=surface.face_neighbour.astype(np.int32),
        corner=corner,
        frame=frame,
        vertex=surface.faces.astype(np.int32),
        vertex_angle=np.where(surface.border_vertex, 0.0, surface.vertex_angle),
        rim=np.array(surface.face_rim),
    )


def _closest_on_triangles(p: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Barycentric coordinates (m, 3) of the point of each triangle nearest to p.

    The foot in the plane where it falls inside, else the nearest of the three edges' nearest points.
    """
    u, v = b - a, c - a
    normal = np.cross(u, v)
    double2 = np.einsum("ij,ij->i", normal, normal)
    w = p - a
    beta = np.einsum("ij,ij->i", np.cross(w, v), normal) / double2
    gamma = np.einsum("ij,ij->i", np.cross(u, w), normal) / double2
    best = np.stack([1 - beta - gamma, beta, gamma], axis=1)
    outside = np.flatnonzero((best < 0).any(axis=1))
    nearest = np.full(len(outside), np.inf)
    for k, (s, e) in enumerate(((a, b), (b, c), (c, a))):
        s, e = s[outside], e[outside]
        along = e - s
        t = np.clip(np.einsum("ij,ij->i", p - s, along) / np.einsum("ij,ij->i", along, along), 0, 1)
        distance = np.linalg.norm(s + t[:, None] * along - p, axis=1)
        nearer = np.flatnonzero(distance < nearest)
        nearest[nearer] = distance[nearer]
        rows = np.zeros((len(nearer), 3))
        rows[:, k] = 1 - t[nearer]
        rows[:, (k + 1) % 3] = t[nearer]
        best[outside[nearer]] = rows
    return best
