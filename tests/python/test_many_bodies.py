"""The study many_bodies: reading logs, made-up results that must be refused, a small run."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.logs import Log
from benchmarks.engine.page import render
from benchmarks.engine.runner import LammpsError
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
SECTIONS = """\
Loop time of {loop} on {ranks} procs for {steps} steps with 3000 atoms

Section |  min time  |  avg time  |  max time  |%varavg| %total
---------------------------------------------------------------
Pair    | 0.75       | 0.8        | 0.85       |   0.0 | 70.00
Comm    | 0.01       | 0.02       | {comm}     |   0.0 |  2.00
Modify  | 0.1        | 0.2        | {modify}   |   0.0 | 20.00
Other   |            | 0.007      |            |       |  0.28

Nlocal:           1500 ave        1510 max        1490 min
"""
MEMORY = """\
Total dynamically allocated memory: 50.41 Mbyte
Current reserved memory pool size: 56.07 Mbyte
"""
START = "Fix gear/quat move: start of order 9 from 48 force evaluations\n"


@pytest.fixture
def log(tmp_path):
    """A maker of Logs of two runs."""

    def make(start=START, modify=0.3, memory=MEMORY):
        first = SECTIONS.format(loop=6.1, ranks=2, steps=1, comm=0.001, modify=5.53)
        timed = SECTIONS.format(loop=1.2, ranks=2, steps=10, comm=0.03, modify=modify)
        (tmp_path / "log.made").write_text("LAMMPS\n" + start + first + memory + timed)
        return Log(tmp_path / "log.made")

    return make


def test_a_timing_is_that_of_the_slowest_rank(log):
    timing = runs.read_timing(log(), 10, 2, True)
    assert timing == runs.Timing(10, 1.2, 0.03, 0.3, 50.41, 56.07, 48, pytest.approx(5.5))
    assert runs.read_timing(log(start=""), 10, 2, False).seconds is None


def test_an_incomplete_timing_is_refused(log, tmp_path):
    with pytest.raises(LammpsError, match="no number of evaluations of the start"):
        runs.read_timing(log(start=""), 10, 2, True)
    with pytest.raises(LammpsError, match="no size of the heap"):
        runs.read_timing(log(memory=MEMORY.splitlines()[0] + "\n"), 10, 2, True)
    with pytest.raises(LammpsError, match="on 2 ranks, not 1"):
        runs.read_timing(log(), 10, 1, True)
    text = log().text
    for wrong in (text.replace("Modify ", "Nothing"), text.rpartition("Loop time")[0]):
        (tmp_path / "log.made").write_text(wrong)
        with pytest.raises(LammpsError, match="not a finished timing"):
            runs.read_timing(Log(tmp_path / "log.made"), 10, 2, True)


# --- made-up results ----------------------------------------------------------------------------
#: ms per step for 1000 bodies on one rank, and bytes per body
FIX = {SECOND: 0.8, FIRST: 0.7, NVE_SMALL: 1.0, FROZEN: 0.0}
BYTES = {SECOND: 1200.0, FIRST: 1000.0, NVE_SMALL: 1000.0, FROZEN: 0.0}


def noise(rng, n):
    return rng.normal(size=n)


def timings(fix=FIX, memory=BYTES, growth=1.0):
    """Timings of PLAN; ``growth``: factor of the times of the smaller scene."""
    made = {}
    for cells, ranks in PLAN.scenes:
        bodies, steps = runs.bodies_of(cells), PLAN.growth[cells]
        for method in runs.TIMED:
            rounds = []
            for wobble in (0.999, 1.0, 1.001):
                inside = 1e-6 * bodies * fix[method] / ranks * wobble
                inside *= growth if bodies == 500 else 1.0
                times = 0.05, 0.002 + 0.1 * inside, 0.9 * inside
                heap = 100.0 + memory[method] * bodies / 2**20
                start = (48, 0.4) if method.gear and cells == PLAN.headline else ()
                rounds.append(
                    runs.Timing(steps, *(steps * t for t in times), heap, heap + 3.0, *start)
                )
            made[method.key, cells, ranks] = rounds
    return made


def kinetic_columns(temperatures, seed):
    """Thermo columns of fix gear/quat with these mean temperatures (translation, three axes)."""
    rng = np.random.default_rng(seed)
    series = [T * (1 + 0.01 * noise(rng, 501)) for T in temperatures]
    n, columns = runs.MOLECULES, {}
    freedoms = [3 * n - 3, n, n, n]
    columns["Temp"] = sum(f * T for f, T in zip(freedoms, series)) / (6 * n - 3)
    unit = quantities.BOLTZMANN / quantities.ENERGY
    for k in range(3):
        columns[f"c_squares[{k + 1}]"] = (
            freedoms[0] * unit * series[0] / quantities.MASSES.sum() / 3
        )
        columns[f"c_squares[{k + 4}]"] = n * unit * series[k + 1] / quantities.moments()[k]
    columns["f_move[1]"] = 0.5 * freedoms[0] * quantities.BOLTZMANN * series[0]
    return columns


def rigid_columns(temperature):
    rng, n = np.random.default_rng(9), runs.MOLECULES
    series = temperature * (1 + 0.01 * noise(rng, 501))
    energy = 0.5 * quantities.BOLTZMANN * series
    return {"Temp": series, "c_trans": (3 * n - 3) * energy, "c_rot": 3 * n * energy}


def pressures(shift=0.0, instant=0.0):
    """All at 1000 atm; the others' depend on the step, ours by ``shift`` and ``instant`` at 2 fs."""
    rng, made = np.random.default_rng(3), {}
    for method in runs.COMPARED:
        base = 1000.0 + 20.0 * noise(rng, 1001)
        for dt in PLAN.pressure_dts:
            series = base + 5.0 * noise(rng, 1001) + (shift if dt == 2.0 else 0.0)
            series[:2] = 900.0 + (instant if dt == 2.0 else 0.0), 901.0
            if not method.gear:
                series += 20.0 * dt
            made[method.key, dt] = series
    return made


def made_up(**changes):
    temperatures = {"second": kinetic_columns((300.0,) * 4, 1), NVE_SMALL.key: rigid_columns(300.0)}
    temperatures["first"] = kinetic_columns((300.0,) * 4, 2)
    parts = {"timings": timings(), "pressures": pressures(), "temperatures": temperatures}
    return runs.Results(PLAN, **(parts | changes))


def broken(results):
    """Words of the measurements that are out of bounds."""
    return [m.what for m in study.find(results).measurements if not m.holds]


def test_all_bounds_can_hold():
    assert broken(made_up()) == []


# --- data that must be refused --------------------------------------------------------------------
def test_communication_that_the_fix_adds_is_its_time():
    results = made_up()
    assert results.fix_seconds(SECOND, (2, 1, 1)) == pytest.approx(
        [0.8e-3 * wobble for wobble in (0.999, 1.0, 1.001)]
    )
    assert results.fix_seconds(FROZEN, (2, 1, 1)) == pytest.approx([0.0] * 3, abs=1e-15)
    assert quantities.time_ratio(results, SECOND, 2) == pytest.approx((0.8,) * 3)


def test_a_slow_fix_is_refused():
    assert broken(made_up(timings=timings(FIX | {SECOND: 0.999}))) == []
    slow = broken(made_up(timings=timings(FIX | {SECOND: 1.01})))
    assert len(slow) == 2 and all("second" in what and "time in the fix" in what for what in slow)


def test_noise_is_not_speed():
    """A negative time in the fix is no time."""
    noisy = timings()
    for key in noisy:
        if key[0] == FIRST.key:
            noisy[key] = [replace(t, comm=0.0, modify=0.0) for t in noisy[key]]
    wrong = [what for what in broken(made_up(timings=noisy)) if "time in the fix" in what]
    assert len(wrong) == 2 and all("first" in what for what in wrong)


def test_too_much_memory_is_refused():
    assert broken(made_up(timings=timings(memory=BYTES | {SECOND: 1499.0}))) == []
    (wrong,) = broken(made_up(timings=timings(memory=BYTES | {SECOND: 1515.0})))
    assert "memory" in wrong
    leap = timings()
    leap["first", (1, 1, 1), 1] = [
        replace(t, allocated=t.allocated + 1.0) for t in leap["first", (1, 1, 1), 1]
    ]
    (wrong,) = broken(made_up(timings=leap))
    assert "memory" in wrong and "first" in wrong, "the largest ratio counts"


def test_growth_that_is_not_linear_is_refused():
    law = 1.1 / 0.9
    for factor, count in ((1.0, 0), (0.99 * law, 0), (1.01 * law, 2), (0.5, 2)):
        wrong = broken(made_up(timings=timings(growth=factor)))
        assert len(wrong) == count and all("linear scaling" in what for what in wrong)
    assert quantities.nonlinearity(made_up(), SECOND) == pytest.approx(0.0, abs=1e-12)


def test_a_pressure_that_depends_on_the_step_is_refused():
    shifted = made_up(pressures=pressures(shift=10.0))
    assert len(broken(shifted)) == 2, "one per cent is refused"
    shift = quantities.pressure_shifts(shifted, SECOND)
    assert shift[2.0].value == pytest.approx(10.0, abs=4 * shift[2.0].error)
    assert abs(shift[1.0].value) < 4 * shift[1.0].error
    theirs = quantities.mean_pressures(made_up(), SMALL)
    assert quantities.largest_deviation(theirs.values()) > allowed(3, 9)


def test_pressures_of_one_configuration_that_differ_are_refused():
    second, first = broken(made_up(pressures=pressures(instant=1e-5)))
    assert "of the start" in second and "of the start" in first
    late = pressures()
    late["first", 1.0][1] += 31.0
    (wrong,) = broken(made_up(pressures=late))
    assert "first" in wrong and "after 2 fs" in wrong


def test_moments_of_spce():
    """Closed forms of a molecule with r = 1 Angstrom and cos = -1/3: about the dipole
    2 m (r sin)^2, and the largest is the sum of the other two."""
    largest, dipole, smallest = quantities.moments()
    assert dipole == pytest.approx(2 * 1.008 * 2 / 3)
    assert smallest == pytest.approx(2 * 1.008 * 15.9994 / (15.9994 + 2 * 1.008) / 3)
    assert largest == pytest.approx(dipole + smallest)


def test_one_hot_axis_is_refused():
    for part in range(4):
        unequal = [300.0] * 4
        unequal[part] *= 1.01
        results = made_up()
        results.temperatures["second"] = kinetic_columns(unequal, 5)
        wrong = [what for what in broken(results) if "equipartition" in what]
        assert len(wrong) == 1 and "second" in wrong[0], part
    series = quantities.temperatures(kinetic_columns([290.0, 300.0, 310.0, 320.0], 5))
    means = [values.mean() for name, values in series.items() if name != "all"]
    assert means == pytest.approx([290.0, 300.0, 310.0, 320.0], rel=2e-3)


def test_wrong_degrees_of_freedom_are_refused():
    results = made_up()
    results.temperatures["first"]["Temp"] *= 1.0 + 3e-9
    (wrong,) = broken(results)
    assert "6N - 3" in wrong and "first" in wrong


def test_another_temperature_is_refused():
    results = made_up()
    results.temperatures[NVE_SMALL.key] = rigid_columns(303.0)
    assert len(broken(results)) == 2


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
    timed = ("time in the fix", "memory", "linear scaling")
    assert [what for what in broken(results) if not any(words in what for words in timed)] == []
    starts = [quantities.instants(results, method)[0, 0] for method in GEAR]
    assert np.ptp(starts) < 1e-8
    assert all(np.ptp(results.pressures[m.key, 2.0]) > 1.0 for m in runs.COMPARED), "they move"
