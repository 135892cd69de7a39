"""The base class of the methods with a closed form between events: branches of the laws, response tracker,
and stop conditions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np

from pound_solve.integrate.energy import EnergyAccumulator
from pound_solve.integrate.events.functions import RowSet
from pound_solve.integrate.protocol import (
    CHATTER_TEXT,
    MAX_CHANGES,
    MAX_CHANGES_PER_LAW,
    RUNAWAY_TEXT,
    Outcome,
    Problem,
    Recorder,
    Stop,
    laws_on_massless,
)
from pound_solve.integrate.release import force_jumps, release
from pound_solve.integrate.tolerances import NEAR_EVENT
from pound_solve.integrate.tracker import ResponseTracker
from pound_solve.integrate.uniqueness import Uniqueness
from pound_solve.laws.automaton import Branch, State
from pound_solve.numerics.types import Array


def is_slack(branch: Branch) -> bool:
    """Return whether a law has neither stiffness nor force on a branch."""
    return branch.stiffness == branch.force0 == 0.0


class EventDrivenRun(ABC):
    """A run from event to event; the base class of EXACT and LAPLACE.

    Attributes
    ----------
    t, u, v
        Present time, displacement and velocity.
    states : list of State
    branches : list of Branch
        Of all laws at the present time.
    rows : RowSet
        Deformations of the laws, followed by the drifts.
    largest : ndarray, shape (2, n_rows)
        Largest magnitudes of the rows and their rates so far: the scale of the event functions.
    contacts : list of int
        Laws that are contacts.
    tracker : ResponseTracker
    energy : EnergyAccumulator
    """

    def __init__(self, problem: Problem[Recorder]) -> None:
        system, start, monitored = problem.system, problem.start, problem.monitored
        self.system, self.recorder, self.times = system, problem.recorder, start.times
        self.laws = system.structure.laws
        self.states = list(start.states)
        self.branches: list[Branch] = [s.branch(x) for s, x in zip(self.laws, self.states)]
        self.rows = RowSet(
            np.vstack([system.law_rows, monitored.rows]),
            np.vstack([system.law_inputs, monitored.input_rows]),
            np.concatenate([np.zeros(len(self.laws)), monitored.constants]),
        )
        self.largest = np.zeros((2, len(self.rows.rows)))
        self.tracker = ResponseTracker(self.laws, len(monitored.names))
        self.energy = EnergyAccumulator(system, start)
        self.t, self.u, self.v = float(start.times[0]), start.u.copy(), start.v.copy()
        self.events = self.changes_at_instant = 0
        self._on_massless = laws_on_massless(system)
        self.contacts = [i for i, s in enumerate(self.laws) if s.role.collides]
        self.uniqueness = Uniqueness(system)

    def transition(self, law: int, event_index: int, d: float, v: float) -> None:
        """Move a law to its next branch at deformation `d` and rate `v`."""
        before = self.branches[law].kind
        self.states[law] = self.laws[law].law.transition(self.states[law], event_index, d, v)
        after = self.branches[law] = self.laws[law].branch(self.states[law])
        self.uniqueness.record_change(self.t, law, self.states[law][0])
        force = self.laws[law].force(self.states[law], d, 0.0 if self._on_massless[law] else v)
        self.tracker.switched(law, before, after.kind, self.t, d, v, force)
        self.tracker.force(law).take(force, self.t)

    def change(self, law: int, event_index: int, d: Array, v: Array) -> None:
        """Move a law to its next branch, record which other laws reach the ends of their branches at the
        same instant, and release massless joints if it loses its force; `d` and `v` are those of all laws.
        """
        law, event_index = self._before_slack(law, event_index, d, v)
        self._look_for_rests(law, event_index, d, v)
        before, deformation = self.branches[law], float(d[law])
        self.transition(law, event_index, deformation, float(v[law]))
        lost_force = self._on_massless[law] and force_jumps(before, self.branches[law], deformation)
        if lost_force or self.branches[law].stiffness < before.stiffness:
            self._look_for_ties(law, d, v, lost_force)
        if lost_force:
            release(self, law)

    def force(self, law: int, d: float) -> tuple[float, float]:
        """Return the force of a law at rest at deformation `d`, and its tangent."""
        return self.laws[law].law.force(self.states[law], d)[:2]

    def add_release_work(self, law: int, lost: float, put_in: float) -> None:
        """Add the energy `lost` by a falling force to the work done on its law, and the work `put_in` by
        loads to the input.
        """
        at, d, work, m = self.states[law]
        self.states[law] = at, d, work + lost, m
        self.add_works(np.array([put_in, 0.0, 0.0]))

    def add_works(self, works: Array) -> None:
        """Add works done at one instant, shape (3,)."""
        before = self.energy.array()
        self.energy.advance(np.array([before, before + works]))

    def _arriving(self, law: int, d: Array, v: Array) -> Iterator[tuple[int, int, State, Branch]]:
        """Yield other laws at massless unknowns whose events occur now: the law, the event, and the state
        and branch after it.
        """
        from pound_solve.integrate.kernels.ties import event_arrives  # most decks do not need this import

        for i in np.flatnonzero(self._on_massless).tolist():
            if i == law or self.laws[i].role.collides:
                continue
            deformation, rate = float(d[i]), float(v[i])
            for n, e in enumerate(self.branches[i].events):
                if event_arrives(*e, deformation, rate, float(self.largest[0, i])):
                    state = self.laws[i].law.transition(self.states[i], n, deformation, rate)
                    yield i, n, state, self.laws[i].branch(state)
                    break

    def _before_slack(self, law: int, event_index: int, d: Array, v: Array) -> tuple[int, int]:
        """Return the law and event to process first if this event makes its law slack (see `kernels.ties`),
        otherwise this law and event.
        """
        before, deformation = self.branches[law], float(d[law])
        if self.laws[law].role.collides or not self._on_massless[law] or before.stiffness == 0.0:
            return law, event_index
        state = self.laws[law].law.transition(self.states[law], event_index, deformation, float(v[law]))
        after = self.laws[law].branch(state)
        if is_slack(after) and not force_jumps(before, after, deformation):
            for i, n, _, its in self._arriving(law, d, v):
                if not is_slack(its):
                    return i, n
        return law, event_index

    def _look_for_rests(self, law: int, event_index: int, d: Array, v: Array) -> None:
        """Record the laws that rest at the start of a branch when `law` reverses (see
        `kernels.ties.note_rests`).
        """
        event = self.branches[law].events[event_index]
        turns = event.on_d == 0.0 and event.on_v != 0.0
        if not turns or self.laws[law].role.collides or not self._on_massless[law]:
            return
        for i in np.flatnonzero(self._on_massless).tolist():
            if not self.laws[i].role.collides:
                branch = self._branch_begun(i, float(d[i]), float(v[i]), i == law)
                if branch >= 0:
                    self.uniqueness.record_rest(self.t, law, i, branch)

    def _branch_begun(self, law: int, d: float, v: float, turns: bool) -> int:
        """Return the branch at whose start the law is, while it reverses (`turns`) or rests; -1 if none."""
        from pound_solve.integrate.kernels.ties import STATIONARY_RATE, event_near  # as above

        state, largest = self.states[law], self.largest[:, law].tolist()
        entered = abs(d - state[1]) <= NEAR_EVENT * largest[0]
        if not turns and (entered or abs(v) > STATIONARY_RATE * largest[1]):
            return -1
        for n, e in enumerate(self.branches[law].events):
            if event_near(*e, d, largest[0]):
                return self.laws[law].law.transition(state, n, d, v)[0]
        return state[0] if entered else -1

    def _look_for_ties(self, law: int, d: Array, v: Array, lost_force: bool) -> None:
        """Record which laws reach the ends of their branches together with a law that has become softer or
        has lost its force.
        """
        k, c = (np.array([getattr(b, name) for b in self.branches]) for name in ("stiffness", "damping"))
        rising = np.where(np.arange(len(k)) == law, v[: len(k)], 0.0)
        if self.laws[law].role.collides or not self._on_massless[law]:
            return
        for i, _, state, after in self._arriving(law, d, v):
            if lost_force and force_jumps(self.branches[i], after, float(d[i])):
                k[i], c[i], rising[i] = -np.inf, state[0], float(v[i])
            elif not lost_force and after.stiffness < k[i]:
                k[i], rising[i] = after.stiffness, float(v[i])
        if np.count_nonzero(rising) > 1:
            self.uniqueness.examine_tie(self.t, k, c, rising)

    def count_change(self, elapsed: float, rounding: float) -> None:
        """Count the changes of branch at one instant; an `elapsed` time up to the fraction `rounding` of
        the time counts as zero.
        """
        same = elapsed <= rounding * max(1.0, self.t)
        self.changes_at_instant = self.changes_at_instant + 1 if same else 0

    def stop_chatter(self, law: int, remedy: str) -> None:
        """Stop if too many changes of branch occur at one instant."""
        if self.changes_at_instant > MAX_CHANGES + MAX_CHANGES_PER_LAW * len(self.laws):
            s, count = self.laws[law], self.changes_at_instant
            why = CHATTER_TEXT.format(count, s.element, s.rule, self.branches[law].name, remedy)
            raise self.stop("A503", why)

    def stop_growth(self, v: Array, hint: str = "") -> None:
        """Stop if the kinetic energy at velocity `v` is far above the energy input."""
        if self.runs_away(v):
            raise self.stop("A504", RUNAWAY_TEXT.format(self.kinetic(v)) + hint)

    def runs_away(self, v: Array) -> bool:
        """Return whether the kinetic energy at velocity `v` is far above the known energy input."""
        return self.energy.runs_away(self.kinetic(v))

    def kinetic(self, v: Array) -> float:
        """Return the kinetic energy at velocity `v` [F L]."""
        return 0.5 * float(v @ self.system.mass @ v)

    def reaching(self, u: Array) -> Array:
        """Return the largest magnitudes of the rows and their rates; for contacts, at least the
        displacements of the two bodies at `u`.  The rounding error of a contact deformation is a fraction
        of these displacements, and for bodies that move alike the deformation is only rounding error.
        """
        largest = self.largest.copy()
        far = np.abs(self.rows.rows[self.contacts]) @ np.abs(u)
        largest[0, self.contacts] = np.maximum(largest[0, self.contacts], far)
        return largest

    def count_magnitudes(self, value: Array, rate: Array) -> None:
        """Include values and rates of the first rows, shape (n_rows, n_times), in the largest
        magnitudes.
        """
        n = len(value)
        both = np.abs([value, rate]).max(axis=2)
        self.largest[:, :n] = np.maximum(self.largest[:, :n], both)

    def count_collision_peaks(self) -> None:
        """Include the peak forces of the present collisions in those of their contacts."""
        for law, collision in self.tracker.open.items():
            self.tracker.force(law).take(collision.peak, collision.t_peak)

    @abstractmethod
    def run(self) -> Outcome:
        """Integrate to the last output time."""

    @abstractmethod
    def outcome(self) -> Outcome:
        """Return the results so far."""

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""
        return Stop(code, self.t, why, self.outcome())
