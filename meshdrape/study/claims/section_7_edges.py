"""Sections 7.2 and 7.3: the nearly straight edge, pyramids and the corner of a cube."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshdrape.mould import Mould
from meshdrape.study.claims.claim import Claim, angle, number
from meshdrape.study.claims.drapes import MM, ruled_mould
from meshdrape.study.claims.judgement import Verdict, equality, first_order, order_of
from meshdrape.study.claims.runs import Runs
from meshdrape.study.claims.section_7 import EPSILON, ROUND_OFF_DEG
from meshdrape.theory import (
    apex_shear,
    pyramid_angle,
    pyramid_edges,
    straight_edge_node,
    straight_edge_sine,
    straight_edge_turn,
)
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import measure

FloatArray = NDArray[np.float64]


def equation_42(runs: Runs) -> Claim:
    """(42), its solution."""
    del runs
    m, step, errors = 1.3, 1e-5, []
    for epsilon in EPSILON:

        def place(u: float, v: float, epsilon: float = epsilon) -> FloatArray:
            x, y = straight_edge_node(u, v, np.sin(v), m, epsilon)
            return np.array([x, y, -m * (x - epsilon * np.sin(v))])

        along = (place(1.0, 0.4 + step) - place(1.0, 0.4 - step)) / (2 * step)
        errors.append(float(abs(np.linalg.norm(along) - 1)))
    off = f"{errors[-1]:.1e} at ε = 0.005, a power {order_of(errors):.2f}"
    found = f"f = sin y, m = 1.3, put into (33): |x_v| is off 1 by {off}."
    return Claim(
        "(42)",
        "Beyond the edge x = u / sqrt(1 + m²) + ε f (1 - 1 / sqrt(1 + m²)), y = v.",
        found,
        first_order(errors, 1.8),
    )


def _edge_drape(epsilon: float, m: float) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """The edge (41) with f = -y² draped: shear of its cells, their slopes ε f' and whether their rows began beyond it.

    A sheet over a metre, upright at its left end as the report has it, its first row half a cell from the corner; the
    cells are a fifth of the strip wide over which rows come across the edge.
    """
    spacing, facet = 200 * epsilon, 0.5
    y = np.arange(-0.5 * facet, 1001.0, facet)
    crease = np.stack([-epsilon * y**2 / 1000, y, 0 * y], axis=1)
    reach = 1000 * epsilon + 4 * spacing
    wing = np.stack([-reach - crease[:, 0], 0 * y, 0 * y], axis=1)
    mould = ruled_mould(crease, wing, np.array([1.0, 0.0, -m]) * 300 / np.sqrt(1 + m * m)).flipped()
    rows = int(reach / spacing - 1)
    net = drape(mould, Fabric(spacing), (-(rows + 0.5) * spacing, 0.0, 0.0), (0, 1, 0))
    shear, node = measure(net).cell_shear, net.node_position
    i0, j0 = net.seed_index
    side = 1 if np.nanmean(node[i0, j0 + 1 :, 0]) > node[i0, j0, 0] else -1
    n = int(1000 / spacing)
    cells, corners = [], []
    for k in range(rows + 12):
        a = j0 + side * k
        low = min(a, a + side)
        cells.append(shear[i0 : i0 + n - 1, low])
        corners.append(
            np.stack(
                [
                    node[i0 : i0 + n - 1, a],
                    node[i0 + 1 : i0 + n, a],
                    node[i0 : i0 + n - 1, a + side],
                    node[i0 + 1 : i0 + n, a + side],
                ]
            )
        )
    corner = np.stack(corners, axis=1)  # 4, rows, n - 1, 3
    beyond = (corner[..., 0] > -epsilon * corner[..., 1] ** 2 / 1000 + 1e-6).all(axis=0)
    middle = corner[..., 1].mean(axis=0)
    from_corner = np.arange(rows + 12)[:, None] > rows  # both rows of the cell begin beyond the edge
    slope = -2 * epsilon * middle / 1000
    return np.stack(cells), np.where(beyond, slope, np.nan), np.broadcast_to(from_corner, middle.shape)


def equation_43(runs: Runs) -> Claim:
    """(43), where rows begin beyond the edge."""
    return _equation_43(
        runs, "(43)", "sin θ = ε |f'| [1 - 1 / sqrt(1 + m²)], rows that begin beyond the edge.", begun=True
    )


def equation_43_strip(runs: Runs) -> Claim:
    """(43), where rows come over the edge."""
    return _equation_43(runs, "(43), for all y", "... and wherever rows come over the edge.", begun=False)


def _equation_43(runs: Runs, place: str, says: str, *, begun: bool) -> Claim:
    del runs
    m, errors, words = 1.0, [], []
    for epsilon in (0.1, 0.05):
        shear, slope, fed = _edge_drape(epsilon, m)
        cells = np.isfinite(shear) & np.isfinite(slope) & (fed if begun else ~fed)
        foretold = straight_edge_sine(slope[cells], m)
        off = np.abs(np.sin(np.abs(shear[cells])) - foretold)
        errors.append(float(off.max()))
        words.append(f"{errors[-1]:.1e} at ε = {epsilon:g} ({cells.sum()} cells)")
    exact = abs(float(straight_edge_turn(-0.1 * 2 * 0.99, m)))
    formula = float(np.arcsin(straight_edge_sine(0.1 * 2 * 0.99, m)))
    found = (
        "f = -y², m = 1, y up to 1, draped at 20 and 10 mm: sin θ off by up to "
        + ", ".join(words)
        + f". Exact turn at y = 0.99, ε = 0.1: {angle(exact, 4)}, (43) {angle(formula, 4)}."
    )
    return Claim(
        place,
        says,
        found,
        first_order(errors, 1.5),
        ((Verdict.WRONG, "Not in the strip where rows come from the wing: they are turned by their own ψ."),),
    )


def upright_limit(runs: Runs) -> Claim:
    """(43) for m to infinity against (20)."""
    del runs
    slope = 0.2 / 2.0 ** np.arange(4)
    exact = np.abs(straight_edge_turn(slope, np.inf))
    both = [np.degrees(np.arcsin(straight_edge_sine(slope, np.inf)) - exact), np.degrees(np.arctan(slope) - exact)]
    found = (
        f"Flat wing, upright spar, ε f' = 0.2: exact {angle(float(exact[0]), 4)}, arcsin is {both[0][0]:.4f}° over it, "
        f"arctan of (20) {number(float(abs(both[1][0])), 4)}°; the difference falls with a power "
        f"{order_of(both[0]):.2f}."
    )
    return Claim(
        "(43), m → ∞",
        "sin θ = ε |f'|, as found in section 4.",
        found,
        first_order(both[0], 1.8, "deg"),
        ((Verdict.FIRST_ORDER, "For a flat wing θ = arctan |f'| is exact, as (20) has it."),),
    )


def _pyramid(sides: int, slant: float) -> Mould:
    edges = MM * pyramid_edges(sides, slant)
    k = np.arange(sides)
    return Mould.from_arrays(
        np.concatenate([[[0.0, 0.0, 0.0]], edges]), np.stack([0 * k, 1 + k, 1 + (k + 1) % sides], axis=1)
    )


def _apex_drape(sides: int, slant: float) -> FloatArray:
    """|Shear| of all cells of a drape whose seed is the apex."""
    edges = pyramid_edges(sides, slant)
    net = drape(_pyramid(sides, slant), Fabric(60.0), (0, 0, 0), 0.7 * edges[0] + 0.3 * edges[1])
    shear = measure(net).cell_shear
    return np.abs(shear[np.isfinite(shear)])


def cube_corner(runs: Runs) -> Claim:
    """7.3: the corner of a cube."""
    del runs
    shear = _apex_drape(3, float(np.arccos(1 / np.sqrt(3))))
    found = (
        f"Draped with the seed on the vertex, {len(shear)} cells: {angle(float(shear.min()), 6)} to "
        f"{angle(float(shear.max()), 6)}; π/8 is {angle(np.pi / 8, 6)}."
    )
    return Claim(
        "7.3",
        "Covering the corner of a cube needs π/8 of shear in each quadrant.",
        found,
        equality(np.degrees(shear - np.pi / 8), ROUND_OFF_DEG, "deg"),
        ((Verdict.HOLDS, "Exact for finite spacing too, and three times what locks at 7°."),),
    )


def any_pyramid(runs: Runs) -> Claim:
    """7.3: any pyramid."""
    del runs
    off, words = [], []
    for sides, slant in ((3, 0.6), (4, 1.2), (5, 0.9), (7, 1.5)):
        shear = _apex_drape(sides, slant)
        expected = apex_shear(pyramid_angle(sides, slant))
        off.append(float(np.abs(shear - expected).max()))
        words.append(f"{sides} sides {angle(expected)}")
    found = f"Draped, uniform in every quadrant to {angle(max(off))}: " + ", ".join(words) + "."
    return Claim(
        "7.3",
        "Any pyramid can be covered with uniform shear in each quadrant, the origin on its apex.",
        found,
        equality(np.degrees(off), ROUND_OFF_DEG, "deg"),
    )


CLAIMS = (
    equation_42,
    equation_43,
    equation_43_strip,
    upright_limit,
    cube_corner,
    any_pyramid,
)
