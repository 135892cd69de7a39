"""What carries runs out: processes of this machine, or the workers of a Dask scheduler.

Both have the interface of `concurrent.futures.Executor`.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor
from typing import Final, NamedTuple

DASK: Final = "dask"
#: environment variables by which builds of numpy's linear algebra limit their threads
THREADS: Final = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


class ExecutorError(Exception):
    """The executor cannot be had; the text says why."""


class Engine(NamedTuple):
    """How runs are carried out.

    Attributes
    ----------
    start : callable
        Makes the executor, anew where one has broken.
    workers : int
        Runs at a time.
    notes : bool
        Whether its processes write the journal themselves.
    """

    start: Callable[[], Executor]
    workers: int
    notes: bool


def engine(name: str, workers: int) -> Engine:
    """The engine of a name.

    Parameters
    ----------
    name : str
        Empty for processes of this machine; ``dask://host:port`` for the workers of that scheduler, and
        ``dask`` for a scheduler with workers of its own on this machine.
    workers : int
        Processes; 0 for as many as there are processors.

    Raises
    ------
    ExecutorError
        There is no such executor, or it cannot be reached.
    """
    count = workers or processors()
    if not name:
        return Engine(lambda: processes(count), count, True)
    scheme, _, address = name.partition("://")
    if scheme != DASK:
        raise ExecutorError(
            f"--executor {name}: write dask://HOST:PORT, or dask for workers of its own here"
        )
    return _dask(address, count)


def processors() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def processes(count: int) -> ProcessPoolExecutor:
    """Processes that know nothing of this one (spawn), one thread each."""
    for name in THREADS:
        os.environ.setdefault(name, "1")
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(count, context, initializer=_begin)


def _begin() -> None:
    """A worker ends what it does when the user interrupts, and ends with the process that began it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _dask(address: str, count: int) -> Engine:
    """The workers of a Dask scheduler."""
    try:
        from distributed import Client
    except ImportError:
        text = 'it needs Dask: pip install "pound-solve[cluster]"'
        raise ExecutorError(text) from None
    try:
        client = (
            Client(f"tcp://{address}", timeout=30)
            if address
            else Client(n_workers=count, threads_per_worker=1)
        )
    except OSError as err:
        raise ExecutorError(f"no Dask scheduler answers at {address}: {err}") from None
    threads = sum(client.nthreads().values())
    return Engine(lambda: client.get_executor(pure=False), threads or count, False)
