"""For every test: the same examples on every run, and MeshLab to open what is written."""

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    max_examples=20,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.load_profile("repeatable")


@pytest.fixture(autouse=True, scope="session")
def compilation_untold():
    """Whichever test comes first to a kernel, what it reads on stderr is the same."""
    from meshdrape.cli import progress

    progress.A_FEW_KERNELS = 1e6


@pytest.fixture(scope="session")
def meshlab():
    """What MeshLab makes of a file: the mesh it loads."""
    import pymeshlab

    alive = []  # a mesh is a view into its set

    def load(path):
        alive.append(pymeshlab.MeshSet())
        alive[-1].load_new_mesh(str(path))
        return alive[-1].current_mesh()

    return load
