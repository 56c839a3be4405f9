"""Many inputs, a thousand in each process: counts, and every fault with the input that shows it."""

import json
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field

from support.running import ONLY_TREE, TREE_BUILD, UNDEFINED, python_environment

IN_A_PROCESS = 1000


@dataclass
class Tally:
    """``faults``: pairs of text, the input and what is wrong; ``megabytes``: largest of a process."""

    counts: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)
    megabytes: float = 0.0
    seconds: float = 0.0

    @property
    def inputs(self):
        return sum(self.counts.values())


def run_worker(kind, seed, count, folder):
    """One process; returns its output, or the cause of its end."""
    last = folder / "last"
    last.write_text("(before the first input)")
    command = [sys.executable, "-m", "fuzz.worker", kind, str(seed), str(count), str(last)]
    environment = python_environment(TREE_BUILD if ONLY_TREE else None)
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode == 0:
        found = json.loads(done.stdout.splitlines()[-1])
        if UNDEFINED in done.stderr:
            found["faults"].append((f"{kind} {seed}", done.stderr[done.stderr.index(UNDEFINED) :][:3000]))
        return found
    how = f"exit code {done.returncode}"
    if done.returncode < 0:
        number = signal.Signals(-done.returncode)
        how = "hangs" if number == signal.SIGALRM else f"crashes ({number.name})"
    text = last.read_text(encoding="utf-8", errors="replace")
    return {"counts": {"ended": 1}, "faults": [(text, f"{how}: {done.stderr[-1000:]}")]}


def run(kind, inputs, folder, seed=0):
    """Tally of this number of inputs of a kind, "arguments" or "infile"; equal inputs for equal seeds."""
    tally, begin = Tally(), time.monotonic()
    for first in range(0, inputs, IN_A_PROCESS):
        found = run_worker(kind, seed + first, min(IN_A_PROCESS, inputs - first), folder)
        tally.counts.update(found["counts"])
        tally.faults += found["faults"]
        tally.megabytes = max(tally.megabytes, found.get("megabytes", 0.0))
    tally.seconds = time.monotonic() - begin
    return tally
