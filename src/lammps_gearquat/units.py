"""The styles of LAMMPS' command units."""

from typing import NamedTuple


class Units(NamedTuple):
    """Names of the units of time and length; what they are in ps and Å; and mass x velocity^2 in the unit
    of energy (mvv2e in LAMMPS' update.cpp).
    """

    time: str
    length: str
    ps: float
    angstrom: float
    energy: float


#: units lj have no ps and Å: one unit becomes one of them
UNITS = {
    "lj": Units("", "", 1.0, 1.0, 1.0),
    "real": Units("fs", "Å", 1e-3, 1.0, 48.88821291**2),
    "metal": Units("ps", "Å", 1.0, 1.0, 1.0364269e-4),
    "si": Units("s", "m", 1e12, 1e10, 1.0),
    "cgs": Units("s", "cm", 1e12, 1e8, 1.0),
    "electron": Units("fs", "bohr", 1e-3, 0.529177210544, 1.06657236),
    "micro": Units("µs", "µm", 1e6, 1e4, 1.0),
    "nano": Units("ns", "nm", 1e3, 10.0, 1.0),
}
