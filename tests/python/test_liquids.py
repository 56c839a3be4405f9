"""The study liquids: quantities of made-up samples, what must be refused, LAMMPS runs of few molecules."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine import Lab
from benchmarks.engine.page import render
from benchmarks.studies import liquids as study
from benchmarks.studies.coefficients import prediction
from benchmarks.studies.liquids import judging, plan, quantities, runs
from benchmarks.studies.liquids.plan import DEFAULT, HEAVY, MAIN, NVE_SMALL, SCENES, SPCE, VALUES

TIME = 60.0 * np.arange(334)


# --- quantities -----------------------------------------------------------------------------------
def made_up(rate=0.0, liquid=SPCE, ratio=1.0, seed=1, time=TIME, duration=TIME[-1], values=7):
    """A Run with noise whose energy drifts at ``rate``, and whose rotation is warmer by ``ratio``."""
    noise = np.random.default_rng(seed).normal(size=(4, len(time)))
    total = -9000.0 + rate * quantities.unit(liquid) * time + 0.02 * noise[0]
    half = quantities.BOLTZMANN * liquid.temperature / 2
    kinetic = [n * half * (1 + 0.05 * x) for n, x in zip(liquid.freedoms, noise[1:])]
    pressure = 100 + 500 * noise[3]
    energies = kinetic[0], ratio * kinetic[1], sum(kinetic)
    return runs.Run(time, total, *energies, pressure, duration, 3e-3, values)


def test_drift_is_one_kt_per_nanosecond_and_freedom():
    """216 rigid molecules have 1293 degrees of freedom; 1 ns has a million fs."""
    gained = 1293 * 0.0019872067 * 298.15  # kcal/mol
    run = replace(made_up(), total=gained * TIME / 1e6)
    assert quantities.drift([run], SPCE)[0] == pytest.approx(1.0, rel=1e-9)
    linear = replace(SPCE, axes=2)
    assert quantities.drift([run], linear)[0] == pytest.approx(1293 / 1077, rel=1e-9)


def test_error_of_a_drift_is_from_the_scatter_of_the_starts():
    rates = np.array([-0.3, 0.1, 0.2, 0.5])
    rate, error = quantities.drift([made_up(r, seed=k) for k, r in enumerate(rates)], SPCE)
    assert rate == pytest.approx(rates.mean(), abs=2e-3)
    assert error == pytest.approx(np.sqrt(np.var(rates, ddof=1) / 4), rel=0.01)
    assert error > 20 * quantities.drift([made_up(0.1)], SPCE)[1]


@pytest.mark.parametrize("liquid", plan.LIQUIDS, ids=lambda liquid: liquid.key)
def test_one_percent_of_rotation_is_seen(liquid):
    """Temperatures agree with equipartition, and cold rotation is detected."""
    for ratio in (1.0, 0.99):
        several = [made_up(liquid=liquid, ratio=ratio, seed=seed) for seed in range(5)]
        mean = quantities.warmer(several, liquid)
        expected = (1 - ratio) * liquid.temperature
        assert abs(mean.value - expected) < 4 * mean.error < 0.01 * liquid.temperature


# --- what is found --------------------------------------------------------------------------------
DRIFT, LOSS, BEST, WRONG = ": drift", "without loss", "best number", "predicted drift"


def spectrum(axes=3):
    """A Spectrum with small predicted drifts only."""
    omega = np.linspace(0.001, 0.05, 50)
    return prediction.Spectrum(omega, np.full(50, 0.02), np.full(50, 0.02), axes)


def results(rates=(), lost=(), ratio=1.0):
    """Results of all runs; ``rates``: (scene, method, step) -> drift; ``lost``: keys of one run lost."""
    rates, seed, found, made = dict(rates), 0, {}, plan.Plan()
    for scene in (*SCENES, HEAVY):
        for method, extent in scene.methods.items():
            for dt in extent.steps:
                key, count = (scene.key, method.key, dt), made.extent(scene, method, dt)[0]
                own = rates.get(key, 0.0), scene.liquid, ratio
                found[key] = [made_up(*own, seed=(seed := seed + 1)) for _ in range(count)]
                if key in lost:
                    found[key][-1] = made_up(*own, time=TIME[:4])
    floors = {
        (forces.text, method.key): made_up(seed=k)
        for k, (forces, methods) in enumerate(plan.FLOORS.items())
        for method in methods
    }
    spectra = {liquid.key: spectrum() for liquid in plan.LIQUIDS}
    bins = np.linspace(0, 9, 90)
    pairs = np.array([np.stack([bins, k + np.exp(-bins), 2 + bins], axis=1) for k in range(5)])
    places = {(MAIN.key, dt): pairs for dt in MAIN.pairs}
    places |= {(HEAVY.key, dt): pairs + [0, 0.1, 0] for dt in HEAVY.pairs}
    return runs.Results(made, found, floors, spectra, places)


def refused(data):
    """Subjects of the measurements outside of their bounds, without the noise of made-up temperatures."""
    return [m.what for m in judging.measurements(data) if not m.holds and "T trans" not in m.what]


@pytest.mark.parametrize("scene", SCENES[:2], ids=lambda scene: scene.key)
@pytest.mark.parametrize("dt", judging.MOST_DRIFT)
def test_drifts_of_water_are_bounded(scene, dt):
    """By the bound and two standard errors, in both directions."""
    most, key = judging.MOST_DRIFT[dt], (scene.key, DEFAULT.key, dt)
    keys = [(scene.key, method.key, dt) for method in VALUES.values()]
    for rate, count in ((0.9, 0), (-0.9, 0), (1.5, 1), (-1.5, 1)):
        data = results({k: rate * most for k in (key, *keys)})
        found = [what for what in refused(data) if DRIFT in what and WRONG not in what]
        assert [what.count(f" {dt:g} fs") for what in found] == [1] * count


def test_a_lost_body_is_noticed():
    key = SCENES[1].key, DEFAULT.key, plan.STEPS[-1]
    assert [LOSS in what for what in refused(results(lost=[key]))] == [True]
    lost = (SCENES[1].key, DEFAULT.key, 3.0)
    assert sum(DRIFT in what for what in refused(results(lost=[lost]))) == 1


def test_page_and_pictures(tmp_path):
    key = MAIN.key, VALUES[9].key
    data = results({(*key, 2.0): -0.27}, [(*key, 3.0)])
    finding = study.find(data)
    rows = {row[0]: row[1:] for row in finding.tables["drift_spce"].rows}
    assert float(rows[plan.NAMES[VALUES[9]]][0].split()[0]) == pytest.approx(-0.27, rel=1e-2)
    assert rows[plan.NAMES[VALUES[9]]][2] == "1 of 3 lost, after 0.2 ps"
    assert render("liquids.md.j2", study.STUDY, finding, "Somewhere.").count("1 of 3 lost") == 2
    heights = [row[-2] for row in finding.tables["heavy"].rows]
    assert heights[:2] == ["3.00 ± 0.71", "+0.1000 ± 0.0000"]
    for name in ("drift", "heavy"):
        picture = finding.pictures[name]
        path = tmp_path / f"{name}.png"
        picture(path) if callable(picture) else study.draw(path, picture)
        assert path.stat().st_size > 10_000


# --- LAMMPS ---------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A Lab, and the liquids with few molecules, hardly equilibrated."""
    lab = Lab(tmp_path_factory.mktemp("liquids"))
    # large enough that no molecule sees its own images, which the deck leaves out, too
    edges = {"spce": 4, "tip4p": 4, "methanol": 4}
    liquids = [replace(liquid, edge=edges.get(liquid.key, 3)) for liquid in plan.LIQUIDS]
    data = runs.equilibrate(lab, replace(plan.QUICK, equilibration=100), liquids)
    return lab, {liquid.key: liquid for liquid in liquids}, data


def follow(small, name, key, method, forces=None, dt=0.5, duration=60.0, **more):
    """Run of a liquid with few molecules."""
    lab, liquids, data = small
    liquid = liquids[key]
    forces = forces or plan.Forces(liquid.pair, kspace=liquid.kspace)
    job = runs.job(liquid, data[key, 0], forces, method, dt, duration, **more)
    return runs.read(lab.many({name: job})[name], job.steps, dt, method)


@pytest.mark.parametrize("key", [liquid.key for liquid in plan.LIQUIDS])
def test_methods_agree_at_a_short_step(small, key):
    """Energies and pressure after 60 fs; the massless site of TIP4P/2005 included."""
    own, other = (
        follow(small, f"{method.key}_{key}", key, method, dt=0.25, interval=30.0)
        for method in (DEFAULT, NVE_SMALL)
    )
    assert not own.lost and not other.lost
    for name in ("translation", "rotation"):
        ours, theirs = getattr(own, name)[-1], getattr(other, name)[-1]
        assert ours == pytest.approx(theirs, rel=2e-3)
    for run in (own, other):  # energies of bodies agree with their atoms
        np.testing.assert_allclose(run.translation + run.rotation, run.kinetic, rtol=1e-9)
    assert abs(own.pressure[-1] - other.pressure[-1]) < 0.02 * np.ptp(own.pressure) + 10
    assert np.ptp(own.total) < 2e-2 * np.ptp(own.potential)
