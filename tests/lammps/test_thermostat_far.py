"""Keyword temp far from its target and with many molecules, where chains are stiff."""

import re

import numpy as np
import pytest
from support.scenes import one_after_the_other, template, water, water_data

# Dumbbells on a lattice with few collisions: soft spheres, so that forces are smooth
GAS = """
units lj
atom_style molecular
lattice sc 0.02
region box block 0 {n} 0 {n} 0 {n}
create_box 1 box
mass 1 1.0
molecule dumbbell dumbbell.molecule
create_atoms 0 box mol dumbbell 4711
pair_style soft 1.0
pair_coeff 1 1 {soft}
neigh_modify delay 0 every 1 check yes exclude molecule/intra all
velocity all create 1.0 4711 dist gaussian loop geom
timestep {dt}
fix move all gear/quat molecule {words}
thermo_style custom step time temp pe ke etotal econserve ecouple f_move[*]
thermo_modify norm no format float %.17g
thermo {every}
{run}
"""
DUMBBELL = template([(-0.5, 0, 0), (0.5, 0, 0)])
TAKEN, T_ROTATION = "f_move[9]", "f_move[11]"


@pytest.fixture
def gas(lmp_tree):
    (lmp_tree.folder / "dumbbell.molecule").write_text(DUMBBELL)

    def deck(words, n=8, dt=0.01, run="run 400", soft=5.0, every=20):
        return GAS.format(words=words, n=n, dt=dt, run=run, soft=soft, every=every)

    return deck


def change(table):
    """Change of the conserved energy, relative to the heat removed or to the kinetic energy."""
    conserved, taken = np.array(table["Econserve"]), np.abs(table[TAKEN])
    return np.ptp(conserved) / max(np.max(taken), table["KinEng"][0])


@pytest.mark.parametrize("kind, target", [("total", 0.2), ("separate", 1.5), ("total", 10.0)])
def test_many_molecules_reach_a_target(lmp_tree, gas, kind, target):
    words = f"temp {target} {target} 1.0 thermostat {kind}"
    (table,) = lmp_tree.succeed(gas(words, n=16, run="run 500")).thermo
    assert change(table) < 1e-4
    kinetic = np.array(table["f_move[1]"]) + np.array(table["f_move[2]"])
    degrees = 2 * kinetic[-5:].mean() / (5 * 16**3 - 3)
    # a chain of three heats a gas slowly
    assert degrees == pytest.approx(target, rel=0.15) if target < 2.0 else degrees > 3.0


@pytest.mark.parametrize("length", [1, 10])
def test_any_length_and_few_steps_of_damping(lmp_tree, gas, length):
    decks = [
        gas(f"temp {target} {target} {damp} tchain {length}")
        for damp in (0.1, 100.0)
        for target in (0.3, 3.0)
    ]
    for table in lmp_tree.succeed(one_after_the_other(decks)).thermo:
        assert change(table) < 2e-3


# --- a first script for water -------------------------------------------------------------------


def test_water_from_a_lattice(lmp_tree):
    """Ordered molecules at 500 K, whose potential energy becomes heat, with a target of 300 K."""
    fix, dt = "gear/quat molecule temp 300 300 100", 2.0
    data = water_data(lmp_tree.folder / "data")
    deck = water(data, fix, dt=dt, steps=round(600 / dt), thermo=10, columns="econserve ecouple f_move[*]")
    deck = deck.replace("fix_modify move energy yes", "velocity all scale 500")
    (table,) = lmp_tree.succeed(deck).thermo
    mean = np.mean(table[T_ROTATION][-10:])
    assert mean == pytest.approx(300, rel=0.25)


# --- overlaps -----------------------------------------------------------------------------------


def overlapping(deck):
    """Molecules on a narrow lattice, whose potential energy becomes twenty times the kinetic energy."""
    return deck.replace("lattice sc 0.02", "lattice sc 0.3")


def test_an_overlap_under_tolerance(lmp_tree, gas):
    words = "temp 1.0 1.0 0.5 tolerance 1e-6 dtmax 0.02"
    (table,) = lmp_tree.succeed(overlapping(gas(words, n=9, soft=300.0, run="run 500"))).thermo
    taken = np.array(table["f_move[18]"])
    assert taken[-1] > 15000.0
    assert np.ptp(table["Econserve"]) < 1e-4 * taken[-1]
    assert table["f_move[16]"][-1] < 0.05 * 500  # repeated steps
    assert table["Time"][-1] > 0.2


# --- too strong ---------------------------------------------------------------------------------

ADVICE = re.compile(
    r"the friction of the thermostat is \S+ in a step, and the method follows \S+; use a damping time of (\S+) or longer"
)


def test_an_unstable_thermostat_is_named(lmp_tree, gas):
    """With a damping time of two steps and kinetic energy from overlaps; the remedy helps."""
    words = "values 7 temp 1.0 1.0 {} tchain 1"
    deck = overlapping(gas(words.format("{}"), soft=300.0, dt=0.002, run="run 200"))
    damp = ADVICE.search(lmp_tree.refuse(deck.format(0.004), "blow-up").words.split("blow-up")[1])[1]
    lmp_tree.succeed(deck.format(max(float(damp), 0.2)))
