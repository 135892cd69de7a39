"""Scenes without massless DOFs that follow the others, for methods that work on full matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pound_solve.integrate.protocol import LawValues, MonitoredOutputs, Recorder, Start, Stop
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.condensation import Condensed, condense
from pound_solve.structure.reduction import ReducedSystem

MOST_UNKNOWNS = 4000  #: of one run: a full matrix of as many takes 128 MB


class Whole:
    """Hands samples on with all unknowns, condensed ones too."""

    def __init__(self, recorder: Recorder, small: Condensed) -> None:
        self.recorder, self.small, self.at_start = recorder, small, small.put_in(np.zeros(1))

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.base.HistoryRecorder`)."""
        ex = self.small.system.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        if not self.small.system.total:  # the total form counts the work on all DOFs
            works = works.copy()
            works[0] += self.small.put_in(t) - self.at_start
        self.recorder.sample(t, u, v, a, laws, works)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` looks at (see `integrate.base.HistoryRecorder`)."""
        return np.asarray(self.small.expand[self.recorder.shown].any(axis=0))

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion between samples (see `integrate.base.HistoryRecorder`)."""
        ex = self.small.system.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        self.recorder.between(t, u, v, a, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Take displacements that turn (see `integrate.base.HistoryRecorder`)."""
        self.recorder.stationary(t, self.small.all(u, self.small.system.excitation.values(t).T))

    def trial(self, t: float, doing: str = "") -> None:
        """Pass it on."""
        self.recorder.trial(t, doing)


def condensed(
    system: ReducedSystem, start: Start, monitored: MonitoredOutputs, recorder: Recorder, method: str
) -> tuple[ReducedSystem, Start, MonitoredOutputs, Recorder]:
    """What a method is given that works on full matrices: no massless DOFs that follow the others.

    Raises
    ------
    Stop
        There are more unknowns than `MOST_UNKNOWNS`.
    """
    if system.size > MOST_UNKNOWNS:
        why = f"{method} works on full matrices, and {system.size} unknowns are too many for them"
        raise Stop("A505", float(start.times[0]), f"{why} ({MOST_UNKNOWNS} at most): NEWMARK takes them")
    small = condense(system)
    return (
        small.system,
        replace(start, u=start.u[small.keep], v=start.v[small.keep]),
        MonitoredOutputs(
            monitored.names,
            monitored.rows @ small.expand,
            monitored.input_rows + monitored.rows @ small.follow,
            monitored.constants + monitored.rows @ small.constant,
        ),
        recorder if len(small.keep) == system.size else Whole(recorder, small),
    )
