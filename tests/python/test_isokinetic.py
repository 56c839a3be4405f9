"""``benchmarks/run isokinetic``: statistics, verdicts from made-up numbers, a small run."""

import csv

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.commands.isokinetic import isokinetic as command
from benchmarks.studies.isokinetic import figures, judge, page, runs

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
    results = runs.Results(PLAN)
    for run in runs.drift_runs(PLAN):
        results.kept[run] = kept(0, largest) if run.rescale else kept(1e-3 * run.dt**order)
    for n, run in enumerate(runs.water_runs(PLAN)):
        results.water[run] = water(seed=n, **(of_total if run.method == "total" else {}))
    return results


def missed(results):
    return [row.what.split(",")[0] for row in judge.rows(results) if not row.met]


# --- verdicts -----------------------------------------------------------------------------------
def test_what_is_asked_is_met_by_what_is_right():
    assert missed(made_up()) == []
    assert judge.order(made_up(), "total") == pytest.approx(6.0, abs=1e-3)


@pytest.mark.parametrize(
    "fault, what",
    [
        (dict(order=5.4), ["drift of the kinetic energy"] * 2),
        (dict(largest=1.1e-13), ["kinetic energy over 1 000 steps"] * 2),
        (dict(shift=0.01), ["mean energy of water"]),
        (dict(peak=3.3), ["g(r) of water"]),
    ],
)
def test_what_is_wrong_is_missed(fault, what):
    assert missed(made_up(**fault)) == what


def test_standard_errors_are_those_of_the_mean():
    rng = np.random.default_rng(7)
    means = [judge.mean_of_blocks(rng.normal(size=12)) for _ in range(4000)]
    z = np.array([mean.value / mean.error for mean in means])
    assert means[0].freedoms == 11
    assert np.var(z) == pytest.approx(11 / 9, rel=0.1)  # of Student's t
    one, other = (judge.Mean(np.array(0.0), np.array(1.0), 10) for _ in range(2))
    assert judge.allowed(one, other, 1) == pytest.approx(2.845, abs=1e-3)  # of a printed table
    assert judge.allowed(one, other, 50) > judge.allowed(one, other, 5)
    with pytest.raises(ValueError, match="too few"):
        judge.mean_of_blocks([1.0, 2.0])


def test_the_first_sample_is_no_part_of_a_block():
    assert judge.blocks_of([100.0, 1.0, 3.0, 5.0, 7.0], 2).tolist() == [2.0, 6.0]
    with pytest.raises(ValueError, match="too few"):
        judge.blocks_of([1.0, 2.0], 2)


# --- files --------------------------------------------------------------------------------------
def test_a_distribution_is_read_block_by_block(tmp_path):
    file = tmp_path / "rdf"
    file.write_text("# a\n# b\n400 2\n1 0.5 0 0\n2 1.5 0.9 4\n800 2\n1 0.5 0 0\n2 1.5 1.1 4\n")
    r, g = runs.read_distribution(file)
    assert r.tolist() == [0.5, 1.5] and g.tolist() == [[0.0, 0.9], [0.0, 1.1]]
    file.write_text("# nothing\n")
    with pytest.raises(ValueError, match="none"):
        runs.read_distribution(file)


def test_page_tables_and_publication(tmp_path):
    out, results = tmp_path / "out", made_up()
    (out / "logs").mkdir(parents=True)
    (out / "logs" / "log.one").write_text("LAMMPS (22 Jul 2025 - Update 4)\n")
    figures.draw(out / page.PICTURE, results)
    page.write(out, results)
    text = (out / page.PAGE).read_text()
    assert "All 8 demands are met." in text and "LAMMPS (22 Jul 2025 - Update 4)" in text
    assert len(list(csv.DictReader((out / "drift.csv").open()))) == len(results.kept)
    assert "6 are met, 2 not" in page.page_text(out, made_up(order=5.0))
    checkout = tmp_path / "checkout"
    (checkout / "src" / "GEARQUAT").mkdir(parents=True)
    (checkout / "README.md").write_text(
        "<!-- begin: written by `benchmarks/run cases --publish` -->\n<!-- end -->\n"
    )
    page.publish(checkout, out, results)
    published = (checkout / "doc" / page.PAGE).read_text()
    picture = checkout / "doc" / page.FOLDER / page.PICTURE
    assert f"({page.FOLDER}/{page.PICTURE})" in published and picture.stat().st_size > 10_000
    assert CliRunner().invoke(command, ["--quick", "--publish", str(checkout)]).exit_code == 2


# --- a small run --------------------------------------------------------------------------------
def test_a_small_run(lmp_wheel, tmp_path):
    plan = runs.Plan(
        drift_steps=4000, dts=(0.05, 0.1), water_steps=30, every=2, blocks=3,
        seeds=(1,),
    )  # fmt: skip
    done = []
    results = runs.measure(tmp_path, plan, str(lmp_wheel.executable), 1, done.append)
    assert sum(done) <= runs.work(plan)
    for constraint in runs.CONSTRAINTS:
        assert judge.largest(results, runs.DriftRun(constraint, True, 0.1)) < 1e-14
        free = [judge.largest(results, runs.DriftRun(constraint, False, dt)) for dt in plan.dts]
        assert free[0] < 0.1 * free[1] < 1e-2
        mean, scatter = judge.kinetic(results, constraint)
        n = runs.MOLECULES
        freedoms = 6 * n - 4 if constraint == "total" else 6 * n - 5
        assert mean == pytest.approx(freedoms * 0.0019872067 * 300.0 / 2, rel=1e-9)
        assert scatter < 1e-12 * mean
    assert judge.kinetic(results, runs.THERMOSTAT)[1] > 0.1
    assert all(len(one.distribution) == 3 for one in results.water.values())
