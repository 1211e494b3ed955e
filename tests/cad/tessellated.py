"""A CAD shape as triangles, by the plainest use of Open CASCADE there is."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property

import cadquery as cq
import numpy as np
from numpy.typing import NDArray
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.TopLoc import TopLoc_Location


@dataclass(frozen=True)
class Tessellation:
    """Triangles of a shape, welded where coordinates are equal to the last bit."""

    vertices: NDArray[np.float64]  # (n, 3) mm
    triangles: NDArray[np.int64]  # (m, 3)
    triangle_face: NDArray[np.int64]  # (m,) which CAD face, from 0

    @cached_property
    def triangle_vector(self) -> NDArray[np.float64]:
        """Normal times area of each triangle, (m, 3)."""
        a, b, c = np.moveaxis(self.vertices[self.triangles], 1, 0)
        return np.cross(b - a, c - a) / 2

    @property
    def area(self) -> float:
        return float(np.linalg.norm(self.triangle_vector, axis=1).sum())

    @cached_property
    def edge_uses(self) -> Counter[tuple[int, int]]:
        """How often each directed edge occurs."""
        corners = self.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        return Counter(map(tuple, corners.tolist()))

    @cached_property
    def border(self) -> NDArray[np.int64]:
        """Directed edges without a partner the other way, (k, 2)."""
        return np.array([edge for edge in self.edge_uses if edge[::-1] not in self.edge_uses])

    def vertices_inside(self, face: int) -> NDArray[np.int64]:
        """Vertices that only triangles of this CAD face have, and that are not on the border."""
        inside = np.unique(self.triangles[self.triangle_face == face])
        elsewhere = np.unique(self.triangles[self.triangle_face != face])
        return np.setdiff1d(np.setdiff1d(inside, elsewhere), self.border)


def tessellate(shape: cq.Workplane, chord: float = 0.1, angle: float = np.radians(1.0)) -> Tessellation:
    solid_or_shell = shape.val()
    BRepMesh_IncrementalMesh(solid_or_shell.wrapped, chord, False, angle, False)
    points: list[tuple[float, float, float]] = []
    triangles, owner = [], []
    for index, face in enumerate(solid_or_shell.Faces()):
        mesh = BRep_Tool.Triangulation_s(face.wrapped, TopLoc_Location())
        first = len(points)
        points += [mesh.Node(i).Coord() for i in range(1, mesh.NbNodes() + 1)]
        turn = -1 if face.wrapped.Orientation().name == "TopAbs_REVERSED" else 1
        for i in range(1, mesh.NbTriangles() + 1):
            triangles.append([first + k - 1 for k in mesh.Triangle(i).Get()][::turn])
            owner.append(index)
    vertices, number = np.unique(np.array(points) + 0.0, axis=0, return_inverse=True)
    return Tessellation(vertices, number.reshape(-1)[np.array(triangles)], np.array(owner))
