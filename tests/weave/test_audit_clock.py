"""How many edges an audit measures: its clock counts measuring alone, and a hundred whatever it says."""

import importlib

import pytest
from moulds import plate

import meshdrape

# the package has a function of this name
audit_module = importlib.import_module("meshdrape.weave.recheck.edges")
LOADING, EDGE = 40.0, 1e-3  # s, of the first question ever, and of every one


@pytest.fixture(scope="module")
def net():
    found = meshdrape.drape(plate().mould(), meshdrape.Fabric(7.0))
    assert meshdrape.audit(found, 1).n_population > 500
    return found


class Machine:
    """A clock that goes on when an edge is measured, and then only."""

    def __init__(self, seconds: float, found: float = 7.0, moved: float = 0.0) -> None:
        self.seconds, self.found, self.moved = seconds, found, moved
        self.now, self.asked = 0.0, 0

    def surface_distance(self, surface, tail, head, bound):
        self.now += self.seconds + LOADING * (not self.asked)
        self.asked += 1
        return self.found, self.moved

    def perf_counter(self) -> float:
        return self.now


@pytest.fixture
def on(monkeypatch):
    def put(machine: Machine) -> Machine:
        monkeypatch.setattr(audit_module, "surface_distance", machine.surface_distance)
        monkeypatch.setattr(audit_module, "time", machine)
        return machine

    return put


def test_loading_is_not_measuring(net, on):
    """Whatever libigl and the kernels take to load: the budget is that of measuring."""
    on(Machine(EDGE))
    found = meshdrape.audit(net, 500, seconds=0.25)
    assert found.n_edges == pytest.approx(250, abs=1)
    assert found.seconds == pytest.approx(EDGE * found.n_edges)


@pytest.mark.parametrize(("edges", "measured"), [(10, 10), (100, 100), (500, 100)])
def test_a_hundred_edges_on_the_slowest_machine(net, on, edges, measured):
    on(Machine(60.0))
    assert meshdrape.audit(net, edges, seconds=0.5).n_edges == measured


def test_what_cannot_be_measured_comes_to_an_end(net, on):
    machine = on(Machine(60.0, moved=1.0))
    found = meshdrape.audit(net, 500, seconds=0.5)
    assert (found.n_edges, found.n_skipped, machine.asked) == (0, 200, 201)


def test_without_a_limit_all_are_measured(net, on):
    on(Machine(60.0))
    assert meshdrape.audit(net, 500).n_edges == 500


def test_no_edges_are_no_question(net, on):
    machine = on(Machine(EDGE))
    assert audit_module.audit_edges(net, [], 0, 1.0).n_edges == machine.asked == 0


def test_first_edges_are_the_same_whatever_the_time(net):
    """A shorter audit is the beginning of a longer one."""
    short, long = (meshdrape.audit(net, 300, seconds=seconds) for seconds in (0.0, float("inf")))
    assert 100 <= short.n_edges < long.n_edges
    assert short.max_relative_error <= long.max_relative_error
