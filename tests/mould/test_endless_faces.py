"""Faces that no facets can follow, edges with kinks that their curves do not tell of: an end, and a reason."""

from __future__ import annotations

import re
import resource
from pathlib import Path

import cadquery as cq
import numpy as np
import pytest
from brep_shapes import all_faces
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
from OCP.Geom import Geom_BSplineCurve
from OCP.gp import gp_Pnt, gp_Vec
from OCP.TColgp import TColgp_Array1OfPnt
from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal

import meshdrape
from meshdrape.errors import MouldError
from meshdrape.mould.apart import apart

SECONDS, MEMORY = 20.0, 2**32
COARSE = {"chord_tolerance": 1.0, "angle_tolerance": np.radians(5)}


def test_a_rim_that_is_no_curve_any_more(tmp_path):
    """A cylinder whose lower circle has lost its placement: the outline leaves the face there, for ever."""
    path = tmp_path / "cylinder.step"
    cq.exporters.export(cq.Workplane(cq.Workplane().circle(20).extrude(30).faces("%CYLINDER").val()), str(path))
    assert len(meshdrape.read_mould(path, **COARSE).triangles) > 100
    text = path.read_text()
    circles = list(re.finditer(r"CIRCLE\('',#\d+,20\.\)", text))
    assert len(circles) == 2
    path.write_text(text[: circles[1].start()] + "CIRCLE('',#1,20.)" + text[circles[1].end() :])
    with pytest.raises(MouldError, match=r"cylinder\.step: no facets follow face 1, .*mend it in CAD"):
        meshdrape.read_mould(path, **COARSE)


def seconds_of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def test_a_surface_that_one_point_tears_off_its_outline_is_given_up_soon(tmp_path):
    """A control point of the face is one from elsewhere: triangles double every few rounds, and follow nothing."""
    text = (Path(__file__).resolve().parents[2] / "samples/blade_root.step").read_text()
    row = "(#122,#123,#124,#125)"
    assert text.count(row) == 1
    path = tmp_path / "blade.step"
    path.write_text(text.replace(row, row.replace("#123", "#57")))
    begun = seconds_of_children()
    with pytest.raises(MouldError, match=r"blade\.step: no facets follow face 1, .*mend it in CAD"):
        meshdrape.read_mould(path, **COARSE)
    assert seconds_of_children() - begun < 8.0


def angled_wall(corner: int) -> cq.Shape:
    """A wall over a cubic spline with `corner` control points in one place, three of which make a right angle."""
    places = [(0, 0), (20, 0), (40, 0), *[(50, 0)] * corner, (50, 10), (50, 30), (50, 50)]
    poles = TColgp_Array1OfPnt(1, len(places))
    for n, (x, y) in enumerate(places, start=1):
        poles.SetValue(n, gp_Pnt(x, y, 0))
    n_knots = len(places) - 2
    knots, counts = TColStd_Array1OfReal(1, n_knots), TColStd_Array1OfInteger(1, n_knots)
    for n in range(1, n_knots + 1):
        knots.SetValue(n, n**1.3)  # so that no halving meets the kink
        counts.SetValue(n, 4 if n in (1, n_knots) else 1)
    edge = BRepBuilderAPI_MakeEdge(Geom_BSplineCurve(poles, knots, counts, 3)).Edge()
    return cq.Shape.cast(BRepPrimAPI_MakePrism(edge, gp_Vec(0, 0, 30)).Shape())


def size_of_wall(corner: int) -> tuple[float, int]:
    mould = all_faces(angled_wall(corner), **COARSE)
    return mould.surface.area, len(mould.triangles)


@pytest.mark.parametrize("corner", [1, 2])
def test_a_bend_however_sharp_is_followed(corner):
    area, n_triangles = apart(lambda: size_of_wall(corner), SECONDS, MEMORY)
    assert area == pytest.approx(float(angled_wall(corner).Area()), rel=0.01)
    assert n_triangles < 400


def test_a_kink_that_the_curve_does_not_tell_of():
    """A diagonal over it turns by 90 degrees however short its segment of the edge is."""
    with pytest.raises(MouldError, match=r"no facets follow face 1|cannot be draped"):
        apart(lambda: size_of_wall(3), SECONDS, MEMORY)


def test_an_edge_that_goes_on_for_ever(tmp_path):
    path = tmp_path / "saddle.step"
    text = (Path(__file__).resolve().parents[2] / "samples/saddle.step").read_text()
    # an end of the first curve of the outline
    at = re.search(r"B_SPLINE_CURVE_WITH_KNOTS\('',2,\((#\d+)", text)
    assert at is not None
    path.write_text(
        re.sub(rf"{at[1]} = CARTESIAN_POINT\([^;]*;", f"{at[1]} = CARTESIAN_POINT('',(1.E+15,0.,0.));", text)
    )
    with pytest.raises(meshdrape.MeshdrapeError, match=r"saddle\.step: .*; mend it in CAD"):
        meshdrape.read_mould(path)
