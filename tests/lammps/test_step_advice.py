"""With the time step suggested in a message the run is stable and conserves its energy.

Liquids and gases of water, CO2 and N2. Each runs with steps that are
far too long; the test reads the step from the message, as a user would, and runs with it.
"""

import re

import numpy as np
import pytest

from support.running import EXAMPLES
from support.scenes import template

LIQUID = """
units {units}
atom_style full
lattice sc {lattice}
region box block 0 {cells} 0 {cells} 0 {cells}
create_box 2 box
molecule body {name}.mol
mass 1 {masses[0]}
mass 2 {masses[1]}
pair_style {pair}
{coefficients}
{kspace}
create_atoms 0 box mol body 4711
neighbor {skin} bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
velocity all create {temperature} 4711 loop geom
fix move all gear/quat molecule report no temp {temperature} {temperature} {damp}
thermo 100
timestep {small}
run 200
timestep {middle}
run 400
unfix move
"""
WATER = """
units real
atom_style full
read_data {examples}/water/data.water
velocity all create 300.0 4711 loop geom
pair_style lj/charmm/coul/long 7 8
pair_coeff 1 1 0.1553 3.166
pair_coeff 2 2 0 1
pair_coeff 1 2 0 1
kspace_style pppm 1e-4
neighbor 2.0 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
"""
RUN = """
reset_timestep 0
fix move all gear/quat molecule report no
timestep {dt}
thermo_style custom step temp ke etotal
thermo_modify norm no
thermo 10
run {steps}
"""
LONG = dict(pair="lj/charmm/coul/long 8 9", kspace="kspace_style pppm 1e-4", skin=2.0)
SHORT = dict(kspace="", masses=(1.0, 1.0))
SITES = {
    "co2": ([(0, 0, 0), (1.16, 0, 0), (-1.16, 0, 0)], [1, 2, 2], [0.6512, -0.3256, -0.3256]),
    "n2": ([(0.55, 0, 0), (-0.55, 0, 0)], [1, 1], [0, 0]),
}
REAL = dict(units="real", cells=5, damp=100, small=0.02, middle=0.5)
LIQUIDS = {
    "co2": dict(
        REAL | LONG,
        lattice=4.4,
        masses=(12.011, 15.999),
        temperature=240,
        coefficients="pair_coeff 1 1 0.0559 2.757\npair_coeff 2 2 0.16 3.033",
    ),
    "n2": dict(
        REAL | SHORT,
        lattice=4.1,
        masses=(14.007, 1.0),
        temperature=100,
        pair="lj/charmm/coul/charmm 8 9",
        skin=2.0,
        coefficients="pair_coeff * * 0.0725 3.31",
    ),
}
#: steps that are too long, from steps that are refused at once to steps that become unstable in the run
TOO_LONG = {
    "water": (100, 7),
    "co2": (300, 60),
    "n2": (200, 40),
}
#: drift in a run, in units of the kinetic energy
MOST_DRIFT = 0.02


def deck(lmp, name, dt, steps):
    run = RUN.format(dt=dt, steps=steps)
    if name == "water":
        return WATER.format(examples=EXAMPLES) + run
    (lmp.folder / f"{name}.mol").write_text(template(*SITES[name]))
    return LIQUID.format(name=name, **LIQUIDS[name]) + run


def test_a_much_longer_step_between_runs(lmp_tree):
    """Histories are not rescaled by a factor of 25, which would amplify small errors."""
    (lmp_tree.folder / "co2.mol").write_text(template(*SITES["co2"]))
    result = lmp_tree.succeed(LIQUID.format(name="co2", **LIQUIDS["co2"]))
    assert "the time step has changed by more than a factor of two; histories are rebuilt" in result.words


def test_overlaps(lmp_tree):
    """A run with the keywords of the message removes the energy of the overlaps."""
    (lmp_tree.folder / "n2.mol").write_text(template(*SITES["n2"]))
    text = LIQUID.format(name="n2", **(LIQUIDS["n2"] | dict(lattice=2.6)))
    fix, run = "fix move all gear/quat molecule", "timestep 1.0\nthermo 50\nrun 300\n"
    begin = text.partition("fix move")[0]
    words = lmp_tree.refuse(f"{begin}{fix}\n{run}", "blow-up").words
    assert "use a time step of" in words or "a run with keywords tolerance and temp" in words
    keywords = "tolerance 1e-4 dtmax 1.0 temp 100 100 100"
    longer = run.replace("300", "1200")
    table = lmp_tree.succeed(f"{begin}{fix} {keywords}\n{longer}").thermo[-1]
    assert table["E_pair"][-1] < 0.2 * table["E_pair"][0] and table["Temp"][-1] < 150


def drift(table):
    energy = np.array(table["TotEng"])
    return np.abs(energy - energy[0]).max() / table["KinEng"][0]


@pytest.mark.parametrize("name", TOO_LONG)
def test_the_advised_step(lmp_tree, name):
    """A user follows the messages; no message has a number where no start has measured vibrations."""
    for dt in TOO_LONG[name]:
        words = lmp_tree.refuse(deck(lmp_tree, name, dt, 200), "Fix gear/quat").words
        for _ in range(8):
            told = re.search(r"use a time step of (\S+) or shorter", words)
            assert told or "halve the time step" in words, words[-1000:]
            shorter = float(told[1]) if told else 0.5 * dt
            assert 0.01 * dt < shorter < dt
            dt = shorter
            result = lmp_tree.run(deck(lmp_tree, name, dt, 200))
            words = result.words
            if result.returncode == 0 and "use a time step of" not in words:
                break
        assert drift(result.thermo[-1]) < MOST_DRIFT
