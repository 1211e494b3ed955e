"""What can go wrong, by name.

Every message is one line that names the culprit and the way out; the command line prints it as it is
and exits with code 2. Catch :class:`MeshdrapeError` to catch them all.
"""


class MeshdrapeError(Exception):
    """Any input meshdrape cannot work with."""


class FileError(MeshdrapeError):
    """A file that is missing, empty, truncated, of an unknown kind, or that cannot be written."""


class MouldError(MeshdrapeError):
    """A surface that cannot be draped: no faces, NaN, non-manifold, mixed orientation, index out of range."""


class SelectionError(MeshdrapeError):
    """Faces of a B-rep asked for that are not there, or no choice made where one is needed."""


class FabricError(MeshdrapeError):
    """A fabric that no mould can take: spacing or angle out of range."""


class StartError(MeshdrapeError):
    """A seed point off the mould, or a direction that is zero or along the normal."""


class NetError(MeshdrapeError):
    """A net that cannot be made or read: too large for the memory, not a meshdrape file."""


class MissingLibraryError(MeshdrapeError):
    """A library of the system that a dependency needs and the machine does not have."""
