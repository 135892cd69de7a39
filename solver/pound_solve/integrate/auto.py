r"""AUTO: EXACT or TAYLOR where they cost less, else NEWMARK with the step that meets a tolerance.

EXACT needs no step, but piecewise linear laws, and every new combination of stiffnesses costs it a modal
decomposition.  TAYLOR has no truncation error either; its steps resolve the fastest mode.  With NEWMARK the
whole run is repeated with a shorter step until the peaks no longer change, or until shorter steps bring no
improvement (a force that rings at a node without mass): if between two runs, of which the second takes r
times the steps of the first, the peaks differ by :math:`\Delta`, the error left in the second is estimated
as :math:`\Delta/(r-1)`, as if the method were of first order only.  It is of second order, so that the
estimate is conservative.

The cost of TAYLOR is known in advance; that of EXACT depends on the events.  Where few laws change
stiffness, and a handful of decompositions does not cost more than TAYLOR, EXACT starts with a small budget.
If that does not suffice, TAYLOR is used where it costs little, or no more than the NEWMARK runs to come;
before each of these EXACT may cost as much as they do, if it would complete the run at its rate so far.
Costs are counted from windows, decompositions, steps and unknowns (:mod:`.costs`), not measured, so that a
deck is always solved in the same way.

The runs are compared by the largest and smallest value of every drift, relative to the larger of the two
(but at least a millionth of the largest drift: smaller values may be rounding, which never converges), and
by the peak force of every contact, relative to itself (but at least a twentieth of the largest contact
force); without drifts, by the deformations of all springs in the same way, and all displacements relative
to the largest in their direction.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate import condensed, costs
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    EnvelopeRecorder,
    LawValues,
    MonitoredOutputs,
    Outcome,
    Start,
    Stop,
    goals,
    not_in_series,
    not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.reduction import Decision, ReducedSystem

# EXACT before any steps
FIRST_BUDGET = 1.0  #: what it may cost: loading the kernels of steps costs as much
FIRST_CHECK = 0.3  #: share of that after which its progress is checked
#: the same as a share of what TAYLOR would cost, if that is less, but not less than the other
TRIAL_SHARE, LEAST_TRIAL = 0.25, 0.05
EXPECTED_DECOMPOSITIONS = 12  #: of all unknowns together, that a run is assumed to need
#: decompositions that EXACT may make within that budget (where combinations of stiffnesses do not return,
#: more will come), and laws from which on it is assumed to need more (combinations seldom return); both for
#: the tolerance REFERENCE_TOL: for a smaller one they grow with the root, as the steps do
MAX_DECOMPOSITIONS, MAX_LAWS, REFERENCE_TOL = 40, 12, 1e-3
# EXACT and TAYLOR before a run with steps
LATER_BUDGET = 4.0  #: times the cost of that run, where shorter steps are to come
LATER_CHECK = 0.1  #: share of the budget after which the progress of EXACT is checked
SERIES_FIRST = 1.0  #: cost up to which TAYLOR is taken before any steps: it has no error to be estimated
# runs with steps
MAX_STEPS = 50_000_000  #: of one run
MAX_RETRY_COST = 20.0  #: of a run that follows one that stopped
MAX_STALE_RUNS = 4  #: runs in a row that do not halve the error, after which shorter steps are given up
SAFETY = 0.6  #: of the tolerance, that the next step aims at

#: why no steps are taken
LINEAR = "all laws are piecewise linear, so no time step is needed; stepping would cost more"
SERIES = "all forces have power series between events, so no time step is needed; stepping would cost more"
RIGID = "steps take no rigid contacts"
GIVEN_UP = ("the most that are tried", "nor nearer than with far fewer")  #: why no shorter steps are tried


class Replay:
    """Keeps the samples of a run, to pass them on if it is the final one; knows the extremes of u.

    Of the motion between the samples only the envelopes are kept.
    """

    def __init__(self, recorder: EnvelopeRecorder) -> None:
        self.recorder, self.samples = recorder, list[tuple[Any, ...]]()
        self.envelopes = recorder.envelopes.blank()
        self.high: Array | float = -np.inf
        self.low: Array | float = np.inf

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `Recorder`)."""
        self.samples.append((t, u, v, a, laws, works))
        self.high = np.maximum(self.high, u.max(axis=1))
        self.low = np.minimum(self.low, u.min(axis=1))
        self.recorder.trial(float(t[-1]))

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion between samples (see `Recorder`)."""
        self.envelopes.between(t, u, v, a, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Take displacements at stationary points (see `Recorder`)."""
        self.envelopes.stationary(t, u)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` needs (see `Recorder`)."""
        return self.recorder.shown

    def trial(self, t: float, doing: str = "") -> None:
        """Pass the progress of a trial on."""
        self.recorder.trial(t, doing)

    def pass_on(self) -> None:
        """Pass everything on to the recorder."""
        self.recorder.envelopes.widen(self.envelopes)
        for sample in self.samples:
            self.recorder.keep(*sample)


def has_series(system: ReducedSystem) -> bool:
    """Return whether TAYLOR is applicable."""
    return not not_in_series(system) and provider().fast


def cost_of_radian(system: ReducedSystem) -> float:
    """Return the cost of a run that resolves the fastest mode, per radian of it."""
    if has_series(system):
        return costs.of_series_radian(system)
    return costs.RADIAN_STEPS * costs.of_step(system)


def cost_of_series(system: ReducedSystem, start: Start) -> float:
    """Return the cost of TAYLOR; infinite where it is not applicable."""
    if not has_series(system):
        return np.inf
    count = costs.TAYLOR_RADIANS * len(goals(system, start.times)[0])  # each is the end of a step
    length = float(start.times[-1] - start.times[0])
    return costs.of_series_radian(system) * (length * costs.fastest_rate(system) + count)


class ExactTrial:
    """EXACT within a budget.

    Attributes
    ----------
    cost : float
        Least cost of the whole run, as far as known.
    """

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        recorder: EnvelopeRecorder,
        tol: float,
    ) -> None:
        self.system, self.start, self.monitored, self.recorder = system, start, monitored, recorder
        self.ease = max(REFERENCE_TOL / tol, 1.0) ** 0.5
        self.cost = FIRST_BUDGET if len(system.structure.laws) > self.ease * MAX_LAWS else 0.0
        if not_linear(system) or system.size > condensed.MAX_UNKNOWNS:
            self.cost = np.inf

    def first(self, other: float) -> Outcome | None:
        """Return its run within `FIRST_BUDGET`, or, if it costs no more, that of resolving the fastest
        mode; None where it exceeds them or needs many decompositions.  Another method costs `other`.
        """
        count = min(1 + len(self.system.structure.laws), EXPECTED_DECOMPOSITIONS)
        if count * costs.of_decomposition(self.system.size) > FIRST_BUDGET + other:
            return None
        limits = {
            "DECOMPOSITIONS": self.ease * MAX_DECOMPOSITIONS,
            "PER_RADIAN": cost_of_radian(self.system),
            "TRIAL": min(FIRST_CHECK * FIRST_BUDGET, max(LEAST_TRIAL, TRIAL_SHARE * other)),
        }
        return self.run(FIRST_BUDGET, limits)

    def run(self, budget: float, limits: Mapping[str, float]) -> Outcome | None:
        """Return its run within a budget and other limits (see `exact.integrate`), or None."""
        if self.cost >= budget:
            return None
        replay, decisions = Replay(self.recorder), self.system.decisions
        known = len(decisions)
        try:
            outcome = exact.integrate(
                self.system, self.start, self.monitored, {"COST": budget, **limits}, replay
            )
        except costs.CostlyError as err:
            del decisions[known:]
            begin, *_, end = self.start.times
            self.cost = err.cost * ((end - begin) / (err.t - begin) if err.t > begin else 1.0)
            return None
        except Stop:
            replay.pass_on()
            raise
        decisions.insert(known, Decision("method", "EXACT", LINEAR))
        replay.pass_on()
        return outcome


def figures(system: ReducedSystem, peaks: Peaks, replay: Replay) -> tuple[Array, Array]:
    """Return the peaks that are compared between runs, and the scales of their differences."""
    laws = system.structure.laws
    contacts = [i for i, s in enumerate(laws) if s.role.collides]
    force = np.array([max((c.peak for c in peaks.collisions if c.law == i), default=0.0) for i in contacts])
    springs = [e for e, s in zip(peaks.deformation, laws) if not s.role.collides]
    extremes: list[Extreme] = peaks.monitored or springs
    values = np.array([(e.high, e.low) for e in extremes]).reshape(-1, 2)
    size = np.repeat(np.abs(values).max(axis=1), 2)
    if not peaks.monitored:
        direction = np.array([d for _, d in system.dofs])
        displacement = np.column_stack([np.ravel(replay.high), np.ravel(replay.low)])
        # hinges and uplift have directions of their own
        most = {d: np.abs(displacement[direction == d]).max() for d in np.unique(direction).tolist()}
        largest = np.array([most[d] for d in direction.tolist()])
        values = np.concatenate([values, displacement])
        size = np.append(size, np.repeat(largest, 2))
    scales = [np.maximum(x, share * x.max(initial=0.0)) for x, share in ((size, 1e-6), (force, 0.05))]
    return np.concatenate([np.ravel(values), force]), np.concatenate(scales)


def stepped(system: ReducedSystem) -> Decision:
    """Return the decision that steps were taken."""
    reason = not_linear(system) or "EXACT would cost more: too many unknowns or changes of stiffness"
    return Decision("method", "NEWMARK", f"{reason}; steps are shortened until the peaks converge")


def hopeless(stop: Stop, start: Start, step_cost: float) -> bool:
    """Return whether a run with a quarter of the step of one that stopped would cost more than
    `MAX_RETRY_COST`.
    """
    begin, *_, end = start.times
    done = stop.outcome.figures if stop.outcome else {"steps": 0, "events": 0}
    cost = step_cost * (done["steps"] + costs.EVENT_STEPS * done["events"])
    return bool(4.0 * cost * (end - begin) > MAX_RETRY_COST * (stop.t - begin))


class Comparison(NamedTuple):
    """A run with its figures, to compare the next one with."""

    steps: int
    peaks: Array


class StepRefinement:
    """Runs of NEWMARK with shorter and shorter steps, until the peaks converge.

    Attributes
    ----------
    h : float
        Step of the next run [T].
    aim : float
        Step that is likely to meet the tolerance [T].
    error : float
        Estimate for the last run.
    """

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        recorder: EnvelopeRecorder,
        tol: float,
    ) -> None:
        self.system, self.start, self.monitored, self.recorder = system, start, monitored, recorder
        self.tol, self.length = tol, float(start.times[-1] - start.times[0])
        intervals = np.diff(goals(system, start.times)[0], prepend=start.times[0])
        self.h = self.aim = min(float(np.median(intervals)), self.length / 1000)
        self.step_cost = costs.of_step(system) * (1 if provider().fast else costs.INTERPRETED)
        self.error = self.best = np.inf
        self.runs = self.events = self.stale = 0
        self.before: Comparison | None = None
        self.complete: tuple[Outcome, Replay] | None = None  # the last run that was completed

    def cost_ahead(self, most: float = np.inf) -> float:
        """Return the cost of the run that is likely to meet the tolerance, or of `most` next runs."""
        steps = min(self.length / self.aim, most * self.length / self.h)
        return self.step_cost * (steps + costs.EVENT_STEPS * self.events)

    def run(self) -> Outcome | None:
        """Run once; return the outcome if no run follows, else None with the next step chosen.

        Raises
        ------
        Stop
            The run stopped, and not because its step was too long.
        """
        from pound_solve.integrate.stepping import newmark  # where no steps are taken it is not loaded

        replay = Replay(self.recorder)
        options = {"DT": self.h, "BETA": 0.25, "GAMMA": 0.5}
        try:
            outcome = newmark.integrate(self.system, self.start, self.monitored, options, replay)
        except Stop as stop:
            self._retry(stop, replay)
            return None
        self.runs += 1
        self.complete = outcome, replay
        peaks, scales = figures(self.system, outcome.peaks, replay)
        steps, self.events = outcome.figures["steps"], outcome.figures["events"]
        if self._converged(steps, peaks, scales):
            self.system.decisions.append(stepped(self.system))
            replay.pass_on()
            outcome.figures = {**outcome.figures, "runs": self.runs}
            outcome.checks = self.checks(outcome, GIVEN_UP[self.stale == MAX_STALE_RUNS])
            return outcome
        self.before = Comparison(steps, peaks)
        likely = float(np.sqrt(SAFETY * self.tol / self.error)) if np.isfinite(self.error) else 0.5
        self.aim = self.h * likely
        self.h = float(np.clip(self.aim, self.h / 4, self.h / 2))
        self.aim = min(self.aim, self.h)
        return None

    def _converged(self, steps: int, peaks: Array, scales: Array) -> bool:
        """Estimate the error of a run; return whether no shorter steps follow."""
        if self.before is None or steps <= self.before.steps:
            return False
        relative = np.abs(peaks - self.before.peaks) / np.where(scales > 0.0, scales, 1.0)
        self.error = float(relative.max(initial=0.0)) / (steps / self.before.steps - 1.0)
        self.stale = 0 if self.error < 0.5 * self.best else self.stale + 1
        self.best = min(self.best, self.error)
        too_many = self.length / self.h * 2.0 > MAX_STEPS
        return self.error <= self.tol or self.stale == MAX_STALE_RUNS or too_many

    def _retry(self, stop: Stop, replay: Replay) -> None:
        """Shorten the step after a run that stopped, or stop."""
        # A503 says nothing of the structure where the step is coarse, growth only if a finer step grows too
        coarse = stop.code == "A503" or (stop.code == "A504" and self.before is None)
        if coarse and self.h > 1e-6 * self.length and not hopeless(stop, self.start, self.step_cost):
            self.h, self.before = 0.25 * self.h, None
            self.aim = self.h
            self.events = max(self.events, stop.outcome.figures["events"] if stop.outcome else 0)
            return
        self.system.decisions.append(stepped(self.system))
        if stop.code == "A506" and self.complete is not None:
            outcome, replay = self.complete
            stop = Stop("A506", float(self.start.times[-1]), INTERRUPTED, outcome)
            outcome.checks = self.checks(outcome, "interrupted")
        replay.pass_on()
        raise stop from None

    def checks(self, outcome: Outcome, ended: str) -> list[tuple[str, str, str]]:
        """Return checks beyond those of a single run; `ended` is why no shorter steps follow."""
        steps, met = outcome.figures["steps"], self.error <= self.tol
        verdict = "met" if met else f"look: not met with {steps} steps, {ended}"
        return [
            (
                f"estimated error of drifts and contact forces, TOL {self.tol:g}",
                f"{self.error:.1e}",
                verdict,
            ),
            *rounding_check(self.system.structure.laws, outcome.peaks),
        ]


def by_series(
    system: ReducedSystem, start: Start, monitored: MonitoredOutputs, recorder: EnvelopeRecorder
) -> Outcome:
    """Run TAYLOR, and state why."""
    from pound_solve.integrate.series import taylor  # where it is not needed it is not loaded

    rigid = any(s.law.rigid for s in system.structure.laws)
    system.decisions.append(Decision("method", "TAYLOR", RIGID if rigid else SERIES))
    return taylor.integrate(system, start, monitored, {}, recorder)


def to_tolerance(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: EnvelopeRecorder,
    trial: ExactTrial,
    series: float,
) -> Outcome:
    """Repeat the run with shorter steps until the peaks converge, or EXACT costs less, or TAYLOR, which
    costs `series`.
    """
    steps = StepRefinement(system, start, monitored, recorder, options["TOL"])
    while True:
        if series <= max(SERIES_FIRST, steps.cost_ahead()):
            return by_series(system, start, monitored, recorder)
        budget = steps.cost_ahead(LATER_BUDGET)
        if (outcome := trial.run(budget, {"TRIAL": LATER_CHECK * budget})) is not None:
            return outcome
        if (outcome := steps.run()) is not None:
            return outcome


def integrate(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: EnvelopeRecorder,
) -> Outcome:
    """Choose a method, state why, and run it."""
    rigid = any(s.law.rigid for s in system.structure.laws)
    if not_linear(system):
        refuse_rigid(system, start, "AUTO")
    elif rigid and not has_series(system):
        system.decisions.append(Decision("method", "EXACT", RIGID))
        return exact.integrate(system, start, monitored, {}, recorder)
    trial = ExactTrial(system, start, monitored, recorder, options["TOL"])
    series = cost_of_series(system, start)
    if (outcome := trial.first(series)) is not None:
        return outcome
    if rigid:
        return by_series(system, start, monitored, recorder)
    return to_tolerance(system, start, monitored, options, recorder, trial, series)


SPEC = Spec(
    "method",
    "AUTO",
    "EXACT where it pays, else steps that meet a tolerance",
    (
        Field(
            "TOL",
            Kind.REAL,
            "-",
            default=1e-4,
            lo=1e-9,
            hi=0.1,
            doc="largest error of drifts and contact forces as a share of their peaks, if steps are taken",
        ),
    ),
    impl=integrate,
)
