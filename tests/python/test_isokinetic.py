"""Constant kinetic energy: statistics, judging of made-up numbers, a small run."""

import numpy as np
import pytest

from benchmarks.engine import statistics
from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.studies import isokinetic as runs

PLAN = runs.Plan(drift_steps=1000, dts=(0.1, 0.2, 0.4), water_steps=400, every=10, blocks=5)


def kept(rate, largest=None):
    """A kinetic energy that drifts, with noise far below the drift."""
    time = np.linspace(0.0, 100.0, 101)
    noise = 1e-4 * rate * np.random.default_rng(1).normal(size=101)
    error = rate * time + noise if largest is None else largest * (time > 50)
    return runs.Kept(time, error, 2 * error)


def water(shift=0.0, peak=3.0, seed=0, noise=1.0):
    """Uncorrelated samples about a mean, and a g(r) with a peak."""
    rng = np.random.default_rng(seed)
    r = np.linspace(0.05, 7.95, 80)
    g = (r > 2.4) * (1 + (peak - 1) * np.exp(-((r - 2.8) ** 2) / 0.02))
    blocks = g * (1 + 0.01 * rng.normal(size=(PLAN.blocks, 80)))
    potential = -3000 * (1 + shift) + noise * rng.normal(size=41)
    return runs.Water(potential, np.full(41, 385.0), r, blocks)


def made_up(order=6.0, largest=1e-15, **of_total):
    keys = [(constraint, False, dt) for constraint in runs.CONSTRAINTS for dt in PLAN.dts]
    kinetic = {key: kept(1e-3 * key[2] ** order) for key in keys}
    kinetic |= {(of, True, PLAN.rescaled_dt): kept(0, largest) for of in runs.CONSTRAINTS}
    waters = {
        (method, seed): water(seed=n + seed, **(of_total if method == "total" else {}))
        for n, method in enumerate(runs.METHODS)
        for seed in PLAN.seeds
    }
    return runs.Results(PLAN, kinetic, waters)


def broken(results):
    return [m.what.rpartition(": ")[2] for m in runs.find(results).measurements if not m.holds]


# --- judging ------------------------------------------------------------------------------------
def test_what_is_right_is_within_the_bounds():
    assert broken(made_up()) == []
    assert made_up().order("total") == pytest.approx(6.0, abs=1e-3)


@pytest.mark.parametrize(
    "fault, what",
    [
        (dict(order=5.4), ["order of the drift of the kinetic energy"] * 2),
        (dict(largest=1.1e-13), ["largest relative change of the kinetic energy"] * 2),
        (dict(shift=0.01), ["mean energy of water, deviation from the thermostat"]),
        (dict(peak=3.3), ["g(r) of water, largest deviation from the thermostat"]),
    ],
)
def test_what_is_wrong_is_refused(fault, what):
    assert broken(made_up(**fault)) == what


def test_standard_errors_are_those_of_the_mean():
    rng = np.random.default_rng(7)
    means = [statistics.mean_of_blocks(rng.normal(size=12)) for _ in range(4000)]
    z = np.array([mean.value / mean.error for mean in means])
    assert means[0].freedoms == 11
    assert np.var(z) == pytest.approx(11 / 9, rel=0.1)  # of Student's t
    one, other = (statistics.Mean(np.array(0.0), np.array(1.0), 10) for _ in range(2))
    most = statistics.largest_deviation
    assert most(one, other, 1) == pytest.approx(2.845, abs=1e-3)  # of a printed table
    assert most(one, other, 50) > most(one, other, 5)
    with pytest.raises(ValueError, match="too few"):
        statistics.mean_of_blocks([1.0, 2.0])


def test_the_first_sample_is_no_part_of_a_block():
    assert statistics.blocks_of([100.0, 1.0, 3.0, 5.0, 7.0], 2).tolist() == [2.0, 6.0]
    with pytest.raises(ValueError, match="too few"):
        statistics.blocks_of([1.0, 2.0], 2)


def test_the_page_shows_what_was_found():
    text = render("isokinetic.md.j2", runs.STUDY, runs.find(made_up()), "Somewhere.")
    assert "| total: order of the drift of the kinetic energy | 6.00 |" in text
    assert "allow deviations of\nup to 3." in text


# --- files --------------------------------------------------------------------------------------
def test_a_distribution_is_read_block_by_block(tmp_path):
    file = tmp_path / "rdf"
    file.write_text("# a\n# b\n400 2\n1 0.5 0 0\n2 1.5 0.9 4\n800 2\n1 0.5 0 0\n2 1.5 1.1 4\n")
    r, g = runs.read_distribution(file)
    assert r.tolist() == [0.5, 1.5] and g.tolist() == [[0.0, 0.9], [0.0, 1.1]]
    file.write_text("# nothing\n")
    with pytest.raises(ValueError, match="none"):
        runs.read_distribution(file)


# --- a small run --------------------------------------------------------------------------------
def test_a_small_run(lmp_wheel, tmp_path):
    small = {"drift_steps": 4000, "water_steps": 30, "every": 2, "blocks": 3}
    plan = runs.Plan(**small, dts=(0.05, 0.1), seeds=(1,))
    done = []
    lab = Lab(tmp_path, str(lmp_wheel.executable), 1, advance=done.append)
    results = runs.measure(lab, plan)
    assert sum(done) == pytest.approx(1.0)
    for constraint in runs.CONSTRAINTS:
        assert results.kept[constraint, True, 0.1].largest < 1e-14
        free = [results.kept[constraint, False, dt].largest for dt in plan.dts]
        assert free[0] < 0.1 * free[1] < 1e-2
        mean, scatter = results.kinetic(constraint)
        n = runs.MOLECULES
        freedoms = 6 * n - 4 if constraint == "total" else 6 * n - 5
        assert mean == pytest.approx(freedoms * 0.0019872067 * 300.0 / 2, rel=1e-9)
        assert scatter < 1e-12 * mean
    assert results.kinetic(runs.THERMOSTAT)[1] > 0.1
    assert all(len(water.distribution) == 3 for water in results.water.values())
    runs.find(results).pictures["isokinetic"](tmp_path / "isokinetic.png")
    assert (tmp_path / "isokinetic.png").stat().st_size > 10_000
