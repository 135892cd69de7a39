"""Samples of EXACT on their way to the recorder: output samples, whose works are integrated later, and the
motion between them, for envelopes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from pound_solve.integrate.closed_form.dense_output import DenseOutput, Kinematics
from pound_solve.integrate.closed_form.subsystems import Subsystems
from pound_solve.integrate.energy import law_values
from pound_solve.integrate.events import grid
from pound_solve.integrate.protocol import LawValues, Recorder
from pound_solve.integrate.rigid.contacts import RigidContacts, linear_forces
from pound_solve.laws.automaton import Branch, State
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.reduction import ReducedSystem

MAX_WAITING = 2**19  #: displacements between the samples that wait for the recorder
STEPS = 4  #: fine steps from one instant of the envelopes to the next
BEYOND = 1e-6  #: share of its range by which a stationary displacement must exceed it to be recorded


def forces_of(
    system: ReducedSystem, rigid: RigidContacts, chosen: Index, branches: Sequence[Branch], t: Array,
    motion: Kinematics,
) -> Array:  # fmt: skip
    """Forces of the `chosen` laws on their present branches, all dashpots included, (n_chosen, n_times)."""
    u, v, _ = motion
    s = np.stack([system.excitation.values_after(t, order).T for order in range(3)])
    d = system.law_rows[chosen] @ u + system.law_inputs[chosen] @ s[0]
    rate = system.law_rows[chosen] @ v + system.law_inputs[chosen] @ s[1]
    out = linear_forces([branches[i] for i in chosen])(d, rate)
    held = np.array([branches[i].held for i in rigid.laws], bool)
    if held.any():
        held &= np.isin(rigid.laws, chosen)
        of_rigid = rigid.forces(held, linear_forces(branches), u, v, s)
        out[np.searchsorted(chosen, np.array(rigid.laws)[held])] = of_rigid[held]
    return out


class DeferredSamples:
    """Output samples that wait until their works are known."""

    def __init__(self, system: ReducedSystem, rigid: RigidContacts, recorder: Recorder) -> None:
        self.system, self.rigid, self.recorder = system, rigid, recorder
        self._waiting: list[tuple[Any, ...]] = []

    def add(
        self,
        t: Array,
        motion: Kinematics,
        entries: Index,
        states: Sequence[State],
        branches: Sequence[Branch],
    ) -> None:
        """Keep samples at times (n_times,), with the entries of `DeferredWork` at which they stand."""
        u, v, a = motion
        laws = law_values(self.system, t, u, v, states)
        held = np.array([branches[i].held for i in self.rigid.laws], bool)
        if held.any():
            inputs = self.system.excitation
            s = np.stack([inputs.values(t, order, before=True).T for order in range(3)])
            laws.force[self.rigid.laws] = self.rigid.forces(held, linear_forces(branches), u, v, s)
        self._waiting.append((t, u, v, a, laws, entries))

    def release(self, works: Array) -> None:
        """Pass the samples to the recorder, with works of shape (n_entries + 1, 3)."""
        if self._waiting:
            times, *motion, laws, entries = zip(*self._waiting)
            u, v, a = (np.concatenate(x, axis=1) for x in motion)
            by_law = LawValues(*(np.concatenate(x, axis=1) for x in zip(*laws)))
            at = np.concatenate(entries)
            self.recorder.sample(np.concatenate(times), u, v, a, by_law, works[at].T)

    def clear(self) -> None:
        """Forget the samples that were released."""
        self._waiting.clear()


class EnvelopeSamples:
    """The motion between the output samples, and the stationary points of displacements that exceed their
    range so far.
    """

    def __init__(self, subsystems: Subsystems, u: Array, recorder: Recorder) -> None:
        self.recorder, self.unknowns = recorder, np.flatnonzero(subsystems.enveloped)
        self._range = np.array([u, u])[:, self.unknowns]  # largest and smallest so far
        self._between: list[tuple[Any, ...]] = []
        self._stationary: list[tuple[Array, Array]] = []

    def add(self, dense: DenseOutput, t0: float, h: float, end: float) -> None:
        """Keep the motion of a window from time `t0` on, up to the local time `end`."""
        if not len(self.unknowns):
            return
        tau, motion = dense.enveloped_grid(STEPS * h, end)
        longest = float(np.diff(tau, append=end).max(initial=0.0))
        rigid, t = dense.subsystems.rigid, t0 + tau
        law_forces = forces_of(
            dense.subsystems.system, rigid, self.recorder.acting, dense.branches, t, motion
        )
        self._between.append((t, *motion, law_forces, longest))
        self._add_stationary(dense, t0, tau, motion, end)
        if sum(x[1].size for x in (*self._between, *self._stationary)) > MAX_WAITING:
            self.release()

    def _add_stationary(
        self, dense: DenseOutput, t0: float, tau: Array, motion: Kinematics, end: float
    ) -> None:
        """Keep the displacements at the instants at which one of them is stationary beyond its range so
        far: of each the highest and the lowest, from the cubic from one point to the next and a step of
        Newton's method on the motion itself.
        """
        last, (u, v, _) = dense.motion(*dense.locate(end)), motion
        x, rate = (np.column_stack([y[self.unknowns], z[self.unknowns]]) for y, z in zip((u, v), last))
        self._widen(x)
        row, at = np.nonzero(rate[:, :-1] * rate[:, 1:] < 0.0)
        length = np.diff(tau, append=end)[at]
        begin, finish = rate[row, at] * length, rate[row, at + 1] * length
        s, value = grid.cubic_extreme(x[row, at], x[row, at + 1], begin, finish)
        margin = BEYOND * (self._range[0] - self._range[1])
        best = np.array([self._range[0] + margin, margin - self._range[1]])
        for sign, most in zip((1.0, -1.0), best):
            np.maximum.at(most, row, sign * value)
        chosen = np.flatnonzero((value == best[0][row]) | (-value == best[1][row]))
        if not len(chosen):
            return
        times, dof = (tau[at] + s * length)[chosen], self.unknowns[row[chosen]]
        _, v, a = (y[dof, np.arange(len(chosen))] for y in dense.enveloped_motions(times))
        times -= np.divide(v, a, out=np.zeros_like(v), where=np.abs(v) < 0.1 * np.abs(a) * length[chosen])
        times = np.unique(np.clip(times, 0.0, end))
        u = dense.enveloped_motions(times)[0]
        self._widen(u[self.unknowns])
        self._stationary.append((t0 + times, u))

    def _widen(self, x: Array) -> None:
        """Count displacements, shape (n_unknowns, n_times), into their range."""
        self._range[0] = np.maximum(self._range[0], x.max(axis=1))
        self._range[1] = np.minimum(self._range[1], x.min(axis=1))

    def release(self) -> None:
        """Pass all that waits to the recorder."""
        if self._between:
            *motion, longest = zip(*self._between)
            t, u, v, a, law_forces = (np.concatenate(x, axis=-1) for x in motion)
            self.recorder.between(t, u, v, a, law_forces, max(longest))
            self._between.clear()
        if self._stationary:
            t, u = (np.concatenate(x, axis=-1) for x in zip(*self._stationary))
            self.recorder.stationary(t, u)
            self._stationary.clear()
