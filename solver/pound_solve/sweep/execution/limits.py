"""Limits of time and memory of one run.

Time is CPU time of the process, so that a machine that sleeps or does other work ends no run.  A run that
does not look at the clock, because something hangs, ends with its process.
"""

from __future__ import annotations

import faulthandler
import os
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Final

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

MB: Final = 2**20
#: a run that does not look at the clock is ended after so many limits and so many seconds more
LIMITS, GRACE = 10.0, 60.0
_HELD: Final = Path("/proc/self/statm")


class TooLongError(Exception):
    """Raised where a run takes longer than it may."""


class Clock:
    """Takes the progress of a run and raises `TooLongError` where its time is up.

    The time counts from the first call on: a process that loads kernels has not begun.

    Parameters
    ----------
    seconds : float or None
        CPU time that the run may take [s].
    """

    def __init__(self, seconds: float | None) -> None:
        self.seconds = seconds
        self._began: float | None = None

    def __call__(self, t: float, end: float, doing: str) -> None:
        """See `sequence.Progress`."""
        now = time.process_time()
        if self._began is None:
            self._began = now
        if self.seconds is not None and now - self._began > self.seconds:
            raise TooLongError


@contextmanager
def within(seconds: float | None, memory: float | None) -> Iterator[Clock]:
    """Limit a run within the block; yield the clock that its progress must be reported to.

    Parameters
    ----------
    seconds : float or None
        CPU time [s].
    memory : float or None
        What the run may take beside what the process holds already [MB]; kept on Linux only.
    """
    with ExitStack() as limits:
        if seconds is not None:
            nowhere = limits.enter_context(open(os.devnull, "w"))
            faulthandler.dump_traceback_later(LIMITS * seconds + GRACE, exit=True, file=nowhere)
            limits.callback(faulthandler.cancel_dump_traceback_later)
        if memory is not None and resource is not None and _HELD.is_file():
            before = resource.getrlimit(resource.RLIMIT_AS)
            held = int(_HELD.read_text().split()[0]) * resource.getpagesize()
            resource.setrlimit(resource.RLIMIT_AS, (held + int(memory * MB), before[1]))
            limits.callback(resource.setrlimit, resource.RLIMIT_AS, before)
        yield Clock(seconds)
