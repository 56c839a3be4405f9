"""Collisions of two rigid bodies with any pair style: flights in LAMMPS, cross sections, collision integrals.

pair       the two bodies of a deck, and one flight of them in LAMMPS
sampling   the starts of the flights, each a function of the seed and of its number
cutoff     whether forces vanish smoothly at the cutoff
pool       flights on several processes
store      the folder of results: what is flown, what has been flown, and parts of it joined
largest    the largest impact parameter, from pilot flights
integrals  averages over flights with their errors: cross sections and collision integrals
gas        what they say of a dilute gas: viscosity, diffusion, relaxation of rotation
report     the answers as text, tables and JSON
"""

from .pair import End, Pair, Start, open_pair
from .sampling import Plan

__all__ = ["End", "Pair", "Plan", "Start", "open_pair"]
