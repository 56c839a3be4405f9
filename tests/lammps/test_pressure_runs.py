"""Constant pressure from run to run: restarts, ranks, images, ramps, changes between runs."""

import re

import numpy as np
import pytest
from support import constant_pressure as scene
from support.constant_pressure import REPULSIVE, apart, ends, trimers
from support.scenes import FORMULATIONS, largest_change, one_after_the_other, water, water_data

MODES = {
    "NPH": "iso 0.3 0.3 1.0",
    "NPT": "aniso 0.3 0.3 1.0 temp 0.7 0.7 0.8 thermostat separate",
    "ramps": "x 0.3 0.9 1.0 y 0.5 -0.2 1.0 temp 0.6 0.9 0.8 pchain 2",
}
SPAN = "start 0 stop 100"
#: relative, of a number
EPSILON = np.finfo(float).eps


@pytest.fixture(autouse=True)
def data(tmp_path):
    return trimers(tmp_path / "data.trimers", n=3)


def pressed(words, dt=0.005, **settings):
    return scene.pressed(words, dt, pair=REPULSIVE, **settings)


def whole(folder, name):
    """A dump with its box, as text."""
    return (folder / name).read_text()


def run(lmp, decks, ranks=1):
    """Runs decks that write end0.dump, end1.dump, ...; the result and their texts."""
    decks = [deck.replace("end.dump", f"end{k}.dump") for k, deck in enumerate(decks)]
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    return result, [whole(lmp.folder, f"end{k}.dump") for k in range(len(decks))]


def continued(deck, file):
    """A deck that reads a restart file instead of the data."""
    return deck.replace("read_data data.trimers", f"read_restart {file}")


# --- restarts -----------------------------------------------------------------------------------


@pytest.mark.parametrize("processors, same", [("1 1 *", True), ("* * *", False)])
def test_the_bits_need_the_same_grid_of_ranks(lmp_tree, processors, same):
    """Without numbers LAMMPS divides the box of the file along its longest edge, which has changed."""
    words, settings = MODES["NPT"], dict(processors=processors)
    decks = [pressed(words, run=f"run 50 {SPAN}\nwrite_restart half\nrun 50 {SPAN}", **settings)]
    decks.append(continued(pressed(words, run=f"run 50 {SPAN}", **settings), "half"))
    result, (whole, again) = ends(lmp_tree, decks, 2)
    grids = re.findall(r"(\d by \d by \d) MPI processor grid", result.words)
    assert (grids[0] == grids[1]) == same
    assert apart(whole, again) == 0.0 if same else 0.0 < apart(whole, again) < 1e-12


# --- ranks and images ---------------------------------------------------------------------------


@pytest.mark.parametrize("mode", ["NVE", *MODES])
def test_molecules_many_periods_off(lmp_tree, mode):
    """LAMMPS' image flags count 511 periods.  Errors are errors of positions in space, with a fixed or moving box."""
    periods = (1, 20, 500)
    for far in periods:
        trimers(lmp_tree.folder / f"data.{far}", n=3, images=(far, -far * 4 // 5, far * 3 // 5))
    words = {"NVE": ""} | MODES
    formulations = FORMULATIONS if mode == "NVE" else ["momentum"]
    decks = [pressed(f"formulation {f} {words[mode]}", **more) for f in formulations
             for more in ({}, *(dict(box=f"read_data data.{far}") for far in periods))]
    _, frames = ends(lmp_tree, decks)
    for here, *others in (frames[n : n + 4] for n in range(0, len(frames), 4)):
        for far, off in zip(periods, others):
            flags = off[:, 6:9] - here[:, 6:9]
            assert np.abs(flags).max() == far and len(np.unique(flags)) > 2
            assert apart(here, off) < 30 * EPSILON * 6.0 * (far + 1)


# --- commands -----------------------------------------------------------------------------------


@pytest.mark.parametrize("mode", ["NPH", "NPT", "ramps"])
def test_ways_to_run_the_same_steps(lmp_tree, mode):
    """Runs in parts, with `every`, `pre no` or `run 0` in between, also during a ramp."""
    parts = {
        "one": f"run 100 {SPAN}",
        "two": f"run 40 {SPAN}\nrun 60 {SPAN}",
        "looks": f"run 0 {SPAN}\nrun 40 {SPAN}\nrun 0\nrun 0 {SPAN}\nrun 60 {SPAN}",
        "pre": f"run 40 {SPAN}\nrun 60 pre no {SPAN}",
        "every": f'run 100 {SPAN} every 20 "print x"',
        "upto": f"run 40 upto {SPAN}\nrun 0\nrun 100 upto {SPAN}",
    }
    result, found = ends(lmp_tree, [pressed(MODES[mode], run=text) for text in parts.values()])
    assert "a target, a damping time" not in result.log
    for name, rows in zip(parts, found):
        assert apart(rows, found[0]) < 1e-12, name
    values = np.concatenate([table["Econserve"] for table in result.thermo])
    assert np.ptp(values) < 1e-5


def test_a_run_of_zero_steps_changes_no_bit(lmp_tree):
    for mode in MODES.values():
        runs = [f"run 40 {SPAN}\n{look}run 60 {SPAN}" for look in ("", "run 0\n", f"run 0 {SPAN}\nrun 0\n")]
        _, found = run(lmp_tree, [pressed(mode, run=text) for text in runs])
        assert found[0] == found[1] == found[2]


def test_other_targets_and_steps_between_runs(lmp_tree):
    """The conserved energy is constant in each run; the box continues with its rate."""
    words = MODES["NPT"]
    other = words.replace("0.3 0.3", "0.8 0.8")
    again = f"unfix move\nfix move all gear/quat molecule {other}"
    decks = [
        pressed(words, run=f"run 50\n{again}\nrun 50"),
        pressed(words, run="run 50\ntimestep 0.01\nrun 50\ntimestep 0.0025\nrun 50"),
        pressed("iso 0.3 0.9 1.0", run="run 50\nrun 50"),
    ]
    result, _ = ends(lmp_tree, decks)
    assert result.log.count("a target, a damping time") >= 1
    for table in result.thermo:
        assert largest_change(table) < 2e-6
    one, two = result.thermo[2:4]
    assert two["f_move[23]"][0] == pytest.approx(one["f_move[23]"][-1], rel=1e-9)
    assert two["Econserve"][0] == pytest.approx(one["Econserve"][-1], rel=1e-9)


def test_another_step_keeps_the_motion(lmp_tree):
    """Compared with a run with short steps only; a lost rate of the box would be detected."""
    words = "values 7 " + MODES["NPT"]
    decks = [
        pressed(words, 0.0025, run="run 160"),
        pressed(words, 0.005, run="run 40\ntimestep 0.0025\nrun 80"),
    ]
    result, (exact, found) = ends(lmp_tree, decks)
    assert apart(exact, found) < 1e-7
    assert result.thermo[2]["Lx"][-1] == pytest.approx(result.thermo[0]["Lx"][-1], abs=1e-9)


def test_change_box_between_runs(lmp_tree):
    """The box is another one, and moves from there on."""
    (result, _) = ends(lmp_tree, [pressed(MODES["NPT"], run="run 0\nchange_box all x delta -0.05 0.05 units box\nrun 50")])
    before, after = result.thermo
    assert after["Lx"][0] == pytest.approx(before["Lx"][0] + 0.1, rel=1e-12)
    assert largest_change(after) < 1e-6


def test_a_fix_that_comes_again_has_lost_its_rate(lmp_tree):
    """Without unfix the box continues to move; a new fix starts with a box at rest."""
    fix = f"unfix move\nfix move all gear/quat molecule {MODES['NPT']}\n"
    result, _ = ends(lmp_tree, [pressed(MODES["NPT"], run=f"run 50\n{fix}run 50")])
    before, after = result.thermo
    assert abs(before["f_move[23]"][-1]) > 1e-3 and after["f_move[23]"][0] == 0.0
    assert largest_change(after) < 1e-6


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("other", ["", "compute move_virial all temp\n"])
def test_a_deleted_compute(lmp_tree, other, ranks):
    deck = pressed(MODES["NPT"], run=f"run 5\nuncompute move_virial\n{other}run 5")
    message = "compute move_virial, with which the fix asks LAMMPS for the virial, was deleted or replaced"
    lmp_tree.refuse(deck, message, ranks=ranks)


def test_the_fix_again_after_its_compute_was_deleted(lmp_tree):
    again = f"unfix move\nfix move all gear/quat molecule {MODES['NPT']}\n"
    lmp_tree.succeed(pressed(MODES["NPT"], run=f"run 5\nuncompute move_virial\n{again}run 5"))


def test_forces_that_reach_far(lmp_tree):
    """Water with PPPM and a tail correction: order of the conserved energy."""
    data = water_data(lmp_tree.folder / "data.water", shift=1.65)
    pair = "pair_style lj/charmm/coul/long 3.5 4.6\npair_coeff * * 0.0 1.0\npair_coeff 1 1 0.1553 3.166\npair_modify table 0\n"
    pair += "kspace_style pppm 1e-7\nkspace_modify order 7"
    settings = dict(pair=pair, skin=2.0, thermo=1, columns="econserve vol")
    fix = "gear/quat molecule values 5 iso 1000 1000 300 temp 300 300 100"
    decks = [water(data, fix, dt=dt, steps=round(40 / dt), **settings).replace("fix_modify move energy yes", "") for dt in (4.0, 2.0)]
    result = lmp_tree.succeed(one_after_the_other(decks))
    changes = [largest_change(table) for table in result.thermo]
    assert np.log2(changes[0] / changes[1]) > 3.4, changes
    assert largest_change(result.thermo[0], "Volume") > 1.0
