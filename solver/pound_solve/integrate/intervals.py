"""Intervals between output times: which ones can be advanced in modes as a whole, and when that pays."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array

SAME_LENGTH = 1e-11  #: fraction by which equal intervals may differ, because the clock is rounded
FEW_INTERVALS = 50  #: number of equal intervals up to which tables do not pay
MAX_UNKNOWNS = 200  #: of a part
MIN_RADIANS = 10.0  #: fewest radians of the fastest mode in an interval that pays: two steps by series


def most_common_length(times: Array) -> float:
    """Return the most common length of the intervals between the times; 0 if few intervals share it.

    Each length is exact only to the rounding of the clock; their mean removes an error that would
    accumulate over thousands of periods.
    """
    if len(times) <= FEW_INTERVALS:
        return 0.0
    lengths = np.sort(np.diff(times))
    ends = np.flatnonzero(np.diff(lengths, append=np.inf) > SAME_LENGTH * lengths) + 1
    counts = np.diff(ends, prepend=0)
    most = int(np.argmax(counts))
    alike = lengths[ends[most] - counts[most] : ends[most]]
    return float(alike.mean()) if len(alike) > FEW_INTERVALS else 0.0
