"""Providers of callable kernels: from the library compiled ahead of time, compiled by numba, or as Python.

The whole process uses the first of the three that is available.  POUND_COMPILE=0 in the environment selects
the last.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib.util import find_spec
from typing import Final, Protocol

from pound_solve.numerics import library
from pound_solve.numerics.jit import Function, Numba

INTERPRETED = "steps are not compiled, some 100 times slower: pip install numba"
_RESIDENT: Final = ContextVar("resident", default=False)


class Provider(Protocol):
    """A way to obtain callable kernels."""

    @property
    def name(self) -> str:
        """How kernels run, in words for the report."""

    @property
    def fast(self) -> bool:
        """Whether kernels run as compiled code."""

    @property
    def loading(self) -> float:
        """Approximate time in which a process loads the kernels [s]."""

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """Return the callable kernel; with a numba signature, it can also be passed to kernels."""

    def notice(self, kernel: Function) -> str:
        """Return a message for the user before a run of this kernel; empty if there is none."""


class Interpreter:
    """Provider of kernels that run as Python.

    Parameters
    ----------
    notice : str
        Message for the user.
    """

    fast, loading = False, 0.0

    def __init__(self, notice: str) -> None:
        self._notice = notice
        self.name = f"as Python; {notice}" if notice else "as Python, which was asked for"

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """See `Provider`."""
        return kernel

    def notice(self, kernel: Function) -> str:
        """See `Provider`."""
        return self._notice


@cache
def provider() -> Provider:
    """Return the provider of this process."""
    if os.environ.get("POUND_COMPILE") == "0":
        return Interpreter("")
    loaded = library.load(library.FOLDER)
    if loaded is not None:
        return loaded
    refused = library.REFUSED if library.present(library.FOLDER) else ""
    if find_spec("numba"):
        return Numba(refused)
    return Interpreter("; ".join(filter(None, [refused, INTERPRETED])))


@contextmanager
def resident() -> Iterator[None]:
    """Enter a context of many runs, in which the loading time is not charged to each run."""
    token = _RESIDENT.set(True)
    try:
        yield
    finally:
        _RESIDENT.reset(token)


def loading() -> float:
    """Return the approximate loading time of the kernels of a run [s]; zero while they are `resident`."""
    return 0.0 if _RESIDENT.get() else provider().loading
