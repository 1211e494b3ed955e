"""Drapes of every kind of mould, each with a start that no symmetry makes easy; shared by the tests of the weave."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from moulds import (
    Mesh,
    bumpy,
    cap,
    cone,
    cube_corner,
    cylinder,
    holed_plate,
    hypar,
    icosphere,
    krogh,
    parallelogram,
    plate,
    sliver_plate,
    step_corner,
    tube,
    wing_spar,
)

import meshdrape

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Case:
    """A mould and how cloth is laid on it, mm."""

    mesh: Mesh
    spacing: float | tuple[float, float]
    seed: Triple
    direction: Triple
    initial_angle: float = np.pi / 2
    extent: tuple[float, float, float, float] | None = None

    def drape(self, **options: object) -> meshdrape.Net:
        fabric = meshdrape.Fabric(self.spacing, initial_angle=self.initial_angle)
        return meshdrape.drape(
            self.mesh.mould(), fabric, seed=self.seed, direction=self.direction, extent=self.extent, **options
        )

    def with_mesh(self, mesh: Mesh) -> Case:
        return replace(self, mesh=mesh)


def _wing(y, c_wing, c_spar):
    return wing_spar(lambda t: c_wing * t**2 / 1000, lambda t: c_spar * t**2 / 1000, y, 1800, 900)


RIGHT = (1.0, 0.3, 0.1)
CASES = {
    "plate": Case(plate(), 7.0, (3, 5, 0), RIGHT),
    "needles and strips": Case(sliver_plate(), 6.0, (3, 5, 0), RIGHT),
    "plate with a hole": Case(holed_plate(), 6.3, (-45, -31, 0), RIGHT),
    "swept plate": Case(parallelogram(), 9.0, (-60, 20, 0), RIGHT),
    "prism": Case(cylinder(200, (-1.2, 1.4), 250, 25), 21.0, (195, 35, 11), (0.1, 0.6, 0.8)),
    "cone": Case(cone(n=40), 45.0, (430, 10, 930), (0.2, 0.6, 0.5), extent=(500, 500, 400, 400)),
    "wing and spar": Case(_wing(np.linspace(0, 1000, 61), 0.2, 0.4), 40.0, (700, 310, 19), (0.1, 1, 0.1)),
    "few facets": Case(_wing(np.linspace(0, 1000, 7), 0.2, 0.4), 31.0, (700, 310, 19), (0.4, 1, 0.1)),
    "cap, cells above triangles": Case(cap(4), 100.0, (80, -60, 995), RIGHT),
    "cap, cells below triangles": Case(cap(2), 31.0, (80, -60, 970), RIGHT),
    "cap, cells far above triangles": Case(cap(5), 250.0, (80, -60, 995), RIGHT),
    "closed sphere": Case(icosphere(3), 130.0, (80, -60, 990), RIGHT),
    "hypar": Case(hypar(1.0, 1.0, 31), 55.0, (120, -90, -10), RIGHT),
    "hills": Case(bumpy(0), 7.0, (3, 5, 0), RIGHT),
    "hills, long cells": Case(bumpy(1), (11.0, 4.0), (-13, 25, 0), (0.2, 1, 0)),
    "hills, tiny cells": Case(bumpy(2, n=10), 1.3, (3, 5, 0), RIGHT, extent=(40, 40, 30, 30)),
    "hills, cloth of 60 degrees": Case(bumpy(3), 8.0, (3, 5, 0), RIGHT, initial_angle=np.radians(60)),
    "steep hills": Case(bumpy(4, height=45), 6.0, (3, 5, 0), RIGHT),
    "double curved": Case(krogh(30), 17.0, (240, 230, 60), RIGHT),
    "cube's corner, from beside it": Case(cube_corner(300), 17.0, (90, 60, 0), (-1, 0.2, 0)),
    "cube's corner, from the vertex": Case(cube_corner(300), 23.0, (0, 0, 0), (1, 0.7, 0)),
    "foot of a step, from the floor": Case(step_corner(300), 19.0, (110, 70, 0), (-1, -0.1, 0)),
    "foot of a step, from the vertex": Case(step_corner(300), 23.0, (0, 0, 0), (1, 0.5, 0)),
    "tube": Case(tube(), 9.0, (60, 0, 0), (0.0, 0.4, 1.0)),
}


def project(case: Case) -> Case:
    """The same start with its seed on the mould."""
    mould = case.mesh.mould()
    return replace(case, seed=tuple(mould.surface.closest_point(case.seed)[0].position(mould.surface).tolist()))


CASES = {name: project(case) for name, case in CASES.items()}
