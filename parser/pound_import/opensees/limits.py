"""Limits of a process that replays a model, where the system has them."""

from __future__ import annotations

from typing import Final

MOST_MEMORY: Final = 2_000_000_000  #: bytes


def limited(seconds: float) -> None:
    """Limit this process in CPU time and memory; Windows has no such limits, only that of time."""
    try:
        import resource
    except ImportError:
        return
    for kind, value in ((resource.RLIMIT_CPU, int(seconds) + 5), (resource.RLIMIT_AS, MOST_MEMORY)):
        _, hard = resource.getrlimit(kind)
        most = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(kind, (most, hard))
