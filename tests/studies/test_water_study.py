"""Study of water: what follows from made-up samples, which run comes next, motion in a made-up dump."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.studies import water
from benchmarks.studies.water import frames, plan, quantities, runs

VOLUME, COMPRESSIBILITY, COUNT = 6470.0, 0.45, 12


def made_up():
    """Samples of all series; the fluctuation of the volume gives the constant above."""
    rng, samples = np.random.default_rng(5), []
    spread = 6.9477 * COMPRESSIBILITY * VOLUME * quantities.KT  # 1 kcal/mol/A^3 is 6.9477 GPa
    for series in plan.TARGETS:
        for start in range(1, COUNT + 1):
            volume = VOLUME + 0.05 * np.sqrt(spread) * rng.normal()
            sample = runs.Sample(
                *(series.model, series.method, series.dt, series.ensemble, start, 0, "abc", "-1.5", 100.0, 4000),
                density=plan.PUBLISHED[series.model] + 2e-4 * rng.normal(),
                energy=-11.0 + 0.002 * rng.normal(),
                volume=volume,
                volume2=volume**2 + spread,
                measured=1.0,
                translation=298.0 + 0.5 * rng.normal(),
                rotation=298.0 + 0.5 * rng.normal(),
                drift=0.0,
                diffusion=0.2 + 0.01 * rng.normal(),
                turning=2.3,
            )
            samples.append(sample)
    return samples


def near(found, expected):
    """True if a (value, error) is within four errors of a number."""
    return abs(found[0] - expected) <= 4 * found[1]


def test_fluctuations():
    ours = water.of_series(made_up())[plan.LONG["tip4p"]]
    found = {quantity.name: quantity.of(ours) for quantity in quantities.FLUCTUATIONS}
    expected = {"compressibility": COMPRESSIBILITY, "diffusion": 2.0}
    assert all(near(found[name], value) and found[name][1] < 0.1 * value for name, value in expected.items())
    assert not any(near(found[name], 2 * value) for name, value in expected.items())
    assert found["rotation time"][0] == pytest.approx(2.3)


def test_errors_of_a_jackknife_are_those_of_a_mean():
    numbers = list(np.random.default_rng(1).normal(size=20))
    value, error = quantities.jackknife(numbers, np.mean)
    assert value == pytest.approx(np.mean(numbers)) and error == pytest.approx(np.std(numbers, ddof=1) / 20**0.5)
    assert all(math.isnan(x) for x in quantities.jackknife([], np.mean)) and quantities.cell((math.nan, math.nan)) == "–"


def test_extrapolation_removes_an_error_of_second_order():
    samples = made_up()[:COUNT]
    fine, coarse = ([replace(s, density=1.0 + 0.01 * h**2 + 1e-4 * k) for k, s in enumerate(samples)] for h in (1.0, 2.0))
    _, error = quantities.DENSITY.of(fine)
    found = quantities.extrapolated(fine, coarse, quantities.DENSITY)
    assert found[0] == pytest.approx(1.0 + 1e-4 * np.mean(range(COUNT))) and found[1] == pytest.approx(error * math.sqrt(17) / 3)


def test_costs():
    seconds = {plan.OURS: 0.003, plan.SHAKE: 0.002}
    found = list(water.costs(seconds).values())
    assert found[0] == pytest.approx(0.003e6 / 2) and found[1] == pytest.approx(0.002e6 / 0.5)
    # (4 s(1 fs) + s(2 fs))^2 / 9 has its minimum at lengths in proportion to s / sqrt(cost)
    fine, coarse = 0.002e6, 0.001e6
    shares = np.linspace(0.01, 0.99, 9999)
    least = np.min((fine * shares + coarse * (1 - shares)) * (16 / shares + 1 / (1 - shares)) / 9)
    assert found[2] == pytest.approx(least, rel=1e-6)
    table = water.cost_table(water.of_series(made_up()), {name: [x, 1.1 * x] for name, x in seconds.items()})
    assert table.rows[0][-1] == "1" and table.rows[1][-1].startswith("2.6667")


def test_the_next_run_is_of_the_series_that_lacks_most():
    assert {series for series, number in runs.next_runs([], len(plan.TARGETS))} == set(plan.TARGETS)
    samples = [one for one in made_up() if one.series != plan.SHORT]
    least = min(plan.TARGETS, key=lambda series: 1 / plan.TARGETS[series])
    assert runs.next_runs(samples, 2) == [(plan.SHORT, 1), (plan.SHORT, 2)]
    assert runs.next_runs(made_up(), 1) == [(least, COUNT + 1)]


def test_samples_come_back(tmp_path):
    samples = made_up()[:3]
    runs.write_samples(samples, tmp_path / "samples.csv")
    back = runs.read_samples(tmp_path / "samples.csv")
    assert [sample.series for sample in back] == [sample.series for sample in samples]
    assert back[2].volume2 == pytest.approx(samples[2].volume2, rel=1e-11) and back[0].start == 1
    assert runs.read_samples(tmp_path / "nothing.csv") == []


# --- the dump ------------------------------------------------------------------------------------
ATOMS = np.array([[0, 0, 0], [0.756950327, 0.585882277, 0], [-0.756950327, 0.585882277, 0]])
MASSES = np.array([15.9994, 1.008, 1.008])
ARMS = ATOMS - MASSES @ ATOMS / MASSES.sum()


def write_dump(path, turns, centers):
    """Dump with a frame per 96 fs: molecules at ``turns`` (F, B) and ``centers`` (F, B, 3)."""
    with path.open("w") as file:
        for frame, poses in enumerate(turns):
            file.write(f"ITEM: UNITS\nreal\nITEM: TIME\n{96.0 * frame}\nITEM: TIMESTEP\n{48 * frame}\nITEM: NUMBER OF ATOMS\n{3 * len(poses)}\n")
            file.write("ITEM: BOX BOUNDS pp pp pp\n0 20\n0 20\n0 20\nITEM: ATOMS id mol type mass xu yu zu vx vy vz\n")
            for b, pose in enumerate(poses):
                x = pose.apply(ARMS) + centers[frame][b]
                for k in range(3):
                    numbers = " ".join(f"{one:.12g}" for one in (MASSES[k], *x[k], 0.0, 0.0, 0.0))
                    file.write(f"{3 * b + k + 1} {b + 1} {1 + (k > 0)} {numbers}\n")


def test_diffusion_and_rotation_of_random_walks(tmp_path):
    """A step of the rotation by random vectors of variance s in each direction decays P2 by exp(-3 s) a frame."""
    rng, number, bodies, square = np.random.default_rng(4), 401, 24, 0.012
    centers = np.cumsum(0.1 * rng.normal(size=(number, bodies, 3)), axis=0)
    turns = [[Rotation.identity()] * bodies]
    for _ in range(number - 1):
        turns.append([Rotation.from_rotvec(math.sqrt(square) * rng.normal(size=3)) * pose for pose in turns[-1]])
    write_dump(tmp_path / "sites.dump", turns, centers)
    part = frames.read_motion(tmp_path / "sites.dump", 1)[0]
    assert part.turning == pytest.approx(0.096 / (3 * square), rel=0.25)
    assert part.diffusion == pytest.approx(0.1**2 / 2 / 0.096, rel=0.25)
