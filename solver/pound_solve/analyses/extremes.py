"""Extremes: the smallest and largest values of every quantity within intervals of time.  A stored history
thus covers the motion between its samples, even if they are coarse.

Values are taken at the instants of the method; the envelopes contain the peaks of the whole history.  If
there are too many sample intervals for the memory limit, 2, 4, 8, ... of them are merged.
"""

from __future__ import annotations

import numpy as np

from pound_solve.numerics.types import Array, Index

BYTES = 16  #: of a quantity in an interval


def intervals(times: Array, count: int, room: float) -> Array:
    """Return the bounds of the intervals, shape (n + 1,), or (0,) if there are none.

    Parameters
    ----------
    times : ndarray, shape (n_times,)
        Of the samples [T].
    count : int
        Number of quantities.
    room : float
        Memory limit [bytes].
    """
    joined, samples = 1, len(times) - 1
    if samples < 1 or room < BYTES * count or not count:
        return np.zeros(0)
    while -(-samples // joined) * BYTES * count > room:
        joined *= 2
    return np.append(times[:-1:joined], times[-1])


class IntervalExtremes:
    """Smallest and largest values of some quantities within contiguous intervals.

    Parameters
    ----------
    bounds : ndarray, shape (n_intervals + 1,) or (0,)
        Ends of the intervals, ascending [T].
    count : int
        Number of quantities.

    Attributes
    ----------
    low, high : ndarray, shape (count, n_intervals)
        Infinite if there are no values.
    """

    def __init__(self, bounds: Array, count: int) -> None:
        self.bounds = bounds
        shape = count, max(len(bounds) - 1, 0)
        self.low, self.high = np.full(shape, np.inf), np.full(shape, -np.inf)

    def blank(self) -> IntervalExtremes:
        """Return empty extremes of the same quantities and intervals."""
        return IntervalExtremes(self.bounds, len(self.low))

    def widen(self, other: IntervalExtremes) -> None:
        """Include the extremes of another instance."""
        np.minimum(self.low, other.low, out=self.low)
        np.maximum(self.high, other.high, out=self.high)

    def take(self, values: Array, t: Array, which: Index | None = None) -> None:
        """Include values of all quantities, or of the quantities `which`, shape (n, n_times), at
        non-decreasing times.  An instant shared by two intervals belongs to both.
        """
        if not self.low.size or not values.size:
            return
        place = np.searchsorted(self.bounds, t, side="right") - 1
        meets = (place > 0) & (t == self.bounds[np.maximum(place, 0)])
        self._take(values, place, which)
        if meets.any():
            self._take(values[:, meets], place[meets] - 1, which)

    def _take(self, values: Array, place: Index, which: Index | None) -> None:
        place = np.clip(place, 0, self.low.shape[1] - 1)
        first = np.flatnonzero(np.append(True, np.diff(place) > 0))
        rows = slice(None) if which is None else which[:, None]
        for best, more in ((self.low, np.minimum), (self.high, np.maximum)):
            best[rows, place[first]] = more(best[rows, place[first]], more.reduceat(values, first, axis=1))

    def take_tops(self, which: Index, sign: Array, top: Array, t: Array) -> None:
        """Include extremes between instants of some quantities, multiplied by `sign`."""
        if not self.low.size:
            return
        place = np.clip(np.searchsorted(self.bounds, t, side="right") - 1, 0, self.low.shape[1] - 1)
        upper, lower = sign > 0.0, sign < 0.0
        np.maximum.at(self.high, (which[upper], place[upper]), top[upper])
        np.minimum.at(self.low, (which[lower], place[lower]), -top[lower])
