"""Facts of the moulds drapers are tested with, from formulas written here anew."""

from __future__ import annotations

import c_spar
import hat
import joggle
import l_corner
import leading_edge
import numpy as np
import pyramid
import saddle
from mould_facts import Fact, over_square
from tessellated import Tessellation

UP = np.array([0.0, 0.0, 1.0])
FOOT = np.sqrt(100**2 + 2 * 100 * 20)  # of the hat's fillet, from the axis
LEAVE = np.arcsin(20 / 120)
RAMP = np.radians(30)
RAMP_LENGTH = (10 - 30 * (1 - np.cos(RAMP))) / np.sin(RAMP)
INCLINE = np.hypot(1, 75 / 2000)  # 1 / cos t of the C-spar's flanges


def upwards(p: np.ndarray) -> np.ndarray:
    return np.tile(UP, (len(p), 1))


def off_hat(t: Tessellation) -> np.ndarray:
    out, z = np.hypot(*t.vertices.T[:2]), t.vertices[:, 2]
    dome, tube = np.hypot(out, z) - 100, np.hypot(out - FOOT, z - 20) - 20
    return np.where(z > 20 * (1 - np.sin(LEAVE)) - 1e-6, dome, np.where(out < FOOT - 1e-6, tube, z))


def curvature_of_hat(p: np.ndarray) -> np.ndarray:
    out = np.hypot(*p.T[:2])
    on_rim, on_dome = np.abs(p[:, 2]) < 1e-9, np.abs(np.linalg.norm(p, axis=1) - 100) < 1e-9
    return np.where(on_dome, 1e-4, np.where(on_rim, 0, -(FOOT - out) / (20**2 * np.maximum(out, 1))))


def off_joggle(t: Tessellation) -> np.ndarray:
    x, _, z = t.vertices.T
    end = 30 * np.sin(RAMP) + RAMP_LENGTH * np.cos(RAMP)
    first, second = 15 * np.sin(RAMP), end - 15 * np.sin(RAMP)
    return np.select(
        [x <= 0, x < first, x <= second, x < end],
        [
            z,
            np.hypot(x, z + 15) - 15,
            z + 15 * (1 - np.cos(RAMP)) + (x - first) * np.tan(RAMP),
            np.hypot(x - end, z - 5) - 15,
        ],
        z + 10,
    )


def off_l_corner(t: Tessellation) -> np.ndarray:
    x, _, z = t.vertices.T
    return np.where(x <= 0, z, np.where(z <= -10, x - 10, np.hypot(x, z + 10) - 10))


def off_c_spar(t: Tessellation) -> np.ndarray:
    x, y, z = t.vertices.T
    inside = (150 - 75 * y / 2000 - np.abs(z)) / INCLINE  # distance from the flange's plane
    return np.where(x >= 12, inside, np.where(inside >= 12, x, np.hypot(x - 12, inside - 12) - 12))


def naca_2412(xi: np.ndarray, side: float) -> np.ndarray:
    """x and z of one side, up to the place of the largest camber."""
    half = 0.6 * (0.2969 * np.sqrt(xi) - 0.1260 * xi - 0.3516 * xi**2 + 0.2843 * xi**3 - 0.1015 * xi**4)
    line, slope = 0.02 / 0.16 * (0.8 * xi - xi**2), np.arctan(0.04 / 0.16 * (0.4 - xi))
    return 1000 * np.stack([xi - side * half * np.sin(slope), line + side * half * np.cos(slope)], axis=-1)


def off_leading_edge(t: Tessellation) -> np.ndarray:
    """Nearest of 200,000 points of the section, whose gaps are 5e-3 mm at most: quadratic in them."""
    s = np.linspace(0, np.sqrt(0.3), 100_001)
    section = np.concatenate([naca_2412(s**2, side) for side in (1.0, -1.0)])
    x, y, z = t.vertices.T
    from scipy.spatial import cKDTree

    back = np.tan(np.radians(25)) * y
    _, near = cKDTree(section).query(np.stack([x - back, z], axis=-1))
    # along the chord the sampled point may be half a gap away: measure across the section alone
    ahead = section[np.clip(near + 1, 0, len(section) - 1)] - section[np.clip(near - 1, 0, len(section) - 1)]
    off = np.stack([x - back, z], axis=-1) - section[near]
    return (off[:, 0] * ahead[:, 1] - off[:, 1] * ahead[:, 0]) / np.linalg.norm(ahead, axis=1)


def leading_edge_area(side: float) -> float:
    def strip(_: np.ndarray, s: np.ndarray) -> np.ndarray:
        x, z = (1e20 * naca_2412_of_root(s + 1e-20j, side)).imag
        swept = np.array([2000 * np.tan(np.radians(25)), 2000.0])
        return np.sqrt((z * swept[1]) ** 2 + (z * swept[0]) ** 2 + (x * swept[1]) ** 2)

    depth = np.sqrt(0.3)
    return over_square(0, depth, strip) / depth


def naca_2412_of_root(s: np.ndarray, side: float) -> np.ndarray:
    """The section again as a function of the root of xi, (2, ...), analytic in it."""
    xi = s * s
    half = 0.6 * (0.2969 * s - 0.1260 * xi - 0.3516 * xi**2 + 0.2843 * xi**3 - 0.1015 * xi**4)
    line, slope = 0.02 / 0.16 * (0.8 * xi - xi**2), np.arctan(0.04 / 0.16 * (0.4 - xi))
    return 1000 * np.stack([xi - side * half * np.sin(slope), line + side * half * np.cos(slope)])


FURTHER = (
    Fact(
        hat,
        (
            2 * np.pi * 100**2 * (1 - np.sin(LEAVE)),
            40 * np.pi * (FOOT * (np.pi / 2 - LEAVE) - 20 * (1 - np.sin(LEAVE))),
            np.pi * (200**2 - FOOT**2),
        ),
        off_hat,
        upwards,
        curvature_of_hat,
        1 / 20,
    ),
    Fact(joggle, (200 * (300 + 30 * RAMP + RAMP_LENGTH),), off_joggle, upwards, largest_curvature=1 / 15),
    Fact(
        l_corner,
        (30000, 24000, 300 * 10 * np.pi / 2),
        off_l_corner,
        lambda p: np.tile([1.0, 0.0, 1.0], (len(p), 1)),
        largest_curvature=1 / 10,
    ),
    Fact(
        pyramid,
        (4 * 1000**2 * np.sin(np.radians(60)) / 2,),
        lambda t: np.abs(t.vertices[:, :2]).max(axis=1) / np.sqrt(0.5) + t.vertices[:, 2],
        upwards,
    ),
    Fact(
        saddle,
        (over_square(-1200, 1200, lambda x, y: np.sqrt(1 + 1e-6 * (x**2 + y**2))),),
        lambda t: t.vertices[:, 2] - (t.vertices[:, 0] ** 2 - t.vertices[:, 1] ** 2) / 2000,
        upwards,
        lambda p: -1e-6 / (1 + 1e-6 * (p[:, 0] ** 2 + p[:, 1] ** 2)) ** 2,
        1e-3,
    ),
    Fact(
        c_spar,
        (
            2000 * (225 - 24 * INCLINE),
            *(2 * [12 * np.pi / 2 * 2000 * INCLINE]),
            *(2 * [68 * 2000 * INCLINE]),
        ),
        off_c_spar,
        lambda p: np.stack([0 * p[:, 0] - 1, 0 * p[:, 0], np.sign(p[:, 2])], axis=-1),
        largest_curvature=1 / 12,
    ),
    Fact(
        leading_edge,
        (leading_edge_area(1.0), leading_edge_area(-1.0)),
        off_leading_edge,
        lambda p: p - np.stack([p[:, 1] * np.tan(np.radians(25)) + 60, p[:, 1], 0 * p[:, 0] + 8], axis=-1),
        largest_curvature=1 / 15.8,
    ),
)
