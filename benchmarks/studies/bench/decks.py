"""Input scripts of ``benchmarks/run bench``: SPC/E water, one script for each run, complete in itself.

They read ``data.water`` and the forces of ``examples/water``, which lie beside them.
"""

import shutil
from pathlib import Path

from benchmarks.engine.decks import examples_folder

FILES = ("data.water", "forces.plain", "forces.smooth")
#: molecules in data.water, before it is replicated
MOLECULES = 500
#: columns of the log for the squares that equipartition needs: velocity of the centre of mass and
#: angular velocity along the principal axes, columns 4-6 and 20-22 of the fix's local data
SQUARES = (4, 5, 6, 20, 21, 22)

_SCENE = """\
units real
atom_style full
read_data data.water
replicate {cells[0]} {cells[1]} {cells[2]}
include forces.{forces}
neighbor 1.0 bin
neigh_modify every {every} delay 0 check {check} exclude molecule/intra all
{motion}
timestep {dt:.17g}
thermo_modify norm no
"""

# The first step holds the start of fix gear/quat, so it is a run of its own.  With "sync" a rank
# that waits for the slower one does so in the section "Sync", not in what comes next.
_TIMING = """\
thermo_style custom step time temp pe etotal
thermo {steps}
timer normal sync
run 1
info memory out log
run {steps}
"""

_SAMPLING = """\
{computes}
thermo_style custom step time {columns}
thermo_modify norm no format float %.17g
thermo {every}
run {steps}
"""


def motion(style):
    """Lines that define the fix ``move``; none for atoms that stay where they are."""
    if not style:
        return "# no fix: nothing moves"
    lines = f"fix move all {style}"
    return lines + "\nfix_modify move energy yes" if style.startswith("gear/quat") else lines


def timing(style, cells, dt, steps):
    """Script that times ``steps`` steps after the first one.

    ``style``: fix style and its arguments, "" for none; ``cells``: copies of the box along x, y, z;
    ``dt`` in fs.  Neighbours are renewed every 10 steps, whoever moves the atoms.
    """
    scene = _SCENE.format(
        cells=cells, forces="plain", every=10, check="no", motion=motion(style), dt=dt
    )
    return scene + _TIMING.format(steps=steps)


def _sampling(style, dt, time, interval, columns, computes="# nothing to compute"):
    scene = _SCENE.format(
        cells=(1, 1, 1), forces="smooth", every=1, check="yes", motion=motion(style), dt=dt
    )
    return scene + _SAMPLING.format(
        computes=computes, columns=columns, every=round(interval / dt), steps=round(time / dt)
    )


def pressure(style, dt, time, interval):
    """Script that samples the pressure of 500 molecules every ``interval`` to ``time``, in fs."""
    return _sampling(style, dt, time, interval, "temp press pe etotal")


def temperature(style, dt, time, interval):
    """Script that samples kinetic energies, and with fix gear/quat the squares of all velocities."""
    if style.startswith("gear/quat"):
        rows = " ".join(f"f_move[{column}]" for column in SQUARES)
        computes = f"compute squares all reduce sumsq {rows} inputs local"
        columns = "temp f_move[1] f_move[2] " + " ".join(
            f"c_squares[{k + 1}]" for k in range(len(SQUARES))
        )
    else:
        computes = "compute trans all ke/rigid move\ncompute rot all erotate/rigid move"
        columns = "temp c_trans c_rot"
    return _sampling(style, dt, time, interval, columns, computes)


def write(folder, name, text):
    """Write a script with what it reads beside it; returns its path."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for file in FILES:
        if not (folder / file).exists():
            shutil.copyfile(examples_folder() / "water" / file, folder / file)
    path = folder / f"in.{name}"
    path.write_text(text, encoding="utf-8")
    return path
