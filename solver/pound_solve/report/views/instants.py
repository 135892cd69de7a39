"""Instants in print."""

from __future__ import annotations

import math
from typing import Any


def decimals(rows: Any) -> int:
    """Decimals of the instants of envelopes."""
    return digits(max(latest(rows, "t_max"), latest(rows, "t_min")))


def latest(rows: Any, name: str) -> float:
    """Last of the instants of a column; 0 where there are none."""
    return max((t for t in rows[name].tolist() if math.isfinite(t)), default=0.0)


def digits(last: float) -> int:
    """Decimals that tell a ten-thousandth of a time, three at least."""
    return max(3, 4 - math.ceil(math.log10(last))) if last > 0.0 else 3
