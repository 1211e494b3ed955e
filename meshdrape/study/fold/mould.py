"""The mould of a design: from its CAD script for the one drape that counts, from its rulings for the many."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshdrape.errors import DesignError, FileError
from meshdrape.mould.cad.library import build_script
from meshdrape.mould.cad.script_apart import ScriptApart
from meshdrape.mould.mould import Mould
from meshdrape.study.fold.design import Design, Shape
from meshdrape.study.fold.frame import Cloth, Frame

FloatArray = NDArray[np.float64]

# A facet of the crease stands for all its directions: half of what it turns by is lost. Rad from facet to facet.
CAD_TURN = math.radians(0.02)
CAD_CHORD = 0.01  # mm; the turn governs
CAD_FACETS = 2500  # of the crease: where it turns more in all, the facets turn more each
RULED_TURN = math.radians(0.015)
RULED_FACETS = 2500


@dataclass(frozen=True, eq=False)
class FoldMould:
    """A mould in the coordinates of a frame.

    Attributes
    ----------
    mould : Mould
        The side laid first is z = g_w(y) of the frame's fold.
    crease : (k, 3) mm
        Its vertices on the crease, y increasing from 0.
    """

    mould: Mould
    crease: FloatArray

    def psi_at_start(self) -> float:
        """Turn of the net over the first facet of the crease, rad: what a ribbon straight on over it turns by."""
        dx, dy, dz = self.crease[1] - self.crease[0]
        # alpha on the wing's facet, which is dy, dz long across its rulings; beta likewise
        return math.atan2(dz, math.hypot(dy, dx)) - math.atan2(dx, math.hypot(dy, dz))


def ruled_mould(frame: Frame, cloth: Cloth, turn: float = RULED_TURN, facets: int = RULED_FACETS) -> FoldMould:
    """The mould with facets along the rulings of both sides: exactly developable, and quick to make.

    Parameters
    ----------
    turn : float
        Most that the slopes of the crease change over a facet, as long as there are no more than
    facets : int
        of them: there they share alike.
    """
    fold = frame.fold
    y, _ = facet_bounds(frame, turn, facets)
    edge, lift = fold.spar(y), fold.wing(y)
    far = np.maximum(edge.max(), edge.min() + cloth.width) + cloth.spacing
    k = len(y)
    crease = np.stack([edge, y, lift], axis=1)
    trailing = np.stack([np.full(k, far), y, lift], axis=1)
    hem = np.stack([edge, y, lift - frame.height], axis=1)
    a = np.arange(k - 1)
    # counter-clockwise about +z on the wing and about -x on the spar
    wing = np.concatenate([np.stack([a, a + k, a + k + 1], 1), np.stack([a, a + k + 1, a + 1], 1)])
    spar = np.concatenate([np.stack([a, a + 1, a + 2 * k + 1], 1), np.stack([a, a + 2 * k + 1, a + 2 * k], 1)])
    triangles = np.concatenate([wing, spar])
    # two strips sewn along the crease: nothing that would have to be examined
    mould = Mould(np.concatenate([crease, trailing, hem]), triangles, np.zeros(len(triangles), dtype=np.int64))
    return FoldMould(mould, crease)


def facet_bounds(frame: Frame, turn: float, facets: int) -> tuple[FloatArray, float]:
    """Stations from 0 to the span between which the slopes of both profiles change alike, and by how much, rad.

    That is by no more than `turn`, unless it took more than so many facets.
    """
    fold = frame.fold
    fine = np.linspace(0.0, fold.span, 20_001)
    bend = np.maximum(np.abs(fold.wing.bend(fine)), np.abs(fold.spar.bend(fine)))
    # the larger bend at the ends of so short a step bounds it well enough
    change = np.concatenate([[0.0], np.cumsum(np.maximum(bend[1:], bend[:-1]) * np.diff(fine))])
    turn = max(turn, float(change[-1]) / facets)
    # some facets where the profiles are straight, too
    count = change / turn + 40 * fine / fold.span
    n = int(np.ceil(count[-1]))
    return np.interp(np.linspace(0.0, count[-1], n + 1), count, fine), turn


def cad_mould(design: Design, frame: Frame, cloth: Cloth) -> FoldMould:
    """The mould of the CAD script, tessellated finely, in the coordinates of the frame.

    Wing and spar are made wide enough for the sheet's first row to lie on the side laid first all along; the script
    cuts them parallel to the crease.
    """
    asked = _script(design, frame, cloth)
    return _in_frame(lambda: build_script(*asked), frame)


class CadMould:
    """`cad_mould` in a process of its own, which begins to get ready at once; leave the block to give it up."""

    def __init__(self) -> None:
        self._script = ScriptApart()

    def begin(self, design: Design, frame: Frame, cloth: Cloth) -> None:
        """Have the mould made; arguments as of `cad_mould`."""
        self._frame = frame
        self._script.ask(*_script(design, frame, cloth))

    def made(self) -> FoldMould:
        """Wait for it."""
        return _in_frame(self._script.mould, self._frame)

    def __enter__(self) -> CadMould:
        return self

    def __exit__(self, *_: object) -> None:
        self._script.close()


def _script(design: Design, frame: Frame, cloth: Cloth) -> tuple[str, dict[str, Any], float, float]:
    """The script, its parameters, and the tolerances of its tessellation."""
    chord, height = design.chord, design.spar_height
    if frame.first == "spar":
        height = max(height, cloth.width + cloth.spacing)
    else:
        chord = max(chord, cloth.width + cloth.spacing)
    parameters = {"span": design.span, "chord": max(chord, height), "spar_height": height, **_shapes(design)}
    _, turn = facet_bounds(frame, CAD_TURN, CAD_FACETS)
    return "wing_spar", parameters, CAD_CHORD, turn


def _in_frame(script: Callable[[], Mould], frame: Frame) -> FoldMould:
    try:
        made = script()
    except FileError as error:
        msg = f"no CAD mould of this design: {error}"
        raise DesignError(msg) from None
    wing, spar = (
        np.unique(made.triangles[made.triangle_face == face.id])
        for name in ("wing", "spar")
        for face in made.cad_faces
        if face.name == name
    )
    vertices = frame.from_design(made.vertices)
    triangles = made.triangles[:, ::-1] if frame.mirrored else made.triangles
    crease = vertices[np.intersect1d(wing, spar)]
    crease = crease[np.argsort(crease[:, 1])]
    mould = Mould(
        vertices,
        triangles,
        made.triangle_face,
        made.cad_faces,
        source=made.source,
        sha256=made.sha256,
        chord_tolerance=made.chord_tolerance,
        angle_tolerance=made.angle_tolerance,
        parameters=made.parameters,
    )
    return FoldMould(mould, crease)


def _shapes(design: Design) -> dict[str, Any]:
    """The script's parameters of both profiles."""
    given: dict[str, Any] = {"wing_profile": design.wing.name, "deviation": "none"}
    given |= _parameters(design.wing, "wing_")
    if design.spar is not None:
        given["spar_profile"] = design.spar.name
        return given | _parameters(design.spar, "spar_")
    assert design.deviation is not None
    given |= {"spar_profile": "origami", "deviation": design.deviation.name}
    return given | _parameters(design.deviation, "deviation_")


def _parameters(shape: Shape, prefix: str) -> dict[str, Any]:
    given = shape.parameters
    if shape.name == "table":
        return {f"{prefix}table": (given["y"], given["f" if prefix == "deviation_" else "g"])}
    own = "" if prefix == "deviation_" else prefix
    return {f"{own}{name}": float(value) for name, value in given.items()}
