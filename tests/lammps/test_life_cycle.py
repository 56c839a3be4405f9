"""What outlives what: runs, time steps, restart files, changes by the user."""

import numpy as np
import pytest
from scenes import last_frame, two_molecules, water, water_data, whole_deck

FORMULATIONS = ["first", "second"]
COLUMNS = ["c_centre[1]", "c_centre[2]", "c_centre[3]", "c_potential", "v_ketrans", "v_kerot"]


class Case1:
    """The paper's first case with another end of the deck."""

    def __init__(self, lmp, examples, formulation, ranks=1):
        self.lmp, self.ranks = lmp, ranks
        self.scene = whole_deck(examples / "case1" / "in.case1")
        self.variables = dict(formulation=formulation, dt=0.02, every=100, out="none")

    def run(self, ending, scene=None, ranks=None, **variables):
        text = (scene or self.scene).replace("run ${steps}", ending)
        result = self.lmp.run(text, {**self.variables, **variables}, ranks=ranks or self.ranks)
        assert result.returncode == 0, result.output
        return result

    def restarted(self):
        """The same deck that reads a restart file instead of the data and the pair coefficients."""
        lines = []
        for line in self.scene.splitlines():
            if line.startswith("read_data"):
                line = "read_restart ${restart}"
            if line.startswith(("pair_", "atom_style", "boundary")):
                continue
            lines.append(line)
        return "\n".join(lines)


def end(result, run=-1):
    return np.array([result.thermo[run][column][-1] for column in COLUMNS])


@pytest.fixture(params=FORMULATIONS)
def case1(request, lmp_tree, examples):
    return Case1(lmp_tree, examples, request.param)


def test_two_runs_are_one_run(case1):
    whole = case1.run("run 2000")
    halves = case1.run("run 1000\nrun 1000")
    assert (end(whole) == end(halves)).all()  # bit for bit
    many = case1.run("run 300\nrun 0\nrun 700\nrun 1000")
    assert (end(whole) == end(many)).all()
    every = case1.run("run 2000 every 500 NULL")
    assert (end(whole) == end(every)).all()
    without = case1.run("run 1000\nrun 1000 pre no")
    assert (end(whole) == end(without)).all()


def test_the_comparisons_can_fail(case1):
    """A step or a time that is 1 % off is seen by both comparisons used here."""
    whole = end(case1.run("run 1000"))
    for other in (case1.run("run 1000", dt=0.0202), case1.run("run 990")):
        assert (end(other) != whole).all()
        assert end(other) != pytest.approx(whole, rel=1e-12, abs=1e-12)
        assert end(other) != pytest.approx(whole, abs=1e-7)


def test_a_restart_is_the_same_run(case1):
    restart = case1.lmp.folder / "half.restart"
    whole = case1.run("run 2000")
    first = case1.run(f"run 1000\nwrite_restart {restart}\nrun 1000")
    assert (end(whole) == end(first)).all()
    second = case1.run("run 1000", scene=case1.restarted(), restart=restart)
    assert "Resetting peratom fix info" in second.stdout
    assert (end(whole) == end(second)).all()  # bit for bit on the same ranks


def test_periodic_restart_files(case1):
    restart = case1.lmp.folder / "run.*.restart"
    whole = case1.run(f"restart 500 {restart}\nrun 2000")
    late = case1.run("run 500", scene=case1.restarted(), restart=str(restart).replace("*", "1500"))
    assert (end(whole) == end(late)).all()


@pytest.mark.parametrize("before, after", [(1, 2), (2, 1), (4, 2)])
def test_a_restart_on_other_ranks(case1, before, after):
    restart = case1.lmp.folder / "half.restart"
    whole = case1.run("run 1000")
    case1.run(f"run 500\nwrite_restart {restart}", ranks=before)
    second = case1.run("run 500", scene=case1.restarted(), ranks=after, restart=restart)
    assert end(second) == pytest.approx(end(whole), rel=1e-12, abs=1e-12)


def test_a_restart_written_before_the_first_step(case1):
    restart = case1.lmp.folder / "new.restart"
    whole = case1.run("run 1000")
    case1.run(f"run 0\nwrite_restart {restart}")
    assert (
        end(case1.run("run 1000", scene=case1.restarted(), restart=restart)) == end(whole)
    ).all()


def test_a_restart_with_the_other_formulation_says_so(case1):
    restart = case1.lmp.folder / "half.restart"
    whole = case1.run("run 1000")
    case1.run(f"run 500\nwrite_restart {restart}")
    other = {"first": "second", "second": "first"}[case1.variables["formulation"]]
    second = case1.run("run 500", scene=case1.restarted(), restart=restart, formulation=other)
    assert "histories of another formulation" in second.stdout
    assert end(second) == pytest.approx(end(whole), abs=1e-7)


def test_restarts_of_water(lmp_tree):
    """Bodies over all boundaries, several a rank, migrating."""
    data = water_data(lmp_tree.folder / "data.water")
    for formulation in FORMULATIONS:
        fix = f"gear/quat molecule formulation {formulation}"
        deck = water(
            data,
            fix,
            steps=400,
            dump="whole.dump",
            run="run 200\nwrite_restart half.restart\nrun 200",
        )
        assert lmp_tree.run(deck, ranks=4).returncode == 0
        again = water("half.restart", fix, steps=400, dump="again.dump", run="run 200")
        again = again.replace("read_data", "read_restart").replace("atom_style", "#")
        again = again.replace("pair_style", "#").replace("pair_coeff", "#")
        for ranks in (1, 2, 4):
            result = lmp_tree.run(again, ranks=ranks)
            assert result.returncode == 0, result.output
            difference = last_frame(lmp_tree.folder / "whole.dump") - last_frame(
                lmp_tree.folder / "again.dump"
            )
            assert np.abs(difference).max() < 1e-12


@pytest.mark.parametrize("factor", [2.0, 0.5, 10.0])
def test_a_change_of_the_time_step(case1, factor):
    """The run goes on as precisely as one with the coarser of the two steps from the beginning."""
    steps = round(1000 / factor)
    exact = end(case1.run("run 10000", dt=0.004))  # to t = 40

    def error(result):
        return np.abs(end(result) - exact)[:3].max()

    allowed = 2.0 * max(
        error(case1.run("run 2000")), error(case1.run(f"run {2 * steps}", dt=0.02 * factor))
    )
    assert error(case1.run(f"run 1000\ntimestep {0.02 * factor}\nrun {steps}")) < allowed + 1e-11
    assert error(case1.run(f"run 1000\ntimestep {0.0202 * factor}\nrun {steps}")) > allowed + 1e-11


def test_reset_timestep_does_not_matter(case1):
    whole = case1.run("run 1000")
    assert (end(case1.run("run 500\nreset_timestep 17\nrun 500")) == end(whole)).all()


def test_what_the_user_changes_between_runs_is_taken_over(lmp_tree):
    deck = two_molecules(after="""
thermo_style custom step ke f_move[1] f_move[2]
thermo_modify norm no format float %.17g
run 5
velocity all set 0.5 0.0 0.0
run 5
displace_atoms all move 0.1 0.0 0.0
run 5
set group all mass 4.0
run 5
""")
    masses = "fix masses all property/atom rmass\nset group all mass 1.0"
    result = lmp_tree.run(deck.replace("mass 1 1.0", "mass 1 1.0\n" + masses))
    assert result.returncode == 0, result.output
    assert result.stdout.count("atoms were changed since the last run") == 3
    assert result.thermo[1]["f_move[1]"] == pytest.approx([0.75] * len(result.thermo[1]["Step"]))
    assert result.thermo[1]["f_move[2]"] == pytest.approx(
        [0.0] * len(result.thermo[1]["Step"]), abs=1e-20
    )
    assert result.thermo[3]["f_move[1]"][-1] == pytest.approx(4 * 0.75)
    for table in result.thermo:
        assert np.add(table["f_move[1]"], table["f_move[2]"]) == pytest.approx(table["KinEng"])


def test_reinit_no_keeps_the_bodies(lmp_tree):
    after = """
thermo_style custom step ke f_move[1]
thermo_modify norm no format float %.17g
run 5
velocity all set 9.0 0.0 0.0
run 5
"""
    result = lmp_tree.run(two_molecules("molecule reinit no", after=after))
    assert result.returncode == 0, result.output
    assert result.thermo[1]["f_move[1]"] == result.thermo[0]["f_move[1]"]
    assert result.thermo[1]["KinEng"] == pytest.approx(result.thermo[0]["KinEng"], rel=1e-9)


@pytest.mark.parametrize("reinit", ["yes", "no"])
def test_velocities_given_after_the_fix_count(lmp_tree, reinit):
    """Before the first run reinit does not matter, as with fix rigid."""
    thermo = "thermo_style custom step ke f_move[1]\nthermo_modify norm no"
    after = f"{thermo}\nvelocity all set 0.5 0 0\nrun 1"
    result = lmp_tree.run(two_molecules(f"molecule reinit {reinit}", after=after))
    assert result.thermo[0]["f_move[1]"] == pytest.approx([0.75, 0.75])


def test_a_body_may_be_removed_as_a_whole(lmp_tree):
    after = """
thermo_style custom step f_move[1] f_move[2]
thermo_modify norm no format float %.17g
run 5
group first molecule 1
delete_atoms group first compress no
run 5
"""
    for ranks in (1, 2):
        result = lmp_tree.run(two_molecules(after=after), ranks=ranks)
        assert result.returncode == 0, result.output
        assert 0.0 < result.thermo[1]["f_move[2]"][0] < result.thermo[0]["f_move[2]"][-1]


def test_unfix_and_back(case1):
    whole = case1.run("run 1000")
    back = "fix move body gear/quat molecule formulation ${formulation}\nfix_modify move energy yes"
    again = case1.run(f"run 500\nunfix move\n{back}\nrun 500")
    # poses and velocities come back from the atoms, the rest from a new start
    assert end(again) == pytest.approx(end(whole), abs=1e-7)
    assert (end(again) != end(whole)).any()


def test_a_step_shorter_than_half_begins_anew(case1):
    """Not at a half, nor if the step is back before it is used, nor where a start would not be full."""
    said = "less than half of that of the last steps, histories start anew"
    shorter = case1.run("run 100\ntimestep 0.008\nrun 100")
    assert shorter.stdout.count(said) == 1
    assert shorter.stdout.count("force evaluations") == 2
    for commands, more in (
        ("timestep 0.01", {}),
        ("timestep 0.008\ntimestep 0.02", {}),
        ("timestep 0.008", {"start": "zero"}),
        ("fix noise body langevin 1.0 1.0 1.0 4711\ntimestep 0.008", {}),
    ):
        assert said not in case1.run(f"run 100\n{commands}\nrun 100", **more).stdout, commands
