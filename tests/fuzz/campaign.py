"""Many inputs, a thousand in each request to a Worker: counts, and every fault with the input that shows it."""

import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field

from lammps_gearquat.launch import LammpsError
from lammps_gearquat.trials.worker import Worker
from support.running import ONLY_TREE, TREE_BUILD, UNDEFINED, python_environment

from .worker import work

IN_A_REQUEST = 1000


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


def run(kind, inputs, folder, seed=0):
    """Tally of this number of inputs of a kind, "arguments" or "infile"; equal inputs for equal seeds."""
    tally, begin, last = Tally(), time.monotonic(), folder / "last"
    with tempfile.TemporaryDirectory() as own:
        worker = Worker(own, 1, python_environment(TREE_BUILD if ONLY_TREE else None))
        for first in range(0, inputs, IN_A_REQUEST):
            last.write_text("(before the first input)")
            asked = dict(kind=kind, seed=seed + first, count=min(IN_A_REQUEST, inputs - first), last=last)
            try:
                ((counts, faults, megabytes),) = worker.ask(work, **asked)
            except LammpsError as error:  # a crash, or a hang
                text = last.read_text(encoding="utf-8", errors="replace")
                counts, faults, megabytes = {"ended": 1}, [(text, str(error))], 0.0
            tally.counts.update(counts)
            tally.faults += faults
            tally.megabytes = max(tally.megabytes, megabytes)
        worker.end()
        said = worker.output.read_text(errors="replace")
    if UNDEFINED in said:
        tally.faults.append((kind, said[said.index(UNDEFINED) :][:3000]))
    tally.seconds = time.monotonic() - begin
    return tally
