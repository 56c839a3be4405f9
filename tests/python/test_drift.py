"""``benchmarks/run drift``: slopes and their uncertainty, verdicts from made-up numbers, a small run."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.engine import series
from benchmarks.commands.drift import drift as command
from benchmarks.studies.drift import figures as drift_figures
from benchmarks.studies.drift import judge, page
from benchmarks.studies.drift import runs as drift
from benchmarks.engine.lammps_runner import LammpsError

TIME = np.arange(2001.0)


# --- the slope ----------------------------------------------------------------------------------
def test_slope_of_a_line():
    found, uncertainty = judge.slope(TIME, 3e-9 * TIME - 1.0)
    assert found == pytest.approx(3e-9, rel=1e-6)
    assert found != pytest.approx(1.01 * 3e-9, rel=1e-3)
    assert uncertainty < 1e-6 * found


def test_slope_does_not_see_an_oscillation():
    error = np.sin(TIME * 0.7)
    found, uncertainty = judge.slope(TIME, error)
    assert abs(found) < judge.SIGNIFICANT * uncertainty
    found, uncertainty = judge.slope(TIME, error + 1e-3 * TIME)
    assert found == pytest.approx(1e-3, abs=judge.SIGNIFICANT * uncertainty)
    assert abs(found) > judge.SIGNIFICANT * uncertainty


def correlated(rng, memory):
    """Noise of variance 1 whose correlation falls by ``memory`` from sample to sample."""
    noise = np.empty(len(TIME))
    noise[0] = rng.normal()
    for k, kick in enumerate(rng.normal(size=len(TIME) - 1), start=1):
        noise[k] = memory * noise[k - 1] + np.sqrt(1 - memory**2) * kick
    return noise


def independent(error):
    """Standard error of the slope as if all samples were independent."""
    x = TIME - TIME.mean()
    rest = error - np.polyval(np.polyfit(TIME, error, 1), TIME)
    return np.sqrt(rest @ rest / (len(TIME) - 2) / (x @ x))


@pytest.mark.parametrize("memory", [0.0, 0.95])
def test_uncertainty_is_the_scatter_of_repeated_slopes(memory):
    """With correlated noise too, where the textbook formula is far too sure."""
    rng = np.random.default_rng(20251121)
    series_of_noise = [correlated(rng, memory) for _ in range(200)]
    found, told = np.array([judge.slope(TIME, noise) for noise in series_of_noise]).T
    assert np.mean(told) == pytest.approx(np.std(found), rel=0.3)
    naive = np.mean([independent(noise) for noise in series_of_noise])
    assert (naive == pytest.approx(np.std(found), rel=0.3)) == (memory == 0.0)
    significant = np.abs(found) > judge.SIGNIFICANT * told
    assert significant.mean() < 0.03


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="20 samples or more, not 5"):
        judge.slope(TIME[:5], TIME[:5])


# --- one run ------------------------------------------------------------------------------------
def test_judging_a_series():
    total = -2.0 + 1e-6 * TIME + 1e-4 * np.sin(TIME)
    found = judge.judge(TIME, total, kinetic=1.0)
    assert found.slope == pytest.approx(1e-6, rel=1e-2)
    assert found.largest == pytest.approx(np.abs(total + 2.0).max())
    assert found.largest != pytest.approx(1.01 * np.abs(total + 2.0).max())
    assert found.drifts and not found.spoiled
    assert (np.diff(found.largest_so_far) >= 0).all()
    assert found.largest_so_far[-1] == found.largest
    assert judge.judge(TIME, total, kinetic=0.01).spoiled
    stuck = judge.judge(TIME, -2.0 + np.where(TIME > 0, 0.5, 0.0), kinetic=1.0)
    assert stuck.drifts, "an energy that was lost at once has no slope, but it did not hold"


SCENE = drift.Scene("top", "Free asymmetric top", (0.02, 0.2))


def written(run, folder, total, ending):
    """A log of a run with the given total energies."""
    rows = [
        f"{k * run.every} {k * run.every * run.dt:.17g} 0 0 0 0 1 6 {value:.17g} 0"
        for k, value in enumerate(total)
    ]
    text = ["LAMMPS", "Step " + " ".join(list(series.COLUMNS)[1:]), *rows, ending, ""]
    run.job(folder).log.write_text("\n".join(text))


def test_reading_logs(tmp_path):
    run = drift.Run(SCENE, drift.DEFAULT, 0.02, 200_000)
    assert run.every == 100
    total = 7.0 + 1e-9 * np.arange(2001.0)
    written(run, tmp_path, total, "Loop time of 1 on 1 procs")
    found = drift.read_drift(run, tmp_path)
    assert found.slope == pytest.approx(1e-9 / 2.0, rel=1e-3)
    assert found.lost is None
    written(run, tmp_path, total[:5], "ERROR: Variable kerot: Non-numeric variable value")
    found = drift.read_drift(run, tmp_path)
    assert found.lost == pytest.approx(5 * 2.0)
    assert found.drifts and found.spoiled and found.largest == np.inf
    written(run, tmp_path, total[:5], "Loop time of 1 on 1 procs")  # the others were nan
    assert drift.read_drift(run, tmp_path).lost == pytest.approx(4 * 2.0)
    written(run, tmp_path, total[:5], "ERROR: something else")
    with pytest.raises(ValueError, match="something else"):
        drift.read_drift(run, tmp_path)


# --- verdicts -----------------------------------------------------------------------------------
FIRST, HIGH, NVE = (
    next(m for m in drift.METHODS if m.key == key) for key in ("first-5", "second-10", "rigid-nve")
)


def made_up(errors, steps=10_000_000):
    """Results of SCENE: method -> largest errors at its two steps (None: lost); all are linear."""
    results = {}
    for method, values in errors.items():
        for dt, largest in zip(SCENE.dts, values):
            run = drift.Run(SCENE, method, dt, steps)
            if largest is None:
                results[run] = judge.lost(10.0)
            else:
                wave = largest * np.sin(TIME) if method in (drift.NO_SQUISH, NVE) else 0.0
                line = largest * TIME / TIME[-1] if method not in (drift.NO_SQUISH, NVE) else 0.0
                results[run] = judge.judge(TIME, 7.0 + wave + line, kinetic=7.0)
    return results


TYPICAL = {
    drift.DEFAULT: (1e-7, None),
    drift.DEFAULT_COMPENSATED: (1e-8, None),
    HIGH: (1e-10, None),
    drift.NO_SQUISH: (1e-4, 1e-2),
    NVE: (1e-4, 1e-2),
    drift.VERLET: (1e-3, 7.0),
}


def test_verdict_says_who_holds_the_energy():
    winner, default, best, compensated, verlet, calm, spoiled, gone = page.verdict(
        made_up(TYPICAL), SCENE
    )
    assert winner.endswith("`fix gear/quat` at 0.02; NO_SQUISH at 0.2.")
    assert default.endswith("better at 0.02 (1000 times); worse at 0.2.")
    assert "better at 0.02 (1e+06 times)" in best
    assert "better at 0.02 (10 times); equally well (within a factor 2) at 0.2" in compensated
    assert verlet.endswith("worse at 0.02 (10 times), 0.2 (700 times).")
    assert calm == "No drift: fix rigid/nve/small at 0.02, 0.2; fix rigid/nve at 0.02, 0.2."
    assert spoiled.endswith("fix rigid/small at 0.2.")
    assert gone.count("at 0.2") == 3 and "0.02" not in gone


def test_verdict_flips_with_the_numbers():
    flipped = TYPICAL | {
        drift.DEFAULT: (1e-2, 1e-4),
        drift.DEFAULT_COMPENSATED: (1e-2, 1e-4),
        HIGH: (1e-2, 1e-4),
    }
    winner, default, *_, gone = page.verdict(made_up(flipped), SCENE)
    assert winner.endswith("`fix gear/quat` at 0.2; NO_SQUISH at 0.02.")
    assert default.endswith("better at 0.2 (100 times); worse at 0.02 (100 times).")
    assert gone == "Numbers no longer finite: none."
    equal = flipped | {drift.NO_SQUISH: (1e-2, 1e-4), NVE: (1.01e-2, 1e-4)}
    assert page.verdict(made_up(equal), SCENE)[0].endswith("each step: neither at 0.02, 0.2.")


def test_only_methods_that_were_run_are_compared():
    few = {method: TYPICAL[method] for method in (drift.DEFAULT, drift.NO_SQUISH)}
    sentences = page.verdict(made_up(few), SCENE)
    assert not any("compensated" in sentence or "rigid/small" in sentence for sentence in sentences)


def test_account_holds_every_number(tmp_path):
    results = made_up(TYPICAL)
    text = "\n".join(page.markdown(results))
    assert "## Energy over 10 000 000 steps" in text
    assert f"| {drift.DEFAULT.label} | 1.0e-07 | lost, t = 10 |" in text
    assert text.count("| fix rigid/nve/small |") == 2
    slope = replace(results[drift.Run(SCENE, HIGH, 0.02, 10_000_000)], slope=1.01e-12)
    assert page.show_slope(slope).startswith("1.0e-12 ±")
    page.write(tmp_path, results)
    rows = list(csv.DictReader((tmp_path / "drift.csv").open()))
    assert len(rows) == 12
    assert rows[0]["method"] == drift.DEFAULT.label and float(rows[0]["largest"]) == 1e-7
    assert rows[1]["lost"] == "10"
    drift_figures.draw(tmp_path / "drift.png", results)
    assert (tmp_path / "drift.png").stat().st_size > 10_000


def test_methods_of_a_kind_look_alike_and_differ():
    looks = drift_figures.appearance(drift.METHODS)
    assert set(looks) == set(drift.METHODS)
    assert len({look["color"] for look in looks.values()}) == len(drift.METHODS)
    assert looks[drift.DEFAULT]["marker"] == looks[HIGH]["marker"] != looks[FIRST]["marker"]


# --- running ------------------------------------------------------------------------------------
def test_plan():
    runs = drift.planned_runs(10_000_000)
    assert len({run.name for run in runs}) == len(runs) == 2 * 3 * len(drift.METHODS)
    assert all(run.job("x").deck.is_file() and run.every == 5000 for run in runs)


def test_small_run(tmp_path):
    """Real runs: one that is lost is a result, and the high order holds the energy best."""
    scene = drift.Scene("top", "Free asymmetric top", (0.02, 1.0))
    done = []

    class Bar:
        total = 0

        def reset(self, total):
            self.total = total

        update = staticmethod(done.append)

    bar = Bar()
    methods = (drift.DEFAULT, HIGH, drift.NO_SQUISH)
    results = drift.measure(tmp_path, 500, workers=2, progress=bar, scenes=[scene], methods=methods)
    assert sum(done) == bar.total == 500 * 6
    found = {(run.method, run.dt): value for run, value in results.items()}
    assert found[HIGH, 1.0].lost is not None
    assert found[drift.NO_SQUISH, 1.0].lost is None
    errors = [found[method, 0.02].largest for method in (HIGH, drift.DEFAULT, drift.NO_SQUISH)]
    assert errors == sorted(errors) and errors[0] < 1e-9 < 1e-6 < errors[2]
    page.write(tmp_path, results)
    assert "NO_SQUISH at 1" in (tmp_path / "drift.md").read_text()
    assert (tmp_path / "drift.csv").is_file()


def test_other_errors_are_not_results(tmp_path):
    method = replace(drift.DEFAULT, variables={"formulation": "third"})
    with pytest.raises(LammpsError, match="third"):
        drift.measure(tmp_path, 100, scenes=[SCENE], methods=[method])


def test_command_names_what_is_required(tmp_path):
    result = CliRunner().invoke(command, ["--steps", "5"])
    assert result.exit_code == 2 and "100" in result.output
    result = CliRunner().invoke(command, ["--out", str(tmp_path), "--lmp", "/nowhere/lmp"])
    assert result.exit_code == 1 and "name one with --lmp" in result.output
