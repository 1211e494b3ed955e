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
    """Faces of a B-rep asked for that are not there, or no choice made where one is needed.

    Attributes
    ----------
    faces : tuple
        The faces there are (:class:`meshdrape.mould.CadFace`).
    """

    def __init__(self, message: str, faces: tuple[object, ...] = ()) -> None:
        super().__init__(message)
        self.faces = faces


class FabricError(MeshdrapeError):
    """A fabric that no mould can take: spacing or angle out of range."""


class StartError(MeshdrapeError):
    """A seed point off the mould, or a direction that is zero or along the normal."""


class NetError(MeshdrapeError):
    """A net that cannot be made or read: too large for the memory, not a meshdrape file."""


class DesignError(MeshdrapeError):
    """A wing and spar, or a question about them, that makes no sense: a table that does not increase, no such name."""


class MissingLibraryError(MeshdrapeError):
    """A library of the system that a dependency needs and the machine does not have."""


_DEBIAN_PACKAGE = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libGLU.so.1": "libglu1-mesa",
    "libICE.so.6": "libice6",
    "libOpenGL.so.0": "libopengl0",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXrender.so.1": "libxrender1",
    "libfontconfig.so.1": "libfontconfig1",
    "libgomp.so.1": "libgomp1",
    "libxcb.so.1": "libxcb1",
}


def missing_library(error: ImportError) -> MissingLibraryError:
    """Return the error to raise for a dependency that cannot be imported, with the package that cures it."""
    reason = " ".join(str(error).split())
    library = reason.partition(":")[0]
    if library in _DEBIAN_PACKAGE:
        return MissingLibraryError(f"{library} is missing; apt-get install {_DEBIAN_PACKAGE[library]}")
    if ".so" in library:
        return MissingLibraryError(
            f"{library} is missing; apt-get install the package that has it (apt-file search {library})"
        )
    if error.name:
        return MissingLibraryError(f"the Python package {error.name} is missing; pip install {error.name}")
    return MissingLibraryError(f"a dependency cannot be imported ({reason}); install meshdrape anew")
