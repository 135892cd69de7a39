"""Runs of NEWMARK with ever shorter steps, until the peaks converge."""

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
MAX_RETRY_COST = 20.0  #: of a run that follows one that stopped
MAX_STALE_RUNS = 6  #: runs in a row that do not halve the error, after which shorter steps are given up
MAX_STALE_OF_SEVERAL = 2  #: the same where the motion is one of several: each step may find another one
TARGET_SHARE = 0.6  #: fraction of the tolerance that the next step aims at
MIN_RUNS = 3  #: runs that a tolerance is met with: two may agree by chance
STEPS_OF_COLLISION = 10.0  #: steps that the collision of the largest force takes at least
FIRST_RATIO = 0.5  #: the second step over the first, where collisions are resolved
#: least ratio of the next step to the last where collisions are not resolved, and largest ratio
MIN_RATIO, MAX_RATIO = 1.0 / 8.0, 0.7
#: retries after runs that stopped, one after another, before and after one that was completed
MAX_RETRIES, MAX_SHORTER = 10, 3
#: fraction of the run; where one stops before, another step is that share of its own
EARLY, NEARBY = 0.01, 0.6

#: why no shorter steps are tried
MOST, STALE = "the most that are tried", "nor nearer than with far fewer"


class StepRefinement:
    """Runs of NEWMARK with shorter and shorter steps, until the peaks converge.

    Attributes
    ----------
    h : float
        Step of the next run [T].
    aim : float
        Step that is likely to meet the tolerance [T].
    tolerances, errors : dict
        Of each kind of peaks that has a tolerance, and the estimate for the last run.
    error, likely : float
        The largest estimate for the last run, over its tolerance; that which the next step is chosen by.
    met : bool
        Whether the last run meets the tolerance, and its steps resolve the hardest collision.
    lasts : float
        Duration of the hardest collision [T].
    spent : float
        Cost of the runs that were completed.
    steps, peaks : list
        Of the runs that are compared.
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
        self.complete: tuple[Outcome, Replay] | None = None  # the last run that was completed

    def cost_of_run(self, h: float) -> float:
        """Return the cost of a run with a step, as far as events are known."""
        return self.step_cost * (self.length / h + costs.EVENT_STEPS * self.events)

    def cost_ahead(self) -> float:
        """Return the cost of the run that is likely to meet the tolerance."""
        return self.cost_of_run(self.aim)

    def least_cost(self) -> float:
        """Return what all runs cost together at least: those that were made, the next one, and those that
        are left to `MIN_RUNS`.
        """
        after = range(max(MIN_RUNS - len(self.steps), 1))
        return self.spent + sum(self.cost_of_run(FIRST_RATIO**k * self.h) for k in after)

    def run(self) -> Outcome | None:
        """Run once; return the outcome if no run follows, else None with the next step chosen.

        Raises
        ------
        Stop
            The run stopped, and not because its step was too long.
        """
        from pound_solve.integrate.stepping import newmark  # where no steps are taken it is not loaded

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
            return self._end(MOST if self._longest() else STALE)
        self._choose()
        return None

    def _longest(self) -> bool:
        """Whether a run with half the step would take more than `MAX_STEPS`."""
        return self.length / self.h * 2.0 > MAX_STEPS

    def _end(self, ended: str) -> Outcome:
        """Hand on the last run that was completed; `ended` is why no shorter steps follow."""
        assert self.complete is not None
        outcome, replay = self.complete
        replay.pass_on()
        outcome.figures = {**outcome.figures, "runs": self.runs}
        outcome.checks = self.checks(outcome, ended)
        return outcome

    def _compare(self, outcome: Outcome, replay: Replay) -> None:
        """Compare a run with those before, estimate its error, and judge whether it meets the tolerance."""
        peaks, scales, kinds = figures(self.system, outcome.peaks, replay, self.tolerances)
        steps, self.events = outcome.figures["steps"], outcome.figures["events"]
        if self.steps and steps <= self.steps[-1]:
            return  # output times cut the steps of both: runs of as many steps do not differ
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
        # the next step relies on the order of the method, or one that is seen once; the judgement does not
        self.likely = likely_error(self.steps, self.peaks, allowed)
        shown = len(self.steps) >= MIN_RUNS and self.lasts >= STEPS_OF_COLLISION * self.h
        self.met = self.error <= 1.0 and shown
        # an order that is seen once is progress, if it is no proof
        reached = self.likely if len(self.steps) >= MIN_RUNS else self.error
        self.stale = 0 if reached < 0.5 * self.best else self.stale + 1
        self.best = min(self.best, reached)

    def _choose(self) -> None:
        """Choose the next step."""
        resolved = 0.9 * self.lasts / STEPS_OF_COLLISION
        # where shorter steps do not help, as little as possible is spent on learning whether they will
        least = 0.25 if self.stale == 0 else 0.5
        if resolved < self.h * least:
            least = MIN_RATIO
        shorter = float(np.sqrt(TARGET_SHARE / max(self.likely, TARGET_SHARE))) if self.steps[1:] else 0.5
        self.aim = min(self.h * shorter, resolved)
        self.h = float(np.clip(self.aim, least * self.h, MAX_RATIO * self.h))
        self.aim = min(self.aim, self.h)

    def _retry(self, stop: Stop, replay: Replay) -> Outcome | None:
        """Change the step after a run that stopped, or end with the last run that did not, or stop."""
        # A503 says nothing of the structure where the step is coarse, growth only if a finer step grows too
        coarse = stop.code == "A503" or (stop.code == "A504" and not self.steps)
        if coarse and not self._hopeless():
            begin = float(self.problem.start.times[0])
            early = stop.t - begin < EARLY * self.length
            # where laws alternate at the start a step nearby may pass; a far shorter one need not
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
        """Whether no other step is tried after a run that stopped: there were many, or a run with a quarter
        of the step would cost more than `MAX_RETRY_COST`.
        """
        cost = self.cost_of_run(0.25 * self.h)
        most = MAX_RETRIES if self.complete is None else MAX_SHORTER
        return self.retries == most or self.h <= 1e-6 * self.length or cost > MAX_RETRY_COST

    def checks(self, outcome: Outcome, ended: str) -> list[Check]:
        """Return checks beyond those of a single run; `ended` is why no shorter steps follow."""
        steps = outcome.figures["steps"]
        resolved = self.met or self.error > 1.0  # else the steps are too long for a collision
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
