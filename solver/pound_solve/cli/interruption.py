"""Signals that end a run: the first ends it with its results, the second at once.

Ctrl-C, the request of a scheduler to end (SIGTERM) and the loss of the terminal (SIGHUP; on Windows the
closing of the console) are answered alike.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import suppress
from types import FrameType, TracebackType
from typing import Final, Self

SIGNALS: Final = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK") if hasattr(signal, name)
)


class Interruption:
    """Within this context, the first signal raises `KeyboardInterrupt` and the second ends the process.

    A library that catches every exception also catches one that a signal raises within one of its calls:
    `check` raises it again.  A signal that the caller ignores (``nohup``) stays ignored.
    """

    def __init__(self) -> None:
        self.pending = False
        self._told = False
        self._before: dict[int, object] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():  # Python's rule for handlers
            for number in SIGNALS:
                if signal.getsignal(number) is not signal.SIG_IGN:
                    self._before[number] = signal.signal(number, self._take)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)  # type: ignore[arg-type]

    def _take(self, number: int, _: FrameType | None) -> None:
        if self._told:
            os._exit(128 + number)
        self._told = self.pending = True
        name = signal.Signals(number).name
        text = f"\npound-solve: {name}: the run ends with what it has; a second one ends it at once\n"
        with suppress(OSError, ValueError):  # the terminal may be gone
            os.write(sys.stderr.fileno(), text.encode())
        raise KeyboardInterrupt

    def check(self) -> None:
        """Raise `KeyboardInterrupt` once if a signal has come that a library kept back."""
        if self.pending:
            self.pending = False
            raise KeyboardInterrupt
