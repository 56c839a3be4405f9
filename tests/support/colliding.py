"""Decks with two bodies that collide, for the tests of gearquat scatter."""

import numpy as np

from gearquat_analysis.units import UNITS

#: two atoms or two dumbbells of Lennard-Jones sites, in reduced units
DECK = """
units lj
atom_style bond
boundary s s s
region box block -20 20 -20 20 -20 20
create_box 1 box bond/types 1 extra/bond/per/atom 1
{atoms}
mass 1 1.0
pair_style lj/smooth {inner} {cutoff}
pair_coeff 1 1 1.0 1.0
neigh_modify exclude molecule/intra all
group right molecule 2
velocity right set 0 0 -1
timestep 0.01
fix move all gear/quat molecule tolerance 1e-10 energy
{extra}
run 100
"""
ATOMS = """
create_atoms 1 single 0 0 0
create_atoms 1 single 0.5 0 9
set atom 1 mol 1
set atom 2 mol 2
"""
DUMBBELLS = """
create_atoms 1 single 0 0 -0.25
create_atoms 1 single 0 0 0.25
create_atoms 1 single 0.5 0.15 9
create_atoms 1 single 0.5 -0.15 9.4
set atom 1*2 mol 1
set atom 3*4 mol 2
"""


def write(folder, atoms=ATOMS, extra="", inner=6.0, cutoff=7.0, **changes):
    """Path of a deck in ``folder``, with changes old=new."""
    text = DECK.format(atoms=atoms, extra=extra, inner=inner, cutoff=cutoff)
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new)
    (folder / "in.pair").write_text(text)
    return folder / "in.pair"


#: diameter, m, and well depth, K, of argon
SIGMA, WELL = 3.405e-10, 119.8


def write_argon(folder, style):
    """Path of the deck of two atoms of argon in units ``style``, with the same reduced numbers as in units lj."""
    units, number = UNITS[style], "{:.17g}".format
    length, energy = SIGMA / (units.angstrom * 1e-10), WELL * units.boltzmann
    # 39.948 u in the mass unit of the style, from its energy, length and time
    joule, speed = 1.380649e-23 / units.boltzmann, units.angstrom * 1e-10 / (units.ps * 1e-12)
    mass = 39.948 * 1.66053907e-27 * speed**2 / (joule * units.energy)
    if style == "lj":
        length = energy = mass = 1.0
    time = length * np.sqrt(mass * units.energy / energy)
    text = DECK.format(
        atoms=ATOMS.replace("0.5 0 9", f"{number(0.5 * length)} 0 {number(9 * length)}"),
        extra="",
        inner=number(6.0 * length),
        cutoff=number(7.0 * length),
    )
    for old, new in {
        "units lj": f"units {style}",
        "-20 20 -20 20 -20 20": " ".join(number(x * length) for x in (-20, 20) * 3),
        "mass 1 1.0": f"mass 1 {number(mass)}",
        "pair_coeff 1 1 1.0 1.0": f"pair_coeff 1 1 {number(energy)} {number(length)}",
        "0 0 -1\n": f"0 0 {number(-length / time)} units box\n",
        "timestep 0.01": f"timestep {number(0.01 * time)}",
        "tolerance 1e-10": f"tolerance {number(1e-10 * energy)}",
    }.items():
        assert old in text
        text = text.replace(old, new)
    (folder / "in.argon").write_text(text)
    return folder / "in.argon"


def smoothed(r, inner=6.0, cutoff=7.0):
    """Potential of pair_style lj/smooth: beyond ``inner`` the force is a polynomial of third order that, with its first
    derivative, continues the one and vanishes at ``cutoff``."""
    width = cutoff - inner
    force = 48.0 * inner**-13 - 24.0 * inner**-7
    slope = -624.0 * inner**-14 + 168.0 * inner**-8
    third = -(3.0 * force + 2.0 * slope * width) / width**2
    fourth = (2.0 * force + slope * width) / width**3
    work = np.poly1d([fourth / 4, third / 3, slope / 2, force, 0.0])  # by the force, from inner on
    outer = work(width) - work(np.clip(r - inner, 0.0, width))
    inside = 4.0 * (r**-12 - r**-6) - 4.0 * (inner**-12 - inner**-6) + work(width)
    return np.where(r < inner, inside, outer)
