"""Constant temperature: judging of made-up numbers, a small run."""

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.studies import thermostat as runs

PLAN = runs.Plan(models=("spce",), blocks=5, seeds=(1, 2))
RIGHT = {"difference": 0.0, "pressure": -100.0, "potential": -46.0}
SCATTER = {"difference": 3.0, "pressure": 300.0, "potential": 0.3}


def made_up(shift=1.0, of_rigid=8.0, **of_ours):
    """Uncorrelated samples about means; rigid's translation becomes colder with the square of the step.

    ``of_ours``: a quantity -> by how many standard errors of a mean ours is off at the longest step.
    """
    found, n = {}, 4001
    for k, (method, dt, seed) in enumerate(
        (method, dt, seed) for method in runs.METHODS for dt in PLAN.dts for seed in PLAN.seeds
    ):
        rng = np.random.default_rng(k)
        series = {}
        for name, right in RIGHT.items():
            error = SCATTER[name] / np.sqrt(2 * n)
            series[name] = right + SCATTER[name] * rng.normal(size=n)
            if method == runs.OURS and dt == PLAN.longest:
                series[name] += of_ours.get(name, 0.0) * error
            if method == runs.RIGID and name == "difference":
                series[name] -= of_rigid * error * (dt / 2.0) ** 2
        time = np.linspace(0.0, PLAN.time, n)
        conserved = 1e-6 * time + 0.01 * rng.normal(size=n)
        found["spce", method, dt, seed] = runs.Run(time, *series.values(), conserved, 100.0 / dt)
    return runs.Results(PLAN, found)


def broken(results):
    return [m.what.partition(", ")[2] for m in runs.find(results).measurements if not m.holds]


def test_what_is_right_is_within_the_bounds():
    assert broken(made_up(of_rigid=20.0)) == []


@pytest.mark.parametrize(
    "fault, what",
    [
        (dict(pressure=15.0), ["pressure: ours, by the step", "pressure: ours at the longest step"]),
        (dict(potential=-15.0), ["potential energy: ours, by the step", "potential energy: ours at the longest step"]),
        (dict(of_rigid=0.0), ["temperatures: rigid, by the step"]),
    ],
)
def test_what_is_wrong_is_refused(fault, what):
    assert broken(made_up(**(dict(of_rigid=20.0) | fault))) == what


def test_drift_and_cost():
    results = made_up()
    drift, error = results.drift("spce", runs.OURS, 1.0)
    expected = 1.0 / (runs.BOLTZMANN * runs.TEMPERATURE * runs.FREEDOMS)
    assert drift == pytest.approx(expected, abs=4 * error) and error < 0.1 * expected
    assert runs.cost_ratio(results, "spce") == pytest.approx(8.0)


def test_the_page_shows_what_was_found():
    text = render("thermostat.md.j2", runs.STUDY, runs.find(made_up(of_rigid=20.0)), "Somewhere.")
    assert "## SPC/E" in text and "| `fix rigid/nvt/small` | 0.25 |" in text
    assert "| SPC/E: time to that answer, ratio | 8.0 |" in text


def test_a_small_run(lmp_wheel, tmp_path):
    plan = runs.Plan(
        models=("tip4p2005",), dts=(1.0, 2.0), time=120.0, equilibrate=20.0, sample=4.0, blocks=3, seeds=(1,)
    )
    done = []
    results = runs.measure(Lab(tmp_path, str(lmp_wheel.executable), 1, advance=done.append), plan)
    assert sum(done) == pytest.approx(1.0)
    changes = {}
    for (_, method, dt, _), run in results.runs.items():
        assert len(run.time) == 31 and run.seconds > 0.0
        changes[method, dt] = np.abs(run.conserved - run.conserved[0]).max()
    for dt in plan.dts:
        assert changes[runs.OURS, dt] < 0.05 * changes[runs.RIGID, dt]
    assert runs.find(results).tables["tip4p2005"].rows
