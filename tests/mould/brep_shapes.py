"""B-rep shapes of exactly known faces, and measures of a mould against them. Needs CadQuery."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import cadquery as cq
import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.GeomAPI import GeomAPI_ProjectPointOnSurf
from OCP.gp import gp_Pnt

from meshdrape import Mould
from meshdrape.mould.cad.brep import brep_mould
from meshdrape.mould.cad.shape import of_shape

SAMPLES = Path(__file__).resolve().parents[2] / "samples"


def closed(shape: cq.Workplane) -> Any:
    return shape.val()


SOLIDS: dict[str, Callable[[], Any]] = {
    "box": lambda: closed(cq.Workplane().box(100, 80, 20)),
    "fillet box": lambda: closed(cq.Workplane().box(100, 80, 40).edges().fillet(8)),
    "plate with a hole": lambda: closed(cq.Workplane().box(100, 80, 20).faces(">Z").workplane().hole(30)),
    "sphere": lambda: closed(cq.Workplane().sphere(50)),
    "torus": lambda: cq.Solid.makeTorus(60, 20),
    "cylinder": lambda: closed(cq.Workplane().circle(30).extrude(100)),
    "cone": lambda: cq.Solid.makeCone(40, 0, 90),
    "mirrored fillet box": lambda: closed(cq.Workplane().box(100, 80, 40).edges("|Z").fillet(8)).mirror("XZ"),
    "moved torus": lambda: cq.Solid.makeTorus(60, 20).rotate((0, 0, 0), (1, 2, 3), 40).translate((500, -200, 90)),
}
# mm3, by the formulas of school
VOLUME = {
    "box": 100 * 80 * 20,
    "plate with a hole": 100 * 80 * 20 - np.pi * 15**2 * 20,
    "sphere": 4 / 3 * np.pi * 50**3,
    "torus": 2 * np.pi**2 * 60 * 20**2,
    "moved torus": 2 * np.pi**2 * 60 * 20**2,
    "cylinder": np.pi * 30**2 * 100,
    "cone": np.pi * 40**2 * 90 / 3,
}


@cache
def solid(name: str) -> Any:
    return SOLIDS[name]()


def all_faces(shape: Any, **tolerances: float) -> Mould:
    named = of_shape(shape, Path("shape"))
    return brep_mould(named, "shape", list(range(1, len(named.faces) + 1)), **tolerances)


def signed_volume(mould: Mould) -> float:
    """Enclosed by the triangles, positive where they face outwards, mm3."""
    a, b, c = np.moveaxis(mould.vertices[mould.triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def distance_to(face: Any, points: np.ndarray) -> np.ndarray:
    """From points to a CAD face, within its outline, mm."""
    found = []
    for point in np.atleast_2d(points):
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()
        found.append(BRepExtrema_DistShapeShape(vertex, face.wrapped).Value())
    return np.array(found)


def normals_at(face: Any, points: np.ndarray) -> np.ndarray:
    """Outward normals of a CAD face at the feet of points on its surface, (k, 3); NaN where there is no one foot."""
    found = []
    surface = BRep_Tool.Surface_s(face.wrapped)
    for point in points:
        if GeomAPI_ProjectPointOnSurf(gp_Pnt(*point), surface).NbPoints() == 0:
            found.append((np.nan,) * 3)
        else:
            found.append(face.normalAt(cq.Vector(*point)).toTuple())
    return np.array(found)
