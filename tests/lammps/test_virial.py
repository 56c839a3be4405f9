"""Virial of the constraint forces, distributed over atoms: input to thermo, stresses and heat fluxes."""

import numpy as np
import pytest
from support.scenes import water, water_data

OUTPUTS = 172
PARTS = range(1, 7)

# contribution of the fix alone: to the total, and to each atom
SHARES = """
compute stress all stress/atom NULL fix
compute centroid all centroid/stress/atom NULL fix
compute shares all reduce sum c_stress[*]
compute diagonal all reduce sum c_centroid[*]
compute whole all pressure NULL fix
{variables}
thermo_style custom step {columns}
thermo_modify norm no format float %.17g
thermo 3
{style}
run {steps}
"""


@pytest.mark.parametrize(
    "ranks, style",
    [(1, "run_style verlet"), (4, "run_style verlet"), (4, "run_style respa 2 1 pair 2")],
)
def test_shares_of_atoms_add_up(lmp_tree, data, ranks, style):
    """Atoms migrate within the steps of the outputs; r-RESPA allows no step other than one."""
    names = ("v_whole{}", "c_shares[{}]", "c_diagonal[{}]")
    columns = [[name.format(k) for k in PARTS] for name in names]
    run = SHARES.format(
        variables="\n".join(f"variable whole{k} equal -c_whole[{k}]*vol" for k in PARTS),
        columns=" ".join(sum(columns, [])),
        style=style,
        steps=3 * (OUTPUTS - 1),
    )
    thermo = lmp_tree.succeed(water(data, dt=1.0, run=run), ranks=ranks).thermo[-1]
    whole, stress, centroid = np.array([[thermo[column] for column in c] for c in columns])
    assert whole.shape == (len(PARTS), OUTPUTS)
    scale = np.abs(whole).max()
    for shares in (stress, centroid):
        assert np.abs(shares - whole).max() < 1e-10 * scale


FLUX = """
compute ke all ke/atom
compute pe all pe/atom pair
compute stress all centroid/stress/atom NULL pair fix
compute flux all heat/flux ke pe stress
thermo_style custom step c_flux[*]
thermo_modify norm no format float %.17g
run {steps}
"""


def flux(lmp, fix, dt, steps, ranks=1):
    data = water_data(lmp.folder / "data.water")
    result = lmp.succeed(water(data, fix, dt=dt, run=FLUX.format(steps=steps)), ranks=ranks)
    return np.array([result.thermo[-1][f"c_flux[{k}]"][-1] for k in PARTS])


def test_heat_flux_is_that_of_fix_rigid_small(lmp_tree):
    """The virial of rigid/small is computed from differences of velocities, so its error is proportional to the
    step."""
    ours, across = (flux(lmp_tree, "gear/quat molecule", 0.02, 50, ranks) for ranks in (1, 4))
    assert across == pytest.approx(ours, rel=1e-9)
    coarse, fine = (
        np.abs(flux(lmp_tree, "rigid/nve/small molecule", 0.02 / k, 50 * k) - ours).max()
        for k in (1, 4)
    )
    assert fine < 1e-4 * np.abs(ours).max()
    assert coarse == pytest.approx(4 * fine, rel=0.02)
