"""Keyword temp far from its target and with many molecules, where chains are stiff."""

import re

import numpy as np
import pytest
from scenes import one_after_the_other, water, water_data

# Dumbbells on a lattice that hardly meet: soft spheres, so that forces are smooth
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
DUMBBELL = "# dumbbell\n2 atoms\nCoords\n\n1 -0.5 0 0\n2 0.5 0 0\n\nTypes\n\n1 1\n2 1\n"
TAKEN, T_TRANSLATION, T_ROTATION = "f_move[9]", "f_move[10]", "f_move[11]"


@pytest.fixture
def gas(lmp_tree):
    (lmp_tree.folder / "dumbbell.molecule").write_text(DUMBBELL)

    def deck(words, n=8, dt=0.01, run="run 400", soft=5.0, every=20):
        return GAS.format(words=words, n=n, dt=dt, run=run, soft=soft, every=every)

    return deck


def change(table):
    """Of the conserved energy, as a part of the heat taken or of the kinetic energy."""
    conserved, taken = np.array(table["Econserve"]), np.abs(table[TAKEN])
    return np.ptp(conserved) / max(np.max(taken), table["KinEng"][0])


@pytest.mark.parametrize("target", [0.2, 0.8, 1.2, 1.5, 10.0])
@pytest.mark.parametrize("kind", ["total", "separate"])
def test_many_molecules_reach_a_target(lmp_tree, gas, kind, target):
    words = f"temp {target} {target} 1.0 thermostat {kind}"
    (table,) = lmp_tree.succeed(gas(words, n=16, run="run 500")).thermo
    assert change(table) < 1e-4
    kinetic = np.array(table["f_move[1]"]) + np.array(table["f_move[2]"])
    degrees = 2 * kinetic[-5:].mean() / (5 * 16**3 - 3)
    # a chain of three heats a gas slowly
    assert degrees == pytest.approx(target, rel=0.15) if target < 2.0 else degrees > 3.0


@pytest.mark.parametrize("length", [1, 2, 4, 10])
def test_any_length_and_few_steps_of_damping(lmp_tree, gas, formulation, length):
    decks = [
        gas(f"formulation {formulation} temp {target} {target} {damp} tchain {length}")
        for damp in (0.1, 100.0)
        for target in (0.3, 3.0)
    ]
    for table in lmp_tree.succeed(one_after_the_other(decks)).thermo:
        assert change(table) < 2e-3


def test_the_order_is_that_of_the_method(lmp_tree, gas):
    """Where the chain is stiff, from the second run on: the first one begins with its transient."""
    errors = []
    for dt in (0.04, 0.02):
        steps = round(1.6 / dt)
        words = "values 6 corrector gear temp 1.5 1.5 1.0"
        deck = gas(words, n=12, dt=dt, run=f"run {steps}\nrun {2 * steps}", every=1)
        _, table = lmp_tree.succeed(deck).thermo
        errors.append(np.ptp(table["Econserve"]))
    assert np.log2(errors[0] / errors[1]) > 4.5


def test_restart_and_ranks_of_a_stiff_chain(lmp_tree, gas):
    end = "write_dump all custom {} id x y z vx vy vz modify sort id format float %.17g"
    words = "temp 1.5 1.5 0.5 tchain 3"
    first = "run 20\nwrite_restart half\nclear\n"
    second = gas(words).split("timestep")[1]
    reading = (
        "read_restart half\npair_style soft 1.0\npair_coeff 1 1 5.0\n"
        "neigh_modify delay 0 every 1 check yes exclude molecule/intra all\ntimestep" + second
    )
    whole = gas(words, run=f"run 40\n{end.format('whole')}")
    halves = gas(words, run=first + reading.replace("run 400", f"run 20\n{end.format('halves')}"))
    lmp_tree.succeed(one_after_the_other([whole, halves]))
    read = (lmp_tree.folder / "whole").read_text(), (lmp_tree.folder / "halves").read_text()
    assert read[0] == read[1]
    lmp_tree.succeed(whole, ranks=4)
    other = np.loadtxt(lmp_tree.folder / "whole", skiprows=9)
    here = np.loadtxt(lmp_tree.folder / "halves", skiprows=9)
    assert np.abs(other[:, 4:] - here[:, 4:]).max() < 1e-11


# --- a first script of water --------------------------------------------------------------------


@pytest.mark.parametrize("dt", [1.0, 2.0])
def test_water_from_a_lattice(lmp_tree, dt):
    """Disordered molecules of 500 K with a target of 300 K."""
    fix = "gear/quat molecule temp 300 300 100"
    data = water_data(lmp_tree.folder / "data")
    deck = water(data, fix, dt=dt, steps=300, thermo=10, columns="econserve ecouple f_move[*]")
    deck = deck.replace("fix_modify move energy yes", "velocity all scale 500")
    (table,) = lmp_tree.succeed(deck).thermo
    assert np.mean(table[T_ROTATION][-10:]) == pytest.approx(300, rel=0.25)


# --- an overlap under tolerance -----------------------------------------------------------------


def test_an_overlap_does_not_make_steps_short_for_long(lmp_tree, gas):
    """The kinetic energy is a thousand times its target after the molecules have parted."""
    run = "displace_atoms all random 1.5 1.5 1.5 4711 units box\nrun 0"
    deck = gas("temp 1.0 1.0 0.5 tolerance 1e-6 dtmax 0.02", n=5, soft=3000.0, run="run 600")
    deck = deck.replace("lattice sc 0.02", "lattice sc 0.4").replace(run, "")
    (table,) = lmp_tree.succeed(deck).thermo
    table = {key.lower(): value for key, value in table.items()}
    heat = np.ptp(table["ecouple"])
    assert heat > 100.0
    assert np.ptp(table["econserve"]) < 1e-4 * heat
    assert table["time"][-1] > 3.0


# --- too strong ---------------------------------------------------------------------------------

ADVICE = re.compile(r"use a damping time of (\S+) or longer")


def test_a_friction_that_is_too_strong_is_refused_and_the_advice_holds(lmp_tree, gas):
    words = "values 7 temp 0.002 0.002 {} tchain 1 thermostat {}"
    for kind, whose in (("total", "the temperature"), ("separate", "the translational temperature")):
        log = lmp_tree.refuse(gas(words.format(0.1, kind)), whose).words
        damp = float(ADVICE.search(log)[1])
        assert 0.2 < damp < 4.0
        result = lmp_tree.succeed(gas(words.format(damp, kind)))
        assert change(result.thermo[0]) < 0.02
        assert "permits" not in result.words
        lmp_tree.refuse(gas(words.format(0.7 * damp, kind)), whose)


def test_a_friction_that_becomes_strong_is_warned_of(lmp_tree, gas):
    """The bodies are at the target until a run makes them hot."""
    hot = "run 5\nvelocity all scale 12.0\nrun 100"
    result = lmp_tree.succeed(gas("values 7 temp 1.0 1.0 0.1 tchain 1 start zero", run=hot))
    assert result.words.count("of what the method can follow") == 1
