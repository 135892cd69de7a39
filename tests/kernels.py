"""Marks of tests that need compiled kernels, and the switches to kernels as Python and to steps alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from pound_solve.integrate import auto
from pound_solve.numerics.jit import Numba
from pound_solve.numerics.providers import provider

FAST = pytest.mark.skipif(not provider().fast, reason="kernels are not compiled")
NUMBA = pytest.mark.skipif(not isinstance(provider(), Numba), reason="numba does not compile the kernels")


@contextmanager
def interpreted() -> Iterator[None]:
    """Kernels run as Python, whose parts a test can replace."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("POUND_COMPILE", "0")
        provider.cache_clear()
        assert not provider().fast
        yield
    provider.cache_clear()


def steps_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep AUTO from EXACT and TAYLOR."""
    monkeypatch.setattr(auto, "not_linear", lambda system: "steps are asked for")
    monkeypatch.setattr(auto, "has_series", lambda system: False)
