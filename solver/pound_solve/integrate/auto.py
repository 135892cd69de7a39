r"""AUTO: EXACT or TAYLOR if they cost less, else runs of LAGUERRE or NEWMARK that meet a tolerance.

EXACT takes no time steps, but needs piecewise linear laws and computes a modal decomposition for every new
combination of stiffnesses.  TAYLOR has no truncation error either; its steps resolve the fastest mode.
LAGUERRE (for piecewise linear laws) and NEWMARK (for all others, and if LAGUERRE stops) have truncation
errors.  AUTO repeats the whole run with a smaller tolerance or a shorter step until the peaks no longer
change, or until repeating brings no improvement (a force that rings at a node without mass); see
:mod:`.convergence`.

The cost of TAYLOR is known in advance; that of EXACT depends on the events.  AUTO uses TAYLOR if it costs
little, or no more than the runs already made plus the next one.  Otherwise it tries EXACT, at the start and
before each such run, within a fraction of the cost of the other methods (:mod:`.trial`).  Costs are counted
from windows, decompositions, steps and unknowns (:mod:`.costs`), not measured, so that a deck is always
solved in the same way.

A twin run follows each run of EXACT or TAYLOR and shows whether the motion magnifies rounding errors
(:mod:`.convergence.twin`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate import costs
from pound_solve.integrate.closed_form import exact
from pound_solve.integrate.convergence import twin
from pound_solve.integrate.convergence.compared import ALL, RESPONSE, tolerances
from pound_solve.integrate.convergence.replay import Replay, Watch
from pound_solve.integrate.convergence.step_refinement import StepRefinement
from pound_solve.integrate.convergence.tolerance_refinement import ToleranceRefinement, UnfitError
from pound_solve.integrate.intervals import MAX_UNKNOWNS, MIN_RADIANS, most_common_length
from pound_solve.integrate.protocol import (
    EnvelopeRecorder,
    Outcome,
    Problem,
    Recorder,
    Stop,
    goals,
    reason_not_in_series,
    reason_not_linear,
    refuse_rigid,
    rigid_contact,
)
from pound_solve.integrate.trial import ExactTrial
from pound_solve.numerics.modes import massless
from pound_solve.numerics.providers import loading, provider
from pound_solve.numerics.types import Array
from pound_solve.structure.elements.base import Role
from pound_solve.structure.reduction import Decision, ReducedSystem

#: limit of steps of TAYLOR, if dampers that hardly move may need more than foreseen
MAX_TAYLOR_STEPS = 500_000
#: costs up to which TAYLOR is preferred to runs whose errors have to be estimated: those of NEWMARK, and
#: of LAGUERRE if it seems to cost less
SERIES_FIRST, SERIES_ALWAYS = 1.0, 0.25

#: why no steps are taken
LINEAR = "all laws are piecewise linear, so no time step is needed; stepping would cost more"
SERIES = "all forces have power series between events, so no time step is needed; stepping would cost more"
EXACT_TOO_COSTLY = "EXACT would cost more: too many unknowns or changes of stiffness"
RIGID = "steps take no rigid contacts"

#: the decision that implicit series were taken
WHY = "EXACT and TAYLOR would cost more; its tolerance is reduced until the peaks converge"
IMPLICIT = Decision("method", "LAGUERRE", WHY)


def has_series(system: ReducedSystem) -> bool:
    """Return whether TAYLOR is applicable."""
    return not reason_not_in_series(system) and provider().fast


def intervals_in_modes(system: ReducedSystem, times: Array, rate: float) -> int:
    """Return how many of the intervals between the `times` TAYLOR advances in modes while all springs are
    elastic and all contacts open; `rate` is that of the fastest mode [1/T].
    """
    length = most_common_length(times)
    curved = any(s.law.curved or s.law.rigid for s in system.structure.laws)
    small = system.size <= MAX_UNKNOWNS and not massless(system.mass).any()
    straight = system.excitation.coefs.shape[1] <= 2
    if curved or not small or not straight or rate * length < MIN_RADIANS:
        return 0
    return int(np.isclose(np.diff(times), length, rtol=1e-9, atol=0.0).sum())


def cost_of_series(problem: Problem[Recorder]) -> float:
    """Return the cost of TAYLOR, infinite if it is not applicable."""
    system, times = problem.system, problem.start.times
    if not has_series(system):
        return np.inf
    times = np.append(times[0], goals(system, times)[0])
    rate, count = costs.fastest_rate(system), len(times) - 1
    in_modes = intervals_in_modes(system, times, rate)
    by_series = float(times[-1] - times[0]) * rate * (1.0 - in_modes / count) / costs.TAYLOR_RADIANS
    reversals = costs.REVERSALS * count * costs.smooth_laws(system)
    # the end of an interval is also the end of a step
    steps = by_series + (count - in_modes) + costs.MODES_STEPS * in_modes + reversals
    return costs.of_series_step(system) * steps


def stepped(system: ReducedSystem, reason: str) -> Decision:
    """Return the decision that steps were taken, and the reason."""
    return Decision("method", "NEWMARK", f"{reason}; steps are shortened until the peaks converge")


def by_series(problem: Problem[Recorder], **options: Any) -> Outcome:
    """Run TAYLOR, and state why."""
    from pound_solve.integrate.series import taylor  # loaded only if needed

    reason = SERIES if rigid_contact(problem.system) is None else RIGID
    problem.system.decisions.append(Decision("method", "TAYLOR", reason))
    return taylor.integrate(problem, options)


def by_few_series(problem: Problem[EnvelopeRecorder]) -> Outcome | None:
    """Run TAYLOR; return None if dampers that hardly move would require too many steps."""
    system = problem.system
    if not any(s.role is Role.DAMPER and s.law.curved for s in system.structure.laws):
        return by_series(problem)
    replay, known = Replay(problem.recorder), len(system.decisions)
    try:
        outcome = by_series(problem.recorded_by(replay), STEPS=MAX_TAYLOR_STEPS)
    except Stop as stop:
        if stop.code == "A502":
            del system.decisions[known:]
            return None
        replay.pass_on()
        raise
    replay.pass_on()
    return outcome


def by_trial(trial: ExactTrial, others: float) -> Outcome | None:
    """Run EXACT, and state why, if it ends within a fraction of the cost of the `others`; else None."""
    known = len(trial.system.decisions)
    outcome = trial.run(others)
    if outcome is not None:
        trial.system.decisions.insert(known, Decision("method", "EXACT", LINEAR))
    return outcome


def to_tolerance(
    runs: StepRefinement | ToleranceRefinement, chosen: Decision, trial: ExactTrial | None, series: float
) -> Outcome:
    """Repeat runs until the peaks converge, unless EXACT or TAYLOR costs less.  `chosen` is the decision to
    state; `series` is the cost of TAYLOR.

    Raises
    ------
    Stop
        A run stopped, and no other run can succeed.
    UnfitError
        Another method may succeed.
    """
    system = runs.system
    while True:
        # then both cost no more than twice as much as series alone
        if series + runs.events * costs.of_series_step(system) <= runs.spent + runs.cost_ahead():
            outcome = by_few_series(runs.problem)
            if outcome is not None:
                return outcome
            series = np.inf
        if trial is not None and (outcome := by_trial(trial, runs.least_cost())) is not None:
            return outcome
        try:
            outcome = runs.run()
        except Stop:
            system.decisions.append(chosen)
            raise
        if outcome is not None:
            system.decisions.append(chosen)
            return outcome


def with_rigid_contact(problem: Problem[EnvelopeRecorder], options: Mapping[str, Any]) -> Outcome:
    """Choose and run the method for a structure with rigid contacts: only EXACT and TAYLOR accept them."""
    system = problem.system
    refuse_rigid(problem, "AUTO")
    if reason_not_linear(system):
        return by_series(problem)
    if not has_series(system):
        system.decisions.append(Decision("method", "EXACT", RIGID))
        return exact.integrate(problem, {})
    series = cost_of_series(problem)
    if series + loading() <= SERIES_FIRST:
        if (outcome := by_few_series(problem)) is not None:
            return outcome
        series = np.inf
    trial = ExactTrial(problem, min(tolerances(options).values()), "")
    return by_trial(trial, series) or by_series(problem)


def by_choice(problem: Problem[EnvelopeRecorder], options: Mapping[str, Any]) -> Outcome:
    """Choose a method, state why, and run it."""
    system = problem.system
    if rigid_contact(system) is not None:
        return with_rigid_contact(problem, options)
    curved = reason_not_linear(system)
    series, reason = cost_of_series(problem), reason_not_in_series(system) or curved
    serves = provider().fast and not curved
    implicit = ToleranceRefinement(problem, options, series) if serves else None
    at_once = SERIES_FIRST if implicit is None else max(SERIES_ALWAYS, implicit.cost_ahead())
    if series + loading() <= at_once:
        if (outcome := by_few_series(problem)) is not None:
            return outcome
        series = np.inf
    trial = ExactTrial(problem, min(tolerances(options).values()), curved)
    if series <= at_once:
        outcome = by_trial(trial, series) or by_few_series(problem)
        if outcome is not None:
            return outcome
        series = np.inf
    if implicit is not None:
        try:
            worth = series + loading() > SERIES_FIRST  # else a trial may cost more than the whole run
            return to_tolerance(implicit, IMPLICIT, trial if worth else None, series)
        except UnfitError as err:
            reason = str(err)
            if err.dear:
                return by_series(problem)
        series = np.inf  # series would stop there, too
    method = stepped(system, reason or EXACT_TOO_COSTLY)
    return to_tolerance(StepRefinement(problem, options), method, trial, series)


def integrate(problem: Problem[EnvelopeRecorder], options: Mapping[str, Any]) -> Outcome:
    """Run the chosen method, and a twin run unless its error is estimated otherwise."""
    watch = Watch(problem.recorder)
    outcome = by_choice(problem.recorded_by(watch), options)
    if outcome.exact:
        tol = min(tolerances(options).values())
        outcome.checks = [*twin.checks(problem, outcome, watch, tol), *outcome.checks]
    return outcome


SPEC = Spec(
    "method",
    "AUTO",
    "EXACT or TAYLOR if efficient, else runs that meet a tolerance",
    (
        Field(
            "TOL",
            Kind.REAL,
            "-",
            default=1e-4,
            lo=1e-9,
            hi=0.1,
            doc="largest relative error of the peaks, by LAGUERRE or NEWMARK",
        ),
        Field(
            "PEAKS",
            Kind.WORD,
            default=RESPONSE,
            words=(RESPONSE, ALL),
            doc="peaks that TOL covers. RESPONSE: drifts, contact forces, deformations and plastic work "
            "of springs and hinges that can yield; ALL: also accelerations and forces of nodes and "
            "members in OUTPUT",
        ),
        Field(
            "TOL_ACCELERATION",
            Kind.REAL,
            "-",
            default=None,
            lo=1e-9,
            hi=0.1,
            doc="largest error of the peak accelerations of the nodes in OUTPUT, relative to the "
            "largest; omitted: TOL with PEAKS=ALL, else no limit",
        ),
        Field(
            "TOL_MEMBER",
            Kind.REAL,
            "-",
            default=None,
            lo=1e-9,
            hi=0.1,
            doc="the same for the peak forces of the members in OUTPUT, relative to the largest of their "
            "unit",
        ),
    ),
    impl=integrate,
)
