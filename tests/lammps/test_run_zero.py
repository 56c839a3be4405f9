"""`run 0` evaluates a state and changes nothing: the following run is the same to the last bit."""

import numpy as np
import pytest
from support.scenes import one_after_the_other
from support.constant_temperature import END, TEMP, cluster, continued

RAMP = "temp 0.4 0.8 0.3"
SPAN = "start 0 stop 100"
AGAIN = "run 0\nrun 0 start 0 stop 100\nrun 0"


def ends_of(lmp, runs, words, ranks=1, **settings):
    """The final atoms of each run, and the tables; runs: the commands between fix and END."""
    names = [f"end{n}" for n in range(len(runs))]
    decks = [cluster(words, every=10, run=f"{run}\n{END.format(n)}", **settings) for run, n in zip(runs, names)]
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    return [(lmp.folder / f"{name}.end").read_text() for name in names], result


@pytest.mark.parametrize(
    "words", ["", "formulation second", "formulation first", TEMP, f"{TEMP} tolerance 1e-9", "tolerance 1e-9"]
)
def test_between_runs(lmp_tree, words):
    runs = [f"run 40\n{look}run 60" for look in ("", "run 0\n", "run 0\nrun 0\n")]
    columns = {} if "temp" in words else dict(columns="")
    ends, _ = ends_of(lmp_tree, runs, words, **columns)
    assert ends[0] == ends[1] == ends[2]


@pytest.mark.parametrize("words", ["", "formulation second", TEMP, "langevin 0.4 0.4 1.0 4711", "tolerance 1e-9"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_reading_a_step_changes_nothing(lmp_tree, words, ranks):
    """Only where something reads them do atoms get the states at the end of a step."""
    looks = ["thermo 100", "thermo 1", "thermo 7", "fix look all ave/time 3 1 3 c_thermo_temp"]
    runs = [f"{look}\nrun 100" for look in looks]
    columns = {} if "temp" in words else dict(columns="")
    ends, _ = ends_of(lmp_tree, runs, words, ranks, **columns)
    assert len(set(ends)) == 1


@pytest.mark.parametrize("words", ["", TEMP])
def test_a_run_that_ends_before_its_last_step(lmp_tree, words):
    """Atoms have the states of their bodies, which the next run does not take for changes by the user."""
    early = "timer timeout 0:00:01 every 10\nrun 1000000000\ntimer timeout off\nrun 0"
    columns = {} if "temp" in words else dict(columns="")
    result = lmp_tree.succeed(cluster(words, every=1000000, run=early, **columns))
    assert "atoms were changed" not in result.log
    assert 10 < result.thermo[-1]["Step"][-1] < 1000000000


@pytest.mark.parametrize("kind, ranks", [("total", 2), ("separate", 1)])
def test_inside_a_ramp(lmp_tree, kind, ranks):
    runs = [
        f"run 40 {SPAN}\n{look}run 60 {SPAN}" for look in ("", "run 0\n", f"{AGAIN}\n", f"run 0 {SPAN}\n")
    ]
    runs.append(f"run 40 upto {SPAN}\nrun 0\nrun 100 upto {SPAN}")
    ends, result = ends_of(lmp_tree, runs, f"thermostat {kind} {RAMP}", ranks)
    assert len(set(ends)) == 1
    assert "a target, a damping time" not in result.log
    # it shows the target and the conserved quantity of the last step
    tables = result.thermo[2:5]
    for column in ("f_move[12]", "f_move[9]"):
        before, look, after = (np.array(table[column]) for table in tables)
        assert before[-1] == look[0] == pytest.approx(after[0], rel=1e-13), column
    assert tables[0]["f_move[12]"][-1] == pytest.approx(0.4 + 0.4 * 0.4)


def test_before_everything(lmp_tree):
    runs = [f"{look}run 100" for look in ("", "run 0\n", "run 0\nrun 0\n")]
    ends, result = ends_of(lmp_tree, runs, RAMP)
    assert ends[0] == ends[1] == ends[2]
    assert result.log.count("thermostat of 9 degrees") == 3


def test_a_restart_behind_it(lmp_tree):
    first = cluster(RAMP, run=f"run 40 {SPAN}\nrun 0\nwrite_restart half\nrun 60 {SPAN}\n{END.format('whole')}")
    again = f"run 0\nrun 60 {SPAN}\n{END.format('again')}"
    result = lmp_tree.succeed(one_after_the_other([first, continued(cluster(RAMP, run=again), "half")]))
    whole, again = ((lmp_tree.folder / f"{name}.end").read_text() for name in ("whole", "again"))
    assert whole == again
    assert "a target, a damping time" not in result.log


def test_what_was_there_for_a_look_only(lmp_tree):
    """A field or another target that is removed before the next step has changed nothing."""
    field = "fix pull all addforce 0 0 1\nrun 0\nunfix pull\n"
    runs = [f"run 40\n{look}run 60" for look in ("", field)]
    ends, result = ends_of(lmp_tree, runs, f"{TEMP} thermostat separate")
    assert ends[0] == ends[1]
    look = result.thermo[3]
    freedoms = (2 * look["f_move[1]"][0]) / look["f_move[10]"][0]
    assert freedoms == pytest.approx(12.0, rel=1e-10)


def test_what_came_for_good_is_noticed_behind_it(lmp_tree):
    """After a change that only `run 0` has used, a step starts as without this change."""
    runs = [f"run 40\nfix pull all addforce 0 0 1\n{look}run 60" for look in ("", "run 0\n")]
    ends, result = ends_of(lmp_tree, runs, TEMP)
    assert ends[0] == ends[1]
    assert result.log.count("the degrees of freedom differ from those of the last steps; histories are rebuilt") == 2
