"""Signals that end a run: the first ends it with its results, the second at once.

Ctrl-C, the request of a scheduler to end (SIGTERM) and the loss of the terminal (SIGHUP; on Windows the
closing of the console) are answered alike.

What must not be broken off, as a write of HDF5, stands within `undisturbed`.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import Any, Final, Self

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


@contextmanager
def undisturbed() -> Iterator[Callable[[], None]]:
    """Within this context a signal raises nothing: `KeyboardInterrupt` waits for its end, or for a call of
    what the context yields, where the block is ready to end.

    An exception raised amid a write of HDF5 would count as a write that failed, and one amid the record of
    a motion would count an event twice.  To block the signals of this thread would not do: the system hands
    them to another thread, and Python answers them in this one.  The handlers themselves run at once, so
    that a second signal still ends the process.  Where the block raises an exception of its own, that one
    holds; `Interruption.check` tells of the signal later.
    """
    waiting: list[KeyboardInterrupt] = []

    def answer_now() -> None:
        if waiting:
            raise waiting.pop()

    if threading.current_thread() is not threading.main_thread():  # where no handler ever runs
        yield answer_now
        return

    def put_off(handler: Callable[[int, FrameType | None], Any]) -> Callable[[int, FrameType | None], None]:
        def answer(number: int, frame: FrameType | None) -> None:
            try:
                handler(number, frame)
            except KeyboardInterrupt as interrupt:
                waiting.append(interrupt)

        return answer

    before = {number: previous for number in SIGNALS if callable(previous := signal.getsignal(number))}
    for number, previous in before.items():
        signal.signal(number, put_off(previous))
    try:
        yield answer_now
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)
    answer_now()
