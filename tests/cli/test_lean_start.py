"""What a command need not load or look for: most commands last a second or two, and every library counts."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from pathlib import Path

import meshdrape
from meshdrape.cli.main import main

ROOT = Path(meshdrape.__file__).parents[1]
SAMPLE = ROOT / "samples" / "hemisphere.stl"


def fresh(code: str) -> str:
    """What the code prints in an interpreter of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    run = subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True)
    return run.stdout.strip()


def test_a_drape_of_a_mesh_loads_neither_blas_nor_libigl(tmp_path):
    """libigl measures the edges all the same, in a process of its own, and says what it says in this one."""
    words = ["drape", str(SAMPLE), "-o", str(tmp_path / "net.ply"), "--spacing", "40", "--no-picture", "--quiet"]
    code = (
        f"import sys\nfrom meshdrape.cli.main import main\nassert main({words!r}) == 0\n"
        "print(*sorted({'igl', 'scipy.linalg', 'scipy.sparse', 'scipy.spatial'} & set(sys.modules)))"
    )
    assert fresh(code) == ""
    net = meshdrape.drape(meshdrape.read_mould(SAMPLE), meshdrape.Fabric(40.0))
    audit = meshdrape.audit(net, edges=100)
    assert audit.n_edges > 90
    code = (
        "import sys, meshdrape\nfrom meshdrape.geodesic.guarded import prepare\nprepare()\n"
        f"net = meshdrape.drape(meshdrape.read_mould({str(SAMPLE)!r}), meshdrape.Fabric(40.0))\n"
        "audit = meshdrape.audit(net, edges=100)\n"
        "print('igl' in sys.modules, audit.n_edges, audit.max_relative_error.hex())"
    )
    assert fresh(code) == f"False {audit.n_edges} {audit.max_relative_error.hex()}"


def test_a_program_keeps_numbas_blas():
    code = (
        "import numba, numpy\nfrom meshdrape.kernels import facets\n"
        "print(numba.njit(lambda a: numpy.dot(a, a))(2 * numpy.eye(2)).tolist())"
    )
    assert fresh(code) == "[[4.0, 0.0], [0.0, 4.0]]"


def test_garbage_is_looked_for_as_before_once_a_command_is_done(capfd):
    often = gc.get_threshold()
    assert main(["inspect", str(SAMPLE)]) == 0
    assert gc.get_threshold() == often
    assert "triangles" in capfd.readouterr().out
