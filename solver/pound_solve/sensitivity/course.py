"""The course of a run, its pieces and changes in order, and the places of instants in it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pound_solve.sensitivity.trajectory import BranchChange, SmoothPiece

SAME_TIME = 1e-12  #: fraction of the time up to which two instants are one


class Instant(NamedTuple):
    """Place of an instant: a part of the course, and for a piece the interval and the time since its
    start.  The part is the first change at the instant of an event.
    """

    part: int
    interval: int = 0
    tau: float = 0.0


class RunCourse:
    """The course of a run.

    Parameters
    ----------
    parts : sequence of SmoothPiece or BranchChange
    """

    def __init__(self, parts: Sequence[SmoothPiece | BranchChange]) -> None:
        self.parts = parts
        self._pieces = [i for i, part in enumerate(parts) if isinstance(part, SmoothPiece)]
        self._changes = [i for i, part in enumerate(parts) if isinstance(part, BranchChange)]
        self._begins = np.array([parts[i].begin for i in self._pieces])  # type: ignore[union-attr]
        self._events = np.array([parts[i].t for i in self._changes])  # type: ignore[union-attr]

    @property
    def sequence(self) -> tuple[tuple[int, int], ...]:
        """Return the law and the event function of all changes in order."""
        return tuple((part.law, part.event) for part in self.parts if isinstance(part, BranchChange))

    def place(self, t: float) -> Instant:
        """Return the place of an instant."""
        rounding = SAME_TIME * max(1.0, abs(t))
        first = int(np.searchsorted(self._events, t - rounding))
        if first < len(self._events) and self._events[first] <= t + rounding:
            return Instant(self._changes[first])
        part = self._pieces[max(int(np.searchsorted(self._begins, t, side="right")) - 1, 0)]
        piece = self.parts[part]
        assert isinstance(piece, SmoothPiece)
        local = t - piece.begin
        edges = piece.dense.edges[: len(piece.lengths)]
        interval = max(int(np.searchsorted(edges, local - rounding, side="right")) - 1, 0)
        tau = min(max(local - float(edges[interval]), 0.0), float(piece.lengths[interval]))
        return Instant(part, interval, tau)
