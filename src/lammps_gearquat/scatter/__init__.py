"""Collisions of two rigid bodies with any pair style: flights in LAMMPS, cross sections, collision integrals.

pair       the two bodies of a deck, and one flight of them in LAMMPS
track      the distance of the bodies during a flight
density    the density from which energies and impact parameters are drawn
sampling   the starts of the flights, each a function of the seed and of its number
cutoff     whether forces vanish smoothly at the cutoff
pilots     pilot flights: the largest impact parameter and the sampling density
pool       flights on several processes
flights    one flight as a row of numbers
store      the folder of results: settings, flights, and parts of it joined
conduct    a run of the command
replay     one flight as a dump
integrals  averages over flights with their errors: cross sections and collision integrals
gas        transport coefficients of the dilute gas: viscosity, diffusion, relaxation of rotation
results    all averages, counts and their convergence
report     the results as text, tables and JSON
"""

from .pair import End, Pair, Start, open_pair
from .sampling import Plan

__all__ = ["End", "Pair", "Plan", "Start", "open_pair"]
