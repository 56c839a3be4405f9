"""Many inputs, a thousand in each process: counts, and every fault with the input that shows it."""

import json
import os
import signal
import subprocess
import sys
import sysconfig
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
IN_A_PROCESS = 1000


@dataclass
class Outcome:
    """``faults``: pairs of text, the input and what is wrong; ``megabytes``: largest of a process."""

    counts: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)
    megabytes: float = 0.0
    seconds: float = 0.0

    @property
    def inputs(self):
        return sum(self.counts.values())


def run_worker(kind, seed, count, folder):
    """One process; returns what it printed, or what ended it."""
    last = folder / "last"
    last.write_text("(before the first input)")
    environment = {
        **os.environ,
        "PYTHONPATH": str(TESTS),
        "LD_LIBRARY_PATH": str(Path(sysconfig.get_path("data")) / "lib"),  # the module's libraries
        "OMP_NUM_THREADS": "1",
        "RES_OPTIONS": "attempts:0",
    }
    command = [sys.executable, "-m", "fuzz.worker", kind, str(seed), str(count), str(last)]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode == 0:
        return json.loads(done.stdout.splitlines()[-1])
    how = f"exit code {done.returncode}"
    if done.returncode < 0:
        number = signal.Signals(-done.returncode)
        how = "hangs" if number == signal.SIGALRM else f"crashes ({number.name})"
    text = last.read_text(encoding="utf-8", errors="replace")
    fault = {"input": text, "fault": f"{how}: {done.stderr[-1000:]}"}
    return {"counts": {"ended": 1}, "faults": [fault], "megabytes": 0.0}


def run(kind, inputs, folder, seed=0):
    """Outcome of so many inputs of a kind, "arguments" or "infile"; the same ones for the same seed."""
    outcome, begin = Outcome(), time.monotonic()
    for first in range(0, inputs, IN_A_PROCESS):
        found = run_worker(kind, seed + first, min(IN_A_PROCESS, inputs - first), folder)
        outcome.counts.update(found["counts"])
        outcome.faults += [(fault["input"], fault["fault"]) for fault in found["faults"]]
        outcome.megabytes = max(outcome.megabytes, found["megabytes"])
    outcome.seconds = time.monotonic() - begin
    return outcome
