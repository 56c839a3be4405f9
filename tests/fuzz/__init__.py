"""Malformed input, in process: the fix neither crashes nor hangs, and refuses input with a message.

`tokens.py` breaks words, `arguments.py` and `infile.py` make inputs, `worker.py` feeds them to LAMMPS,
`campaign.py` runs workers and counts.
"""
