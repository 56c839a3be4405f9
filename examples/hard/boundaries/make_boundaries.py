#!/usr/bin/env python3
"""Write the data files of examples/hard/boundaries: two bodies tied together, in three boxes.

    python make_boundaries.py [FOLDER]

writes ``hard/boundaries/data.BOX`` below FOLDER (default: the examples folder this program is in)
for a box that is open and never left, a periodic one and a triclinic one.  The bodies, five sites
each, are tied by a bond between their last sites and turn about the origin, which is a corner of the
periodic boxes.  These sites are close to the centers of mass, so that the motion is not chaotic.
Positions are unwrapped: LAMMPS wraps them, and sets image flags, when it reads the file.

Units: lj.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "common"))
from data_files import cross, data_text, write  # noqa: E402

# a flat tetrahedron and the site of the bond, and its mirror image beyond the origin; both turn about
# the axis of their largest moment, but for a little
SITES = ((0.4, 0.1, 0.2), (2.0, 0.3, -0.1), (1.1, 1.6, 0.1), (1.2, 0.0, 0.7), (1.2, 0.5, 0.25))
OMEGA = ((0.3, 0.5, 1.0), (0.2, 0.4, 1.0))
BOXES = {
    "open": ("-200000 200000 xlo xhi", "-200000 200000 ylo yhi", "-200000 200000 zlo zhi"),
    "periodic": ("0 10 xlo xhi", "0 10 ylo yhi", "0 10 zlo zhi"),
    "triclinic": ("0 10 xlo xhi", "0 10 ylo yhi", "0 10 zlo zhi", "3 2.5 -2 xy xz yz"),
}


def data_file(box):
    """Text of a LAMMPS data file, atom style full: molecules 1 and 2."""
    atoms = [
        (molecule, 1, 0.0, [sign * c for c in site])
        for molecule, sign in ((1, 1.0), (2, -1.0))
        for site in SITES
    ]
    velocities = [cross(OMEGA[molecule - 1], place) for molecule, *_, place in atoms]
    title = "two bodies tied together, %s box (make_boundaries.py)" % box
    bond = (len(SITES), 2 * len(SITES))
    return data_text(title, BOXES[box], (1.0,), atoms, velocities, bond)


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {"hard/boundaries/data.%s" % box: data_file(box) for box in BOXES}


if __name__ == "__main__":
    write(scene_files())
