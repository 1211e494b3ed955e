"""The net read off on the mould's own triangles: fibre angles, shear, coverage."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshdrape.errors import StartError
from meshdrape.kernels import locate
from meshdrape.weave.measures.cells import Measures
from meshdrape.weave.measures.subdivide import subdivided
from meshdrape.weave.net import run_kernel

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

# A reference axis this near to the normal, rad, is none: the second one takes its place.
ALONG_NORMAL = np.radians(5.0)


@dataclass(frozen=True, eq=False)
class MouldField:
    """What lies on each triangle of the mould, refined where it is coarser than the net.

    Attributes
    ----------
    vertices : (n, 3) mm
    triangles : (m, 3) int64
    parent : (m,) int64
        Triangle of the mould each one is part of.
    area : (m,) mm2
    covered : (m,) bool
        Whether a whole cell lies on the triangle's centre.
    warp_angle, weft_angle : (m,) rad in (-pi/2, pi/2]
        Fibre angle from the projected reference axis, right-handed about the triangle's normal. NaN where not covered.
    shear : (m,) rad, signed; NaN where not covered
    reference : (3,)
        The axis asked for.
    """

    vertices: FloatArray
    triangles: IntArray
    parent: IntArray
    area: FloatArray
    covered: NDArray[np.bool_]
    warp_angle: FloatArray
    weft_angle: FloatArray
    shear: FloatArray
    reference: FloatArray

    @property
    def coverage_fraction(self) -> float:
        """Share of the mould's area under cloth, 0 to 1."""
        return float(self.area[self.covered].sum() / self.area.sum())


def read_off(measures: Measures, reference: ArrayLike = (1.0, 0.0, 0.0), most_triangles: int = 500_000) -> MouldField:
    """Fibre angles, shear and coverage on the triangles of the mould.

    Parameters
    ----------
    measures : Measures
    reference : (3,) float
        Axis whose projection is angle zero. Where it is within 5 degrees of the normal, global y serves, or x if the
        axis is y.
    most_triangles : int
        Bound on the refinement.

    Raises
    ------
    StartError
        If the reference is zero or not finite.
    """
    net = measures.net
    axis = np.asarray(reference, dtype=np.float64)
    if axis.shape != (3,) or not np.isfinite(axis).all() or not axis.any():
        msg = f"reference axis {axis.tolist()} is no direction: give three numbers that are not all zero"
        raise StartError(msg)
    axis = axis / np.abs(axis).max()  # so that no square is beyond all numbers
    axis = axis / np.linalg.norm(axis)
    mould, mesh, fabric = net.mould, net.surface.unfolding, net.fabric
    total = mould.surface.area
    # triangles of the net's own size, unless that is too many: halving leaves about two in three of this area
    longest = max(1.5 * fabric.longest, float(np.sqrt(6.0 * total / most_triangles)))
    vertices, triangles, parent = subdivided(mould.vertices, mould.triangles, longest, most_triangles)
    order = np.argsort(parent, kind="stable")
    triangles, parent = triangles[order], parent[order]
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    normal = mould.surface.face_normal[parent]

    face = np.full(len(mould.triangles), -1)
    face[net.surface_face] = np.arange(len(net.surface_face))
    draped = np.flatnonzero(face[parent] >= 0)
    n = len(draped)
    cell, share = np.full((n, 2), -1), np.empty((n, 2))
    warp, weft = np.empty((n, 3)), np.empty((n, 3))
    first = np.empty((len(net.surface_face), 2), dtype=np.int64)
    locate.first_nodes(mesh, net.lattice, first)
    at, centre, up = face[parent[draped]], ((a + b + c) / 3)[draped], normal[draped]
    # a net with fewer nodes than points gives its tangents once, a larger one only where they are asked for
    few = net.shape[0] * net.shape[1] <= 2 * n
    tangent = np.stack(net.directions(0, net.shape[0])) if few else np.empty((2, 0, 0, 3))
    spacings = (fabric.warp_spacing, fabric.weft_spacing)
    # blocks of a fixed size: where one begins a search starts anew, which must not depend on the threads
    step = 8192
    blocks = [slice(k, k + step) for k in range(0, n, step)]
    run_kernel(
        locate.climb_to_cells,
        [(mesh, net.lattice, *spacings, at[k], centre[k], up[k], first, cell[k], share[k]) for k in blocks],
        net.threads,
    )
    missed = np.flatnonzero((cell[:, 0] < 0) & (first[at, 0] >= 0))
    if len(missed):
        locate.search_cells(mesh, net.lattice, *spacings, at, centre, up, missed, cell, share)
    run_kernel(
        locate.fibres_on_cells,
        [
            (mesh, net.lattice, net.start, *spacings, tangent, up[k], cell[k], share[k], warp[k], weft[k])
            for k in blocks
        ],
        net.threads,
    )
    on = cell[:, 0] >= 0
    covered = np.zeros(len(triangles), dtype=np.bool_)
    covered[draped] = on
    values = np.full((3, len(triangles)), np.nan)
    kept = draped[on]
    zero = _projected(axis, normal[kept])
    values[0, kept] = _angle_about(zero, warp[on], normal[kept])
    values[1, kept] = _angle_about(zero, weft[on], normal[kept])
    values[2, kept] = measures.cell_shear[cell[on, 0], cell[on, 1]]
    return MouldField(vertices, triangles, parent, area, covered, values[0], values[1], values[2], axis)


def _projected(axis: FloatArray, normal: FloatArray) -> FloatArray:
    """The reference axis in each plane, unit, (n, 3)."""
    second = np.array([1.0, 0.0, 0.0]) if abs(axis[1]) > 0.9 else np.array([0.0, 1.0, 0.0])
    standing = np.abs(normal @ axis) > np.cos(ALONG_NORMAL)
    chosen = np.where(standing[:, None], second, axis)
    flat = chosen - np.einsum("ij,ij->i", chosen, normal)[:, None] * normal
    return np.asarray(flat / np.linalg.norm(flat, axis=1)[:, None])


def _angle_about(zero: FloatArray, direction: FloatArray, normal: FloatArray) -> FloatArray:
    """Angle from `zero` to `direction` about the normal, in (-pi/2, pi/2]: a fibre has no sense."""
    angle = np.arctan2(np.einsum("ij,ij->i", np.cross(zero, direction), normal), np.einsum("ij,ij->i", zero, direction))
    return np.asarray(np.pi / 2 - np.mod(np.pi / 2 - angle, np.pi))
