"""Start fibres drawn on the mould."""

import re

import numpy as np
import pytest
from lattice import cells_at, nodes_at, offsets, placed, statuses_at
from moulds import Mesh, bumpy, cube_corner, cylinder, grid, hypar, plate
from rates import orders

import meshdrape
from meshdrape.weave.measures.balance import balance

PLATE = plate(400, 300, (19, 15))


def drape(mesh, spacing=10.0, **options):
    fabric = spacing if isinstance(spacing, meshdrape.Fabric) else meshdrape.Fabric(spacing)
    return meshdrape.drape(mesh.mould(), fabric, **options)


def arc(radius, half_length, n=801, turned=0.0):
    """A circle's arc through the origin that leaves it in the direction `turned`, curved to its left; z = 0."""
    s = np.linspace(-half_length, half_length, n)
    along, left = radius * np.sin(s / radius), radius * (1 - np.cos(s / radius))
    c, d = np.cos(turned), np.sin(turned)
    return np.stack([c * along - d * left, d * along + c * left, 0 * s], axis=1)


def on_arc(radius, s, turned=0.0):
    along, left = radius * np.sin(s / radius), radius * (1 - np.cos(s / radius))
    c, d = np.cos(turned), np.sin(turned)
    return np.stack([c * along - d * left, d * along + c * left, 0 * along], axis=-1)


# --- the plane: a net is the translation surface r(u) + s(v) of its start fibres -------------------------------------

PLANE = {
    "arc and straight": (150.0, None),
    "two arcs": (150.0, -200.0),
    "two arcs that close": (-180.0, -160.0),
}


def plane_errors(spacing, radii):
    """Largest errors: of place, mm, off the drawn fibres and on them; of shear, rad, off them and beside them."""
    warp_radius, weft_radius = radii
    paths = {"warp_path": arc(warp_radius, 110)}
    if weft_radius is not None:
        paths["weft_path"] = arc(weft_radius, 110, turned=np.pi / 2)
    net = drape(PLATE, spacing, seed=(0, 0, 0), **paths)
    i, j = offsets(net)
    u, v = i * spacing, j * spacing
    across = np.stack([0 * v, v, 0 * v], axis=-1) if weft_radius is None else on_arc(weft_radius, v, np.pi / 2)
    expected = on_arc(warp_radius, u) + across
    inside = placed(net) & (np.abs(u) <= 100) & (np.abs(v) <= 100)
    assert inside.sum() > 0.5 * (200 / spacing) ** 2
    off = np.where(inside, np.linalg.norm(net.node_position - expected, axis=-1), 0)
    # at a cell's middle: what the warp has turned less what the weft has
    middle_u, middle_v = u[:-1, :-1] + spacing / 2, v[:-1, :-1] + spacing / 2
    shear = middle_u / warp_radius - (0 if weft_radius is None else middle_v / weft_radius)
    wrong = np.abs(meshdrape.measure(net).cell_shear - shear)
    cells = inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]
    wrong = np.where(cells & np.isfinite(wrong), wrong, 0)
    beside = ((j[:-1, :-1] == 0) | (j[:-1, :-1] == -1)) | ((i[:-1, :-1] == 0) | (i[:-1, :-1] == -1))
    own = (i == 0) | (j == 0)
    return off[~own].max(), off[own].max(), wrong[~beside].max(), wrong[beside].max()


@pytest.mark.parametrize("name", PLANE)
def test_plane_net_is_the_translation_surface_of_both_fibres(name):
    """Nodes of the start fibres to the polyline's own error, all others to second order, as the shear is.

    The cells beside a drawn fibre have an edge whose ends are an arc's, shorter by the square of its turn over 24, and
    the sum of these turns their other sides: first order.
    """
    errors = np.array([plane_errors(spacing, PLANE[name]) for spacing in (20.0, 10.0, 5.0)])
    assert errors[:, 1].max() < 1e-4  # chords of 0.28 mm of arcs of 150 mm
    rate = orders(errors)
    assert (rate[:, 0] > 1.8).all(), errors
    assert (rate[:, 2] > 1.8).all(), errors
    assert (rate[:, 3] > 0.8).all(), errors
    assert errors[-1, 0] < 0.01
    assert np.degrees(errors[-1, 2]) < 0.005
    assert np.degrees(errors[-1, 3]) < 0.12


@pytest.mark.parametrize("angle", [60.0, 110.0])
def test_straight_fibre_crosses_a_drawn_one_at_the_initial_angle(angle):
    """Whatever the cloth's angle, from the curve's tangent, to second order; and the cell at the seed is unsheared."""
    off = []
    for spacing in (20.0, 10.0):
        net = drape(PLATE, meshdrape.Fabric(spacing, np.radians(angle)), seed=(0, 0, 0), warp_path=arc(150, 110))
        weft = nodes_at(net, 0, np.array([3]))[0]
        off.append(abs(np.arctan2(weft[1], weft[0]) - np.radians(angle)))
        assert net.direction == pytest.approx([1, 0, 0], abs=1e-5)
        assert net.warp_direction[net.seed_index] == pytest.approx([1, 0, 0], abs=1e-5)
        around = cells_at(net, meshdrape.measure(net).cell_shear, [[-1, -1], [0, 0]], [[-1, 0], [-1, 0]])
        assert abs(around.mean()) < 1e-3
    assert max(off) < 1e-5


def test_weft_path_is_the_warp_path_seen_from_the_weft():
    """A weft drawn along (i, j) gives the net of a warp drawn so with (i, j) for (j, -i), and the shear its sign."""
    warp = drape(PLATE, seed=(3, -4, 0), warp_path=arc(150, 110))
    weft = drape(PLATE, seed=(3, -4, 0), weft_path=arc(150, 110), direction=(0, -1, 0))
    i, j = np.meshgrid(np.arange(-8, 9), np.arange(-8, 9), indexing="ij")
    assert nodes_at(weft, -j, i) == pytest.approx(nodes_at(warp, i, j), abs=1e-9, nan_ok=True)
    one = cells_at(warp, meshdrape.measure(warp).cell_shear, i, j)
    other = cells_at(weft, meshdrape.measure(weft).cell_shear, -j - 1, i)
    assert np.isfinite(one).sum() > 100
    assert other == pytest.approx(-one, abs=1e-9, nan_ok=True)


def test_direction_says_which_way_the_net_counts_and_the_order_of_points_if_it_is_silent():
    curve = arc(150, 110)
    there = drape(PLATE, warp_path=curve)
    back = drape(PLATE, warp_path=curve[::-1])
    told = drape(PLATE, warp_path=curve[::-1], direction=(1, 0.3, 0))
    i, j = np.meshgrid(np.arange(-6, 7), np.arange(-6, 7), indexing="ij")
    assert nodes_at(told, i, j) == pytest.approx(nodes_at(there, i, j), abs=1e-9)
    assert nodes_at(back, -i, -j) == pytest.approx(nodes_at(there, i, j), abs=1e-9)


# --- any mould -------------------------------------------------------------------------------------------------------


def height_on(mesh, x, y):
    """z of a mould that is a graph over x and y."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    u, v, w = b - a, c - a, np.array([x, y]) - a[:, :2]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    s = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / double
    t = (u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0]) / double
    k = int(np.argmax(np.minimum(np.minimum(s, t), 1 - s - t)))
    return a[k, 2] + s[k] * u[k, 2] + t[k] * v[k, 2]


def wavy(mesh, amplitude=15.0, period=30.0, n=60, along=0):
    s = np.linspace(-85, 85, n)
    points = np.stack([s, amplitude * np.sin(s / period)], axis=1)
    points = points if along == 0 else points[:, ::-1]
    return np.array([[x, y, height_on(mesh, x, y)] for x, y in points])


HILLS = bumpy(2)


@pytest.mark.parametrize("mesh", [HILLS, hypar(1.0, 1.0, 24, 100.0), cylinder(80, n=60, half_length=150)])
def test_geodesic_given_as_points_gives_the_geodesic_net(mesh):
    """Nodes of the geodesic generator as the path: the net is the same, to the round-off of its points."""
    centre = mesh.mould().surface.closest_point([80.0, 5, 3] if mesh is not HILLS else [4.0, 3, 0])[0]
    seed = centre.position(mesh.mould().surface)
    direct = drape(mesh, 10.0, seed=seed, direction=(0.2, 1, 0.3))
    i = np.arange(-30, 31)
    fibre = nodes_at(direct, i, 0)
    on = statuses_at(direct, i, 0) == meshdrape.NodeStatus.PLACED
    drawn = drape(mesh, 10.0, seed=seed, warp_path=fibre[on], direction=(0.2, 1, 0.3))
    k, m = np.meshgrid(np.arange(-7, 8), np.arange(-7, 8), indexing="ij")
    there = nodes_at(direct, k, m)
    both = np.isfinite(there[..., 0])
    assert both.sum() > 60
    assert np.linalg.norm(nodes_at(drawn, k, m) - there, axis=-1)[both].max() < 1e-6


def test_nodes_lie_one_spacing_apart_along_the_curve():
    """By the arc length of the curve on the mould, measured with chords a thousandth of a spacing long."""
    curve = wavy(HILLS)
    net = drape(HILLS, 8.0, warp_path=curve)
    surface = HILLS.mould().surface
    from meshdrape.weave.start.path import draw

    path = draw(surface, curve, 8.0, "curve")
    middle = path.length / 2
    for k in range(-8, 9):
        expected = path.point_at(middle + 8.0 * k).position(surface)
        assert nodes_at(net, k, 0) == pytest.approx(expected, abs=1e-9)
    fine = np.array([path.point_at(s).position(surface) for s in np.linspace(0, path.length, 40_001)])
    assert np.linalg.norm(np.diff(fine, axis=0), axis=1).sum() == pytest.approx(path.length, rel=1e-5)
    # the curve runs through every point it was given
    for point in curve:
        assert path.nearest(point)[1] < 1e-9


@pytest.mark.parametrize("both", [False, True])
def test_edges_off_a_drawn_fibre_are_exact_and_its_own_are_told_apart(both):
    paths = {"warp_path": wavy(HILLS)} | ({"weft_path": wavy(HILLS, along=1)} if both else {})
    net = drape(HILLS, 8.0, **paths)
    found = meshdrape.audit(net, edges=10**6)
    assert found.max_relative_error < 1e-9
    assert found.n_arcs > (20 if both else 10)
    assert found.n_edges + found.n_arcs + found.n_through_vertex + found.n_skipped == found.n_population


def test_engines_agree_on_drawn_fibres():
    options = {"warp_path": wavy(HILLS), "weft_path": wavy(HILLS, along=1), "extent": (25, 25, 25, 25)}
    fast, reference = (drape(HILLS, 8.0, engine=engine, **options) for engine in ("fast", "libigl"))
    assert np.array_equal(fast.node_status, reference.node_status)
    assert placed(fast).sum() > 30
    assert np.nanmax(np.linalg.norm(fast.node_position - reference.node_position, axis=-1)) < 1e-8


def test_net_does_not_depend_on_threads_nor_on_the_sense_of_the_weft():
    paths = {"warp_path": wavy(HILLS), "weft_path": wavy(HILLS, along=1)}
    one = drape(HILLS, 4.0, threads=1, **paths)
    two = drape(HILLS, 4.0, threads=2, **paths)
    assert np.array_equal(one.node_position, two.node_position, equal_nan=True)
    other = drape(HILLS, 4.0, warp_path=paths["warp_path"], weft_path=paths["weft_path"][::-1])
    assert one.node_position == pytest.approx(other.node_position, abs=1e-9, nan_ok=True)


def test_large_net_is_scouted_with_its_path():
    """Above the size from which a coarse net goes first; nodes that both sizes have are near each other."""
    size = plate(4000, 3000, (9, 7))
    curve = 10 * arc(150, 110)
    fine, coarse = drape(size, 8.0, warp_path=curve), drape(size, 40.0, warp_path=curve)
    assert fine.count(meshdrape.NodeStatus.PLACED) > 150_000
    i, j = np.meshgrid(np.arange(-20, 21), np.arange(-20, 21), indexing="ij")
    gap = np.linalg.norm(nodes_at(fine, 5 * i, 5 * j) - nodes_at(coarse, i, j), axis=-1)
    assert np.nanmax(gap) < 1.0
    assert np.isfinite(gap).sum() > 1000


# --- places where a curve is hard to follow --------------------------------------------------------------------------

SIDE = np.linspace(-100, 100, 9)
GRID = grid(SIDE, SIDE, lambda x, y: (x, y, 0))  # squares of 25 mm cut along (1, 1)
STRAIGHT = {
    "along edges": ([-100, 0, 0], [100, 0, 0]),
    "along edges, through every vertex": [[x, 25, 0] for x in SIDE],
    "along diagonals": ([-100, -100, 0], [100, 100, 0]),
    "along the border": ([-100, -100, 0], [100, -100, 0]),
    "into the corner": ([0, 0, 0], [100, 100, 0]),
    "short, from vertex to vertex": ([0, 0, 0], [25, 0, 0]),
    "short, inside a triangle": ([3, 1, 0], [9, 4, 0]),
    "points repeated": ([-50, 3, 0], [-50, 3, 0], [20, 3, 0], [20, 3, 0], [20, 3, 0]),
}


@pytest.mark.parametrize("name", STRAIGHT)
@pytest.mark.parametrize("seed", [None, "begin", "end"])
def test_straight_line_on_a_plane_gives_the_plane_lattice(name, seed):
    points = np.array(STRAIGHT[name], dtype=float)
    where = {None: None, "begin": points[0], "end": points[-1]}[seed]
    net = drape(GRID, 10.0, warp_path=points, seed=where)
    along = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
    left = np.array([-along[1], along[0], 0])
    i, j = offsets(net)
    start = (points[0] + points[-1]) / 2 if where is None else where
    expected = start + 10.0 * (i[..., None] * along + j[..., None] * left)
    here = placed(net)
    assert here.sum() > 200
    assert np.abs(net.node_position - expected)[here].max() < 1e-9
    measures = meshdrape.measure(net)
    assert np.abs(measures.cell_shear[measures.cell_touches_mould]).max() < 1e-9
    assert meshdrape.audit(net).max_relative_error < 1e-9


@pytest.mark.parametrize("angle", [90, 60])
def test_kink_at_the_seed_and_elsewhere(angle):
    """In the plane cells beyond a kink are turned by it, those on each side of the seed by their side's."""
    c, s = np.cos(0.3), np.sin(0.3)
    points = np.array([[-90 * c, -90 * s, 0], [0, 0, 0], [50 * c, -50 * s, 0], [90, -50 * s, 0]])
    net = drape(GRID, meshdrape.Fabric(10.0, np.radians(angle)), seed=(0, 0, 0), warp_path=points)
    assert balance(meshdrape.measure(net)).worst < 1e-6 + 1.5 * (1 - np.cos(0.15))
    shear = meshdrape.measure(net).cell_shear
    assert cells_at(net, shear, -3, 2) == pytest.approx(0.3, abs=1e-9)
    assert cells_at(net, shear, 3, 2) == pytest.approx(-0.3, abs=1e-9)
    assert cells_at(net, shear, 6, 2) == pytest.approx(0.0, abs=1e-9)
    assert net.direction == pytest.approx([1, 0, 0], abs=1e-9)


@pytest.mark.parametrize("off", [0.0, 2.5, 7.5, 10.0, 13.0])
@pytest.mark.parametrize("kink", [0.3, -0.6])
def test_a_straight_fibre_crosses_a_kinked_one_midway_between_its_first_edges(off, kink):
    """A kink less than a spacing from the seed turns it by half of what it turns the first edge by; others do not."""
    beyond = 80.0 * np.array([np.cos(kink), np.sin(kink), 0.0])
    path = np.array([[-80.0, 0.0, 0.0], [off, 0.0, 0.0], np.array([off, 0.0, 0.0]) + beyond])
    net = drape(PLATE, 10.0, seed=(0, 0, 0), warp_path=path)
    rest = max(10.0 - off, 0.0)
    first_edge = np.arctan2(rest * np.sin(kink), 10.0 - rest + rest * np.cos(kink))
    weft = np.pi / 2 + 0.5 * first_edge
    expected = 10.0 * np.array([np.cos(weft), np.sin(weft), 0.0])
    for step in (1, -1, 4, -4):
        assert nodes_at(net, 0, step) == pytest.approx(step * expected, abs=1e-9)


def test_across_a_crease_and_bent_on_it():
    """Over a cube's edge: straight through a point of it, then bent there; the net unfolds to the plane's."""
    mesh = cube_corner(300, 3)
    flat = grid(np.linspace(-300, 300, 7), np.linspace(0, 300, 4), lambda x, y: (x, y, 0))
    paths = {
        "warp_path": [[-100, 160, 0], [0, 180, 0], [100, 150, 0]],
        "seed": (40, 168, 0),
        "extent": (120, 60, 60, 60),
    }
    folded = {
        "warp_path": [[0, 160, 100], [0, 180, 0], [100, 150, 0]], "seed": (40, 168, 0), "extent": (120, 60, 60, 60)
    }  # fmt: skip
    plain, bent = drape(flat, **paths), drape(mesh, **folded)
    x, y, z = np.moveaxis(bent.node_position, -1, 0)
    unfolded = np.stack([x - z, y, 0 * x], axis=-1)
    assert placed(bent).sum() > 200
    assert plain.node_position == pytest.approx(unfolded, abs=1e-9)
    assert meshdrape.measure(plain).cell_shear == pytest.approx(meshdrape.measure(bent).cell_shear, abs=1e-9)


@pytest.mark.parametrize("path", [
    [[100, 0, 0], [0, 0, 0], [0, 0, 100]], [[100, 100, 0], [0, 0, 0]], [[100, 100, 0], [0, 0, 0], [0, 60, 60]],
])  # fmt: skip
def test_through_a_cubes_vertex_with_the_seed_on_it(path):
    """The quadrants at the seed share the star of 3 pi / 2 as the curve and the weft cut it; no curvature elsewhere."""
    net = drape(cube_corner(200, 3), 10.0, warp_path=path, seed=(0, 0, 0))
    measures = meshdrape.measure(net)
    assert net.start.sector.sum() == pytest.approx(1.5 * np.pi, abs=1e-9)
    assert balance(measures).worst < 1e-9
    assert meshdrape.audit(net).max_relative_error < 1e-9


def test_two_paths_cross_at_the_angle_drawn():
    a, b = np.radians(20), np.radians(75)
    warp = [[-80 * np.cos(a), -80 * np.sin(a), 0], [80 * np.cos(a), 80 * np.sin(a), 0]]
    weft = [[80 * np.cos(b), 80 * np.sin(b), 0], [-80 * np.cos(b), -80 * np.sin(b), 0]]
    net = drape(GRID, 10.0, warp_path=warp, weft_path=weft)
    shear = meshdrape.measure(net).cell_shear
    assert net.seed == pytest.approx([0, 0, 0], abs=1e-9)
    assert np.nanmax(np.abs(shear - (np.pi / 2 - (b - a)))) < 1e-9
    i, j = offsets(net)
    expected = 10.0 * (i[..., None] * [np.cos(a), np.sin(a), 0] + j[..., None] * [np.cos(b), np.sin(b), 0])
    assert np.abs(net.node_position - expected)[placed(net)].max() < 1e-9


def test_of_several_crossings_the_one_at_the_seed():
    zigzag = [[-80, -20, 0], [-40, 20, 0], [0, -20, 0], [40, 20, 0], [80, -20, 0]]
    level = [[-90, 0, 0], [90, 0, 0]]
    for seed, x in (((55, 10, 0), 60), ((-25, 0, 0), -20), (None, -20)):
        net = drape(GRID, 10.0, warp_path=level, weft_path=zigzag, seed=seed)
        assert net.seed == pytest.approx([x, 0, 0], abs=1e-9) or (
            seed is None and abs(net.seed[0]) == pytest.approx(20)
        )


def test_seed_beside_the_path_is_moved_onto_it_and_that_is_said():
    net = drape(GRID, 10.0, warp_path=[[-80, 3, 0], [80, 3, 0]], seed=(20, 8, 0))
    assert net.seed == pytest.approx([20, 3, 0], abs=1e-9)
    assert any("moved 5 mm onto" in note for note in net.notes)


def test_net_keeps_what_was_drawn_and_can_be_laid_again():
    curve = wavy(HILLS)
    net = drape(HILLS, 8.0, warp_path=curve, seed=(20, 5, 10))
    assert np.array_equal(net.start_fibres.warp_path, curve)
    again = meshdrape.drape(
        net.mould, net.fabric, net.seed, net.direction, warp_path=net.start_fibres.warp_path,
    )  # fmt: skip
    assert again.node_position == pytest.approx(net.node_position, abs=1e-9, nan_ok=True)
    assert not drape(HILLS, 8.0).start_fibres


# --- what cannot be --------------------------------------------------------------------------------------------------

LEVEL = [[-50, 0, 0], [50, 0, 0]]
REFUSED = {
    "a point off the mould": (
        {"warp_path": [[0, 0, 0], [10, 0, 0], [20, 0, 25]]}, "point 3 at (20, 0, 25) lies 25 mm from the mould",
    ),
    "not finite": ({"weft_path": [[0, 0, 0], [10, np.nan, 0]]}, "weft_path: point 2 is [10.0, nan, 0.0]"),
    "one point": ({"warp_path": [[0, 0, 0]]}, "warp_path has the shape (1, 3)"),
    "in the plane": ({"warp_path": [[0, 0], [1, 1]]}, "warp_path has the shape (2, 2)"),
    "no numbers": ({"warp_path": [["a", "b", "c"]] * 2}, "warp_path has the shape (0,)"),
    "all one point": ({"warp_path": [[1, 2, 0]] * 4}, "no two of them apart"),
    "two that do not cross": (
        {"warp_path": LEVEL, "weft_path": [[-50, 7, 0], [50, 7, 0]]}, "do not cross: they are 7 mm apart",
    ),
    "two that run along each other": ({"warp_path": LEVEL, "weft_path": LEVEL}, "run along each other"),
    "path and turn": ({"warp_path": LEVEL, "warp_turn": 0.1}, "both warp_turn and warp_path"),
    "direction of nothing": ({"warp_path": LEVEL, "direction": (0, 0, 0)}, "direction (0, 0, 0)"),
    "seed far off": ({"warp_path": LEVEL, "seed": (0, 0, 50)}, "seed (0, 0, 50) lies 50 mm"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_one_line(name):
    options, message = REFUSED[name]
    with pytest.raises(meshdrape.MeshdrapeError, match=re.escape(message)) as caught:
        drape(GRID, 10.0, **options)
    assert "\n" not in str(caught.value)


def test_curve_over_two_parts_is_refused():
    apart = GRID.joined(Mesh(GRID.vertices + np.array([250.0, 0, 0]), GRID.triangles))
    with pytest.raises(meshdrape.MeshdrapeError, match=r"point 3 at .* from the part of the mould"):
        drape(apart, 10.0, warp_path=[[0, 0, 0], [90, 0, 0], [160, 0, 0]])
