"""The styles of LAMMPS' command units, and the units of results."""

from typing import NamedTuple


class Units(NamedTuple):
    """A style of units; names in parentheses are LAMMPS' names in update.cpp.

    * ``time``, ``length``, ``mass_name``, ``energy_name``: names of the units
    * ``ps``, ``angstrom``: the units of time and length in ps and Å
    * ``energy``: mass x velocity^2 in the unit of energy (mvv2e)
    * ``boltzmann``: Boltzmann's constant (boltz)
    * ``density_name``, ``density``: the unit of density and mass / length^3 in it (mv2d), if it is not mass / length^3
    * ``coulomb``: Coulomb's constant (qqrd2e)
    """

    time: str
    length: str
    ps: float
    angstrom: float
    energy: float
    boltzmann: float
    mass_name: str
    energy_name: str
    density_name: str = ""
    density: float = 1.0
    coulomb: float = 1.0


#: units lj have no values in ps and Å, so 1 is used for both
UNITS = {
    "lj": Units("", "", 1.0, 1.0, 1.0, 1.0, "m", "ε"),
    "real": Units("fs", "Å", 1e-3, 1.0, 48.88821291**2, 0.0019872067, "g/mol", "kcal/mol", "g/cm³", 1.0 / 0.602214129, 332.06371),
    "metal": Units("ps", "Å", 1.0, 1.0, 1.0364269e-4, 8.617343e-5, "g/mol", "eV", "g/cm³", 1.0 / 0.602214129, 14.399645),
    "si": Units("s", "m", 1e12, 1e10, 1.0, 1.3806504e-23, "kg", "J", coulomb=8.9876e9),
    "cgs": Units("s", "cm", 1e12, 1e8, 1.0, 1.3806504e-16, "g", "erg"),
    "electron": Units("fs", "bohr", 1e-3, 0.529177210544, 1.06657236, 3.16681534e-6, "u", "Hartree"),
    "micro": Units("µs", "µm", 1e6, 1e4, 1.0, 1.3806504e-8, "pg", "pg µm²/µs²", coulomb=8.987556e6),
    "nano": Units("ns", "nm", 1e3, 10.0, 1.0, 0.013806504, "ag", "ag nm²/ns²", coulomb=230.7078669),
}
#: units of results, composed of units of mass M, length L, time T, energy E and temperature K.  t is the unit of the times
#: of frames: steps, if neither the dump nor --timestep gives times.  Velocities are always in LAMMPS' units
OF_RESULTS = {
    "time": "t",
    "lag": "t",
    "center": "L",
    "residual": "L",
    "velocity": "L/T",
    "velocity_residual": "L/T",
    "omega_space": "rad/T",
    "momentum": "M L/T",
    "angular_momentum_space": "M L²/T",
    "ke_translation": "E",
    "ke_rotation": "E",
    "potential": "E",
    "mean_square_displacement": "L²",
    "velocity_autocorrelation": "L²/T²",
    "omega_space_autocorrelation": "rad²/T²",
    "mean_square_rotation": "rad²",
    "temperature": "K",
    "diffusion coefficient": "L²/t",
    "correlation time": "t",
    "volume": "L³",
    "density": "D",
    "compressibility": "B",
}


def style_of(trajectory, units=None):
    """Style of units of a trajectory: the style in the dump, or else ``units``; None if neither is known.

    Raises ValueError for an unknown style, and for a style that differs from the dump's, or from the units to which
    MDAnalysis converted another format.
    """
    ours, stated = hasattr(trajectory, "unit_style"), getattr(trajectory, "unit_style", None)
    if units is None:
        return stated
    if units not in UNITS:
        raise ValueError(f"units {units}: one of {', '.join(UNITS)} is required")
    if stated not in (None, units):
        raise ValueError(f"units {units}: the dump says units {stated}")
    # several files have a reader each
    if not ours and any("LAMMPSDUMP" in one.format for one in getattr(trajectory, "readers", [trajectory])):
        raise ValueError(
            f"units {units}: MDAnalysis' own reader of LAMMPS dumps (LAMMPSDUMP) converts times to ps, but not velocities;"
            " a universe of gearquat_analysis.open_dump is required"
        )
    if not ours and units != "metal":
        raise ValueError(
            f"units {units}: MDAnalysis gives this trajectory in Å and ps, so units metal are required, or none"
        )
    return units


def unit_of(result, style, time=None):
    """Unit of a result in a style of units of LAMMPS, such as "Å²/fs"; "" for a pure number or without a style.

    ``time``: the unit of the times of frames, if it differs from the style's.
    """
    kind = OF_RESULTS.get("omega_space_autocorrelation" if result.startswith("omega_ax") else result, "")
    if style is None:
        return time or "" if kind == "t" else ""
    units = UNITS[style]
    names = {"M": units.mass_name, "L": units.length or "σ", "T": units.time or "τ", "t": time or units.time or "τ"}
    names["D"] = units.density_name or f"{names['M']}/{names['L']}³"
    names["B"] = "σ³/ε" if style == "lj" else "1/GPa"
    names |= {"E": units.energy_name, "K": "ε/k" if style == "lj" else "K"}
    return "".join(names.get(letter, letter) for letter in kind)
