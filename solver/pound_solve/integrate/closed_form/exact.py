r"""EXACT: event-driven integration without a time step.

Between events (a spring yields or unloads, a contact closes or opens) the reduced system is linear and its
motion under piecewise-polynomial excitation is known in closed form (see `propagators`).  Only the event
times remain to be found: event functions are sampled in cells whose length follows from bounds of their
curvature (:mod:`.search`), bracketed by value and by slope (two crossings within one step of the grid), and
refined to the last digits (:mod:`..events.grid`).  Peaks of drifts, spring deformations and contact forces
are found the same way.

Parts of the structure that no closed contact connects are solved separately.  Each has separate modes for
each combination of stiffnesses, which are cached for reuse
(:mod:`~pound_solve.integrate.closed_form.subsystems`).

Energies are integrated independently of each other: the work of the dashpots as the closed-form integral of
:math:`v^T C v`, the input as that of :math:`v^T p`, and the plastic work from the slip of the laws.
Comparing their sum with the kinetic and strain energy is therefore a check of the whole integration.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.check import Check, Subject, at_most
from pound_solve.integrate import costs
from pound_solve.integrate.closed_form import recording, work_integrals
from pound_solve.integrate.closed_form.decomposition import MAX_CONDITION, MAX_RESIDUAL
from pound_solve.integrate.closed_form.deferred_work import DeferredWork
from pound_solve.integrate.closed_form.dense_output import DenseOutput
from pound_solve.integrate.closed_form.event_loop import EventDrivenRun
from pound_solve.integrate.closed_form.grid_samples import GridSamples
from pound_solve.integrate.closed_form.recording import DeferredSamples, EnvelopeSamples
from pound_solve.integrate.closed_form.search import CERTAIN, Search
from pound_solve.integrate.closed_form.subsystems import Subsystems
from pound_solve.integrate.closed_form.windows import Window, Windows
from pound_solve.integrate.condensed import condensed
from pound_solve.integrate.energy import CONTACT, DAMPING
from pound_solve.integrate.events.functions import EventFunctions, GridEvent, monitored_functions
from pound_solve.integrate.propagators.series import SeriesPropagator
from pound_solve.integrate.propagators.state_space import Mechanism
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    Outcome,
    Problem,
    Recorder,
    Stop,
    goals,
    reason_not_linear,
    refuse_rigid,
    remedy,
    rounding_check,
    without_steps,
)
from pound_solve.integrate.rigid.contacts import MasslessContact, linear_forces
from pound_solve.integrate.rigid.instants import RigidInstants
from pound_solve.integrate.tolerances import EVENT_TOLERANCE, SAME_INSTANT
from pound_solve.numerics.types import Array
from pound_solve.structure.reduction import Decision

MAX_PIECES = 2000  #: largest number of windows within one interval of the excitation
MAX_WINDOWS = 10000  #: largest number of windows shorter than an interval in the rest of a run: minutes
#: number of such windows without an event between them, after which the total number is predicted
WINDOWS_BEFORE_FORECAST = 16
#: fractions of the time, which is rounded to 1e-16 of it: a shorter window does not advance the clock, and
#: a nearer goal has been reached.  Both are shorter than an instant (`SAME_INSTANT`)
NO_ADVANCE, AT_GOAL = 1e-15, 1e-14
MAX_DEFERRED = 256  #: largest number of deferred work entries
DEFECTIVE_MODES = "modes are nearly parallel: digits are lost"


class Exact(EventDrivenRun):
    """One run; see the module docstring."""

    def __init__(self, problem: Problem[Recorder], options: Mapping[str, Any]) -> None:
        super().__init__(problem)
        system = self.system
        self.goals, self.is_output = goals(system, self.times)
        self.budget = costs.Budget(
            problem.begin,
            float(self.times[-1]),
            options.get("COST", np.inf),
            options.get("TRIAL"),
            options.get("DECOMPOSITIONS", np.inf),
        )
        self.subsystems = Subsystems(system, self.rows, self.recorder.enveloped_unknowns)
        self.largest = np.zeros((2, len(self.subsystems.rows.rows)))
        if (parts := self.subsystems.parts) > 1:
            system.decisions.append(
                Decision(
                    f"{parts} parts", "solved apart", "each on its own while no closed contact joins them"
                )
            )
        contact = np.array([s.role.collides for s in self.laws], bool)
        self.work = DeferredWork(self.energy, system.constant, contact)
        self.rigid = RigidInstants(self, self.subsystems.rigid)
        self.samples = DeferredSamples(system, self.subsystems.rigid, self.recorder)
        self.envelopes = EnvelopeSamples(self.subsystems, self.recorder)
        self.windows = Windows(int(options.get("REFINE") or 0))
        self.window_count = self.pieces = self.unbroken = 0

    def run(self) -> Outcome:  # noqa: D102
        self.tracker.begin(self.system, self.t, self.u, self.v, self.branches)
        try:
            self.rigid.begin()
        except ArithmeticError as err:
            raise self.stop("A503", str(err)) from None
        self._update_subsystems()
        self._sample_now()
        cursor = 0
        while cursor < len(self.goals):
            cursor = self._advance(cursor)
        return self.outcome()

    def _charge(self, cost: float) -> None:
        """Charge a cost to the budget of the run."""
        decompositions = len(self.subsystems.decompositions)
        self.budget.charge(cost, self.t, decompositions)

    def _update_subsystems(self) -> None:
        """Form the subsystems of the present branches and their event functions."""
        try:
            self.subsystems.update(self.branches, self.u, self.v, self._charge)
        except Mechanism as err:
            worst = int(np.argmax(np.abs(err.shape)))
            raise self.stop("A501", self.system.explain_massless(worst, err.softens)) from None
        reaction_row = self.subsystems.reaction_row
        events = EventFunctions(self.branches, reaction_row)
        self.search = Search(events, *monitored_functions(self.tracker, self.branches, reaction_row))

    def _dense_output(self, lengths: Array, starts: Array) -> DenseOutput:
        return DenseOutput(self.subsystems, self.branches, self.system.excitation.about(starts), lengths)

    def _sample_now(self) -> None:
        """Add a sample of the present motion."""
        at = np.array([self.t])
        motion = self._dense_output(np.zeros(1), at).motions(0, np.zeros(1))
        self.samples.add(at, motion, np.array([self.work.entries]), self.states, self.branches)

    def _advance(self, cursor: int) -> int:
        """Advance by a window up to the next goals, or to an event; return the new cursor."""
        goal = float(self.goals[cursor])
        if goal - self.t <= AT_GOAL * max(1.0, self.t):  # an event coincides with the goal
            self.t = goal
            if self.is_output[cursor]:
                self._sample_now()
            return cursor + 1
        window = self.windows.next(self.t, self.goals[cursor:], self.subsystems.spectral_radius)
        if not window.whole:
            self._check_progress(float(window.lengths[0]), goal - self.t)
        dense = self._dense_output(window.lengths, window.starts)
        if dense.intervals > 1 and self.runs_away(dense.end[1]):
            self._release()  # the deferred works may contain the energy of the motion
            if self.runs_away(dense.end[1]):
                self.windows.narrow()  # a stop is then reported at the first goal
                return cursor
        bounds = dense.derivative_bounds()
        coarse = self.search.coarse(dense, bounds, window.h, self.largest)
        if not np.isfinite(coarse.value).all() or not np.isfinite(coarse.rate).all():
            raise self.stop("A504", "the response overflowed: the motion grows without bound")
        overdue = self.search.events.violated(
            coarse, self.largest, CERTAIN * EVENT_TOLERANCE, self._on_massless
        )
        if overdue is not None:
            law = overdue.law
            self.count_change(0.0, SAME_INSTANT)
            self._switch(law, overdue.event_index, coarse.value[:, 0, 0], coarse.rate[:, 0, 0])
            return cursor
        fine = self.search.fine(coarse, bounds, window.h, self.largest)
        self.window_count += 1
        self._charge_window(dense, window.h, coarse.t.size + fine.t.size)
        largest = self.largest
        if self.contacts:  # the end of the window is not reached if an event precedes it
            self.largest = self.reaching(self.u)
            largest = self.reaching(dense.end[0])
        earliest = self.search.events.first_event(fine, largest, EVENT_TOLERANCE, self.contacts)
        if earliest is None:
            self._count_peaks(coarse, fine, dense.length)
            self.envelopes.add(dense, self.t, window.h, dense.length)
            return self._accept_window(window, dense, cursor)
        end = GridSamples.at_time(dense, earliest.event.time)
        fine.cut(earliest.segment, earliest.cell, earliest.event.time, end)
        self._count_peaks(coarse, fine, earliest.event.time)
        self.envelopes.add(dense, self.t, window.h, earliest.event.time)
        return self._accept_event(window, dense, earliest, end, cursor)

    def _charge_window(self, dense: DenseOutput, h: float, points: int) -> None:
        self._charge(costs.WINDOW + costs.GRID_POINT * points * len(self.u))
        enveloped = self.subsystems.enveloped.sum()
        self._charge(costs.ENVELOPE_POINT * dense.length / (recording.FINE_STEPS * h) * enveloped)

    def _accept_window(self, window: Window, dense: DenseOutput, cursor: int) -> int:
        """Advance to the end of a window without events; return the new cursor."""
        if window.whole:
            self._sample(dense, cursor, dense.intervals)
            self.pieces = self.unbroken = 0
            cursor += dense.intervals
            self.t = float(self.goals[cursor - 1])
        else:
            self._add_work(dense, 0, window.lengths)
            self.t += dense.length
            self.unbroken += 1
        dense.advance_subsystems(dense.intervals - 1, float(window.lengths[-1]))
        self.windows.widen()
        self.changes_at_instant = 0
        self.recorder.report_progress(self.t)
        return cursor

    def _accept_event(
        self, window: Window, dense: DenseOutput, grid_event: GridEvent, end: GridSamples, cursor: int
    ) -> int:
        """Advance to an event, at which `end` contains the values of the rows; return the new cursor."""
        law, event_index, tau = grid_event.event
        interval, local = dense.locate(tau)
        self._sample(dense, cursor, interval)
        self._add_work(dense, interval, np.array([local]))
        self.u, self.v, _ = dense.motion(interval, local)
        dense.advance_subsystems(interval, local)
        self.count_change(tau, SAME_INSTANT)
        self.t = float(window.starts[interval]) + local
        self.windows.restart()
        self.unbroken = 0
        self._switch(law, event_index, end.value[:, 0, 0], end.rate[:, 0, 0])
        return cursor + interval

    def _switch(self, law: int, event_index: int, d: Array, v: Array) -> None:
        """Move a law to its next branch, and process all consequences at the same instant; `d` and `v` are
        the deformations and rates of all laws.
        """
        self.events += 1
        try:
            strikes = self.laws[law].law.rigid and not self.branches[law].constrains
            if strikes:
                self.rigid.impact()
            else:
                self.change(law, event_index, d, v)
            self.rigid.open_pulled(self.subsystems.spectral_radius)
            if strikes:
                self.subsystems.present = []  # the velocities have jumped
        except ArithmeticError as err:
            raise self.stop("A503", str(err)) from None
        self.stop_chatter(law, remedy(self.system))
        if self.rigid.contacts.laws:
            rows = list(self.subsystems.reaction_row.values())
            self.largest[0, rows] = np.maximum(self.largest[0, rows], self.rigid.rounding)
        self._update_subsystems()

    def law_forces(self, d: Array, v: Array) -> Array:
        """Return the forces of all laws at deformations and rates (see `RigidRun`)."""
        return linear_forces(self.branches)(d, v)

    def add_works(self, works: Array) -> None:
        """Add works that are done at one instant, shape (3,)."""
        self.work.add(works)

    def add_impact_work(self, put_in: float, lost: Array) -> None:
        """Add the works of an impact of rigid contacts (see `RigidRun`)."""
        self.add_works(np.array([put_in, 0.0, lost.sum()]))
        self.energy.dashpot_losses += lost

    def _check_progress(self, length: float, remaining: float) -> None:
        """Stop if the fastest mode cannot be resolved: pieces of the given `length` would not advance the
        time, or too slowly for the `remaining` of the interval or of the run.
        """
        self.pieces += 1
        left = MAX_PIECES - self.pieces
        slow = left < 0
        if self.unbroken >= WINDOWS_BEFORE_FORECAST:
            slow |= remaining > (left + 1) * length or self.goals[-1] - self.t > MAX_WINDOWS * length
        if slow or length < NO_ADVANCE * max(1.0, self.t):
            raise self.stop(
                "A503",
                f"the fastest mode, {self.subsystems.spectral_radius:.3g} rad per unit of time, is too "
                "fast to be followed: look for a mass too small or a stiffness or dashpot too large",
            )

    def _count_peaks(self, coarse: GridSamples, fine: GridSamples, end: float) -> None:
        """Include the samples up to the local time `end` in magnitudes and peaks."""
        seen = coarse.t <= end
        self.count_magnitudes(coarse.value[:, seen], coarse.rate[:, seen])
        if fine.t.size:
            self.count_magnitudes(fine.value[..., -1], fine.rate[..., -1])
        self.search.update_peaks(coarse, fine, self.t, end)
        if self.search.peaks:
            self.count_collision_peaks()

    def _sample(self, dense: DenseOutput, cursor: int, count: int) -> None:
        """Add the work of the first `count` intervals and the samples at their ends."""
        before = self.work.entries
        self._add_work(dense, 0, dense.lengths[:count])
        outputs = np.flatnonzero(self.is_output[cursor : cursor + count])
        if len(outputs):
            motion, entries = dense.motions_at_ends(outputs), before + outputs + 1
            self.samples.add(self.goals[cursor + outputs], motion, entries, self.states, self.branches)
        ends = cursor + count == len(self.goals)
        grows = count == dense.intervals and self.runs_away(dense.end[1])
        if self.work.entries > MAX_DEFERRED or ends or grows:
            self._release()
            if count:
                self.t = float(self.goals[cursor + count - 1])  # time at which a stop is reported
                self.stop_growth(dense.motions_at_ends(np.array([count - 1]))[1][:, 0])

    def _release(self) -> None:
        """Evaluate the works, and pass the samples that depend on them to the recorder.

        An interrupt meanwhile loses no samples: the recorder ignores those that it already has.
        """
        works, losses = self.work.evaluated()
        self.envelopes.release()
        self.samples.release(works)
        for law, loss in losses.items():
            self.energy.dashpot_losses[law] += loss
        self.samples.clear()
        self.work.restart(works)

    def _add_work(self, dense: DenseOutput, first: int, lengths: Array) -> None:
        """Add the work, and the impulses of the contacts, over some `lengths` of intervals from
        `first` on.
        """
        last = first + len(lengths)
        if self.system.total:
            for i, tau in zip(range(first, last), lengths.tolist()):
                self._add_total_work(dense, i, tau)
        elif len(lengths):
            self.work.add_intervals(dense, first, last, lengths)
        for law, collision in self.tracker.open.items():
            for i, tau in zip(range(first, last), lengths.tolist()):
                collision.impulse += dense.impulse(law, i, tau)

    def _add_total_work(self, dense: DenseOutput, interval: int, tau: float) -> None:
        """Add the work over the first `tau` of an interval, see `work_integrals.total_work`."""
        work = work_integrals.total_work(
            self.system,
            tau,
            self.subsystems.spectral_radius,
            dense.input_coefs[interval],
            lambda x: dense.motions(interval, x),
            self.branches,
        )
        entry = np.array([work.input, work.damping, 0.0])
        for law, loss in work.laws:
            self.energy.dashpot_losses[law] += loss
            entry[CONTACT if self.laws[law].role.collides else DAMPING] += loss
        self.work.add(entry)

    def outcome(self) -> Outcome:  # noqa: D102
        self._release()
        propagators = [x.propagator for x in self.subsystems.decompositions.values()]
        figures = {
            "method": "EXACT, event-driven",
            "events": self.events,
            "windows": self.window_count,
            "modal decompositions": len(propagators),
        }
        residual = max((x.residual for x in propagators), default=0.0)
        condition = max((x.condition for x in propagators), default=1.0)
        checks = [
            at_most(
                Subject.ROUNDING,
                "residual of the modes, worst decomposition",
                residual,
                MAX_RESIDUAL,
                DEFECTIVE_MODES,
            ),
            at_most(
                Subject.ROUNDING,
                "condition of the modes, worst decomposition",
                condition,
                MAX_CONDITION,
                DEFECTIVE_MODES,
            ),
        ]
        if defective := sum(isinstance(x, SeriesPropagator) for x in propagators):
            about = "decompositions with defective modes, by the exponential series"
            checks.append(Check(Subject.ROUNDING, about, defective))
        peaks = self.tracker.close(self.energy.dashpot_losses)
        checks += [*rounding_check(self.laws, peaks), *self.uniqueness.checks()]
        return Outcome(peaks, figures, tuple(self.states), checks, exact=True)


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system exactly; see the module docstring.

    AUTO limits the costs (see `costs.Budget`) by the options COST, TRIAL and DECOMPOSITIONS, which no deck
    sets.

    Raises
    ------
    Stop
        There were too many changes at one instant, a mechanism, an overflow, or an interrupt.
    CostlyError
        The run exceeds these limits.
    """
    if why := reason_not_linear(problem.system):
        refuse_rigid(problem, "EXACT")
        other = "TAYLOR takes it" if "TAYLOR" in without_steps(problem.system) else "AUTO takes steps"
        why = f"EXACT needs linear pieces, and {why}: {other}"
        raise Stop("A505", problem.begin, why)
    problem = condensed(problem, "EXACT")
    try:
        run = Exact(problem, options)
    except MasslessContact as err:
        raise Stop("A505", problem.begin, str(err)) from None
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # a diverging motion has a separate message
            return run.run()
    except KeyboardInterrupt:
        raise run.stop("A506", INTERRUPTED) from None


SPEC = Spec(
    "method",
    "EXACT",
    "event-driven, exact between events",
    (
        Field(
            "REFINE", Kind.INT, default=0, lo=0, hi=8, doc="halvings of the search grid, for a self-check"
        ),
    ),
    reference="after Nigam & Jennings 1969, for many degrees of freedom and events",
    impl=integrate,
)
