"""Those nets, measured once, and a field read off on four triangles."""

import numpy as np
import pytest
from known_nets import KnownField, flat_net, measured, sphere_net, wing_net


@pytest.fixture(scope="session")
def flat():
    """Sheared 5 degrees everywhere, with nodes missing for several reasons."""
    net = flat_net()
    return net, measured(net)


@pytest.fixture(scope="session")
def sphere():
    net = sphere_net()
    return net, measured(net)


@pytest.fixture(scope="session")
def wing():
    net = wing_net()
    return net, measured(net)


@pytest.fixture(scope="session")
def field():
    """Four triangles round the origin, the last without cloth."""
    vertices = np.array([[0.0, 0, 0], [1, 0, 0.5], [0, 1, 0], [-1, 0, 0.5], [0, -1, 1 / 3]])
    triangles = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    warp = np.radians([10.0, -20.0, 30.0, np.nan])
    shear = np.radians([5.0, -12.5, 0.0, np.nan])
    covered = np.array([True, True, True, False])
    weft = warp + np.pi / 2 - shear
    return KnownField(vertices, triangles, warp, weft, shear, covered, np.array([1.0, 0, 0]))
