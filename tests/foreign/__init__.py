"""LAMMPS as judge: the decks, styles and unit tests of LAMMPS together with fix gear/quat.

python -m foreign [--all] [--publish]        the command that `tests/run foreign` calls
"""
