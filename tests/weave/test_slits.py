"""Slits narrower than two cells: the sheet lies over them as if they were not there."""

import numpy as np
import pytest
from lattice import planar_lattice
from moulds import Mesh, grid

import meshdrape
from meshdrape import NodeStatus
from meshdrape.cli.main import main
from meshdrape.surface import Surface
from meshdrape.weave import read_off
from meshdrape.weave.lay.collar import extended
from meshdrape.weave.lay.notches import without_notches

LOST = [status for status in NodeStatus if status > NodeStatus.OUTSIDE]


class Plan:
    """A plate of rectangles, two triangles each: those marked # in rows of text, a row along y for each step of x."""

    def __init__(self, x, y, rows, height=None):
        self.x, self.y = np.array(x, dtype=float), np.array(y, dtype=float)
        self.kept = np.array([list(row) for row in rows]) == "#"
        mesh = grid(self.x, self.y, lambda u, v: (u, v, 0 * u if height is None else height(u, v)))
        middle = mesh.vertices[mesh.triangles].mean(axis=1)
        self.mesh: Mesh = mesh.kept(self._cell(middle[:, 0], middle[:, 1]))

    def _cell(self, x, y):
        i, j = np.searchsorted(self.x, x) - 1, np.searchsorted(self.y, y) - 1
        inside = (i >= 0) & (j >= 0) & (i < len(self.x) - 1) & (j < len(self.y) - 1)
        return inside & self.kept[np.clip(i, 0, len(self.x) - 2), np.clip(j, 0, len(self.y) - 2)]

    def holds(self, x, y, margin):
        """Whether places lie on the plate and no nearer to its border than a margin; a negative one: or no farther."""
        corners = [self._cell(x + a, y + b) for a in (-abs(margin), abs(margin)) for b in (-abs(margin), abs(margin))]
        return np.all(corners, axis=0) if margin > 0 else np.any(corners, axis=0)

    def lay(self, spacing, seed, degrees=0.0):
        angle = np.radians(degrees)
        return meshdrape.drape(
            self.mesh.mould(), meshdrape.Fabric(spacing), (*seed, 0), (np.cos(angle), np.sin(angle), 0)
        )


def assert_lies_as_the_flat_sheet(plan, net, seed, degrees):
    """Every node of the flat sheet on the plate is PLACED there and no other; no cell that is whole is sheared."""
    flat = planar_lattice(net, (*seed, 0), np.radians(degrees))
    on = net.node_status == NodeStatus.PLACED
    inside = plan.holds(flat[..., 0], flat[..., 1], 1e-6)
    assert on[inside].all(), f"{np.count_nonzero(inside & ~on)} of {np.count_nonzero(inside)} nodes missing"
    assert not on[~plan.holds(flat[..., 0], flat[..., 1], -1e-6)].any()
    assert not {status: net.count(status) for status in LOST if net.count(status)}
    here = net.node_status <= NodeStatus.OFF_MOULD
    assert net.node_position[here] == pytest.approx(flat[here], abs=1e-8)
    assert np.nanmax(np.abs(meshdrape.measure(net).cell_shear)) < 1e-9


RING = ("#####", "....#", "###.#", "#...#", "#...#", "#####")


@pytest.mark.parametrize(
    ("x", "y", "spacing", "seed"),
    [
        ([0, 1.1, 1.9, 3.4, 3.9, 5.3, 6.5], [0, 0.7, 1.9, 2.8, 4.2, 5.7], (0.19, 0.36), 4.2),
        ([0, 1.3, 1.9, 3.4, 4.7, 6.2, 6.8], [0, 1.2, 2.0, 3.0, 4.5, 5.3], (0.16, 0.49), 5.0),
        ([0, 1.4, 1.9, 2.9, 4.1, 5.0, 6.5], [0, 1.5, 2.9, 3.9, 5.3, 5.8], (0.2, 0.41), 4.4),
        ([0, 1.1, 2.4, 3.8, 5.1, 6.1, 7.6], [0, 0.5, 1.7, 2.7, 3.9, 5.3], (0.11, 0.13), 5.4),
        ([0, 1.0, 2.3, 3.7, 4.6, 5.8, 6.5], [0, 1.0, 2.4, 3.3, 3.8, 5.1], (0.5, 0.2), 4.9),
    ],
)
def test_a_ring_cut_open(x, y, spacing, seed):
    plan = Plan(x, y, RING)
    assert_lies_as_the_flat_sheet(plan, plan.lay(spacing, (seed, 0.2), 90), (seed, 0.2), 90)


@pytest.mark.parametrize("degrees", [0, 31, 90])
@pytest.mark.parametrize("width", [1e-4, 0.3, 1.0, 1.7, 1.99, 3.0])
@pytest.mark.parametrize("end", ["closed", "open", "of several edges"])
def test_a_slit_of_any_width(end, width, degrees):
    """From far below a cell's width to where the cloth no more shares nodes across it."""
    # along y, so many spacings wide, of single edges; the other way from the seed it is a ring
    x = [0, 20, 40, 40 + width, 60, 80]
    rows = {
        "closed": ("####", "####", "..##", "####", "####"),
        "open": ("####", "#..#", "...#", "#..#", "####"),
        "of several edges": ("####", "####", "...#", "####", "####"),
    }[end]
    if end == "of several edges":
        x = [0, 20, 40, 40 + width / 3, 40 + width, 60]
        rows = ("####", "####", "...#", "...#", "####")
    plan = Plan(x, [0, 15, 31, 52, 70], rows)
    seed = (13.3, 62.9)
    assert_lies_as_the_flat_sheet(plan, plan.lay(1.0, seed, degrees), seed, degrees)


def test_what_fills_a_slit_is_the_slit():
    """Its area, and its border on both sides."""
    plan = Plan([0, 20, 40, 40.7, 60], [0, 15, 31, 52, 70], ("####", "####", "..##", "####"))
    surface = Surface.from_arrays(plan.mesh.vertices, plan.mesh.triangles)
    filled = without_notches(surface, 4.0, 2.0)
    whole = Surface.from_arrays(surface.vertices, np.concatenate([surface.faces, filled]))
    assert whole.area - surface.area == pytest.approx(0.7 * 31, rel=1e-12)
    assert (whole.face_normal[:, 2] == 1).all()
    assert len(whole.border_loops) == 1
    # wider than asked for it stays
    assert not len(without_notches(surface, 0.65, 0.65))
    assert not len(without_notches(surface, 4.0, 0.65)) or whole.area > surface.area


def test_a_slit_open_at_both_ends_makes_a_hole_of_what_the_ring_holds():
    plan = Plan([0, 20, 40, 40.7, 60], [0, 15, 31, 52], ("###", "#.#", "..#", "###"))
    surface = Surface.from_arrays(plan.mesh.vertices, plan.mesh.triangles)
    assert len(surface.border_loops) == 1
    filled = without_notches(surface, 4.0, 2.0)
    whole = Surface.from_arrays(surface.vertices, np.concatenate([surface.faces, filled]))
    assert sorted(whole.is_hole(loop) for loop in whole.border_loops) == [False, True]
    collar = extended(surface, 4.0, 2.0)
    # flat: no vertex inside has a defect, and nothing is turned over
    inside = ~collar.border_vertex
    assert np.abs(collar.vertex_defect[inside]).max() < 1e-9
    assert (collar.face_normal[:, 2] > 0).all()


@pytest.mark.parametrize(
    ("x", "y", "rows", "spacing", "seed", "degrees"),
    [
        # cloth of an arm has the place of cloth beside another arm
        (
            [0, 2.026, 4.818, 4.986, 6.43, 8.917], [0, 2.594, 3.85, 4.782], (".##", "###", ".#.", ".#.", "##."),
            (0.4564, 0.2046), (7.844, 3.4563), 0,
        ),
        (
            [0, 2.803, 5.304, 5.696, 6.083], [0, 1.13, 2.865, 4.491, 4.653, 7.212, 7.563],
            ("....##", ".##..#", "######", "#.#..."), (0.4219, 0.2353), (5.7553, 0.7567), 0,
        ),
        (
            [0, 0.048, 0.599, 2.647, 2.689, 4.469], [0, 1.164, 1.356, 3.117, 5.032, 5.161, 6.244],
            ("#..##.", "######", "###..#", ".##.##", "....##"), (0.4235, 0.3826), (2.6327, 1.8725), 331.959,
        ),
        # in a corner of the outline beside a short edge, where sheets of the extension part
        (
            [0, 1.14, 1.63, 2.21, 4.7], [0, 1.11, 1.16, 1.61, 3.72, 4.92], ("#####", ".####", "#####", "#...#"),
            (0.3928, 0.4674), (0.2, 0.77), 0,
        ),
        (
            [0, 2.06, 2.2, 2.23, 3.04], [0, 0.15, 0.37, 2.23, 2.5, 4.07, 7.02],
            ("..####", "...###", "..####", "###.##"), (0.2578, 0.2321), (2.21, 3.9), 15.0,
        ),
    ],
)  # fmt: skip
def test_arms_that_meet_at_a_corner(x, y, rows, spacing, seed, degrees):
    plan = Plan(x, y, rows)
    assert_lies_as_the_flat_sheet(plan, plan.lay(spacing, seed, degrees), seed, degrees)


@pytest.mark.parametrize("bow", [(0.004, 0.0), (0.004, 0.003), (0.003, -0.004)])
def test_a_slit_in_a_curved_plate(bow):
    """The two sides need not agree: the sheet lies over the slit, no node is lost and the mould is covered."""
    side = np.linspace(0, 60, 25)
    slit = (40.0, 40.8)
    x = np.sort(np.concatenate([side[np.abs(side - 40.4) > 1], slit]))
    kept = np.full((len(x) - 1, 24), "#")
    middle = 0.5 * (side[:-1] + side[1:])
    kept[np.ix_((x[:-1] >= 15) & (x[1:] <= slit[0]), np.abs(middle - 30) < 15)] = "."
    kept[np.ix_(x[:-1] == slit[0], middle < 30)] = "."
    plan = Plan(x, side, ["".join(row) for row in kept], lambda u, v: bow[0] * (u - 30) ** 2 + bow[1] * (v - 30) ** 2)
    mould = plan.mesh.mould()
    seed = mould.surface.closest_point((7, 40, 1))[0].position(mould.surface)
    net = meshdrape.drape(mould, meshdrape.Fabric(1.5), seed, (1, 0.3, 0))
    assert not {status: net.count(status) for status in LOST if net.count(status)}
    measures = meshdrape.measure(net)
    assert read_off(measures).coverage_fraction > 0.999
    assert np.degrees(measures.max_shear) < 25
    assert meshdrape.audit(net, 300).max_relative_error < 1e-9


def test_a_stored_net_over_a_slit_is_found_sound(tmp_path):
    """The audit extends the mould as the drape did."""
    plan = Plan([0, 20, 40, 40.7, 60], [0, 15, 31, 52], ("###", "#.#", "..#", "###"))
    file = tmp_path / "ring.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in plan.mesh.vertices] + [
        f"f {a} {b} {c}" for a, b, c in plan.mesh.triangles + 1
    ]
    file.write_text("\n".join(lines) + "\n")
    mould = meshdrape.read_mould(file)
    net = meshdrape.drape(mould, meshdrape.Fabric(1.0), (10, 10, 0), (1, 0.2, 0))
    meshdrape.write_ply(net, tmp_path / "ring.ply")
    assert main(["audit", str(tmp_path / "ring.ply")]) == 0
