"""The run of EXACT whose derivatives are taken: its pieces between events, and its events."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from pound_solve.integrate.closed_form.dense_output import DenseOutput
from pound_solve.integrate.closed_form.exact import Exact
from pound_solve.integrate.closed_form.grid_samples import GridSamples
from pound_solve.integrate.closed_form.windows import Window
from pound_solve.integrate.events.functions import GridEvent
from pound_solve.laws.automaton import State
from pound_solve.numerics.types import Array


class SmoothPiece(NamedTuple):
    """A smooth part of the motion.

    Attributes
    ----------
    begin : float
        Time of its start [T].
    dense : DenseOutput
        Its motion.
    lengths : ndarray, shape (n,)
        Of its intervals; the last one ends at the event, if any [T].
    """

    begin: float
    dense: DenseOutput
    lengths: Array

    @property
    def end(self) -> float:
        """Time of its end [T]."""
        return self.begin + float(self.dense.edges[len(self.lengths) - 1] + self.lengths[-1])


class BranchChange(NamedTuple):
    """A change of branch.

    Attributes
    ----------
    t : float
        Time [T].
    law, event : int
        Index of the law and of its event function.
    d, v : float
        Deformation and rate of the law.
    before, after : State
        Of the law.
    """

    t: float
    law: int
    event: int
    d: float
    v: float
    before: State
    after: State


class Trajectory(Exact):
    """A run of EXACT that remembers its course.

    Attributes
    ----------
    course : list of SmoothPiece or BranchChange
    released : bool
        Whether massless joints have jumped where a law lost its force.
    """

    def __init__(self, problem: Any) -> None:
        super().__init__(problem, {})
        self.course: list[SmoothPiece | BranchChange] = []
        self.released = False

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Move a law to its next branch, and remember it."""
        before = self.states[law]
        super().transition(law, event_index, d, v)
        self.course.append(BranchChange(self.t, law, event_index, d, v, before, self.states[law]))

    def add_release_work(self, law: int, lost: float, put_in: float) -> None:
        """Add the works of a release, and remember that there was one."""
        self.released = True
        super().add_release_work(law, lost, put_in)

    def _accept_window(self, window: Window, dense: DenseOutput, cursor: int) -> int:
        self.course.append(SmoothPiece(self.t, dense.kept(), dense.lengths))
        return super()._accept_window(window, dense, cursor)

    def _accept_event(
        self, window: Window, dense: DenseOutput, grid_event: GridEvent, end: GridSamples, cursor: int
    ) -> int:
        interval, local = dense.locate(grid_event.event.time)
        lengths = np.append(dense.lengths[:interval], local)
        self.course.append(SmoothPiece(self.t, dense.kept(), lengths))
        return super()._accept_event(window, dense, grid_event, end, cursor)
