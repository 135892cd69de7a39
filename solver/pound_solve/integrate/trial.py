"""EXACT within a budget: AUTO spends at most a third of the total cost on trials of it.

The cost of an unfinished trial is lost.  Therefore all trials together cost no more than half
(`TRIAL_SHARE`) of what is certainly needed without them: the rest of the program, the loading of
kernels, the runs with steps that were made, and the next one, or the run of TAYLOR.  A trial ends early if
the run, extrapolated at the present rate, would cost more.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate import condensed, costs
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.convergence.replay import Replay
from pound_solve.integrate.protocol import EnvelopeRecorder, Outcome, Problem, Stop
from pound_solve.numerics.providers import loading

TRIAL_SHARE = 0.5  #: limit of the cost of all trials, as a fraction of the cost of the other methods
COST_OF_REST = 0.5  #: cost of the rest of the program: loading it, reading the deck, writing the results
CHECKED_AFTER = 0.2  #: fraction of a trial's budget after which its progress is checked
EXPECTED_DECOMPOSITIONS = 12  #: decompositions of all unknowns that a run is assumed to need
#: decompositions that a trial may make (if combinations of stiffnesses do not recur, more will follow), and
#: number of laws above which EXACT is not tried first (combinations seldom recur); both for the tolerance
#: REFERENCE_TOL: for a smaller one they grow with its root, as the steps do
MAX_DECOMPOSITIONS, MAX_LAWS, REFERENCE_TOL = 40, 12, 1e-3
MIN_COST_OF_MANY = 1.0  #: least cost that is assumed for a run with more laws


class ExactTrial:
    """Trials of EXACT.

    Parameters
    ----------
    refused : str
        Why EXACT is not applicable; empty if it is.

    Attributes
    ----------
    cost : float
        Least known cost of the whole run.
    spent : float
        Cost of all trials.
    """

    def __init__(self, problem: Problem[EnvelopeRecorder], tol: float, refused: str) -> None:
        self.problem, self.system = problem, problem.system
        system = self.system
        self.ease, self.spent = max(REFERENCE_TOL / tol, 1.0) ** 0.5, 0.0
        laws = len(system.structure.laws)
        count = min(1 + laws, EXPECTED_DECOMPOSITIONS)
        self.cost = max(
            count * costs.of_decomposition(system.size), MIN_COST_OF_MANY * (laws > self.ease * MAX_LAWS)
        )
        if refused or system.size > condensed.MAX_UNKNOWNS:
            self.cost = np.inf

    def run(self, others: float) -> Outcome | None:
        """Run EXACT and return its outcome; None if all trials together would exceed the budget, a fraction
        of the cost without trials, or if EXACT stops because a mode is too fast or changes do not end.

        Parameters
        ----------
        others : float
            Cost of the other methods, without the loading of their kernels.

        Raises
        ------
        Stop
            The structure gives way, or an interrupt.
        """
        budget = TRIAL_SHARE * (others + loading() + COST_OF_REST) - self.spent
        if self.cost >= budget:
            return None
        replay, decisions = Replay(self.problem.recorder), self.system.decisions
        known = len(decisions)
        limits = {
            "COST": budget,
            "TRIAL": CHECKED_AFTER * budget,
            "DECOMPOSITIONS": self.ease * MAX_DECOMPOSITIONS,
        }
        try:
            outcome = exact.integrate(self.problem.recorded_by(replay), limits)
        except costs.CostlyError as err:
            del decisions[known:]
            begin, *_, end = self.problem.start.times
            self.spent += err.cost
            self.cost = err.cost * ((end - begin) / (err.t - begin) if err.t > begin else 1.0)
            return None
        except Stop as stop:
            if stop.code == "A503":  # rounding stops EXACT, but perhaps not the others
                del decisions[known:]
                self.cost = np.inf
                return None
            replay.pass_on()
            raise
        replay.pass_on()
        return outcome
