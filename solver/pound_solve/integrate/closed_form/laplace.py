r"""LAPLACE: the response between events by a numerical Laplace transform.

A structure that is linear between events, including soil and foundation, is transformed starting from its
present state (:mod:`.laplace_transform`).  The earliest event ends the window: the law changes its branch,
and the next window starts from the state at the event.  Chouw (2002) treats buildings, their contact and
the soil in this way.

Apart from the transforms of the polynomial pieces of the excitation, which are exact, the method has
nothing in common with EXACT.  It is a check of EXACT, not an alternative to it.

References
----------
Chouw N (2002), Influence of soil-structure interaction on pounding response of adjacent buildings due to
near-source earthquakes, J. Applied Mechanics JSCE 5: 543-553.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate.closed_form.event_loop import EventDrivenRun
from pound_solve.integrate.closed_form.hermite import SampledMotion, SampledRows, simpson
from pound_solve.integrate.closed_form.laplace_transform import DynamicStiffness, LaplaceTransform
from pound_solve.integrate.closed_form.search import CERTAIN
from pound_solve.integrate.condensed import condensed
from pound_solve.integrate.energy import law_values
from pound_solve.integrate.events import grid
from pound_solve.integrate.events.functions import EventFunctions, monitored_functions
from pound_solve.integrate.propagators.state_space import Mechanism
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    MAX_CHANGES,
    MAX_CHANGES_PER_LAW,
    Course,
    Motion,
    Outcome,
    Problem,
    Recorder,
    Stop,
    reason_not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.rigid.contacts import linear_forces
from pound_solve.integrate.tolerances import COUNT_ROUNDING
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Index

TRANSFORM_TOLERANCE = 1e-10  #: in place of `EVENT_TOLERANCE`: the transforms have ten digits
SAME_INSTANT_OF_TRANSFORMS = 1e-12  #: in place of `SAME_INSTANT`
MAX_NUMBERS = 6e7  #: largest number of complex values in all stored dynamic stiffnesses: 1 GB


class Laplace(EventDrivenRun):
    """One run; see the module's head."""

    def __init__(self, problem: Problem[Recorder], options: Mapping[str, Any]) -> None:
        super().__init__(problem)
        self.dt, self.points = options["DT"], 2 * (options["POINTS"] // 2)
        self.transform = LaplaceTransform(self.system, self.dt, self.points)
        self.with_mass = np.flatnonzero(~massless(self.system.mass))
        self.transforms = self.combinations = 0
        self._since, self._changes = self.t, 0
        self._stiffnesses: dict[tuple[float, ...], DynamicStiffness] = {}

    def run(self) -> Outcome:  # noqa: D102
        self.tracker.begin(self.system, self.t, self.u, self.v, self.branches)
        first, end = True, float(self.times[-1])
        while first or end - self.t > 1e-12 * max(1.0, end):
            self._advance(end, first)
            first = False
        return self.outcome()

    def _constant(self) -> Array:
        """Return the constant loads: those of the system, and the constants of the laws."""
        f0 = np.array([x.force0 for x in self.branches])
        return np.asarray(self.system.constant - self.system.law_rows.T @ f0)

    def _stiffness(self) -> DynamicStiffness:
        """Return the dynamic stiffness of the present branches, from a cache."""
        key = tuple(x for b in self.branches for x in (b.stiffness, b.damping))
        if key not in self._stiffnesses:
            system, b = self.system, self.system.law_rows
            k = np.array([x.stiffness for x in self.branches])
            c = np.array([x.damping for x in self.branches])
            try:
                dynamic = self.transform.dynamic_stiffness(
                    system.damping + (b.T * c) @ b, system.stiffness + (b.T * k) @ b
                )
            except Mechanism as err:
                worst = int(np.argmax(np.abs(err.shape)))
                raise self.stop("A501", system.explain_massless(worst, err.softens)) from None
            fastest = dynamic.spectral_radius
            if fastest * self.dt > 1.0:
                why = "DT={:g} does not resolve the fastest mode, {:.4g} rad per unit of time: {:.3g} does"
                raise self.stop("A502", why.format(self.dt, fastest, 0.5 / fastest))
            while self._stiffnesses and (1 + len(self._stiffnesses)) * dynamic.inverse.size > MAX_NUMBERS:
                del self._stiffnesses[next(iter(self._stiffnesses))]  # the oldest
            self._stiffnesses[key] = dynamic
            self.combinations += 1
        return self._stiffnesses[key]

    def _accelerations(self, u: Array, v: Array, s: Array) -> Array:
        """Return accelerations from the equations of motion, one column per instant."""
        x, h = self._stiffness(), self.with_mass
        accelerations = np.zeros_like(u)
        force = (self.system.inputs @ s - x.damping @ v - x.stiffness @ u) + self._constant()[:, None]
        accelerations[h] = np.linalg.solve(self.system.mass[np.ix_(h, h)], force[h])
        return accelerations

    def _transformed(self, end: float) -> tuple[SampledMotion, SampledRows]:
        """Return motion and rows at the samples up to the middle of the window, or to the first beyond
        `end`.
        """
        u, v = self.transform.response(self._stiffness(), self._constant(), self.t, self.u, self.v)
        self.transforms += 1
        count = min(u.shape[1], int(np.ceil((end - self.t) / self.dt * (1 - COUNT_ROUNDING))) + 1)
        t = self.dt * np.arange(count)
        u, v = u[:, :count], v[:, :count]
        inputs = [self.system.excitation.values(self.t + t, order).T for order in range(3)]
        a = self._accelerations(u, v, inputs[0])
        value, rate, second = (self.rows.rows @ x + self.rows.inputs @ s for x, s in zip((u, v, a), inputs))
        value += self.rows.constants[:, None]
        if not np.isfinite(value).all():
            raise self.stop("A504", "the response overflowed: the motion grows without bound")
        return SampledMotion(self.dt, u, v, a), SampledRows(t, value, rate, second)

    def _advance(self, end: float, first: bool) -> None:
        """Advance to the next event, to the middle of the window, or to the end."""
        motion, rows = self._transformed(end)
        span = min(float(rows.t[0, -1]), end - self.t)
        functions = EventFunctions(self.branches, {})
        self.largest = self.reaching(self.u)
        largest = self.reaching(np.abs(motion.u).max(axis=1))
        earliest = functions.first_event(rows, largest, TRANSFORM_TOLERANCE, self.contacts)
        event = None if earliest is None or earliest.event.time >= span else earliest.event
        certain = CERTAIN * TRANSFORM_TOLERANCE
        event = functions.violated(rows, self.largest, certain, self._on_massless) or event
        tau = span if event is None else event.time
        if first:
            self._sample(self.t, motion.u[:, 0], motion.v[:, 0], motion.a[:, 0], self.energy.array())
        self._samples(motion, tau)
        self._show(motion, tau)
        ends = rows.all_at(self.dt, tau)
        self._count_peaks(rows.until(tau, ends))
        self.u, self.v = motion.at(tau)
        self.count_change(tau, SAME_INSTANT_OF_TRANSFORMS)
        self.t += tau
        if event is not None:
            self.events += 1
            self.change(event.law, event.event_index, ends[0], ends[1])
            self.stop_chatter(event.law, "EXACT")
            self._stop_crowd()
        hint = f" as samples {self.dt:g} apart see it: is DT too long for the excitation?"
        self.stop_growth(self.v, hint)

    def _stop_crowd(self) -> None:
        """Stop if events are so close that the samples do not resolve the motion between them."""
        if self.t - self._since > self.dt:
            self._since, self._changes = self.t, 0
        self._changes += 1
        if self._changes > MAX_CHANGES + MAX_CHANGES_PER_LAW * len(self.laws):
            why = f"{self._changes} changes of branch within one DT, each of which takes a transform"
            raise self.stop("A503", f"{why}: try a shorter DT, or METHOD=EXACT")

    def _samples(self, motion: SampledMotion, tau: float) -> None:
        """Add the work up to the local time `tau`, and sample the output times before it."""
        chosen = self.times[(self.times > self.t) & (self.times <= self.t + tau * (1 + 1e-13))]
        works, at = [self.energy.array()], 0.0
        for goal in chosen.tolist():
            works.append(works[-1] + self._work(at, goal - self.t, motion))
            at = goal - self.t
            u, v = motion.at(at)
            s = self.system.excitation.values(np.array([goal]), before=True)[0]
            a = self._accelerations(u[:, None], v[:, None], s[:, None])[:, 0]
            self._sample(goal, u, v, a, works[-1])
        works.append(works[-1] + self._work(at, tau, motion))
        self.energy.advance(np.array(works))

    def _show(self, motion: SampledMotion, tau: float) -> None:
        """Pass the motion up to the local time `tau` to the recorder."""
        begin = np.asarray(motion.h * np.arange(int(np.ceil(tau / motion.h * (1 - COUNT_ROUNDING)))), float)
        if not len(begin):
            return
        lengths = np.diff(begin, append=tau)

        def at(t: Array) -> Motion:
            u, v = motion.at_times(t)
            a = self._accelerations(u, v, self.system.excitation.values(self.t + t).T)
            return self._with_forces(self.t + t, u, v, a)

        def within(cells: Index, shares: Array) -> Motion:
            return at((begin[cells, None] + lengths[cells, None] * shares).ravel())

        self.recorder.between(Course(at(begin), lengths, within))

    def _with_forces(self, t: Array, u: Array, v: Array, a: Array) -> Motion:
        """Return the motion at some times with the forces of the laws in `Recorder.enveloped_laws`."""
        system, enveloped_laws = self.system, self.recorder.enveloped_laws
        s, ds = (system.excitation.values(t, order).T for order in (0, 1))
        d = system.law_rows[enveloped_laws] @ u + system.law_inputs[enveloped_laws] @ s
        rate = system.law_rows[enveloped_laws] @ v + system.law_inputs[enveloped_laws] @ ds
        return Motion(t, u, v, a, linear_forces([self.branches[i] for i in enveloped_laws])(d, rate))

    def _work(self, begin: float, end: float, motion: SampledMotion) -> Array:
        """Return the energy input and the energy lost in dashpots between two local times, shape (3,), by
        Simpson's rule on the cubics between samples; also add the losses and impulses of the laws.
        """
        if end <= begin:
            return np.zeros(3)
        system = self.system
        t, weight = simpson(self.dt, begin, end)
        u, v = motion.at_times(t)
        s, ds = (system.excitation.values(self.t + t, order).T for order in (0, 1))
        d, rate = system.law_rows @ u + system.law_inputs @ s, system.law_rows @ v
        rate = rate + system.law_inputs @ ds
        power = ((system.inputs @ s + system.constant[:, None]) * v).sum(axis=0)
        damping, lost = float((v * (system.damping @ v)).sum(axis=0) @ weight), 0.0
        for law, branch in enumerate(self.branches):
            loss = float(branch.damping * rate[law] ** 2 @ weight)
            self.energy.dashpot_losses[law] += loss
            if self.laws[law].role.collides:
                lost += loss
            else:
                damping += loss
            if law in self.tracker.open:
                force = branch.stiffness * d[law] + branch.damping * rate[law] + branch.force0
                self.tracker.open[law].impulse += float(force @ weight)
        return np.array([float(power @ weight), damping, lost])

    def _count_peaks(self, rows: SampledRows) -> None:
        """Include samples in magnitudes and peaks."""
        n = len(self.laws)
        self.count_magnitudes(rows.value[:n, 0], rows.rate[:n, 0])
        monitored, peaks = monitored_functions(self.tracker, self.branches, {})
        grid.update_by_extremes(peaks, self.t, rows.t, *monitored.sampled(rows), monitored.evaluator(rows))
        self.count_collision_peaks()

    def _sample(self, t: float, u: Array, v: Array, a: Array, works: Array) -> None:
        """Pass one sample to the recorder."""
        at, (u, v, a) = np.array([t]), np.stack([u, v, a])[:, :, None]
        laws = law_values(self.system, at, u, v, self.states)
        self.recorder.sample(at, u, v, a, laws, works[:, None])

    def outcome(self) -> Outcome:  # noqa: D102
        figures = {
            "method": f"LAPLACE, {self.points} samples {self.dt:g} apart",
            "events": self.events,
            "transforms": self.transforms,
            "combinations of stiffnesses": self.combinations,
        }
        peaks = self.tracker.close(self.energy.dashpot_losses)
        checks = [*rounding_check(self.laws, peaks, TRANSFORM_TOLERANCE), *self.uniqueness.checks()]
        return Outcome(peaks, figures, tuple(self.states), checks)


def refuse_large(unknowns: int, points: int, t: float) -> None:
    """Raise `Stop` at time `t` if one dynamic stiffness does not fit into memory."""
    frequencies = points // 2 + 1
    if unknowns**2 * frequencies > MAX_NUMBERS:
        size = 16e-9 * unknowns**2 * frequencies
        why = (
            f"LAPLACE inverts the matrix of {unknowns} unknowns at {frequencies} frequencies, {size:.3g} GB"
        )
        raise Stop("A505", t, f"{why}: METHOD=EXACT needs one matrix")


def integrate(problem: Problem[Recorder], options: Mapping[str, Any]) -> Outcome:
    """Integrate a reduced system by numerical Laplace transforms; see the module docstring.

    Raises
    ------
    Stop
        The reduced system is not piecewise linear, is too large or has supports that move differently; DT
        does not resolve the system or its events; or there was a mechanism, an overflow, or an interrupt.
    """
    refuse_rigid(problem, "LAPLACE")
    system = problem.system
    if why := reason_not_linear(system) or (
        "the supports move apart from each other" if system.total else ""
    ):
        raise Stop("A505", problem.begin, f"LAPLACE cannot take this: {why}; AUTO can")
    problem = condensed(problem, "LAPLACE")
    refuse_large(problem.system.size, options["POINTS"], problem.begin)
    run = Laplace(problem, options)
    try:
        return run.run()
    except KeyboardInterrupt:
        raise run.stop("A506", INTERRUPTED) from None


SPEC = Spec(
    "method",
    "LAPLACE",
    "numerical Laplace transform between events",
    (
        Field("DT", Kind.REAL, "T", above=0, doc="sampling interval"),
        Field("POINTS", Kind.INT, default=4096, lo=16, hi=1_000_000, doc="samples per transform"),
    ),
    reference="after Chouw 2002; Wilcox 1978",
    impl=integrate,
)
