"""Many bodies: time, memory, growth, pressure and temperature beside LAMMPS' own fixes.

runs.py (what is run, and what is read from logs), decks.py (one input script a run), judge.py
(statistics and verdicts), page.py (tables and text), figures.py (pictures).
"""
