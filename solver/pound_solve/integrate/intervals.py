"""Intervals between output times: which of them can be advanced in modes as a whole, and when that pays."""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array

SAME_LENGTH = 1e-11  #: share by which intervals of one length may differ: the clock is rounded
FEW_INTERVALS = 50  #: number of intervals of one length up to which tables do not pay
MAX_UNKNOWNS = 200  #: of a part
MIN_RADIANS = 10.0  #: radians of the fastest mode in an interval from which on it pays: two steps by series


def most_common_length(times: Array) -> float:
    """Length of most of the intervals between some times; 0 where few have the same.

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
