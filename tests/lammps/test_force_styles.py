"""Forces between steps with pair styles that sum up rates, and with forces elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from support.running import run_python
from support.scenes import placed

# --- rates of some atom styles -----------------------------------------------------------------------
HEAT = """
set atom * sph/rho 1.0 sph/cv 1.0 sph/e 1.0
set atom 1*3 sph/e 2.0
comm_modify vel yes
pair_style hybrid/overlay lj/charmm/coul/charmm 3.0 4.0 sph/heatconduction
pair_coeff * * lj/charmm/coul/charmm 1.0 0.8
pair_coeff * * sph/heatconduction 0.1 {}
compute energy all sph/e/atom
compute warm all reduce max c_energy
compute sum all reduce sum c_energy
"""


def two(before=HEAT.format(3.0), apart=2.2, speed=0.1, style="hybrid full sph", **settings):
    """A deck of two triangles that approach each other."""
    bodies = [[(0, 0, 0), (1, 0, 0), (0, 1.2, 0.1)], [(apart, 0.3, 0), (apart, 1.2, 0.1), (apart, 0, 1)]]
    settings = dict(box="-10 10 -10 10 -10 10", boundary="p p p", dt=0.005, thermo=1, steps=5) | settings
    return placed(bodies, [(speed, 0, 0)] * 3 + [(-speed, 0, 0)] * 3, style=style, before=before, **settings)


@pytest.mark.parametrize("ranks", [1, 2])
def test_heat_is_conducted_as_beside_fix_rigid(lmp_wheel, ranks):
    """Energies advance with the bodies; the loss in the first step is a tenth of the amount that the start would add."""
    columns = ["c_warm", "c_sum"]
    fixes = [dict(fix="rigid/nve/small molecule", after="fix heat all sph/stationary"), dict(fix="gear/quat molecule")]
    decks = [two(columns=" ".join(columns), **fix) for fix in fixes]
    rigid, thermo = (np.array([lmp_wheel.succeed(deck, ranks=ranks).thermo[0][c] for c in columns]) for deck in decks)
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
    deck = two(HEAT.format(4.0), apart=4.5, speed=3.0, fix="gear/quat molecule tolerance 1e-9", run="run 0")
    (lmp_wheel.folder / "in.deck").write_text(deck)
    run_python(REPEATS.format(element=15), lmp_wheel.folder)
    found = np.load(lmp_wheel.folder / "rates.npz")
    rates, again = found["rates"], found["again"]
    largest = np.abs(rates[:, 1]).max(axis=1)
    conducting = largest > 1e-6
    assert np.count_nonzero(again[conducting]) > 3 and conducting.sum() > 20
    off = np.abs(rates[:, 0] - rates[:, 1]).max(axis=1)[conducting] / largest[conducting]
    assert off.max() < 1e-3


# --- forces elsewhere ---------------------------------------------------------------------------------
COULOMB = """
set atom 1*3 charge 0.3
set atom 4*6 charge -0.3
pair_style lj/cut/coul/long 3.0
pair_coeff * * 0.1 1.0
kspace_style pppm 1e-4
run_style verlet/split
"""


def test_a_run_style_with_forces_elsewhere_is_not_followed(lmp_wheel):
    """Run style verlet/split gets long-range forces from the ranks of another partition."""
    deck = two(COULOMB, style="full").replace("region box", "processors * * * part 1 2 multiple\nregion box")
    # words after a variable in the command line
    replace(lmp_wheel, library=None).succeed(deck, {"none": ["0", "-partition", "1", "1"]}, ranks=2)
    log = (lmp_wheel.folder / "log.run1.0").read_text()
    assert "because run style verlet/split may evaluate forces elsewhere" in log
