"""Decimals of instants in printed tables."""

from __future__ import annotations

import math
from typing import Any


def decimals(rows: Any) -> int:
    """Number of decimals for the instants in rows of envelopes."""
    return digits(max(latest(rows, "t_max"), latest(rows, "t_min")))


def latest(rows: Any, name: str) -> float:
    """Latest finite instant of a column; 0 where there is none."""
    return max((t for t in rows[name].tolist() if math.isfinite(t)), default=0.0)


def digits(last: float) -> int:
    """Number of decimals that show a ten-thousandth of a time, at least three."""
    return max(3, 4 - math.ceil(math.log10(last))) if last > 0.0 else 3
