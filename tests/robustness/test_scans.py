"""Meshes as scanners and mesh tools leave them: noisy, decimated, resampled, in several parts, in single precision."""

import numpy as np
import pytest
from moulds import icosphere

import meshdrape
from meshdrape import NodeStatus
from meshdrape.weave import read_off


def _meshlab(vertices, triangles):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(vertices, triangles))
    return meshes


def _bowl(noise):
    """A double-curved bowl of 600 mm on a grid of 45,000 triangles, with noise normal to it, mm."""
    side = np.linspace(-300, 300, 151)
    x, y = np.meshgrid(side, side, indexing="ij")
    z = 0.0006 * x**2 + 0.0003 * y**2 + np.random.default_rng(5).normal(0, noise, x.shape)
    n = len(side)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    a = (i * n + j).ravel()
    triangles = np.concatenate([np.stack([a, a + n, a + n + 1], axis=1), np.stack([a, a + n + 1, a + 1], axis=1)])
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), triangles


def noisy():
    return _bowl(noise=0.02)


def decimated():
    meshes = _meshlab(*_bowl(noise=0.01))
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=6000, preserveboundary=True)
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def resampled():
    """Marching cubes round a ball: slivers everywhere, closed."""
    import pymeshlab

    ball = icosphere(4, 200.0)
    meshes = _meshlab(ball.vertices, ball.triangles)
    meshes.generate_resampled_uniform_mesh(cellsize=pymeshlab.PureValue(7.0))
    mesh = meshes.current_mesh()
    return mesh.vertex_matrix(), mesh.face_matrix()


def in_parts():
    """The noisy bowl, a ball beside it, and a speck of two triangles."""
    bowl, ball = noisy(), icosphere(3, 80.0)
    speck = np.array([[900.0, 0, 0], [901, 0, 0], [900, 1, 0], [901, 1, 0.2]])
    vertices = np.concatenate([bowl[0], ball.vertices + np.array([600.0, 0, 0]), speck])
    n, m = len(bowl[0]), len(ball.vertices)
    triangles = np.concatenate([bowl[1], ball.triangles + n, np.array([[0, 1, 2], [1, 3, 2]]) + n + m])
    return vertices, triangles


def single_precision():
    vertices, triangles = noisy()
    return (vertices + 5000.0).astype(np.float32).astype(np.float64), triangles


SCANS = {make.__name__: make for make in (noisy, decimated, resampled, in_parts, single_precision)}


@pytest.mark.parametrize("name", SCANS)
@pytest.mark.parametrize("spacing", [4.0, 25.0])
def test_a_scan_is_draped(name, spacing):
    vertices, triangles = SCANS[name]()
    mould = meshdrape.Mould.from_arrays(vertices, triangles)
    surface = mould.surface
    top = np.argmin(np.linalg.norm(vertices - np.median(vertices, axis=0), axis=1))
    seed = surface.closest_point(vertices[top] + (1.3, 0.7, 0))[0].position(surface)
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed=seed, direction=(1, 0.2, 0.1))
    found = meshdrape.audit(net, 150, seconds=5)
    assert found.n_edges > 20
    assert found.max_relative_error < 1e-9, found
    assert net.count(NodeStatus.NOT_CONVERGED) == 0
    coverage = read_off(meshdrape.measure(net)).coverage_fraction
    if name != "resampled":  # a ball: the sheet folds
        part = surface.face_component[surface.closest_point(seed)[0].face]
        share = surface.face_area[surface.face_component == part].sum() / surface.area
        assert coverage > 0.98 * share
