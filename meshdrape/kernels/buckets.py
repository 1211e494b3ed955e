"""Places in space by cubes, hashed: a chance collision only costs a look."""

from meshdrape.kernels.cache import kernel


@kernel(inline="always")
def bucket(x, y, z, size):
    """Number below `size`, a power of two, of the cube with these integer coordinates."""
    return (x * 73856093 ^ y * 19349663 ^ z * 83492791) & (size - 1)


@kernel(inline="always")
def cube_beside(x, y, z, near, size):
    """Bucket of the near-th, 0 to 26, of the cubes that touch one, itself among them."""
    return bucket(x + near // 9 - 1, y + near // 3 % 3 - 1, z + near % 3 - 1, size)
