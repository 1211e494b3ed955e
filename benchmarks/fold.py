"""CPU and wall time of `meshdrape fold`, of its chart, and of a drape on a mould that has no collar yet.

``python benchmarks/fold.py``; some rows: ``python benchmarks/fold.py collar drape fold chart``. Beside another state of
the sources, ``--against FOLDER``, every job is run in turn by both, so that whatever else the machine does slows both
alike, and the last columns have the other's times over this one's.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import textwrap
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DESIGNS = ROOT / "samples" / "designs"
ROUNDS = 3

# Each sets `job`, which is run on a mould made anew once uncounted, then some times: the shortest counts.
WARM = """
    import json, sys, time
    import numpy as np
    import meshdrape

    def anew(mould):
        # nothing of what an earlier drape left with the surface
        return meshdrape.Mould.from_arrays(mould.vertices, mould.triangles)

    def doubly_curved():
        n = 101
        x, y = (part.ravel() for part in np.meshgrid(*[np.linspace(0.0, 500.0, n)] * 2, indexing="ij"))
        z = 60 * np.sin(x / 130) * np.cos(y / 170) + x * y / 4000
        q = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
        faces = np.concatenate([np.stack([q, q + n, q + n + 1], 1), np.stack([q, q + n + 1, q + 1], 1)])
        return meshdrape.Mould.from_arrays(np.stack([x, y, z], axis=1), faces)
    {setup}
    job(anew(mould))
    best = [np.inf, np.inf]
    for _ in range(7):
        fresh = anew(mould)
        begun = time.process_time(), time.perf_counter()
        job(fresh)
        best = [min(best[0], time.process_time() - begun[0]), min(best[1], time.perf_counter() - begun[1])]
    print(json.dumps(best))
"""
DRAPE = "mould = {mould}\ndef job(mould): meshdrape.drape(mould, meshdrape.Fabric({spacing}), threads=1)"
COLLAR = (
    "from meshdrape.weave.lay.collar import extended\nmould = {mould}\ndef job(mould): extended(mould.surface, {depth})"
)
WING, CURVED = f"meshdrape.read_mould({str(ROOT / 'samples' / 'wing_spar.stl')!r})", "doubly_curved()"
CONE = f"meshdrape.read_mould({str(ROOT / 'samples' / 'cone.step')!r})"

IN_PROCESS = {
    "collar": [
        ("collar of the wing, 80 mm deep", COLLAR.format(mould=WING, depth=80.0)),
        ("collar of the cone, 12,288 triangles, 50 mm deep", COLLAR.format(mould=CONE, depth=50.0)),
        ("collar of a doubly curved mould, 20,000 triangles, 20 mm deep", COLLAR.format(mould=CURVED, depth=20.0)),
    ],
    "drape": [
        ("drape of the wing, 20 mm", DRAPE.format(mould=WING, spacing=20.0)),
        ("drape of a doubly curved mould, 20,000 triangles, 5 mm", DRAPE.format(mould=CURVED, spacing=5.0)),
    ],
}
COMMANDS = {
    "fold": [
        ("fold of the real wing, f a parabola", ["real_wing_parabola.toml"]),
        ("fold of the real wing, f a sine that locks, with f*", ["real_wing_sine.toml"]),
    ],
    "chart": [("fold with a chart of 400 designs", ["real_wing_parabola.toml", "--chart", "20x20"])],
}


def in_process(tree: Path, setup: str) -> tuple[float, float]:
    """Seconds of CPU and of wall of a job within one Python."""
    code = textwrap.dedent(WARM).replace("{setup}", setup)
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(tree), cwd=tree, check=True, capture_output=True, text=True
    )
    cpu, wall = json.loads(done.stdout.splitlines()[-1])
    return cpu, wall


def command(tree: Path, words: list[str]) -> tuple[float, float]:
    """Seconds of CPU, of its own processes too, and of wall of a whole command."""
    with tempfile.TemporaryDirectory() as folder:
        ask = [sys.executable, "-m", "meshdrape", "fold", str(DESIGNS / words[0]), *words[1:], "--quiet"]
        before, begun = os.times(), time.perf_counter()
        subprocess.run([*ask, "-o", str(Path(folder) / "fold.json")], env=environment(tree), cwd=tree, check=True)
        wall, after = time.perf_counter() - begun, os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system, wall


def environment(tree: Path) -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(tree)}


def row(what: str, timed: list[list[tuple[float, float]]]) -> None:
    """A row of the table: the shortest of the rounds, of this state of the sources first."""
    (cpu, wall), *others = [tuple(map(min, zip(*rounds, strict=True))) for rounds in timed]
    compared = "".join(f" {a:.3f} | {b:.3f} | {a / cpu:.2f} | {b / wall:.2f} |" for a, b in others)
    print(f"| {what} | {cpu:.3f} | {wall:.3f} |{compared}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rows", nargs="*", help=f"of {', '.join([*IN_PROCESS, *COMMANDS])}; all by default")
    parser.add_argument("--against", type=Path, metavar="FOLDER", help="another state of the sources")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()
    trees = [ROOT, *([options.against.resolve()] if options.against else [])]
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores\n")
    print("| what | CPU s | wall s |" + " other's CPU s | wall s | CPU ratio | wall ratio |" * (len(trees) - 1))
    print("|---|---|---|" + "---|---|---|---|" * (len(trees) - 1))
    jobs = [
        (name, run, jobs)
        for run, table in ((in_process, IN_PROCESS), (command, COMMANDS))
        for name, jobs in table.items()
    ]
    for name, run, listed in jobs:
        if options.rows and name not in options.rows:
            continue
        for what, job in listed:
            timed: list[list[tuple[float, float]]] = [[] for _ in trees]
            for _ in range(options.rounds):
                for tree, rounds in zip(trees, timed, strict=True):
                    rounds.append(run(tree, job))
            row(what, timed)


if __name__ == "__main__":
    main()
