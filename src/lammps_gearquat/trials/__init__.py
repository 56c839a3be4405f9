"""Short trials of any input script: what accuracy costs there, and how long it can be trusted.

script          what the commands of a deck say: text in, text out
interpreter     the deck's flow of commands, up to the run that moves its bodies
worker          a process that replays these commands in LAMMPS, with other fix lines and steps
measure         trials of one deck: where its bodies are, and what it cost to bring them there
evaluate        errors, prices, fronts, growth: arrays in, numbers out
cost, horizon   the two questions
report, figures   the answers as text, tables and pictures
options         what both commands have in common
"""
