"""Insertion and removal of bodies in a liquid."""

import numpy as np
from support.scenes import SPCE, last_frame, water, water_data

N = 27  # molecules of the water box


def liquid(lmp, commands, fix="gear/quat molecule", before="", dt=1.0):
    """A deck of 27 molecules in a box of 13.5 Angstrom, with steps of a femtosecond."""
    (lmp.folder / "molecule.spce").write_text(SPCE)
    data = water_data(lmp.folder / "data.water", spacing=4.5)
    return water(data, fix, dt=dt, steps=20, before=before, run=commands)


def poses(lmp):
    return last_frame(lmp.folder / "poses.dump")


def close(a, b, tolerance):
    assert a.shape == b.shape
    assert np.abs(a - b).max() < tolerance
# --- removed -------------------------------------------------------------------------------------
EVAPORATE = """
group some {members}
region everywhere block INF INF INF INF INF INF
fix out some evaporate 5 {number} everywhere 4711 molecule {molecule}
"""


def evaporating(members="molecule 5 17", molecule="yes", number=1):
    return EVAPORATE.format(members=members, molecule=molecule, number=number)
# --- inserted ------------------------------------------------------------------------------------
INSERT = """
region within block 0 13 0 13 0 13
fix in all deposit {count} 0 5 4711 region within near 2.0 attempt 2000 mol spce rigid move &
  vx -0.01 0.01 vy -0.01 0.01 vz -0.01 0.01
"""
TEMPLATE = "molecule spce molecule.spce"
MOL = "gear/quat molecule mol spce"
