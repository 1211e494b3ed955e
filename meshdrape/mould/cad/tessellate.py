"""CAD faces in, one welded triangle mesh out.

Open CASCADE's own mesher is not used: it leaves a straight edge of a twisted face undivided, so that facets
there are tens of degrees off, and takes minutes and hundreds of thousands of triangles for a cone. Here edges are
divided first, by angle and chord, once for all faces they bound; the outline of each face is cut into triangles
between those nodes; and only doubly curved faces are given nodes within.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from meshdrape.errors import MouldError
from meshdrape.mould.apart import step
from meshdrape.mould.cad.facets import Facets
from meshdrape.mould.cad.outline import Outline, Outlines
from meshdrape.mould.cad.patch import Floats, Ints, Nodes, Patch, Tolerances
from meshdrape.mould.cad.refine import refine, require_triangles
from meshdrape.mould.mesh.check import FARTHEST

if TYPE_CHECKING:
    from OCP.TopoDS import TopoDS_Face

# A well-shaped facet tilts from its face by six tenths of the turn from node to node.
MOST_TILT: Final = 1.2
# The estimate is low, by five times and more on the samples: at this share of the most triangles there may be, no try.
ESTIMATE: Final = 0.5
# An outline that crosses itself is divided more finely so often.
MOST_ATTEMPTS: Final = 6


@dataclass(frozen=True, eq=False)
class Tessellation:
    """Triangles on CAD faces.

    Attributes
    ----------
    vertices : (n, 3) float64, mm
    triangles : (m, 3) int64
        Counter-clockwise about the outward normal of their face.
    triangle_face : (m,) int64
        Id of the face each lies on.
    """

    vertices: Floats
    triangles: Ints
    triangle_face: Ints


def tessellate(faces: Sequence[TopoDS_Face], ids: Sequence[int], tolerances: Tolerances) -> Tessellation:
    """Return triangles on the faces, which share their nodes where the faces share edges.

    Parameters
    ----------
    faces : sequence of TopoDS_Face
    ids : sequence of int
        Of each face.
    tolerances : Tolerances

    Raises
    ------
    MouldError
        The outline of a face crosses itself, or the tolerances ask for too many triangles.
    """
    patches = []
    for index, (face, number) in enumerate(zip(faces, ids, strict=True)):
        step()
        patch = Patch(face, index, tolerances)
        patches.append(patch)
        # of a face without an outline only the parameters end
        if not patch.extent <= FARTHEST:
            msg = f"face {number} goes on for more than {FARTHEST:g} mm: its outline is missing; mend it in CAD"
            raise MouldError(msg)
    require_triangles(sum(patch.fewest_triangles(tolerances.chord) for patch in patches) / ESTIMATE)
    outlines = Outlines(patches, tolerances)
    rings, cuts = _cut(patches, outlines, ids)
    start = np.cumsum([0] + [len(ring.number) for ring in rings])
    facets = Facets(
        Nodes.joined([ring.nodes for ring in rings]),
        np.concatenate([cut + first for cut, first in zip(cuts, start[:-1], strict=True)]),
        MOST_TILT * np.array([patch.angle for patch in patches]),
    )
    facets.make_delaunay()

    def evaluate(face: Ints, uv: Floats) -> Nodes:
        step()
        order = np.argsort(face, kind="stable")
        indices, first = np.unique(face[order], return_index=True)
        parts = np.split(order, first[1:])
        found = Nodes.joined([patches[index].nodes(uv[part]) for index, part in zip(indices, parts, strict=True)])
        back = np.empty_like(order)
        back[order] = np.arange(len(order))
        return found[back]

    refine(facets, tolerances, np.array([patch.developable for patch in patches]), evaluate, ids)
    vertices, triangles, face = _assembled(
        facets, patches, outlines.position, np.concatenate([r.number for r in rings])
    )
    return Tessellation(vertices, triangles, np.asarray(ids, dtype=np.int64)[face])


def _cut(patches: list[Patch], outlines: Outlines, ids: Sequence[int]) -> tuple[list[Outline], list[Ints]]:
    """The outline of each face and the triangles it is cut into."""
    for _ in range(MOST_ATTEMPTS):
        rings, cuts = [], []
        for patch in patches:
            step()
            rings.append(outlines.outline(patch.index))
            cuts.append(rings[-1].triangles())
        crossed = [index for index, cut in enumerate(cuts) if cut is None]
        if not crossed:
            return rings, [cut for cut in cuts if cut is not None]
        for index in crossed:
            outlines.halve(index)
    msg = f"the outline of face {ids[crossed[0]]} crosses itself; mend the face in CAD, or leave it out with --faces"
    raise MouldError(msg)


def _assembled(facets: Facets, patches: list[Patch], position: Floats, number: Ints) -> tuple[Floats, Ints, Ints]:
    """The facets, nodes of common edges and seams made one, and the index of the face each lies on.

    What shrank to a line at a pole is left out.
    """
    nodes = facets.nodes
    within = np.arange(len(number), len(nodes))
    number = np.concatenate([number, len(position) + np.arange(len(within))])
    triangles, face = number[facets.triangles], nodes.face[facets.triangles[:, 0]]
    backwards = np.array([patch.reversed for patch in patches])[face]
    triangles[backwards] = triangles[backwards][:, ::-1]
    a, b, c = triangles.T
    whole = (a != b) & (b != c) & (c != a)
    return np.vstack([position, nodes.position[within]]), triangles[whole], face[whole]
