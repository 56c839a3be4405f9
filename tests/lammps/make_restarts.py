#!/usr/bin/env python3
"""Restart files of a release, and their continuations by this release: tests/lammps/restarts/RELEASE.

    .venv/bin/python tests/lammps/make_restarts.py 1.2.3               # with the build of this tree
    .venv/bin/python tests/lammps/make_restarts.py 1.2.3 --lmp FILE    # with another build

For each release, the first command saves its files for the tests of all later ones
(doc/release.md); remove the folder first if it exists.  Files of earlier releases are not
made again.  WRITE and CONTINUE are the decks that made them: later releases may add cases, but must
not change these.

For each case there is a restart file. `continued.json` has the thermo output and the last frame of a run
that continues from it, with all digits.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import running
from scenes import last_frame, water_data

FOLDER = Path(__file__).parent / "restarts"
STEPS = 20

#: words of the fix, and outputs that exist only with these words
CASES = {
    "first": ("formulation first", ""),
    "second": ("formulation second", ""),
    "tolerance": (
        "formulation second tolerance 1e-7",
        "f_move[9] f_move[11] f_move[12] f_move[16]",
    ),
    "isokinetic": ("formulation first isokinetic separate", "f_move[9] f_move[10] f_move[11]"),
    "temp": (
        "formulation second temp 300 300 60 tchain 3 thermostat separate",
        "econserve f_move[9] f_move[10] f_move[11] f_move[13] f_move[14]",
    ),
    "spheres": ("formulation second", ""),
}

WATER = """
units real
atom_style full
read_data data.water
pair_style lj/charmm/coul/charmm 2.7 3.9
pair_coeff 1 1 0.1553 3.166
pair_coeff 2 2 0.0 1.0
pair_coeff 1 2 0.0 1.0
"""
SPHERES = """
units lj
atom_style hybrid molecular sphere
atom_modify map array
boundary f f f
region box block -9 9 -9 9 -9 9
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.1 0.0
create_atoms 1 single 0.3 1.5 0.2
create_atoms 1 single 1.1 1.9 0.6
create_atoms 1 single 0.9 0.5 1.6
create_atoms 1 single 1.7 0.2 2.1
set atom 1*2 mol 1
set atom 3*4 mol 2
set atom 5*6 mol 3
set atom 1*6 diameter 0.6
set atom 2*4 diameter 0.9
velocity all create 1.0 4711 loop geom
pair_style lj/cut 8.0
pair_coeff * * 1.0 1.0
"""
WRITE = f"""
{{scene}}
neighbor 0.9 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
atom_modify sort 0 0.0
timestep {{dt}}
velocity all zero linear
fix move all gear/quat molecule {{words}}
thermo_style custom step pe
run {STEPS}
write_restart {{name}}.restart
"""

CONTINUE = f"""
read_restart {{file}}
neighbor 0.9 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
atom_modify sort 0 0.0
timestep {{dt}}
fix move all gear/quat molecule {{words}}
thermo_style custom step time pe f_move[1] f_move[2] {{columns}}
thermo_modify norm no format float %.17g
thermo 5
run {STEPS}
write_dump all custom {{name}}.end id xu yu zu vx vy vz modify sort id format float %.17g
"""


def words_of(name):
    """Differences between the decks."""
    words, columns = CASES[name]
    scene, dt = (SPHERES, 0.002) if name == "spheres" else (WATER, 0.2)
    return dict(name=name, words=words, columns=columns, scene=scene, dt=dt)


def go_on(lmp, name, file, change=lambda words: words, ranks=1):
    """Output of a run that continues from a file, with the steps of the stored one, and its messages.

    change: applied to the words of the fix.
    """
    parts = words_of(name)
    parts["words"] = change(parts["words"])
    result = lmp.succeed(CONTINUE.format(file=file, **parts), ranks=ranks)
    frame = last_frame(lmp.folder / f"{name}.end")
    return {"thermo": result.thermo[-1], "frame": frame.tolist()}, result


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("release")
    parser.add_argument("--lmp", type=Path, default=running.TREE_BUILD / "lmp")
    arguments = parser.parse_args()
    folder = FOLDER / arguments.release
    folder.mkdir(parents=True)  # files of a release are never overwritten
    continued = {}
    with tempfile.TemporaryDirectory() as work:
        environment = running.OPEN_MPI_ENVIRONMENT
        lmp = running.Lammps(
            "release", arguments.lmp, running.OPEN_MPI_LAUNCHER, Path(work), environment
        )
        water_data(lmp.folder / "data.water", n=2)
        for name in CASES:
            lmp.succeed(WRITE.format(**words_of(name)))
            file = folder / f"{name}.restart"
            file.write_bytes((lmp.folder / file.name).read_bytes())
            continued[name], _ = go_on(lmp, name, file)
    lines = (f'"{name}": {json.dumps(output)}' for name, output in continued.items())
    (folder / "continued.json").write_text("{" + ",\n".join(lines) + "}\n")


if __name__ == "__main__":
    main()
