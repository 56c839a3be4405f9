"""The study liquids: quantities of made-up samples, what must be refused, LAMMPS runs of few molecules."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine import EXAMPLES, Lab
from benchmarks.engine.page import render
from benchmarks.studies import liquids as study
from benchmarks.studies.liquids import plan, quantities, runs
from benchmarks.studies.liquids.plan import LONG_STEPS, MAIN, NVE_SMALL, SCENES, SECOND, SPCE

TIME = 30.0 * np.arange(667)


# --- quantities -----------------------------------------------------------------------------------
def made_up(rate=0.0, liquid=SPCE, ratio=1.0, seed=1, time=TIME, duration=TIME[-1]):
    """A Run with noise whose energy drifts at ``rate``, and whose rotation is warmer by ``ratio``."""
    noise = np.random.default_rng(seed).normal(size=(4, len(time)))
    total = -9000.0 + rate * quantities.unit(liquid) * time + 0.02 * noise[0]
    half = quantities.BOLTZMANN * liquid.temperature / 2
    kinetic = [n * half * (1 + 0.05 * x) for n, x in zip(liquid.freedoms, noise[1:])]
    pressure = 100 + 500 * noise[3]
    return runs.Run(time, total, kinetic[0], ratio * kinetic[1], pressure, duration, 3e-3)


def test_drift_is_one_kt_per_nanosecond_and_freedom():
    """216 rigid molecules have 1293 degrees of freedom; 1 ns has a million fs."""
    gained = 1293 * 0.0019872067 * 298.15  # kcal/mol
    run = replace(made_up(), total=gained * TIME / 1e6)
    assert quantities.drift(run, SPCE)[0] == pytest.approx(1.0, rel=1e-9)
    linear = replace(SPCE, axes=2)
    assert quantities.drift(run, linear)[0] == pytest.approx(1293 / 1077, rel=1e-9)


def test_fluctuation_leaves_out_the_drift():
    assert quantities.fluctuation(made_up(5.0)) == pytest.approx(0.02, rel=0.1)
    assert quantities.fluctuation(made_up(5.0)) == pytest.approx(quantities.fluctuation(made_up()))


@pytest.mark.parametrize("liquid", plan.LIQUIDS, ids=lambda liquid: liquid.key)
def test_one_percent_of_rotation_is_seen(liquid):
    """The temperatures are those of equipartition, and cold rotation counts as such."""
    for ratio in (1.0, 0.99):
        mean = quantities.cooler(made_up(liquid=liquid, ratio=ratio), liquid)
        expected = (ratio - 1) * liquid.temperature
        assert abs(mean.value - expected) < 4 * mean.error < 0.01 * liquid.temperature


# --- what is found --------------------------------------------------------------------------------
def results(rates=(), lost=()):
    """Results of all runs; ``rates``: (scene, method, step) -> drift; ``lost``: such keys."""
    rates, seed, found = dict(rates), 0, {}
    for scene in SCENES:
        for method in scene.methods:
            for dt in scene.liquid.steps:
                key, seed = (scene.key, method.key, dt), seed + 1
                time = TIME[:9] if key in lost else TIME
                found[key] = made_up(rates.get(key, 0.0), scene.liquid, seed=seed, time=time)
    floors = {
        (forces.text, method.key): made_up(seed=k)
        for k, (forces, methods) in enumerate(plan.FLOORS.items())
        for method in methods
    }
    return runs.Results(plan.Plan(), found, floors)


def refused(data):
    """What the measurements that do not hold are about."""
    return [m.what for m in study.find(data).measurements if not m.holds]


def test_drifts_are_bounded():
    """At 2 fs by what is noise of both, at 2.5 fs by a tenth; at 3 fs only the loss is refused."""
    methods = {1.0: SECOND, 2.0: SECOND, 2.5: LONG_STEPS, 3.0: LONG_STEPS}
    keys = {dt: (MAIN.key, method.key, dt) for dt, method in methods.items()}
    good = results({keys[2.5]: 0.09, keys[3.0]: 5.0})
    error = quantities.drift(good.runs[keys[2.0]], SPCE)[1]
    assert refused(good) == []
    assert [w.count("2 fs") for w in refused(results({keys[2.0]: 8 * error}))] == [1]
    assert [w.count("2.5 fs") for w in refused(results({keys[2.5]: -0.11}))] == [1]
    assert [w.count("time without loss") for w in refused(results(lost=[keys[3.0]]))] == [1]


def test_error_bars_are_judged_by_what_does_not_drift():
    ratio = study.calibration(results()).value
    assert 0.6 < ratio < 1.6
    keys = [(scene.key, NVE_SMALL.key, dt) for scene in SCENES for dt in scene.liquid.steps]
    assert study.calibration(results(dict.fromkeys(keys, 0.5))).value > 3 * ratio


def test_page_and_pictures(tmp_path):
    data = results({(MAIN.key, SECOND.key, 2.0): -0.27}, [(MAIN.key, SECOND.key, 3.0)])
    finding = study.find(data)
    rows = {row[0]: row[1:] for row in finding.tables["drift_spce"].rows}
    assert float(rows[plan.NAMES[SECOND]][1].split()[0]) == pytest.approx(-0.27, rel=1e-2)
    assert rows[plan.NAMES[SECOND]][-1] == "lost after 0.2 ps"
    assert render("liquids.md.j2", study.STUDY, finding, "Somewhere.").count("lost after 0.2 ps") == 2
    for scene in SCENES:
        assert len(finding.tables[f"state_{scene.key}"].rows) == len(scene.methods) * len(scene.liquid.steps)
    finding.pictures["drift"](tmp_path / "drift.png")
    assert (tmp_path / "drift.png").stat().st_size > 10_000


def test_error_has_two_digits():
    assert study.with_error(-0.27123, 0.0123, "+") == "-0.271 ± 0.012"
    assert study.with_error(312.4, 25.2) == "312 ± 25"


# --- LAMMPS ---------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A Lab, and the four liquids with few molecules, hardly equilibrated."""
    lab, data = Lab(tmp_path_factory.mktemp("liquids")), {}
    # large enough that no molecule sees its own images, which the deck leaves out, too
    edges = {"spce": 4, "tip4p": 4, "co2": 3, "benzene": 3}
    liquids = [replace(liquid, edge=edges[liquid.key]) for liquid in plan.LIQUIDS]
    original, runs.LIQUIDS = runs.LIQUIDS, liquids
    try:
        data = runs.equilibrate(lab, replace(plan.QUICK, equilibration=100))
    finally:
        runs.LIQUIDS = original
    return lab, {liquid.key: liquid for liquid in liquids}, data


def follow(small, name, key, method, forces=None, dt=0.5, duration=60.0):
    """Run of a liquid with few molecules."""
    lab, liquids, data = small
    liquid = liquids[key]
    forces = forces or plan.Forces(liquid.pair, kspace=liquid.kspace)
    job = runs.job(liquid, data, forces, method, dt, duration)
    return runs.read(lab.many({name: job})[name], liquid, job.steps, dt)


@pytest.mark.parametrize("key", [liquid.key for liquid in plan.LIQUIDS])
def test_temperature_of_the_start_is_exact(small, key):
    """Masses, degrees of freedom and units: the data files were scaled to the temperature."""
    run, liquid = follow(small, f"start_{key}", key, SECOND), small[1][key]
    translation, rotation = quantities.temperatures(run, liquid)
    freedoms = np.array(liquid.freedoms)
    mean = freedoms @ [translation[0], rotation[0]] / freedoms.sum()
    assert mean == pytest.approx(liquid.temperature, rel=1e-7)
    assert 0.3 < rotation[0] / translation[0] < 3.0


@pytest.mark.parametrize("key", [liquid.key for liquid in plan.LIQUIDS])
def test_methods_agree_at_a_short_step(small, key):
    """Energies and pressure after 60 fs; the massless site of TIP4P/2005 included."""
    own, other = (
        follow(small, f"{method.key}_{key}", key, method, dt=0.25) for method in (SECOND, NVE_SMALL)
    )
    assert not own.lost and not other.lost
    for name in ("translation", "rotation"):
        ours, theirs = getattr(own, name)[-1], getattr(other, name)[-1]
        assert ours == pytest.approx(theirs, rel=2e-3)
    assert abs(own.pressure[-1] - other.pressure[-1]) < 0.02 * np.ptp(own.pressure) + 10
    assert np.ptp(own.total) < 1e-2 * np.ptp(own.translation)


def test_charges_within_a_molecule_change_no_pressure(small):
    """The deck leaves their pairs out, but not from kspace; the constraint forces balance that."""
    lab, liquids, data = small
    forces = plan.Forces(plan.TIP4P, kspace="pppm/tip4p")
    job = runs.job(liquids["tip4p"], data, forces, SECOND, 0.5, 60.0)
    excluded = " exclude molecule/intra all"
    deck = job.deck.read_text().replace("include liquid", f"include {job.deck.parent}/liquid")
    deck = deck.replace("../../../examples", str(EXAMPLES))
    assert excluded in deck
    found = []
    for k, other in enumerate((excluded, "\nspecial_bonds lj/coul 0 0 0")):
        changed = lab.out / f"in.pairs{k}"
        changed.write_text(deck.replace(excluded, other))
        finished = lab.many({changed.name: replace(job, deck=changed)})[changed.name]
        found.append(runs.read(finished, liquids["tip4p"], job.steps, 0.5))
    np.testing.assert_allclose(found[0].pressure, found[1].pressure, rtol=1e-7)
    assert abs(found[0].total[0] - found[1].total[0]) > 100


def test_shifted_energies_change_no_trajectory(small):
    plain, shifted = (
        follow(small, name.split()[1], "spce", SECOND, plan.Forces(modify=name))
        for name in ("shift no", "shift yes")
    )
    np.testing.assert_allclose(plain.translation, shifted.translation, rtol=1e-9)
    assert plain.total[0] != pytest.approx(shifted.total[0], abs=1.0)
