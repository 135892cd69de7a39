r"""EXACT: event-driven integration without a time step.

Between events (a spring yields or unloads, a contact closes or opens) the reduced system is linear and its
motion under piecewise-polynomial excitation is known in closed form (:mod:`.propagator`).
So only the event times need finding.  The exits of all laws are sampled with their slopes in cells whose
length the motion itself sets: how far it can bend within one is bounded by what its modes carry,

.. math:: |\ddot y(t)| \le \sum_i |r_i|\,|\ddot q_i(0)|

for a functional :math:`y = \mathrm{Re} \sum r_i q_i`, modes that do not grow and excitation along a
straight line, so that most cells cannot hold an event.  The others are seen on a grid that resolves the
fastest mode, bracketed by value and by slope (two crossings within one step of it), and polished to
the last digits (:mod:`..events.grid`).  Peaks of drifts, spring deformations and contact
forces are found the same way.

Parts of the structure that no closed contact joins are solved apart, each with its own modes for each
combination of stiffnesses, kept for when it returns (:mod:`~pound_solve.integrate.closed_form.subsystems`).

Energies are integrated independently of each other: the dashpots' work as the closed integral
of :math:`v^T C v`, the input as that of :math:`v^T p`, the plastic work from the laws' slip.
Their sum against kinetic and strain energy is therefore a check of the whole integration.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.closed_form import work_integrals
from pound_solve.integrate.closed_form.deferred_work import DeferredWork
from pound_solve.integrate.closed_form.dense_output import DenseOutput, GridSamples
from pound_solve.integrate.closed_form.propagator import MOST_CONDITION, Mechanism, SeriesPropagator
from pound_solve.integrate.closed_form.rigid_contact import NOISE, MasslessContact
from pound_solve.integrate.closed_form.subsystems import Subsystems
from pound_solve.integrate.condensed import condensed
from pound_solve.integrate.events import grid
from pound_solve.integrate.events.functions import exits, followed
from pound_solve.integrate.protocol import (
    CHATTER,
    INTERRUPTED,
    RUNAWAY,
    STEPPED,
    STILL,
    LawValues,
    MonitoredOutputs,
    Outcome,
    Recorder,
    ResponseTracker,
    Start,
    Stop,
    energy_at_start,
    law_values,
    light,
    not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.protocol import goals as goals_of
from pound_solve.laws.automaton import Branch
from pound_solve.numerics import polynomial
from pound_solve.numerics.types import Array, Flags, Index
from pound_solve.structure.reduction import Decision, ReducedSystem

MOST_POINTS = 4096  #: points of the fine grid in one window
MOST_STEPS = 64  #: of the fine grid in one cell
SLACK = 0.05  #: share of an exit's scale that it may bend within a cell
MOST_PIECES = 2000  #: windows within one interval of the excitation
MOST_INTERVALS = 128  #: intervals of one window
AFTER = 8  #: of the first one after an event
GRID = 1.0  #: grid interval times the fastest eigenvalue
MOST_OPEN = 256  #: intervals whose work is put off
MOST_SEEN = 2**19  #: displacements between the samples that wait for the sink
EACH = 4  #: grid points from one that envelopes of nodes and members are taken at to the next
BEYOND = 1e-6  #: share of its range by which a displacement must turn outside it for that instant to count
# what it costs, in seconds of some machine: counted, not measured, so that a choice by it repeats
WINDOW, POINT = 1.3e-3, 2e-8  #: a window; each of its grid points times each unknown
SEEN = 5e-8  #: each point for the envelopes times each unknown that they look at


class CostlyError(Exception):
    """A run has used up what it may cost; `spent` brought it to time `t`."""

    def __init__(self, spent: float, t: float) -> None:
        super().__init__(f"more than {spent:g}, at {t:g}")
        self.spent, self.t = spent, t


class Exact:
    """One run; see the module's head."""

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        options: Mapping[str, Any],
        recorder: Recorder,
    ) -> None:
        self.system, self.recorder, self.times = system, recorder, start.times
        self.refine = 2.0 ** -int(options.get("REFINE") or 0)
        self.spent, self.most = 0.0, options.get("COST", np.inf)
        self.trial = options.get("TRIAL", self.most)
        self.per_radian = options.get("PER_RADIAN", 0.0)
        self.most_decompositions = options.get("REGIMES", np.inf)
        self.begin, self.end = float(start.times[0]), float(start.times[-1])
        self.laws = system.structure.laws
        n = self.n_laws = len(self.laws)
        self.light = light(system)
        self.states = list(start.states)
        self.branches: list[Branch] = [s.branch(x) for s, x in zip(self.laws, self.states)]
        # the rows that are followed: deformations of the laws, then the drifts
        self.subsystems = Subsystems(
            system,
            np.vstack([system.law_rows, monitored.rows]),
            np.vstack([system.law_inputs, monitored.input_rows]),
            np.concatenate([np.zeros(n), monitored.constants]),
            recorder.shown,
        )
        if (parts := self.subsystems.parts) > 1:
            system.decisions.append(
                Decision(
                    f"{parts} parts", "solved apart", "each on its own while no closed contact joins them"
                )
            )
        self.tracker = ResponseTracker(system, len(monitored.names))
        self.t, self.u, self.v = float(start.times[0]), start.u.copy(), start.v.copy()
        contact = np.array([s.role.contact_energy for s in self.laws], bool)
        self.deferred = DeferredWork(start.works.copy(), system.constant, contact)
        # what waits for the sink: samples whose works are not known yet, and motions between them
        self.held_back: list[tuple[Any, ...]] = []
        self.seen: list[tuple[Any, ...]] = []
        self.stationary: list[tuple[Array, Array]] = []  # where displacements turn between those
        self.range = np.array([self.u, self.u])[:, self.subsystems.shown]  # of the displacements there
        self.rigid = self.subsystems.rigid
        # |value|, |rate| of all rows seen, the scale of the exits
        self.largest = np.zeros((2, len(self.subsystems.rows)))
        self.ahead = AFTER  # intervals of the next window
        self.usual = 0.0  # length of most intervals
        self.events = self.windows = self.same_instant = self.pieces = 0
        self.held = energy_at_start(system, start)

    def run(self) -> Outcome:
        """Integrate to the last output time."""
        self.tracker.begin(self.system, self.t, self.u, self.v, self.branches)
        self._no_overlap()
        self._form()
        goals, self.is_output = goals_of(self.system, self.times)
        self._show_now()
        cursor = 0
        while cursor < len(goals):
            cursor = self._advance(goals, cursor)
        return self.outcome()

    def _spend(self, cost: float) -> None:
        """Take something from what the run may cost: the faster its fastest mode, the more, as long as it
        will do at this rate.
        """
        self.spent += cost
        if len(self.subsystems.decompositions) > self.most_decompositions:
            raise CostlyError(self.spent, self.t)
        if self.spent > self.trial:
            length = self.end - self.begin
            whole = self.spent * length / max(self.t - self.begin, 1e-300)
            if whole > self.most + self.per_radian * self.subsystems.fastest * length:
                raise CostlyError(self.spent, self.t)

    def _no_overlap(self) -> None:
        """Stop where rigid bodies overlap from the start."""
        r = self.rigid
        d = r.rows @ self.u + r.inputs @ self._inputs()[0]
        size = np.abs(r.rows) @ np.abs(self.u) + r.gap
        for i in np.flatnonzero(d - r.gap > 1e-10 * size).tolist():
            s = self.laws[r.laws[i]]
            why = f"the rigid contact {s.element} ({s.rule}) overlaps by {d[i] - r.gap[i]:.3g} at the start"
            raise self.stop("A505", why)

    def _form(self) -> None:
        """Form the blocks for the present branches and gather their exits."""
        try:
            self.subsystems.form(self.branches, self.u, self.v, self._spend)
        except Mechanism as err:
            worst = int(np.argmax(np.abs(err.shape)))
            raise self.stop("A501", f"{self.system.name(worst)} has no mass and nothing holds it") from None
        self.exits, self.exit_pairs = exits(self.branches, self.subsystems.force_row)
        self.followed, self.peaks = followed(self.tracker, self.branches, self.subsystems.force_row)
        # second rates matter where rates decide
        self.bending = self.exits.by_rate or self.followed.by_rate

    def _window(self, lengths: Array, starts: Array) -> DenseOutput:
        return DenseOutput(self.subsystems, self.branches, self.system.excitation.about(starts), lengths)

    def _show_now(self) -> None:
        """Hand out a sample of the present."""
        at = np.array([self.t])
        motion = self._window(np.zeros(1), at).path(0, np.zeros(1))
        self._hand_out(at, *motion, np.array([self.deferred.rows]))

    def _advance(self, goals: Array, cursor: int) -> int:
        """Advance by a window of intervals up to the next goals, or to an event; return the new cursor."""
        if goals[cursor] - self.t <= 1e-14 * max(1.0, self.t):  # an event fell on the goal
            self.t = float(goals[cursor])
            if self.is_output[cursor]:
                self._show_now()
            return cursor + 1
        lengths, starts, h, whole = self._intervals(goals, cursor)
        window = self._window(lengths, starts)
        bends = window.bends()
        coarse = window.all(self._cell(bends, h), self.bending)
        if not np.isfinite(coarse.value).all() or not np.isfinite(coarse.rate).all():
            raise self.stop("A504", "the motion grew beyond all numbers")
        self.windows += 1
        fine = coarse
        if coarse.h > h:
            fine = coarse.closer(self._near(coarse, bends), h, self.bending)
        self._spend(WINDOW + POINT * (coarse.t.size + fine.t.size) * len(self.u))
        self._spend(SEEN * window.length / (EACH * h) * self.subsystems.shown.sum())
        event = None
        if self.exit_pairs and fine.t.size:
            event = self.exits.first_rise(fine, self.largest, STILL)
        if event is None:
            self._peaks(coarse, fine, window.length)
            self._between(window, h, window.length)
            if whole:
                self._sample(window, goals, cursor, window.intervals)
                self.pieces = 0
                cursor += window.intervals
                self.t = float(goals[cursor - 1])
            else:
                self._work(window, 0, lengths)
                self.t += window.length
            window.accept(window.intervals - 1, float(lengths[-1]))
            self.ahead = min(2 * self.ahead, MOST_INTERVALS)
            self.same_instant = 0
            self.recorder.trial(self.t)
            return cursor
        tau, n, arc, cell = event
        law, event_index = self.exit_pairs[n]
        interval, within = window.place(tau)
        now = window.all_at(tau)
        fine.cut(arc, cell, tau, now)
        self._peaks(coarse, fine, tau)
        self._between(window, h, tau)
        self._sample(window, goals, cursor, interval)
        self._work(window, interval, np.array([within]))
        self.u, self.v, _ = window.motion(interval, within)
        window.accept(interval, within)
        self.same_instant = self.same_instant + 1 if tau <= 1e-13 * max(1.0, self.t) else 0
        self.t = float(starts[interval]) + within
        self.ahead = AFTER
        self._switch(law, event_index, float(now[0][law]), float(now[1][law]))
        return cursor + interval

    def _intervals(self, goals: Array, cursor: int) -> tuple[Array, Array, float, bool]:
        """Lengths and starts of the next window's intervals, the step of its fine grid, and whether they
        are whole: an interval of too many steps is taken in pieces.
        """
        ends = goals[cursor : cursor + self.ahead + 1]
        own = np.diff(np.append(self.t, ends))
        # intervals of equal length share their exponentials, whatever the rounding of the times
        close = 1e-11 * own + 4.0 * np.spacing(ends)
        if abs(own[-1] - self.usual) > close[-1]:
            self.usual = float(f"{own[-1]:.12e}")
        own = np.where(np.abs(own - self.usual) <= close, self.usual, own)
        usual = own[min(1, len(own) - 1)]
        longest = float(max(own[0], usual))
        h = self._grid_step(longest)
        per_interval = int(np.ceil(longest / h * (1 - 1e-12)))
        if per_interval > MOST_POINTS:
            length = float(min(own[0], MOST_POINTS * h))
            if length < own[0]:
                self._resolvable(length)
            return np.array([length]), np.array([self.t]), h, length == own[0]
        most = min(len(own), MOST_POINTS // per_interval)
        other = np.flatnonzero(own[1:most] != usual)
        count = int(other[0]) + 1 if len(other) else most
        return own[:count], np.append(self.t, ends[: count - 1]), h, True

    def _cell(self, bends: Array, h: float) -> float:
        """Length of the coarse cells: a multiple of `h`, over which little can bend."""
        if self.exit_pairs:
            own, scale = self.exits, self.exits.scale(self.largest)
        else:  # by their range so far
            own, scale = self.followed, np.array([max(x.high - x.low, 0.0) for x in self.peaks])
        most = own.bends(bends).max(axis=1, initial=0.0)
        chosen = (scale > 0.0) & (most > 0.0)
        if not np.isfinite(most).all():
            return h
        if not chosen.any():
            return h * MOST_STEPS
        cell = float(np.sqrt(8.0 * SLACK * (scale[chosen] / most[chosen]).min()))
        # powers of four: few lengths, so that tables are found again
        steps = 4.0 ** np.floor(np.log2(max(cell / h, 1.0)) / 2.0)
        return h * float(min(steps, MOST_STEPS))

    def _near(self, coarse: GridSamples, bends: Array) -> Flags:
        """Which cells may hold an event or a peak, shape (n, count)."""
        out = np.zeros((len(coarse.width), coarse.t.shape[1] - 1), bool)
        last = out.size
        if self.exit_pairs:
            g, slope = self.exits.of(coarse)
            # what first_rise is sure to count
            scale = np.maximum(self.exits.scale(self.largest), np.abs(g).max(axis=(1, 2)))
            least = 1e3 * STILL * scale[:, None, None]
            g[:, 0, 0] = np.minimum(g[:, 0, 0], 0.0)
            out |= grid.may_rise(g, slope, self.exits.bends(bends), coarse.widths).any(axis=0)
            sure = ((g[..., 1:] > least) & (g[..., :-1] <= 0.0)).any(axis=0).ravel()
            if sure.any():
                last = int(sure.argmax())
        if self.peaks:
            value, slope = self.followed.of(coarse)
            bend = self.followed.bends(bends)
            out |= grid.may_peak(value, slope, bend, coarse.widths, self.peaks).any(axis=0)
        out.ravel()[last + 1 :] = False  # the run goes no further
        return out

    def _resolvable(self, length: float) -> None:
        """Stop where the fastest mode cannot be followed: time would not advance, or too slowly."""
        self.pieces += 1
        if length < 1e-15 * max(1.0, self.t) or self.pieces > MOST_PIECES:
            fastest = self.subsystems.fastest
            raise self.stop(
                "A503",
                f"the fastest mode, {fastest:.3g} rad per unit of time, is too fast to be followed: "
                "look for a mass too small or a stiffness or dashpot too large",
            )

    def _grid_step(self, length: float) -> float:
        """Step of the search grid: it resolves the fastest mode; a power of two,
        so that tables are found again.
        """
        fastest = self.subsystems.fastest
        h = 2.0 ** np.ceil(np.log2(length / 8))
        return (
            float(min(h, 2.0 ** np.floor(np.log2(GRID * self.refine / fastest))))
            if fastest > 0
            else float(h)
        )

    def _sample(self, window: DenseOutput, goals: Array, cursor: int, count: int) -> None:
        """Note the work of the first `count` intervals and hand out the samples at their ends."""
        before = self.deferred.rows
        self._work(window, 0, window.lengths[:count])
        out = np.flatnonzero(self.is_output[cursor : cursor + count])
        if len(out):
            self._hand_out(goals[cursor + out], *window.ends(out), before + out + 1)
        if self.deferred.rows > MOST_OPEN or cursor + count == len(goals):
            self._settle()
            _, v, _ = window.ends(np.array([count - 1]))
            kinetic = 0.5 * float(v[:, 0] @ self.system.mass @ v[:, 0])
            if not kinetic <= 10.0 * (self.held + self.deferred.put_in) + 1e-300:
                raise self.stop("A504", RUNAWAY.format(kinetic))

    def _settle(self) -> None:
        """Learn the works, and give the sink what waited for them.

        An interrupt on the way loses nothing: the sink passes over what it has been given already.
        """
        works, losses = self.deferred.measured()
        self._show_seen()
        if self.held_back:
            times, *motion, laws, row = zip(*self.held_back)
            u, v, a = (np.concatenate(x, axis=1) for x in motion)
            by_law = LawValues(*(np.concatenate(x, axis=1) for x in zip(*laws)))
            self.recorder.sample(np.concatenate(times), u, v, a, by_law, works[np.concatenate(row)].T)
        for law, loss in losses.items():
            self.tracker.peaks.dashpot_losses[law] += loss
        self.held_back.clear()
        self.deferred.close(works)

    def _show_seen(self) -> None:
        """Give the sink the motions between the samples."""
        if self.seen:
            *motion, apart = zip(*self.seen)
            t, u, v, a = (np.concatenate(x, axis=-1) for x in motion)
            self.recorder.between(t, u, v, a, max(apart))
            self.seen.clear()
        if self.stationary:
            t, u = (np.concatenate(x, axis=-1) for x in zip(*self.stationary))
            self.recorder.stationary(t, u)
            self.stationary.clear()

    def _turn(self, window: DenseOutput, tau: Array, u: Array, v: Array, end: float) -> None:
        """Keep the displacements at the instants at which one that the envelopes look at turns beyond its
        range so far, for the sink: of each the highest and the lowest, from the cubic from one point to
        the next and a step of Newton's method on the motion itself.
        """
        shown, known = np.flatnonzero(self.subsystems.shown), self.range
        last = window.motion(*window.place(end))
        x, rate = (np.column_stack([y[shown], z[shown]]) for y, z in zip((u, v), last))
        known[0] = np.maximum(known[0], x.max(axis=1))
        known[1] = np.minimum(known[1], x.min(axis=1))
        row, at = np.nonzero(rate[:, :-1] * rate[:, 1:] < 0.0)
        length = np.diff(tau, append=end)[at]
        begin, finish = rate[row, at] * length, rate[row, at + 1] * length
        s, value = grid.turn(x[row, at], x[row, at + 1], begin, finish)
        margin = BEYOND * (known[0] - known[1])
        best = np.array([known[0] + margin, margin - known[1]])
        for sign, most in zip((1.0, -1.0), best):
            np.maximum.at(most, row, sign * value)
        chosen = np.flatnonzero((value == best[0][row]) | (-value == best[1][row]))
        if not len(chosen):
            return
        times, dof = (tau[at] + s * length)[chosen], shown[row[chosen]]
        _, v, a = (y[dof, np.arange(len(chosen))] for y in window.at(times))
        times -= np.divide(v, a, out=np.zeros_like(v), where=np.abs(v) < 0.1 * np.abs(a) * length[chosen])
        times = np.unique(np.clip(times, 0.0, end))
        u = window.at(times)[0]
        known[0] = np.maximum(known[0], u[shown].max(axis=1))
        known[1] = np.minimum(known[1], u[shown].min(axis=1))
        self.stationary.append((self.t + times, u))

    def _between(self, window: DenseOutput, h: float, end: float) -> None:
        """Keep the motion between the samples, up to the local time `end`, for the sink."""
        if not self.subsystems.shown.any():
            return
        tau, u, v, a = window.between(EACH * h, end)
        self.seen.append((self.t + tau, u, v, a, float(np.diff(tau, append=end).max(initial=0.0))))
        self._turn(window, tau, u, v, end)
        if sum(x[1].size for x in (*self.seen, *self.stationary)) > MOST_SEEN:
            self._show_seen()

    def _hand_out(self, t: Array, u: Array, v: Array, a: Array, row: Index) -> None:
        """Keep samples for the sink, with the rows of the account that they stand at."""
        laws = law_values(self.system, t, u, v, self.states)
        held = np.array([self.branches[i].held for i in self.rigid.laws], bool)
        if held.any():
            ex = self.system.excitation
            s = np.stack([ex.values(t, order) for order in range(3)])
            for i in range(len(t)):
                now = self.rigid.forces(held, self.branches, u[:, i], v[:, i], s[:, i])
                laws.force[self.rigid.laws, i] = now
        self.held_back.append((t, u, v, a, laws, row))

    def _work(self, window: DenseOutput, first: int, lengths: Array) -> None:
        """Note the work, and the contacts' impulses, over some `lengths` of intervals from `first` on."""
        last = first + len(lengths)
        if self.system.total:
            for i, tau in zip(range(first, last), lengths.tolist()):
                self._total_work(window, i, tau)
        elif len(lengths):
            self.deferred.note(window, first, last, lengths)
        for law, collision in self.tracker.open.items():
            for i, tau in zip(range(first, last), lengths.tolist()):
                collision.impulse += window.impulse(law, i, tau)

    def _total_work(self, window: DenseOutput, interval: int, tau: float) -> None:
        """Note the work over the first `tau` of an interval in the total form."""
        found = work_integrals.total_work(
            self.system,
            tau,
            self.subsystems.fastest,
            window.coefs[interval],
            lambda x: window.path(interval, x),
            self.branches,
        )
        entry = np.array([found.input, found.damping, 0.0])
        for law, loss in found.laws:
            self.tracker.peaks.dashpot_losses[law] += loss
            entry[2 if self.laws[law].role.contact_energy else 1] += loss
        self.deferred.put(entry)

    def _switch(self, law: int, event_index: int, d: float, v: float) -> None:
        self.events += 1
        try:
            if self.laws[law].law.rigid and not self.branches[law].held:
                self._meet()
            else:
                self._leave(law, event_index, d, v)
                self._press()
        except ArithmeticError as err:
            raise self.stop("A503", str(err)) from None
        if self.same_instant > 50 + 4 * self.n_laws:
            s = self.laws[law]
            why = CHATTER.format(self.same_instant, s.element, s.rule, self.branches[law].name, STEPPED)
            raise self.stop("A503", why)
        self._form()

    def _leave(self, law: int, event_index: int, d: float, v: float) -> None:
        before = self.branches[law].kind
        self.states[law] = self.laws[law].law.transition(self.states[law], event_index, d, v)
        after = self.branches[law] = self.laws[law].branch(self.states[law])
        force = self.laws[law].force(self.states[law], d, 0.0 if self.light[law] else v)
        self.tracker.switched(law, before, after.kind, self.t, d, v, force)
        self.tracker.peaks.force[law].take(force, self.t)

    def _inputs(self) -> Array:
        """Inputs and their first two derivatives just after now, shape (3, n_inputs)."""
        ex = self.system.excitation
        own = ex.about(np.array([self.t]))[0]
        return np.stack([polynomial.value(own, 0.0, order) for order in range(3)])

    def _meet(self) -> None:
        """Let rigid contacts that touch strike, and close or part."""
        r, s = self.rigid, self._inputs()
        held = np.array([self.branches[i].held for i in r.laws])
        d, rates = r.rows @ self.u + r.inputs @ s[0], r.rows @ self.v + r.inputs @ s[1]
        near = 1e-12 * (self.largest[0, r.laws] + r.gap) + 1e-13 * max(1.0, self.t) * np.abs(rates)
        touching = held | (d >= r.gap - near)
        fastest = self.largest[1, r.laws]
        impulse, lost, after = r.strike(rates, touching, fastest)
        self.v = self.v - r.yielding @ impulse
        # input by supports that move
        self.deferred.put(np.array([float(impulse @ (r.inputs @ s[1])), 0.0, lost.sum()]))
        still = touching & (after >= -NOISE * fastest)
        for i, law in enumerate(r.laws):
            self.tracker.peaks.dashpot_losses[law] += float(lost[i])
            if not held[i] and (still[i] or impulse[i] > 0.0):
                self._leave(law, 0, float(d[i]), float(rates[i]))
            if law in self.tracker.open:
                self.tracker.open[law].impulse += float(impulse[i])
            if self.branches[law].held and not still[i]:
                if not held[i]:
                    self.tracker.open[law].peak = np.nan  # beyond all numbers
                self._leave(law, 0, float(d[i]), float(after[i]))
        self._press()
        self.subsystems.active = []  # the velocities have jumped

    def _press(self) -> None:
        """Open those of the closed rigid contacts that would have to pull."""
        r = self.rigid
        if not r.laws:
            return
        # a deformation that contact holds at next to nothing still has the rounding of what it is made of
        moved = np.abs(r.rows) @ np.abs(self.u)
        self.largest[0, r.laws] = np.maximum(self.largest[0, r.laws], moved)
        held = np.array([self.branches[i].held for i in r.laws])
        if not held.any():
            return
        s = self._inputs()
        free, size = r.accelerations(self.branches, self.u, self.v, s)
        # displacements come from modes that carry the velocities as well
        size = size + self.subsystems.fastest * (np.abs(r.rows) @ np.abs(self.v))
        force = r.plastic(free, held)
        parting = held & (force == 0.0) & (free - r.compliance @ force < -NOISE * size)
        for i in np.flatnonzero(parting).tolist():
            d, v = r.rows[i] @ self.u + r.inputs[i] @ s[0], r.rows[i] @ self.v + r.inputs[i] @ s[1]
            self._leave(r.laws[i], 0, float(d), float(v))
        rows = [self.subsystems.force_row[i] for i in r.laws]
        self.largest[0, rows] = np.maximum(self.largest[0, rows], size / np.diag(r.compliance))

    def _peaks(self, coarse: GridSamples, fine: GridSamples, end: float) -> None:
        """Count in what happened up to the local time `end`; the fine arcs are cut there."""
        seen = coarse.t <= end
        if self.n_laws:
            both = np.abs([coarse.value[:, seen], coarse.rate[:, seen]]).max(axis=2)
            np.maximum(self.largest, both, out=self.largest)
            if fine.t.size:
                both = np.abs([fine.value[..., -1], fine.rate[..., -1]]).max(axis=2)
                np.maximum(self.largest, both, out=self.largest)
        if not self.peaks:
            return
        grid.count(self.peaks, self.t + coarse.t[seen], self.followed.of(coarse)[0][:, seen])
        if fine.t.size:
            grid.widen(self.peaks, self.t, fine.t, *self.followed.of(fine), self.followed.at(fine))
        for i, collision in self.tracker.open.items():
            self.tracker.peaks.force[i].take(collision.peak, collision.t_peak)

    def outcome(self) -> Outcome:
        """What the run gathered."""
        self._settle()
        propagators = [r.propagator for r in self.subsystems.decompositions.values()]
        residual, condition = (
            max((f.residual for f in propagators), default=0.0),
            max((f.condition for f in propagators), default=1.0),
        )
        figures = {
            "method": "EXACT, event-driven",
            "events": self.events,
            "windows": self.windows,
            "linear regimes": len(propagators),
        }
        checks = [
            (
                "residual of the modes, worst regime",
                f"{residual:.1e}",
                "good" if residual < 1e-10 else "look",
            ),
            (
                "condition of the modes, worst regime",
                f"{condition:.1e}",
                "good" if condition < MOST_CONDITION else "look",
            ),
        ]
        if any(isinstance(f, SeriesPropagator) for f in propagators):
            checks.append(("defective modes, integrated by the exponential series", "present", "good"))
        peaks = self.tracker.close()
        checks += rounding_check(self.system.structure.laws, peaks)
        return Outcome(peaks, figures, tuple(self.states), checks, exact=True, turns=True)

    def stop(self, code: str, why: str) -> Stop:
        """The exception that ends the run here."""
        return Stop(code, self.t, why, self.outcome())


def integrate(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: Recorder,
) -> Outcome:
    """Integrate a reduced system exactly; see the module's head.

    Raises
    ------
    Stop
        Too many changes at one instant, a mechanism, numbers beyond all bounds, or an interrupt.
    CostlyError
        It has cost more than TRIAL and will cost more than COST and PER_RADIAN for each radian of the
        fastest mode, or takes more than REGIMES, of the options; no deck sets them.
    """
    if why := not_linear(system):
        refuse_rigid(system, start, "EXACT")
        why = f"EXACT needs linear pieces, and {why}: AUTO takes steps"
        raise Stop("A505", float(start.times[0]), why)
    system, start, monitored, recorder = condensed(system, start, monitored, recorder, "EXACT")
    try:
        run = Exact(system, start, monitored, options, recorder)
    except MasslessContact as err:
        raise Stop("A505", float(start.times[0]), str(err)) from None
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # what grows beyond all numbers is told as such
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
