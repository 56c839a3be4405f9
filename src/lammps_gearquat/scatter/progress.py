"""Progress of a run: a bar in a terminal, and lines in the log of a batch job."""

import sys
import time

from gearquat_analysis.options import progress_bar

#: seconds between two lines where there is no terminal
EVERY = 60.0


class Progress:
    """Use it in a with statement.  ``clock``: function of the time in seconds."""

    def __init__(self, clock=time.monotonic):
        self._bar, self._clock = progress_bar(total=0, unit=" flights", desc="reading the deck"), clock
        self._what, self._done, self._total, self._told = "", 0, 0, clock()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._bar.close()

    def begin(self, what, count, done=0):
        """Begin to simulate ``count`` of ``what``, flights of some kind; ``done`` of them are known."""
        self._what, self._done, self._total = what, done, count + done
        self._bar.set_description(what)
        self._bar.total = self._bar.n + count

    def advance(self, count):
        """Count this number of further finished flights."""
        self._done += count
        self._bar.update(count)
        if self._bar.disable and self._clock() - self._told >= EVERY:
            self.tell(f"{self._what}: {self._done} of {self._total}")

    def tell(self, text):
        """Write a line above the bar."""
        self._told = self._clock()
        self._bar.write(text, file=sys.stderr)
        sys.stderr.flush()
