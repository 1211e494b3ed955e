"""Shear foretold from angle defects alone, against shear measured: an audit that shares no code with the solver."""

import numpy as np
import pytest
from moulds import cone, cube_corner, cylinder, hypar, icosphere, plate

import meshdrape
from meshdrape.weave.measures.balance import balance


def of(net):
    return balance(meshdrape.measure(net))


def test_no_curvature_no_shear():
    for mesh, seed, direction in (
        (plate(), (3, 5, 0), (1, 0.3, 0)),
        (cylinder(200, (-1.2, 1.4), 250, 25), (195, 35, 11), (0.1, 0.6, 0.8)),
        (cone(n=40), (430, 10, 930), (0.2, 0.6, 0.5)),
    ):
        mould = mesh.mould()
        seed = mould.surface.closest_point(seed)[0].position(mould.surface)
        found = of(meshdrape.drape(mould, meshdrape.Fabric(20.0), seed, direction, extent=(200,) * 4))
        assert np.nanmax(np.abs(found.predicted)) < 1e-9
        assert found.worst < 1e-8


@pytest.mark.parametrize("degrees", [0, 33, 100])
def test_seed_on_the_corner_shares_its_defect(degrees):
    """The seed's pi / 2 in quarters: 22.5 degrees in every cell, its sign the quadrant's."""
    face, within = divmod(np.radians(degrees), np.pi / 2)
    axis = np.eye(3)
    direction = np.cos(within) * axis[int(face)] + np.sin(within) * axis[int(face) + 1]
    found = of(meshdrape.drape(cube_corner(300).mould(), meshdrape.Fabric(23.0), (0, 0, 0), direction))
    known = np.isfinite(found.predicted)
    assert known.sum() > 300
    assert np.degrees(np.abs(found.predicted[known])) == pytest.approx(np.full(known.sum(), 22.5), abs=1e-9)
    assert np.degrees(found.worst) < 1e-6


@pytest.mark.parametrize(
    ("mesh", "seed", "bound"), [(icosphere(5), (20, 30, 1000), 0.02), (hypar(1.0, 1.0, 60), (20, 30, 1), 0.01)]
)
def test_foretells_the_shear_of_a_fine_mesh(mesh, seed, bound):
    mould = mesh.mould()
    seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    found = of(meshdrape.drape(mould, meshdrape.Fabric(50.0), seed, (1, 0.2, 0), extent=(700,) * 4))
    known = np.isfinite(found.predicted)
    assert known.sum() > 500
    assert np.abs(found.predicted[known]).max() > 0.2
    assert np.sqrt(np.mean(found.residual[known] ** 2)) < bound
    assert found.worst < 4 * bound


def test_defects_are_counted_once():
    """What the cells hold in all is no more than the mould has under them."""
    found = of(
        meshdrape.drape(icosphere(4).mould(), meshdrape.Fabric(50.0), (0, 0, 1000), (1, 0.2, 0), extent=(500,) * 4)
    )
    whole = np.isfinite(found.measures.cell_shear)
    # 400 cells of 50 x 50 mm, a little less for their shear, on a sphere of K = 1e-6
    area = 2500 * np.cos(found.measures.cell_shear[whole]).sum()
    assert whole.all()
    assert whole.size == 400
    assert found.cell_defect.sum() == pytest.approx(area * 1e-6, rel=0.03)
