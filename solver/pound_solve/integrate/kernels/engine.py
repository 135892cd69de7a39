"""The base of the methods that run as compiled kernels: a run allocates its arrays, lets a kernel advance,
and fetches the samples, transitions and peaks that the kernel has stored.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from pound_solve.check import Check
from pound_solve.integrate.energy import EnergyAccumulator
from pound_solve.integrate.kernels import allocation, corotational
from pound_solve.integrate.kernels import laws as law_kernels
from pound_solve.integrate.kernels.state import (
    BUFFERS_FULL,
    CHATTER,
    DONE,
    LOG_AFTER,
    LOG_PEAK,
    LOG_TIME,
    NOT_CONVERGED,
    RUNAWAY,
    SINGULAR,
    TOO_MANY_EVENTS,
    Scheme,
    Simulation,
)
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    RUNAWAY_TEXT,
    Course,
    LawValues,
    Motion,
    Outcome,
    Problem,
    Recorder,
    Stop,
    without_steps,
)
from pound_solve.integrate.tracker import Peaks, ResponseTracker
from pound_solve.integrate.uniqueness import Uniqueness
from pound_solve.laws import functions
from pound_solve.laws.automaton import BranchKind, State
from pound_solve.laws.hysteresis import bilinear
from pound_solve.numerics.jit import Function
from pound_solve.numerics.matrices import MAX_DENSE, dense
from pound_solve.numerics.modes import massless
from pound_solve.numerics.providers import provider


class KernelEngine(ABC):
    """One run of a method.

    Parameters
    ----------
    problem : Problem
    scheme : Scheme
    dt : float
        Longest time step [T].
    name : str
        For the report.
    """

    exact = False  #: whether there is no error but rounding
    keeps_steps = True  #: whether the motion at the ends of steps is kept for the envelopes

    def __init__(self, problem: Problem[Recorder], scheme: Scheme, dt: float, name: str) -> None:
        system, start, recorder = problem.system, problem.start, problem.recorder
        self.system, self.recorder, self.scheme, self.dt, self.name = system, recorder, scheme, dt, name
        self.law_springs, self.times = system.structure.laws, start.times
        self.tracker = ResponseTracker(self.law_springs, len(problem.monitored.names))
        self.accumulator = EnergyAccumulator(system, start)
        rules = list(dict.fromkeys(s.law.rule for s in self.law_springs))
        self.rules = functions.tables(
            rules or [bilinear.RULE]
        )  # never empty: an empty table does not compile
        layout = allocation.layout(system, scheme)
        self.order = layout.order
        self.linear = allocation.linear_system(system, problem.monitored, layout, scheme, dt)
        losses = self.accumulator.dashpot_losses
        self.laws = allocation.law_arrays(system, start, layout, rules, losses, dt)
        self.members = allocation.member_arrays(system, layout, scheme)
        self.step = allocation.step_arrays(system, start, layout, self.linear, self.tracker.extremes)
        self.inverse_order = layout.inverse_order
        unknowns, laws = np.zeros((2, 0), np.int64)
        if self.keeps_steps:
            unknowns = layout.inverse_order[np.flatnonzero(recorder.enveloped_unknowns)]
            laws = recorder.enveloped_laws
        self.buffers = allocation.buffers(system.size, len(self.law_springs), unknowns, laws)
        run = allocation.run_record(float(self.times[0]), self.accumulator.initial)
        works = self.accumulator.works
        self.sim = Simulation(self.linear, self.laws, self.members, self.step, self.buffers, works, run)
        for i in range(len(self.law_springs)):
            law_kernels.enter_branch(self.laws, self.rules, i)
        law_kernels.linearise_laws(self.laws, self.rules)
        corotational.form_members(self.members, self.step)
        corotational.compute_tangents(self.members, self.members.now.quantities)
        self.uniqueness = Uniqueness(system)
        self.motion_norms = np.zeros(2)  # v M v and a M a, summed over the samples
        self.seen = float(self.times[0])  # latest instant that the recorder has received
        self.latest = list[list[float]]()  # transitions that were fetched last

    def run(self) -> Outcome:
        """Integrate to the last output time.

        Raises
        ------
        Stop
            A step has too many changes or no solution, numbers overflow, or the run is interrupted.
        """
        try:
            self.integrate()
        except KeyboardInterrupt:
            raise self.stop("A506", INTERRUPTED) from None
        return self.outcome()

    @abstractmethod
    def integrate(self) -> None:
        """Run the method's kernel to the end."""

    @abstractmethod
    def figures(self) -> dict[str, Any]:
        """Return the figures of the run for the report."""

    @abstractmethod
    def checks(self, peaks: Peaks) -> list[Check]:
        """Return the self-checks of the run."""

    def begin(self, advance: Function) -> None:
        """Record the contacts that are closed at the start, and set the limits of friction.  Call this
        before a kernel runs.
        """
        laws, t = self.laws, float(self.times[0])
        for i, s in enumerate(self.law_springs):
            kind = s.law.rule.branches[laws.state.branch[i]].kind
            if s.role.collides and kind.closed:
                d, v = float(laws.now.deformation[i]), float(laws.now.rate[i])
                force = law_kernels.law_force(laws, self.rules, i, d, v)
                self.tracker.switched(i, BranchKind.OPEN, kind, t, d, v, force)
                laws.collision.peak_force[i] = force
        for i in laws.friction.coupled.tolist():
            law_kernels.couple_friction(laws, self.rules, self.step.now.acceleration, i)
        law_kernels.save_friction_limits(laws)
        if notice := provider().notice(advance):
            self.recorder.report_progress(t, notice)

    def advance(self, kernel: Function, *given: Any) -> None:
        """Run a kernel until it has reached the end, and fetch its results whenever it returns."""
        ready = provider().ready(kernel)
        while True:
            with np.errstate(all="ignore"):  # a runaway is reported in words
                why = ready(self.sim, self.rules, *given)
            self.fetch()
            if why == DONE:
                return
            if why != BUFFERS_FULL:
                self.resume(why)

    def resume(self, why: int) -> None:
        """Handle the reason why a kernel has returned, so that it can continue; stop if it cannot."""
        raise self.trouble(why)

    def fetch(self) -> None:
        """Fetch transitions, the motion between samples, and samples from the buffers."""
        self.fetch_transitions()
        self.fetch_motions()
        self._fetch_samples()
        if not self.sim.run.n_samples:  # a pending signal is handled at each return of a kernel
            self.recorder.report_progress(float(self.sim.run.time))
        self.sim.run.n_samples = self.sim.run.n_motions = 0

    def fetch_transitions(self) -> None:
        """Fetch the transitions from the buffers, and which laws changed at the same instant."""
        for k in range(int(self.sim.run.n_ties)):
            self.uniqueness.examine_tie(float(self.buffers.tie_time[k]), *self.buffers.ties[k])
        for t, law, other, branch in self.buffers.rests[: self.sim.run.n_rests].tolist():
            self.uniqueness.record_rest(t, int(law), int(other), int(branch))
        self.sim.run.n_ties = self.sim.run.n_rests = 0
        self.latest = self.buffers.log[: self.sim.run.n_transitions].tolist()
        for row in self.latest:
            law, before, after = (int(x) for x in row[: LOG_AFTER + 1])
            branches = self.law_springs[law].law.rule.branches
            if law in self.tracker.open:
                self.tracker.open[law].count(*row[LOG_PEAK:])
            self.tracker.switched(law, branches[before].kind, branches[after].kind, *row[LOG_TIME:LOG_PEAK])
            self.uniqueness.record_change(row[LOG_TIME], law, after)
        self.sim.run.n_transitions = 0

    def fetch_motions(self) -> None:
        """Pass the motion between the samples from the buffers to the recorder."""
        buffers, count = self.buffers, self.sim.run.n_motions
        if not count:
            return
        # at the end of a step a load has not jumped yet
        times = self.system.excitation.before_jumps(buffers.motion_time[:count])
        u, v, a = motion = np.zeros((3, len(self.order), count))
        motion[:, self.order[buffers.enveloped_unknowns]] = buffers.motion[:count].transpose(1, 2, 0)
        law_forces = buffers.law_forces[:count].T.copy()
        lengths = np.diff(times, prepend=self.seen)
        self.seen = float(times[-1])
        self.recorder.between(Course(Motion(times, u, v, a, law_forces), lengths, None))

    def _fetch_samples(self) -> None:
        buffers, kept, back = self.buffers, self.sim.run.n_samples, self.inverse_order
        if not kept:
            return
        motions = buffers.displacement, buffers.velocity, buffers.acceleration
        u, v, a = (np.ascontiguousarray(x[:kept, back].T) for x in motions)
        mass = self.system.mass
        self.motion_norms += (v * (mass @ v)).sum(), (a * (mass @ a)).sum()
        of_laws = buffers.force, buffers.stored, buffers.lost, buffers.dashpot
        values = LawValues(*(x[:kept].T.copy() for x in of_laws))
        self.recorder.sample(buffers.time[:kept].copy(), u, v, a, values, buffers.works[:kept].T.copy())

    def trouble(self, why: int) -> Stop:
        """Return the `Stop` that explains why a kernel has returned early."""
        if why == RUNAWAY:
            fastest = int(self.order[np.argmax(np.abs(self.step.now.velocity))])
            name = self.system.name(fastest)
            cause = f", fastest at {name}: the structure collapses, or DT={self.dt:g} is too long"
            return self.stop("A504", RUNAWAY_TEXT.format(self.sim.run.runaway_energy) + cause)
        if why == SINGULAR:
            unknown = int(self.order[int(self.sim.run.failed_unknown)])
            return self.stop("A501", self.system.explain_massless(unknown))
        if why == CHATTER and (snaps := self._without_branch(int(self.sim.run.changed_law))) is not None:
            return self.stop("A501", self.system.explain_massless(snaps, softens=True))
        law = int(self.sim.run.failed_law if why == NOT_CONVERGED else self.sim.run.changed_law)
        place, last = "the members' turning", ""
        if law >= 0:
            s = self.law_springs[law]
            place = f"element {s.element} ({s.rule})"
            last = f"the last in {place} to {s.law.rule.branches[self.laws.state.branch[law]].name!r}"
        if why == CHATTER:
            text = f"laws change branch again and again at one instant, {last}"
        elif why == TOO_MANY_EVENTS:
            most = len(self.buffers.log) // 2
            text = f"laws change branch more than {most} times within one step, {last}"
        else:
            text = f"Newton's iterations find no equilibrium of {place}, however short the step"
        others = "".join(f", or METHOD={method}" for method in without_steps(self.system))
        return self.stop("A503", f"{text}; try a DT well below {self.dt:g}{others}")

    def _without_branch(self, law: int) -> int | None:
        """Return a massless unknown that `law` holds on none of its branches, None if there is none.

        At one instant its rate then has one sign on the softening branch, and the opposite sign on the
        branches to which a rate of that sign leads.
        """
        rows, has_mass = self.laws.definition.rows, self.linear.has_mass
        unknowns = rows.columns[rows.pointers[law] : rows.pointers[law + 1]]
        massless = unknowns[~np.asarray(has_mass, bool)[unknowns]]
        rates = [row[5] for row in self.latest if row[0] == law and row[3] == self.sim.run.time]
        turns = min(rates, default=0.0) < 0.0 < max(rates, default=0.0)
        return int(self.order[massless[0]]) if turns and len(massless) and self._softens() else None

    def _softens(self) -> bool:
        """Return whether the stiffness of the massless unknowns is not positive if all laws that change
        at this instant are on their softest branches.
        """
        massless_unknowns = np.flatnonzero(massless(self.system.mass))
        if self.system.structure.corotational or len(massless_unknowns) > MAX_DENSE:
            return True  # an examination takes too long
        stiffness = self.laws.tangent.stiffness.copy()
        changes = {tuple(map(int, row[:3])) for row in self.latest if row[3] == self.sim.run.time}
        for i in {change[0] for change in changes}:
            law, states = self.law_springs[i].law, [self.law_state(i)]
            d = float(self.laws.now.deformation[i])
            for state in states:  # the list grows by the states that follow
                after = [law.transition(state, n, d) for n in range(len(law.branch(state).events))]
                seen = {other[0] for other in states}
                states += [x for x in after if (i, state[0], x[0]) in changes and x[0] not in seen]
            if not law.curved:
                stiffness[i] = min(law.branch(state).stiffness for state in states)
        rows = dense(self.system.law_rows[:, massless_unknowns])
        elastic = dense(self.system.stiffness[np.ix_(massless_unknowns, massless_unknowns)])
        return bool(np.linalg.eigvalsh(elastic + (rows.T * stiffness) @ rows)[0] <= 0.0)

    def outcome(self) -> Outcome:
        """Return the results of the run."""
        laws = self.laws
        for law, collision in self.tracker.open.items():
            collision.count(*(float(x[law]) for x in laws.collision))
        peaks = self.tracker.close(self.accumulator.dashpot_losses)
        states = tuple(self.law_state(i) for i in range(len(self.law_springs)))
        checks = [*self.checks(peaks), *self.uniqueness.checks()]
        return Outcome(peaks, self.figures(), states, checks, self.exact)

    def law_state(self, i: int) -> State:
        """Return the state of law `i`."""
        laws, spring = self.laws, self.law_springs[i]
        variables = laws.state.internal[i, : spring.law.rule.variables].tolist()
        if spring.secant:
            variables += laws.state.internal[i, -2:].tolist()
        entry = float(laws.state.entry_deformation[i]), float(laws.state.entry_work[i])
        return int(laws.state.branch[i]), *entry, tuple(variables)

    def stop(self, code: str, why: str) -> Stop:
        """Return the exception that ends the run here."""
        return Stop(code, float(self.sim.run.time), why, self.outcome())
