"""Passes inputs to LAMMPS in the process of a Worker; see campaign.py.

A crash or a hang ends the process: the input is then in the file that the caller has named.
"""

import os
import random
import resource
import signal
from collections import Counter
from pathlib import Path

from lammps_gearquat.launch import open_library

from . import arguments, infile

PATIENCE = 60  # seconds for one input, also with sanitizers
FRESH = 250  # inputs for one LAMMPS
MOST_FAULTS = 20


class Scene:
    """LAMMPS with six atoms, put back after every input."""

    def __init__(self, module):
        for name, text in module.FILES.items():
            Path(name).write_text(text, encoding="utf-8")
        self.module, self.lmp = module, None
        self.renew()

    def renew(self):
        if self.lmp:
            self.lmp.close()
        self.lmp = open_library()
        self.lmp.commands_string(self.module.SETUP)
        self.begin = {
            name: self.lmp.numpy.extract_atom(name).copy() for name in ("x", "v", "image")
        }

    def put_back(self):
        self.lmp.command("unfix move")
        self.lmp.command("timestep 0.01")
        for name, values in self.begin.items():
            self.lmp.numpy.extract_atom(name)[: len(values)] = values

    def stir(self):
        """An atom is created and deleted, so that LAMMPS calls all fixes that it knows."""
        self.lmp.command("create_atoms 1 single 9 9 9")
        self.lmp.command("group extra id 7")
        self.lmp.command("delete_atoms group extra compress no")

    def define(self, command):
        """Defines the fix; returns LAMMPS' words if it refuses, else an empty string."""
        try:
            self.lmp.command(command)
        except UnicodeDecodeError:  # in messages of any command, LAMMPS may cut a character in two
            return "ERROR"
        except Exception as error:  # the exception of LAMMPS' module
            return str(error) or "?"
        return ""

    def attempt(self, command, text):
        """Whether an input is accepted, and any fault that was found."""
        Path("bodies").write_text(text, encoding="utf-8", newline="")
        refusal = self.define(command)
        if refusal:
            self.stir()
            named = self.module.NAMED in refusal
            return False, "" if named else f"an error without '{self.module.NAMED}': {refusal}"
        wrong = ""
        try:
            self.lmp.command("run 1 post no")
            self.put_back()
        except Exception as error:
            if "Fix gear/quat" not in str(error):
                wrong = f"accepted, and then: {error}"
            self.renew()
        return True, wrong


def work(kind, seed, count, last, tell):
    """Counts, faults and memory of ``count`` inputs; ``last``: a file that holds the present input."""
    os.chdir(last.parent)
    module = {"arguments": arguments, "infile": infile}[kind]
    rng, scene = random.Random(f"{kind} {seed}"), Scene(module)
    counts, faults = Counter(), []
    for n in range(count):
        if n and n % FRESH == 0:
            scene.renew()
        signal.alarm(PATIENCE)
        command, text = module.draw(rng)
        shown = f"{command}\n{text}"
        last.write_text(shown, encoding="utf-8", newline="")
        accepted, wrong = scene.attempt(command, text)
        counts["accepted" if accepted else "refused"] += 1
        if wrong and len(faults) < MOST_FAULTS:
            faults.append((shown, wrong))
    signal.alarm(0)
    scene.lmp.close()
    return [counts, faults, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]
