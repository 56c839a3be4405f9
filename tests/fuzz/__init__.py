"""Broken input, in process: it makes the fix neither crash nor hang, and what is refused has a message.

`tokens.py` breaks words, `arguments.py` and `infile.py` make inputs, `worker.py` feeds them to LAMMPS,
`campaign.py` runs workers and counts.
"""
