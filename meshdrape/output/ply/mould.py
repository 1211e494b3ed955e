"""NET.mould.ply: the mould's own triangles with what the net says about each."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Final

import numpy as np

from meshdrape import __version__
from meshdrape.output.ply.columns import POSITION, SHEAR_FIELDS, fill, fill_shear
from meshdrape.output.ply.comments import to_comments
from meshdrape.output.ply.writer import Element, ply_writer

if TYPE_CHECKING:
    from meshdrape.weave.measures.field import MouldField

VERTEX: Final = np.dtype([(name, "f8") for name in POSITION])
TRIANGLE: Final = np.dtype(
    [("vertex_indices", "i4", (3,)), *SHEAR_FIELDS, ("warp_angle_deg", "f8"), ("weft_angle_deg", "f8")]
)


def write_mould_ply(field: MouldField, path: str | os.PathLike[str], locking_angle: float) -> None:
    """Write the triangles of a mould with fibre angles and shear, as binary little-endian PLY for MeshLab.

    Each face has a colour, `quality` (absolute shear, deg), `shear_deg` (signed), `warp_angle_deg` and
    `weft_angle_deg`, the angles from the reference axis, which a comment names. Where there is no cloth the
    face is grey, its `quality` is 0 and the other three are NaN.

    Parameters
    ----------
    field : MouldField
    path : path-like
    locking_angle : float
        rad; the colours change at it.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    vertices = Element("vertex", len(field.vertices), VERTEX)
    triangles = Element("face", len(field.triangles), TRIANGLE)
    points = vertices.rows(vertices.count)
    fill(points, POSITION, field.vertices)
    faces = triangles.rows(triangles.count)
    faces["vertex_indices"] = field.triangles
    fill_shear(faces, field.shear, locking_angle)
    faces["warp_angle_deg"] = np.degrees(field.warp_angle)
    faces["weft_angle_deg"] = np.degrees(field.weft_angle)
    made = {
        "meshdrape": __version__,
        "unit": "mm",
        "locking_angle_rad": locking_angle,
        "reference": np.asarray(field.reference).tolist(),
    }
    with ply_writer(path, [vertices, triangles], to_comments(made)) as ply:
        ply.write("vertex", points)
        ply.write("face", faces)
