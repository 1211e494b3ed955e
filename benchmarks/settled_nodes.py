"""What a node costs that libigl decides, by the number of triangles within one spacing of it. Prints a table.

Run it as ``python benchmarks/settled_nodes.py``. Each node is looked for twice from a first guess a fiftieth of a
spacing off: as the package does, on distance fields that libigl's distances then confirm; and from libigl's distances
alone, by Broyden's method with slopes by differences. Processor time of this process; libigl's own share is told apart.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from meshdrape.geodesic.distance import exact_distances
from meshdrape.geodesic.patch import Patch, faces_between
from meshdrape.surface import Surface, SurfacePoint
from meshdrape.weave.lay.settle import MET, NodeSearch, Place, step_from

FloatArray = NDArray[np.float64]

NODES = 12
SLACK = 0.3
STEP = 1e-3


def hills(cells: int) -> Surface:
    """A plate of 200 mm with hills and hollows on a grid whose inner vertices are off their places."""
    rng = np.random.default_rng(4)
    side = np.linspace(-100, 100, cells + 1)
    x, y = (v.ravel() for v in np.meshgrid(side, side, indexing="ij"))
    inner = np.maximum(np.abs(x), np.abs(y)) < 99
    x, y = (v + inner * rng.uniform(-50, 50, len(v)) / cells for v in (x, y))
    z = sum(
        rng.uniform(-25, 25) * np.exp(-((x - a) ** 2 + (y - b) ** 2) / 2000) for a, b in rng.uniform(-80, 80, (8, 2))
    )
    i, j = (v.ravel() for v in np.meshgrid(range(cells), range(cells), indexing="ij"))
    a = i * (cells + 1) + j
    b, c, d = a + cells + 1, a + cells + 2, a + 1
    return Surface.from_arrays(
        np.stack([x, y, z], axis=1), np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    )


class LibiglAlone:
    """The same search with nothing but libigl's distances on one patch."""

    def __init__(self, surface: Surface, parents: list[Place], length: float, guess: Place) -> None:
        self.surface, self.parents, self.length = surface, parents, length
        ends = [SurfacePoint.from_frame(surface, *place) for place in (*parents, guess)]
        self.faces = np.union1d(*(faces_between(surface, end, ends[2], (1 + SLACK) * length) for end in ends[:2]))
        self.seconds = 0.0

    def distances(self, places: list[Place]) -> FloatArray:
        """From both parents to some places, (2, n)."""
        patch = Patch(self.surface, self.faces)
        sources, targets = (
            [patch.insert(p[0], SurfacePoint.from_frame(self.surface, *p).position(self.surface))[0] for p in some]
            for some in (self.parents, places)
        )
        begun = time.thread_time()
        found = np.array([exact_distances(patch, source, targets) for source in sources])
        self.seconds += time.thread_time() - begun
        return found

    def run(self, guess: Place) -> Place | None:
        """The node nearest to a guess; None where the search does not close."""
        step = STEP * self.length
        around = [step_from(self.surface, guess, step * np.array(v)) for v in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        near = self.distances(around)
        inverse = np.linalg.inv(np.stack([near[:, 0] - near[:, 1], near[:, 2] - near[:, 3]], axis=1) / (2 * step))
        shift, miss = np.zeros(2), self.distances([guess])[:, 0] - self.length
        for _ in range(30):
            move = -inverse @ miss
            shift = shift + move
            place = step_from(self.surface, guess, shift)
            change = self.distances([place])[:, 0] - self.length - miss
            miss = miss + change
            if np.abs(miss).max() <= MET * self.length:
                return place
            mapped = inverse @ change
            inverse = inverse + np.outer(move - mapped, move @ inverse) / (move @ mapped)
        return None


def corners(surface: Surface, length: float) -> list[tuple[list[Place], Place]]:
    """Pairs of parents, each one spacing straight on from a place, and a first guess of that place."""
    rng = np.random.default_rng(7)
    found: list[tuple[list[Place], Place]] = []
    while len(found) < NODES:
        point = SurfacePoint(int(rng.integers(len(surface.faces))), rng.dirichlet([1, 1, 1]))
        node: Place = (point.face, *point.in_frame(surface))
        turn = rng.uniform(0, 2 * np.pi)
        ways = [length * np.array([np.cos(turn + t), np.sin(turn + t)]) for t in (0, np.pi / 2)]
        places = [step_from(surface, node, way) for way in (*ways, 0.02 * ways[0] - 0.01 * ways[1])]
        if all(place is not None for place in places):
            found.append((places[:2], places[2]))
    return found


def main() -> None:
    print("| triangles searched | nodes | libigl alone, ms a node | of it in libigl | now, ms a node | ratio |")
    print("|---|---|---|---|---|---|")
    length = 40.0
    for cells in (12, 30, 60, 110):
        surface = hills(cells)
        cases = corners(surface, length)
        searched, alone, inside, now, agreed = 0, 0.0, 0.0, 0.0, 0
        for parents, guess in cases:
            found = {}
            for _ in range(2):  # the first is not counted: it may load what both need
                begun = time.thread_time()
                search = NodeSearch(surface, *parents, length, length, guess, slack=SLACK)
                found["now"] = search.run(guess, 1.0) or search.run(guess, -1.0)
                took = time.thread_time() - begun
                begun = time.thread_time()
                plain = LibiglAlone(surface, parents, length, guess)
                found["alone"] = plain.run(guess)
                plainly = time.thread_time() - begun
            if found["now"] is None or found["alone"] is None:
                continue
            places = [
                SurfacePoint.from_frame(surface, *p).position(surface) for p in (found["now"].place, found["alone"])
            ]
            if np.linalg.norm(places[0] - places[1]) > 1e-9 * length:
                continue  # another node than the one looked for
            agreed += 1
            searched, now, alone, inside = (
                searched + len(plain.faces),
                now + took,
                alone + plainly,
                inside + plain.seconds,
            )
        mean = 1e3 / agreed
        print(
            f"| {searched / agreed:,.0f} | {agreed} | {mean * alone:.1f} | {mean * inside:.1f} | {mean * now:.2f} "
            f"| {alone / now:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
