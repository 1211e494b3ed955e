"""Section 7.3: a net with its seed on the apex of a pyramid, the corner of a cube among them.

The half-fibres leave the apex a quarter of its whole angle apart and run straight over edges and faces; each quadrant
is a plane lattice sheared by π/2 less that quarter, folded over the edges. Exact for any spacing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from meshdrape.errors import DesignError
from meshdrape.theory.quadrature import FloatArray


def apex_shear(total_angle: float) -> float:
    """Shear of every cell about an apex of a total surface angle, rad: (2π - total) / 4, signed.

    A cube's corner has 3π/2: π/8. Positive where there is less than 2π, the angle closing; negative about a saddle.
    """
    if not 0 < total_angle < 4 * np.pi:
        msg = f"total_angle={total_angle} rad: must lie between 0 and 4π, or cells fold flat"
        raise DesignError(msg)
    return (2 * np.pi - total_angle) / 4


def pyramid_angle(sides: int, slant: float) -> float:
    """Total angle at the apex of a regular pyramid, rad.

    Parameters
    ----------
    slant : float
        Angle of its edges against the axis, rad.
    """
    if sides < 3 or not 0 < slant <= np.pi / 2:
        msg = f"sides={sides}, slant={slant} rad: at least 3 sides, slant above 0 and at most π/2"
        raise DesignError(msg)
    return float(2 * sides * np.arcsin(np.sin(slant) * np.sin(np.pi / sides)))


def pyramid_edges(sides: int, slant: float) -> FloatArray:
    """Unit vectors (sides, 3) down the edges of a regular pyramid with its apex at the origin and its axis along -z."""
    pyramid_angle(sides, slant)
    turn = 2 * np.pi * np.arange(sides) / sides
    return np.stack(
        [np.sin(slant) * np.cos(turn), np.sin(slant) * np.sin(turn), np.full(sides, -np.cos(slant))], axis=-1
    )


def apex_net(edges: ArrayLike, spacing: float, cells: int, first: float = 0.0) -> FloatArray:
    """The net about an apex at the origin, (4, cells + 1, cells + 1, 3), a quadrant each.

    Parameters
    ----------
    edges : (k, 3) float, k >= 3
        Vectors down the edges, counter-clockwise seen from outside; plane faces between one and the next.
    spacing : float
    cells : int
        Each way in each quadrant.
    first : float
        Where the first half-fibre leaves, measured over the faces from the first edge, rad.
    """
    directions = np.asarray(edges, dtype=np.float64)
    directions = directions / np.linalg.norm(directions, axis=1, keepdims=True)
    after = np.roll(directions, -1, axis=0)
    angle = np.arccos(np.clip(np.sum(directions * after, axis=1), -1, 1))
    ends = np.concatenate([[0.0], np.cumsum(angle)])
    quarter = ends[-1] / 4
    apex_shear(float(ends[-1]))
    i, j = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1), indexing="ij")
    quadrant = np.arange(4)[:, None, None]
    lattice = spacing * (i + j * np.exp(1j * quarter))
    turn = np.mod(first + quadrant * quarter + np.angle(lattice), ends[-1])
    face = np.clip(np.searchsorted(ends, turn, side="right") - 1, 0, len(angle) - 1)
    # within a face, between its two edges a and b at the angle w: by sines
    t, w = turn - ends[face], angle[face]
    weight = np.stack([np.sin(w - t), np.sin(t)], axis=-1) / np.sin(w)[..., None]
    return np.asarray(np.abs(lattice)[..., None] * (weight[..., :1] * directions[face] + weight[..., 1:] * after[face]))
