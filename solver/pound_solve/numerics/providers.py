"""Kernels ready to be called: from the library compiled ahead of time, compiled by numba, or as Python.

The first of the three that there is serves the whole process.  POUND_COMPILE=0 in the environment asks for
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
    """A way to make kernels ready to be called."""

    @property
    def name(self) -> str:
        """How kernels run, for the report."""

    @property
    def fast(self) -> bool:
        """Whether kernels run as compiled code."""

    @property
    def loading(self) -> float:
        """Approximate time that a process takes to load the kernels [s]."""

    def ready(self, kernel: Function, signature: str = "") -> Function:
        """The kernel ready to be called; with a signature of numba, ready to be handed to kernels."""

    def notice(self, kernel: Function) -> str:
        """What a user has to know before a run of this kernel; empty if nothing."""


class Interpreter:
    """Kernels as Python.

    Parameters
    ----------
    notice : str
        What a user has to know of it.
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
    """The way in which this process makes kernels ready."""
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
    """Context in which a process carries out many runs, so that the loading time is not charged to each."""
    token = _RESIDENT.set(True)
    try:
        yield
    finally:
        _RESIDENT.reset(token)


def loading() -> float:
    """Approximate time that the kernels of a run take to load [s]; zero while they are `resident`."""
    return 0.0 if _RESIDENT.get() else provider().loading
