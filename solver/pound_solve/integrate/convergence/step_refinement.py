"""Runs of NEWMARK with successively shorter steps, until the peaks converge."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_solve.check import Check, Subject, at_most, beyond
from pound_solve.integrate import costs
from pound_solve.integrate.convergence.compared import NAMES, figures, hardest, tolerances
from pound_solve.integrate.convergence.estimate import error_left, likely_error
from pound_solve.integrate.convergence.replay import Replay
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    EnvelopeRecorder,
    Outcome,
    Problem,
    Stop,
    between_check,
    goals,
    rounding_check,
)
from pound_solve.numerics.providers import provider
from pound_solve.numerics.types import Array

MAX_STEPS = 50_000_000  #: of one run
MAX_RETRY_COST = 20.0  #: largest cost of a run after one that stopped
MAX_STALE_RUNS = 6  #: consecutive runs that do not halve the error, after which no shorter steps are tried
MAX_STALE_OF_SEVERAL = 2  #: the same if the motion is not unique: each step may find another one
TARGET_SHARE = 0.6  #: target error of the next step, as a fraction of the tolerance
MIN_RUNS = 3  #: smallest number of runs for a tolerance to be met: two may agree by chance
STEPS_OF_COLLISION = 10.0  #: smallest number of steps in the collision with the largest force
FIRST_RATIO = 0.5  #: ratio of the second step to the first, if collisions are resolved
#: smallest ratio of the next step to the last if collisions are not resolved, and largest ratio
MIN_RATIO, MAX_RATIO = 1.0 / 8.0, 0.7
#: largest number of consecutive retries after runs that stopped, before and after a completed run
MAX_RETRIES, MAX_SHORTER = 10, 3
#: fraction of the run; if a run stops before it, the next step is the second number times its step
EARLY, NEARBY = 0.01, 0.6

#: reasons why no shorter steps are tried
NO_SHORTER, NO_NEARER = "the most that are tried", "nor nearer than with far fewer"


class StepRefinement:
    """Runs of NEWMARK with successively shorter steps, until the peaks converge.

    Attributes
    ----------
    h : float
        Step of the next run [T].
    aim : float
        Step that is likely to meet the tolerance [T].
    tolerances, errors : dict
        Tolerance of each kind of peaks that has one, and the error estimate of the last run.
    error, likely : float
        The largest estimate of the last run, divided by its tolerance; and the value from which the next
        step is chosen.
    met : bool
        Whether the last run meets the tolerance, and its steps resolve the hardest collision.
    lasts : float
        Duration of the hardest collision [T].
    spent : float
        Cost of the completed runs.
    steps, peaks : list
        Of the compared runs.
    """

    def __init__(self, problem: Problem[EnvelopeRecorder], options: Mapping[str, Any]) -> None:
        self.problem, self.system = problem, problem.system
        self.tolerances = tolerances(options)
        self.errors = dict.fromkeys(self.tolerances, np.inf)
        times = problem.start.times
        self.length = float(times[-1] - times[0])
        intervals = np.diff(goals(self.system, times)[0], prepend=times[0])
        self.h = self.aim = min(float(np.median(intervals)), self.length / 1000)
        self.step_cost = costs.of_step(self.system) * (1 if provider().fast else costs.INTERPRETED)
        self.error = self.likely = self.best = self.lasts = np.inf
        self.runs = self.events = self.stale = self.retries = 0
        self.steps, self.peaks = list[int](), list[Array]()
        self.met, self.spent = False, 0.0
        self.complete: tuple[Outcome, Replay] | None = None  # the last completed run

    def cost_of_run(self, h: float) -> float:
        """Return the cost of a run with step `h`, given the known number of events."""
        return self.step_cost * (self.length / h + costs.EVENT_STEPS * self.events)

    def cost_ahead(self) -> float:
        """Return the cost of the run that is likely to meet the tolerance."""
        return self.cost_of_run(self.aim)

    def least_cost(self) -> float:
        """Return the minimum total cost: of the completed runs, the next one, and those that are missing up
        to `MIN_RUNS`.
        """
        after = range(max(MIN_RUNS - len(self.steps), 1))
        return self.spent + sum(self.cost_of_run(FIRST_RATIO**k * self.h) for k in after)

    def run(self) -> Outcome | None:
        """Run once; return the outcome if no run follows, otherwise choose the next step and return None.

        Raises
        ------
        Stop
            The run stopped for a reason other than a too long step.
        """
        from pound_solve.integrate.stepping import newmark  # loaded only if steps are taken

        replay = Replay(self.problem.recorder)
        options = {"DT": self.h, "BETA": 0.25, "GAMMA": 0.5}
        try:
            outcome = newmark.integrate(self.problem.recorded_by(replay), options)
        except Stop as stop:
            return self._retry(stop, replay)
        self.runs, self.retries, self.complete = self.runs + 1, 0, (outcome, replay)
        self.lasts = hardest(outcome.peaks)
        self._compare(outcome, replay)
        self.spent += self.cost_of_run(self.h)
        several = any(check.subject is Subject.UNIQUENESS for check in outcome.checks)
        stale = self.stale >= (MAX_STALE_OF_SEVERAL if several else MAX_STALE_RUNS)
        if self.met or stale or self._longest():
            return self._end(NO_SHORTER if self._longest() else NO_NEARER)
        self._choose()
        return None

    def _longest(self) -> bool:
        """Return whether a run with half the step would take more than `MAX_STEPS`."""
        return self.length / self.h * 2.0 > MAX_STEPS

    def _end(self, ended: str) -> Outcome:
        """Return the last completed run; `ended` is the reason why no shorter steps follow."""
        assert self.complete is not None
        outcome, replay = self.complete
        replay.pass_on()
        outcome.figures = {**outcome.figures, "runs": self.runs}
        outcome.checks = self.checks(outcome, ended)
        return outcome

    def _compare(self, outcome: Outcome, replay: Replay) -> None:
        """Compare a run with the previous ones, estimate its error, and decide whether it meets the
        tolerance.
        """
        peaks, scales, kinds = figures(self.system, outcome.peaks, replay, self.tolerances)
        steps, self.events = outcome.figures["steps"], outcome.figures["events"]
        if self.steps and steps <= self.steps[-1]:
            return  # output times determine the steps of both: runs with equally many steps do not differ
        self.steps.append(steps)
        self.peaks.append(peaks)
        if len(self.steps) == 1:
            return
        scales = np.where(scales > 0.0, scales, 1.0)
        for kind in self.tolerances:
            alike = kinds == kind
            self.errors[kind] = error_left(self.steps, [x[alike] for x in self.peaks], scales[alike])
        self.error = max(error / self.tolerances[kind] for kind, error in self.errors.items())
        allowed = scales * np.array([self.tolerances[kind] for kind in kinds.tolist()])
        # the next step relies on the order of the method, or on one observed once; the decision does not
        self.likely = likely_error(self.steps, self.peaks, allowed)
        shown = len(self.steps) >= MIN_RUNS and self.lasts >= STEPS_OF_COLLISION * self.h
        self.met = self.error <= 1.0 and shown
        # an order observed once is progress but not proof
        reached = self.likely if len(self.steps) >= MIN_RUNS else self.error
        self.stale = 0 if reached < 0.5 * self.best else self.stale + 1
        self.best = min(self.best, reached)

    def _choose(self) -> None:
        """Choose the next step."""
        resolved = 0.9 * self.lasts / STEPS_OF_COLLISION
        # if shorter steps do not help, spend as little as possible on further attempts
        least = 0.25 if self.stale == 0 else 0.5
        if resolved < self.h * least:
            least = MIN_RATIO
        shorter = float(np.sqrt(TARGET_SHARE / max(self.likely, TARGET_SHARE))) if self.steps[1:] else 0.5
        self.aim = min(self.h * shorter, resolved)
        self.h = float(np.clip(self.aim, least * self.h, MAX_RATIO * self.h))
        self.aim = min(self.aim, self.h)

    def _retry(self, stop: Stop, replay: Replay) -> Outcome | None:
        """Change the step after a run that stopped, or return the last completed run, or stop."""
        # A503 at a coarse step says nothing about the structure, nor does growth unless a finer step grows
        coarse = stop.code == "A503" or (stop.code == "A504" and not self.steps)
        if coarse and not self._hopeless():
            begin = float(self.problem.start.times[0])
            early = stop.t - begin < EARLY * self.length
            # if laws alternate at the start, a similar step may succeed, and a far shorter one may not
            self.h *= NEARBY if early or self.retries % 2 else 0.25
            self.aim, self.retries = self.h, self.retries + 1
            done = stop.outcome.figures["events"] if stop.outcome and not early else 0
            self.events = max(self.events, done)
            return None
        if coarse and self.complete is not None:
            return self._end(f"shorter ones stopped ({stop.code} at t = {stop.t:.6g})")
        if stop.code == "A506" and self.complete is not None:
            outcome, replay = self.complete
            stop = Stop("A506", float(self.problem.start.times[-1]), INTERRUPTED, outcome)
            outcome.checks = self.checks(outcome, "interrupted")
        replay.pass_on()
        raise stop from None

    def _hopeless(self) -> bool:
        """Return whether no other step is tried after a run that stopped: there were many such runs, or a
        run with a quarter of the step would cost more than `MAX_RETRY_COST`.
        """
        cost = self.cost_of_run(0.25 * self.h)
        most = MAX_RETRIES if self.complete is None else MAX_SHORTER
        return self.retries == most or self.h <= 1e-6 * self.length or cost > MAX_RETRY_COST

    def checks(self, outcome: Outcome, ended: str) -> list[Check]:
        """Return checks in addition to those of a single run; `ended` is why no shorter steps follow."""
        steps = outcome.figures["steps"]
        resolved = self.met or self.error > 1.0  # otherwise the steps are too long for a collision
        checks, remark = list[Check](), f"not shown with {steps} steps, {ended}"
        for kind, tol in self.tolerances.items():
            error, about = self.errors[kind], f"estimated error of {NAMES[kind]}"
            judge = at_most if resolved else beyond
            checks.append(judge(Subject.ERROR, about, error, tol, remark))
        return [
            *checks,
            between_check(outcome.peaks),
            *rounding_check(self.system.structure.laws, outcome.peaks),
            *(check for check in outcome.checks if check.subject is Subject.UNIQUENESS),
        ]
