"""A file or a script in, a mould out: faces chosen, tessellated, welded, checked; healed only on request."""

from meshdrape.mould.mould import CadFace, Mould
from meshdrape.mould.read import read_mould

__all__ = ["CadFace", "Mould", "read_mould"]
