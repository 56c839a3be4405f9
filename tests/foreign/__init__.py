"""LAMMPS as judge: its own decks, its own styles and its own unit tests beside fix gear/quat.

python -m foreign [--all] [--publish]        what `tests/run foreign` calls
"""
