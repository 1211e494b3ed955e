"""Walls over a polyline, open or closed: they unroll, so that what lies where on a net is known by arithmetic."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from moulds import FloatArray, IntArray, Mesh

import meshdrape


@dataclass(frozen=True)
class Prism:
    """A wall of a given height over a polyline, closed where its ends are one; normals to the right of it.

    Attributes
    ----------
    profile : (n + 1, 2) mm
    height : float, mm
    rows : int
        Rows of triangles.
    noise : float
        Standard deviation, mm, by which each vertex is moved across the wall.
    """

    profile: FloatArray
    height: float
    rows: int = 3
    noise: float = 0.0

    @property
    def closed(self) -> bool:
        return bool(np.allclose(self.profile[0], self.profile[-1]))

    @property
    def at(self) -> FloatArray:
        """Arc length at the profile's points, (n + 1,) mm."""
        return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(self.profile, axis=0), axis=1))])

    @property
    def mesh(self) -> Mesh:
        points = self.profile[:-1] if self.closed else self.profile
        n, z = len(self.profile) - 1, np.linspace(0, self.height, self.rows + 1)
        vertices = np.concatenate([np.repeat(points, len(z), axis=0), np.tile(z, len(points))[:, None]], axis=1)
        if self.noise:
            away = np.random.default_rng(0).normal(0, self.noise, len(vertices))
            vertices[:, :2] *= 1 + (away / np.linalg.norm(vertices[:, :2], axis=1))[:, None]
        number = np.arange(len(vertices)).reshape(len(points), -1)
        left, right = number[:n], np.roll(number, -1, axis=0)[:n]
        a, b, c, d = left[:, :-1], right[:, :-1], right[:, 1:], left[:, 1:]
        triangles = [np.stack(corners, -1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))]
        return Mesh(vertices, np.concatenate(triangles))

    def place(self, s: float, z: float) -> FloatArray:
        """The point at arc length s and height z, (3,)."""
        return np.array([*(np.interp(s, self.at, self.profile[:, k]) for k in range(2)), z])

    def unrolled(self, triangle: IntArray, point: FloatArray) -> FloatArray:
        """Arc length and height, (n, 2), of points (n, 3) on triangles (n,) of the mesh."""
        facet = triangle % ((len(self.profile) - 1) * self.rows) // self.rows
        s = self.at[facet] + np.linalg.norm(point[:, :2] - self.profile[facet], axis=1)
        return np.stack([s, point[:, 2]], axis=1)

    def drape(
        self, spacing: tuple[float, float], seed: tuple[float, float], turn: float, **options: object
    ) -> meshdrape.Net:
        """The net from (arc length, height), mm, the warp turned by so many rad from the profile towards the height."""
        facet = int(np.searchsorted(self.at, seed[0])) - 1
        along = (self.profile[facet + 1] - self.profile[facet]) / (self.at[facet + 1] - self.at[facet])
        direction = (*(np.cos(turn) * along), np.sin(turn))
        fabric = meshdrape.Fabric(spacing)
        return meshdrape.drape(self.mesh.mould(), fabric, self.place(*seed), direction, **options)

    def in_cloth(
        self, spacing: tuple[float, float], seed: tuple[float, float], turn: float, unrolled: FloatArray
    ) -> FloatArray:
        """Lattice coordinates from the seed, (laps, n, 2), of unrolled points (n, 2), once for each lap of the wall."""
        c, s = np.cos(turn), np.sin(turn)
        sides = np.array([[c, -s], [s, c]]) * spacing
        laps = np.arange(-12, 13) if self.closed else np.zeros(1)
        ahead = np.stack([laps * self.at[-1], 0 * laps], axis=1)
        return np.asarray((unrolled - seed + ahead[:, None]) @ np.linalg.inv(sides).T)


def tube_of(facets: int, rows: int, height: float, radius: float = 25.0) -> Prism:
    turns = 2 * np.pi * np.arange(facets + 1) / facets
    return Prism(radius * np.stack([np.cos(turns), np.sin(turns)], axis=1), height, rows)


def roll(rows: int = 39, noise: float = 0.0) -> Prism:
    """Two turns of a spiral from 50 mm radius on, 3 mm apart, 150 mm high."""
    turns = np.linspace(0, 4 * np.pi, 160)
    radius = 50 + 3 * turns / (2 * np.pi)
    return Prism(np.stack([radius * np.cos(turns), radius * np.sin(turns)], axis=1), 150.0, rows, noise)
