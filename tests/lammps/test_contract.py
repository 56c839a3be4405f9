"""What LAMMPS' class Fix promises and asks, as far as no other test looks: see doc/fix_contract.md."""

import numpy as np
import pytest
from scenes import last_frame, two_molecules, water, water_data


def test_a_dynamic_group_is_refused(lmp_tree):
    """By LAMMPS, for the fix does not say that it can: bodies do not change their atoms."""
    before = "variable all atom x<100\ngroup some dynamic all var all every 1"
    deck = two_molecules(before=before, after="run 1").replace("move all", "move some")
    result = lmp_tree.run(deck)
    assert result.returncode != 0
    assert "dynamic" in result.output


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_box_may_become_triclinic_between_runs(lmp_tree, ranks):
    """The same box, and the same motion; all molecules lie inside."""
    data = water_data(lmp_tree.folder / "data.water", spacing=4.5, shift=2.25)
    ends = []
    for change in (
        "",
        "undump poses\nchange_box all triclinic\ndump poses all custom 20 poses.dump id xu yu zu vx vy vz\n"
        "dump_modify poses sort id format float %.17g",
    ):
        result = lmp_tree.run(
            water(data, dt=1.0, steps=20, run=f"run 20\n{change}\nrun 20"), ranks=ranks
        )
        assert result.returncode == 0, result.output
        ends.append(last_frame(lmp_tree.folder / "poses.dump")[:, 1:7])
    scale = np.abs(ends[0]).max(axis=0)
    assert (np.abs(ends[0] - ends[1]) < 1e-11 * scale).all()
