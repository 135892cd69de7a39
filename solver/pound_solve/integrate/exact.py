r"""EXACT: event-driven integration without a time step.

Between events (a spring yields or unloads, a contact closes or opens) the scene is linear and its motion
under piecewise-polynomial excitation is known in closed form (:mod:`~pound_solve.integrate.flow`).
So only the event times need finding: the exits of all laws are sampled with their slopes on a grid
that resolves the fastest mode, bracketed by value and by slope (two crossings within one interval),
and polished to the last digits (:mod:`~pound_solve.integrate.search`).  Peaks of drifts,
spring deformations and contact forces are found the same way.

Parts of the structure that no closed contact joins are solved apart, each with its own modes for each
combination of stiffnesses, kept for when it returns (:mod:`~pound_solve.integrate.blocks`).

Energies are integrated independently of each other: the dashpots' work as the closed integral
of :math:`v^T C v`, the input as that of :math:`v^T p`, the plastic work from the laws' slip.
Their sum against kinetic and strain energy is therefore a check of the whole integration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pound_deck.schema import Field, Kind, Spec
from pound_solve import polynomial
from pound_solve.integrate import search, work
from pound_solve.integrate.base import (
    INTERRUPTED,
    RUNAWAY,
    LawValues,
    Ledger,
    Outcome,
    Sink,
    Start,
    Stop,
    Watch,
    energy_at_start,
    law_values,
    not_linear,
)
from pound_solve.integrate.base import goals as goals_of
from pound_solve.integrate.blocks import Partition, Window
from pound_solve.integrate.flow import MOST_CONDITION, Mechanism, SeriesFlow
from pound_solve.integrate.rigid import NOISE, Weightless
from pound_solve.laws import Branch
from pound_solve.scene import Condensed, Decision, Scene, condense

Array = NDArray[np.float64]

MOST_POINTS = 1024  #: grid points of one window
MOST_PIECES = 20_000  #: windows within one interval of the excitation
MOST_INTERVALS = 32  #: intervals of one window
GRID = 1.0  #: grid interval times the fastest eigenvalue
EACH = 4  #: grid points from one that envelopes of nodes and members are taken at to the next
STILL = 1e-12  #: share of its largest value below which an exit counts as not reached
# what it costs, in seconds of some machine: counted, not measured, so that a choice by it repeats
WINDOW, POINT = 1e-3, 2e-8  #: a window; each of its grid points times each unknown


class CostlyError(Exception):
    """A run has used up what it may cost; `spent` brought it to time `t`."""

    def __init__(self, spent: float, t: float) -> None:
        super().__init__(f"more than {spent:g}, at {t:g}")
        self.spent, self.t = spent, t


class Exact:
    """One run; see the module's head."""

    def __init__(
        self, scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink
    ) -> None:
        self.scene, self.sink, self.times = scene, sink, start.times
        self.refine = 2.0 ** -int(options.get("REFINE") or 0)
        self.spent, self.most, self.most_regimes = (
            0.0,
            options.get("COST", np.inf),
            options.get("REGIMES", np.inf),
        )
        self.laws = scene.structure.laws
        n = self.n_laws = len(self.laws)
        self.states = list(start.states)
        self.branches: list[Branch] = [s.branch(x) for s, x in zip(self.laws, self.states)]
        # the rows that are followed: deformations of the laws, then the drifts
        self.partition = Partition(
            scene,
            np.vstack([scene.law_rows, watch.rows]),
            np.vstack([scene.law_inputs, watch.input_rows]),
            np.concatenate([np.zeros(n), watch.constants]),
        )
        if (parts := self.partition.parts) > 1:
            scene.decisions.append(
                Decision(
                    f"{parts} parts", "solved apart", "each on its own while no closed contact joins them"
                )
            )
        self.ledger = Ledger(scene, len(watch.names))
        self.t, self.u, self.v = float(start.times[0]), start.u.copy(), start.v.copy()
        self.works = start.works.copy()  # input, dashpots of structure and springs, dashpots of contacts
        self.rigid = self.partition.rigid
        # |value|, |rate| of all rows seen, the scale of the exits
        self.largest = np.zeros((2, len(self.partition.rows)))
        self.ahead = 1  # intervals of the next window
        self.events = self.windows = self.same_instant = self.pieces = 0
        self.held = energy_at_start(scene, start)
        self.put_in = 0.0  # sum of all |input| since the start

    def run(self) -> Outcome:
        """Integrate to the last output time."""
        for i, s in enumerate(self.laws):
            if s.is_contact and self.branches[i].name.startswith("pressed"):
                d, v = float(self.scene.law_rows[i] @ self.u), float(self.scene.law_rows[i] @ self.v)
                self.ledger.switched(i, "open", "pressed", 0.0, d, v, self.branches[i].force(d, v))
        self._no_overlap()
        self._form()
        goals, self.is_output = goals_of(self.scene, self.times)
        first = self._window(0.0, np.array([self.t]))  # of no length: for the first sample only
        self._hand_out(np.array([self.t]), *first.path(0, np.zeros(1)), self.works[:, None])
        cursor = 0
        while cursor < len(goals):
            cursor = self._advance(goals, cursor)
        return self.outcome()

    def _spend(self, cost: float) -> None:
        """Take something from what the run may cost."""
        self.spent += cost
        if self.spent > self.most or len(self.partition.regimes) > self.most_regimes:
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
            self.partition.form(self.branches, self.u, self.v, self._spend)
        except Mechanism as err:
            worst = int(np.argmax(np.abs(err.shape)))
            raise self.stop("A501", f"{self.scene.name(worst)} has no mass and nothing holds it") from None
        self.exit_pairs = [(i, e) for i, b in enumerate(self.branches) for e in range(len(b.exits))]
        # what a closed rigid contact may leave by is its force
        row = self.partition.force_row
        self.exit_row = np.array(
            [row[i] if self.branches[i].held else i for i, _ in self.exit_pairs], np.intp
        )
        self.exit_factors = (
            np.array([self.branches[i].exits[e] for i, e in self.exit_pairs]).reshape(-1, 3).T
        )
        # the second rate of a law matters where its rate decides
        self.bending = bool(np.any(self.exit_factors[1])) or any(b.damping for b in self.branches)

    def _window(self, length: float, starts: Array) -> Window:
        return Window(self.partition, self.branches, self.scene.excitation.about(starts), length)

    def _advance(self, goals: Array, cursor: int) -> int:
        """Advance by a window of intervals up to the next goals, or to an event; return the new cursor."""
        if goals[cursor] - self.t <= 1e-14 * max(1.0, self.t):  # an event fell on the goal
            self.t = float(goals[cursor])
            if self.is_output[cursor]:
                at = np.array([self.t])
                self._hand_out(at, *self._window(0.0, at).path(0, np.zeros(1)), self.works[:, None])
            return cursor + 1
        # twelve digits: intervals of equal length share their exponentials,
        # whatever the rounding of the times
        length = float(f"{goals[cursor] - self.t:.12e}")
        h = self._grid_step(length)
        per_interval = int(np.ceil(length / h * (1 - 1e-12)))
        whole = per_interval <= MOST_POINTS
        starts = np.array([self.t])
        if not whole:
            length = MOST_POINTS * h
            self._resolvable(length)
        else:
            most = min(self.ahead, max(1, MOST_POINTS // per_interval), len(goals) - cursor)
            later = np.append(self.t, goals[cursor : cursor + most])
            same = np.abs(np.diff(later) - length) <= 1e-11 * length
            starts = later[: int(np.argmin(same)) if not same.all() else len(same)]
        window = self._window(length, starts)
        t = window.grid(h)
        value, rate, second = window.functionals(h, self.bending)
        if not np.isfinite(value).all() or not np.isfinite(rate).all():
            raise self.stop("A504", "the motion grew beyond all numbers")
        self.windows += 1
        self._spend(WINDOW + POINT * len(t) * len(self.u))
        event = self._first_event(window, t, value, rate, second) if self.n_laws else None
        if event is None:
            self._peaks(window, t, value, rate, second)
            self._between(window, window.length * window.intervals)
            self._sample(window, goals, cursor, window.intervals if whole else 0)
            if whole:
                self.pieces = 0
                cursor += window.intervals
                self.t = float(goals[cursor - 1])
            else:
                self._work(window, window.intervals - 1, length)
                self.t += length
            window.accept(window.intervals - 1, length)
            self.ahead = min(2 * self.ahead, MOST_INTERVALS)
            self.same_instant = 0
            return cursor
        tau, law, exit_index = event
        interval, within = window.place(tau)
        cut = t < tau
        now = window.all_at(tau)
        points = [np.append(a[:, cut], x[:, None], axis=1) for a, x in zip((value, rate, second), now)]
        self._peaks(window, np.append(t[cut], tau), *points)
        self._between(window, tau)
        self._sample(window, goals, cursor, interval)
        self._work(window, interval, within)
        self.u, self.v, _ = window.motion(interval, within)
        window.accept(interval, within)
        self.same_instant = self.same_instant + 1 if tau <= 1e-13 * max(1.0, self.t) else 0
        self.t = float(starts[interval]) + within
        self.ahead = 1
        self._switch(law, exit_index, float(now[0][law]), float(now[1][law]))
        return cursor + interval

    def _resolvable(self, length: float) -> None:
        """Stop where the fastest mode cannot be followed: time would not advance, or too slowly."""
        self.pieces += 1
        if length < 1e-15 * max(1.0, self.t) or self.pieces > MOST_PIECES:
            fastest = self.partition.fastest
            raise self.stop(
                "A503",
                f"the fastest mode, {fastest:.3g} rad per unit of time, is too fast to be followed: "
                "look for a mass too small or a stiffness or dashpot too large",
            )

    def _grid_step(self, length: float) -> float:
        """Step of the search grid: it resolves the fastest mode; a power of two,
        so that tables are found again.
        """
        fastest = self.partition.fastest
        h = 2.0 ** np.ceil(np.log2(length / 8))
        return (
            float(min(h, 2.0 ** np.floor(np.log2(GRID * self.refine / fastest))))
            if fastest > 0
            else float(h)
        )

    def _sample(self, window: Window, goals: Array, cursor: int, count: int) -> None:
        """Add the work of the first `count` intervals and hand out the samples at their ends."""
        if not count:
            return
        works = self.works + np.cumsum(self._measure(window, 0, count, window.length), axis=0)
        u, v, a = window.ends(count)
        self.put_in += float(np.abs(np.diff(works[:, 0], prepend=self.works[0])).sum())
        kinetic = 0.5 * float(v[:, -1] @ self.scene.mass @ v[:, -1])
        if not kinetic <= 10.0 * (self.held + self.put_in) + 1e-300:
            raise self.stop("A504", RUNAWAY.format(kinetic))
        out = np.flatnonzero(self.is_output[cursor : cursor + count])
        if len(out):
            self._hand_out(goals[cursor + out], u[:, out], v[:, out], a[:, out], works[out].T)
        self.works = works[-1]

    def _between(self, window: Window, end: float) -> None:
        """Show the sink the motion between the samples, up to the local time `end`."""
        tau, u, v, a = window.between(EACH, end)
        self.sink.between(self.t + tau, u, v, a, float(np.diff(tau, append=end).max(initial=0.0)))

    def _hand_out(self, t: Array, u: Array, v: Array, a: Array, works: Array) -> None:
        laws = law_values(self.scene, t, u, v, self.states)
        held = np.array([self.branches[i].held for i in self.rigid.laws], bool)
        if held.any():
            ex = self.scene.excitation
            s = np.stack([ex.values(t, order) for order in range(3)])
            for i in range(len(t)):
                now = self.rigid.forces(held, self.branches, u[:, i], v[:, i], s[:, i])
                laws.force[self.rigid.laws, i] = now
        self.sink.sample(t, u, v, a, laws, works)

    def _work(self, window: Window, interval: int, tau: float) -> None:
        """Add the work done over the first `tau` of an interval."""
        if tau > 0.0:
            self.works = self.works + self._measure(window, interval, interval + 1, tau)[0]

    def _measure(self, window: Window, first: int, last: int, tau: float) -> Array:
        """Work put in and lost in dashpots over `tau` of some intervals, shape (last - first, 3).

        Laws' losses and contacts' impulses are noted on the way.
        """
        if self.scene.total:
            each = [
                work.total_work(
                    self.scene,
                    tau,
                    self.partition.fastest,
                    window.coefs[i],
                    lambda x, i=i: window.path(i, x),  # type: ignore[misc]
                    self.branches,
                )
                for i in range(first, last)
            ]
            damping, input_ = np.array([w.damping for w in each]), np.array([w.input for w in each])
            losses = {
                law: np.array([w.laws[n][1] for w in each]) for n, (law, _) in enumerate(each[0].laws)
            }
        else:
            damping, input_, losses = window.works(slice(first, last), tau)
        lost = np.zeros(last - first)
        for law, loss in losses.items():
            self.ledger.peaks.dashpot_losses[law] += float(loss.sum())
            if self.laws[law].is_contact:
                lost += loss
            else:
                damping = damping + loss
        for law, collision in self.ledger.open.items():
            collision.impulse += sum(window.impulse(law, i, tau) for i in range(first, last))
        return np.column_stack([input_, damping, lost])

    def _first_event(
        self, window: Window, t: Array, value: Array, rate: Array, second: Array
    ) -> tuple[float, int, int] | None:
        row, (a, b, c) = self.exit_row, self.exit_factors
        g, slope = a[:, None] * value[row] + c[:, None], a[:, None] * rate[row]
        if self.bending:
            g += b[:, None] * rate[row]
            slope += b[:, None] * second[row]
        scale = np.abs(a) * self.largest[0, row] + np.abs(b) * self.largest[1, row] + np.abs(c)
        tol = STILL * np.maximum(scale, np.abs(g[:, :2]).max(axis=1))[:, None]

        def exact(n: int, tau: float) -> tuple[float, float]:
            d, v, w = window.at(int(row[n]), tau)
            return float(a[n] * d + b[n] * v + c[n]), float(a[n] * v + b[n] * w)

        found = search.first_rise(t, g, slope, tol, exact)
        return None if found is None else (found[0], *self.exit_pairs[found[1]])

    def _switch(self, law: int, exit_index: int, d: float, v: float) -> None:
        self.events += 1
        before = self.branches[law].name
        try:
            if self.laws[law].law.rigid and not self.branches[law].held:
                self._meet()
            else:
                self._leave(law, exit_index, d, v)
                self._press()
        except ArithmeticError as err:
            raise self.stop("A503", str(err)) from None
        after = self.branches[law]
        if self.same_instant > 50 + 4 * self.n_laws:
            s = self.laws[law]
            raise self.stop(
                "A503",
                f"{self.same_instant} changes at one instant, "
                f"the last in element {s.element} ({s.rule}): {before} to {after.name}",
            )
        self._form()

    def _leave(self, law: int, exit_index: int, d: float, v: float) -> None:
        before = self.branches[law].name
        self.states[law] = self.laws[law].law.leave(self.states[law], exit_index, d, v)
        after = self.branches[law] = self.laws[law].branch(self.states[law])
        force = self.laws[law].force(self.states[law], d, v)
        self.ledger.switched(law, before, after.name, self.t, d, v, force)
        self.ledger.peaks.force[law].take(force, self.t)

    def _inputs(self) -> Array:
        """Inputs and their first two derivatives just after now, shape (3, n_inputs)."""
        ex = self.scene.excitation
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
        done = float(impulse @ (r.inputs @ s[1]))  # by supports that move
        self.works = self.works + np.array([done, 0.0, lost.sum()])
        self.put_in += abs(done)
        still = touching & (after >= -NOISE * fastest)
        for i, law in enumerate(r.laws):
            self.ledger.peaks.dashpot_losses[law] += float(lost[i])
            if not held[i] and (still[i] or impulse[i] > 0.0):
                self._leave(law, 0, float(d[i]), float(rates[i]))
            if law in self.ledger.open:
                self.ledger.open[law].impulse += float(impulse[i])
            if self.branches[law].held and not still[i]:
                if not held[i]:
                    self.ledger.open[law].peak = np.nan  # beyond all numbers
                self._leave(law, 0, float(d[i]), float(after[i]))
        self._press()
        self.partition.blocks = []  # the velocities have jumped

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
        size = size + self.partition.fastest * (np.abs(r.rows) @ np.abs(self.v))
        force = r.plastic(free, held)
        parting = held & (force == 0.0) & (free - r.compliance @ force < -NOISE * size)
        for i in np.flatnonzero(parting).tolist():
            d, v = r.rows[i] @ self.u + r.inputs[i] @ s[0], r.rows[i] @ self.v + r.inputs[i] @ s[1]
            self._leave(r.laws[i], 0, float(d), float(v))
        rows = [self.partition.force_row[i] for i in r.laws]
        self.largest[0, rows] = np.maximum(self.largest[0, rows], size / np.diag(r.compliance))

    def _peaks(self, window: Window, t: Array, value: Array, rate: Array, second: Array) -> None:
        n, peaks = self.n_laws, self.ledger.peaks
        if n:
            np.maximum(self.largest, np.abs([value, rate]).max(axis=2), out=self.largest)
        linear = [*peaks.deformation, *peaks.watch]
        m = len(linear)
        search.widen(linear, self.t, t, value[:m], rate[:m], lambda i, x: window.at(i, x)[:2])
        # forces of springs, and of contacts that are pressed: those go to the collision that runs
        acting = [i for i, spring in enumerate(self.laws) if not spring.is_contact or i in self.ledger.open]
        if not acting:
            return
        k, c, f0 = (
            np.array([getattr(self.branches[i], x) for i in acting])[:, None]
            for x in ("stiffness", "damping", "force0")
        )
        c *= np.array([[self.laws[i].is_contact] for i in acting])  # a spring's force is without damping
        held = np.array([self.branches[i].held for i in acting])
        k[held] = 1.0
        rows = [self.partition.force_row[i] if x else i for i, x in zip(acting, held.tolist())]

        def exact(i: int, tau: float) -> tuple[float, float]:
            d, v, w = window.at(rows[i], tau)
            return float(k[i, 0] * d + c[i, 0] * v + f0[i, 0]), float(k[i, 0] * v + c[i, 0] * w)

        force, slope = k * value[rows] + c * rate[rows] + f0, k * rate[rows] + c * second[rows]
        running = self.ledger.open
        targets = [self.ledger.running(i) if i in running else peaks.force[i] for i in acting]
        search.widen(targets, self.t, t, force, slope, exact)
        for i, collision in running.items():
            peaks.force[i].take(collision.peak, collision.t_peak)

    def outcome(self) -> Outcome:
        """What the run gathered."""
        flows = [r.flow for r in self.partition.regimes.values()]
        residual, condition = (
            max((f.residual for f in flows), default=0.0),
            max((f.condition for f in flows), default=1.0),
        )
        figures = {
            "method": "EXACT, event-driven",
            "events": self.events,
            "windows": self.windows,
            "linear regimes": len(flows),
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
        if any(isinstance(f, SeriesFlow) for f in flows):
            checks.append(("defective modes, integrated by the exponential series", "present", "good"))
        return Outcome(self.ledger.close(), figures, tuple(self.states), checks, exact=True)

    def stop(self, code: str, why: str) -> Stop:
        """The exception that ends the run here."""
        return Stop(code, self.t, why, self.outcome())


class Whole:
    """Hands samples on with all unknowns, condensed ones too."""

    def __init__(self, sink: Sink, small: Condensed) -> None:
        self.sink, self.small, self.at_start = sink, small, small.put_in(np.zeros(1))

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.base.Sink`)."""
        ex = self.small.scene.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        if not self.small.scene.total:  # the total form counts the work on all freedoms
            works = works.copy()
            works[0] += self.small.put_in(t) - self.at_start
        self.sink.sample(t, u, v, a, laws, works)

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion between samples (see `integrate.base.Sink`)."""
        ex = self.small.scene.excitation
        u, v, a = (self.small.all(x, ex.values(t, order).T, order) for order, x in enumerate((u, v, a)))
        self.sink.between(t, u, v, a, apart)

    def trial(self, t: float, doing: str = "") -> None:
        """Pass it on."""
        self.sink.trial(t, doing)


def condensed(scene: Scene, start: Start, watch: Watch, sink: Sink) -> tuple[Scene, Start, Watch, Sink]:
    """What a method is given that works on full matrices: no massless freedoms that follow the others."""
    small = condense(scene)
    return (
        small.scene,
        replace(start, u=start.u[small.keep], v=start.v[small.keep]),
        Watch(
            watch.names,
            watch.rows @ small.expand,
            watch.input_rows + watch.rows @ small.follow,
            watch.constants + watch.rows @ small.constant,
        ),
        sink if len(small.keep) == scene.size else Whole(sink, small),
    )


def integrate(scene: Scene, start: Start, watch: Watch, options: Mapping[str, Any], sink: Sink) -> Outcome:
    """Integrate a scene exactly; see the module's head.

    Raises
    ------
    Stop
        Too many changes at one instant, a mechanism, numbers beyond all bounds, or an interrupt.
    CostlyError
        It costs more than COST, or takes more than REGIMES, of the options; no deck sets them.
    """
    if why := not_linear(scene):
        why = f"EXACT needs linear pieces, and {why}: AUTO takes steps"
        raise Stop("A505", float(start.times[0]), why)
    scene, start, watch, sink = condensed(scene, start, watch, sink)
    try:
        run = Exact(scene, start, watch, options, sink)
    except Weightless as err:
        raise Stop("A505", float(start.times[0]), str(err)) from None
    try:
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
    reference="after Nigam & Jennings 1969, for many freedoms and events",
    impl=integrate,
)
