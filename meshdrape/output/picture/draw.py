"""The picture of a drape: the net on the mould in colours of shear, with all a reader needs to judge it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from meshdrape.output.colour import NO_CLOTH, WARP, WEFT, shear_colour
from meshdrape.output.files import atomic_write
from meshdrape.output.picture.camera import View, fitted, view_axes
from meshdrape.output.picture.legend import INK, add_axes, add_colour_scale, add_keys, add_scale_bar, add_title
from meshdrape.output.picture.scene import DrawnCells, drawn_cells, drawn_fibres
from meshdrape.output.picture.stage import Colour, Stage

if TYPE_CHECKING:
    from meshdrape.mould import Mould
    from meshdrape.weave.measures.cells import Measures
    from meshdrape.weave.net import Net

FloatArray = NDArray[np.float64]

_WIDTH: Final = 2000  # pixels, as all below
_MARGIN: Final = 70
_HEADER: Final = 190
_FOOTER: Final = 210
_HEIGHTS: Final = (480.0, 1060.0)  # of the drawing
_BLEED: Final = 10  # of the drawing into header and footer
_FIBRE_GAP: Final = 24.0
_ARROW: Final = 120.0
_LABEL_ROOM: Final = 300.0
_OUTLINE: Final = (84, 88, 96)
_SEAM: Final = (140, 144, 150)
_WHITE: Final = (255, 255, 255)
_CREASE: Final = np.cos(np.radians(30.0))  # a sharper edge of the mould is drawn, and shaded as one


def draw_net(net: Net, measures: Measures, path: str | os.PathLike[str]) -> None:
    """Draw a net on its mould in 3D, as PNG 2000 pixels wide; no screen is needed.

    Cells have the colour of their shear on a scale anchored at the locking angle. Some fibres of both
    families are drawn, the seed with the two directions, the place of the largest shear, a legend and a scale
    bar. The view is chosen from the shape; it is a parallel projection, so the scale bar holds everywhere. Of
    more than 300,000 cells whole blocks are drawn, each in the colour of its largest shear.

    Parameters
    ----------
    net : Net
    measures : Measures
        Of this net.
    path : path-like

    Raises
    ------
    FileError
        The file cannot be written.
    MissingLibraryError
        The machine has no OpenGL that works without a screen.
    """
    cells = drawn_cells(net, measures)
    view, height = _view(net.mould, cells)
    stage = Stage(_WIDTH, height, view)
    # mm by which lines clear the faces they lie on, and cells the curved mould they are chords of
    lift = max(0.02 * _quad_size(net, cells), 2.0 * view.mm_per_pixel)
    clearance = lift + 0.75 * _quad_size(net, cells)
    _add_mould(stage, net.mould, clearance)
    colours = shear_colour(cells.shear, net.fabric.locking_angle)
    stage.add_faces(cells.corners, cells.normals, colours, back=lift, cull=True)
    warp, weft, step = drawn_fibres(net, _FIBRE_GAP * view.mm_per_pixel, cells.block)
    stage.add_segments(weft, WEFT, 2.0)
    stage.add_segments(warp, WARP, 2.0)
    # a mould larger than its cloth may reach into header and footer
    for bottom, top in ((0, _FOOTER - _BLEED), (height - _HEADER + _BLEED, height)):
        stage.add_polygon([(0, bottom), (_WIDTH, bottom), (_WIDTH, top), (0, top)], _WHITE)
    _mark_seed(stage, net, view)
    _mark_largest_shear(stage, net, measures, view, clearance)
    add_title(stage, net, measures, _MARGIN, height - 30)
    add_colour_scale(stage, net.fabric.locking_angle)
    add_keys(stage, step)
    add_axes(stage, view)
    add_scale_bar(stage, view)
    with atomic_write(path) as file:
        file.write(stage.png())


def _view(mould: Mould, cells: DrawnCells) -> tuple[View, int]:
    """Return the view of a mould and its cloth, and the height of the picture."""
    surface = mould.surface
    if len(cells.corners):
        normals, areas = cells.normals, cells.areas
    else:
        normals, areas = surface.face_normal, surface.face_area
    cloth = cells.corners.reshape(-1, 3) if len(cells.corners) else surface.vertices
    axes = view_axes(normals, areas, cloth)
    frame = ((_MARGIN, _FOOTER), _WIDTH - 2 * _MARGIN, _HEIGHTS)
    view, drawing = fitted(axes, cloth, surface.vertices, *frame)
    return view, round(_FOOTER + drawing + _HEADER)


def _quad_size(net: Net, cells: DrawnCells) -> float:
    """Return the longest side of the drawn quads, mm."""
    return cells.block * net.fabric.longest


def _add_mould(stage: Stage, mould: Mould, back: float) -> None:
    surface = mould.surface
    corners = surface.vertices[surface.faces]
    normal = surface.face_normal
    weighted = (normal * surface.face_area[:, None]).repeat(3, axis=0)
    at_vertex = np.stack([np.bincount(surface.faces.ravel(), weighted[:, axis]) for axis in range(3)], axis=1)
    at_vertex = at_vertex / np.maximum(np.linalg.norm(at_vertex, axis=1)[:, None], 1e-300)
    smooth = at_vertex[surface.faces]
    is_sharp = np.einsum("mkd,md->mk", smooth, normal) < _CREASE
    stage.add_faces(corners, np.where(is_sharp[..., None], normal[:, None], smooth), NO_CLOTH, back=back)
    face, k = np.nonzero(surface.face_neighbour < 0)
    stage.add_segments(_edges(corners, face, k), _OUTLINE, 2.5)
    face, k = np.nonzero(surface.face_neighbour > 3 * np.arange(len(corners))[:, None])  # each edge once
    other = surface.face_neighbour[face, k] // 3
    is_crease = np.einsum("ed,ed->e", normal[face], normal[other]) < _CREASE
    stage.add_segments(_edges(corners, face[is_crease], k[is_crease]), _SEAM, 2.0)


def _edges(corners: FloatArray, face: NDArray[np.int64], k: NDArray[np.int64]) -> FloatArray:
    """Return edges k of faces, from corner k to the next, (n, 2, 3)."""
    return np.stack([corners[face, k], corners[face, (k + 1) % 3]], axis=1)


def _mark_seed(stage: Stage, net: Net, view: View) -> None:
    """Mark the seed, with an arrow along the warp and one along the weft."""
    i, j = net.seed_index
    seed = view.pixels(net.seed)
    reach = _ARROW * view.mm_per_pixel
    _, weft = net.directions(i, i + 1)
    for name, direction, colour in (("weft", weft[0, j], WEFT), ("warp", net.direction, WARP)):
        if not np.isfinite(direction).all():
            continue
        tip = view.pixels(net.seed + reach * np.asarray(direction))
        _arrow(stage, seed, tip, colour)
        away = (tip - seed) / max(float(np.linalg.norm(tip - seed)), 1e-9)
        stage.add_text(name, tip + 34 * away, 25, colour, align="centre", bold=True, plate=True)
    stage.add_ring(seed, 6.0, _WHITE, 12.0)
    stage.add_ring(seed, 11.0, INK, 4.0)


def _arrow(stage: Stage, start: FloatArray, tip: FloatArray, colour: Colour) -> None:
    length = float(np.linalg.norm(tip - start))
    if length < 1.0:
        return
    along = (tip - start) / length
    side = np.array([-along[1], along[0]])
    head = min(26.0, 0.5 * length)
    paints: tuple[tuple[float, Colour], ...] = ((3.0, _WHITE), (0.0, colour))
    for rim, paint in paints:
        stage.add_stroke(start, tip - 0.8 * head * along, paint, 7.0 + 2 * rim)
        wing = (0.45 * head + 1.5 * rim) * side
        foot = tip - (head + rim) * along
        stage.add_polygon([tip + 2.0 * rim * along, foot + wing, foot - wing], paint)


def _mark_largest_shear(stage: Stage, net: Net, measures: Measures, view: View, clearance: float) -> None:
    """Ring the cell with the largest shear and write the shear beside it, on the side away from the seed.

    Where the mould hides it the ring is broken, lest what lies before it be taken for it.
    """
    if not np.isfinite(measures.max_shear):
        return
    place = view.pixels(measures.max_shear_position)
    is_hidden = _is_hidden(net.mould, view, measures.max_shear_position, clearance)
    stage.add_ring(place, 20.0, _WHITE, 9.0)
    stage.add_ring(place, 20.0, INK, 4.0, broken=is_hidden)
    is_right = bool(place[0] >= view.pixels(net.seed)[0])
    if not _LABEL_ROOM < place[0] < _WIDTH - _LABEL_ROOM:
        is_right = bool(place[0] < 0.5 * _WIDTH)
    text = f"max {np.degrees(measures.max_shear):.1f}°" + (", behind" if is_hidden else "")
    at = place + np.array([32.0 if is_right else -32.0, 0.0])
    stage.add_text(text, at, 27, INK, align="left" if is_right else "right", bold=True, plate=True)


def _is_hidden(mould: Mould, view: View, place: FloatArray, clearance: float) -> bool:
    """Tell whether a place of the cloth is on a side that is not seen, or behind other parts of the mould."""
    surface = mould.surface
    nearest, _ = surface.closest_point(place)
    if surface.face_normal[nearest.face] @ view.toward < 0:
        return True
    return view.hides(place, surface.vertices[surface.faces], clearance)
