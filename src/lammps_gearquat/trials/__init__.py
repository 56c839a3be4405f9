"""Short trials of any input script: the cost of accuracy, and the time up to which a trajectory is accurate.

script          the commands of a deck: text in, text out
interpreter     the deck's flow of commands, up to the run that moves its bodies
checkpoint      the state after a run, saved and restored
process         a process of LAMMPS: it follows a deck, then replays it with other fix lines and steps
worker          that process, or its ranks, as the caller sees it; gearquat scatter has several
measure         trials of one deck: positions of its bodies, and the cost of reaching them
evaluate        prices and trends: arrays in, numbers out
methods         the keywords of the fix that are tried
doubt           the time until which errors can be judged
drift           the drift of the energy, and the temperatures of translation and rotation, at one step
sampling        the longest steps for long runs, where trajectories diverge
cost, until     the two questions
report          the answers as text and tables
"""

#: quantities that an error can refer to, over all bodies
NORMS = ("largest position", "rms position", "largest orientation", "rms orientation")
#: kT per degree of freedom and ns by which the energy may drift at a recommended step
BOUND = 0.1
