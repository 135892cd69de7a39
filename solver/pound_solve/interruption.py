"""Signals that end a run: the first ends it with its results, the second immediately.

Ctrl-C, the request of a scheduler to end (SIGTERM) and the loss of the terminal (SIGHUP; on Windows the
closing of the console) are handled alike.

Operations that must not be interrupted, such as a write of HDF5, run within `undisturbed`.
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

    A library that catches every exception may also catch one that a signal raises within its calls:
    `check` raises it again.  A signal that the caller ignores (``nohup``) stays ignored.
    """

    def __init__(self) -> None:
        self.pending = False
        self._reported = False
        self._before: dict[int, object] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():  # Python allows handlers only there
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
        if self._reported:
            os._exit(128 + number)
        self._reported = self.pending = True
        name = signal.Signals(number).name
        text = f"\npound-solve: {name}: the run ends with what it has; a second one ends it at once\n"
        with suppress(OSError, ValueError):  # the terminal may be gone
            os.write(sys.stderr.fileno(), text.encode())
        raise KeyboardInterrupt

    def check(self) -> None:
        """Raise `KeyboardInterrupt` once if a library has suppressed that of a signal."""
        if self.pending:
            self.pending = False
            raise KeyboardInterrupt


@contextmanager
def undisturbed() -> Iterator[Callable[[], None]]:
    """Within this context a signal raises nothing: `KeyboardInterrupt` waits for the end of the context, or
    for a call of the yielded function, with which the block offers to end.

    An exception during a write of HDF5 would count as a failed write, and one during the recording of a
    motion would count an event twice.  Blocking the signals of this thread is not enough: the system passes
    them to another thread, and Python handles them in this one.  The handlers themselves run immediately,
    so that a second signal still ends the process.  If the block raises its own exception, that one
    prevails; `Interruption.check` reports the signal later.
    """
    waiting: list[KeyboardInterrupt] = []

    def answer_now() -> None:
        if waiting:
            raise waiting.pop()

    if threading.current_thread() is not threading.main_thread():  # no handler ever runs there
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
