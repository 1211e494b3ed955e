"""Speed and memory of the main job, warmed up; compile time told apart. Each row beside what it should reach.

All rows: ``python benchmarks/main_job.py``; some: ``python benchmarks/main_job.py wing sphere``, of wing, sphere,
forecast, command, help and compilation.
"""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import meshdrape

SAMPLES = Path(__file__).resolve().parent.parent / "samples"
REPEATS = 5


def seconds(job: Callable[[], object]) -> float:
    """Median wall time of a job over REPEATS runs, after one that is not counted."""
    job()
    times = []
    for _ in range(REPEATS):
        begun = time.perf_counter()
        job()
        times.append(time.perf_counter() - begun)
    return float(np.median(times))


def row(what: str, figure: str, target: str) -> None:
    print(f"| {what} | {figure} | {target} |", flush=True)


def rates(name: str, mould: meshdrape.Mould, spacing: float, targets: tuple[str, str], **how: object) -> None:
    fabric = meshdrape.Fabric(spacing)
    for threads, target in zip((1, 2), targets, strict=True):
        kept: list[meshdrape.Net] = []

        def job(threads: int = threads, kept: list[meshdrape.Net] = kept) -> None:
            kept[:] = [meshdrape.drape(mould, fabric, threads=threads, **how)]

        took = seconds(job)
        nodes = int(np.count_nonzero(kept[0].node_status <= 1))
        threads_word = f"{threads} thread" + "s" * (threads > 1)
        rate = f"{nodes / took / 1e6:.1f} million nodes/s ({took:.3f} s)"
        row(f"{name}, {nodes:,} nodes, {threads_word}", rate, target)


def wing() -> None:
    mould = meshdrape.read_mould(SAMPLES / "wing_spar.step")
    rates("14 m wing from STEP, 3 mm", mould, 3.0, ("10", "16"))
    times = []
    for spacing in (12.0, 6.0, 3.0):
        net = meshdrape.drape(mould, meshdrape.Fabric(spacing))
        took = seconds(lambda spacing=spacing: meshdrape.drape(mould, meshdrape.Fabric(spacing), threads=1))
        times.append((np.count_nonzero(net.node_status <= 1), took))
    (n1, t1), (n2, t2) = times[0], times[-1]
    row("linear in nodes: exponent from 12 to 3 mm", f"{np.log(t2 / t1) / np.log(n2 / n1):.2f}", "1")
    entries = net.node_status.size
    held = sum(array.nbytes for array in net.lattice)
    row("memory while draping", f"{held / entries:.0f} bytes an entry", "150")


def sphere() -> None:
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=7, radius=1000.0)
    turn = trimesh.transformations.rotation_matrix(0.7, [0.3, 0.5, 0.8])[:3, :3]
    mould = meshdrape.Mould.from_arrays(np.asarray(ball.vertices) @ turn.T, ball.faces)
    edge = float(np.sqrt(mould.surface.face_area.mean() * 4 / np.sqrt(3)))
    start = {"seed": (0, 0, 1000.0), "direction": (1, 0, 0), "extent": (850.0,) * 4}
    for share, word in ((1.0, "an edge"), (0.5, "half an edge")):
        rates(f"sphere, {len(mould.triangles):,} triangles, spacing {word}", mould, share * edge, ("", "2"), **start)


def forecast() -> None:
    """Of a mould just read, its tables not built yet; the kernels loaded."""
    for name in ("wing_spar", "krogh_double_curved", "hemisphere"):
        mould = meshdrape.read_mould(SAMPLES / f"{name}.step")
        fabric = meshdrape.Fabric(mould.surface.diagonal / 300)
        fresh = (meshdrape.Mould.from_arrays(mould.vertices, mould.triangles) for _ in range(REPEATS + 1))
        took = float(np.median([meshdrape.forecast(mould, fabric).seconds for mould in fresh][1:]))
        row(f"forecast, {name}, {len(mould.triangles):,} triangles, just read", f"{1e3 * took:.0f} ms", "")


def command() -> None:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "net.ply"
        stl = [sys.executable, "-m", "meshdrape", "drape", str(SAMPLES / "hemisphere.stl"), "-o", str(out)]
        took = seconds(lambda: subprocess.run([*stl, "--spacing", "5.3", "--quiet"], check=False))
        nodes = np.count_nonzero(meshdrape.read_net(out).node_status == 0)
        row(f"whole command on an STL, {nodes:,} nodes", f"{took:.2f} s", "4 s")
        step = [sys.executable, "-m", "meshdrape", "drape", str(SAMPLES / "wing_spar.step"), "-o", str(out)]
        begun = time.perf_counter()
        subprocess.run([*step, "--spacing", "3", "--quiet"], check=True)
        took = time.perf_counter() - begun
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 2**20
        row("14 m wing, 3 mm, STEP to all files", f"{took:.1f} s, {peak:.1f} GiB", "20 s, 3 GB")


def help_text() -> None:
    ask = [sys.executable, "-m", "meshdrape", "--help"]
    row("meshdrape --help", f"{seconds(lambda: subprocess.run(ask, check=True, capture_output=True)):.2f} s", "0.3 s")


def compilation() -> None:
    """The kernels compiled anew, into a folder of their own."""
    with tempfile.TemporaryDirectory() as folder:
        code = (
            "import meshdrape as m; p = m.Mould.from_arrays([[0,0,0],[99,0,0],[0,99,0]], [[0,1,2]]); "
            "n = m.drape(p, m.Fabric(9)); k = m.measure(n); from meshdrape.weave import read_off; read_off(k)"
        )
        begun = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, "NUMBA_CACHE_DIR": folder})
        row("compiling the kernels, once", f"{time.perf_counter() - begun:.0f} s", "")


JOBS = {
    "wing": wing,
    "sphere": sphere,
    "forecast": forecast,
    "command": command,
    "help": help_text,
    "compilation": compilation,
}


def main() -> None:
    asked = sys.argv[1:] or list(JOBS)
    print(f"meshdrape {meshdrape.__version__}, Python {platform.python_version()}, {os.cpu_count()} cores\n")
    print("| what | measured | should reach |\n|---|---|---|")
    for name in asked:
        JOBS[name]()


if __name__ == "__main__":
    main()
