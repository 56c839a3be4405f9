"""Keyword temp with step control (tolerance), and with insertion and removal of bodies (mol)."""

import numpy as np
import pytest
from support.scenes import MOLECULES, largest_change, one_after_the_other, placed, template
from scipy.integrate import solve_ivp
from support.insertion import INSERT, MOL, TEMPLATE, N, close, evaporating, liquid, poses
from support.constant_temperature import COMMON, END, KINDS, cluster, continued
from support.step_control import ELEMENTS, LARGEST, LOADS, NEXT, REPEATED, tables

TEMP = "temp 0.5 0.5 0.3"
TAKEN, XI = "f_move[18]", "f_move[22]"  # with tolerance
BESIDE = " ".join(["econserve ecouple", *ELEMENTS, TAKEN, XI])
UNTIL = "variable now equal time\nfix stop all halt 1 v_now >= {} error continue\nrun 5000"


def changing(words, eps, run=UNTIL.format(1.6), **settings):
    settings = dict(every=1, columns=BESIDE) | settings
    return cluster(f"{words} tolerance {eps}", run=run, **settings)


# --- tolerance ----------------------------------------------------------------------------------


# also a damping time of some twenty steps, a tenth of which limits the step for larger eps
@pytest.mark.parametrize("temp, digits", [(TEMP, (6, 9, 12)), ("temp 0.5 0.5 0.05", (9, 11, 13))])
def test_the_conserved_quantity_follows_eps(lmp_tree, temp, digits):
    powers = [("", k) for k in digits] + [(" energy", k) for k in digits[:2]]
    eps = [f"1e-{k}{unit}" for unit, k in powers]
    decks = [changing(f"{temp} thermostat separate", e) for e in eps]
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    changes = [largest_change(run, "Econserve") for run in runs]
    for large, small in ((0, 2), (3, 4)):
        decades = powers[small][1] - powers[large][1]
        assert 0.6 < np.log10(changes[large] / changes[small]) / decades < 1.25
    for run, change in zip(runs, changes):
        assert run[LARGEST][-1] <= 1 and run["Time"][-1] >= 1.6
        assert largest_change(run, "TotEng") > 20 * change
        assert len(set(run[NEXT])) > 5
    assert any(np.ptp(run[LOADS]) > 0 for run in runs)
    assert sum(run[REPEATED][-1] for run in runs) > 5


# --- bodies that hardly rotate ------------------------------------------------------------------

#: of rotation
FREEDOMS, TARGET, DAMP = 6, 0.5, 0.3


def coasting(words, spin, run=UNTIL.format(9.0), columns=f"f_move[23] {LARGEST}", dt=0.004):
    """Two molecules that never collide; spin: of each about the z axis."""
    bodies, velocities = [], []
    for side in (-1.0, 1.0):
        sites = np.array(MOLECULES[0]) - np.mean(MOLECULES[0], axis=0)
        bodies.append(sites + [0.0, 5.0 * side, 0.0])
        velocities += [(0.6 * side - spin * y, spin * x, 0.0) for x, y, _ in sites]
    return placed(
        bodies,
        velocities,
        boundary="p p p",
        box="-9 9 -9 9 -9 9",
        before="pair_style zero 1.0\npair_coeff * *",
        fix=f"gear/quat molecule temp {TARGET} {TARGET} {DAMP} {words}",
        dt=dt,
        thermo=1,
        columns=columns,
        run=run,
    ).replace("fix_modify move energy yes", "")


def warming(times, kinetic):
    """Logarithm of a kinetic energy, and xi of its chain of three, without forces; an independent solution."""

    def rates(_, y):
        log_kinetic, one, two, three = y
        pushed = 2 * np.exp(log_kinetic) / (FREEDOMS * TARGET)
        return [
            -2 * one,
            (pushed - 1) / DAMP**2 - one * two,
            FREEDOMS * one**2 - 1 / DAMP**2 - two * three,
            two**2 - 1 / DAMP**2,
        ]

    start = [np.log(kinetic), 0.0, 0.0, 0.0]
    return solve_ivp(rates, (0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12).y[:2]


@pytest.mark.parametrize("unit", ["length", "energy"])
def test_a_rotation_that_is_almost_zero_grows_as_it_should(lmp_tree, unit):
    """The errors of bodies that hardly move permit any step; the friction is accurate nevertheless."""
    eps, errors = ("1e-6", "1e-9"), []
    decks = [coasting(f"thermostat separate tolerance {e} {unit}", 1e-9) for e in eps]
    for run in tables(lmp_tree.succeed(one_after_the_other(decks))):
        kinetic, xi = run["f_move[2]"], run["f_move[23]"]
        log_kinetic, expected = warming(run["Time"], kinetic[0])
        assert kinetic[0] < 1e-17 and 0.1 < kinetic[-1] < 10.0
        assert run[LARGEST][-1] <= 1
        errors.append([np.abs(np.log(kinetic) - log_kinetic).max(), np.abs(xi - expected).max()])
    assert np.max(errors) < 1e-4
    assert np.divide(*errors).min() > 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_cold_rotation_beside_one_chain_stays_cold(lmp_tree, kind):
    last = tables(lmp_tree.succeed(coasting(f"thermostat {kind}", 1e-9, "run 2500", columns="")))[-1]
    assert (last["f_move[2]"][-1] < 1e-15) == (kind == "total")


# --- insertion and removal ----------------------------------------------------------------------

TRIANGLE = template([(0, 0, 0), (1, 0, 0), (0, 1.1, 0.2)])
COMES = """
region there block 4.0 4.1 1.5 1.6 1.5 1.6
fix in all deposit 1 0 1 4711 region there near 0.5 mol tri rigid move vx -0.3 -0.3 vy 0.1 0.1 vz 0.1 0.1
"""
BOLTZMANN = 0.0019872067  # kcal/mol/K


def joined(lmp, words, dt, columns="econserve", run=None, comes=COMES, **settings):
    """A fifth molecule is inserted into the cluster in the first step, with a momentum."""
    (lmp.folder / "tri").write_text(TRIANGLE)
    columns += " v_common"
    deck = cluster(f"{words} mol tri", dt, every=1, columns=columns, run=run, style=COMMON, **settings)
    return deck.replace("fix move", "molecule tri tri\nfix move").replace("timestep", f"{comes}timestep")


def kinetic_and_potential(table):
    return table["PotEng"] + table["f_move[1]"] + table["f_move[2]"]


def test_what_is_conserved_when_a_body_comes(lmp_tree):
    """From the insertion on, as accurate as without a thermostat, and the energy of the chains is continuous."""
    steps = (0.004, 0.002, 0.001)
    columns = "econserve f_move[9] f_move[10] f_move[11] f_move[13]"
    decks = [joined(lmp_tree, "", dt) for dt in steps]
    decks += [joined(lmp_tree, TEMP, dt, columns=columns) for dt in steps]
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    without = [np.ptp(kinetic_and_potential(run)[1:]) for run in runs[:3]]
    changes = []
    for run, dt in zip(runs[3:], steps):
        taken = run["f_move[9]"]
        changes.append(np.ptp((kinetic_and_potential(run) + taken)[1:]))
        twice = {1: 2 * run["f_move[1]"], 2: 2 * run["f_move[2]"]}
        assert run["v_common"][-1] > 1e-2  # bodies that come bring momentum, which counts
        power = run["f_move[13]"] * (twice[1] + twice[2])
        assert np.abs(np.diff(taken)[1:] - dt * (power[1:] + power[:-1])[1:] / 2).max() < 20 * dt**2
        assert abs(np.diff(taken)[0]) < 20 * dt**2  # xi grows from zero
        for kinetic, temperature, freedoms in ((1, "10", (12, 15)), (2, "11", (11, 14))):
            found = twice[kinetic] / run[f"f_move[{temperature}]"]
            assert found == pytest.approx([freedoms[0]] + [freedoms[1]] * (len(found) - 1), rel=1e-10)
    for change, one in zip(changes, without):
        assert change < 3 * one
    assert np.log2(changes[0] / changes[-1]) / 2 > 0.9


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_molecules_come_and_go(lmp_tree, ranks):
    """Degrees of freedom are updated, on any number of ranks."""
    show = "thermo_style custom step f_move[1] f_move[2] f_move[10] f_move[11] f_move[13]\n"
    commands = evaporating() + INSERT.format(count=3).replace("0 5 4711", "0 7 4711")
    commands += f"{show}thermo_modify lost error format float %.17g\nthermo 1\nrun 20"
    ends = []
    for number in {1, ranks}:
        deck = liquid(lmp_tree, commands, f"{MOL} temp 300 300 50 thermostat separate", TEMPLATE, dt=0.1)
        deck = deck.replace("fix_modify move energy yes", "")
        (table,) = tables(lmp_tree.succeed(deck, ranks=number))
        steps = np.arange(21)
        present = N + (steps >= 1) + (steps >= 8) + (steps >= 15) - (steps >= 5) - (steps >= 10)
        for kinetic, temperature in (("1", "10"), ("2", "11")):
            freedoms = 2 * table[f"f_move[{kinetic}]"] / (table[f"f_move[{temperature}]"] * BOLTZMANN)
            assert freedoms == pytest.approx(3.0 * present, rel=1e-6)
        assert (np.diff(table["f_move[13]"]) != 0).all()
        ends.append(poses(lmp_tree))
    close(ends[0], ends[-1], 1e-9)


def test_no_bodies_yet(lmp_tree):
    """Chains without degrees of freedom are constant, and start with the first insertion."""
    columns = "econserve f_move[9] f_move[10] f_move[11] f_move[13]"
    comes = COMES.replace("4.0 4.1 1.5 1.6 1.5 1.6", "0 4 0 4 0 4").replace("deposit 1 0 1", "deposit 2 0 10")
    run = f"run 20\n{comes}\nrun 200"
    deck = joined(lmp_tree, TEMP, 0.002, columns, run, comes="", bodies=[])
    deck = deck.replace("velocity all create 0.6 4711 loop geom", "")
    empty, table = tables(lmp_tree.succeed(deck))
    for column in ("f_move[9]", "f_move[11]", "f_move[13]"):
        assert (empty[column] == 0).all()
    twice = np.array([2 * table[f"f_move[{k}]"][-1] for k in (1, 2)])
    freedoms = twice / [table["f_move[10]"][-1], table["f_move[11]"][-1]]
    assert freedoms == pytest.approx([6, 6], rel=1e-10)
    energy = kinetic_and_potential(table) + table["f_move[9]"]
    assert np.ptp(energy[30:]) < 0.01 * np.ptp(kinetic_and_potential(table)[30:])


def test_a_restart_with_an_inserted_body(lmp_tree):
    words, tail = f"{TEMP} thermostat separate", END.format("{}")
    whole = joined(lmp_tree, words, 0.004, run=f"run 40\n{tail.format('whole')}")
    halves = joined(lmp_tree, words, 0.004, run="run 20\nwrite_restart half")
    again = joined(lmp_tree, words, 0.004, run=f"run 20\n{tail.format('again')}")
    again = continued(again, "half").replace(COMES, "\n")
    lmp_tree.succeed(one_after_the_other([whole, halves, again]))
    ends = [(lmp_tree.folder / f"{name}.end").read_text() for name in ("whole", "again")]
    assert ends[0] == ends[1] and len(ends[0].splitlines()) == 9 + 14
