"""A net as it was draped, made again from the places of its nodes alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.nearest import nearest_faces
from meshdrape.kernels.aim import aim_edges
from meshdrape.kernels.tables import Lattice
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.collar import extended
from meshdrape.weave.lay.slits import SLIT
from meshdrape.weave.net import Net, run_kernel
from meshdrape.weave.start.generators import free_memory, lay_generators, start_fibres
from meshdrape.weave.start.prescribed import StartFibres, courses_on
from meshdrape.weave.start.seed import part_under
from meshdrape.weave.status import NodeStatus

if TYPE_CHECKING:
    from typing import Protocol

    from meshdrape.mould import Mould

    class StoredNodes(Protocol):
        """What a net's file says of its nodes and of where it was begun."""

        @property
        def fabric(self) -> Fabric:
            """The fabric."""

        @property
        def seed(self) -> FloatArray:
            """(3,) mm, on the mould."""

        @property
        def direction(self) -> FloatArray:
            """(3,) unit warp direction at the seed."""

        @property
        def seed_index(self) -> tuple[int, int]:
            """(i, j) of the seed node."""

        @property
        def node_position(self) -> FloatArray:
            """(n_warp, n_weft, 3) mm, NaN where there is no node."""

        @property
        def node_status(self) -> NDArray[np.uint8]:
            """(n_warp, n_weft) NodeStatus."""

        @property
        def start_fibres(self) -> StartFibres:
            """What was prescribed of the start fibres."""

        @property
        def generator_nodes(self) -> list[int]:
            """Nodes on +warp, +weft, -warp, -weft."""

        @property
        def collar_depth(self) -> float:
            """Depth of the extension past the border, mm."""


FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A straight path of one spacing that ends this near to the node, in spacings, is the edge.
STRAIGHT = 1e-9
# Paths on both sides of a vertex may end that near; the edge itself is the one that ends within round-off, which grows
# with the distance from the origin.
ROUND_OFF = 1e-12


@dataclass(frozen=True, eq=False)
class Rebuilt:
    """A net made again, and how far what was stored lies from it.

    Attributes
    ----------
    net : Net
    off_surface : (n_warp, n_weft) mm
        Distance of each node from the mould, of the OFF_MOULD ones from its extension; NaN where there is no node.
    off_generator : (n_warp, n_weft) mm
        Distance of the generators' nodes from the straightest path traced anew; NaN elsewhere.
    edge_gap : (2, n_warp, n_weft) mm
        By family (warp, weft), how far from its node the straight path of one spacing along each edge ends; NaN where
        there is no edge and on the generators.
    """

    net: Net
    off_surface: FloatArray
    off_generator: FloatArray
    edge_gap: FloatArray


def rebuild(mould: Mould, stored: StoredNodes, threads: int = 1) -> Rebuilt:
    """Put stored nodes on a mould, trace the generators anew, and aim every other edge from node to node.

    Raises
    ------
    StartError
        If the stored direction is none.
    """
    fabric, (i0, j0) = stored.fabric, stored.seed_index
    n_warp, n_weft = stored.node_status.shape
    whole = mould.surface
    nearest, distance = whole.closest_point(stored.seed)
    part, part_face, point = part_under(whole, nearest, stored.seed)
    given = stored.start_fibres
    courses, drawn_point = courses_on(mould, part, part_face, fabric, given, stored.seed, stored.direction)
    point = drawn_point or point
    surface = extended(part, stored.collar_depth, SLIT * fabric.longest)
    counts = [n_warp - 1 - i0, n_weft - 1 - j0, i0, j0]
    room = (
        i0 * fabric.warp_spacing,
        counts[0] * fabric.warp_spacing,
        j0 * fabric.weft_spacing,
        counts[1] * fabric.weft_spacing,
    )
    memory = free_memory()
    star, halves = start_fibres(surface, fabric, point, stored.direction, counts, memory, courses)
    lattice, start = lay_generators(surface, fabric, star, halves, counts, memory, room)
    # cloth on an arm beyond may have taken a generator's numbers past its end
    start = start._replace(n_nodes=np.minimum(start.n_nodes, stored.generator_nodes))
    off_surface = np.full((n_warp, n_weft), np.nan)
    off_generator = np.full((n_warp, n_weft), np.nan)
    _place(surface, len(part.faces), stored, lattice, off_surface)
    _compare_generators(surface, stored, lattice, (i0, j0), off_generator)
    lattice.status[:] = stored.node_status
    net = Net(
        mould=mould,
        fabric=fabric,
        surface=surface,
        surface_face=part_face,
        lattice=lattice,
        start=start,
        seed=np.asarray(stored.seed),
        seed_distance=distance,
        direction=np.asarray(stored.direction),
        collar_depth=stored.collar_depth,
        start_fibres=given,
        threads=threads,
    )
    edge_gap = np.full((2, n_warp, n_weft), np.nan)
    mesh = surface.unfolding
    kernel: Callable[..., Any] = aim_edges
    enough = ROUND_OFF * fabric.shortest + 1e-15 * float(np.abs(surface.vertices).max())
    run_kernel(
        kernel,
        [
            (mesh, lattice, start, a, b, fabric.warp_spacing, fabric.weft_spacing,
             enough, edge_gap)
            for a, b in net.row_blocks(0, n_warp)
        ],
        threads,
    )  # fmt: skip
    return Rebuilt(net, off_surface, off_generator, edge_gap)


def _place(
    surface: Surface, n_mould_faces: int, stored: StoredNodes, lattice: Lattice, off_surface: FloatArray
) -> None:
    """Give every node that was not traced its face and its place there."""
    i0, j0 = (int(v) for v in stored.seed_index)
    frame = surface.unfolding.frame
    for status, first, faces in (
        (NodeStatus.PLACED, 0, surface.faces[:n_mould_faces]),
        (NodeStatus.OFF_MOULD, n_mould_faces, surface.faces[n_mould_faces:]),
    ):
        i, j = np.nonzero(stored.node_status == status)
        position = stored.node_position[i, j]
        face, distance = nearest_faces(surface.vertices, faces, position)
        off_surface[i, j] = distance
        # a generator's node that was traced keeps its place, to which its directions belong
        other = ((i != i0) & (j != j0)) | (lattice.status[i, j] > NodeStatus.OFF_MOULD)
        i, j, position, face = i[other], j[other], position[other], face[other] + first
        away = position - frame[face, :3]
        lattice.face[i, j] = face
        lattice.xy[i, j, 0] = np.einsum("ij,ij->i", away, frame[face, 3:6])
        lattice.xy[i, j, 1] = np.einsum("ij,ij->i", away, frame[face, 6:9])


def _compare_generators(
    surface: Surface, stored: StoredNodes, lattice: Lattice, origin: tuple[int, int], off_generator: FloatArray
) -> None:
    """How far the stored nodes of the generators lie from those just traced; infinite where there is none."""
    frame = surface.unfolding.frame
    i0, j0 = origin
    n_warp, n_weft = stored.node_status.shape
    for i, j in (
        (np.arange(n_warp), np.full(n_warp, j0)),
        (np.full(n_weft, i0), np.arange(n_weft)),
    ):
        there = stored.node_status[i, j] <= NodeStatus.OFF_MOULD
        i, j = i[there], j[there]
        traced = lattice.status[i, j] <= NodeStatus.OFF_MOULD
        face = frame[np.where(traced, lattice.face[i, j], 0)]
        xy = lattice.xy[i, j]
        found = face[:, :3] + xy[:, :1] * face[:, 3:6] + xy[:, 1:] * face[:, 6:9]
        off = np.linalg.norm(found - stored.node_position[i, j], axis=1)
        off_generator[i, j] = np.where(traced, off, np.inf)
