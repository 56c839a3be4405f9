"""The styles of LAMMPS' command units."""

from typing import NamedTuple


class Units(NamedTuple):
    """Names of the units of time and length; what they are in ps and Å; mass x velocity^2 in the unit
    of energy, and Boltzmann's constant (mvv2e and boltz in LAMMPS' update.cpp).
    """

    time: str
    length: str
    ps: float
    angstrom: float
    energy: float
    boltzmann: float


#: units lj have no ps and Å: one unit becomes one of them
UNITS = {
    "lj": Units("", "", 1.0, 1.0, 1.0, 1.0),
    "real": Units("fs", "Å", 1e-3, 1.0, 48.88821291**2, 0.0019872067),
    "metal": Units("ps", "Å", 1.0, 1.0, 1.0364269e-4, 8.617343e-5),
    "si": Units("s", "m", 1e12, 1e10, 1.0, 1.3806504e-23),
    "cgs": Units("s", "cm", 1e12, 1e8, 1.0, 1.3806504e-16),
    "electron": Units("fs", "bohr", 1e-3, 0.529177210544, 1.06657236, 3.16681534e-6),
    "micro": Units("µs", "µm", 1e6, 1e4, 1.0, 1.3806504e-8),
    "nano": Units("ns", "nm", 1e3, 10.0, 1.0, 0.013806504),
}
