"""The study of liquids: quantities of made-up samples, what must be refused, LAMMPS runs of few molecules."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine import Lab
from benchmarks.engine.methods import AUTOMATIC
from benchmarks.engine.page import render
from benchmarks.studies import liquids as study
from benchmarks.studies.liquids import RIGID, SPCE, WATER4

TIME = 60.0 * np.arange(334)


def made_up(rate=0.0, liquid=SPCE, seed=1, time=TIME):
    """A Run with noise whose energy drifts at ``rate``."""
    noise = np.random.default_rng(seed).normal(size=len(time))
    gained = rate * study.BOLTZMANN * liquid.temperature * sum(liquid.freedoms) / 1e6 * time
    return study.Run(time, -9000.0 + gained + 0.02 * noise, *np.zeros((2, len(time))), TIME[-1])


def test_drift_is_one_kt_per_nanosecond_and_freedom():
    """216 rigid molecules have 1293 degrees of freedom; 1 ns has a million fs."""
    gained = 1293 * 0.0019872067 * 298.15  # kcal/mol
    run = replace(made_up(), total=gained * TIME / 1e6)
    assert study.drift([run], SPCE)[0] == pytest.approx(1.0, rel=1e-9)
    linear = replace(SPCE, axes=2)
    assert study.drift([run], linear)[0] == pytest.approx(1293 / 1077, rel=1e-9)


def test_error_of_a_drift_is_from_the_scatter_of_the_starts():
    rates = np.array([-0.3, 0.1, 0.2, 0.5])
    rate, error = study.drift([made_up(r, seed=k) for k, r in enumerate(rates)], SPCE)
    assert rate == pytest.approx(rates.mean(), abs=2e-3)
    assert error == pytest.approx(np.sqrt(np.var(rates, ddof=1) / 4), rel=0.01)
    assert error > 20 * study.drift([made_up(0.1)], SPCE)[1]


def results(rates=(), lost=()):
    """Results of all runs; ``rates``: key -> drift; ``lost``: keys of one run lost."""
    rates, seed, found, plan = dict(rates), 0, {}, study.Plan()
    for liquid in study.LIQUIDS:
        for method in study.NAMES:
            for dt in study.STEPS:
                key = liquid.key, method.key, dt
                runs = range(plan.starts)
                found[key] = [made_up(rates.get(key, 0.0), liquid, seed=(seed := seed + 1)) for _ in runs]
                if key in lost:
                    found[key][-1] = made_up(liquid=liquid, time=TIME[:4])
    return study.Results(plan, found)


def refused(data):
    """Drifts outside of their bounds."""
    return [m.what for m in study.measurements(data) if not m.holds and "drift" in m.what]


@pytest.mark.parametrize("liquid", [SPCE, WATER4], ids=lambda liquid: liquid.key)
@pytest.mark.parametrize("dt", study.MOST_DRIFT)
def test_drifts_of_water_are_bounded(liquid, dt):
    """By the bound and two standard errors, in both directions."""
    most, key = study.MOST_DRIFT[dt], (liquid.key, AUTOMATIC.key, dt)
    for rate, count in ((0.9, 0), (-0.9, 0), (1.5, 1), (-1.5, 1)):
        found = refused(results({key: rate * most}))
        assert [what.count(f" {dt:g} fs") for what in found] == [1] * count
    assert len(refused(results(lost=[key]))) == 1


def test_block_of_the_page():
    key = SPCE.key, AUTOMATIC.key
    finding = study.find(results({(*key, 2.0): -0.27}, [(*key, 3.0)]))
    first = finding.tables["drift"].rows[0]
    assert float(first[2].split()[0]) == pytest.approx(-0.27, rel=1e-2)
    assert first[3] == "1 of 5 lost, after 0.2 ps"
    assert render("liquids.md.j2", study.STUDY, finding, "Somewhere.").count("1 of 5 lost") == 1


# --- LAMMPS ---------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A Lab, and the data of liquids with few molecules, hardly equilibrated."""
    lab = Lab(tmp_path_factory.mktemp("liquids"))
    # large enough that no molecule sees its own images, which the deck leaves out, too
    edges = {"spce": 4, "tip4p": 4, "methanol": 4}
    liquids = [(replace(liquid, edge=edges.get(liquid.key, 3)), [0]) for liquid in study.LIQUIDS]
    return lab, study.equilibrate(lab, replace(study.QUICK, equilibration=100), liquids)


@pytest.mark.parametrize("liquid", study.LIQUIDS, ids=lambda liquid: liquid.key)
def test_methods_agree_at_a_short_step(small, liquid):
    """Energies after 60 fs; the massless site of TIP4P/2005 included."""
    lab, data = small
    jobs = {
        f"{method.key}_{liquid.key}": study.job(liquid, data[liquid.key, 0], method, 0.25, 60.0, interval=30.0)
        for method in (AUTOMATIC, RIGID)
    }
    own, other = (study.read(run, 60.0) for run in lab.many(jobs).values())
    assert not own.lost and not other.lost
    for name in ("translation", "rotation"):
        assert getattr(own, name)[-1] == pytest.approx(getattr(other, name)[-1], rel=2e-3)
    potential = own.total - own.translation - own.rotation
    assert np.ptp(own.total) < 2e-2 * np.ptp(potential)
