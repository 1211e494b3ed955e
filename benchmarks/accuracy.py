"""How far nets on the sample moulds lie from what is known without a mesh. Prints the accuracy table of the README.

Run it as ``python benchmarks/accuracy.py``. References: the facts in ``samples/README.md``; on the sphere the smooth
limit sigma(u, v) = W(K u v) with (t W')' = -sin W, W(0) = pi/2, solved here by its power series.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import meshdrape

SAMPLES = Path(__file__).resolve().parent.parent / "samples"


def sphere_angle(t: np.ndarray) -> np.ndarray:
    """W(t) by Runge-Kutta from the series at 0, rad."""
    fine = np.linspace(1e-6, float(t.max()), 4001)
    step = fine[1] - fine[0]
    state = np.array([np.pi / 2 - fine[0], -1.0])
    values = [state[0]]

    def slope(at: float, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], (-np.sin(y[0]) - y[1]) / at])

    for at in fine[:-1]:
        k1 = slope(at, state)
        k2 = slope(at + step / 2, state + step / 2 * k1)
        k3 = slope(at + step / 2, state + step / 2 * k2)
        k4 = slope(at + step, state + step * k3)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        values.append(state[0])
    return np.interp(t, fine, values)


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
        wanted = np.pi / 2 - sphere_angle(np.multiply.outer(centre, centre))
        off = np.abs(ball.cell_shear[i0 : i0 + n, j0 : j0 + n] - wanted)
        row(f"hemisphere, {spacing:g} mm", ball, "smooth limit, cells within 0.8 R", f"{np.degrees(off.max()):.3f} deg")
    saddle = lay("hypar", 50.0, (0, 0, 0), (1, 0, 0))
    i0, j0 = saddle.net.seed_index
    node = saddle.net.node_position[i0 + 20, j0 + 20]
    off = float(np.linalg.norm(node - (762.6122, 762.6122, 581.5774)))
    row("hypar", saddle, "node at fabric coordinates (1000, 1000)", f"{off:.2f} mm")


if __name__ == "__main__":
    main()
