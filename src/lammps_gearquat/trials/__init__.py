"""Short trials of any input script: what accuracy costs there, and how long it can be trusted.

script          what the commands of a deck say: text in, text out
interpreter     the deck's flow of commands, up to the run that moves its bodies
checkpoint      the state that a run has led to, saved and restored
process         what is done in a process of LAMMPS: it follows a deck, then replays it with other fix lines and steps
worker          that process, or several ranks of it, as the caller sees it; gearquat scatter has several
measure         trials of one deck: where its bodies are, and what it cost to bring them there
evaluate        prices, trends and growth: arrays in, numbers out
methods         the keywords of the fix that are tried
doubt           until what time errors can be judged
drift           the drift of the energy, and the temperatures of translation and rotation, at one step
sampling        the longest steps for long runs, where trajectories diverge
explain         causes of LAMMPS' errors, and what to write then
cost, horizon   the two questions
report          the answers as text and tables; sampling_report, those of sampling
"""

#: what an error is of, over all bodies
NORMS = ("largest position", "rms position", "largest orientation", "rms orientation")
#: kT per degree of freedom and ns by which the energy may drift at a recommended step
BOUND = 0.1
