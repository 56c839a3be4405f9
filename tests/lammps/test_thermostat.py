"""Keyword temp: outputs, canonical distributions, degrees of freedom, targets.

The equations are in test_equations.py, restarts in test_restart_state.py, unsupported settings in test_bad_input.py.
"""

import re

import numpy as np
import pytest
from scipy import stats
from support.scenes import MOLECULES, largest_change
from support.constant_temperature import COLUMNS, COMMON, TEMP, cluster, run

def test_the_columns_belong_together(lmp_tree):
    deck = cluster("temp 0.5 0.7 0.3 thermostat separate tchain 2", 0.016)
    result = run(lmp_tree, [deck])
    table = {name: np.array(values) for name, values in result.thermo[0].items()}
    assert "of 9 degrees of freedom of translation, without those of the total" in result.log
    assert "and 11 of rotation" in result.log
    assert np.abs(table["Econserve"] - table["TotEng"] - table["f_move"]).max() < 1e-14
    assert (table["Ecouple"] == table["f_move"]).all()
    # the scalar includes the change from the predicted to the corrected pose, which is small
    assert 0.0 < np.abs(table["f_move"] - table["f_move[9]"]).max() < 1e-4
    for kinetic, temperature, freedoms in (("1", "10", 9), ("2", "11", 11)):
        found = 2 * table[f"f_move[{kinetic}]"] / freedoms
        assert table[f"f_move[{temperature}]"] == pytest.approx(found, rel=1e-12)
    steps = table["Step"]
    assert table["f_move[12]"] == pytest.approx(0.5 + 0.2 * steps / steps[-1], rel=1e-12)
    assert abs(table["f_move[9]"][-1]) > 1.0


@pytest.mark.parametrize("words", ["temp 0.5 0.5 0.3", "temp 0.5 0.5 0.3 start zero"])
def test_time_runs_backward(lmp_tree, words):
    """With and without a new start of the histories."""
    result = run(lmp_tree, [cluster(words, run="run 200\ntimestep -0.004\nrun 200")])
    there, back = result.thermo
    for name in ("f_move[10]", "f_move[11]"):
        assert abs(there[name][-1] - there[name][0]) > 0.01
        assert back[name][-1] == pytest.approx(there[name][0], abs=1e-3 if "zero" in words else 1e-8)


HELD = """
units lj
atom_style full
atom_modify map array
boundary f f f
region box block -60 60 -60 60 -60 60
create_box 1 box
create_atoms 1 single 0.5 -0.3 0.4
create_atoms 1 single -0.9 0.1 0.2
create_atoms 1 single 0.1 0.8 -0.7
mass 1 1.0
set group all mol 1
set atom 2 charge 1.0
set atom 3 charge -1.0
velocity all create 0.5 4711 loop geom
pair_style none
comm_modify cutoff 4
group handle id 1
fix move all gear/quat molecule temp 1 1 0.8 values 5 report no
fix x handle spring tether 1.0 0 NULL NULL 0
fix y handle spring tether 1.7 NULL 0 NULL 0
fix z handle spring tether 2.6 NULL NULL 0 0
fix field all efield 0 0 1.2
timestep 0.08
variable cosine equal (z[2]-z[3])/1.5165750888
variable x equal x[1]
variable v equal vcm(all,z)*sqrt(3)
variable energy equal 2*(f_move[1]+f_move[2])+x[1]^2+1.7*y[1]^2+2.6*z[1]^2
thermo_style custom step v_cosine v_x v_v v_energy
thermo 250
run 600000
"""


def test_distributions_are_canonical(lmp_wheel):
    """Of a body that a site off its center ties to springs, with a dipole in a field."""
    table = lmp_wheel.succeed(HELD, timeout=300).thermo[0]
    strength = 1.2 * 1.5165750888
    exact = {
        "cosine": lambda u: np.expm1(strength * (u + 1)) / np.expm1(2 * strength),
        "x": stats.norm.cdf,
        "v": stats.norm.cdf,
        "energy": stats.chi2(9).cdf,
    }
    for name, distribution in exact.items():
        samples = np.array(table[f"v_{name}"][20:])
        assert stats.kstest(samples, distribution).pvalue > 0.001, name  # one test in 250 fails for other bodies


# bodies, keywords and settings, degrees of freedom of translation and rotation
FREEDOMS = {
    "points": ([[(0, 0, 0)], [(1.2, 0, 0.1)], [(0, 1.3, 0)]], "", {}, (6, 0)),
    "linear": ([[(0, 0, 0), (0, 0, 1)], [(1.5, 0, 0), (1.5, 1, 0)]], "", {}, (3, 4)),
    "held": (MOLECULES, "force 1 off on on torque 2 off off off", {}, (9, 8)),
    "outside": (MOLECULES, "", {"after": "fix one all spring tether 1.0 0 0 0 0.0"}, (12, 11)),
    "flat": (
        [[(0, 0, 0), (1, 0, 0)], [(0, 2, 0), (1, 2.2, 0)], [(2.5, 1, 0)]],
        "",
        {"dimension": 2, "box": "-60 60 -60 60 -0.5 0.5", "boundary": "p p p"},
        (4, 2),
    ),
}


@pytest.mark.parametrize("name", FREEDOMS)
def test_degrees_of_freedom(lmp_tree, name):
    bodies, words, settings, (translation, rotation) = FREEDOMS[name]
    deck = cluster(f"{words} {TEMP}", 0.002, 0.2, bodies=bodies, **settings)
    deck = deck.replace("exclude molecule/intra all", "every 1") if name == "points" else deck
    result = run(lmp_tree, [deck])
    said = re.search(r"thermostat of (\d+) degrees of freedom.* and (\d+) of rotation", result.log)
    assert tuple(map(int, said.groups())) == (translation, rotation)
    table = result.thermo[0]
    if name in ("outside", "held"):  # the springs' energy is not in pe, and the masks do work
        return
    assert largest_change(table, "Econserve") < 1e-6
    assert largest_change(table, "TotEng") > 1e-2


def test_what_is_off_has_no_friction(lmp_tree):
    """Momenta and angular momenta in masked directions are constant."""
    masks = "force 1 off off off torque 1 off off off"
    deck = cluster(f"{masks} {TEMP}", dumped="", time=1.6)
    deck = deck.replace(COLUMNS, COLUMNS + " f_move[1][4] f_move[1][23] f_move[2][4]")
    (table,) = run(lmp_tree, [deck]).thermo
    assert largest_change(table, "f_move[1][4]") < 1e-13
    assert largest_change(table, "f_move[1][23]") < 1e-6
    assert largest_change(table, "f_move[2][4]") > 1e-2
    assert largest_change(table, "Econserve") > 1e-3  # the constraint does work on it


# --- targets ------------------------------------------------------------------------------------


def test_another_target_starts_anew(lmp_tree):
    words = TEMP
    commands = f"run 100\nunfix move\nfix move all gear/quat molecule {words}\nrun 100"
    again = cluster(words, run="run 100\nrun 100\nrun 100 start 0 stop 300")
    step = cluster("temp 0.5 0.9 0.3", run="run 100\nrun 100")
    results = run(lmp_tree, [again, step])
    assert results.log.count("a target, a damping time") == 1
    for table in results.thermo:
        assert largest_change(table, "Econserve") < 1e-7
    last, then = results.thermo[3], results.thermo[4]
    assert (last["f_move[12]"][-1], then["f_move[12]"][0]) == (pytest.approx(0.9), pytest.approx(0.5))
    # the energy removed by the chains continues
    assert then["f_move[9]"][0] != 0.0 and then["f_move[13]"][0] == last["f_move[13]"][-1]


def test_another_step(lmp_tree):
    commands = "run 100\ntimestep 0.003\nrun 100\ntimestep 0.004\nrun 100"
    tables = run(lmp_tree, [cluster(TEMP, run=commands)]).thermo
    values = np.concatenate([table["Econserve"] for table in tables])
    assert np.abs(values - values[0]).max() < 1e-7


# --- other fixes, ranks, restart -----------------------------------------------------------------


def test_several_fixes(lmp_tree):
    deck = cluster(TEMP)
    deck = deck.replace("fix move all", "group some molecule 1 2\ngroup others subtract all some\nfix move some")
    deck = deck.replace("timestep", f"fix too others gear/quat molecule {TEMP} thermostat separate\ntimestep")
    result = run(lmp_tree, [deck])
    assert len(re.findall("6 degrees of freedom of translation, with those", result.log)) == 2
    assert largest_change(result.thermo[0], "Econserve") < 1e-6
    assert largest_change(result.thermo[0], "TotEng") > 1e-2


def test_a_body_is_taken_away(lmp_tree):
    commands = "run 20\ngroup gone molecule 4\ndelete_atoms group gone compress no\nrun 100"
    deck = cluster(TEMP, run=commands, every=20, style=COMMON, columns=f"{COLUMNS} v_common")
    table = run(lmp_tree, [deck], 2).thermo[1]
    assert largest_change(table, "Econserve") < 1e-7
    freedoms = (2 * np.array(table["f_move[1]"]) - table["v_common"]) / table["f_move[10]"]
    assert freedoms == pytest.approx(6.0)
    assert min(table["v_common"]) > 1e-2


def test_a_damping_time_that_is_too_short(lmp_tree):
    """With tolerance no step is longer than a tenth of the damping time."""
    for words, warned in (("0.03", True), ("0.05", False), ("0.03 tolerance 1e-6", False)):
        result = run(lmp_tree, [cluster(f"temp 0.5 0.5 {words}", run="run 1")])
        assert ("is less than 10 time steps" in result.output + result.log) == warned
