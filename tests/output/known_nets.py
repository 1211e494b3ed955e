"""Small nets that are known without draping, with the attributes of the real ones."""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from moulds import grid_triangles
from numpy.typing import NDArray

from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.start.prescribed import StartFibres
from meshdrape.weave.status import NodeStatus


@dataclass(frozen=True, eq=False)
class KnownMould:
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    source: Path | None = None
    sha256: str | None = None
    unit: str = "mm"
    cad_faces: tuple = ()
    chord_tolerance: float | None = None
    angle_tolerance: float | None = None
    parameters: tuple = ()
    healing: object = None
    turned: bool = False

    @cached_property
    def surface(self) -> Surface:
        return Surface.from_arrays(self.vertices, self.triangles)


DRAWN = StartFibres(warp_turn=0.1, weft_path=np.array([[0, 1, 2], [0.1, 1 / 3, 2e-17]]))


@dataclass(frozen=True, eq=False)
class KnownNet:
    mould: KnownMould
    fabric: Fabric
    seed: NDArray[np.float64]
    direction: NDArray[np.float64]
    seed_index: tuple[int, int]
    node_position: NDArray[np.float64]
    node_status: NDArray[np.uint8]
    start_fibres: StartFibres = DRAWN
    generator_nodes: list[int] = field(default_factory=lambda: [3, 2, 1, 0])
    collar_depth: float = 12.5
    warp_direction: NDArray[np.float64] = field(init=False)
    weft_direction: NDArray[np.float64] = field(init=False)

    def __post_init__(self):
        for axis, name in enumerate(("warp_direction", "weft_direction")):
            along = np.gradient(self.node_position, axis=axis)
            object.__setattr__(self, name, along / np.linalg.norm(along, axis=2, keepdims=True))

    def positions(self, i0, i1):
        assert 0 <= i0 < i1 <= len(self.node_position)
        return self.node_position[i0:i1]

    def directions(self, i0, i1):
        assert 0 <= i0 < i1 <= len(self.node_position)
        return self.warp_direction[i0:i1], self.weft_direction[i0:i1]


@dataclass(frozen=True, eq=False)
class KnownMeasures:
    cell_shear: NDArray[np.float64]
    cell_touches_mould: NDArray[np.bool_]
    shear_of_nodes: NDArray[np.float64]
    max_shear: float
    max_shear_cell: tuple[int, int]
    max_shear_position: NDArray[np.float64]
    max_shear_face: int
    over_locking_fraction: float

    def node_shear(self, first, last):
        return self.shear_of_nodes[first:last]


def measured(net):
    """Shear from the chords at the four corners of each cell."""
    p = net.node_position
    warp, weft = p[1:] - p[:-1], p[:, 1:] - p[:, :-1]
    corners = [
        (warp[:, :-1], weft[:-1]),
        (warp[:, 1:], weft[1:]),
        (warp[:, :-1], weft[1:]),
        (warp[:, 1:], weft[:-1]),
    ]
    angle = [
        np.arccos(
            np.clip(np.einsum("ijk,ijk->ij", a, b) / np.linalg.norm(a, axis=2) / np.linalg.norm(b, axis=2), -1, 1)
        )
        for a, b in corners
    ]
    cell_shear = net.fabric.initial_angle - np.mean(angle, axis=0)
    around = np.full((4, *p.shape[:2]), np.nan)
    for k, (rows, columns) in enumerate(
        [(np.s_[:-1], np.s_[:-1]), (np.s_[1:], np.s_[:-1]), (np.s_[:-1], np.s_[1:]), (np.s_[1:], np.s_[1:])]
    ):
        around[k, rows, columns] = cell_shear
    known = ~np.isnan(around)
    n_known = known.sum(axis=0)
    node_shear = np.where(n_known > 0, np.nansum(around, axis=0) / np.maximum(n_known, 1), np.nan)
    i, j = np.unravel_index(np.nanargmax(np.abs(cell_shear)), cell_shear.shape)
    magnitude = np.abs(cell_shear[~np.isnan(cell_shear)])
    return KnownMeasures(
        cell_shear=cell_shear,
        cell_touches_mould=~np.isnan(cell_shear),
        shear_of_nodes=node_shear,
        max_shear=float(magnitude.max()),
        max_shear_cell=(int(i), int(j)),
        max_shear_position=p[i : i + 2, j : j + 2].mean(axis=(0, 1)),
        max_shear_face=0,
        over_locking_fraction=float((magnitude > net.fabric.locking_angle).mean()),
    )


def flat_net(n_warp=30, n_weft=20, spacing=(2.0, 3.0), shear_deg=5.0, hole=True):
    """A flat sheet sheared evenly; `hole` leaves out some nodes, with a status for each reason."""
    fabric = Fabric(spacing, locking_angle=np.radians(7))
    sigma = np.pi / 2 - np.radians(shear_deg)
    i, j = np.meshgrid(np.arange(n_warp), np.arange(n_weft), indexing="ij")
    u, v = i * fabric.warp_spacing, j * fabric.weft_spacing
    position = np.stack([0.1 + u + v * np.cos(sigma), 1 / 3 + v * np.sin(sigma), np.full_like(u, 7.0)], axis=2)
    status = np.zeros((n_warp, n_weft), dtype=np.uint8)
    status[:, -1] = NodeStatus.OFF_MOULD
    if hole:
        status[0, :3] = NodeStatus.OUTSIDE
        status[10:13, 5:8] = NodeStatus.FOLDED
        status[10, 5] = NodeStatus.NOT_CONVERGED
        status[-1, -2:] = NodeStatus.NOT_REACHED
        position[status > NodeStatus.OFF_MOULD] = np.nan
    size = 1.2 * np.array([n_warp * fabric.warp_spacing, n_weft * fabric.weft_spacing])
    corners = np.array([[-5, -5, 7], [size[0], -5, 7], [size[0], size[1], 7], [-5, size[1], 7]], dtype=float)
    mould = KnownMould(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    seed_index = (n_warp // 2, n_weft // 2)
    return KnownNet(mould, fabric, position[seed_index], np.array([1.0, 0, 0]), seed_index, position, status)


def sphere_net(half=24, spacing=40.0, radius=1000.0):
    """The net on a sphere from two great circles, exact: each node at two chords from its parents."""
    chord = 2 * radius * np.sin(spacing / (2 * radius))
    n = 2 * half + 1
    position = np.full((n, n, 3), np.nan)
    angle = spacing / radius * np.arange(-half, half + 1)
    position[:, half] = radius * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    position[half] = radius * np.stack([0 * angle, np.sin(angle), np.cos(angle)], axis=1)
    product = radius**2 - 0.5 * chord**2  # of a node and each of its parents
    for si in (1, -1):
        for sj in (1, -1):
            for i in range(1, half + 1):
                for j in range(1, half + 1):
                    a = position[half + si * (i - 1), half + sj * j]
                    b = position[half + si * i, half + sj * (j - 1)]
                    along = product / (radius**2 + a @ b) * (a + b)
                    across = np.cross(a, b)
                    across *= np.sqrt(max(radius**2 - along @ along, 0.0) / (across @ across))
                    away = along - position[half + si * (i - 1), half + sj * (j - 1)]
                    position[half + si * i, half + sj * j] = along + np.sign(across @ away) * across
    theta, phi = np.meshgrid(np.linspace(0.0, 1.5, 40), np.linspace(0, 2 * np.pi, 121), indexing="ij")
    dome = radius * np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=2)
    merged = np.concatenate([dome[:1, 0], dome[1:, :-1].reshape(-1, 3)])
    index = np.concatenate(
        [np.zeros((1, 121), dtype=int), 1 + np.tile(np.r_[0:120, 0], (39, 1)) + 120 * np.arange(39)[:, None]]
    )
    triangles = index.ravel()[grid_triangles(39, 120)]
    triangles = triangles[
        (triangles[:, 0] != triangles[:, 1])
        & (triangles[:, 1] != triangles[:, 2])
        & (triangles[:, 2] != triangles[:, 0])
    ]
    mould = KnownMould(merged, triangles)
    status = np.zeros((n, n), dtype=np.uint8)
    fabric = Fabric(spacing, locking_angle=np.radians(30))
    return KnownNet(mould, fabric, np.array([0, 0, radius]), np.array([1.0, 0, 0]), (half, half), position, status)


def wing_net(spacing=50.0, span=14000.0, chord=3000.0, height=1000.0):
    """A sheet over a curved wing cover and down a spar, 14 : 3 : 1, its columns turned at the edge."""
    y = np.arange(0.0, span, spacing)
    across = np.arange(-height + spacing / 2, chord, spacing)[::-1]  # so that the normal points out
    Y, S = np.meshgrid(y, across, indexing="ij")
    on_spar = S < 0
    turn = np.radians(11.0) * (1 - np.cos(2.0 * np.pi * Y / span)) / 2
    along = Y + np.where(on_spar, S * np.tan(turn), 0.0)
    drop = 1e-5 * along**2
    position = np.stack([np.where(on_spar, 0.0, S), along, np.where(on_spar, S, 0.0) - drop], axis=2)
    y = np.linspace(0.0, span, 60)
    z = -1e-5 * y**2
    profile = [np.stack([x + 0 * y, y, z + dz], axis=1) for x, dz in ((0.0, -height), (0.0, 0.0), (chord, 0.0))]
    mould = KnownMould(np.stack(profile[::-1], axis=1).reshape(-1, 3), grid_triangles(59, 2))
    status = np.zeros(position.shape[:2], dtype=np.uint8)
    fabric = Fabric(spacing, locking_angle=np.radians(7))
    seed_index = (len(position) // 2, int(np.argmin(np.abs(across - 500.0))))
    return KnownNet(mould, fabric, position[seed_index], np.array([0.0, 1, 0]), seed_index, position, status)


@dataclass(frozen=True, eq=False)
class KnownField:
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    warp_angle: NDArray[np.float64]
    weft_angle: NDArray[np.float64]
    shear: NDArray[np.float64]
    covered: NDArray[np.bool_]
    reference: NDArray[np.float64]
