"""At the border and past it: fabric off the mould still holds the net together, and no part of the mould stays bare."""

import numpy as np
import pytest
from lattice import cells_at, nodes_at, offsets, placed, planar_lattice, shear_deg, statuses_at
from moulds import (
    Mesh,
    bumpy,
    cap,
    cone,
    cut_plate,
    cylinder,
    grid,
    holed_plate,
    hypar,
    icosphere,
    parallelogram,
    plate,
    sliver_plate,
    triangle_plate,
    tube,
    wing_spar,
)

import meshdrape
from meshdrape import NodeStatus
from meshdrape.weave import read_off


def lay(mesh: Mesh, spacing, seed, degrees=0.0, **options):
    angle = np.radians(degrees)
    return meshdrape.drape(
        mesh.mould(), meshdrape.Fabric(spacing), (*seed, 0), (np.cos(angle), np.sin(angle), 0), **options
    )


def assert_covers_the_plane(net, seed, degrees, on_mould, slack=1e-6):
    """Every node of the flat sheet that falls on the mould is PLACED where the flat sheet has it, and no other is.

    `on_mould` (x, y, margin) says whether a place lies on the mould grown by a margin, mm.
    """
    expected = planar_lattice(net, (*seed, 0), np.radians(degrees))
    x, y = expected[..., 0], expected[..., 1]
    step = net.fabric.warp_spacing
    inside, beyond = on_mould(x, y, -slack * step), ~on_mould(x, y, 2 * slack * step)
    on = net.node_status == NodeStatus.PLACED
    assert on[inside].all(), f"{np.count_nonzero(inside & ~on)} of {np.count_nonzero(inside)} nodes missing"
    assert not on[beyond].any()
    here = placed(net)
    assert net.node_position[here] == pytest.approx(expected[here], abs=1e-9 * step * max(net.shape))
    # and the arrays reach as far as the mould does: nothing lies beyond their rim
    rim = np.ones(net.shape, dtype=bool)
    rim[1:-1, 1:-1] = False
    assert not (rim & on).any()
    assert not np.isin(net.node_status, [NodeStatus.FOLDED, NodeStatus.NOT_CONVERGED, NodeStatus.NOT_REACHED]).any()


def box(length, width, centre=(0.0, 0.0)):
    def within(x, y, margin):
        return (np.abs(x - centre[0]) <= length / 2 + margin) & (np.abs(y - centre[1]) <= width / 2 + margin)

    return within


SEEDS = {
    "inside": (3.3, -7.1),
    "corner": (-100, -70),
    "border": (-100, 13),
    "another border": (31, 70),
    "middle of an edge": None,
    "vertex": None,
    "near the border": (99.999999, 1.0),
}


@pytest.mark.parametrize("degrees", [0, 30, 45, 90, 200])
@pytest.mark.parametrize("spot", SEEDS)
def test_plate_from_anywhere(spot, degrees):
    mesh = plate()
    seed = SEEDS[spot]
    if spot == "vertex":
        seed = tuple(mesh.vertices[37, :2])
    if spot == "middle of an edge":
        seed = tuple(mesh.vertices[mesh.triangles[50, :2], :2].mean(axis=0))
    net = lay(mesh, 7.0, seed, degrees)
    assert_covers_the_plane(net, seed, degrees, box(200, 140))
    assert np.nanmax(np.abs(shear_deg(net))) < 1e-8


@pytest.mark.parametrize("spot", ["vertex", "middle of an edge", "border", "inside"])
def test_directions_at_the_seed_are_those_asked_for(spot):
    """On the plane: warp as asked for, weft a right angle on about the normal, wherever the seed lies."""
    mesh = plate()
    seed = {
        "vertex": mesh.vertices[37], "middle of an edge": mesh.vertices[mesh.triangles[50, :2]].mean(axis=0),
        "border": np.array([-100, 13.0, 0]), "inside": np.array([3.3, -7.1, 0]),
    }[spot]  # fmt: skip
    warp = np.array([np.cos(0.7), np.sin(0.7), 0])
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(7.0), seed, 3 * warp)
    assert net.direction == pytest.approx(warp, abs=1e-12)
    assert net.warp_direction[net.seed_index] == pytest.approx(warp, abs=1e-9)
    assert net.weft_direction[net.seed_index] == pytest.approx([-warp[1], warp[0], 0], abs=1e-9)


def test_net_reaches_the_very_border():
    """Spacing that divides the plate: the outermost rows and columns lie on the border and are PLACED."""
    net = lay(plate(), 10.0, (0, 0))
    i, j = np.meshgrid(np.arange(-10, 11), np.arange(-7, 8), indexing="ij")
    assert (statuses_at(net, i, j) == NodeStatus.PLACED).all()
    assert (statuses_at(net, [-11, 11, 0, 0], [0, 0, -8, 8]) == NodeStatus.OFF_MOULD).all()
    touching = meshdrape.measure(net).cell_touches_mould.astype(float)
    assert (cells_at(net, touching, i[:-1, :-1], j[:-1, :-1]) == 1).all()


@pytest.mark.parametrize("degrees", [0, 90])
def test_start_fibre_along_the_border(degrees):
    net = lay(plate(), 10.0, (-100, -70), degrees)
    on = net.node_status == NodeStatus.PLACED
    assert on.sum() == 21 * 15
    assert_covers_the_plane(net, (-100, -70), degrees, box(200, 140))


@pytest.mark.parametrize("degrees", [0, 45, 90, 135])
def test_fibres_along_mesh_edges_and_through_vertices(degrees):
    side = np.linspace(-100, 100, 11)
    mesh = grid(side, side, lambda x, y: (x, y, 0))
    spacing = 20.0 if degrees % 90 == 0 else 20 * np.sqrt(2) / 2
    net = lay(mesh, spacing, (0, 0), degrees)
    assert_covers_the_plane(net, (0, 0), degrees, box(200, 200))


def test_needles_and_strips():
    net = lay(sliver_plate(), 6.0, (3, 5), 17)
    assert_covers_the_plane(net, (3, 5), 17, box(200, 140))


@pytest.mark.parametrize("spacing", [0.9, 200.0])
def test_spacing_a_hundredth_of_a_triangle_to_the_whole_mould(spacing):
    net = lay(plate(cells=(2, 2)), spacing, (3, 5), 17)
    assert_covers_the_plane(net, (3, 5), 17, box(200, 140))


def test_status_off_the_mould_is_kept_only_beside_the_mould():
    """OFF_MOULD nodes have a position and hold up cells at the border; further out all is OUTSIDE."""
    net = lay(plate(), 7.0, (3, 5), 30)
    measures = meshdrape.measure(net)
    distance = np.maximum(np.abs(net.node_position[..., 0]) - 100, np.abs(net.node_position[..., 1]) - 70)
    off = net.node_status == NodeStatus.OFF_MOULD
    assert distance[off].min() > 0
    assert distance[off].max() < 4 * 7 * np.sqrt(2)
    # every cell that touches the mould is whole, and cells that do not are far enough out to miss it
    touching = measures.cell_touches_mould
    assert np.isfinite(measures.cell_shear[touching]).all()
    expected = planar_lattice(net, (3, 5, 0), np.radians(30))
    centre = (expected[:-1, :-1] + expected[1:, 1:]) / 2
    deep = (np.abs(centre[..., 0]) < 100) & (np.abs(centre[..., 1]) < 70)
    assert touching[deep].all()
    far = (np.abs(centre[..., 0]) > 100 + 7) | (np.abs(centre[..., 1]) > 70 + 7)
    assert not touching[far].any()


@pytest.mark.parametrize("degrees", [0, 25, 90])
def test_hole_is_bridged(degrees):
    """Nodes behind the hole lie where the flat sheet has them; over the hole they are off the mould."""
    hole = box(60, 60, (25, 5))

    def within(x, y, margin):
        return box(200, 200)(x, y, margin) & ~hole(x, y, -margin - 1e-12)

    net = lay(holed_plate(), 6.3, (-45, 3), degrees)
    assert_covers_the_plane(net, (-45, 3), degrees, within)
    behind = net.node_position[net.node_status == NodeStatus.PLACED]
    assert ((behind[:, 0] > 55) & (np.abs(behind[:, 1] - 5) < 25)).sum() > 20


def test_hole_larger_than_the_fabrics_way_round():
    """A thin frame: all but the rim is hole, and every node of the rim is found."""

    def within(x, y, margin):
        return box(200, 200)(x, y, margin) & ~box(180, 180)(x, y, -margin - 1e-12)

    mesh = cut_plate(lambda x, y: np.maximum(np.abs(x), np.abs(y)) > 90)
    net = lay(mesh, 6.3, (-95, 3), 20)
    assert_covers_the_plane(net, (-95, 3), 20, within)


CONCAVE = {
    "L": (lambda x, y: (x < 0) | (y < 0), [(-50, 50), (50, -50), (-60, -40)]),
    "U": (lambda x, y: (np.abs(x) > 40) | (y < -40), [(-70, 50), (70, 31), (3, -71)]),
    "T": (lambda x, y: (np.abs(x) < 30) | (y > 50), [(0, -70), (-80, 80)]),
    "comb": (lambda x, y: (y < -60) | (np.abs(np.mod(x + 10, 40) - 20) > 10), [(-90, 50), (3, -81)]),
}


@pytest.mark.parametrize("degrees", [0, 35])
@pytest.mark.parametrize(
    ("shape", "start"), [(shape, start) for shape, (_, seeds) in CONCAVE.items() for start in range(len(seeds))]
)
def test_concave_outline_does_not_stop_the_sheet(shape, start, degrees):
    """Arms ahead of the seed and back towards it are covered as the flat sheet lies, though fibres leave the plate."""
    keep, seeds = CONCAVE[shape]

    def within(x, y, margin):
        # the kept cells are squares of 10: grow or shrink them
        near = np.zeros(np.shape(x), dtype=bool)
        for dx in (-1, 1):
            for dy in (-1, 1):
                u, v = x + dx * abs(margin), y + dy * abs(margin)
                cell = (np.floor(u / 10) * 10 + 5, np.floor(v / 10) * 10 + 5)
                here = keep(*cell) & (np.abs(u) <= 100) & (np.abs(v) <= 100)
                near = (near | here) if margin >= 0 or (dx, dy) == (-1, -1) else (near & here)
        return near

    net = lay(cut_plate(keep), 6.3, seeds[start], degrees)
    assert_covers_the_plane(net, seeds[start], degrees, within)


@pytest.mark.parametrize(
    ("x", "y", "spacing", "seed"),
    [
        ([0, 1.1, 1.9, 3.4, 3.9, 5.3, 6.5], [0, 0.7, 1.9, 2.8, 4.2, 5.7], (0.19, 0.36), 4.2),
        ([0, 1.1, 2.4, 3.8, 5.1, 6.1, 7.6], [0, 0.5, 1.7, 2.7, 3.9, 5.3], (0.11, 0.13), 5.4),
    ],
)
def test_a_ring_cut_open_meets_itself_nowhere(x, y, spacing, seed):
    """Cloth that comes round from both sides closes cells where the fronts meet; none hangs free beside cloth."""
    kept = np.array([list(row) for row in ("#####", "....#", "###.#", "#...#", "#...#", "#####")]) == "#"
    mesh = grid(np.array(x), np.array(y), lambda u, v: (u, v, 0 * u))
    middle = mesh.vertices[mesh.triangles].mean(axis=1)
    mesh = mesh.kept(kept[np.searchsorted(x, middle[:, 0]) - 1, np.searchsorted(y, middle[:, 1]) - 1])
    net = meshdrape.drape(mesh.mould(), meshdrape.Fabric(spacing), seed=(seed, 0.2, 0), direction=(0, 1, 0))
    assert net.count(NodeStatus.MET_ITSELF) == 0
    assert net.count(NodeStatus.PLACED) > 300


@pytest.mark.parametrize("sweep", [1.0, -2.0, 3.0])
@pytest.mark.parametrize("seed", [(0, 0), (-150, -40), (140, 45)])
def test_swept_plate(sweep, seed):
    """The weft generator leaves the mould early; what lies beyond its end is covered all the same."""

    def within(x, y, margin):
        across = (x - sweep * y) / np.hypot(1, sweep)
        return (np.abs(y) <= 50 + margin) & (np.abs(across) <= 150 / np.hypot(1, sweep) + margin)

    at = (seed[0] + sweep * seed[1], seed[1])
    net = lay(parallelogram(sweep=sweep), 8.0, at, 0)
    assert_covers_the_plane(net, at, 0, within)


@pytest.mark.parametrize(
    "corners", [((0, 0), (300, 0), (60, 200)), ((0, 0), (300, 10), (290, 60)), ((0, 0), (200, 0), (0, 150))]
)
@pytest.mark.parametrize(
    "weight", [(0.97, 0.015, 0.015), (0.02, 0.96, 0.02), (1.0, 0.0, 0.0), (0.4, 0.3, 0.3), (0.5, 0.5, 0)]
)
def test_triangle_from_its_tips(corners, weight):
    a, b, c = np.array(corners, dtype=float)
    seed = tuple(np.array(weight) @ [a, b, c])

    def within(x, y, margin):
        inside = np.ones(np.shape(x), dtype=bool)
        for p, q in ((a, b), (b, c), (c, a)):
            along = (q - p) / np.linalg.norm(q - p)
            inside &= along[0] * (y - p[1]) - along[1] * (x - p[0]) >= -margin
        return inside

    net = lay(triangle_plate(corners), 5.7, seed, 11)
    assert_covers_the_plane(net, seed, 11, within)


def test_seed_on_a_crease():
    """On a flat crease bent at a right angle the sheet is one plane folded: from on the crease as from beside it."""
    mesh = wing_spar(lambda t: 0 * t, lambda t: 0 * t, np.array([0.0, 37, 90, 160]), 100, 80)
    on = meshdrape.drape(mesh.mould(), meshdrape.Fabric(7.0), (0, 73, 0), (0.3, 1, 0))
    unfolded = planar_lattice(on, (0, 73, 0), np.arctan2(1, 0.3))
    # the spar hangs straight down from x = 0
    x, y = unfolded[..., 0], unfolded[..., 1]
    folded = np.stack([np.maximum(x, 0), y, np.minimum(x, 0)], axis=-1)
    here = on.node_status == NodeStatus.PLACED
    assert np.array_equal(here, (x <= 100) & (x >= -80) & (y >= 0) & (y <= 160))
    assert on.node_position[here] == pytest.approx(folded[here], abs=1e-8)
    assert np.nanmax(np.abs(shear_deg(on))) < 1e-7


def test_developable_mould_keeps_unsheared_past_its_border():
    """Creases and rulings go on over the extension, so that cells across the border have no shear either."""
    for mesh, seed, direction in (
        (cylinder(n=20), (500, 0, 0), (0, 0.6, 0.8)), (cone(n=40), (430, 10, 930), (0.4, 0.5, 0.6)),
    ):  # fmt: skip
        mould = mesh.mould()
        seed = mould.surface.closest_point(seed)[0].position(mould.surface)
        measures = meshdrape.measure(meshdrape.drape(mould, meshdrape.Fabric(60.0), seed, direction))
        assert measures.n_cells > 300
        assert np.degrees(measures.max_shear) < 1e-6


@pytest.mark.parametrize(
    ("mesh", "seed", "direction"),
    [
        (hypar(1.0, 0.4, 40), (-400, -400, 160), (1, 0, -0.4)),
        (cap(4), (200, 100, 970), (1, 0, 0)),
        (bumpy(0), (-100, -100, 0), (1, 0.01, 0)),
        (bumpy(5), (-100, 3, 0), (0, 1, 0)),
    ],
)
def test_doubly_curved_mould_is_covered_from_its_corner(mesh, seed, direction):
    """Seed in the very corner, start fibres along curved borders: points all over the mould lie under whole cells."""
    mould = mesh.mould()
    seed = mould.surface.closest_point(seed)[0].position(mould.surface)
    size = float(np.linalg.norm(mould.size))
    spacing = size / 50
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), seed, direction)
    measures = meshdrape.measure(net)
    on = net.node_position[net.node_status == NodeStatus.PLACED]
    centres = mould.vertices[mould.triangles].mean(axis=1)
    reach = np.array([np.linalg.norm(on - c, axis=1).min() for c in centres[:: max(1, len(centres) // 400)]])
    # in a whole lattice no place is farther from a node than a cell's half diagonal, sheared by up to 45 degrees
    sheared = np.degrees(np.nanmax(np.abs(measures.cell_shear[measures.cell_touches_mould])))
    assert sheared < 60
    assert reach.max() < 1.1 * spacing


def test_two_parts_the_seeds_is_draped_and_said():
    two = plate().joined(plate().moved(np.eye(3), (0, 0, 500)))
    mould = two.mould()
    for height in (0.0, 500.0):
        net = meshdrape.drape(mould, meshdrape.Fabric(7.0), (3, 5, height), (1, 0.2, 0))
        assert np.nanmax(np.abs(net.node_position[..., 2] - height)) < 1e-9
        assert any("part" in note or "component" in note for note in net.notes)
        assert "2" in " ".join(net.notes)
        # its faces are told in the mould's own numbers
        assert (np.sort(net.surface_face) == np.arange(126) + (126 if height else 0)).all()
    alone = meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0), (3, 5, 0), (1, 0.2, 0))
    assert alone.notes == ()


def test_closed_sphere():
    """Draped as it is: no border, exact edges, an end where the net folds or meets itself, and no node twice."""
    net = meshdrape.drape(icosphere(3).mould(), meshdrape.Fabric(90.0), (0, 0, 1000), (1, 0.2, 0))
    status = net.node_status
    assert (status == NodeStatus.PLACED).sum() > 300
    assert not (status == NodeStatus.OFF_MOULD).any()
    assert meshdrape.audit(net, edges=300).max_relative_error < 1e-9
    assert (status == NodeStatus.FOLDED).any() or (status == NodeStatus.MET_ITSELF).any()
    found = net.node_position[status == NodeStatus.PLACED]
    gap = np.linalg.norm(found[:, None] - found[None], axis=-1)
    gap[np.diag_indices(len(gap))] = np.inf
    # two layers would put nodes of one beside the other's; but sheared cells have short diagonals too
    assert np.median(gap.min(axis=1)) > 0.3 * 90


def test_tube_ends_where_it_meets_itself():
    """Round a tube the cloth comes back to its own start: stopped there, once round and no more."""
    circumference = 24 * 2 * 60 * np.sin(np.pi / 24)
    net = meshdrape.drape(tube(60, 200, 24).mould(), meshdrape.Fabric(9.0), (60, 0, 0), (0, 0.4, 1))
    measures = meshdrape.measure(net)
    area = measures.n_cells * 81.0
    assert (net.node_status == NodeStatus.MET_ITSELF).any()
    # cells at the ends and along the meeting line lie over it in part
    assert 0.8 < area / (200 * circumference) < 1.25
    assert np.degrees(measures.max_shear) < 1e-6


EXTENT = [
    (30.0, 50.0, 20.0, 40.0),
    (0.0, 60.0, 0.0, 35.0),
    (33.0, 0.0, 14.0, 0.0),
    (7.0, 7.0, 7.0, 7.0),
    (0.0, 21.0, 14.0, 14.0),
]


@pytest.mark.parametrize("extent", EXTENT)
def test_extent_bounds_the_cloth(extent):
    """warp-, warp+, weft-, weft+: as many whole spacings as fit; a node on the very edge is kept."""
    net = lay(plate(), 7.0, (3, 5), 20, extent=extent)
    i, j = offsets(net)
    here = placed(net)
    warp_minus, warp_plus, weft_minus, weft_plus = (int(length / 7 + 1e-9) for length in extent)
    assert i[here].min() == -warp_minus
    assert i[here].max() == warp_plus
    assert j[here].min() == -weft_minus
    assert j[here].max() == weft_plus
    whole = (warp_minus + warp_plus + 1) * (weft_minus + weft_plus + 1)
    assert here.sum() == whole
    assert net.node_position[here] == pytest.approx(planar_lattice(net, (3, 5, 0), np.radians(20))[here], abs=1e-9)


def test_extent_bounds_the_cloth_where_generators_end_early():
    """On a swept plate the lattice grows beyond the generators' ends, but never beyond the cloth."""
    net = lay(parallelogram(sweep=2.0), 8.0, (0, 0), 0, extent=(100, 100, 24, 24))
    i, j = offsets(net)
    here = placed(net)
    assert np.abs(i[here]).max() <= 12
    assert np.abs(j[here]).max() <= 3
    larger = lay(parallelogram(sweep=2.0), 8.0, (0, 0), 0)
    again = nodes_at(larger, i, j)
    assert net.node_position[here] == pytest.approx(again[here], abs=1e-9)


@pytest.mark.parametrize("mesh", [bumpy(0), cap(4), cylinder(n=30), parallelogram(), icosphere(3)])
def test_defaults_serve(mesh):
    """No seed, no direction: near the middle, along the longest extent, and most of the mould covered."""
    mould = mesh.mould()
    spacing = float(np.linalg.norm(mould.size)) / 40
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing))
    assert mould.surface.closest_point(net.seed)[1] < 1e-9
    assert net.seed_distance == pytest.approx(0, abs=1e-9)
    assert (net.node_status == NodeStatus.PLACED).sum() > 100
    longest = np.eye(3)[np.argsort(-mould.size)]
    assert np.abs(longest[:2] @ net.direction).max() > 0.8


def test_seed_off_the_mould_is_projected_and_the_distance_told():
    net = meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0), (3, 5, 4.5), (1, 0, 0))
    assert net.seed_distance == pytest.approx(4.5)
    assert net.seed == pytest.approx([3, 5, 0], abs=1e-12)


def torn(seed, size=200.0, n=40):
    """A hilly plate with half of the triangles along its border torn out."""
    mesh = bumpy(seed, size=size, n=n, height=6.0)
    surface = mesh.mould().surface
    rng = np.random.default_rng(seed)
    rim = surface.face_neighbour < 0
    tip = surface.faces[np.arange(len(surface.faces)), (np.argmax(rim, axis=1) + 2) % 3]
    kept = np.ones(len(surface.faces), dtype=bool)
    touched = set()
    for face in np.flatnonzero((rim.sum(axis=1) == 1) & ~surface.border_vertex[tip]):
        if rng.random() < 0.5 and tip[face] not in touched:
            kept[face] = False
            touched.add(tip[face])
    used, triangles = np.unique(surface.faces[kept], return_inverse=True)
    return meshdrape.Mould.from_arrays(surface.vertices[used], triangles.reshape(-1, 3))


@pytest.mark.parametrize("spacing", [2.0, 6.0])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_torn_border_costs_no_cloth(seed, spacing):
    """Notches are filled before the mould is extended: no node is lost for them, and none sheared."""
    mould = torn(seed)
    start = mould.surface.closest_point((3, 5, 0))[0].position(mould.surface)
    whole = meshdrape.drape(bumpy(seed, n=40, height=6.0).mould(), meshdrape.Fabric(spacing), start, (1, 0.3, 0))
    net = meshdrape.drape(mould, meshdrape.Fabric(spacing), start, (1, 0.3, 0))
    assert not any(net.count(status) for status in NodeStatus if status > NodeStatus.OUTSIDE)
    measures = meshdrape.measure(net)
    assert read_off(measures).coverage_fraction > 0.995
    assert measures.max_shear <= meshdrape.measure(whole).max_shear * 1.05 + np.radians(0.2)
    assert meshdrape.audit(net, 300).max_relative_error < 1e-9
