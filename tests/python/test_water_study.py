"""Study of water: what follows from made-up samples, what is refused, which samples are kept, a small run."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.studies import water
from benchmarks.studies.water import plan, runs

VOLUME, COMPRESSIBILITY = 6470.0, 0.45
COUNT = 12


def made_up(density=0.0, warmer=0.0, volume2=1.0, compressed=1.0):
    """Samples of all series: faults of ours at 2 fs and 1 atm, and of the densities at other pressures."""
    rng, samples = np.random.default_rng(5), []
    spread = COMPRESSIBILITY / water.PER_GPA * VOLUME * runs.BOLTZMANN * plan.TEMPERATURE * water.ATMOSPHERES
    for series in plan.ROUND:
        ours = series in plan.LONG.values()
        change = COMPRESSIBILITY / water.PER_GPA * (series.pressure - 1.0) * compressed
        for start in range(1, COUNT + 1):
            mean = VOLUME + 0.05 * np.sqrt(spread) * rng.normal()
            sample = runs.Sample(
                *(series.model, series.method, series.dt, series.pressure, start, 0, "abc", "-1.5", 100.0, 4000),
                density=plan.PUBLISHED[series.model] * np.exp(change) + ours * density + 2e-4 * rng.normal(),
                volume=mean,
                volume2=mean**2 + spread * volume2,
                energy=-11.0 + 0.002 * rng.normal(),
                translation=298.0 + 0.5 * rng.normal() + ours * warmer,
                rotation=298.0 + 0.5 * rng.normal(),
                drift=0.0,
            )
            samples.append(sample)
    return samples


def broken(samples):
    return [m.what for m in water.find(samples).measurements if not m.holds]


def test_what_is_right_is_within_the_bounds():
    assert broken(made_up()) == []


@pytest.mark.parametrize(
    "fault, words",
    [
        ({"density": 0.003}, "density of SPC/E water, `fix gear/quat`, 2 fs"),
        ({"density": 0.001}, "less that of `fix shake`"),
        ({"warmer": 1.5}, "T translation − T rotation, TIP4P/2005 water, `fix gear/quat`, 2 fs"),
        ({"volume2": 1.2}, "compressibility"),
        ({"compressed": 1.2}, "compressibility"),
    ],
)
def test_what_is_wrong_is_refused(fault, words):
    assert any(words in what for what in broken(made_up(**fault)))


def test_compressibilities():
    found = water.of_series(made_up())
    value, error = water.jackknife(found[plan.LONG["spce"]], water.fluctuating)
    assert value == pytest.approx(COMPRESSIBILITY, abs=4 * error) and error < 0.01
    value, error = water.by_two_pressures(*(found[series] for series in plan.COMPRESSED))
    assert value == pytest.approx(COMPRESSIBILITY, abs=4 * error) and error < 0.01


def test_errors_of_a_jackknife_are_those_of_a_mean():
    numbers = list(np.random.default_rng(1).normal(size=20))
    value, error = water.jackknife(numbers, np.mean)
    assert value == pytest.approx(np.mean(numbers)) and error == pytest.approx(np.std(numbers, ddof=1) / 20**0.5)


def test_samples_come_back(tmp_path):
    samples = made_up()[:3]
    runs.write_samples(samples, tmp_path / "samples.csv")
    back = runs.read_samples(tmp_path / "samples.csv")
    assert [sample.series for sample in back] == [sample.series for sample in samples]
    assert back[2].volume2 == pytest.approx(samples[2].volume2, rel=1e-9) and back[0].start == 1
    assert runs.read_samples(tmp_path / "nothing.csv") == []


def test_the_page_shows_what_was_found():
    text = render("water.md.j2", water.STUDY, water.find(made_up()), "Somewhere.")
    assert "| TIP4P/2005 water | `fix shake` and `fix npt`, 0.5 fs | 1.20 |" in text and "per GPa" in text


def test_a_small_run(lmp_wheel, tmp_path, monkeypatch):
    path = tmp_path / "samples.csv"
    monkeypatch.setattr(runs, "SAMPLES", path)
    few = {model: replace(liquid, edge=3) for model, liquid in plan.MODELS.items()}
    monkeypatch.setattr(runs, "MODELS", few)
    ours, theirs = plan.Series("spce", plan.OURS, 2.0), plan.Series("tip4p", plan.SHAKE, 1.0)
    monkeypatch.setattr(runs, "ROUND", {ours: 1, theirs: 1})
    lab = Lab(tmp_path, str(lmp_wheel.executable), 1)
    made = plan.Plan(0.0, 0.05, 0.24, 0.024, 50, 2)
    samples = runs.measure(lab, made)
    assert [sample.series for sample in samples] == [ours, ours, theirs, theirs]
    assert [(sample.rows, sample.block) for sample in samples] == [(5, 0), (5, 1)] * 2
    for sample in samples:
        # molecules are counted once, and both temperatures are those of as many degrees of freedom
        assert 200 < sample.translation < 400 and 200 < sample.rotation < 400
        assert sample.volume2 >= sample.volume**2 and -13 < water.energy(sample) < -6
        assert sample.density * sample.volume == pytest.approx(27 * 18.0154 / 0.602214076, rel=1e-3)
    # they are kept, and those of another trajectory are not
    kept = runs.read_samples(path)
    assert [sample.start for sample in runs.measure(lab, made)] == [1] * 4
    runs.write_samples([*(replace(one, trajectory="-1.0") for one in kept[:2]), *kept[2:]], path)
    again = runs.measure(lab, made)
    assert sorted(sample.trajectory for sample in again) == sorted(sample.trajectory for sample in samples)
