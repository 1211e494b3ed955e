"""Arms of the mould that lie back towards the seed, covered after the quadrants."""

from __future__ import annotations

import numpy as np

from meshdrape.geodesic.detours import detours
from meshdrape.kernels.complete import complete, joins_all
from meshdrape.kernels.tables import Lattice
from meshdrape.surface import Surface
from meshdrape.weave.fabric import Fabric
from meshdrape.weave.lay.judge import Judge
from meshdrape.weave.lay.quadrants import gap_tolerance
from meshdrape.weave.start.generators import border_slack
from meshdrape.weave.status import NodeStatus

# Bends a mould may make; each pass follows one. A spiral with more is left uncovered beyond, and the summary says so.
MOST_PASSES = 200
# Senses tried in each quadrant, the first turned back along the weft, then the warp, then both.
TURNS = ((1, -1), (-1, 1), (-1, -1), (1, 1))


def fill_bays(surface: Surface, fabric: Fabric, lattice: Lattice, judge: Judge) -> None:
    """Place nodes back round reflex corners of the outline, until there are none to place.

    One thread, one order: nodes depend on what is there already. The senses are those of each quadrant, so that a
    symmetric mould gets a symmetric net.
    """
    i0, j0 = (int(v) for v in judge.start.origin)
    n_warp, n_weft = lattice.status.shape
    tolerance, slack = gap_tolerance(surface, fabric), border_slack(fabric)
    spacing = (fabric.warp_spacing, fabric.weft_spacing)
    mesh = surface.unfolding
    table = detours(surface, fabric.longest)
    report = np.zeros(5, dtype=np.int64)
    refused: list[tuple[int, int]] = []
    for _ in range(MOST_PASSES):
        before = int(report[0])
        for turn in TURNS:
            for qi in (1, -1):
                for qj in (1, -1):
                    # rows and columns of the quadrant, the generators' own with the positive ones
                    rows = (i0, n_warp) if qi > 0 else (0, i0)
                    columns = (j0, n_weft) if qj > 0 else (0, j0)
                    sense = (qi * turn[0], qj * turn[1])
                    first = (rows[0] if sense[0] > 0 else rows[1] - 1, columns[0] if sense[1] > 0 else columns[1] - 1)
                    count = (rows[1] - rows[0], columns[1] - columns[0])
                    while not complete(
                        mesh, table, lattice, judge.start, *sense, first[0], count[0], first[1], count[1],
                        *spacing, fabric.initial_angle, judge.stop_at, tolerance, slack, report,
                    ):  # fmt: skip
                        i, j, why = (int(v) for v in report[2:])
                        judge.decide((i, j), why, sense)
                        status = lattice.status[i, j]
                        if status == NodeStatus.OUTSIDE:
                            # not to be tried again from there
                            lattice.status[i, j] = NodeStatus.NOT_CONVERGED
                            refused.append((i, j))
                        elif status <= NodeStatus.OFF_MOULD:
                            off = status == NodeStatus.OFF_MOULD
                            if joins_all(mesh, lattice, judge.start, *sense, i, j, off, *spacing):
                                report[0] += 1
                            else:
                                lattice.status[i, j] = NodeStatus.MET_ITSELF
        if int(report[0]) == before:
            break
    for node in refused:
        lattice.status[node] = NodeStatus.OUTSIDE
