"""``benchmarks/run bench``: reading logs, statistics, verdicts from made-up numbers, a small run."""

import csv
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.studies.bench import decks as bench_decks
from benchmarks.studies.bench import figures as bench_figures
from benchmarks.studies.bench import judge
from benchmarks.studies.bench import page as bench_page
from benchmarks.studies.bench import runs as bench
from benchmarks.studies.bench.runs import FIRST, FROZEN, NVE_SMALL, SECOND, SMALL
from benchmarks.engine.checkout import PublishError
from benchmarks.commands.bench import bench as command
from benchmarks.engine.lammps_runner import LammpsError

PLAN = bench.Plan(
    rounds=3,
    headline=(2, 1, 1),
    growth={(1, 1, 1): 10, (2, 1, 1): 10},
    pressure_dts=(0.5, 1.0, 2.0),
)

# --- reading logs -------------------------------------------------------------------------------
SECTIONS = """\
Loop time of {loop} on {ranks} procs for {steps} steps with 3000 atoms

MPI task timing breakdown:
Section |  min time  |  avg time  |  max time  |%varavg| %total
---------------------------------------------------------------
Pair    | 0.75       | 0.8        | 0.85       |   0.0 | 70.00
Comm    | 0.01       | 0.02       | {comm}     |   0.0 |  2.00
Modify  | 0.1        | 0.2        | {modify}   |   0.0 | 20.00
Sync    | 3e-06      | 4e-06      | 5e-06      |   0.0 |  0.00
Other   |            | 0.007      |            |       |  0.28

Nlocal:           1500 ave        1510 max        1490 min
"""
MEMORY = """\
Total dynamically allocated memory: 50.41 Mbyte
Current reserved memory pool size: 56.07 Mbyte
Maximum resident set size: 91.15 Mbyte
"""
START = "Fix gear/quat move: start of order 9 from 48 force evaluations\n"


def log(ranks=2, start=START, modify=0.3):
    first = SECTIONS.format(loop=6.1, ranks=ranks, steps=1, comm=0.001, modify=5.53)
    timed = SECTIONS.format(loop=1.2, ranks=ranks, steps=10, comm=0.03, modify=modify)
    return "LAMMPS\n" + start + first + MEMORY + timed


RUN = bench.TimedRun(SECOND, (2, 1, 1), 2, 1, 10)


def test_a_timing_is_that_of_the_slowest_rank():
    found = bench.read_timing(RUN, log())
    assert (found.loop, found.comm, found.modify) == (1.2, 0.03, 0.3)
    assert (found.reported, found.allocated) == (50.41, 56.07)
    assert found.start_evaluations == 48
    assert found.start_seconds == pytest.approx(5.5)
    assert bench.read_timing(RUN, log(modify=0.303)).modify != pytest.approx(0.3, rel=5e-3)
    assert bench.breakdowns(log())[1]["Other"] == 0.007


def test_only_a_start_that_was_asked_for_is_read():
    for run in (replace(RUN, start=False), replace(RUN, method=NVE_SMALL)):
        assert bench.read_timing(run, log(start="")).start_seconds is None
    with pytest.raises(LammpsError, match="no number of evaluations of the start"):
        bench.read_timing(RUN, log(start=""))


def test_logs_that_are_not_a_timing_are_refused():
    """Two copies on one rank each are what a launcher of another MPI makes."""
    with pytest.raises(LammpsError, match="it ran on 1 ranks, not 2"):
        bench.read_timing(RUN, log(ranks=1))
    with pytest.raises(LammpsError, match="Modify"):
        bench.read_timing(RUN, log().replace("Modify", "Motion"))
    with pytest.raises(LammpsError, match="no size of the heap"):
        bench.read_timing(RUN, log().replace("Current reserved", "Some"))
    with pytest.raises(LammpsError, match="not a finished timing"):
        bench.read_timing(RUN, log().partition(MEMORY)[0])


# --- the plan -----------------------------------------------------------------------------------
def test_competitors_are_interleaved():
    runs = bench.timed_runs(bench.FULL)
    assert len({run.name for run in runs}) == len(runs) == 5 * 4 * 4
    assert {run.bodies for run in runs} == {1000, 8000, 64000}
    orders = set()
    for number in range(1, 6):
        of_round = [run for run in runs if run.round == number]
        assert runs[(number - 1) * 16 : number * 16] == of_round
        scene = [r.method.key for r in of_round if (r.bodies, r.ranks) == (8000, 2)]
        assert sorted(scene) == sorted(method.key for method in bench.TIMED)
        orders.add(tuple(scene))
    assert len(orders) == 4
    assert all(run.start == (run.bodies == 8000) for run in runs)


def test_default_settings_are_timed():
    for run in bench.timed_runs(bench.FULL):
        expected = run.method.style
        if run.method.gear and run.bodies != 8000:
            expected += " start zero"
        assert run.style == expected
    assert SECOND.style == "gear/quat molecule"
    assert FIRST.style == "gear/quat molecule formulation first"


# --- statistics ---------------------------------------------------------------------------------
def noise(rng, n, memory=0.0):
    """Noise of variance 1 whose correlation falls by ``memory`` from sample to sample."""
    found = rng.normal(size=n)
    for k in range(1, n):
        found[k] = memory * found[k - 1] + np.sqrt(1 - memory**2) * found[k]
    return found


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_standard_error_is_the_scatter_of_repeated_means(memory):
    rng = np.random.default_rng(20261121)
    means = [judge.block_mean(noise(rng, 1001, memory)) for _ in range(200)]
    scatter = np.std([mean.value for mean in means])
    assert np.mean([mean.error for mean in means]) == pytest.approx(scatter, rel=0.2)


def test_blocks_leave_out_the_common_start():
    values = np.concatenate([[1e6], np.arange(50.0)])
    found = judge.block_mean(values)
    assert found.value == pytest.approx(24.5)
    assert found.error == pytest.approx(np.std(np.arange(2.0, 50.0, 5.0), ddof=1) / np.sqrt(10))
    with pytest.raises(ValueError, match="10 samples are too few for 10 blocks"):
        judge.block_mean(values[:10])


def test_bound_is_rarely_exceeded_by_chance():
    rng = np.random.default_rng(4)
    limit, false = judge.bound(4), 0
    for _ in range(500):
        means = [judge.block_mean(noise(rng, 101)) for _ in range(4)]
        false += judge.largest_deviation(means, 0.0) > limit
    assert 0.02 < false / 500 < 0.08
    assert judge.bound(8) > limit > judge.bound(1)


# --- made-up results ----------------------------------------------------------------------------
FIX = {SECOND: 0.8, FIRST: 0.7, NVE_SMALL: 1.0, FROZEN: 0.0}  # ms a step for 1000 bodies, one rank
BYTES = {SECOND: 1200.0, FIRST: 1000.0, NVE_SMALL: 1000.0, FROZEN: 0.0}


def timings(fix=FIX, memory=BYTES, growth=1.0):
    """Timings of PLAN; ``growth``: factor of the times of the smaller scene."""
    found = []
    for run in bench.timed_runs(PLAN):
        wobble = 1.0 + 0.001 * (run.round - 2)
        inside = 1e-6 * run.bodies * fix[run.method] / run.ranks * wobble
        inside *= growth if run.bodies == 500 else 1.0
        extra = 100.0 + memory[run.method] * run.bodies / 2**20
        start = (30 if run.method == SECOND else 12, 0.4) if run.method.gear and run.start else ()
        found.append(
            bench.Timing(
                run,
                loop=run.steps * 0.05,
                comm=run.steps * (0.002 + 0.1 * inside),
                modify=run.steps * 0.9 * inside,
                **dict(zip(("start_evaluations", "start_seconds"), start)),
                reported=extra,
                allocated=extra + 3.0,
            )
        )
    return found


def kinetic_columns(temperatures, seed):
    """Thermo columns of fix gear/quat with these mean temperatures (translation, three axes)."""
    rng = np.random.default_rng(seed)
    series = [T * (1 + 0.01 * noise(rng, 501)) for T in temperatures]
    n, columns = judge.MOLECULES, {}
    freedoms = [3 * n - 3, n, n, n]
    columns["Temp"] = sum(f * T for f, T in zip(freedoms, series)) / (6 * n - 3)
    unit = judge.BOLTZMANN / judge.ENERGY
    for k in range(3):
        columns[f"c_squares[{k + 1}]"] = freedoms[0] * unit * series[0] / judge.MASSES.sum() / 3
        squares = n * unit * series[k + 1] / judge.moments()[k]
        columns[f"c_squares[{k + 4}]"] = squares
    columns["f_move[1]"] = 0.5 * freedoms[0] * judge.BOLTZMANN * series[0]
    return columns


def rigid_columns(temperature, seed=9):
    rng, n = np.random.default_rng(seed), judge.MOLECULES
    series = temperature * (1 + 0.01 * noise(rng, 501))
    energy = 0.5 * judge.BOLTZMANN * series
    return {"Temp": series, "c_trans": (3 * n - 3) * energy, "c_rot": 3 * n * energy}


def pressures(shift=0.0, instant=0.0):
    """All at 1000 atm; the others' depend on the step, ours by ``shift`` and ``instant`` at 2 fs."""
    rng, found = np.random.default_rng(3), {}
    for method in bench.COMPARED:
        base = 1000.0 + 20.0 * noise(rng, 1001)
        for dt in PLAN.pressure_dts:
            series = base + 5.0 * noise(rng, 1001) + (shift if dt == 2.0 else 0.0)
            series[:2] = 900.0 + (instant if dt == 2.0 else 0.0), 901.0
            if not method.gear:
                series += 20.0 * dt
            found[method.key, dt] = {"Press": series}
    return found


def made_up(**changes):
    parts = {
        "timings": timings(),
        "pressures": pressures(),
        "temperatures": {
            "second": kinetic_columns((300.0,) * 4, 1),
            "first": kinetic_columns((300.0,) * 4, 2),
            NVE_SMALL.key: rigid_columns(300.0),
        },
    }
    return bench.Results(PLAN, **(parts | changes))


def missed(results):
    return [row.what for row in judge.all_rows(results) if not row.met]


def test_everything_can_be_met():
    assert missed(made_up()) == []


# --- verdicts -----------------------------------------------------------------------------------
def test_communication_that_the_fix_adds_is_its_time():
    results = made_up()
    assert results.fix_seconds(SECOND, (2, 1, 1)) == pytest.approx(
        [0.8e-3 * wobble for wobble in (0.999, 1.0, 1.001)]
    )
    assert results.fix_seconds(FROZEN, (2, 1, 1)) == pytest.approx([0.0] * 3, abs=1e-15)
    ratio, least, largest = judge.time_ratio(results, SECOND, 2)
    assert (ratio, least, largest) == pytest.approx((0.8,) * 3)


def test_time_verdict_flips():
    equal = judge.time_rows(made_up(timings=timings(FIX | {SECOND: 0.999})))
    assert [row.met for row in equal] == [True] * 4
    slower = judge.time_rows(made_up(timings=timings(FIX | {SECOND: 1.01})))
    assert [row.met for row in slower] == [False, True] * 2
    assert slower[0].measured.startswith("1.01 (") and slower[0].verdict == "not met"


def test_noise_is_not_speed():
    """A negative time in the fix is no time."""
    noisy = timings()
    noisy = [replace(t, comm=0.0) if t.run.method == FIRST else t for t in noisy]
    noisy = [replace(t, modify=0.0) if t.run.method == FIRST else t for t in noisy]
    rows = judge.time_rows(made_up(timings=noisy))
    assert [row.met for row in rows] == [True, False] * 2
    assert rows[1].measured == "timings too noisy"


def test_memory_verdict_flips():
    for size, met in ((1499.0, True), (1515.0, False)):
        rows = judge.memory_rows(made_up(timings=timings(memory=BYTES | {SECOND: size})))
        assert [row.met for row in rows] == [met, True]
    leap = [
        (
            replace(t, allocated=t.allocated + 1.0)
            if (t.run.method, t.run.bodies) == (FIRST, 500)
            else t
        )
        for t in timings()
    ]
    rows = judge.memory_rows(made_up(timings=leap))
    assert [row.met for row in rows] == [True, False], "the largest ratio counts"
    assert rows[1].measured.startswith("1.00 to 3.")


def test_growth_verdict_flips():
    law = 1.1 / 0.9
    for factor, met in ((1.0, True), (0.99 * law, True), (1.01 * law, False), (0.5, False)):
        rows = judge.growth_rows(made_up(timings=timings(growth=factor)))
        assert [row.met for row in rows] == [met] * 2
    assert judge.nonlinearity(made_up(), SECOND) == pytest.approx(0.0, abs=1e-12)


def test_one_pressure_at_all_steps():
    rows = judge.pressure_rows(made_up(pressures=pressures(shift=10.0)))
    assert [row.met for row in rows] == [False, True] * 2, "one per cent is refused"
    shift = judge.pressure_shifts(made_up(pressures=pressures(shift=10.0)), SECOND)
    assert shift[2.0].value == pytest.approx(10.0, abs=4 * shift[2.0].error)
    assert abs(shift[1.0].value) < 4 * shift[1.0].error
    theirs = judge.mean_pressures(made_up(), SMALL)
    assert judge.largest_deviation(theirs.values()) > judge.bound(3)


def test_pressure_of_one_configuration():
    results = made_up()
    assert judge.instant_changes(results, SECOND) == (0.0, 0.0)
    assert judge.instant_changes(results, NVE_SMALL) == pytest.approx((30.0, 30.0))
    rows = judge.pressure_rows(made_up(pressures=pressures(instant=1e-5)))
    assert [row.met for row in rows] == [True, False] * 2, "more than rounding at the start"
    late = pressures()
    late["first", 1.0]["Press"][1] += 31.0
    rows = judge.pressure_rows(made_up(pressures=late))
    assert [row.met for row in rows[1::2]] == [True, False], "more than rigid/nve/small's"


def test_moments_of_spce():
    """Closed forms of a molecule with r = 1 Angstrom and cos = -1/3: about the dipole
    2 m (r sin)^2, and the largest is the sum of the other two."""
    largest, dipole, smallest = judge.moments()
    assert dipole == pytest.approx(2 * 1.008 * 2 / 3)
    assert smallest == pytest.approx(2 * 1.008 * 15.9994 / (15.9994 + 2 * 1.008) / 3)
    assert largest == pytest.approx(dipole + smallest)


def test_equipartition_verdict_flips():
    for part in range(4):
        unequal = [300.0] * 4
        unequal[part] *= 1.01
        found = made_up()
        found.temperatures["second"] = kinetic_columns(unequal, 5)
        rows = judge.temperature_rows(found)
        assert [row.met for row in rows[::3]] == [False, True], part
        assert rows[1].met, "degrees of freedom are those of the rows all the same"
    names = judge.temperatures(kinetic_columns([290.0, 300.0, 310.0, 320.0], 5))
    means = {name: series.mean() for name, series in names.items() if name != "all"}
    assert list(means.values()) == pytest.approx([290.0, 300.0, 310.0, 320.0], rel=2e-3)
    assert list(means) == ["translation", *(f"axis {name}" for name in judge.AXES)]


def test_wrong_degrees_of_freedom_are_seen():
    found = made_up()
    found.temperatures["first"]["Temp"] *= 1.0 + 3e-9
    assert [row.met for row in judge.temperature_rows(found)[1::3]] == [True, False]


def test_mean_temperature_verdict_flips():
    found = made_up()
    found.temperatures[NVE_SMALL.key] = rigid_columns(303.0)
    rows = judge.temperature_rows(found)
    assert [row.met for row in rows] == [True, True, False] * 2


# --- what is written ----------------------------------------------------------------------------
@pytest.fixture
def out(tmp_path):
    """What a run leaves."""
    (tmp_path / "out" / "logs").mkdir(parents=True)
    (tmp_path / "out" / "logs" / "log.one").write_text("LAMMPS (1 Jan 2030)\n")
    return tmp_path / "out"


def test_page_holds_demands_beside_numbers(out):
    text = bench_page.page_text(out, made_up())
    assert "All 18 demands are met." in text and "LAMMPS (1 Jan 2030)" in text
    assert text.count("| met |") == 18 and "do not edit" in text
    assert "| fix gear/quat, second formulation | 0.80 (0.80 to 0.80) | 50.00" in text
    assert "| fix gear/quat, first formulation | 2 | 12 | 0.40 (0.40 to 0.40) | 8 |" in text
    assert "| fix rigid/nve/small | 1000 | 1000 | 1000 | 1000 |" in text
    assert "500 bodies, LAMMPS' sum | 500 bodies, heap | 1000 bodies, LAMMPS' sum" in text
    slow = made_up(timings=timings(FIX | {SECOND: 1.01}))
    text = bench_page.page_text(out, slow)
    assert "Of 18 demands 16 are met, 2 not." in text and text.count("| not met |") == 2


def test_tables(out):
    bench_page.write(out, made_up())
    rows = list(csv.DictReader((out / "timings.csv").open()))
    assert len(rows) == 3 * 3 * 4
    assert rows[0]["method"] == "second" and float(rows[0]["modify"]) > 0
    rows = {(r["method"], r["step"]): r for r in csv.DictReader((out / "pressure.csv").open())}
    assert len(rows) == 4 * 3 and float(rows["second", "2.0"]["first sample"]) == 901.0
    rows = list(csv.DictReader((out / "temperature.csv").open()))
    assert [row["part"] for row in rows[:2]] == ["all", "translation"] and len(rows) == 5 + 5 + 3
    assert len(list(csv.DictReader((out / "bench.csv").open()))) == 18


def test_picture(out):
    bench_figures.draw(out / "many_bodies.png", made_up())
    assert (out / "many_bodies.png").stat().st_size > 10_000


def test_publishing(tmp_path, out):
    with pytest.raises(PublishError, match="is not a checkout of GEARQUAT"):
        bench_page.publish(tmp_path, out, made_up())
    (tmp_path / "src" / "GEARQUAT").mkdir(parents=True)
    readme = "# Title\n"
    (tmp_path / "README.md").write_text(readme)
    (out / "many_bodies.png").write_bytes(b"picture")
    bench_page.publish(tmp_path, out, made_up())
    text = (tmp_path / "doc" / "many_bodies.md").read_text()
    assert "(many_bodies/many_bodies.png)" in text
    assert (tmp_path / "doc" / "many_bodies" / "many_bodies.png").read_bytes() == b"picture"
    assert (tmp_path / "README.md").read_text() == readme


# --- running ------------------------------------------------------------------------------------
def test_decks_sample_at_common_times():
    for dt in bench.FULL.pressure_dts:
        text = bench_decks.pressure(SECOND.style, dt, 800.0, 2.0)
        steps, every = (int(re.search(rf"^{w} (\d+)$", text, re.M)[1]) for w in ("run", "thermo"))
        assert steps * dt == 800.0 and every * dt == 2.0
        assert "fix_modify move energy yes" in text
    assert "fix_modify" not in bench_decks.pressure(SMALL.style, 1.0, 1000.0, 2.0)
    assert "fix move" not in bench_decks.timing("", (1, 1, 1), 0.5, 10)


def test_small_run(tmp_path):
    """Real runs on one and two ranks: everything that is not a time is as it should be."""
    plan = bench.Plan(
        rounds=1,
        headline=(1, 1, 1),
        growth={(1, 1, 1): 10},
        pressure_dts=(1.0, 2.0),
        pressure_time=24.0,
        temperature_time=24.0,
        temperature_interval=2.0,
    )
    done = []
    results = bench.measure(tmp_path, plan, progress=done.append)
    assert sum(done) == bench.work(plan)
    assert all(t.start_evaluations > 0 for t in results.timings if t.run.method.gear)
    assert all(t.modify < 1e-3 for t in results.timings if t.run.method == FROZEN)
    for row in judge.pressure_rows(results)[1::2] + judge.temperature_rows(results)[1::3]:
        assert row.met, row
    start = {tuple(judge.instants(results, method)[1.0]) for method in bench.GEAR}
    assert np.ptp([pressure for pressure, _ in start]) < 1e-8
    bench_page.write(tmp_path, results)
    assert "| 500 bodies |" in (tmp_path / "many_bodies.md").read_text()


def test_command_names_what_is_required(tmp_path):
    def fails(*arguments):
        result = CliRunner().invoke(command, ["--out", str(tmp_path / "out"), *arguments])
        assert result.exit_code != 0
        return result.output

    assert "in full and at least five --rounds" in fails("--publish", str(tmp_path), "--quick")
    assert "in full and at least five --rounds" in fails(
        "--publish", str(tmp_path), "--rounds", "4"
    )
    assert "is not a checkout of GEARQUAT" in fails("--publish", str(tmp_path))
    assert not (tmp_path / "out").exists()
    assert "name one with --lmp" in fails("--lmp", "/nowhere/lmp")
    assert "name one with --mpiexec" in fails("--mpiexec", "/nowhere/mpiexec")
