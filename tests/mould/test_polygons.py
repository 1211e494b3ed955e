"""Faces of more than three corners: cut into triangles without overlap."""

import numpy as np
import pytest
from meshfiles import OFF_SQUARE, stored
from moulds import rotation

from meshdrape.mould.formats.reader import read_mesh


@pytest.mark.parametrize("shift", range(5))
@pytest.mark.parametrize(
    ("outline", "area"),
    [
        ([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)], 10.0),
        ([(0, 0), (4, 0), (1, 1), (0, 4)], 4.0),
        ([(0, -1), (10, 0), (0, 1), (1, 0)], 9.0),
        ([(0, 0), (3, 0), (4, 2), (0, 4)], 11.0),
        ([(0, 0), (5, 0), (5, 5), (4, 5), (4, 1), (1, 1), (1, 5), (0, 5)], 13.0),
    ],
    ids=["M", "arrow", "long arrow", "convex quad", "U"],
)
def test_polygons_are_cut_without_overlap_or_turning_over(tmp_path, outline, area, shift):
    points = np.roll(np.array([[*p, 0.0] for p in outline]), shift, axis=0)
    turn = rotation([1, 2, 3], 0.8)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in (points @ turn.T).tolist()]
    lines.append("f " + " ".join(str(i + 1) for i in range(len(outline))))
    found = read_mesh(stored(tmp_path, "a.obj", "\n".join(lines).encode()))
    a, b, c = (found.vertices[found.triangles[:, k]] @ turn for k in range(3))
    doubled = np.cross(b - a, c - a)[:, 2]
    assert len(doubled) == len(outline) - 2
    assert (doubled > 1e-9).all()
    assert doubled.sum() / 2 == pytest.approx(area, rel=1e-12)
    assert found.notes == ("1 polygon cut into triangles",)


def test_a_warped_quadrilateral_is_cut_along_its_shorter_diagonal(tmp_path):
    content = b"OFF\n4 1 0\n0 0 0\n3 0 0\n4 1 0\n1 1 0.1\n4 0 1 2 3\n"
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert found.triangles.tolist() == [[0, 1, 3], [1, 2, 3]]


def test_faces_of_two_corners_are_left_out_and_said(tmp_path):
    content = b"OFF\n4 3 0\n" + OFF_SQUARE + b"2 0 1\n3 0 1 2\n1 3\n"
    found = read_mesh(stored(tmp_path, "a.off", content))
    assert found.triangles.tolist() == [[0, 1, 2]]
    assert found.notes == ("2 faces of fewer than three corners left out",)
