"""Collisions of two rigid bodies with any pair style: flights in LAMMPS, cross sections, collision integrals.

pair       the two bodies of a deck, and one flight of them in LAMMPS
sampling   the starts of the flights
flights    flights on several processes, each as a row of numbers
integrals  averages over flights with their errors: cross sections and collision integrals
gas        transport coefficients of the dilute gas: viscosity, diffusion, relaxation of rotation
"""
