"""The collar is sewn to all border vertices at once: the same faces as one vertex after the other."""

from itertools import pairwise

import numpy as np
import pytest

from meshdrape.surface import Surface
from meshdrape.weave.lay.collar import _sewn, extended


def one_by_one(vertices, tail, place, spreads, first):
    """Outer vertices and faces in the order of the border: first all fans, then two triangles a border edge."""
    outer, fans, ends = [], [], []
    for i, vertex in enumerate(tail):
        mine = list(spreads[i]) if i in spreads else [place[i]]
        numbers = list(range(first + len(outer), first + len(outer) + len(mine)))
        fans += [(vertex, a, b) for a, b in pairwise(numbers)]
        ends.append((numbers[0], numbers[-1]))
        outer += mine
    strips = []
    for i, a in enumerate(tail):
        after = (i + 1) % len(tail)
        b, outer_a, outer_b = tail[after], ends[i][1], ends[after][0]
        across_a = np.linalg.norm(vertices[b] - outer[outer_a - first])
        across_b = np.linalg.norm(vertices[a] - outer[outer_b - first])
        if across_a < across_b:
            strips += [(b, a, outer_a), (b, outer_a, outer_b)]
        else:
            strips += [(b, a, outer_b), (a, outer_a, outer_b)]
    return np.array(outer), np.array(fans + strips)


@pytest.mark.parametrize("with_fans", [(), (0,), (3, 4, 11)])
def test_faces_are_those_of_one_vertex_after_the_other(with_fans):
    rng = np.random.default_rng(7)
    vertices = rng.normal(size=(40, 3))
    tail = rng.permutation(40)[:12]
    place = rng.normal(size=(12, 3))
    spreads = {i: rng.normal(size=(2 + i % 3, 3)) for i in with_fans}
    outer, faces = _sewn(vertices, tail, place, spreads, 40)
    expected, expected_faces = one_by_one(vertices, tail.tolist(), place, spreads, 40)
    assert np.array_equal(outer, expected)
    assert np.array_equal(faces, expected_faces)


def test_a_square_has_mitres_that_are_cut_alike():
    """Four trapezoids with equal diagonals: which is taken does not hang on round-off."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    for angle in np.linspace(0.1, 3.0, 7):
        c, s = np.cos(angle), np.sin(angle)
        turned = square @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1.0]])
        surface = extended(Surface.from_arrays(turned, [[0, 1, 2], [0, 2, 3]]), 0.3)
        assert surface.faces[2:].tolist() == [
            [1, 0, 4], [1, 4, 5], [2, 1, 5], [2, 5, 6], [3, 2, 6], [3, 6, 7], [0, 3, 7], [0, 7, 4],
        ]  # fmt: skip
        assert surface.area == pytest.approx(1.6**2, rel=1e-12)


def test_border_loops_run_round_each_border_once():
    """A sheet with two holes: every border edge is in one loop, each begins where the one before it ends."""
    n = 12
    q = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.stack([np.stack([q, q + n, q + n + 1], 1), np.stack([q, q + n + 1, q + 1], 1)], axis=1).reshape(-1, 3)
    x, y = np.divmod(np.arange(n * n), n)
    cell = faces.min(axis=1)
    hole = ((x[cell] == 2) & (y[cell] == 3)) | (np.isin(x[cell], [6, 7]) & np.isin(y[cell], [5, 6, 7]))
    surface = Surface.from_arrays(np.stack([x, y, 0 * x], axis=1), faces[~hole])
    loops = surface.border_loops
    assert [len(loop) for loop in loops] == [44, 10, 4]
    assert [surface.is_hole(loop) for loop in loops] == [False, True, True]
    half = np.sort(np.concatenate(loops))
    assert np.array_equal(half, np.flatnonzero(surface.face_neighbour.ravel() < 0))
    for loop in loops:
        tail = surface.faces[loop // 3, loop % 3]
        head = surface.faces[loop // 3, (loop % 3 + 1) % 3]
        assert np.array_equal(head, np.roll(tail, -1))
