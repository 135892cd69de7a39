"""Processes that judge cases within limits of time and memory, and are replaced where they end."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any

from fuzz.cases import case
from fuzz.judge import Outcome, judge
from pound_solve.numerics import library

MEMORY = 2**30  #: bytes that a process may ask for
#: CPU seconds that a case may take; one of `RUNS` is then asked to end, as by Ctrl-C, and has `GRACE`
LIMITS = {
    "deck": 20.0,
    "verbs": 60.0,
    "editor": 60.0,
    "record": 5.0,
    "results": 30.0,
    "words": 10.0,
    "run": 15.0,
    "options": 15.0,
    "study": 30.0,
    "import": 10.0,
    "texts": 60.0,
}
RUNS = ("run", "options", "study", "texts")
GRACE = 10.0
PATIENCE = 100.0  #: times the limit after which a process that uses no CPU counts as hanging
MOST_CASES = 2000  #: of one process: a new one has a clean memory


def limit(seconds: float, kind: str) -> None:
    """Have the system end this process, or a run of it, after some seconds of CPU time (POSIX)."""
    if not hasattr(signal, "setitimer"):
        return

    def ask(number: int, frame: object) -> None:
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_PROF, GRACE)
        signal.raise_signal(signal.SIGINT)

    signal.signal(signal.SIGPROF, ask if kind in RUNS else signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    # compiled code that never returns to Python hears none of this: the system ends it
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds + 3.0 * GRACE if seconds else 0.0)


def bound_memory() -> None:
    """Bound what the process may hold (Linux, whose bound counts memory that is written)."""
    if sys.platform == "linux":
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def serve(connection: Connection, seed: int, bases: Mapping[str, bytes]) -> None:
    """Judge the cases that come, until none does."""
    if library.load(library.FOLDER) is None:  # numba would compile within the limits of a case
        os.environ["POUND_COMPILE"] = "0"
    os.environ.setdefault("MPLBACKEND", "Agg")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # which a shell may have had ignored
    bound_memory()
    while (task := connection.recv()) is not None:
        kind, number = task
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            own = case(kind, seed, number, bases)
            limit(LIMITS[kind], kind)
            try:
                outcome = judge(own, Path(folder))
            finally:
                limit(0.0, kind)
                os.chdir("/")
        connection.send((kind, number, outcome))


class Worker:
    """One process."""

    def __init__(self, seed: int, bases: Mapping[str, bytes]) -> None:
        self.given = seed, bases
        self.task: tuple[str, int] | None = None
        self.cases, self.begun = 0, 0.0
        self.start()

    def start(self) -> None:
        """Start the process."""
        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=serve, args=(other, *self.given), daemon=True)
        self.process.start()
        other.close()
        self.cases = 0

    def give(self, task: tuple[str, int]) -> None:
        """Give it a case."""
        if self.cases >= MOST_CASES:
            self.end()
            self.start()
        self.task, self.begun = task, time.monotonic()
        self.cases += 1
        self.connection.send(task)

    def take(self) -> tuple[str, int, Outcome] | None:
        """What became of its case; None while that is open."""
        assert self.task is not None
        try:
            if self.connection.poll():
                found: tuple[str, int, Outcome] = self.connection.recv()
                self.task = None
                return found
        except EOFError:
            pass
        else:
            if self.process.is_alive() and time.monotonic() < self.begun + PATIENCE * LIMITS[self.task[0]]:
                return None
            self.process.kill()
        self.process.join()
        code = self.process.exitcode or 0
        hangs = code in [-getattr(signal, name, 0) for name in ("SIGPROF", "SIGVTALRM", "SIGKILL")]
        (kind, number), self.task = self.task, None
        self.start()
        return kind, number, Outcome("hang" if hangs else "crash", f"the process ended with {code}")

    def end(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()
        self.connection.close()


def outcomes(
    tasks: Iterator[tuple[str, int]], jobs: int, seed: int, bases: Mapping[str, bytes]
) -> Iterator[tuple[str, int, Outcome]]:
    """Outcomes of cases in the order in which they end."""
    workers = [Worker(seed, bases) for _ in range(jobs)]
    try:
        for worker, task in zip(workers, tasks):
            worker.give(task)
        while busy := [worker for worker in workers if worker.task]:
            ready: list[Any] = wait([worker.connection for worker in busy], timeout=1.0)
            for worker in busy:
                late = worker.connection not in ready
                found = worker.take() if not late or time.monotonic() > worker.begun + 1.0 else None
                if found is not None:
                    yield found
                    if (task := next(tasks, None)) is not None:  # type: ignore[arg-type]
                        worker.give(task)
    finally:
        for worker in workers:
            worker.end()
