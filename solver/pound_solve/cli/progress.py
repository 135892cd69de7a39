"""The progress of a run: one line on a terminal, rewritten in place; elsewhere a line at intervals."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

WIDTH = 69  #: characters of the line
INTERVAL = 0.1  #: least time between two lines [s]
QUIET = 20.0  #: time to the first line where there is no terminal, doubled from line to line [s]


class StatusLine:
    """A line on the error stream that is rewritten in place if that is a terminal."""

    def __init__(self, quiet: bool = False) -> None:
        self.quiet, self.live = quiet, sys.stderr.isatty() and not quiet
        self._printed: set[str] = set()

    def show(self, text: str) -> None:
        """Replace the line."""
        if self.live:
            print(f"\r {text:{WIDTH}}", end="", file=sys.stderr, flush=True)

    def tell(self, text: str) -> None:
        """Show what a run is doing; where there is no terminal, or the text is longer than the line, print
        it once.
        """
        if self.live and len(text) <= WIDTH:
            self.show(text)
        elif not self.quiet and text not in self._printed:
            self.clear()
            self._printed.add(text)
            print(f"pound-solve: {text}", file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """Print a line where there is no terminal."""
        if not self.live and not self.quiet:
            print(f"pound-solve: {' '.join(text.split())}", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Erase the line."""
        if self.live:
            print("\r" + " " * (WIDTH + 1) + "\r", end="", file=sys.stderr, flush=True)


class AnalysisProgress:
    """Progress of an analysis, at most ten lines a second.

    A method may run the history several times: when the time decreases, a new run begins, and the estimate
    of the remaining time is that of this run.

    Parameters
    ----------
    quiet : bool
        Show nothing.
    check : callable
        Called before anything is shown; it may raise `KeyboardInterrupt`.
    """

    def __init__(self, quiet: bool, check: Callable[[], None] = lambda: None) -> None:
        self.line, self._check = StatusLine(quiet), check
        self.began = self.shown = time.monotonic()
        self.pause, self.first, self.reached, self.runs = QUIET, 0.0, 0.0, 1
        self.noted = self.began

    def __call__(self, t: float, end: float, doing: str) -> None:
        """Show the time `t` of `end` and an estimate of the remaining time, or the activity `doing`."""
        self._check()
        now = time.monotonic()
        if t < self.reached:
            self.runs, self.began, self.first = self.runs + 1, now, t
        self.reached = t
        if now - self.shown < INTERVAL and not doing:
            return
        self.shown = now
        if doing:
            self.line.tell(doing)
            return
        text = self._state(now, t, end)
        self.line.show(text)
        if now - self.noted > self.pause:
            self.noted, self.pause = now, 2.0 * self.pause
            self.line.note(text)

    def _state(self, now: float, t: float, end: float) -> str:
        """Text on the time reached, the number of the run and the seconds to go."""
        ahead = (now - self.began) * (end - t) / (t - self.first) if t > self.first else 0.0
        run = f"   run {self.runs}" if self.runs > 1 else ""
        return f"t = {t:10.4f} of {end:g}   {100 * t / end:5.1f} %{run}   {ahead:6.0f} s to go"

    def end(self) -> None:
        """Clear the line."""
        self.line.clear()
