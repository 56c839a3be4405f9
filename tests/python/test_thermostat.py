"""Constant temperature: judging of made-up numbers, a small run."""

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.studies import thermostat as runs

PLAN = runs.Plan(models=("spce",), times=(10_000.0,) * 4, blocks=5, seeds=(1, 2))
RIGHT = {"difference": 0.0, "pressure": -100.0, "potential": -46.0}
SCATTER = {"difference": 3.0, "pressure": 300.0, "potential": 0.3}


def made_up(shift=1.0, of_rigid=8.0, **of_ours):
    """Uncorrelated samples about means; rigid's rotation becomes colder with the square of the step.

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
                series[name] += of_rigid * error * (dt / 2.0) ** 2
        time = np.linspace(0.0, PLAN.time(dt), n)
        conserved = 1e-6 * time + 0.01 * rng.normal(size=n)
        found["spce", method, dt, seed] = runs.Run(time, *series.values(), conserved)
    seconds = {("spce", method, dt): [0.003, 0.002] for method in runs.METHODS for dt in PLAN.dts}
    return runs.Results(PLAN, found, seconds)


FINEST, APART = "that at 0.25 fs", "difference of 2 fs of ours and 0.25 fs of `rigid/nvt/small`"
COLDER = "T translation − T rotation, largest deviation from 0 at any step"


def broken(results):
    return [m.what.partition(", ")[2] for m in runs.find(results).measurements if not m.holds]


def test_what_is_right_is_within_the_bounds():
    assert broken(made_up(of_rigid=20.0)) == []


@pytest.mark.parametrize(
    "fault, what",
    [
        (
            dict(pressure=15.0),
            [f"pressure, largest deviation from {FINEST} at any step: ours", f"pressure, {APART}"],
        ),
        (
            dict(potential=-15.0),
            [f"potential energy, largest deviation from {FINEST} at any step: ours", f"potential energy, {APART}"],
        ),
        (dict(of_rigid=0.0), [f"{COLDER}: `rigid/nvt/small`"]),
        (dict(difference=15.0), [f"{COLDER}: ours", f"T translation − T rotation, {APART}"]),
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
    assert "## SPC/E" in text and "| `fix rigid/nvt/small` | 0.25 | 10 |" in text
    assert "8.0 times as long for them as" in text and "These runs do not tell" not in text
    for row in runs.find(made_up(pressure=15.0)).tables["deviations"].rows:
        assert (float(row[2]) > 5.0) == (float(row[3]) > 5.0) == ("pressure" in row[0])


def test_a_small_run(lmp_wheel, tmp_path):
    plan = runs.Plan(
        models=("tip4p2005",),
        dts=(1.0, 2.0),
        times=(120.0, 200.0),
        start=400.0,
        equilibrate=20.0,
        sample=4.0,
        blocks=3,
        seeds=(1,),
        timed_steps=10,
        rounds=2,
    )
    done = []
    results = runs.measure(Lab(tmp_path, str(lmp_wheel.executable), 1, advance=done.append), plan)
    assert sum(done) == pytest.approx(1.0)
    changes = {}
    for (_, method, dt, _), run in results.runs.items():
        assert len(run.time) == 1 + plan.time(dt) / plan.sample
        assert run.potential.mean() == pytest.approx(-46.0, abs=3.0)
        changes[method, dt] = np.abs(run.conserved - run.conserved[0]).max()
    for dt in plan.dts:
        assert changes[runs.OURS, dt] < 0.05 * changes[runs.RIGID, dt]
    assert all(len(seconds) == 2 and min(seconds) > 0.0 for seconds in results.seconds.values())
    finding = runs.find(results)
    assert len(finding.tables["tip4p2005"].rows) == 4
    finding.pictures["tip4p2005"](tmp_path / "averages.png")
    assert (tmp_path / "averages.png").stat().st_size > 10_000
