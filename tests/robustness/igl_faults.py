"""Meshes on which libigl's exact_geodesic crashes, hangs or answers with a silent zero, fed to the public functions.

Run as a program it prints one line of JSON for each mesh and function, so that the test that started it knows, should
the process die or hang, on which.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from meshfiles import obj, off, stored, text_ply
from moulds import Mesh, cube, grid

import meshdrape
from meshdrape.surface import Surface

SPACING = 0.35


class Fault(NamedTuple):
    """A mesh, where to measure on it, and the distance, mm; None where there is no distance to be had."""

    mesh: Mesh
    ends: tuple[tuple[float, float, float], tuple[float, float, float]]
    distance: float | None = None


def _sheet(n: int = 4) -> Mesh:
    side = np.linspace(0, n, n + 1)
    return grid(side, side, lambda x, y: (x, y, 0))


def _with(mesh: Mesh, vertices: object = (), triangles: object = ()) -> Mesh:
    return Mesh(
        np.concatenate([mesh.vertices, np.reshape(vertices, (-1, 3))]),
        np.concatenate([mesh.triangles, np.reshape(triangles, (-1, 3)).astype(np.int64)]),
    )


def _low(height: float) -> Mesh:
    """A sheet one of whose vertices all but lies on the edge opposite."""
    mesh = _sheet()
    a, b, c = mesh.triangles[0]
    middle = 0.5 * (mesh.vertices[a] + mesh.vertices[b])
    inward = mesh.vertices[c] - middle
    inward -= (inward @ (mesh.vertices[b] - mesh.vertices[a])) * (mesh.vertices[b] - mesh.vertices[a])
    new = len(mesh.vertices)
    mesh = Mesh(np.vstack([mesh.vertices, middle + height * inward]), mesh.triangles[1:])
    return _with(mesh, (), [[a, b, new], [b, c, new], [c, a, new]])


def _short_edge(length: float) -> Mesh:
    """A sheet with an inner edge next to nothing long: two vertices where there was one, and two needles."""
    n = 4
    mesh = _sheet(n)
    at = 2 * (n + 1) + 2
    new = len(mesh.vertices)
    vertices = np.vstack([mesh.vertices, mesh.vertices[at] + [length, 0, 0]])
    triangles = mesh.triangles.copy()
    centre = mesh.vertices[triangles].mean(axis=1)
    right = (triangles == at).any(axis=1) & (centre[:, 0] > mesh.vertices[at, 0])
    triangles[right] = np.where(triangles[right] == at, new, triangles[right])
    # above and below the slit opens between the two vertices
    above, below = at + 1, at - 1
    return Mesh(vertices, np.vstack([triangles, [[at, new, above], [new, at, below]]]))


NEAR, FAR = (0.3, 0.4, 0.0), (3.6, 3.3, 0.0)
STRAIGHT = float(np.hypot(3.3, 2.9))


def faults() -> dict[str, Fault]:
    sheet, ends = _sheet(), (NEAR, FAR)
    a, b, c = sheet.triangles[0]
    nan = sheet.vertices.copy()
    nan[7, 2] = np.nan
    infinite = sheet.vertices.copy()
    infinite[7, 2] = np.inf
    far_sheet = _sheet(2).moved(np.eye(3), (10, 0, 0))
    tip = Mesh(np.array([[4.0, 4, 0], [6, 4, 0], [6, 6, 0]]), np.array([[0, 1, 2]]))
    bow_tie = sheet.joined(tip).welded()
    return {
        "non-manifold edge": Fault(_with(sheet, [1, 1, 2], [[a, b, 25]]), ends),
        "duplicate face": Fault(_with(sheet, (), [[a, b, c]]), ends),
        "duplicate face, turned": Fault(_with(sheet, (), [[b, c, a]]), ends),
        "face and its reverse": Fault(_with(sheet, (), [[a, c, b]]), ends),
        "repeated index": Fault(_with(sheet, (), [[a, a, b]]), ends),
        "empty": Fault(Mesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)), ends),
        "no triangles": Fault(Mesh(sheet.vertices, np.empty((0, 3), dtype=np.int64)), ends),
        "index out of range": Fault(_with(sheet, (), [[a, b, 25]]), ends),
        "negative index": Fault(_with(sheet, (), [[a, b, -1]]), ends),
        "edge of length zero": Fault(_short_edge(0.0), ends),
        "edge of 1e-13": Fault(_short_edge(1e-13), ends),
        "edge of 1e-10": Fault(_short_edge(1e-10), ends, STRAIGHT),
        "edge of 1e-8": Fault(_short_edge(1e-8), ends, STRAIGHT),
        "edge of 1e-6": Fault(_short_edge(1e-6), ends, STRAIGHT),
        "height of zero": Fault(_low(0.0), ends),
        "height of 1e-10": Fault(_low(1e-10), ends, STRAIGHT),
        "height of 1e-8": Fault(_low(1e-8), ends, STRAIGHT),
        "height of 1e-6": Fault(_low(1e-6), ends, STRAIGHT),
        "NaN": Fault(Mesh(nan, sheet.triangles), ends),
        "infinity": Fault(Mesh(infinite, sheet.triangles), ends),
        "separate parts": Fault(sheet.joined(far_sheet), (NEAR, (11.0, 1.0, 0.0))),
        "separate parts, one of them": Fault(sheet.joined(far_sheet), ends, STRAIGHT),
        "unreferenced vertex": Fault(_with(sheet, [9, 9, 9]), ends, STRAIGHT),
        "unreferenced NaN": Fault(_with(sheet, [np.nan, 9, 9]), ends),
        "bow tie": Fault(bow_tie, (NEAR, (5.9, 5.0, 0.0))),
        "closed": Fault(cube(2.0, 2), ((0.1, 0.2, 2.0), (1.9, 1.7, 2.0)), float(np.hypot(1.8, 1.5))),
    }


def _written(mesh: Mesh, suffix: str, folder: Path) -> Path:
    write = {".obj": obj, ".off": off, ".ply": text_ply, ".stl": _stl}[suffix]
    return stored(folder, f"mould{suffix}", write(mesh))


def _stl(mesh: Mesh) -> bytes:
    """In text; corners that are no vertex are left out."""
    v = mesh.vertices.tolist()
    lines = ["solid x"]
    for face in mesh.triangles.tolist():
        lines += ["facet normal 0 0 1", "outer loop"]
        lines += ["vertex {!r} {!r} {!r}".format(*v[i]) for i in face if -len(v) <= i < len(v)]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid x", ""]).encode()


def _drape(mould: meshdrape.Mould, fault: Fault, engine: str) -> object:
    reach = (1.2,) * 4 if engine == "libigl" else None
    fabric = meshdrape.Fabric(SPACING, initial_angle=np.radians(80))
    net = meshdrape.drape(mould, fabric, fault.ends[0], (1, 0.3, 0), engine=engine, extent=reach, threads=1)
    measures = meshdrape.measure(net)
    found = meshdrape.audit(net, 60)
    return {
        "nodes": net.count(meshdrape.NodeStatus.PLACED),
        "lost": sum(net.count(status) for status in meshdrape.NodeStatus if status > 2),
        "shear": measures.max_shear,
        "edge_error": found.max_relative_error,
        "edges": found.n_edges,
        "zero": int((np.linalg.norm(np.diff(net.node_position, axis=0), axis=-1) == 0).sum()),
    }


def _functions(fault: Fault, folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    """Every public function that takes a mould, by name."""
    mesh, (a, b) = fault.mesh, fault.ends

    def mould() -> meshdrape.Mould:
        return meshdrape.Mould.from_arrays(mesh.vertices, mesh.triangles)

    yield "Mould.from_arrays", lambda: len(mould().triangles)
    yield "Surface.from_arrays", lambda: len(Surface.from_arrays(mesh.vertices, mesh.triangles).faces)
    for suffix in (".obj", ".ply", ".off", ".stl"):
        yield f"read_mould {suffix}", lambda s=suffix: len(meshdrape.read_mould(_written(mesh, s, folder)).triangles)
        yield (
            f"geodesic_distance {suffix}",
            lambda s=suffix: meshdrape.geodesic_distance(meshdrape.read_mould(_written(mesh, s, folder)), a, b),
        )
    yield "geodesic_distance", lambda: meshdrape.geodesic_distance(mould(), a, b)
    yield "drape fast", lambda: _drape(mould(), fault, "fast")
    yield "drape libigl", lambda: _drape(mould(), fault, "libigl")


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for name, fault in faults().items():
            for function, call in _functions(fault, Path(folder)):
                sys.stdout.write(json.dumps([name, function]) + "\n")
                sys.stdout.flush()
                begun = time.perf_counter()
                try:
                    outcome: dict[str, object] = {"result": call()}
                except meshdrape.MeshdrapeError as error:
                    outcome = {"refused": str(error)}
                except Exception as error:
                    outcome = {"crashed": f"{type(error).__name__}: {error}"}
                outcome["seconds"] = time.perf_counter() - begun
                sys.stdout.write(json.dumps([name, function, outcome]) + "\n")
                sys.stdout.flush()


if __name__ == "__main__":
    main()
