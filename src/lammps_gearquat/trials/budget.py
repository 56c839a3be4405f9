"""The wall time that trials may take."""

import time as clock

#: seconds of the budget for tables and pictures
CLOSING = 10.0


class Budget:
    """Seconds of wall time, shown by ``progress`` (an object like a tqdm bar, or None).

    The time begins at ``begin`` on the monotonic clock; None means now.
    """

    def __init__(self, seconds, progress=None, begin=None):
        self.seconds, self.progress = seconds, progress
        self.begin = clock.monotonic() if begin is None else begin

    def spent(self):
        """Seconds since the beginning; updates the bar."""
        now = clock.monotonic() - self.begin
        if self.progress is not None:
            self.progress.update(max(0.0, min(now, self.seconds) - self.progress.n))
        return now

    def left(self):
        """Seconds that trials may still take."""
        return self.seconds - min(CLOSING, 0.1 * self.seconds) - self.spent()

    def say(self, text):
        if self.progress is not None:
            self.progress.set_description(text)
