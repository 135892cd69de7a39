"""Runs of LAGUERRE with successively smaller tolerances, until the peaks converge.

The tolerance of LAGUERRE bounds the error of a step, not that of the run.  The run is therefore repeated
with a smaller tolerance.  The difference between the peaks of two runs is nearly the error of the first
run, which is about ten times that of the second; it is used as the estimate for the second.  Two runs may
agree by chance, so differences from earlier runs also count, assuming that errors fall only with the root
of the tolerance.  Steps that end at the intervals of the record may be the same in both runs; a difference
of zero then proves nothing.  An estimate is therefore at least the tolerance of the first run, and runs
with the same number of steps are compared only if no smaller tolerance is left.  Two runs may also make the
same error if a hinge nearly reverses.  Therefore the first tolerance is small even if a large error is
allowed, and an estimate is at least a fraction of the allowed error.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_solve.check import Check, Subject, at_most
from pound_solve.integrate import costs
from pound_solve.integrate.convergence.compared import NAMES, RESPONSES, ComparedPeaks, figures, tolerances
from pound_solve.integrate.convergence.replay import Replay
from pound_solve.integrate.protocol import INTERRUPTED, EnvelopeRecorder, Outcome, Problem, Stop, goals

#: expected number of steps of a run between two samples of the excitation or output instants
EXPECTED_STEPS = 2.0
FIRST_TOLERANCE = 0.1  #: tolerance of the first run, as a fraction of that of the peaks
#: its upper limit: a larger tolerance hardly saves steps, since intervals and events remain
MAX_FIRST_TOLERANCE = 1e-5
#: smallest estimate, as a fraction of the tolerance of the peaks
MIN_ESTIMATE = 0.05
NEXT, NEXT_LEAST = 0.1, 1e-3  #: largest and smallest ratio of the next tolerance to the last
MIN_TOLERANCE = 1e-12  #: smallest tolerance of a run
POWER = 0.5  #: smallest power of the tolerance with which errors are assumed to fall
ORDER = 6  #: steps grow with the root of this order
MAX_RUNS = 6  #: number of runs after which no smaller tolerance is tried


class UnfitError(Exception):
    """LAGUERRE cannot finish, but another method may; or it is too expensive (`dear`)."""

    def __init__(self, why: str, dear: bool) -> None:
        super().__init__(why)
        self.dear = dear


class ToleranceRefinement:
    """Runs of LAGUERRE with successively smaller tolerances, until the peaks converge.

    Parameters
    ----------
    others : float
        Cost of another method; a run is abandoned if it would cost more.

    Attributes
    ----------
    tolerances, errors : dict
        Of each kind of peaks that has a tolerance, and the estimate for the last run.
    error : float
        The largest estimate of the last run, divided by its tolerance.
    tol, floor : float
        Tolerances of the next run and of the one before it.
    peaks : list
        Tolerances and peaks of the completed runs.
    spent : float
        Cost of the runs that were completed.
    most : float
        Largest number of steps of a run, in addition to one for each event.
    events : int
        Of the last run.
    steps : float
        Expected number of steps of the next run.
    """

    def __init__(
        self, problem: Problem[EnvelopeRecorder], options: Mapping[str, Any], others: float
    ) -> None:
        self.problem, self.system = problem, problem.system
        self.tolerances = tolerances(options)
        self.errors, self.error = dict.fromkeys(self.tolerances, np.inf), np.inf
        self.tol = self.floor = float(
            np.clip(FIRST_TOLERANCE * min(self.tolerances.values()), MIN_TOLERANCE, MAX_FIRST_TOLERANCE)
        )
        self.step_cost = costs.of_series_step(self.system)
        self.steps = EXPECTED_STEPS * len(goals(self.system, problem.start.times)[0])
        self.most = max(self.steps, others / self.step_cost)
        self.runs, self.events, self.spent = 0, 0, 0.0
        self.peaks = list[tuple[float, ComparedPeaks]]()
        self.complete: tuple[Outcome, Replay] | None = None  # the last run that was completed

    def cost_ahead(self) -> float:
        """Return the cost of the run that is likely to meet the tolerance, and of the run before it."""
        return self.step_cost * self.steps * (1 if self.runs else 2)

    least_cost = cost_ahead

    def run(self) -> Outcome | None:
        """Run once; return the outcome if no run follows, otherwise choose the next tolerance and return
        None.

        Raises
        ------
        Stop
            There was an interrupt.
        UnfitError
            The run stopped for another reason.
        """
        from pound_solve.integrate.series import laguerre  # loaded only if needed

        # the first run is never the final one
        replay = Replay(self.problem.recorder, self.runs > 0 or set(self.tolerances) != {RESPONSES})
        try:
            options = {"TOL": self.tol, "STEPS": self.most + self.events}
            outcome = laguerre.integrate(self.problem.recorded_by(replay), options)
        except Stop as stop:
            if stop.code != "A506":
                why = f"LAGUERRE stops: {stop.code} at t = {stop.t:.6g}"
                raise UnfitError(why, stop.code == "A502" and np.isfinite(self.most)) from None
            raise self._interrupted(stop, replay) from None
        return self._judge(outcome, replay)

    def _judge(self, outcome: Outcome, replay: Replay) -> Outcome | None:
        """Estimate the error of a completed run; return its outcome if no run follows."""
        before, self.complete = self.complete, (outcome, replay)
        peaks = figures(self.system, outcome.peaks, replay, self.tolerances)
        taken = outcome.figures["steps"] + outcome.figures["steps taken again"]
        self.runs, self.events = self.runs + 1, outcome.figures["events"]
        self.spent += self.step_cost * taken
        share = NEXT
        if before is not None:
            share = NEXT_LEAST  # this leads to different steps
            if outcome.figures["steps"] > before[0].figures["steps"] or self.tol == MIN_TOLERANCE:
                self._compare(peaks)
                share = float(np.clip(FIRST_TOLERANCE / self.error, NEXT_LEAST, NEXT))
        if self.error <= 1.0 or self.runs == MAX_RUNS or self.tol == MIN_TOLERANCE:
            replay.pass_on()
            outcome.figures = {**outcome.figures, "runs": self.runs}
            outcome.checks = self.checks(outcome, "the smallest that is tried")
            return outcome
        self.peaks.append((self.tol, peaks))
        self.steps = taken * share ** (-1.0 / ORDER)
        self.floor, self.tol = self.tol, max(share * self.tol, MIN_TOLERANCE)
        return None

    def _compare(self, peak: ComparedPeaks) -> None:
        """Estimate the error of a run from its differences to the previous runs."""
        scales = np.where(peak.scales > 0.0, peak.scales, 1.0)
        apart = np.zeros(len(scales))
        for tol, before in self.peaks:
            fallen = (self.floor / tol) ** POWER
            apart = np.maximum(apart, fallen * np.abs(peak.values - before.values) / scales)
        for kind in self.tolerances:
            least = max(self.floor, MIN_ESTIMATE * self.tolerances[kind])
            self.errors[kind] = max(float(apart[peak.kinds == kind].max(initial=0.0)), least)
        self.error = max(error / self.tolerances[kind] for kind, error in self.errors.items())

    def _interrupted(self, stop: Stop, replay: Replay) -> Stop:
        """Return the exception for an interrupt, with the last completed run, if any."""
        if self.complete is None:
            replay.pass_on()
            return stop
        outcome, replay = self.complete
        replay.pass_on()
        outcome.checks = self.checks(outcome, "interrupted")
        return Stop("A506", float(self.problem.start.times[-1]), INTERRUPTED, outcome)

    def checks(self, outcome: Outcome, ended: str) -> list[Check]:
        """Return checks of a run with the estimates; `ended` is why no smaller tolerances follow."""
        remark = f"not shown with TOL={self.tol:.2g} of LAGUERRE, {ended}"
        estimates = [
            at_most(Subject.ERROR, f"estimated error of {NAMES[kind]}", self.errors[kind], tol, remark)
            for kind, tol in self.tolerances.items()
        ]
        return [*estimates, *outcome.checks]
