"""The arrays a kernel walks on, and the arrays it writes a net into."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

# Beyond all tangents, so that a number above it means a radius; a radius is then good to 1e-7 mm.
KEPT_OUT = 1e9


class Unfolding(NamedTuple):
    """A triangle mesh as planes that can be unfolded one into the next.

    Each face carries a frame of its own: corner 0 is the origin, corner 1 lies on the positive x axis,
    corner 2 has y > 0. Edge k runs from corner k to corner k + 1 (mod 3).

    Invariants (kept by :class:`meshdrape.surface.Surface`): manifold, consistently oriented, no zero area.
    """

    plane: FloatArray
    """(m, 24) what a walk reads, a cache line an edge: for edge k, from 8 k on, its unit inward normal, its tail, and
    its `crossing`."""
    line: FloatArray
    """(m, 9) three edges as (nx, ny, o): unit inward normal and offset; nx x + ny y - o is the height above it."""
    crossing: FloatArray
    """(m, 12) per edge (c, s, tx, ty): (x, y) of this face is (c x - s y + tx, s x + c y + ty) over the edge."""
    neighbour: NDArray[np.int32]
    """(m, 3) 3 g + l: edge l of face g lies on the other side; -1 at a border."""
    corner: FloatArray
    """(m, 3) x of corner 1; x and y of corner 2."""
    frame: FloatArray
    """(m, 9) corner 0, x axis, y axis in space."""
    vertex: NDArray[np.int32]
    """(m, 3) corners of each face."""
    vertex_angle: FloatArray
    """(n,) sum of the face angles at each vertex, rad; 0 where the vertex lies on the border."""
    rim: NDArray[np.int8]
    """(m,) -1 on the mould; else bits of what the face shares with it: edges 0 to 2, then corners 0 to 2."""


class Detours(NamedTuple):
    """Where straight paths may have a shorter way round: a table of its own, for few loops ask."""

    corner: FloatArray
    """(m, 3) of the vertex at each corner: 0 where it offers no shorter way; else the tangent of half its angle defect,
    with a margin; or KEPT_OUT and the radius, mm, within which a path may have a shorter way round it and others.
    (0, 3) where no path on the surface has a shorter way."""
    wary: NDArray[np.bool_]
    """(m,) whether even a path within the face may have a shorter way."""
    beside: NDArray[np.float32]
    """(m, 6) what a path passes that comes in over edge k: at 2 k the `corner` across from it, infinite where that is a
    radius or negative; at 2 k + 1 the angle, rad, by which the surface turns at that edge."""
    normal: FloatArray
    """(m, 3) unit normals; (0, 3) likewise."""


class Lattice(NamedTuple):
    """The nodes of a net and the edges between them, as a sweep fills them.

    A warp edge (i, j)-(i + 1, j) is kept at [i, j], a weft edge (i, j)-(i, j + 1) likewise. An edge is known by the
    direction in which it leaves its tail, the end nearer to the seed, in the frame of the tail's face.
    """

    face: NDArray[np.int32]
    """(n_warp, n_weft) face that holds the node."""
    xy: FloatArray
    """(n_warp, n_weft, 2) place in the frame of that face, mm."""
    warp_out: FloatArray
    """(n_warp, n_weft, 2) unit direction of each warp edge at its tail."""
    weft_out: FloatArray
    """(n_warp, n_weft, 2) unit direction of each weft edge at its tail."""
    status: NDArray[np.uint8]
    """(n_warp, n_weft) NodeStatus."""


class Start(NamedTuple):
    """Where the four half-fibres leave the seed: +warp, +weft, -warp, -weft.

    A seed on an edge or a vertex belongs to several faces, so each half-fibre keeps its own.
    """

    origin: NDArray[np.int64]
    """(2,) lattice index of the seed."""
    face: NDArray[np.int32]
    """(4,) face each half-fibre enters."""
    xy: FloatArray
    """(4, 2) the seed in the frame of that face."""
    out: FloatArray
    """(4, 2) unit direction in that frame."""
    sector: FloatArray
    """(4,) angle from each half-fibre to the next, counter-clockwise, rad."""
    n_nodes: NDArray[np.int64]
    """(4,) nodes on each half-fibre."""
    tangent: FloatArray
    """(2, 2) unit directions of warp and weft at the seed, in the frame of the face that holds it."""
    arrival: FloatArray
    """(4, n, 2) direction in which each half-fibre reaches its first, second ... node, in that node's frame."""
    through: NDArray[np.bool_]
    """(4, n) whether a half-fibre runs through a vertex on its first, second ... edge."""
    arc: NDArray[np.bool_]
    """(4, n) whether its first, second ... edge bends, so that its ends lie nearer than one spacing."""
    bent_key: NDArray[np.int64]
    """(k,) keys, ascending, of the edges that bend at a saddle vertex: no straight walk reaches their heads."""
    bent_ends: FloatArray
    """(k, 4) their directions at the tail and at the head, in the frames of the nodes' faces."""
