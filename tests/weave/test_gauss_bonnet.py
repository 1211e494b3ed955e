"""Cell by cell: the interior angles less 2 pi are the angle defects inside, to round-off, on any mesh.

Angles, lengths and what lies inside are found from node positions alone, by laying strips of triangles flat, with none
of the package's kernels. The moulds are graphs over the plane, where a cell's inside can be seen from above.
"""

import numpy as np
import pytest
from moulds import bumpy, hypar
from unfolding import straight_line

import meshdrape
from meshdrape.surface import Surface

MOULDS = {
    "cells below triangles": (bumpy(0), 5.0, (3, 5, 0), 90),
    "cells above triangles": (bumpy(1, n=40), 7.3, (-11, 13, 0), 90),
    "steep, cloth of 70 degrees": (bumpy(4, height=40), 6.0, (3, 5, 0), 70),
    "hypar": (hypar(1.0, 0.1, 15), 9.0, (12, -17, 0), 90),
}


class Corners:
    """Nodes of a net by position alone, and the straight lines between them."""

    def __init__(self, net: meshdrape.Net) -> None:
        self.net, self.surface = net, net.mould.surface
        self.lines = {}

    def face(self, node):
        return self.surface.closest_point(self.net.node_position[node])[0].face

    def line(self, a, b):
        if (a, b) not in self.lines:
            p = self.net.node_position
            self.lines[a, b] = straight_line(
                self.surface, self.face(a), p[a], self.face(b), p[b], self.net.fabric.warp_spacing
            )
            assert self.lines[a, b] is not None, (a, b)
        return self.lines[a, b]

    def angle(self, at, first, second):
        """Interior angle at a node, counter-clockwise from one edge to another as seen against the normal."""
        u, v = self.line(at, first).direction, self.line(at, second).direction
        normal = self.surface.face_normal[self.face(at)]
        return np.arctan2(np.cross(u, v) @ normal, u @ v) % (2 * np.pi)

    def outline(self, ring):
        """The cell seen from above, (k, 2)."""
        points = []
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            points += [self.net.node_position[a][None], self.line(a, b).crossings]
        return np.concatenate(points)[:, :2]


def inside(polygon, points):
    """Whether each point (n, 2) lies in a polygon, by the winding of its corners about it."""
    ray = polygon[None] - points[:, None]
    following = np.roll(ray, -1, axis=1)
    turn = np.arctan2(ray[..., 0] * following[..., 1] - ray[..., 1] * following[..., 0], (ray * following).sum(axis=-1))
    return np.abs(turn.sum(axis=1)) > np.pi


@pytest.fixture(scope="module", params=MOULDS)
def cells(request):
    """A net, sixty whole cells of it by their rings of nodes, and their corners."""
    mesh, spacing, seed, degrees = MOULDS[request.param]
    mould = mesh.mould()
    seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    fabric = meshdrape.Fabric(spacing, initial_angle=np.radians(degrees))
    net = meshdrape.drape(mould, fabric, seed, (1, 0.3, 0))
    on = net.node_status == meshdrape.NodeStatus.PLACED
    whole = np.argwhere(on[:-1, :-1] & on[1:, :-1] & on[:-1, 1:] & on[1:, 1:])
    chosen = whole[np.random.default_rng(0).permutation(len(whole))[:60]]
    rings = [[(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in chosen.tolist()]
    return net, rings, Corners(net)


def test_edges_are_one_spacing_long(cells):
    net, rings, corners = cells
    for ring in rings:
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            assert corners.line(a, b).length == pytest.approx(net.fabric.warp_spacing, rel=1e-9)


def test_interior_angles_less_two_pi_are_the_enclosed_defects(cells):
    net, rings, corners = cells
    surface: Surface = net.mould.surface
    found_one = 0
    for ring in rings:
        angles = [corners.angle(ring[k], ring[(k + 1) % 4], ring[k - 1]) for k in range(4)]
        enclosed = inside(corners.outline(ring), surface.vertices[:, :2])
        found_one += enclosed.any()
        assert sum(angles) - 2 * np.pi == pytest.approx(surface.vertex_defect[enclosed].sum(), abs=1e-8)
    assert found_one > 10


def test_cell_shear_is_the_initial_angle_less_the_mean_of_the_corners(cells):
    """The corners at (i, j) and (i + 1, j + 1) as they are, the other two as supplements."""
    net, rings, corners = cells
    shear = meshdrape.measure(net).cell_shear
    for ring in rings:
        angles = np.array([corners.angle(ring[k], ring[(k + 1) % 4], ring[k - 1]) for k in range(4)])
        mean = (angles[0] + angles[2] + 2 * np.pi - angles[1] - angles[3]) / 4
        assert shear[ring[0]] == pytest.approx(net.fabric.initial_angle - mean, abs=1e-8)
