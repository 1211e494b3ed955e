"""What leaves the package: PLY files for MeshLab, a picture, a summary for machines.

Importing this imports neither VTK nor any other library of drawing.
"""

from meshdrape.output.files import atomic_write, check_target
from meshdrape.output.picture.draw import draw_net
from meshdrape.output.ply.fibres import write_fibres_ply
from meshdrape.output.ply.mould import write_mould_ply
from meshdrape.output.ply.net import write_ply
from meshdrape.output.ply.stored_net import StoredNet, read_net
from meshdrape.output.summary import json_text, write_json

__all__ = [
    "StoredNet",
    "atomic_write",
    "check_target",
    "draw_net",
    "json_text",
    "read_net",
    "write_fibres_ply",
    "write_json",
    "write_mould_ply",
    "write_ply",
]
