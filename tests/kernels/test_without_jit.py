"""Kernels run as plain Python give the same nets: nothing hangs on compiled behaviour."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SCRIPT = """
import sys
import numpy as np
import meshdrape
from moulds import bumpy, cube_corner, wing_spar
from meshdrape.weave.measures.balance import balance
from meshdrape.weave.recheck.rebuild import rebuild

nets = {}
cases = {
    "bumpy": (bumpy(1, n=8), 17.0, (3.0, 5.0, 0.0), (1.0, 0.3, 0.0)),
    "corner": (cube_corner(100, 2), 23.0, (0.0, 0.0, 0.0), (1.0, 0.2, 0.0)),
    "wing": (wing_spar(lambda t: 2e-4 * t**2, lambda t: 4e-4 * t**2, np.linspace(0, 1000, 9), 800, 300), 90.0,
             (600.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
}
for name, (mesh, spacing, seed, direction) in cases.items():
    fabric = meshdrape.Fabric(spacing)
    distance = mesh.mould().surface.closest_point(seed)[1]
    net = meshdrape.drape(mesh.mould(), fabric, seed, direction, threads=1)
    nets[name + "_position"] = net.node_position
    nets[name + "_status"] = net.node_status
    measures = meshdrape.measure(net)
    nets[name + "_shear"] = measures.cell_shear
    nets[name + "_foretold"] = balance(measures).predicted
    nets[name + "_gap"] = rebuild(net.mould, net).edge_gap / spacing
    nets[name + "_warp"] = net.warp_direction
np.savez(sys.argv[1], **nets)
"""


@pytest.mark.slow
def test_same_nets_with_and_without_jit(tmp_path):
    found = []
    for disabled in ("0", "1"):
        out = tmp_path / f"{disabled}.npz"
        environment = os.environ | {
            "NUMBA_DISABLE_JIT": disabled,
            "PYTHONPATH": os.pathsep.join(
                [str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])]
            ),
        }
        subprocess.run([sys.executable, "-c", SCRIPT, str(out)], check=True, env=environment, timeout=300)
        found.append(np.load(out))
    compiled, plain = found
    for name in compiled.files:
        if name.endswith("_status"):
            assert np.array_equal(compiled[name], plain[name])
        else:
            # the compiler may contract a multiplication and an addition into one rounding
            assert plain[name] == pytest.approx(compiled[name], abs=1e-8, nan_ok=True)
        assert np.isfinite(plain[name]).sum() > 20
