"""Convex vertices that stand so close together that a path may have a shorter way round several of them at once."""

import math

import numpy as np

from meshdrape.kernels.cache import kernel

# Radii at which the defects round a vertex are added up: from half a path's length down, two to an octave.
N_RADII = 24


@kernel(makes_arrays=True)
def reach_of_crowds(centre, position, defect, key, low, size, width, half, margin, own):
    """From how far off the vertices round each centre may offer a shorter way to a path of length 2 `half`.

    Defects that add up to S within a radius rho act, seen from farther off than rho, as one vertex of defect S does:
    round it two ways between the path's ends are equally long where the path's middle passes at half tan(S / 4). They
    count where that is farther off than rho.

    Parameters
    ----------
    centre : (c, 3)
    position, defect : (n, 3) mm, (n,) rad
        Convex vertices, sorted by `key`, the number of the box that holds each.
    key : (n,) int64
    low, size : (3,)
        Corner of the first box; number of boxes each way.
    width : float
        Of a box, mm, at least `half`.
    margin : float
        Factor on the defects.
    own : (c,) rad
        Defect of each centre itself.

    Returns
    -------
    (reach, gathered) : (c,) mm, (c,) rad
        That distance, and all defects within `half`.
    """
    n = len(centre)
    out = np.empty(n)
    within = np.empty(n)
    total = np.empty(N_RADII + 1)
    for at in range(n):
        total[:] = 0.0
        ix = math.floor((centre[at, 0] - low[0]) / width)
        iy = math.floor((centre[at, 1] - low[1]) / width)
        iz = math.floor((centre[at, 2] - low[2]) / width)
        for jx in range(max(ix - 1, 0), min(ix + 2, size[0])):
            for jy in range(max(iy - 1, 0), min(iy + 2, size[1])):
                row = (jx * size[1] + jy) * size[2]
                first = np.searchsorted(key, row + max(iz - 1, 0))
                last = np.searchsorted(key, row + min(iz + 1, size[2] - 1), side="right")
                for k in range(first, last):
                    away2 = (
                        (position[k, 0] - centre[at, 0]) ** 2
                        + (position[k, 1] - centre[at, 1]) ** 2
                        + (position[k, 2] - centre[at, 2]) ** 2
                    )
                    if away2 > half * half:
                        continue
                    # rho[k] = half 2^(-k / 2): the smallest that still holds it
                    octaves = N_RADII if away2 == 0.0 else min(int(-math.log2(away2 / (half * half))), N_RADII)
                    total[octaves] += defect[k]
        reach = half * math.tan(0.25 * min(margin * own[at], math.pi))
        gathered = 0.0
        for k in range(N_RADII, -1, -1):
            gathered += total[k]
            turn = min(margin * gathered, math.pi)
            far = half * math.tan(0.25 * turn)
            if far > half * 2.0 ** (-0.5 * (k + 1)):
                reach = max(reach, far)
        out[at] = reach
        within[at] = gathered
    return out, within
