"""What each effect costs: instructions counted by valgrind, and time.

scenes.py (bodies on a lattice, one deck for many scenes), plan.py (effects and rungs of the ladder:
a row each), count.py (valgrind's tool callgrind), runs.py (all that is measured), page.py and
figures.py (doc/effects.md and its picture).
"""
