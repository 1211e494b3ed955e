"""What cannot be draped: each its own exception, one line that names the culprit and the way out."""

import numpy as np
import pytest
from moulds import Mesh, bumpy, plate

import meshdrape
from meshdrape.errors import FabricError, MeshdrapeError, MouldError, NetError, StartError

NAN, INF = float("nan"), float("inf")


def raises_one_line(exception, *words):
    """The exception itself, not another of the family; its message on one line, with every word."""

    class Check:
        def __enter__(self):
            self.context = pytest.raises(exception)
            self.caught = self.context.__enter__()
            return self.caught

        def __exit__(self, *problem):
            suppressed = self.context.__exit__(*problem)
            assert type(self.caught.value) is exception
            assert isinstance(self.caught.value, MeshdrapeError)
            message = str(self.caught.value)
            assert "\n" not in message
            assert len(message) < 400
            for word in words:
                assert word in message, message
            return suppressed

    return Check()


@pytest.mark.parametrize(("keywords", "words"), [
    ({"spacing": 0.0}, ["spacing", "0"]),
    ({"spacing": -3.0}, ["spacing", "-3"]),
    ({"spacing": NAN}, ["spacing", "nan"]),
    ({"spacing": INF}, ["spacing", "inf"]),
    ({"spacing": (5.0, 0.0)}, ["weft", "0"]),
    ({"spacing": (-1.0, 5.0)}, ["warp", "-1"]),
    ({"spacing": (5.0, 5.0, 5.0)}, ["3"]),
    ({"spacing": 5.0, "initial_angle": 0.0}, ["initial angle", "0"]),
    ({"spacing": 5.0, "initial_angle": np.pi}, ["initial angle", "180"]),
    ({"spacing": 5.0, "initial_angle": 90.0}, ["initial angle"]),  # degrees given for radians
    ({"spacing": 5.0, "initial_angle": NAN}, ["initial angle"]),
    ({"spacing": 5.0, "locking_angle": 0.0}, ["locking angle"]),
    ({"spacing": 5.0, "locking_angle": 7.0}, ["locking angle"]),
    ({"spacing": 5.0, "locking_angle": NAN}, ["locking angle"]),
    ({"spacing": "fine"}, ["spacing", "fine", "number"]),
    ({"spacing": None}, ["spacing", "None", "number"]),
    ({"spacing": (5.0, "wide")}, ["spacing", "wide"]),
    ({"spacing": np.array([5.0, 5.0, 5.0])}, ["3"]),
    ({"spacing": 5.0, "initial_angle": "right"}, ["initial angle", "right"]),
    ({"spacing": 5.0, "locking_angle": [0.1]}, ["locking angle", "0.1"]),
])  # fmt: skip
def test_fabric(keywords, words):
    with raises_one_line(FabricError, *words):
        meshdrape.Fabric(**keywords)


def test_fabric_as_given():
    fabric = meshdrape.Fabric((5.0, 3.0), np.radians(60), np.radians(10))
    assert (fabric.warp_spacing, fabric.weft_spacing) == (5.0, 3.0)
    square = meshdrape.Fabric(spacing=4)
    assert (square.warp_spacing, square.weft_spacing) == (4.0, 4.0)
    assert (square.initial_angle, square.locking_angle) == pytest.approx((np.pi / 2, np.radians(7)))
    with pytest.raises(AttributeError):
        square.spacing = 3.0
    # numbers of numpy's come out as Python's: what is written to a file is the same
    of_numpy = meshdrape.Fabric(np.array([5.0, 3.0]), np.float32(1.5), np.float64(0.25))
    assert of_numpy == meshdrape.Fabric((5.0, 3.0), 1.5, 0.25)
    assert {type(v) for v in (*of_numpy.spacing, of_numpy.initial_angle, of_numpy.locking_angle)} == {float}


@pytest.mark.parametrize(("keywords", "exception", "words"), [
    ({"seed": (0, 0, 31.5)}, StartError, ["seed", "31.5", "spacing"]),
    ({"seed": (160, 0, 0)}, StartError, ["seed", "60 mm", "nearest", "100"]),
    ({"seed": (NAN, 0, 0)}, StartError, ["seed"]),
    ({"seed": (INF, 0, 0)}, StartError, ["seed"]),
    ({"seed": (1, 2)}, StartError, ["seed"]),
    ({"seed": (1, 2, 3, 4)}, StartError, ["seed"]),
    ({"direction": (0, 0, 0)}, StartError, ["direction", "zero"]),
    ({"direction": (0, 0, 1)}, StartError, ["direction", "normal"]),
    ({"direction": (0, 0, -5)}, StartError, ["direction", "normal"]),
    ({"direction": (1e-9, 0, 1)}, StartError, ["direction", "normal"]),
    ({"direction": (NAN, 0, 0)}, StartError, ["direction"]),
    ({"direction": (INF, 0, 0)}, StartError, ["direction"]),
    ({"direction": (1, 0)}, StartError, ["direction"]),
    ({"extent": (-1, 10, 10, 10)}, StartError, ["extent", "-1"]),
    ({"extent": (10, 10, 10)}, StartError, ["extent", "four"]),
    ({"extent": (10, 10, 10, NAN)}, StartError, ["extent"]),
    ({"extent": 10}, StartError, ["extent", "10", "four"]),
    ({"extent": ("a", "b", "c", "d")}, StartError, ["extent", "'a'", "numbers"]),
    ({"seed": "here"}, StartError, ["seed", "here", "numbers"]),
    ({"seed": np.array(["a\n"] * 3)}, StartError, ["seed", "numbers"]),
    ({"direction": "north"}, StartError, ["direction", "north", "numbers"]),
    ({"stop_at": "7"}, StartError, ["stop_at", "7", "numbers"]),
    ({"threads": 0}, StartError, ["threads", "0"]),
    ({"threads": -1}, StartError, ["threads", "-1"]),
    ({"threads": 1.5}, StartError, ["threads", "1.5"]),
])  # fmt: skip
def test_start(keywords, exception, words):
    start = {"seed": (0, 0, 0), "direction": (1, 0, 0)} | keywords
    with raises_one_line(exception, *words):
        meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0), **start)


def test_direction_along_the_normal_at_a_vertex():
    mesh = plate()
    with raises_one_line(StartError, "direction", "normal"):
        meshdrape.drape(mesh.mould(), meshdrape.Fabric(7.0), mesh.vertices[37], (0, 0, 1))


def test_seed_within_one_spacing_is_projected_and_farther_is_not():
    mould = plate().mould()
    assert meshdrape.drape(mould, meshdrape.Fabric(7.0), (0, 0, 6.99), (1, 0, 0)).seed_distance == pytest.approx(6.99)
    with raises_one_line(StartError, "7.01"):
        meshdrape.drape(mould, meshdrape.Fabric(7.0), (0, 0, 7.01), (1, 0, 0))


@pytest.mark.parametrize("spacing", [250.0, (5.0, 250.0), 1e9])
def test_spacing_larger_than_the_mould(spacing):
    with raises_one_line(FabricError, "larger than the mould", "244"):
        meshdrape.drape(plate().mould(), meshdrape.Fabric(spacing), (0, 0, 0), (1, 0, 0))


@pytest.mark.parametrize("spacing", [1e-3, 1e-5, 1e-9, 1e-12, (1e-7, 100.0)])
def test_net_that_would_not_fit_in_memory(spacing):
    """Told at once, with the count of nodes, rather than found out by filling the memory."""
    with raises_one_line(NetError, "nodes", "GiB") as caught:
        meshdrape.drape(plate().mould(), meshdrape.Fabric(spacing), (0, 0, 0), (1, 0, 0))
    assert any(len(word.replace(",", "")) > 8 and word.replace(",", "").isdigit() for word in str(caught.value).split())


def test_cloth_bounded_by_its_extent_fits_where_the_mould_would_not():
    net = meshdrape.drape(
        plate().mould(), meshdrape.Fabric(1e-3), (0.2, 0.3, 0), (1, 0, 0), extent=(0.02, 0.02, 0.02, 0.02)
    )
    assert np.count_nonzero(net.node_status <= 1) == 41 * 41


FINE = bumpy(0, n=6)


def spoiled(vertex=None, triangles=None):
    vertices = FINE.vertices.copy()
    if vertex is not None:
        vertices[10] = vertex
    return Mesh(vertices, FINE.triangles if triangles is None else np.concatenate([FINE.triangles, triangles]))


@pytest.mark.parametrize(("mesh", "words"), [
    (spoiled(vertex=(NAN, 0, 0)), ["vertices[10]"]),
    (spoiled(vertex=(0, INF, 0)), ["vertices[10]"]),
    (spoiled(triangles=[[0, 1, 900]]), ["triangles[72]", "900", "49 vertices"]),
    (spoiled(triangles=[[0, 1, -1]]), ["triangles[72]", "-1"]),
    (spoiled(triangles=[[3, 3, 4]]), ["repeated-vertex"]),
    (spoiled(triangles=[FINE.triangles[20]]), ["duplicate"]),
    (spoiled(triangles=[FINE.triangles[20][::-1]]), ["duplicate"]),
    (spoiled(triangles=[[*FINE.triangles[20][:2], 48]]), ["non-manifold"]),
    (Mesh(FINE.vertices, np.concatenate([FINE.triangles[:40], FINE.triangles[40:, ::-1]])), ["reversed"]),
    (Mesh(FINE.vertices, np.empty((0, 3), dtype=int)), ["no triangles"]),
    (Mesh(FINE.vertices[:, :2], FINE.triangles), ["vertices", "(k, 3)"]),
    (Mesh(FINE.vertices, FINE.triangles[:, :2]), ["triangles", "(k, 3)"]),
    (Mesh(FINE.vertices, FINE.triangles.astype(float)), ["integers"]),
])  # fmt: skip
def test_mesh(mesh, words):
    with raises_one_line(MouldError, *words):
        mesh.mould()


def test_arrays_handed_in_are_not_changed_and_not_kept():
    vertices, triangles = plate()
    before = vertices.copy(), triangles.copy()
    mould = meshdrape.Mould.from_arrays(vertices, triangles)
    seed, direction = np.array([3.0, 5.0, 0.0]), np.array([1.0, 0.3, 0.0])
    first = meshdrape.drape(mould, meshdrape.Fabric(7.0), seed, direction)
    assert np.array_equal(vertices, before[0])
    assert np.array_equal(triangles, before[1])
    assert seed.tolist() == [3, 5, 0]
    assert direction.tolist() == [1, 0.3, 0]
    vertices[:] = 0
    again = meshdrape.drape(mould, meshdrape.Fabric(7.0), seed, direction)
    assert np.array_equal(first.node_position, again.node_position, equal_nan=True)
