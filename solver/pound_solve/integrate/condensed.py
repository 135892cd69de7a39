"""Static condensation of massless DOFs without dashpots, for methods that work on full matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pound_solve.integrate.energy import INPUT
from pound_solve.integrate.protocol import (
    Course,
    LawValues,
    MonitoredOutputs,
    Motion,
    Problem,
    Recorder,
    Stop,
    rigid_contact,
    without_steps,
)
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.condensation import Condensed, condense
from pound_solve.structure.reduction import ReducedSystem

MAX_UNKNOWNS = 4000  #: unknowns of one run: a full matrix of this size takes 128 MB


class ExpandingRecorder:
    """A recorder that passes on samples with all unknowns, the condensed ones included."""

    def __init__(self, recorder: Recorder, condensed: Condensed) -> None:
        self.recorder, self.condensed = recorder, condensed
        self._input_at_start = condensed.put_in(np.zeros(1))

    def _expanded(self, t: Array, *motion: Array, before: bool = False) -> list[Array]:
        """Return the displacements of all unknowns and their derivatives in order, shape (n, n_times) each;
        `before` or after the inputs jump.
        """
        inputs = self.condensed.system.excitation
        s = [inputs.values(t, i, before) if before else inputs.values_after(t, i) for i in range(3)]
        return [self.condensed.all(x, s[order].T, order) for order, x in enumerate(motion)]

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        u, v, a = self._expanded(t, u, v, a, before=True)
        if not self.condensed.system.total:  # the total form counts the work on all DOFs
            works = works.copy()
            works[INPUT] += self.condensed.put_in(t, before=True) - self._input_at_start
        self.recorder.sample(t, u, v, a, laws, works)

    @property
    def enveloped_unknowns(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return np.asarray(self.condensed.expand[self.recorder.enveloped_unknowns].any(axis=0))

    @property
    def enveloped_laws(self) -> Index:
        """Laws whose forces `between` needs (see `Recorder`)."""
        return self.recorder.enveloped_laws

    def between(self, course: Course) -> None:
        """Take the motion between samples (see `Recorder`)."""

        def whole(x: Motion) -> Motion:
            u, v, a = self._expanded(x.t, x.u, x.v, x.a)
            return Motion(x.t, u, v, a, x.law_forces)

        inner = course.within
        within = None if inner is None else lambda cells, shares: whole(inner(cells, shares))
        self.recorder.between(Course(whole(course.motion), course.lengths, within))

    def report_progress(self, t: float, doing: str = "") -> None:
        """Pass on the progress."""
        self.recorder.report_progress(t, doing)


def others(system: ReducedSystem) -> str:
    """Return which methods accept so many unknowns."""
    steps = ["NEWMARK"] if rigid_contact(system) is None else []
    able = [method for method in without_steps(system) if method != "EXACT"] + steps
    if not able:
        return "no other method takes the rigid contacts; give them a LAW with a stiffness"
    return f"METHOD={' or '.join([*able, 'AUTO'])} takes them"


def condensed(problem: Problem[Recorder], method: str) -> Problem[Recorder]:
    """Return the problem for a method that works on full matrices, with massless DOFs without dashpots
    condensed.

    Raises
    ------
    Stop
        There are more unknowns than `MAX_UNKNOWNS`.
    """
    system, start, monitored = problem.system, problem.start, problem.monitored
    if system.size > MAX_UNKNOWNS:
        why = f"{method} works on full matrices, and {system.size} unknowns are too many for them"
        raise Stop("A505", problem.begin, f"{why} ({MAX_UNKNOWNS} at most): {others(system)}")
    small = condense(system)
    return Problem(
        small.system,
        replace(start, u=start.u[small.keep], v=start.v[small.keep]),
        MonitoredOutputs(
            monitored.names,
            monitored.rows @ small.expand,
            monitored.input_rows + monitored.rows @ small.follow,
            monitored.constants + monitored.rows @ small.constant,
        ),
        problem.recorder if len(small.keep) == system.size else ExpandingRecorder(problem.recorder, small),
    )
