"""Limits that no mould should meet: nodes along one CAD edge, and a length below which it is not divided."""

from __future__ import annotations

import time

import cadquery as cq
import numpy as np
import pytest
from brep_shapes import all_faces

from meshdrape.errors import MouldError
from meshdrape.mould.cad.outline import MANY, Outline
from meshdrape.mould.cad.patch import Nodes


def tube(radius: float, height: float) -> cq.Shape:
    return cq.Workplane().circle(radius).extrude(height).faces("%CYLINDER").val()


def strip(n: int, turn: float) -> Outline:
    """The outline of a strip of n cells, each as long as a segment may be, in parameters that lie askew to it."""
    rim = np.column_stack([np.arange(n + 1.0), np.zeros(n + 1)])
    ring = np.vstack([rim, rim[::-1] + np.array([0.0, 30.0])]) @ [
        [np.cos(turn), np.sin(turn)],
        [-np.sin(turn), np.cos(turn)],
    ]
    k = len(ring)
    space = np.column_stack([ring, np.zeros(k)])
    nodes = Nodes(
        face=np.zeros(k, dtype=np.int64),
        uv=ring,
        position=space,
        normal=np.tile([0.0, 0.0, 1.0], (k, 1)),
        tangent=np.tile([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], (k, 1, 1)),
        metric=np.tile([1.0, 0.0, 1.0], (k, 1)),
        curvature=np.zeros(k),
        pole=np.zeros(k, dtype=bool),
    )
    return Outline(nodes, np.arange(k), np.array([k]))


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_time_to_cut_a_strip_goes_with_its_nodes(turn):
    """Each cell becomes two triangles between its own four nodes, whose common circles cost Qhull no time."""
    n = 30_000
    outline = strip(n, turn)
    assert 2 * n > 10 * MANY
    begun = time.process_time()
    triangles = outline.triangles()
    assert time.process_time() - begun < 6.0  # with the square of the nodes it takes minutes
    assert len(triangles) == 2 * n
    a, b, c = np.moveaxis(outline.nodes.position[triangles], 1, 0)
    np.testing.assert_allclose(np.cross(b - a, c - a), np.tile([0.0, 0.0, 30.0], (2 * n, 1)), rtol=1e-6)
    along = np.where(triangles <= n, triangles, 2 * n + 1 - triangles)
    assert (np.ptp(along, axis=1) == 1).all()


def test_an_edge_of_more_nodes_than_fifty_thousand():
    """A circle is halved until its chords keep within the tolerance, and all of its nodes lie on one circle."""
    disc = cq.Workplane().circle(1000).extrude(10).faces(">Z").val()
    mould = all_faces(disc, chord_tolerance=2e-6)
    longest = np.sqrt(8 * 1000 * 2e-6)
    n = 2 ** int(np.ceil(np.log2(2 * np.pi * 1000 / longest)))
    assert n > 50_000
    assert len(mould.triangles) == n - 2
    assert mould.surface.area == pytest.approx(np.pi * 1000**2, rel=1e-8)


@pytest.mark.parametrize("chord_tolerance", [1e-8, 1e-14])
def test_an_edge_of_too_many_nodes_is_refused_before_they_are_made(chord_tolerance):
    begun = time.process_time()
    with pytest.raises(MouldError) as caught:
        all_faces(tube(1000.0, 100.0), chord_tolerance=chord_tolerance)
    assert time.process_time() - begun < 2.0
    told = "begins at (1000, 0, 100) takes more than 500,000 nodes at these tolerances; make them larger, or mend it"
    assert told in str(caught.value)


def test_a_mould_of_ten_micrometres_is_divided_as_one_of_ten_metres_is():
    """What is taken for a point is far smaller than any feature: angles make a mesh of the same shape at any size."""
    triangles = [
        len(all_faces(tube(radius, radius), chord_tolerance=radius).triangles) for radius in (0.01, 1.0, 10_000.0)
    ]
    assert triangles == [2 * 2**11] * 3  # of 0.2 degrees or less


@pytest.mark.parametrize("tip", [1.1e-7, 2e-6, 1e-5, 1.0])
def test_a_cone_that_all_but_ends_in_a_point_is_cut_as_a_blunt_one(tip):
    """Its tip, were it taken for a point, would have fewer nodes than its rim, and facets between them are askew."""
    cone = cq.Solid.makeCone(40, tip, 90).faces("%CONE")
    mould = all_faces(cone)
    assert len(mould.triangles) == 2 * 2**11
    assert mould.surface.area == pytest.approx(np.pi * (40 + tip) * np.hypot(90, 40 - tip), rel=1e-5)
