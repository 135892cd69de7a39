r"""AUTO: EXACT or TAYLOR where they cost less, else NEWMARK with the step that meets a tolerance.

EXACT needs no step, but piecewise linear laws, and every new combination of stiffnesses costs it a modal
decomposition.  TAYLOR has no truncation error either; its steps resolve the fastest mode.  With NEWMARK the
whole run is repeated with a shorter step until the peaks no longer change, or until shorter steps bring no
improvement (a force that rings at a node without mass): if between two runs, of which the second takes r
times the steps of the first, a peak differs by :math:`\Delta`, the error left in the second is estimated as
:math:`\Delta/(r-1)`, as if the method were of first order only; as :math:`\Delta/(r^{1.25}-1)` where the
difference falls at least as fast from run to run.  The method is of second order, so that the estimate is
conservative where the peaks converge.  Where they do not yet, two runs may agree by chance.  Hence the
estimate is not below :math:`\Delta` where that falls more slowly than the error of a method of first order;
and it counts only where the collision of the largest force lasts `RESOLVED` steps, and where a third run
confirms it: the one before, if differences do not fall faster than the method explains, else one with a
step between those of the two.  Two runs that agree far better than TOL need no other.

The cost of TAYLOR is known in advance; that of EXACT depends on the events.  Where few laws change
stiffness, and a handful of decompositions does not cost more than TAYLOR, EXACT starts with a small budget.
If that does not suffice, TAYLOR is used where it costs little, or no more than the NEWMARK runs to come;
before each of these EXACT may cost as much as they do, if it would complete the run at its rate so far.
Costs are counted from windows, decompositions, steps and unknowns (:mod:`.costs`), not measured, so that a
deck is always solved in the same way.

The runs are compared by the largest and smallest value of every drift and by the peak force of every
contact, each relative to the larger magnitude of its own, but at least to `FLOOR` times the largest of its
kind: a contact that is hardly touched does not set the step.  Without drifts, by the deformations of all
springs in the same way, and by all displacements relative to the largest in their direction.  With
PEAKS=ALL, by the accelerations of the nodes and the forces of the members that OUTPUT names, too, relative
to the largest of their kind.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    rigid_contact,
    rounding_check,
)
from pound_solve.integrate.tracker import Extreme, Peaks
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.elements.base import Role
from pound_solve.structure.reduction import Decision, ReducedSystem

# EXACT before any steps
FIRST_BUDGET = 1.0  #: what it may cost: loading the kernels of steps costs as much
KERNELS = 0.5  #: cost of loading the kernels of TAYLOR
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
MAX_SERIES = 500_000  #: steps of TAYLOR, where dampers that hardly move may ask for more than is foreseen
SERIES_FIRST = 1.0  #: cost up to which TAYLOR is taken before any steps: it has no error to be estimated
# runs with steps
MAX_STEPS = 50_000_000  #: of one run
MAX_RETRY_COST = 20.0  #: of a run that follows one that stopped
MAX_STALE_RUNS = 4  #: runs in a row that do not halve the error, after which shorter steps are given up
SAFETY = 0.6  #: of the tolerance, that the next step aims at
FLOOR = 0.05  #: share of the largest peak of its kind that a peak is measured against at least
RESOLVED = 10.0  #: steps that the collision of the largest force takes at least
SHORTEST, LONGEST = 1.0 / 8.0, 0.7  #: of a step, that the next one is: where that is not resolved, at most
STEADY, FAST = 1.25, 3.0  #: powers of the step between which differences fall that the method explains
CERTAIN = 0.1  #: share of the tolerance within which two runs do not agree by chance
#: retries after runs that stopped, one after another, before and after one that was completed
MAX_RETRIES, MAX_SHORTER = 10, 3
#: share of the run; where one stops before, another step is that share of its own
EARLY, NEARBY = 0.01, 0.6

#: why no steps are taken
LINEAR = "all laws are piecewise linear, so no time step is needed; stepping would cost more"
SERIES = "all forces have power series between events, so no time step is needed; stepping would cost more"
DEAR = "EXACT would cost more: too many unknowns or changes of stiffness"
RIGID = "steps take no rigid contacts"
#: why no shorter steps are tried
MOST, STALE = "the most that are tried", "nor nearer than with far fewer"
RESPONSE, ALL = "RESPONSE", "ALL"  #: what TOL is for


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

    def seen(self, system: ReducedSystem) -> tuple[Array, list[str]]:
        """Peaks of the accelerations of nodes and of the forces of members, and the kind of each."""
        own = self.recorder.envelopes.blank()
        own.widen(self.envelopes)
        for t, u, v, a, *_ in self.samples:
            own.take(t, u, v, a, [system.excitation.values(t, order).T for order in range(3)])
        return own.peaks()

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
            "OTHER": other + KERNELS,
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


class Peak(NamedTuple):
    """Values that are compared between runs, and the scales of their differences."""

    values: Array
    scales: Array


def measured(extremes: Sequence[Extreme], kinds: Sequence[str]) -> Peak:
    """Extremes, each relative to its own size, but at least to `FLOOR` times the largest of its kind."""
    values = np.array([(e.high, e.low) for e in extremes]).reshape(-1, 2)
    size = np.abs(values).max(axis=1, initial=0.0)
    return Peak(values.ravel(), np.repeat(_floored(size, np.array(kinds)), 2))


def _floored(size: Array, kinds: Array, share: float = FLOOR) -> Array:
    """Sizes, but at least a share of the largest of their kind."""
    out = size.copy()
    for kind in np.unique(kinds):
        own = kinds == kind
        out[own] = np.maximum(out[own], share * out[own].max())
    return out


def figures(system: ReducedSystem, peaks: Peaks, replay: Replay, asked: str = RESPONSE) -> Peak:
    """Return the peaks that are compared between runs, and the scales of their differences."""
    laws = system.structure.laws
    contacts = [i for i, s in enumerate(laws) if s.role.collides]
    force = np.array([max((c.peak for c in peaks.collisions if c.law == i), default=0.0) for i in contacts])
    parts = [measured(peaks.monitored, ["drift"] * len(peaks.monitored))]
    if not peaks.monitored:
        springs = [(e, s.unit) for e, s in zip(peaks.deformation, laws) if not s.role.collides]
        parts.append(measured([e for e, _ in springs], [unit for _, unit in springs]))
        direction = np.array([d for _, d in system.dofs])
        displacement = np.column_stack([np.ravel(replay.high), np.ravel(replay.low)])
        # hinges and uplift have directions of their own
        largest = _floored(np.abs(displacement).max(axis=1), direction, 1.0)
        parts.append(Peak(displacement.ravel(), np.repeat(largest, 2)))
    if asked == ALL:
        values, kinds = replay.seen(system)
        parts.append(Peak(values, _floored(np.abs(values), np.array(kinds), 1.0)))
    parts.append(Peak(force, _floored(force, np.zeros(len(force)))))
    return Peak(*(np.concatenate(x) for x in zip(*parts)))


def hardest(peaks: Peaks) -> float:
    """Return how long the collision of the largest force lasts [T]; infinite without collisions."""
    found = max(peaks.collisions, key=lambda c: c.peak, default=None)
    if found is None or not found.t_end > found.t_start:  # it is still closed
        return np.inf
    return found.t_end - found.t_start


def error_left(relative: Sequence[Array], ratios: Sequence[float]) -> tuple[float, float]:
    """Estimate the error left in the last of some runs.

    Parameters
    ----------
    relative : sequence of ndarray
        Differences of the peaks between two runs, relative to their scales; those of the last two last.
    ratios : sequence of float
        Steps of the second over those of the first of them.

    Returns
    -------
    error, doubt : float
        The estimate; and what it would be if the peaks that differ less than the method explains, by their
        differences before, had come nearer as its error does: infinite after two runs.
    """
    now, r = relative[-1], ratios[-1]
    left = now / (r - 1.0)
    if len(relative) < 2:
        return float(left.max(initial=0.0)), np.inf
    before, first = relative[-2], ratios[-2]
    # differences, if the error were proportional to a power of the step
    linear, steady, fast = (before * (1.0 - r**-p) / (first**p - 1.0) for p in (1.0, STEADY, FAST))
    left = np.where(now > linear, np.maximum(left, now), left)
    left = np.where(now <= steady, now / (r**STEADY - 1.0), left)
    doubt = np.where(now < fast, before / (first - 1.0) / r**2, 0.0)
    return float(left.max(initial=0.0)), float(doubt.max(initial=0.0))


def stepped(system: ReducedSystem) -> Decision:
    """Return the decision that steps were taken."""
    reason = not_in_series(system) or not_linear(system) or DEAR
    return Decision("method", "NEWMARK", f"{reason}; steps are shortened until the peaks converge")


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
    met : bool
        Whether the last run meets the tolerance, and not by chance.
    between : float
        Step of a run that shall confirm the last one; 0 where none is needed [T].
    interval : float
        Usual interval between output times and corners of the excitation [T].
    lasts : float
        Duration of the hardest collision [T].
    steps, relative, ratios : list
        Steps of the runs that are compared; differences between two of them, relative to their scales;
        steps of the second over those of the first.
    """

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        recorder: EnvelopeRecorder,
        options: Mapping[str, Any],
    ) -> None:
        self.system, self.start, self.monitored, self.recorder = system, start, monitored, recorder
        self.tol, self.asked = float(options["TOL"]), options.get("PEAKS", RESPONSE)
        self.length = float(start.times[-1] - start.times[0])
        intervals = np.diff(goals(system, start.times)[0], prepend=start.times[0])
        self.h = self.aim = self.interval = min(float(np.median(intervals)), self.length / 1000)
        self.between, self.lasts = 0.0, np.inf
        self.step_cost = costs.of_step(system) * (1 if provider().fast else costs.INTERPRETED)
        self.error = self.best = np.inf
        self.runs = self.events = self.stale = self.retries = 0
        self.steps, self.relative, self.ratios = list[int](), list[Array](), list[float]()
        self.peaks: Array = np.zeros(0)
        self.met = False
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
        options = {"DT": self.between or self.h, "BETA": 0.25, "GAMMA": 0.5}
        try:
            outcome = newmark.integrate(self.system, self.start, self.monitored, options, replay)
        except Stop as stop:
            return self._retry(stop, replay)
        self.runs, self.retries = self.runs + 1, 0
        if self.between:
            self._confirm(outcome, replay)
        else:
            self.complete = outcome, replay
            self._compare(outcome, replay)
            self.lasts = hardest(outcome.peaks)
        if self.met or self.stale == MAX_STALE_RUNS or self._longest():
            return self._end(MOST if self._longest() else STALE)
        if not self.between:
            self._choose()
        return None

    def _confirm(self, outcome: Outcome, replay: Replay) -> None:
        """Compare the last run with one of longer steps, whose peaks must not differ more either."""
        apart = self._apart(*figures(self.system, outcome.peaks, replay, self.asked))
        ratio = self.steps[-1] / outcome.figures["steps"]
        self.between = 0.0
        if ratio > 1.0:
            self.error = max(self.error, float(apart.max(initial=0.0)) / (ratio - 1.0))
            self.met = self.error <= self.tol
            self.relative[-1] = np.maximum(self.relative[-1], apart)

    def _middle(self) -> float:
        """Step between those of the last two runs that differs from both; 0 where there is none."""
        step = self.h * self.ratios[-1] ** 0.5
        # output times cut the steps: so many are between two of them
        last, middle, before = (
            np.ceil(self.interval / h) for h in (self.h, step, self.h * self.ratios[-1])
        )
        return step if before < middle < last else 0.0

    def _longest(self) -> bool:
        """Whether a run with half the step would take more than `MAX_STEPS`."""
        return self.length / self.h * 2.0 > MAX_STEPS

    def _end(self, ended: str) -> Outcome:
        """Hand on the last run that was completed; `ended` is why no shorter steps follow."""
        assert self.complete is not None
        outcome, replay = self.complete
        self.system.decisions.append(stepped(self.system))
        replay.pass_on()
        outcome.figures = {**outcome.figures, "runs": self.runs}
        outcome.checks = self.checks(outcome, ended)
        return outcome

    def _compare(self, outcome: Outcome, replay: Replay) -> None:
        """Compare a run with the one before, and estimate its error."""
        peaks, scales = figures(self.system, outcome.peaks, replay, self.asked)
        steps, self.events = outcome.figures["steps"], outcome.figures["events"]
        # output times cut the steps of both: runs of as many steps do not differ
        if self.steps and steps > self.steps[-1]:
            self.relative.append(self._apart(peaks, scales))
            self.ratios.append(steps / self.steps[-1])
            self.error, doubt = error_left(self.relative, self.ratios)
            self._judge(hardest(outcome.peaks) >= RESOLVED * self.h, doubt)
            self.stale = 0 if self.error < 0.5 * self.best else self.stale + 1
            self.best = min(self.best, self.error)
        self.steps.append(steps)
        self.peaks = peaks

    def _apart(self, peaks: Array, scales: Array) -> Array:
        """Differences of a run's peaks from the last ones, relative to their scales."""
        return np.asarray(np.abs(peaks - self.peaks) / np.where(scales > 0.0, scales, 1.0))

    def _judge(self, resolved: bool, doubt: float) -> None:
        """Judge whether the last run meets the tolerance, or whether one in between shall confirm that."""
        certain = float(self.relative[-1].max(initial=0.0)) <= CERTAIN * self.tol
        near = self.error <= self.tol and (resolved or certain)
        self.met = near and (certain or doubt <= self.tol)
        self.between = self._middle() if near and not self.met else 0.0

    def _choose(self) -> None:
        """Choose the next step."""
        likely = float(np.sqrt(SAFETY * self.tol / self.error)) if np.isfinite(self.error) else 0.5
        resolved = 0.9 * self.lasts / RESOLVED
        # where shorter steps do not help, as little as possible is spent on learning whether they will
        least = 0.25 if self.stale == 0 else 0.5
        if resolved < self.h * least:
            least = SHORTEST
        self.aim = min(self.h * likely, resolved)
        self.h = float(np.clip(self.aim, least * self.h, LONGEST * self.h))
        self.aim = min(self.aim, self.h)

    def _retry(self, stop: Stop, replay: Replay) -> Outcome | None:
        """Change the step after a run that stopped, or end with the last run that did not, or stop."""
        # A503 says nothing of the structure where the step is coarse, growth only if a finer step grows too
        coarse = stop.code == "A503" or (stop.code == "A504" and not self.steps)
        if coarse and self.between:  # no run confirms the last one
            self.between = 0.0
            self._choose()
            return None
        if coarse and not self._hopeless():
            begin = float(self.start.times[0])
            early = stop.t - begin < EARLY * self.length
            # where laws alternate at the start a step nearby may pass; a far shorter one need not
            self.h *= NEARBY if early or self.retries % 2 else 0.25
            self.aim, self.retries = self.h, self.retries + 1
            done = stop.outcome.figures["events"] if stop.outcome and not early else 0
            self.events = max(self.events, done)
            return None
        if coarse and self.complete is not None:
            return self._end(f"shorter ones stopped ({stop.code} at t = {stop.t:.6g})")
        self.system.decisions.append(stepped(self.system))
        if stop.code == "A506" and self.complete is not None:
            outcome, replay = self.complete
            stop = Stop("A506", float(self.start.times[-1]), INTERRUPTED, outcome)
            outcome.checks = self.checks(outcome, "interrupted")
        replay.pass_on()
        raise stop from None

    def _hopeless(self) -> bool:
        """Whether no other step is tried after a run that stopped: there were many, or a run with a quarter
        of the step would cost more than `MAX_RETRY_COST`.
        """
        cost = self.step_cost * (4.0 * self.length / self.h + costs.EVENT_STEPS * self.events)
        most = MAX_RETRIES if self.complete is None else MAX_SHORTER
        return self.retries == most or self.h <= 1e-6 * self.length or cost > MAX_RETRY_COST

    def checks(self, outcome: Outcome, ended: str) -> list[tuple[str, str, str]]:
        """Return checks beyond those of a single run; `ended` is why no shorter steps follow."""
        steps = outcome.figures["steps"]
        verdict = "met" if self.met else f"look: not met with {steps} steps, {ended}"
        what = "drifts and contact forces" if self.asked == RESPONSE else "all peaks"
        return [
            (f"estimated error of {what}, TOL {self.tol:g}", f"{self.error:.1e}", verdict),
            *rounding_check(self.system.structure.laws, outcome.peaks),
        ]


def by_series(
    system: ReducedSystem, start: Start, monitored: MonitoredOutputs, recorder: EnvelopeRecorder
) -> Outcome | None:
    """Run TAYLOR, and state why; None where dampers that hardly move ask for too many steps."""
    from pound_solve.integrate.series import taylor  # where it is not needed it is not loaded

    reason = SERIES if rigid_contact(system) is None else RIGID
    decisions, known = system.decisions, len(system.decisions)
    decisions.append(Decision("method", "TAYLOR", reason))
    if not any(s.role is Role.DAMPER and s.law.curved for s in system.structure.laws):
        return taylor.integrate(system, start, monitored, {}, recorder)
    replay = Replay(recorder)
    try:
        outcome = taylor.integrate(system, start, monitored, {"STEPS": MAX_SERIES}, replay)
    except Stop as stop:
        if stop.code == "A502":
            del decisions[known:]
            return None
        replay.pass_on()
        raise
    replay.pass_on()
    return outcome


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
    steps = StepRefinement(system, start, monitored, recorder, options)
    while True:
        if series <= max(SERIES_FIRST, steps.cost_ahead()):
            if (outcome := by_series(system, start, monitored, recorder)) is not None:
                return outcome
            series = np.inf
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
    rigid = rigid_contact(system) is not None
    if not_linear(system):
        refuse_rigid(system, start, "AUTO")
    elif rigid and not has_series(system):
        system.decisions.append(Decision("method", "EXACT", RIGID))
        return exact.integrate(system, start, monitored, {}, recorder)
    trial = ExactTrial(system, start, monitored, recorder, options["TOL"])
    series = cost_of_series(system, start)
    if series + provider().loading <= SERIES_FIRST:
        if (outcome := by_series(system, start, monitored, recorder)) is not None:
            return outcome
        series = np.inf
    if (outcome := trial.first(series)) is not None:
        return outcome
    if rigid and (outcome := by_series(system, start, monitored, recorder)) is not None:
        return outcome
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
            doc="largest error of the peaks as a share of them, if steps are taken",
        ),
        Field(
            "PEAKS",
            Kind.WORD,
            default=RESPONSE,
            words=(RESPONSE, ALL),
            doc="peaks that TOL is for: RESPONSE drifts and contact forces; ALL also accelerations "
            "and forces of the nodes and members that OUTPUT names",
        ),
    ),
    impl=integrate,
)
