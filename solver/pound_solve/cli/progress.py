"""The progress of a run: one line on a terminal, rewritten in place; elsewhere a line at intervals."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from pound_solve.cli import terminal

INTERVAL = 0.1  #: least time between two lines [s]
QUIET = 20.0  #: time to the first line where there is no terminal, doubled from line to line [s]
EDGE = 2  #: columns left free: the blank before the line, and the last one, where some terminals wrap


class StatusLine:
    """A line on the error stream that is rewritten in place if that is a terminal."""

    def __init__(self, quiet: bool = False) -> None:
        self.quiet, self.live = quiet, sys.stderr.isatty() and not quiet
        self._printed: set[str] = set()
        self._length = 0

    @property
    def width(self) -> int:
        """Characters that fit into the line at present."""
        return terminal.columns(sys.stderr) - EDGE

    def show(self, *texts: str) -> None:
        """Replace the line by the first of some texts that fits, else by the last one, shortened."""
        if self.live:
            width = self.width
            text = next((text for text in texts if len(text) <= width), texts[-1])
            text = terminal.fitted(text, width)
            print(f"\r {text.ljust(self._length)}", end="", file=sys.stderr, flush=True)
            self._length = len(text)

    def tell(self, text: str) -> None:
        """Show what a run is doing; where there is no terminal, or the text is longer than the line, print
        it once.
        """
        if self.live and len(text) <= self.width:
            self.show(text)
        elif not self.quiet and text not in self._printed:
            self.clear()
            self._printed.add(text)
            print(f"pound-solve: {text}", file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """Print a line where there is no terminal."""
        if not self.live and not self.quiet:
            print(f"pound-solve: {text}", file=sys.stderr, flush=True)

    def clear(self) -> None:
        """Erase the line."""
        if self.live:
            print("\r" + " " * (self._length + 1) + "\r", end="", file=sys.stderr, flush=True)
            self._length = 0


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
        texts = self._state(now, t, end)
        self.line.show(*texts)
        if now - self.noted > self.pause:
            self.noted, self.pause = now, 2.0 * self.pause
            self.line.note(texts[1])

    def _state(self, now: float, t: float, end: float) -> tuple[str, str, str]:
        """Texts on the time reached, the number of the run and the seconds to go, the widest first."""
        ahead = (now - self.began) * (end - t) / (t - self.first) if t > self.first else 0.0
        run = f"run {self.runs}" if self.runs > 1 else ""
        wide = f"   {run}" if run else ""
        narrow = f" {run}" if run else ""
        percent = 100 * t / end
        return (
            f"t = {t:10.4f} of {end:g}   {percent:5.1f} %{wide}   {ahead:6.0f} s to go",
            f"t = {t:.4f} of {end:g} {percent:.1f} %{narrow} {ahead:.0f} s to go",
            f"{percent:.0f} %{narrow} {ahead:.0f} s to go",
        )

    def end(self) -> None:
        """Clear the line."""
        self.line.clear()
