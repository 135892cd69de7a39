"""Samples that EXACT passes to the recorder: output samples, whose works are integrated later, and the
motion between them, for envelopes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from pound_solve.integrate.closed_form.dense_output import DenseOutput, Kinematics
from pound_solve.integrate.closed_form.subsystems import Subsystems
from pound_solve.integrate.energy import law_values
from pound_solve.integrate.protocol import Course, LawValues, Motion, Recorder
from pound_solve.integrate.rigid.contacts import RigidContacts, linear_forces
from pound_solve.laws.automaton import Branch, State
from pound_solve.numerics.types import Array, Index
from pound_solve.structure.reduction import ReducedSystem

MAX_WAITING = 2**19  #: largest number of stored displacements between samples before they are passed on
FINE_STEPS = 2  #: number of fine steps between instants of the envelopes


def forces_of(
    system: ReducedSystem, rigid: RigidContacts, chosen: Index, branches: Sequence[Branch], t: Array,
    motion: Kinematics,
) -> Array:  # fmt: skip
    """Return the forces of the `chosen` laws on their branches, including dashpots, (n_chosen, n_times)."""
    u, v, _ = motion
    s = np.stack([system.excitation.values_after(t, order).T for order in range(3)])
    d = system.law_rows[chosen] @ u + system.law_inputs[chosen] @ s[0]
    rate = system.law_rows[chosen] @ v + system.law_inputs[chosen] @ s[1]
    forces = linear_forces([branches[i] for i in chosen])(d, rate)
    constrained = np.array([branches[i].constrains for i in rigid.laws], bool)
    if constrained.any():
        constrained &= np.isin(rigid.laws, chosen)
        of_rigid = rigid.forces(constrained, linear_forces(branches), u, v, s)
        forces[np.searchsorted(chosen, np.array(rigid.laws)[constrained])] = of_rigid[constrained]
    return forces


class DeferredSamples:
    """Output samples, buffered until their works are known."""

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
        """Buffer samples at times (n_times,), with the corresponding entries of `DeferredWork`."""
        u, v, a = motion
        laws = law_values(self.system, t, u, v, states)
        constrained = np.array([branches[i].constrains for i in self.rigid.laws], bool)
        if constrained.any():
            inputs = self.system.excitation
            s = np.stack([inputs.values(t, order, before=True).T for order in range(3)])
            laws.force[self.rigid.laws] = self.rigid.forces(constrained, linear_forces(branches), u, v, s)
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
        """Discard the samples that were released."""
        self._waiting.clear()


class KeptWindow(NamedTuple):
    """A buffered window: index of its first instant, local times of its instants, and its start and end."""

    dense: DenseOutput
    tau: Array
    begin: float
    end: float


class EnvelopeSamples:
    """The motion between the output samples."""

    def __init__(self, subsystems: Subsystems, recorder: Recorder) -> None:
        self.recorder, self.is_needed = recorder, bool(subsystems.enveloped.any())
        self._windows: list[KeptWindow] = []
        self._motions: list[Motion] = []

    def add(self, dense: DenseOutput, t0: float, h: float, end: float) -> None:
        """Buffer the motion of a window from time `t0` on, up to the local time `end`."""
        if not self.is_needed:
            return
        tau, motion = dense.enveloped_grid(FINE_STEPS * h, end)
        self._windows.append(KeptWindow(dense.kept(), tau, t0, end))
        self._motions.append(self._motion(dense, t0 + tau, motion))
        if sum(x.u.size for x in self._motions) > MAX_WAITING:
            self.release()

    def _motion(self, dense: DenseOutput, t: Array, motion: Kinematics) -> Motion:
        """Return the motion of a window at some times, with the forces of the laws."""
        system, rigid = dense.subsystems.system, dense.subsystems.rigid
        laws = self.recorder.enveloped_laws
        return Motion(t, *motion, forces_of(system, rigid, laws, dense.branches, t, motion))

    def release(self) -> None:
        """Pass the buffered motion to the recorder."""
        if not self._windows:
            return
        windows, motions = self._windows, self._motions
        self._windows, self._motions = [], []
        lengths = [np.diff(w.tau, append=w.end) for w in windows]
        first = np.cumsum([0, *map(len, lengths)])

        def within(cells: Index, shares: Array) -> Motion:
            window = np.searchsorted(first, cells, "right") - 1
            parts = []
            for i in np.unique(window).tolist():
                w, at = windows[i], cells[window == i] - first[i]
                tau = (w.tau[at, None] + lengths[i][at, None] * shares).ravel()
                parts.append(self._motion(w.dense, w.begin + tau, w.dense.enveloped_motions(tau)))
            return joined(parts)

        self.recorder.between(Course(joined(motions), np.concatenate(lengths), within))


def joined(motions: Sequence[Motion]) -> Motion:
    """Concatenate several motions into one motion at all their instants."""
    return Motion(*(np.concatenate(x, axis=-1) for x in zip(*motions)))
