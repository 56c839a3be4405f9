"""What accuracy costs: error of a trajectory against force evaluations and against wall time.

plan.py      what is run: scenes, methods, steps
worker.py    one run, in a process of its own that only runs LAMMPS
measure.py   the runs in turn: errors first, then timings with all competitors interleaved
conduct.py   everything that is run, in order, with one progress bar
references.py  the reference of each scene
judge.py     errors of one run against the reference of its scene
stability.py largest stable steps: of the linear test equation, and of a scene by bisection
results.py   what was measured, as rows of CSV files
evaluate.py  fitted orders, costs at given errors, verdicts; arrays in, numbers out
tables.py    the tables as CSV and as Markdown
figures.py   the pictures; nothing is computed there
page.py      doc/accuracy_cost.md and README's block
"""
