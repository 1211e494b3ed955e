"""Full drapes of the report's moulds on meshes, read in the lattice numbers of the nets without a mesh.

Facets lie along the rulings of wing and spar, so the polyhedron is developable on both sides of the crease and differs
from the mould only by the chords of its profiles.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshdrape.mould import Mould
from meshdrape.theory import Fold, FoldNet, Profile, discrete_net
from meshdrape.theory.sheet import Gamma
from meshdrape.weave.drape import drape
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.measures.cells import Measures, measure
from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]

MM = 1000.0  # folds are in metres here


def ruled_mould(crease: FloatArray, wing: FloatArray, spar: FloatArray) -> Mould:
    """Two ruled strips that meet in a polyline.

    Parameters
    ----------
    crease : (n, 3) mm
    wing, spar : (3,) or (n, 3) mm
        From the crease to the other border of either; the side of spar x crease x wing is the one draped.
    """
    n = len(crease)
    vertices = np.concatenate([crease + spar, crease, crease + wing])
    k = np.arange(n - 1)
    quads = [(k + side * n, k + 1 + side * n, k + 1 + (side + 1) * n, k + (side + 1) * n) for side in (0, 1)]
    triangles = [np.stack(corners, axis=1) for a, b, c, d in quads for corners in ((a, c, b), (a, d, c))]
    return Mould.from_arrays(vertices, np.concatenate(triangles))


def fold_mould(fold: Fold, chord: float, height: float, facet: float, before: float = 0.5) -> Mould:
    """The wing as far as x = chord and the spar to its height, facets of a width; all in the fold's unit, metres.

    The first facet begins `before` of its width ahead of y = 0: by a half it is tangent to the crease there.
    """
    y = np.asarray((np.arange(int(np.ceil(fold.span / facet)) + 2) - before) * facet, dtype=np.float64)
    crease: FloatArray = MM * np.stack([_curving_on(fold.spar, y), y, _curving_on(fold.wing, y)], axis=1)
    wing = np.stack([MM * chord - crease[:, 0], 0 * y, 0 * y], axis=1)
    return ruled_mould(crease, wing, np.array([0.0, 0.0, -MM * height]))


def _curving_on(profile: Profile, y: FloatArray) -> FloatArray:
    """A profile that keeps its curvature ahead of y = 0, where it would otherwise go on straight."""
    start = np.zeros(())
    return np.asarray(profile(y) + np.where(y < 0, profile.bend(start) / 2 * y**2, 0.0))


@dataclass(frozen=True, eq=False)
class DrapedFold:
    """A drape over a fold beside the discrete net of the same sheet.

    Attributes
    ----------
    reference : FoldNet
        Without a mesh; tells which cell belongs to which region.
    net : Net
        The drape, mm.
    """

    reference: FoldNet
    net: Net

    @cached_property
    def measures(self) -> Measures:
        """Of the drape."""
        return measure(self.net)

    @cached_property
    def node(self) -> FloatArray:
        """Nodes of the drape where the reference has them, (n, rows, 3) m; NaN where there is none."""
        return window(self.net, self.net.node_position, self.reference.plane.shape) / MM

    @cached_property
    def shear(self) -> FloatArray:
        """Signed shear of the drape's cells, (n - 1, rows - 1) rad."""
        n, rows = self.reference.plane.shape
        return window(self.net, self.measures.cell_shear, (n - 1, rows - 1))

    def cells(self, region: int) -> NDArray[np.bool_]:
        """Cells of a region within the spar's height that the drape has, (n - 1, rows - 1)."""
        chosen = (self.reference.region == region) & self.reference.within
        return np.asarray(chosen & np.isfinite(self.shear))

    def max_shear(self, region: int) -> float:
        """Largest |shear| of the drape's cells of a region, rad; 0 of none."""
        values = np.abs(self.shear[self.cells(region)])
        return float(values.max()) if values.size else 0.0

    @cached_property
    def on_wing(self) -> FloatArray:
        """Shear of the drape's cells that lie on the wing with all corners, (k,) rad."""
        on = self.reference.sheet.on_spar
        whole = ~(on[:-1, :-1] | on[1:, :-1] | on[:-1, 1:] | on[1:, 1:])
        values = self.shear[whole]
        return values[np.isfinite(values)]

    @cached_property
    def astride(self) -> FloatArray:
        """Shear of the drape's cells that straddle the crease, (k,) rad."""
        values = self.shear[np.isnan(self.reference.shear)]
        return values[np.isfinite(values)]

    @property
    def node_error(self) -> float:
        """Largest distance between a node of the drape and its like, m, within the spar's height and the span."""
        on, y = self.reference.sheet.on_spar, self.reference.node[..., 1]
        inside = (
            (self.reference.depth <= self.reference.sheet.height) & (y >= 0) & (y <= self.reference.sheet.fold.span)
        )
        off = np.linalg.norm(self.node - self.reference.node, axis=-1)[inside & (on | np.isfinite(self.node[..., 0]))]
        return float(np.nanmax(off))

    @property
    def shear_error(self) -> float:
        """Largest difference of a cell's shear between drape and reference, rad, both regions."""
        cells = self.cells(1) | self.cells(2)
        return float(np.abs(self.shear - self.reference.shear)[cells].max())


def drape_fold(
    fold: Fold, spacing: float, height: float, facet: float, gamma: Gamma = 0.0, chord: float = 0.0
) -> DrapedFold:
    """Lay a sheet on the wing from its root and over the crease, as `discrete_net` does, on a mesh of the mould.

    Lengths in metres. The seed is the root's end of the row farthest from the crease; the left-most ribbon is turned
    where it comes over the crease, by gamma less what it turns of itself. The wing reaches to x = chord, or as far as
    that row if it is more.
    """
    reference = discrete_net(fold, spacing, height, gamma)
    sheet = reference.sheet
    x = float(sheet.x[0])
    turn = float(fold.psi(0.0)) - sheet.gamma  # right-handed about the spar's normal, -x: towards smaller y
    mould = fold_mould(fold, max(chord, x + 2.5 * spacing), height, facet)
    seed = MM * np.array([x, 0.0, float(fold.wing(0.0))])
    direction = np.array([0.0, 1.0, float(fold.wing.slope(0.0))])
    fabric = Fabric(MM * spacing)
    net = drape(mould, fabric, seed, direction, weft_turn=turn if abs(turn) > 1e-15 else None)
    return DrapedFold(reference, net)


def window(net: Net, values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Of an array by node or by cell, what lies from the seed on in both directions, padded by NaN to a shape.

    Parameters
    ----------
    net : Net
    values : (n_warp, n_weft, ...) or (n_warp - 1, n_weft - 1)
    shape : (n, m, ...)
    """
    i, j = net.seed_index
    part = values[i : i + shape[0], j : j + shape[1]]
    out = np.full((*shape[:2], *values.shape[2:]), np.nan)
    out[: part.shape[0], : part.shape[1]] = part
    return out
