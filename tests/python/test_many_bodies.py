"""The study many_bodies: reading logs, made-up results that must be refused, a small run."""

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine import Lab, LammpsError
from benchmarks.engine.logs import Log
from benchmarks.engine.page import render
from benchmarks.engine.statistics import allowed
from benchmarks.studies import many_bodies as study
from benchmarks.studies.many_bodies import quantities, runs
from benchmarks.studies.many_bodies.runs import FIRST, FROZEN, GEAR, NVE_SMALL, SECOND, SMALL

PLAN = runs.Plan(
    rounds=3,
    headline=(2, 1, 1),
    growth={(1, 1, 1): 10, (2, 1, 1): 10},
    pressure_dts=(0.5, 1.0, 2.0),
)

# --- reading logs -------------------------------------------------------------------------------
START = "Fix gear/quat move: start of order 9 from 48 force evaluations\n"
MEMORY = """\
Total dynamically allocated memory: 50.41 Mbyte
Current reserved memory pool size: 56.07 Mbyte
"""
SECTIONS = """\
Loop time of {loop} on 2 procs for {steps} steps with 3000 atoms
Section |  min time  |  avg time  |  max time  |%varavg| %total
Comm    | 0.01       | 0.02       | {comm}     |   0.0 |  2.00
Modify  | 0.1        | 0.2        | {modify}   |   0.0 | 20.00
Other   |            | 0.007      |            |       |  0.28
Nlocal:           1500 ave        1510 max        1490 min
"""
FIRST_RUN = SECTIONS.format(loop=6.1, steps=1, comm=0.001, modify=5.53)
LOG = START + FIRST_RUN + MEMORY + SECTIONS.format(loop=1.2, steps=10, comm=0.03, modify=0.3)


@pytest.fixture
def read(tmp_path):
    """Reads the Timing of a text."""

    def timing(text, ranks=2, started=True):
        (tmp_path / "log").write_text(text)
        return runs.read_timing(Log(tmp_path / "log"), 10, ranks, started)

    return timing


def test_a_timing_is_that_of_the_slowest_rank(read):
    expected = runs.Timing(10, 1.2, 0.03, 0.3, 50.41, 56.07, 48, pytest.approx(5.5))
    assert read(LOG) == expected
    assert read(LOG.replace(START, ""), started=False).seconds is None


@pytest.mark.parametrize(
    "old, new, ranks, said",
    [
        (START, "", 2, "no number of evaluations of the start"),
        ("Current reserved", "Other", 2, "no size of the heap"),
        (START, START, 1, "on 2 ranks, not 1"),
        ("Modify ", "Nothing", 2, "not a finished timing"),
        ("Loop time of 1.2", "Lost after 1.2", 2, "not a finished timing"),
    ],
)
def test_an_incomplete_timing_is_refused(read, old, new, ranks, said):
    with pytest.raises(LammpsError, match=said):
        read(LOG.replace(old, new), ranks)


# --- made-up results ----------------------------------------------------------------------------
#: ms per step for 1000 bodies on one rank, and bytes per body
FIX = {SECOND: 0.8, FIRST: 0.7, NVE_SMALL: 1.0, FROZEN: 0.0}
BYTES = {SECOND: 1200.0, FIRST: 1000.0, NVE_SMALL: 1000.0, FROZEN: 0.0}


def timings(fix=FIX, memory=BYTES, growth=1.0):
    """Timings of PLAN; ``growth``: factor of the times of the smaller scene."""
    made = {}
    for (cells, ranks), method in itertools.product(PLAN.scenes, runs.TIMED):
        bodies, steps = runs.bodies_of(cells), PLAN.growth[cells]
        heap = 100.0 + memory[method] * bodies / 2**20
        start = (48, 0.4) if method.gear and cells == PLAN.headline else ()
        rounds = made[method.key, cells, ranks] = []
        for wobble in (0.999, 1.0, 1.001):
            inside = 1e-6 * bodies * fix[method] / ranks * wobble
            inside *= growth if bodies == 500 else 1.0
            times = steps * np.array([0.05, 0.002 + 0.1 * inside, 0.9 * inside])
            rounds.append(runs.Timing(steps, *times, heap, heap + 3.0, *start))
    return made


def around(temperature, rng):
    """A series of noise about a temperature."""
    return temperature * (1 + 0.01 * rng.normal(size=501))


def kinetic_columns(temperatures, seed):
    """Thermo columns of fix gear/quat with these mean temperatures (translation, three axes)."""
    rng, n = np.random.default_rng(seed), runs.MOLECULES
    series = np.array([around(T, rng) for T in temperatures])
    freedoms = np.array([3 * n - 3, n, n, n])
    energies = freedoms[:, None] * quantities.BOLTZMANN * series
    inertia = [quantities.MASSES.sum() * 3] * 3 + list(quantities.moments())
    squares = energies[[0, 0, 0, 1, 2, 3]] / quantities.ENERGY / np.array(inertia)[:, None]
    columns = {f"c_squares[{k + 1}]": values for k, values in enumerate(squares)}
    return columns | {"Temp": freedoms @ series / (6 * n - 3), "f_move[1]": 0.5 * energies[0]}


def rigid_columns(temperature):
    """Thermo columns of fix rigid/nve/small."""
    series, n = around(temperature, np.random.default_rng(9)), runs.MOLECULES
    energy = 0.5 * quantities.BOLTZMANN * series
    return {"Temp": series, "c_trans": (3 * n - 3) * energy, "c_rot": 3 * n * energy}


def pressures(shift=0.0, instant=0.0):
    """All at 1000 atm; the others' depend on the step, ours by ``shift`` and ``instant`` at 2 fs."""
    rng, made = np.random.default_rng(3), {}
    for method in runs.COMPARED:
        base = 1000.0 + 20.0 * rng.normal(size=1001)
        for dt in PLAN.pressure_dts:
            series = base + 5.0 * rng.normal(size=1001) + (shift if dt == 2.0 else 0.0)
            series[:2] = 900.0 + (instant if dt == 2.0 else 0.0), 901.0
            made[method.key, dt] = series if method.gear else series + 20.0 * dt
    return made


def temperatures(**columns):
    """Thermo columns by key of the method, all at 300 K but those given."""
    even = {"second": kinetic_columns((300.0,) * 4, 1), "first": kinetic_columns((300.0,) * 4, 2)}
    return even | {NVE_SMALL.key: rigid_columns(300.0)} | columns


def made_up(**changes):
    parts = {"timings": timings(), "pressures": pressures(), "temperatures": temperatures()}
    return runs.Results(PLAN, **(parts | changes))


def broken(results):
    """Words of the measurements that are out of bounds."""
    return [m.what for m in study.find(results).measurements if not m.holds]


# --- data that must be refused --------------------------------------------------------------------
def changed(data, keys, change):
    """Made-up data with a change of some of their values."""
    return data | {key: change(data[key]) for key in keys}


#: a time that noise has made negative; more memory at one size; a pressure that differs after the
#: start; other degrees of freedom
FIRSTS = [key for key in timings() if key[0] == "first"]
NOISY = changed(timings(), FIRSTS, lambda own: [replace(t, comm=0.0, modify=0.0) for t in own])
ONE_SIZE = [("first", (1, 1, 1), 1)]
LEAP = changed(timings(), ONE_SIZE, lambda own: [replace(t, allocated=104.0) for t in own])
LATE = changed(pressures(), [("first", 1.0)], lambda p: p + 31.0 * (np.arange(len(p)) == 1))
FREEDOMS = changed(temperatures(), ["first"], lambda t: t | {"Temp": t["Temp"] * (1 + 3e-9)})
LAW, WARM = 1.1 / 0.9, {NVE_SMALL.key: rigid_columns(303.0)}


@pytest.mark.parametrize(
    "changes, wrong",
    [
        ({}, []),
        ({"timings": timings(FIX | {SECOND: 0.999})}, []),
        ({"timings": timings(FIX | {SECOND: 1.01})}, ["second.*time in the fix"] * 2),
        ({"timings": NOISY}, ["first.*time in the fix"] * 2),
        ({"timings": timings(memory=BYTES | {SECOND: 1499.0})}, []),
        ({"timings": timings(memory=BYTES | {SECOND: 1515.0})}, ["second.*memory"]),
        ({"timings": LEAP}, ["first.*memory"]),
        ({"timings": timings(growth=0.99 * LAW)}, []),
        ({"timings": timings(growth=1.01 * LAW)}, ["linear scaling"] * 2),
        ({"timings": timings(growth=0.5)}, ["linear scaling"] * 2),
        ({"pressures": pressures(shift=10.0)}, ["of a mean pressure"] * 2),
        ({"pressures": pressures(instant=1e-5)}, ["second.*of the start", "first.*of the start"]),
        ({"pressures": LATE}, ["first.*after 2 fs"]),
        ({"temperatures": FREEDOMS}, ["first.*6N - 3"]),
        ({"temperatures": temperatures(**WARM)}, ["mean temperature less"] * 2),
    ],
)
def test_what_is_refused(changes, wrong):
    found = broken(made_up(**changes))
    assert len(found) == len(wrong), found
    assert all(re.search(words, what) for words, what in zip(wrong, found)), found


@pytest.mark.parametrize("part", range(4))
def test_a_part_that_is_too_warm_is_refused(part):
    columns = kinetic_columns(300.0 + 3.0 * (np.arange(4) == part), 5)
    wrong = broken(made_up(temperatures=temperatures(second=columns)))
    assert ["second" in what for what in wrong if "equipartition" in what] == [True]


def test_quantities_are_those_of_the_numbers():
    results = made_up(pressures=pressures(shift=10.0))
    wobbles = [0.8e-3 * wobble for wobble in (0.999, 1.0, 1.001)]
    assert results.fix_seconds(SECOND, (2, 1, 1)) == pytest.approx(wobbles), "with communication"
    assert results.fix_seconds(FROZEN, (2, 1, 1)) == pytest.approx([0.0] * 3, abs=1e-15)
    assert quantities.time_ratio(results, SECOND, 2) == pytest.approx((0.8,) * 3)
    assert quantities.nonlinearity(results, SECOND) == pytest.approx(0.0, abs=1e-12)
    shift = quantities.pressure_shifts(results, SECOND)
    assert shift[2.0].value == pytest.approx(10.0, abs=4 * shift[2.0].error)
    assert abs(shift[1.0].value) < 4 * shift[1.0].error
    theirs = quantities.mean_pressures(results, SMALL)
    assert quantities.largest_deviation(theirs.values()) > allowed(3, 9)
    series = quantities.temperatures(kinetic_columns([290.0, 300.0, 310.0, 320.0], 5))
    means = [values.mean() for name, values in series.items() if name != "all"]
    assert means == pytest.approx([290.0, 300.0, 310.0, 320.0], rel=2e-3)


# --- page and runs --------------------------------------------------------------------------------
def test_page():
    text = render("many_bodies.md.j2", study.STUDY, study.find(made_up()), "Somewhere.")
    assert "| fix gear/quat, second formulation | 0.80 (0.80 to 0.80) | 50.00" in text
    assert "| fix gear/quat, first formulation | 2 | 48 | 0.40 (0.40 to 0.40) | 8 |" in text
    assert "| fix rigid/nve/small | 1000 | 1000 | 1000 | 1000 |" in text


def test_small_run(tmp_path):
    """Real runs on one and two ranks: everything that is not a time is as it should be."""
    plan = runs.Plan(
        rounds=1,
        headline=(1, 1, 1),
        growth={(1, 1, 1): 10},
        pressure_dts=(1.0, 2.0),
        pressure_time=24.0,
        temperature_time=24.0,
        temperature_interval=2.0,
    )
    done = []
    results = runs.measure(Lab(tmp_path, advance=done.append), plan)
    assert sum(done) == pytest.approx(1.0)
    for (key, *_), rounds in results.timings.items():
        assert (rounds[0].evaluations or 0) > 0 or key not in {method.key for method in GEAR}
        assert rounds[0].modify < 1e-3 or key != FROZEN.key
    # times, and an average that 24 fs do not have
    left_out = ("time in the fix", "memory", "linear scaling", "equipartition")
    assert [what for what in broken(results) if not any(words in what for words in left_out)] == []
    starts = [quantities.instants(results, method)[0, 0] for method in GEAR]
    assert np.ptp(starts) < 1e-8
    assert all(np.ptp(results.pressures[m.key, 2.0]) > 1.0 for m in runs.COMPARED), "they move"
