"""Marks of tests that need compiled kernels or numba, and the choice of what makes kernels ready."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

from pound_solve.integrate import auto, trial
from pound_solve.numerics import library
from pound_solve.numerics.jit import Numba
from pound_solve.numerics.providers import provider

FAST = pytest.mark.skipif(not provider().fast, reason="kernels are not compiled")
NUMBA = pytest.mark.skipif(find_spec("numba") is None, reason="numba is not installed")


@contextmanager
def interpreted() -> Iterator[None]:
    """Kernels run as Python, whose parts a test can replace."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POUND_COMPILE", "0")
        provider.cache_clear()
        assert not provider().fast
        yield
    provider.cache_clear()


@contextmanager
def by_numba(no_library: Path) -> Iterator[None]:
    """Numba compiles the kernels; a folder without libraries stands in for the program's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("POUND_COMPILE", raising=False)
        patch.setattr(library, "FOLDER", no_library)
        provider.cache_clear()
        assert isinstance(provider(), Numba)
        yield
    provider.cache_clear()


def as_with_numba(monkeypatch: pytest.MonkeyPatch) -> None:
    """AUTO counts a second for the loading of kernels, as it does with numba; none with a library."""
    for module in (auto, trial):
        monkeypatch.setattr(module, "loading", lambda: 1.0)


def steps_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep AUTO from EXACT and TAYLOR."""
    monkeypatch.setattr(auto, "reason_not_linear", lambda system: "steps are asked for")
    monkeypatch.setattr(auto, "has_series", lambda system: False)
