"""Limits of time and memory of one run.

Time is CPU time of the process, so that sleep or other load of the machine ends no run.  A run that hangs,
and therefore does not check the clock, is ended with its process.
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
#: multiple of the limit, and additional seconds, after which a run that does not check the clock is ended
LIMITS, GRACE = 10.0, 60.0
_HELD: Final = Path("/proc/self/statm")


class TooLongError(Exception):
    """Raised if a run exceeds its time limit."""


class Clock:
    """Progress callback of a run that raises `TooLongError` when its time is up.

    Time counts from the first call on, so that loading of kernels is excluded.

    Parameters
    ----------
    seconds : float or None
        Limit of CPU time [s].
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
    """Limit a run within the context; yield the clock to which its progress must be reported.

    Parameters
    ----------
    seconds : float or None
        CPU time [s].
    memory : float or None
        Limit of memory in addition to that already used by the process [MB]; enforced on Linux only.
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
