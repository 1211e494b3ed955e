"""Meshes such as nobody would draw, and drapes over them, each told by its kind and one number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from moulds import Mesh, bumpy, grid, icosphere, plate, rotation
from numpy.random import Generator
from numpy.typing import NDArray

import meshdrape

FloatArray = NDArray[np.float64]


def bumpy_grid(rng: Generator) -> Mesh:
    """Hills and hollows, of heights from gentle to steep."""
    n = int(rng.integers(2, 30))
    return bumpy(int(rng.integers(1 << 30)), n=n, height=10 ** rng.uniform(-2, 1.9), jitter=rng.uniform(0, 0.45))


def saddle(rng: Generator) -> Mesh:
    """z = k (x^2 - a y^2), or a monkey saddle, cut into quadrilaterals of one diagonal."""
    n, k, a = int(rng.integers(2, 25)), rng.uniform(0.1, 3) / 200, rng.uniform(0.2, 3)
    side = np.linspace(-100, 100, n + 1)
    if rng.random() < 0.3:
        return grid(side, side, lambda x, y: (x, y, k * (x**3 - 3 * x * y**2) / 200))
    return grid(side, side, lambda x, y: (x, y, k * (x**2 - a * y**2)))


def slivers(rng: Generator) -> Mesh:
    """Rows and columns at random places, so that triangles get up to a million times longer than wide."""
    thin = 10 ** rng.uniform(-4, 0)
    lines = []
    for _ in range(2):
        coarse = np.linspace(-100, 100, int(rng.integers(2, 8)))
        near = rng.choice(coarse[:-1], 2) + thin * rng.uniform(0.5, 2, 2)
        lines.append(np.unique(np.concatenate([coarse, near])))
    height = 10 ** rng.uniform(-3, 1)
    waves = rng.uniform(0.01, 0.04, 2)
    return grid(*lines, lambda x, y: (x, y, height * np.sin(waves[0] * x) * np.cos(waves[1] * y)))


def needle_fan(rng: Generator) -> Mesh:
    """A vertex of many thin triangles: a cone, dome or pleated saddle about it."""
    n = int(rng.integers(3, 300))
    rings = int(rng.integers(1, 5))
    azimuth = np.sort(rng.uniform(0, 2 * np.pi, n)) if rng.random() < 0.3 else np.arange(n) * 2 * np.pi / n
    # no gap of half a turn or more, and none of nothing
    azimuth = azimuth[np.append(True, np.diff(azimuth) > 1e-5)]
    if np.diff(np.append(azimuth, azimuth[0] + 2 * np.pi)).max() > 3.0:
        azimuth = np.arange(n) * 2 * np.pi / n
    n = len(azimuth)
    radius = 100 * np.arange(1, rings + 1) / rings
    wave = rng.uniform(0, 40) * np.cos(int(rng.integers(2, 5)) * azimuth)
    steep = rng.uniform(-1.5, 1.5)
    vertices = [np.zeros((1, 3))]
    for r in radius:
        z = steep * r + wave * (r / 100) ** rng.choice([1, 2])
        vertices.append(np.stack([r * np.cos(azimuth), r * np.sin(azimuth), z], axis=1))
    k = np.arange(n)
    following = (k + 1) % n
    triangles = [np.stack([np.zeros(n, dtype=int), 1 + k, 1 + following], axis=1)]
    for ring in range(1, rings):
        a, b = 1 + (ring - 1) * n, 1 + ring * n
        triangles += [np.stack([a + k, b + k, b + following], 1), np.stack([a + k, b + following, a + following], 1)]
    return Mesh(np.concatenate(vertices), np.concatenate(triangles))


def torn(rng: Generator) -> Mesh:
    """Hills with triangles taken out at random: holes, a jagged outline, what hangs on by one vertex left out."""
    mesh = bumpy(int(rng.integers(1 << 30)), n=int(rng.integers(6, 24)), height=rng.uniform(0, 30))
    keep = rng.random(len(mesh.triangles)) > rng.uniform(0.005, 0.25)
    return without_bow_ties(mesh.kept(keep))


def holed(rng: Generator) -> Mesh:
    """Hills with round holes."""
    mesh = bumpy(int(rng.integers(1 << 30)), n=int(rng.integers(10, 30)), height=rng.uniform(0, 20))
    centre = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2]
    keep = np.ones(len(centre), dtype=bool)
    for _ in range(int(rng.integers(1, 5))):
        keep &= np.linalg.norm(centre - rng.uniform(-100, 100, 2), axis=1) > rng.uniform(8, 45)
    return without_bow_ties(mesh.kept(keep))


def single_precision(rng: Generator) -> Mesh:
    """A smooth plate far from the origin whose coordinates went through float32."""
    mesh = bumpy(int(rng.integers(1 << 30)), n=int(rng.integers(4, 40)), height=rng.uniform(0, 15))
    shift = 10 ** rng.uniform(0, 4) * rng.standard_normal(3)
    return Mesh((mesh.vertices + shift).astype(np.float32).astype(np.float64), mesh.triangles)


def scattered(rng: Generator) -> Mesh:
    """Points scattered in a disc, joined by Delaunay, with heights at random: every vertex a spike or a pit."""
    from scipy.spatial import Delaunay

    n = int(rng.integers(5, 300))
    flat = 100 * rng.uniform(-1, 1, (n, 2))
    triangles = Delaunay(flat).simplices
    u, v = (flat[triangles[:, k]] - flat[triangles[:, 0]] for k in (1, 2))
    turned = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0
    triangles = np.where(turned[:, None], triangles[:, ::-1], triangles).astype(np.int64)
    height = 10 ** rng.uniform(-6, 1.5) * rng.standard_normal(n)
    return Mesh(np.column_stack([flat, height]), triangles)


def noisy_sphere(rng: Generator) -> Mesh:
    """A closed sphere with vertices off it by up to a fifth of an edge."""
    level = int(rng.integers(0, 4))
    mesh = icosphere(level, 100.0)
    noise = rng.uniform(0, 0.2) * 100 / 2**level
    return Mesh(mesh.vertices + rng.uniform(-noise, noise, mesh.vertices.shape), mesh.triangles)


def torus(rng: Generator) -> Mesh:
    """A closed torus, thick or thin."""
    n, m = int(rng.integers(5, 40)), int(rng.integers(4, 30))
    large, small = 100.0, rng.uniform(10, 80)
    mesh = grid(
        np.linspace(0, 2 * np.pi, n + 1),
        np.linspace(0, 2 * np.pi, m + 1),
        lambda a, b: (
            (large + small * np.cos(b)) * np.cos(a),
            (large + small * np.cos(b)) * np.sin(a),
            small * np.sin(b),
        ),
    )
    return mesh.welded()


def two_parts(rng: Generator) -> Mesh:
    """Two of the others, apart from one another."""
    first, second = (KINDS[str(rng.choice(["bumpy grid", "noisy sphere", "needle fan", "slivers"]))](rng) for _ in "ab")
    return first.joined(second.moved(np.eye(3), (0, 0, rng.uniform(300, 600))))


def few_triangles(rng: Generator) -> Mesh:
    """One to eight triangles about a vertex."""
    n = int(rng.integers(1, 9))
    azimuth = np.linspace(0, rng.uniform(0.3, 5.5), n + 1)
    rim = (
        np.stack([np.cos(azimuth), np.sin(azimuth), rng.uniform(-0.5, 0.5, n + 1)], 1)
        * rng.uniform(40, 120, n + 1)[:, None]
    )
    k = np.arange(n)
    return Mesh(np.concatenate([np.zeros((1, 3)), rim]), np.stack([np.zeros(n, dtype=int), 1 + k, 2 + k], axis=1))


def creased(rng: Generator) -> Mesh:
    """A plate folded along parallel lines, up and down."""
    n = int(rng.integers(2, 12))
    turns = np.cumsum(rng.uniform(-1.2, 1.2, n))
    steps = rng.uniform(5, 40, n)
    x, z = (np.append(0, np.cumsum(steps * turn(turns))) for turn in (np.cos, np.sin))
    across = np.linspace(-80, 80, int(rng.integers(2, 6)))
    mesh = grid(np.arange(n + 1.0), across, lambda i, y: (x[i.astype(int)], y, z[i.astype(int)]))
    return mesh


def flat_grid(rng: Generator) -> Mesh:
    """A plate whose edges run along the axes: fibres along edges and through vertices."""
    n, m = (int(k) for k in rng.integers(1, 12, 2))
    if rng.random() < 0.3:
        return plate(cells=(n, m), jitter_seed=0)
    return grid(np.linspace(-100, 100, n + 1), np.linspace(-70, 70, m + 1), lambda x, y: (x, y, 0))


KINDS: dict[str, Callable[[Generator], Mesh]] = {
    "bumpy grid": bumpy_grid,
    "saddle": saddle,
    "slivers": slivers,
    "needle fan": needle_fan,
    "torn": torn,
    "holed": holed,
    "single precision": single_precision,
    "scattered": scattered,
    "noisy sphere": noisy_sphere,
    "torus": torus,
    "two parts": two_parts,
    "few triangles": few_triangles,
    "creased": creased,
    "flat grid": flat_grid,
}


def without_bow_ties(mesh: Mesh) -> Mesh:
    """The largest part of a mesh that hangs together by edges, each fan about a vertex with a vertex of its own."""
    from meshdrape.surface import Surface

    surface = Surface.from_arrays(mesh.vertices, mesh.triangles)
    largest = np.argmax(np.bincount(surface.face_component))
    part = mesh.kept(surface.face_component == largest)
    surface = Surface.from_arrays(part.vertices, part.triangles)
    corner, count = part.triangles.copy(), len(part.vertices)
    fan = np.full(corner.shape, -1)
    extra = []
    seen: set[int] = set()
    for start in range(corner.size):
        if fan.flat[start] >= 0:
            continue
        vertex = int(part.triangles.flat[start])
        name = vertex
        if vertex in seen:
            name = count + len(extra)
            extra.append(part.vertices[vertex])
        seen.add(vertex)
        for half in _fan_about(surface.face_neighbour, start):
            fan.flat[half] = name
    vertices = np.concatenate([part.vertices, np.reshape(extra, (-1, 3))])
    return Mesh(vertices, fan)


def _fan_about(neighbour: NDArray[np.int64], corner: int) -> list[int]:
    """Corners 3 f + k about one vertex that share edges, beginning with one of them."""
    found, left = [], [corner]
    while left:
        here = left.pop()
        if here in found:
            continue
        found.append(here)
        face, k = divmod(here, 3)
        # edge k leaves the vertex, edge k - 1 arrives there
        code = int(neighbour[face, k])
        if code >= 0:
            left.append(code - code % 3 + (code % 3 + 1) % 3)
        code = int(neighbour[face, (k + 2) % 3])
        if code >= 0:
            left.append(code)
    return found


@dataclass(frozen=True)
class WildDrape:
    """A mesh and how cloth is laid on it, all drawn from one number."""

    kind: str
    number: int
    mesh: Mesh = field(repr=False)
    spacing: tuple[float, float]
    seed: FloatArray
    direction: FloatArray
    initial_angle: float
    extent: tuple[float, float, float, float] | None

    @classmethod
    def drawn(cls, kind: str, number: int, most_nodes: int = 1500) -> WildDrape:
        """Spacing from a hundredth of a triangle to a hundred triangles, if the mould and `most_nodes` let it."""
        rng = np.random.default_rng([sorted(KINDS).index(kind), number])
        mesh = KINDS[kind](rng)
        turn = rotation(rng.standard_normal(3), rng.uniform(0, np.pi)) if rng.random() < 0.5 else np.eye(3)
        mesh = mesh.moved(turn, scale=10 ** rng.uniform(-2, 2))
        corners = mesh.vertices[mesh.triangles]
        edge = float(np.median(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)))
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        area = 0.5 * float(np.linalg.norm(np.cross(u, v), axis=1).sum())
        size = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
        spacing = float(np.clip(edge * 10 ** rng.uniform(-2, 2), 1e-3 * edge, 0.3 * size))
        ratio = 10 ** rng.uniform(-0.5, 0.5) if rng.random() < 0.2 else 1.0
        face = int(rng.integers(len(mesh.triangles)))
        weight = rng.dirichlet([1, 1, 1])
        where = rng.random()
        if where < 0.15:
            weight = np.eye(3)[rng.integers(3)]
        elif where < 0.3:
            weight[rng.integers(3)] = 0
            weight /= weight.sum()
        elif where < 0.4:
            weight = np.array([1 - 2e-9, 1e-9, 1e-9])[rng.permutation(3)]
        a, b, _ = corners[face]
        direction = rng.standard_normal(3) if rng.random() < 0.6 else (b - a)
        extent = None
        if area / spacing**2 > most_nodes or rng.random() < 0.2:
            reach = spacing * min(np.sqrt(most_nodes), 40) / 2
            extent = tuple(float(v) for v in reach * rng.uniform(0.3, 1.0, 4))
        angle = np.pi / 2 if rng.random() < 0.6 else float(rng.uniform(np.radians(25), np.radians(155)))
        return cls(kind, number, mesh, (spacing, spacing * ratio), weight @ corners[face], direction, angle, extent)

    def fabric(self) -> meshdrape.Fabric:
        return meshdrape.Fabric(self.spacing, initial_angle=self.initial_angle)

    def drape(self, **options: object) -> meshdrape.Net:
        return meshdrape.drape(
            self.mesh.mould(), self.fabric(), self.seed, self.direction, extent=self.extent, **options
        )
