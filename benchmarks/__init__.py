"""The laboratory: what measures the pages of doc/.  It is not installed; see benchmarks/run.

It imports the installed package ``lammps_gearquat``, which imports nothing from here.
"""
