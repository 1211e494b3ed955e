"""Errors against smooth or exact references fall at the rate they must, and end where they must."""

import numpy as np
import pytest
from creased import facets, lay
from lattice import cells_at, nodes_at, offsets
from moulds import cylinder, hypar, icosphere, rotation
from rates import rate, table
from references import Crease, CreaseNet, hypar_net, rolled_on_cylinder, sphere_angle, sphere_net

import meshdrape


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.slow
def test_second_order_in_spacing_on_a_sphere():
    """Nodes and cell shear against the smooth net over 0.8 x 0.8 radii of cloth, on 327,680 triangles.

    The smooth nodes are the exact discrete net's, extrapolated from two spacings.
    """
    fine, coarse = sphere_net(1.0, 0.0125, 64), sphere_net(1.0, 0.025, 32)
    smooth = fine[::2, ::2] + (fine[::2, ::2] - coarse) / 3
    mould = icosphere(7).mould()
    steps, position, shear = [0.4, 0.2, 0.1], [], []
    for step in steps:
        n, every = round(0.8 / step), round(step / 0.025)
        net = meshdrape.drape(mould, meshdrape.Fabric(1000 * step), (0, 0, 1000), (1, 0, 0), extent=(0, 850, 0, 850))
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
        position.append(np.linalg.norm(nodes_at(net, i, j) / 1000 - smooth[::every, ::every], axis=-1).max())
        i, j = i[:-1, :-1], j[:-1, :-1]
        centre = np.pi / 2 - sphere_angle((i + 0.5) * (j + 0.5) * step**2)
        shear.append(rms(cells_at(net, meshdrape.measure(net).cell_shear, i, j) - centre))
    assert 1.8 < rate(steps, position) < 2.2, table(steps, position)
    assert position[-1] < 4e-4, table(steps, position)
    assert 1.8 < rate(steps, shear) < 2.2, table(steps, shear)
    assert np.degrees(shear[-1]) < 0.02, table(steps, shear)


def test_with_the_mesh_at_fixed_spacing_on_a_sphere():
    """Against the exact discrete net: in rms over four starts close to first order in the chord tolerance h.

    (The bound is 3 h + 3 (h / R)^0.75 L: each vertex carries its curvature as one defect of about h / R.)
    """
    spacing, n = 0.05, 16
    tolerances, position, shear = [], [], []
    i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1), indexing="ij")
    reference = sphere_net(1.0, spacing, n)
    smooth = np.pi / 2 - sphere_angle((i[1:, 1:] - 0.5) * (j[1:, 1:] - 0.5) * spacing**2)
    for level in (2, 3, 4, 5, 6):
        mould = icosphere(level).mould()
        centre = mould.vertices[mould.triangles].mean(axis=1)
        tolerances.append(1 - np.linalg.norm(centre, axis=1).min() / 1000)
        off, turn_off = [], []
        for angle in (0, 0.5, 1.1, 1.9):
            turn = rotation([0.2, -0.7, 0.4], angle)
            net = meshdrape.drape(
                mould,
                meshdrape.Fabric(1000 * spacing),
                turn @ [0, 0, 1000],
                turn @ [1, 0, 0],
                extent=(0, 850, 0, 850),
            )
            off.append(np.linalg.norm(nodes_at(net, i, j) / 1000 @ turn - reference, axis=-1))
            turn_off.append(cells_at(net, meshdrape.measure(net).cell_shear, i[:-1, :-1], j[:-1, :-1]) - smooth)
        position.append(rms(off))
        shear.append(rms(turn_off))
    assert rate(tolerances, position) > 0.75, table(tolerances, position)
    assert position[-1] < 3e-4, table(tolerances, position)
    assert rate(tolerances, shear) > 0.7, table(tolerances, shear)
    assert shear[-1] < 2 * tolerances[-1] ** 0.75, table(tolerances, shear)


@pytest.mark.parametrize(("sizes", "symmetric"), [((13, 25, 49, 97), False), ((12, 24, 48, 96), True)])
def test_with_the_mesh_on_a_hypar(sizes, symmetric):
    """Fixed spacing, rulings as start, across triangles or along edges through vertices: first order in h."""
    node, _ = hypar_net(1.0, 1.0, 40)
    i, j = np.meshgrid(np.arange(41), np.arange(41), indexing="ij")
    errors = []
    for n in sizes:
        mould = hypar(1.0, 1.3, n, symmetric=symmetric).mould()
        seed = mould.surface.closest_point((0, 0, 0))[0].position(mould.surface)
        net = meshdrape.drape(mould, meshdrape.Fabric(25.0), seed, (1, 0, 0))
        errors.append(rms(np.linalg.norm(nodes_at(net, i, j) / 1000 - node, axis=-1)))
    steps = [(2.6 / n) ** 2 / 4 for n in sizes]
    assert 0.9 < rate(steps, errors) < 1.1, table(steps, errors)
    assert errors[-1] < steps[-1], table(steps, errors)


def test_with_the_facets_of_a_cylinder():
    """The prism's own net is exact, so nodes differ from the cylinder's by its sagitta: second order in the width."""
    radius, widths, errors = 500.0, [], []
    azimuth, eta = np.radians(10), np.radians(35)
    seed = radius * np.array([np.cos(azimuth), np.sin(azimuth), 0])
    across = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    for n in (50, 100, 200, 400):
        net = meshdrape.drape(
            cylinder(radius, n=n).reversed().mould(), meshdrape.Fabric(50.0), seed,
            np.cos(eta) * np.array([0, 0, 1.0]) + np.sin(eta) * across, extent=(400, 400, 400, 400),
        )  # fmt: skip
        i, j = offsets(net)
        flat = 50 * np.stack([i * np.cos(eta) - j * np.sin(eta), i * np.sin(eta) + j * np.cos(eta)], axis=-1)
        on = net.node_status == meshdrape.NodeStatus.PLACED
        off = np.linalg.norm(net.node_position - rolled_on_cylinder(flat, radius, azimuth), axis=-1)
        widths.append(3.6 / n)
        errors.append(rms(off[on]))
    assert 1.8 < rate(widths, errors) < 2.2, table(widths, errors)
    assert errors[-1] < 0.02, table(widths, errors)


def test_with_the_facets_of_a_crease():
    """Wing and spar of section 3.4: nodes second order in the facets' width, to 1.5 h."""
    crease = Crease((lambda y: 0.2 * y**2, lambda y: 0.4 * y), (lambda y: 0.4 * y**2, lambda y: 0.8 * y), 1.35)
    reference = CreaseNet(crease, 0.05, 21, -12, 22, 0.0)
    widths = [16e-3, 8e-3, 4e-3, 2e-3, 1e-3]
    errors = [lay(crease, reference, facets(1.35, width), 3.0, 1.2, 9).node_error() for width in widths]
    assert 1.8 < rate(widths, errors) < 2.2, table(widths, errors)
    assert errors[-1] < 1.5 * 0.8 * widths[-1] ** 2 / 8, table(widths, errors)
