"""Energy over long runs: slopes and their uncertainty, judging of made-up numbers, a small run."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import linregress

from benchmarks.engine import series
from benchmarks.engine.lab import Lab
from benchmarks.engine.logs import Log
from benchmarks.engine.methods import gear, looks
from benchmarks.engine.page import render
from benchmarks.engine.runner import LammpsError
from benchmarks.engine.statistics import slope
from benchmarks.reference import paper_problem, solvers, splittings
from benchmarks.studies import drift

TIME = np.arange(2001.0)
DEFAULT, HIGH, NO_SQUISH = drift.DEFAULT.label, gear("second", 10).label, drift.NO_SQUISH.label
NVE, VERLET = "fix rigid/nve", drift.VERLET.label


# --- the slope ----------------------------------------------------------------------------------
def test_slope_does_not_see_an_oscillation():
    rate, error = slope(TIME, 3e-9 * TIME - 1.0)
    assert rate == pytest.approx(3e-9, rel=1e-6) and error < 1e-6 * rate
    for expected in (0.0, 1e-3):
        rate, error = slope(TIME, np.sin(TIME * 0.7) + expected * TIME)
        assert abs(rate - expected) < drift.SIGNIFICANT * error
        assert (abs(rate) > drift.SIGNIFICANT * error) == (expected > 0)


def correlated(rng, memory):
    """Noise of variance 1 whose correlation falls by ``memory`` from sample to sample."""
    kicks = np.sqrt(1 - memory**2) * rng.normal(size=len(TIME))
    return lfilter([1.0], [1.0, -memory], kicks, zi=[memory * rng.normal()])[0]


@pytest.mark.parametrize("memory", [0.0, 0.95])
def test_uncertainty_is_the_scatter_of_repeated_slopes(memory):
    """With correlated noise too, where the textbook formula is far too sure."""
    rng = np.random.default_rng(20251121)
    series_of_noise = [correlated(rng, memory) for _ in range(200)]
    found, told = np.array([slope(TIME, noise) for noise in series_of_noise]).T
    assert np.mean(told) == pytest.approx(np.std(found), rel=0.3)
    naive = np.mean([linregress(TIME, noise).stderr for noise in series_of_noise])
    assert (naive == pytest.approx(np.std(found), rel=0.3)) == (memory == 0.0)
    significant = np.abs(found) > drift.SIGNIFICANT * told
    assert significant.mean() < 0.03


def test_too_few_samples_are_refused():
    with pytest.raises(ValueError, match="20 samples or more, not 5"):
        slope(TIME[:5], TIME[:5])


# --- one run ------------------------------------------------------------------------------------
def test_judging_a_series():
    total = -2.0 + 1e-6 * TIME + 1e-4 * np.sin(TIME)
    run = drift.Run(TIME, total, kinetic=1.0)
    assert run.slope[0] == pytest.approx(1e-6, rel=1e-2)
    assert run.largest == pytest.approx(np.abs(total + 2.0).max())
    assert not run.spoiled and drift.show_largest(run) == "2.1e-03"
    assert drift.show_largest(drift.Run(TIME, total, kinetic=0.01)).endswith("*")
    assert not drift.show_slope(run).startswith("(")
    calm = drift.Run(TIME, 1e-4 * np.sin(0.7 * TIME), kinetic=1.0)
    assert drift.show_slope(calm).startswith("(")


def finished(folder, total, error=""):
    """A run of 200 000 steps of 0.02 with the given total energies."""
    rows = [f"{k * 100} {k * 2.0:.17g} 0 0 0 0 1 6 {value:.17g} 0" for k, value in enumerate(total)]
    end = f"ERROR: {error}" if error else "Loop time of 1 on 1 procs"
    header = "Step " + " ".join(list(series.COLUMNS)[1:])
    (folder / "log").write_text("\n".join(["LAMMPS", header, *rows, end, ""]))
    log = Log(folder / "log")
    return SimpleNamespace(log=log, error=error, thermo=log.thermo)


def test_reading_logs(tmp_path):
    total = 7.0 + 1e-9 * np.arange(2001.0)
    run = drift.read(finished(tmp_path, total), 200_000, 2.0)
    assert run.slope[0] == pytest.approx(1e-9 / 2.0, rel=1e-3)
    assert run.lost is None and run.kinetic == 7.0
    run = drift.read(finished(tmp_path, total[:5], "Non-numeric variable value"), 200_000, 2.0)
    assert run.lost == pytest.approx(5 * 2.0) and run.largest == np.inf
    early = np.append(total[:5], np.nan)
    assert drift.read(finished(tmp_path, early), 200_000, 2.0).lost == pytest.approx(4 * 2.0)
    assert drift.read(finished(tmp_path, [], "values can follow"), 200_000, 2.0).lost == 2.0


# --- comparing ----------------------------------------------------------------------------------
def made_up(errors):
    """Results of the top: label -> largest errors at two steps (None: lost)."""
    results = {}
    for label, values in errors.items():
        for dt, largest in zip((0.02, 0.2), values):
            total = 7.0 + (largest or 0.0) * TIME / TIME[-1]
            lost = 10.0 if largest is None else None
            results["top", label, dt] = drift.Run(TIME * dt, total, 7.0, lost)
    return results


TYPICAL = {
    DEFAULT: (1e-7, None),
    drift.DEFAULT_COMPENSATED.label: (1e-8, None),
    HIGH: (1e-10, None),
    NO_SQUISH: (1e-4, 1e-2),
    NVE: (1e-4, 1.01e-2),
    VERLET: (1e-3, 7.0),
}


#: a solver whose error falls a hundredfold at half the time per evaluation, from 0.2 to 0.01
PEERS = {"DOP853": [(x, 1e-5 * 100 ** np.log2(x / 0.0625)) for x in (0.2, 0.01)]}


def test_ratios_say_who_holds_the_energy():
    finding = drift.find(made_up(TYPICAL))
    shown = [" ".join(row[1:]) for row in finding.tables["ratios_top"].rows]
    assert shown == ["1.0e-03 inf", "1.0e-06 inf", "1.0e-01 nan", "1.0e+01 7.0e+02"]
    flipped = drift.find(made_up(TYPICAL | {DEFAULT: (1e-2, 1e-4)}))
    assert flipped.tables["ratios_top"].rows[0][1:] == ["1.0e+02", "1.0e-02"]
    rows = {row[0]: row[1:] for row in finding.tables["largest_top"].rows}
    assert rows[DEFAULT] == ["1.0e-07", "lost, t = 10"] and rows[VERLET] == ["1.0e-03", "7.0e+00*"]
    assert finding.context["steps"] == 2000
    finding = drift.find_all(drift.Results(made_up(TYPICAL), PEERS))
    text = render("drift.md.j2", drift.STUDY, finding, "Somewhere.")
    assert "| DOP853 | – | 1.0e-03 | 1.0e-05 | 1.0e-07 |" in text
    assert f"| {DEFAULT} | 1.0e-07 | lost, t = 10 |" in text and "over 2 000 steps" in text


def test_only_methods_that_were_run_are_compared():
    few = {label: TYPICAL[label] for label in (DEFAULT, NO_SQUISH)}
    rows = drift.find(made_up(few)).tables["ratios_top"].rows
    assert len(rows) == 2 and not any("compensated" in row[0] or VERLET in row[0] for row in rows)


def test_methods_of_a_kind_look_alike_and_differ():
    methods = list(drift.METHODS.values())
    look = looks(methods)
    assert set(look) == set(methods)
    assert len({own["color"] for own in look.values()}) == len(methods)
    second, high, first = gear("second", 6), gear("second", 10), gear("first", 5)
    assert look[second]["marker"] == look[high]["marker"] != look[first]["marker"]


# --- running ------------------------------------------------------------------------------------
def test_small_run(tmp_path):
    """Real runs: one that is lost is a result, and the high order holds the energy best."""
    scenes = {"top": ("Free asymmetric top", (0.02, 1.0))}
    methods = {label: drift.METHODS[label] for label in (DEFAULT, HIGH, NO_SQUISH)}
    done = []
    results = drift.measure(Lab(tmp_path, advance=done.append), scenes, methods, 500)
    assert sum(done) == pytest.approx(1.0)
    assert results["top", HIGH, 1.0].lost is not None
    assert results["top", NO_SQUISH, 1.0].lost is None
    errors = [results["top", label, 0.02].largest for label in (HIGH, DEFAULT, NO_SQUISH)]
    assert errors == sorted(errors) and errors[0] < 1e-9 < 1e-6 < errors[2]
    finding = drift.find(results)
    finding.pictures["drift"](tmp_path / "drift.png")
    assert (tmp_path / "drift.png").stat().st_size > 10_000


def test_errors_at_equal_evaluations():
    rows = [(0.02, 1e-8), (0.2, 1e-4)]
    assert drift.peers.error_at(rows, 0.02 * 10**0.5) == pytest.approx(1e-6, rel=1e-9)
    assert np.isnan(drift.peers.error_at(rows, 0.3)) and np.isnan(drift.peers.error_at(rows, 0.01))
    assert drift.peers.error_at([*rows, (0.4, np.inf)], 0.3) == np.inf


def test_a_splitting_holds_the_energy_and_a_solver_does_not():
    """Test case 1 to t = 200 and 400 at 0.1 per evaluation: the error of RKN6 stays."""
    kept, lost = (
        [work(paper_problem(1), end, *own)[1] for end, own in zip((200.0, 400.0), settings)]
        for work, settings in (
            (splittings.largest_energy_error, [(splittings.SPLITTINGS[1], n) for n in (182, 364)]),
            (solvers.largest_energy_error, [("DOP853", 1e-7)] * 2),
        )
    )
    assert kept[0] == kept[1] < 1e-5
    assert 1e-6 < 1.2 * lost[0] < lost[1]


def test_a_quick_run_of_the_peers(tmp_path, monkeypatch):
    monkeypatch.setattr(drift.peers, "SPACINGS", (0.25, 0.125))
    done = []
    lab = Lab(tmp_path, quick=True, advance=done.append)
    rows = drift.peers.measure(lab, drift.read, drift.is_lost)
    assert sum(done) == pytest.approx(1.0)
    assert set(rows) >= {"DOP853", "LSODA", "RKN4, 6 stages", NO_SQUISH}
    ends = {label: drift.peers.error_at(own, 0.125) for label, own in rows.items()}
    assert ends["RKN6, 11 stages"] < ends[NO_SQUISH] < ends[VERLET]


def test_other_errors_are_not_results(tmp_path):
    scenes, methods = {"top": ("", (0.02,))}, {"third": gear("third", 8)}
    with pytest.raises(LammpsError, match="third"):
        drift.measure(Lab(tmp_path), scenes, methods, 100)
