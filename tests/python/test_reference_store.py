"""The cache of reference states: different entries, memory, disk."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reference import Problem, paper_problem, reference_state, reference_states
from benchmarks.reference import store
from benchmarks.reference.integrators import integrate

LONG = np.longdouble


@pytest.fixture(autouse=True)
def empty_memory(monkeypatch):
    monkeypatch.setattr(store, "_memory", {})


@pytest.fixture
def calls(monkeypatch):
    """Times that were integrated and not taken from the cache."""
    made = []

    def integrate(problem, times, **accuracy):
        made.extend(times)
        return original(problem, times, **accuracy)

    original = store.integrators.integrate
    monkeypatch.setattr(store.integrators, "integrate", integrate)
    return made


def changed(part):
    """Test case 1 with a change in one part that is below double precision."""
    problem = paper_problem(1)
    bodies, start = problem.bodies, problem.start
    if part == "start":
        start = replace(start, center=start.center + LONG("1e-17"))
    if part == "shape":
        bodies = replace(bodies, moments=bodies.moments * (1 + LONG("1e-18")))
    return Problem(problem.name, bodies, problem.field, start)


def test_each_state_is_computed_once(calls):
    problem = paper_problem(1)
    first = reference_states(problem, [1.0, 2.0])
    again = reference_states(paper_problem(1), [2.0, 1.0, 3.0])
    assert calls == [1.0, 2.0, 3.0]
    assert (again[0].center == first[1].center).all() and (again[1].q == first[0].q).all()
    assert (first[1].packed() == integrate(problem, [1.0, 2.0])[1].packed()).all()
    assert first[0].center.dtype == LONG and first[0].double.center.dtype == np.float64


@pytest.mark.parametrize("part", ["start", "shape"])
def test_another_problem_is_another_entry(calls, part):
    for some in (None, part, None):
        reference_state(changed(some), 1.0)
    assert calls == [1.0, 1.0]


def test_disk_keeps_every_digit_and_a_broken_file_is_computed_anew(calls, tmp_path):
    problem, folder = paper_problem(3), tmp_path / "new"
    first = reference_state(problem, 1.0, folder=folder)
    assert (first.packed() != first.double.packed()).any()
    for keep, times in ((None, [1.0]), (100, [1.0, 1.0])):
        (file,) = folder.iterdir()
        file.write_bytes(file.read_bytes()[:keep])
        store._memory.clear()
        again = reference_state(problem, 1.0, folder=folder)
        assert calls == times and (again.packed() == first.packed()).all()
