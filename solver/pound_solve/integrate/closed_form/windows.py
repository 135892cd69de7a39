"""Windows of EXACT: the number of intervals of the excitation in one dense output, and the grid step that
resolves the fastest mode.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.integrate.intervals import SAME_LENGTH
from pound_solve.integrate.tolerances import COUNT_ROUNDING
from pound_solve.numerics.types import Array

MAX_POINTS = 4096  #: largest number of points of the fine grid in one window
MAX_INTERVALS = 128  #: largest number of intervals of one window
INTERVALS_AFTER_EVENT = 8  #: number of intervals of the first window after an event
FINE_STEP = 1.0  #: fine step times the fastest eigenvalue


class Window(NamedTuple):
    """Intervals of the next window.

    Attributes
    ----------
    lengths, starts : ndarray, shape (n,)
        All lengths but the first are equal [T].
    h : float
        Step of the fine grid [T], a power of two.
    whole : bool
        Whether the intervals end at goals; an interval with too many steps is integrated in pieces.
    """

    lengths: Array
    starts: Array
    h: float
    whole: bool


class Windows:
    """Chooses the windows of a run.

    Parameters
    ----------
    refinement : int
        Number of halvings of the fine grid.
    """

    def __init__(self, refinement: int) -> None:
        self._grid = FINE_STEP * 2.0**-refinement
        self._usual = 0.0  # length of most intervals
        self.restart()

    def restart(self) -> None:
        """Start again with windows of few intervals, after an event."""
        self._intervals = INTERVALS_AFTER_EVENT

    def narrow(self) -> None:
        """Make the next window end at the next goal."""
        self._intervals = 0

    def widen(self) -> None:
        """Double the number of intervals of the next window, up to a limit, because there was no event."""
        self._intervals = min(max(2 * self._intervals, 1), MAX_INTERVALS)

    def next(self, t: float, goals: Array, spectral_radius: float) -> Window:
        """Return the window from time `t` towards the next `goals`."""
        ends = goals[: self._intervals + 1]
        lengths = np.diff(np.append(t, ends))
        # intervals of equal length share their exponentials, regardless of rounding errors of the times
        close = SAME_LENGTH * lengths + 4.0 * np.spacing(ends)
        if abs(lengths[-1] - self._usual) > close[-1]:
            self._usual = float(f"{lengths[-1]:.12e}")
        lengths = np.where(np.abs(lengths - self._usual) <= close, self._usual, lengths)
        usual = lengths[min(1, len(lengths) - 1)]
        longest = float(max(lengths[0], usual))
        h = self._step(longest, spectral_radius)
        per_interval = int(np.ceil(longest / h * (1 - COUNT_ROUNDING)))
        if per_interval > MAX_POINTS:
            length = float(min(lengths[0], MAX_POINTS * h))
            return Window(np.array([length]), np.array([t]), h, bool(length == lengths[0]))
        most = min(len(lengths), MAX_POINTS // per_interval)
        other = np.flatnonzero(lengths[1:most] != usual)
        count = int(other[0]) + 1 if len(other) else most
        return Window(lengths[:count], np.append(t, ends[: count - 1]), h, True)

    def _step(self, length: float, spectral_radius: float) -> float:
        """Return the step of the fine grid in intervals of a length: a power of two, so that tables can be
        reused.
        """
        h = 2.0 ** np.ceil(np.log2(length / 8))
        if spectral_radius <= 0.0:
            return float(h)
        return float(min(h, 2.0 ** np.floor(np.log2(self._grid / spectral_radius))))
