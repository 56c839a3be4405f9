"""The laboratory: the programs that measure the numbers on the pages of doc/.  It is not installed; see benchmarks/run.

It imports the installed package ``lammps_gearquat``, which imports nothing from this package.
"""
