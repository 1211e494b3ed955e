"""Directions about a point: one angle all round it, in faces, on edges and at vertices."""

import numpy as np
import pytest
from moulds import cube, icosphere, step_corner

from meshdrape.kernels.generator import turn_about_vertex
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.start.rays import Rays

PLACES = {
    "in a face": np.array([0.2, 0.3, 0.5]),
    "on an edge": np.array([0.0, 0.4, 0.6]),
    "at a vertex": np.array([0.0, 1.0, 0.0]),
}


@pytest.mark.parametrize("name", PLACES)
@pytest.mark.parametrize("mesh", [cube(100, 2), icosphere(1, 100)])
def test_every_angle_comes_back_from_its_ray(mesh, name):
    surface = Surface.from_arrays(*mesh)
    for face in range(0, len(surface.faces), 7):
        point = SurfacePoint(face, PLACES[name])
        rays = Rays(surface, point)
        for angle in np.linspace(0.01, rays.total - 0.01, 23):
            ray = rays.ray(angle)
            assert rays.angle(ray.face, ray.dx, ray.dy) == pytest.approx(angle, abs=1e-12)
            assert np.hypot(ray.dx, ray.dy) == pytest.approx(1, abs=1e-12)
            at = SurfacePoint.from_frame(surface, ray.face, ray.x, ray.y)
            assert at.position(surface) == pytest.approx(point.position(surface), abs=1e-9)
            # it enters the face it names
            ahead = SurfacePoint.from_frame(surface, ray.face, ray.x + 1e-3 * ray.dx, ray.y + 1e-3 * ray.dy)
            assert ahead.barycentric.min() > -1e-12


@pytest.mark.parametrize("mesh", [cube(100, 2), step_corner(100, 2)])
def test_total_angle_is_the_stars(mesh):
    surface = Surface.from_arrays(*mesh)
    for vertex in np.flatnonzero(~surface.border_vertex):
        face, corner = np.argwhere(surface.faces == vertex)[0]
        rays = Rays(surface, SurfacePoint(int(face), np.eye(3)[corner]))
        assert rays.total == pytest.approx(surface.vertex_angle[vertex], abs=1e-12)
        # counter-clockwise, as the kernel turns
        start = rays.ray(0.1)
        f, k, dx, dy = turn_about_vertex(surface.unfolding, face, corner, start.dx, start.dy, 1.7)
        turned = rays.ray(1.8)
        assert (turned.face, turned.far_edge) == (f, (k + 1) % 3)
        assert (turned.dx, turned.dy) == pytest.approx((dx, dy), abs=1e-12)


def test_in_a_face_and_on_an_edge_it_is_a_full_turn():
    surface = Surface.from_arrays(*cube(100, 2))
    for name in ("in a face", "on an edge"):
        assert Rays(surface, SurfacePoint(3, PLACES[name])).total == pytest.approx(2 * np.pi, abs=1e-12)
