"""Broken input, in process: is what the fix accepts right, and does it survive what it refuses?

`tokens.py` breaks words, `arguments.py` and `infile.py` make inputs and say by a grammar of their own what
has to become of them, `worker.py` feeds them to LAMMPS, `campaign.py` runs workers and counts.
"""
