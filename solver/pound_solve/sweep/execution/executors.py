"""Executors of runs: processes of this machine, or the workers of a Dask scheduler.

Both have the interface of `concurrent.futures.Executor`.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import resource_tracker
from typing import Any, Final, NamedTuple, TypeVar

from pound_solve.numerics import threads

DASK: Final = "dask"
AHEAD, MANY = 2, 1000  #: runs submitted at a time to each process, and to a scheduler
HELD_BACK: Final = (signal.SIGINT,)
PATIENCE: Final = 60.0  #: timeout for a scheduler that does not answer [s]


_T = TypeVar("_T")


class ExecutorError(Exception):
    """Raised if an executor does not exist or cannot be reached; the text states why."""


class Engine(NamedTuple):
    """Settings of the execution: factory of the executors, and number of runs submitted to each.

    Attributes
    ----------
    start : callable
        Makes an executor, also to replace a broken one.
    workers : int
        Number of concurrent runs, as far as known.
    lanes : int
        Executors: one for each process of this machine, so that each keeps its own structures; a scheduler
        is one.
    ahead : int
        Runs submitted to an executor in advance, so that no worker is idle.
    notes : bool
        Whether its processes write the journal themselves.
    """

    start: Callable[[], Executor]
    workers: int
    lanes: int
    ahead: int
    notes: bool


def engine(name: str, workers: int) -> Engine:
    """Make the engine of that name.

    Parameters
    ----------
    name : str
        Empty for processes of this machine; ``dask://host:port`` for the workers of that scheduler, and
        ``dask`` for a new scheduler with workers on this machine.
    workers : int
        Number of processes; 0 for one per processor.  An existing scheduler has its own workers.

    Raises
    ------
    ExecutorError
        There is no such executor, or it cannot be reached.
    """
    count = workers or processors()
    if not name:
        return Engine(process, count, count, AHEAD, True)
    scheme, _, address = name.partition("://")
    if scheme != DASK:
        raise ExecutorError(
            f"--executor {name}: write dask://HOST:PORT, or dask for workers of its own here"
        )
    options: dict[str, Any] = {"address": f"tcp://{address}"}
    if not address:
        options = {"n_workers": count, "threads_per_worker": 1, "dashboard_address": None}
    return Engine(lambda: DaskExecutor(**options), count, 1, MANY, False)


def processors() -> int:
    """Number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def process() -> ProcessPoolExecutor:
    """Start a worker process by spawn, so that it shares no state with this one, with one thread."""
    threads.one()
    pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), initializer=_begin)
    with _interrupts_held_back():
        pool.submit(os.getpid)  # the process starts with the first call
    return pool


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    """Keep Ctrl-C from a process that starts within this context until it calls `_begin`: Python would end
    with a traceback while it reads its modules.  A Ctrl-C for this process waits for the end.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    resource_tracker.ensure_running()  # it lets the signals in again where it starts
    signal.pthread_sigmask(signal.SIG_BLOCK, HELD_BACK)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HELD_BACK)


def _begin() -> None:
    """Prepare a worker: it ignores Ctrl-C, so as to finish its run, and ends with its parent process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, HELD_BACK)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


class DaskExecutor(Executor):
    """Executor on the workers of a Dask scheduler, whose runs end when this executor is shut down.

    Parameters
    ----------
    options : mapping
        Of a `distributed.Client`.

    Raises
    ------
    ExecutorError
        Dask is not installed, or no scheduler answers.
    """

    def __init__(self, **options: Any) -> None:
        try:
            from distributed import Client
        except ImportError:
            raise ExecutorError('Dask is missing: pip install "pound-solve[cluster]"') from None
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # the sweep itself reports lost runs
        try:
            self._client = Client(timeout=PATIENCE, set_as_default=False, **options)
        except OSError as err:
            raise ExecutorError(
                f"no Dask scheduler answers at {options.get('address', '')}: {err}"
            ) from None
        self._inner = self._client.get_executor(pure=False)

    def submit(self, fn: Callable[..., _T], /, *args: Any, **kwargs: Any) -> Future[_T]:
        """Hand a call to a worker."""
        future: Future[_T] = self._inner.submit(fn, *args, **kwargs)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the connection; runs that have not ended are cancelled unless waited for."""
        self._inner.shutdown(wait=wait and not cancel_futures)
        self._client.close()
