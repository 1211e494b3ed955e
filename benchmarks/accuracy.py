"""How far nets on the sample moulds lie from what is known without a mesh. Prints the accuracy table of the README.

Run it as ``python benchmarks/accuracy.py``. References: the facts in ``samples/README.md``; on the sphere the smooth
limit sigma(u, v) = W(K u v) of :func:`meshdrape.theory.constant_curvature_angle`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import meshdrape
from meshdrape.theory import constant_curvature_angle

SAMPLES = Path(__file__).resolve().parent.parent / "samples"


def lay(name: str, spacing: float, seed: tuple[float, ...], direction: tuple[float, ...]) -> meshdrape.Measures:
    mould = meshdrape.read_mould(SAMPLES / f"{name}.step")
    return meshdrape.measure(meshdrape.drape(mould, meshdrape.Fabric(spacing), seed, direction))


def row(name: str, measures: meshdrape.Measures, what: str, error: str) -> None:
    edges = meshdrape.audit(measures.net, 300).max_relative_error
    triangles = len(measures.net.mould.triangles)
    print(f"| {name} | {triangles:,} | {what} | {error} | {edges:.0e} |", flush=True)


def main() -> None:
    print("| sample | triangles | against | off by | edges by libigl, relative |\n|---|---|---|---|---|")
    flat = (("cylinder", (500.0, 0, 900.0), (0, 1, 2)), ("cone", (450.0, 0, 965.0), (1, 1, 0)))
    for name, seed, direction in flat:
        mould = meshdrape.read_mould(SAMPLES / f"{name}.step")
        near = mould.surface.closest_point(seed)[0].position(mould.surface)
        measures = lay(name, 25.0, tuple(near), direction)
        row(name, measures, "no shear", f"{np.degrees(measures.max_shear):.0e} deg")
    corner = lay("cube_corner", 50.0, (0, 0, 0), (-1, -0.4, 0))
    shear = np.degrees(np.abs(corner.cell_shear[corner.cell_touches_mould]))
    row("cube_corner", corner, "22.5 deg in every cell", f"{np.abs(shear - 22.5).max():.0e} deg")
    for spacing in (50.0, 25.0):
        ball = lay("hemisphere", spacing, (0, 0, 500), (1, 0.3, 0))
        i0, j0 = ball.net.seed_index
        n = int(400 / spacing)
        centre = (np.arange(n) + 0.5) * spacing / 500
        wanted = np.pi / 2 - constant_curvature_angle(np.multiply.outer(centre, centre))
        off = np.abs(ball.cell_shear[i0 : i0 + n, j0 : j0 + n] - wanted)
        row(f"hemisphere, {spacing:g} mm", ball, "smooth limit, cells within 0.8 R", f"{np.degrees(off.max()):.3f} deg")
    saddle = lay("hypar", 50.0, (0, 0, 0), (1, 0, 0))
    i0, j0 = saddle.net.seed_index
    node = saddle.net.node_position[i0 + 20, j0 + 20]
    off = float(np.linalg.norm(node - (762.6122, 762.6122, 581.5774)))
    row("hypar", saddle, "node at fabric coordinates (1000, 1000)", f"{off:.2f} mm")


if __name__ == "__main__":
    main()
