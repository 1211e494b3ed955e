"""Moulds whose geometry is known exactly, built in memory. Lengths in mm, angles in rad; normals up or outward."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import meshdrape

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Profile = Callable[[FloatArray], FloatArray]


class Mesh(NamedTuple):
    """Vertices (n, 3), mm, and triangles (m, 3)."""

    vertices: FloatArray
    triangles: IntArray

    def mould(self) -> meshdrape.Mould:
        return meshdrape.Mould.from_arrays(self.vertices, self.triangles)

    def moved(self, rotation: ArrayLike, shift: ArrayLike = (0.0, 0.0, 0.0), scale: float = 1.0) -> Mesh:
        return Mesh(scale * self.vertices @ np.asarray(rotation).T + shift, self.triangles)

    def reversed(self) -> Mesh:
        """The same surface seen from its other side."""
        return Mesh(self.vertices, self.triangles[:, ::-1])

    def joined(self, other: Mesh) -> Mesh:
        """Both meshes, without common vertices."""
        return Mesh(
            np.concatenate([self.vertices, other.vertices]),
            np.concatenate([self.triangles, len(self.vertices) + other.triangles]),
        )

    def welded(self, tolerance: float = 1e-6) -> Mesh:
        key = np.round(self.vertices / tolerance).astype(np.int64)
        _, first, inverse = np.unique(key, axis=0, return_index=True, return_inverse=True)
        return Mesh(self.vertices[first], inverse.reshape(-1)[self.triangles])

    def kept(self, keep: NDArray[np.bool_]) -> Mesh:
        """The triangles (m,) asked for, without the vertices of the others."""
        used, compact = np.unique(self.triangles[keep], return_inverse=True)
        return Mesh(self.vertices[used], compact.reshape(-1, 3))


def rotation(axis: ArrayLike, angle: float) -> FloatArray:
    """Rotation matrix about an axis (Rodrigues)."""
    x, y, z = np.asarray(axis, dtype=np.float64) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def grid_triangles(n: int, m: int) -> IntArray:
    """Two triangles for each of n x m cells of a grid of vertices, about the normal of rows crossed with columns."""
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    a = i * (m + 1) + j
    b, c, d = a + m + 1, a + m + 2, a + 1
    return np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])


def grid(u: ArrayLike, v: ArrayLike, place: Callable[[FloatArray, FloatArray], tuple[ArrayLike, ...]]) -> Mesh:
    """The parametric surface place(u, v) -> (x, y, z) over a grid."""
    U, V = np.meshgrid(np.asarray(u, dtype=np.float64), np.asarray(v, dtype=np.float64), indexing="ij")
    x, y, z = (np.broadcast_to(value, U.shape) for value in place(U, V))
    return Mesh(np.stack([x, y, z], -1).reshape(-1, 3), grid_triangles(U.shape[0] - 1, U.shape[1] - 1))


# --- flat -----------------------------------------------------------------------------------------------------------


def tiles(n: int = 4) -> Mesh:
    """n x n unit squares, two triangles each; vertex (i, j) is number i (n + 1) + j."""
    return grid(np.arange(n + 1), np.arange(n + 1), lambda x, y: (x, y, 0))


def plate(length: float = 200.0, width: float = 140.0, cells: tuple[int, int] = (9, 7), jitter_seed: int = 1) -> Mesh:
    """A rectangle about the origin whose inner vertices are off the grid: no fibre runs along edges by chance."""
    mesh = grid(
        np.linspace(-length / 2, length / 2, cells[0] + 1),
        np.linspace(-width / 2, width / 2, cells[1] + 1),
        lambda x, y: (x, y, 0),
    )
    x, y, _ = mesh.vertices.T
    inside = (np.abs(x) < 0.499 * length) & (np.abs(y) < 0.499 * width)
    step = np.array([length / cells[0], width / cells[1], 0.0])
    jitter = np.random.default_rng(jitter_seed).uniform(-0.3, 0.3, mesh.vertices.shape) * step
    return Mesh(mesh.vertices + jitter * inside[:, None], mesh.triangles)


def cut_plate(
    keep: Callable[[FloatArray, FloatArray], NDArray[np.bool_]], size: float = 200.0, cells: int = 20
) -> Mesh:
    """Of a square plate about the origin the triangles whose centres (x, y) are to be kept."""
    side = np.linspace(-size / 2, size / 2, cells + 1)
    mesh = grid(side, side, lambda x, y: (x, y, 0))
    centre = mesh.vertices[mesh.triangles].mean(axis=1)
    return mesh.kept(keep(centre[:, 0], centre[:, 1]))


def holed_plate(size: float = 200.0, hole: float = 60.0) -> Mesh:
    """A square plate about the origin with a square hole about (25, 5)."""
    return cut_plate(lambda x, y: np.maximum(np.abs(x - 25), np.abs(y - 5)) > hole / 2, size, 40)


def parallelogram(
    length: float = 300.0, width: float = 100.0, sweep: float = 1.0, cells: tuple[int, int] = (12, 5)
) -> Mesh:
    """A swept plate: x from the line x = sweep y, length long, |y| <= width / 2."""
    return grid(
        np.linspace(-length / 2, length / 2, cells[0] + 1),
        np.linspace(-width / 2, width / 2, cells[1] + 1),
        lambda s, t: (s + sweep * t, t, 0),
    )


def triangle_plate(corners: ArrayLike = ((0.0, 0.0), (300.0, 0.0), (60.0, 200.0)), cells: int = 6) -> Mesh:
    """A triangle in the plane z = 0, cut into cells^2 triangles."""
    a, b, c = (np.append(corner, 0.0) for corner in np.asarray(corners, dtype=np.float64))
    index = {}
    vertices, triangles = [], []
    for i in range(cells + 1):
        for j in range(cells + 1 - i):
            index[i, j] = len(vertices)
            vertices.append(a + (b - a) * i / cells + (c - a) * j / cells)
    for i in range(cells):
        for j in range(cells - i):
            triangles.append((index[i, j], index[i + 1, j], index[i, j + 1]))
            if i + j + 1 < cells:
                triangles.append((index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]))
    return Mesh(np.array(vertices), np.array(triangles))


def sliver_plate(length: float = 200.0, width: float = 140.0) -> Mesh:
    """A rectangle of strips and needles, up to thousands of times longer than wide."""
    y = np.sort(np.concatenate([np.linspace(-width / 2, width / 2, 8), [0.05, 0.1, 0.15, -31.0, -30.9]]))
    x = np.sort(np.concatenate([np.linspace(-length / 2, length / 2, 3), [0.02, 0.2, 17.0, 17.1]]))
    return grid(x, y, lambda x, y: (x, y, 0))


# --- developable ----------------------------------------------------------------------------------------------------


def cylinder(
    radius: float = 500.0,
    azimuth: tuple[float, float] = (-1.6, 2.0),
    half_length: float = 900.0,
    n: int = 300,
) -> Mesh:
    """Facets along the rulings of a cylinder about z, so a prism; normals away from the axis."""
    return grid(
        np.linspace(*azimuth, n + 1),
        np.linspace(-half_length, half_length, 3),
        lambda p, z: (radius * np.cos(p), radius * np.sin(p), z),
    )


def tube(radius: float = 60.0, length: float = 200.0, n: int = 24, rings: int = 5) -> Mesh:
    """A prism closed about z, open at both ends: the net meets itself on it."""
    azimuth = np.linspace(0, 2 * np.pi, n + 1)
    return grid(
        azimuth,
        np.linspace(-length / 2, length / 2, rings + 1),
        lambda p, z: (radius * np.cos(p), radius * np.sin(p), z),
    ).welded()


def cone(
    half_angle: float = np.radians(25),
    slant: tuple[float, float] = (300.0, 1900.0),
    azimuth: tuple[float, float] = (-1.6, 2.6),
    n: int = 300,
) -> Mesh:
    """Facets along the rulings of a cone about z, its apex (left out) at the origin; normals away from the axis."""
    s, c = np.sin(half_angle), np.cos(half_angle)
    return grid(
        np.linspace(*azimuth, n + 1),
        np.linspace(*slant, 4),
        lambda p, r: (r * s * np.cos(p), r * s * np.sin(p), r * c),
    )


def wing_spar(wing: Profile, spar: Profile, y: ArrayLike, chord: float, height: float) -> Mesh:
    """A wing z = wing(y) and a spar x = spar(y) that meet in a crease, facets along the rulings of each.

    The wing reaches from the crease to x = chord, the spar from the crease to z = -height below it. Normals point
    up out of the wing and away from it out of the spar. The polyhedron is developable on both sides of the crease.
    """
    y = np.asarray(y, dtype=np.float64)
    edge, lift = np.broadcast_to(spar(y), y.shape), np.broadcast_to(wing(y), y.shape)
    t = np.array([0.0, 1.0])
    wing_part = grid(t, y, lambda s, _: (edge + s * (chord - edge), y, lift))
    spar_part = grid(-t[::-1], y, lambda s, _: (edge, y, lift + s * height))
    return spar_part.joined(wing_part).welded()


# --- doubly curved --------------------------------------------------------------------------------------------------


def icosphere(level: int = 4, radius: float = 1000.0) -> Mesh:
    """A sphere of 20 x 4^level triangles about the origin, turned so that no symmetry of it meets a coordinate axis."""
    phi = (1 + 5**0.5) / 2
    # three golden rectangles
    vertices = np.array([[-1, phi, 0], [1, phi, 0], [-1, -phi, 0], [1, -phi, 0]])
    vertices = np.concatenate([vertices, vertices[:, [2, 0, 1]], vertices[:, [1, 2, 0]]])
    triangles = np.array([[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4],
                          [11, 10, 2], [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
                          [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]])  # fmt: skip
    vertices = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    for _ in range(level):
        edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        unique, middle = np.unique(edges, axis=0, return_inverse=True)
        halves = vertices[unique].sum(axis=1)
        ab, bc, ca = (middle.reshape(-1, 3) + len(vertices)).T
        a, b, c = triangles.T
        vertices = np.concatenate([vertices, halves / np.linalg.norm(halves, axis=1)[:, None]])
        corners = [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        triangles = np.concatenate([np.stack(t, axis=1) for t in corners])
    return Mesh(radius * vertices @ rotation([0.3, 0.5, 0.8], 0.7).T, triangles)


def cap(level: int = 4, radius: float = 1000.0, depth: float = 0.25) -> Mesh:
    """The part of that sphere about +z above (1 - depth) of its radius; a ragged border."""
    ball = icosphere(level, radius)
    return ball.kept(ball.vertices[ball.triangles][..., 2].min(axis=1) > (1 - depth) * radius)


def hypar(k: float = 1.0, half: float = 1.3, n: int = 80, scale: float = 1000.0, symmetric: bool = False) -> Mesh:
    """z = k x y in units of `scale` mm over |x|, |y| <= half; n cells a side.

    For even n vertices lie on both axes. The diagonals all run one way, or, for even n, away from the middle, which
    keeps the surface's symmetry.
    """
    side = np.linspace(-half, half, n + 1)
    mesh = grid(side, side, lambda x, y: (scale * x, scale * y, scale * k * x * y))
    if not symmetric:
        return mesh
    first, second = np.split(mesh.triangles.copy(), 2)
    a, b, c, d = first[:, 0], first[:, 1], first[:, 2], second[:, 2]
    across = np.prod(mesh.vertices[a, :2] + mesh.vertices[c, :2], axis=1) < 0
    first[across], second[across] = np.stack([a, b, d], 1)[across], np.stack([b, c, d], 1)[across]
    return Mesh(mesh.vertices, np.concatenate([first, second]))


def bumpy(seed: int = 0, size: float = 200.0, n: int = 24, height: float = 18.0, jitter: float = 0.25) -> Mesh:
    """A plate with random hills, hollows and saddles on an irregular grid."""
    rng = np.random.default_rng(seed)
    side = np.linspace(-size / 2, size / 2, n + 1)
    mesh = grid(side, side, lambda x, y: (x, y, 0))
    x, y, _ = mesh.vertices.T
    inside = np.maximum(np.abs(x), np.abs(y)) < 0.499 * size
    x = x + inside * rng.uniform(-jitter, jitter, len(x)) * size / n
    y = y + inside * rng.uniform(-jitter, jitter, len(y)) * size / n
    z = np.zeros_like(x)
    for _ in range(6):
        cx, cy = rng.uniform(-0.4 * size, 0.4 * size, 2)
        width = rng.uniform(0.15, 0.35) * size
        z += height * rng.uniform(-1, 1) * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * width**2))
    return Mesh(np.stack([x, y, z], axis=1), mesh.triangles)


def krogh(n: int = 60) -> Mesh:
    """KinDrape's generic double-curved mould (Krogh et al. 2021, doi 10.1007/s00158-021-02925-z), [0, 0.5]^2 m."""
    side = np.linspace(0, 0.5, n + 1)

    def place(x: FloatArray, y: FloatArray) -> tuple[FloatArray, ...]:
        z = 1.004 * x + 1.089 * y - 3.667 * x**2 - 4.4 * x * y - 3.75 * y**2
        z = z + 3.086 * x**3 + 8.889 * x**2 * y + 4.321 * y**3
        return 1000 * x, 1000 * y, 1000 * z

    return grid(side, side, place)


# --- one-sided ------------------------------------------------------------------------------------------------------


def moebius(cells: int = 40) -> Mesh:
    """A strip about the circle of radius 1 that is turned over once."""
    t = np.arange(cells) * 2 * np.pi / cells
    edges = [
        np.stack([(1 + s * np.cos(t / 2)) * np.cos(t), (1 + s * np.cos(t / 2)) * np.sin(t), s * np.sin(t / 2)], 1)
        for s in (-0.3, 0.3)
    ]
    i = np.arange(cells - 1)
    inner = [np.stack([i, i + 1, cells + i + 1], 1), np.stack([i, cells + i + 1, cells + i], 1)]
    last = [[cells - 1, cells, 0], [cells - 1, 0, 2 * cells - 1]]
    return Mesh(np.concatenate(edges), np.concatenate([*inner, last]))


# --- polyhedra ------------------------------------------------------------------------------------------------------


def _square(origin: ArrayLike, u: ArrayLike, v: ArrayLike, side: float, n: int) -> Mesh:
    origin, u, v = (np.asarray(a, dtype=np.float64) for a in (origin, u, v))
    t = np.linspace(0, side, n + 1)
    mesh = grid(t, t, lambda a, b: (a, b, 0))
    return Mesh(origin + mesh.vertices[:, :1] * u + mesh.vertices[:, 1:2] * v, mesh.triangles)


def cube_corner(side: float = 1000.0, n: int = 3) -> Mesh:
    """Three squares about the corner at the origin, in the coordinate planes; normals into the first octant."""
    axis = np.eye(3)
    squares = [_square(np.zeros(3), axis[k], axis[(k + 1) % 3], side, n) for k in range(3)]
    return squares[0].joined(squares[1]).joined(squares[2]).welded()


def cube(side: float = 1.0, n: int = 2) -> Mesh:
    """The closed surface of the cube [0, side]^3, normals outward."""
    axis = np.eye(3)
    mesh = None
    for k in range(3):
        u, v, w = axis[k], axis[(k + 1) % 3], axis[(k + 2) % 3]
        low, high = _square(np.zeros(3), v, u, side, n), _square(side * w, u, v, side, n)
        mesh = low.joined(high) if mesh is None else mesh.joined(low).joined(high)
    assert mesh is not None
    return mesh.welded(1e-6 * side)


def step_corner(side: float = 1000.0, n: int = 4) -> Mesh:
    """Floor and walls about the foot of a block's upright edge: five squares, so a saddle vertex of angle 5 pi / 2.

    The block fills x < 0, y < 0, z > 0; the vertex is the origin.
    """
    ex, ey, ez = np.eye(3)
    rays = [ex, ey, -ex, ez, -ey]
    squares = [_square(np.zeros(3), rays[k], rays[(k + 1) % 5], side, n) for k in range(5)]
    mesh = squares[0]
    for square in squares[1:]:
        mesh = mesh.joined(square)
    return mesh.welded()
