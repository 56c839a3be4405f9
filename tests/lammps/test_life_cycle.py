"""State that persists through runs, time steps, restart files and changes by the user."""

import numpy as np
import pytest
from support.running import SCENES
from support.scenes import two_molecules, water, whole_deck

COLUMNS = ["c_centre[1]", "c_centre[2]", "c_centre[3]", "c_potential", "v_ketrans", "v_kerot"]


class Case1:
    """The paper's first case with other final commands."""

    def __init__(self, lmp, formulation):
        self.lmp = lmp
        self.scene = whole_deck(SCENES / "in.case1")
        self.variables = dict(formulation=formulation, dt=0.02, every=100, out="none")

    def run(self, ending, **variables):
        """With the steps in ``ending``."""
        return self.lmp.succeed(self.scene.replace("run ${steps}", ending), {**self.variables, **variables})


def end(result):
    return np.array([result.thermo[-1][column][-1] for column in COLUMNS])


@pytest.fixture
def case1(lmp_tree, formulation):
    return Case1(lmp_tree, formulation)


def test_several_runs_are_one_run(case1):
    whole = end(case1.run("run 2000"))
    for commands in (
        "run 1000\nrun 1000",
        "run 300\nrun 0\nrun 700\nrun 1000",
        "run 2000 every 500 NULL",
        "run 1000\nrun 1000 pre no",
        "run 500\nreset_timestep 17\nrun 1500",
    ):
        assert (end(case1.run(commands)) == whole).all(), commands  # bit for bit


def test_a_rerun_in_between(case1):
    """Rerun finds the energies of the dumped poses; with reinit no bodies ignore it, otherwise they start again from
    its last frame."""
    dump = "dump d body custom 100 frames id x y z vx vy vz\ndump_modify d sort id format float %.17g\nrun 1000\nundump d"
    whole = end(case1.run("run 1000\nrun 1000"))
    for reinit in ("no", "yes"):
        result = case1.run(f"{dump}\nrerun frames dump x y z vx vy vz\nrun 1000", inertia=f"reinit {reinit}")
        first, again = (np.array(table["v_total"]) for table in result.thermo[:2])
        assert reinit == "no" or first == pytest.approx(again, abs=1e-10)
        assert (end(result) == whole).all() == (reinit == "no")
        assert end(result) == pytest.approx(whole, abs=1e-7)


@pytest.mark.parametrize("factor", [2.0, 0.5, 10.0])
def test_a_change_of_the_time_step(case1, factor):
    """The run is as accurate as a run with the coarser of the two steps from the beginning."""
    steps = round(1000 / factor)
    exact = end(case1.run("run 10000", dt=0.004))  # to t = 40

    def error(result):
        return np.abs(end(result) - exact)[:3].max()

    allowed = 2.0 * max(
        error(case1.run("run 2000")), error(case1.run(f"run {2 * steps}", dt=0.02 * factor))
    )
    assert error(case1.run(f"run 1000\ntimestep {0.02 * factor}\nrun {steps}")) < allowed + 1e-11
    assert error(case1.run(f"run 1000\ntimestep {0.0202 * factor}\nrun {steps}")) > allowed + 1e-11


def test_a_longer_step_and_back(case1):
    """The error is at most twice the error of a run in which the fix is defined again for the short step."""
    anew = "unfix move\nfix move body gear/quat molecule formulation ${formulation}\nfix_modify move energy yes"
    exact = end(case1.run("run 15000", dt=0.004))  # to t = 60
    kept, again = (
        np.abs(end(case1.run(f"run 1000\ntimestep 0.2\nrun 100\n{words}\ntimestep 0.02\nrun 1000")) - exact)[:3].max()
        for words in ("", anew)
    )
    assert kept < 2 * again + 1e-11


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
    result = lmp_tree.succeed(deck.replace("mass 1 1.0", "mass 1 1.0\n" + masses))
    assert result.stdout.count("atoms were changed since the last run") == 3
    thrown = result.thermo[1]
    assert thrown["f_move[1]"] == pytest.approx([0.75] * len(thrown["Step"]))
    assert thrown["f_move[2]"] == pytest.approx([0.0] * len(thrown["Step"]), abs=1e-20)
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
    result = lmp_tree.succeed(two_molecules("molecule reinit no", after=after))
    before, after = result.thermo
    assert after["f_move[1]"] == before["f_move[1]"]
    assert after["KinEng"] == pytest.approx(before["KinEng"], rel=1e-9)


@pytest.mark.parametrize("ranks", [1, 2])
def test_with_reinit_no_atoms_stay_in_their_bodies(lmp_tree, ranks):
    """They are put back before forces are evaluated; beyond the skin of neighbor lists that is an error."""
    before = "pair_style lj/cut 9.0\npair_coeff 1 1 1.0 1.0\nneigh_modify exclude molecule/intra all"
    after = "thermo_style custom step pe\nthermo_modify norm no format float %.17g\nrun 5\ngroup one id 1\n"
    after += "displace_atoms one move {} 0 0\nrun 5"
    result = lmp_tree.succeed(two_molecules("molecule reinit no", before, after.format(0.1)), ranks=ranks)
    first, again = result.thermo
    assert again["PotEng"][0] == pytest.approx(first["PotEng"][-1], rel=1e-14)
    far = "moved by up to 0.5 since the last run, but with reinit no bodies stay where they are"
    lmp_tree.refuse(two_molecules("molecule reinit no", before, after.format(0.5)), far, ranks=ranks)


@pytest.mark.parametrize("reinit", ["yes", "no"])
def test_velocities_given_after_the_fix_count(lmp_tree, reinit):
    """Before the first run reinit does not matter, as with fix rigid."""
    thermo = "thermo_style custom step ke f_move[1]\nthermo_modify norm no"
    after = f"{thermo}\nvelocity all set 0.5 0 0\nrun 1"
    result = lmp_tree.run(two_molecules(f"molecule reinit {reinit}", after=after))
    assert result.thermo[0]["f_move[1]"] == pytest.approx([0.75, 0.75])


def test_unfix_and_back(case1):
    whole = case1.run("run 1000")
    back = "fix move body gear/quat molecule formulation ${formulation}\nfix_modify move energy yes"
    again = case1.run(f"run 500\nunfix move\n{back}\nrun 500")
    # poses and velocities are recovered from the atoms, the rest from a new start
    assert end(again) == pytest.approx(end(whole), abs=1e-7)
    assert (end(again) != end(whole)).any()


def test_a_step_shorter_than_half_begins_anew(case1):
    """Histories are not restarted at one half, nor if the step is restored before it is used, nor if a start would not
    be full."""
    said = "changed by more than a factor of two; histories are rebuilt"
    shorter = case1.run("run 100\ntimestep 0.008\nrun 100")
    assert shorter.stdout.count(said) == 1
    assert shorter.stdout.count("force evaluations") == 2
    for commands, more in (
        ("timestep 0.01", {}),
        ("timestep 0.008\ntimestep 0.02", {}),
        ("timestep 0.008", {"keywords": "start zero"}),
        ("fix noise body langevin 1.0 1.0 1.0 4711\ntimestep 0.008", {}),
    ):
        assert said not in case1.run(f"run 100\n{commands}\nrun 100", **more).stdout, commands


# --- atoms that commands move relative to their body ---------------------------------------------
GROUPS = "group one id 4\ngroup two molecule 2\n"
REBUILT = "atoms were changed since the last run; bodies are rebuilt from them"


def said(lmp, data, change, words="", first="run 5\n", ranks=1):
    deck = water(data, f"gear/quat molecule {words}", run=f"{GROUPS}{first}{change}\nrun 5\nrun 5")
    return lmp.succeed(deck, ranks=ranks).words


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_displaced_atom(lmp_wheel, data, ranks):
    """The body gets another shape; with reinit no its atom is put back."""
    move = "displace_atoms one move 0.1 0.05 0"
    assert REBUILT in said(lmp_wheel, data, move, ranks=ranks)
    assert REBUILT not in said(lmp_wheel, data, move, "reinit no", ranks=ranks)


@pytest.mark.parametrize("first", ["", "run 5\n"])
def test_a_remapped_box(lmp_wheel, data, first):
    """Each atom is remapped by itself, which ends the next run; fix deform moves bodies as a whole."""
    remapped = water(data, run=f"{first}change_box all x scale 1.1 remap\nrun 5")
    lmp_wheel.refuse(remapped, "change_box moved each atom by itself")
    said(lmp_wheel, data, "fix d all deform 1 x scale 1.1\nrun 5\nunfix d", first=first)
