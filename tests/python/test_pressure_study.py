"""Study of constant pressure: judging of made-up numbers, a small run."""

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.studies import pressure as runs
from benchmarks.studies.pressure.instructions import Instructions

PLAN = runs.Plan(time=10_000.0, seeds=(1, 2), blocks=5)
N, VOLUME = 4001, 300.0


def made_up(drift=0.01, of_box=3.0, shift=0.0, work=-1.0, rigid=5.0 / 6.0, share=1.0, shear=runs.SHEAR):
    """``drift`` of ours; ``shift`` of Pxx in standard errors; ``rigid``: what its pressures all are; ``share`` of zz in
    the energy of the box; ``shear``: the mean of Pxy."""
    water, unit = {}, runs.BOLTZMANN * runs.TEMPERATURE * runs.FREEDOMS * 1e-6
    for k, (method, dt, seed) in enumerate((m, dt, s) for m in runs.METHODS for dt in PLAN.dts for s in PLAN.seeds):
        time = np.linspace(0.0, PLAN.time, N)
        rate = drift if method == runs.OURS else 20.0
        noise = 0.01 * np.random.default_rng(k).normal(size=N)
        water[method, dt, seed] = {"Time": time, "v_conserved": unit * rate * time + noise}
    rng, kt, crystal = np.random.default_rng(7), runs.DUMBBELLS_KT, {}
    for method in (runs.OURS, runs.RIGID):
        columns = {"Volume": np.full(N, VOLUME)}
        for k, name in enumerate(("Pxx", "Pyy", "Pzz")):
            noise = 0.3 * rng.normal(size=N)
            right = runs.TARGETS[k] - kt / VOLUME if method == runs.OURS else rigid
            columns[name] = right + noise + (shift * 0.3 / np.sqrt(N) if method == runs.OURS and k == 0 else 0.0)
            columns[f"f_move[{16 + k}]"] = runs.TARGETS[k] + work * kt / VOLUME + 0.002 * rng.normal(size=N)
        columns["f_move[26]"] = 0.5 * kt * of_box * rng.chisquare(3, N) / 3
        crystal[method] = columns
    means = (*runs.TARGETS, shear, 0.0, 0.0) - kt / VOLUME * np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0])
    crystal[runs.SHEARED] = {f"f_move[{16 + k}]": mean + 0.3 * rng.normal(size=N) for k, mean in enumerate(means)}
    crystal[runs.SHEARED]["Volume"] = np.full(N, VOLUME)
    per_mass = 1.0 / (4 * runs.FEW**3 * runs.PDAMP**2)
    rates = [np.sqrt(per_mass * (share if k == 2 else 1.0)) * rng.normal(size=N) for k in range(3)]
    crystal[runs.SMALL] = {f"f_move[{23 + k}]": rate for k, rate in enumerate(rates)}
    fixes, steps = (8000.0, 5000.0, 4000.0), (100_000.0, 80_000.0, 50_000.0)
    counted = {m: Instructions(f, 23_000.0, s) for m, f, s in zip(runs.METHODS, fixes, steps)}
    return runs.Results(PLAN, water, crystal, counted)


def broken(results):
    return [m.what for m in runs.find(results).measurements if not m.holds]


def test_what_is_right_is_within_the_bounds():
    assert broken(made_up()) == []


@pytest.mark.parametrize(
    "fault, number, what",
    [
        (dict(drift=0.06), 2, "drift of the conserved energy of water at 1 fs, `fix gear/quat`"),
        (dict(drift=-0.06), 2, "drift of the conserved energy of water at 2 fs, `fix gear/quat`"),
        (dict(shift=12.0), 1, "crystal, largest deviation of a component of the pressure: ours"),
        (dict(work=-0.7), 1, "crystal, largest deviation of a mean (P − P₀) V from −kT"),
        (dict(of_box=2.7), 1, "crystal, deviation of the box's kinetic energy from 3 kT/2"),
        (dict(share=1.5), 1, "small crystal, largest deviation of a share of the box from kT/2"),
        (dict(shear=0.35), 1, "crystal under a shear stress, largest deviation of one of six components of the pressure"),
    ],
)
def test_what_is_wrong_is_refused(fault, number, what):
    found = broken(made_up(**fault))
    assert what in found and len(found) == number


def test_drift_and_instructions():
    results = made_up(drift=0.2)
    drift, error = results.drift(runs.OURS, 1.0)
    assert drift == pytest.approx(0.2, abs=4 * error) and error < 0.02
    ratios = {m.what: m.value for m in runs.find(results).measurements if m.what.startswith("instructions")}
    assert list(ratios.values()) == pytest.approx([1.25, 1.6, 2.0, 2.0])


def test_the_page_shows_what_was_found():
    text = render("pressure.md.j2", runs.STUDY, runs.find(made_up()), "Somewhere.")
    assert "| 2 | `fix rigid/npt/small` | +20.0" in text and "| zz | 1.5 | 1.4983 |" in text
    assert "| `fix rigid/npt/small` | 5000 | 23000 | 80000 |" in text


def test_a_small_run(lmp_wheel, tmp_path):
    plan = runs.Plan((2.0,), 80.0, 20.0, 2.0, (1,), 400, 100, 400, 4, 1, 2)
    done = []
    results = runs.measure(Lab(tmp_path, str(lmp_wheel.executable), 1, advance=done.append), plan)
    assert sum(done) == pytest.approx(1.0)
    assert set(results.water) == {(method, 2.0, 1) for method in runs.METHODS}
    change = {method: np.ptp(results.water[method, 2.0, 1]["v_conserved"]) for method in runs.METHODS}
    assert change[runs.OURS] < 0.2 * change[runs.RIGID]
    assert results.pressures(runs.OURS).value == pytest.approx(runs.TARGETS, abs=0.6)
    assert len(runs.find(results).tables["crystal"].rows) == 3
    # all make the same mesh, and forces take most of a step
    meshes = [counted.mesh for counted in results.counted.values()]
    assert meshes == pytest.approx([meshes[0]] * 3, rel=0.01) and meshes[0] > 1000
    assert all(counted.fixes < 0.2 * counted.step for counted in results.counted.values())
