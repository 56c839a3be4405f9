"""LAMMPS as judge: the decks and styles of LAMMPS together with fix gear/quat.

python -m foreign [--all] [--publish]        the command that `tests/run foreign` calls
"""
