"""How a node of the lattice ended."""

from enum import IntEnum


class NodeStatus(IntEnum):
    """Outcome of one node; the first two have a position."""

    PLACED = 0
    """On the mould."""
    OFF_MOULD = 1
    """On the extension past the border, at a cell that touches the mould."""
    OUTSIDE = 2
    """Off the mould and trimmed, or beyond the cloth's extent."""
    FOLDED = 3
    """Warp and weft closer than one degree to parallel, or no point at one spacing from both parents."""
    MET_ITSELF = 4
    """Where the net already lies."""
    STOPPED = 5
    """Past the shear at which the user stops the drape."""
    RECROSSED = 6
    """Behind a fibre that crossed a crease and came back: ill-posed."""
    NOT_CONVERGED = 7
    """The search for the node did not close."""
    NOT_REACHED = 8
    """A parent is missing for one of the reasons above."""
