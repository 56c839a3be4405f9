"""Study of water: what follows from made-up samples, what is refused, which samples are kept, a small run."""


import numpy as np
import pytest

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


def test_a_quarter_of_the_error_takes_sixteen_times_as_long():
    samples = made_up()[:COUNT]
    _, error = water.mean(samples, water.density)
    assert water.duration(samples, water.density, error) == pytest.approx(COUNT * 0.1)
    assert water.duration(samples, water.density, error / 4) == pytest.approx(16 * COUNT * 0.1)


def test_samples_come_back(tmp_path):
    samples = made_up()[:3]
    runs.write_samples(samples, tmp_path / "samples.csv")
    back = runs.read_samples(tmp_path / "samples.csv")
    assert [sample.series for sample in back] == [sample.series for sample in samples]
    assert back[2].volume2 == pytest.approx(samples[2].volume2, rel=1e-9) and back[0].start == 1
    assert runs.read_samples(tmp_path / "nothing.csv") == []
