"""Keyword isokinetic: constant kinetic energy, the heat removed, restarts, unsupported settings.

The independence of the trajectory from the ranks is tested in test_large_bodies.py.
"""

import numpy as np
import pytest
from support.constant_temperature import run
from support.scenes import BEFORE, MOLECULES, largest_change, placed, two_molecules

MODES = ["total", "separate"]
PARTS = ["f_move[1]", "f_move[2]"]  # of translation and rotation

ENERGIES = """
variable k equal f_move[1]+f_move[2]
variable all equal etotal+f_move[9]
"""


def cluster(words, dt=0.004, time=0.8, run=None, every=None, style=""):
    steps = round(time / dt)
    return placed(
        MOLECULES,
        box="-9 9 -9 9 -9 9",
        before=BEFORE + style,
        fix=f"gear/quat molecule formulation first {words}",
        after=ENERGIES,
        columns="v_k v_all f_move[9] f_move[10] f_move[11]",
        dt=dt,
        thermo=every or steps // 8,
        run=run or f"run {steps}",
    )


@pytest.mark.parametrize("mode", MODES)
def test_kinetic_energy_and_heat_to_the_order_of_the_method(lmp_tree, mode):
    """This is true also in the first steps, because the start includes the constraint."""
    values, steps = 6, (0.008, 0.004, 0.002)
    words = f"isokinetic {mode} rescale no values {values}"
    decks = [cluster(words, dt) for dt in steps]
    decks += [cluster(words, dt, time=2 * dt, every=1) for dt in steps]
    tables = run(lmp_tree, decks).thermo
    for first, column in ((0, "v_k"), (0, "v_all"), (3, "v_k"), (3, "v_all")):
        errors = [largest_change(table, column) for table in tables[first : first + 3]]
        assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > values - 1.3, (first, column)
    constant = [largest_change(tables[2], part) < 1e-6 for part in PARTS]
    assert constant == [mode == "separate"] * 2
    # energy is exchanged, and the heat is large
    assert largest_change(tables[2], "TotEng") > 1e4 * largest_change(tables[2], "v_all")


@pytest.mark.parametrize("mode", MODES)
def test_rescaled_momenta_keep_it_to_rounding(lmp_tree, mode):
    decks = [cluster(f"isokinetic {mode} rescale {word}", 0.008, 8.0) for word in ("yes", "no")]
    kept, free = run(lmp_tree, decks).thermo
    for column in ["v_k"] if mode == "total" else PARTS:
        assert largest_change(kept, column) < 1e-13 * kept[column][0]
        assert largest_change(free, column) > 1e-9 * free[column][0]
    assert largest_change(kept, "v_all") < 1e-3 * largest_change(kept, "TotEng")


def test_points_have_one_multiplier(lmp_tree):
    """Bodies of one atom have no rotation, and none is required."""
    deck = cluster("isokinetic separate", 0.002)
    for old, new in (
        ("exclude molecule/intra all", "every 1"),
        ("0.3 1.0", "0.3 0.4"),
        ("gear/quat molecule", "gear/quat custom v_single"),
        ("fix move all", "variable single atom id\nfix move all"),
    ):
        deck = deck.replace(old, new)
    table = run(lmp_tree, [deck]).thermo[0]
    assert set(table["f_move[2]"]) == set(table["f_move[11]"]) == {0.0}
    assert largest_change(table, "v_k") < 1e-13 * table["v_k"][0]
    assert largest_change(table, "v_all") < 1e-4 * largest_change(table, "TotEng")


# --- runs, restart ---------------------------------------------------------------------


def test_the_energy_to_keep_is_that_of_the_atoms(lmp_tree):
    """Velocities scaled between runs, and a body removed: the energy at that time is kept."""
    commands = (
        "run 20\nvariable fast atom 1.1*vx\nvelocity all set v_fast NULL NULL\nrun 20\n"
        "group gone molecule 4\ndelete_atoms group gone compress no\nrun 20\ntimestep 0.002\nrun 20"
    )
    tables = run(lmp_tree, [cluster("isokinetic total", run=commands, every=10)], 2).thermo
    for table in tables:
        assert largest_change(table, "v_k") < 1e-12 * table["v_k"][0]
    kept = [table["v_k"][0] for table in tables]
    assert kept[0] < 0.999 * kept[1] and kept[2] < 0.999 * kept[1]
    assert kept[3] == pytest.approx(kept[2], rel=1e-12)
    # the step has changed, the heat continues
    heat = [table["f_move[9]"] for table in tables]
    assert heat[2][-1] == heat[3][0] != 0.0
    assert largest_change(tables[3], "v_all") < 1e-4


# --- unsupported settings ----------------------------------------------------------------------

# mode, velocities, message
AT_REST = [
    ("total", "0 0 0", "a kinetic energy of the bodies is zero"),
    ("separate", "0 0 0", "(translation 0, rotation 0)"),
    ("separate", "0.3 0 0.1", "a kinetic energy of the bodies is zero"),
    ("separate", "v_sx v_sy 0", "a kinetic energy of the bodies is zero"),
]


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("mode, velocities, message", AT_REST)
def test_nothing_to_keep_is_refused(lmp_tree, mode, velocities, message, ranks):
    # one body about the origin rotates without translation
    before = f"variable sx atom -y\nvariable sy atom x\nvelocity all set {velocities}"
    deck = two_molecules(f"molecule formulation first isokinetic {mode}", before)
    if "v_sx" in velocities:
        square = "".join(f"create_atoms 1 single {x} 0\n" for x in ("1 0", "-1 0", "0 1", "0 -1"))
        lines = [line for line in deck.splitlines() if not line.startswith(("create_atoms", "set"))]
        deck = "\n".join(lines).replace("mass 1", f"{square}set group all mol 1\nmass 1")
    lmp_tree.refuse(deck, message, ranks=ranks)
