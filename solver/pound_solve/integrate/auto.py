r"""AUTO: EXACT where it pays, or TAYLOR, else NEWMARK with the step that meets a tolerance.

EXACT needs no step, but linear pieces, and every combination of stiffnesses that is new costs it a
decomposition.  TAYLOR has no error either; it follows the fastest mode.  By NEWMARK the whole run is
repeated with a shorter step until the peaks no longer change, or shorter steps bring nothing any more (a
force that rings at a node without mass):
between two runs of which the second takes r times the steps of the first the peaks differ by
:math:`\Delta`, and the error left in the second is estimated as :math:`\Delta/(r-1)`, as if the method
were of first order only.  It is of second order, so that the estimate errs on the safe side.

What TAYLOR costs is known beforehand, which of the others pays shows on the way.  Where few laws change
stiffness, and a handful of decompositions does not cost more than TAYLOR, EXACT may begin with a little;
if that does not last, TAYLOR takes over where it costs no more than the runs by steps to come, and before
every such run EXACT may spend as much as these, if by what it has shown it would get to the end.
Costs are counted from windows, decompositions, steps and unknowns, and not measured, so that a deck takes
the same way whenever it is run.

What is compared: the largest and smallest value of every drift, against the larger of the two (but no less
than a millionth of the largest drift: what is smaller may be rounding, which never stands still); the peak
force of every contact, against itself (but no less than a twentieth of the largest contact force);
without drifts, the deformations of all springs in the same way, and all displacements against the largest
in their direction.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from pound_deck.schema import Field, Kind, Spec
from pound_solve.integrate import condensed
from pound_solve.integrate.closed_form import exact, subsystems
from pound_solve.integrate.protocol import (
    INTERRUPTED,
    EnvelopeRecorder,
    Extreme,
    LawValues,
    MonitoredOutputs,
    Outcome,
    Peaks,
    Start,
    Stop,
    goals,
    not_linear,
    refuse_rigid,
    rounding_check,
)
from pound_solve.integrate.series import taylor
from pound_solve.integrate.stepping import newmark
from pound_solve.numerics import jit
from pound_solve.numerics.modes import massless
from pound_solve.numerics.types import Array, Flags
from pound_solve.structure.reduction import Decision, ReducedSystem

MOST_STEPS = 50_000_000  #: of one run
MOST = 20.0  #: cost up to which a run is tried after one that came to a stop
STALE = 4  #: runs in a row that do not halve the error, after which shorter steps are given up
MARGIN = 0.6  #: of the tolerance that the next step aims at
FREE = 1.0  #: what EXACT may cost before steps are thought of: loading their kernels costs as much
LOADING = 0.1  #: what it costs to load the kernels of steps beside those of TAYLOR
TRIAL = 0.3  #: share of that after which it is seen whether it comes to more than that, or than TAYLOR
HANDFUL = 12  #: combinations of stiffnesses of all unknowns together that a run is taken to meet
#: combinations of stiffnesses that it may meet by then (where they do not return, more will come), and laws
#: from which on it is taken to meet more (combinations seldom return), both for the tolerance USUAL: the
#: steps that a smaller one asks for are more as its root
FEW, MANY, USUAL = 40, 12, 1e-3
AHEAD = 4.0  #: times the cost of the next run by steps that EXACT may spend where shorter ones are to come
TASTE = 0.1  #: share of that after which it is seen whether it will do
RADIAN = 5  #: steps of NEWMARK that it takes to follow the fastest mode through a radian
STEP, EACH = 3e-7, 2.5e-8  #: cost of a step and of each of its unknowns, of a law twice, as `exact.WINDOW`
EVENT = 10  #: steps that a located event costs as much as
#: why no steps are taken
LINEAR = "all laws are piecewise linear: no step is needed, and steps, with their loading, cost more"
PLAIN = 100  #: times as much where nothing compiles the kernels


def stepped(system: ReducedSystem) -> Decision:
    """Why steps were taken."""
    reason = not_linear(system) or "EXACT would cost more, for all its unknowns or changes of stiffness"
    return Decision("method", "NEWMARK", f"{reason}; steps are shortened until the peaks stand still")


def hopeless(stop: Stop, start: Start, each: float) -> bool:
    """Whether a run with a quarter of the steps that came to a stop would cost more than `MOST`; a step
    costs `each`.
    """
    begin, *_, end = start.times
    done = stop.outcome.figures if stop.outcome else {"steps": 0, "events": 0}
    spent = each * (done["steps"] + EVENT * done["events"])
    return bool(4.0 * spent * (end - begin) > MOST * (stop.t - begin))


GIVEN_UP = ("the most that are tried", "nor nearer than with far fewer")  #: why no shorter steps are tried


class Replay:
    """Keeps what a run tells its sink, to hand it on if it is the one that counts; knows the extremes of u.

    Of what is between the samples only the envelopes are kept.
    """

    def __init__(self, recorder: EnvelopeRecorder) -> None:
        self.recorder, self.told = recorder, list[tuple[Any, ...]]()
        self.envelopes = recorder.envelopes.blank()
        self.high: Array | float = -np.inf
        self.low: Array | float = np.inf

    def sample(self, t: Array, u: Array, v: Array, a: Array, laws: LawValues, works: Array) -> None:
        """Take some samples (see `integrate.base.HistoryRecorder`)."""
        self.told.append((t, u, v, a, laws, works))
        self.high = np.maximum(self.high, u.max(axis=1))
        self.low = np.minimum(self.low, u.min(axis=1))
        self.recorder.trial(float(t[-1]))

    def between(self, t: Array, u: Array, v: Array, a: Array, apart: float) -> None:
        """Take the motion between samples (see `integrate.base.HistoryRecorder`)."""
        self.envelopes.between(t, u, v, a, apart)

    def stationary(self, t: Array, u: Array) -> None:
        """Take displacements that turn (see `integrate.base.HistoryRecorder`)."""
        self.envelopes.stationary(t, u)

    @property
    def shown(self) -> Flags:
        """Which unknowns `between` looks at (see `integrate.base.HistoryRecorder`)."""
        return self.recorder.shown

    def trial(self, t: float, doing: str = "") -> None:
        """Pass on how far a trial has come."""
        self.recorder.trial(t, doing)

    def hand_on(self) -> None:
        """Tell the sink all of it."""
        self.recorder.envelopes.widen(self.envelopes)
        for what in self.told:
            self.recorder.keep(*what)


def cost_of_step(system: ReducedSystem) -> float:
    """Cost of a compiled step, as those of `exact`."""
    return STEP + EACH * (system.size + 2 * len(system.structure.laws))


def has_series(system: ReducedSystem) -> bool:
    """Whether TAYLOR may be taken."""
    return not not_linear(system) and not massless(system.mass).any() and jit.available()


def cost_of_radian(system: ReducedSystem) -> float:
    """Cost of a run that follows the fastest mode, for each of its radians."""
    return taylor.cost_of_radian(system) if has_series(system) else RADIAN * cost_of_step(system)


def cost_of_series(system: ReducedSystem, start: Start) -> float:
    """Cost of TAYLOR; infinite where it cannot be taken."""
    if not has_series(system):
        return np.inf
    count = taylor.RADIANS * len(goals(system, start.times)[0])  # each is the end of a step
    length = float(start.times[-1] - start.times[0])
    return taylor.cost_of_radian(system) * (length * taylor.rate(system) + count)


class ExactTrial:
    """EXACT, tried for no more than a cost."""

    def __init__(
        self,
        system: ReducedSystem,
        start: Start,
        monitored: MonitoredOutputs,
        recorder: EnvelopeRecorder,
        tol: float,
    ) -> None:
        self.system, self.start, self.monitored, self.recorder = system, start, monitored, recorder
        self.ease = max(USUAL / tol, 1.0) ** 0.5
        # least cost of the whole run, so far as known
        self.whole = FREE if len(system.structure.laws) > self.ease * MANY else 0.0
        if not_linear(system) or system.size > condensed.MOST_UNKNOWNS:
            self.whole = np.inf

    def first(self, other: float) -> Outcome | None:
        """Its run, if that costs little, or no more than to follow the fastest mode, and meets few linear
        regimes; None where it does not.  Another method costs `other`.
        """
        count = min(1 + len(self.system.structure.laws), HANDFUL)
        if count * subsystems.cost_of_decomposition(self.system.size) > FREE + other:
            return None
        limits = {"REGIMES": self.ease * FEW, "PER_RADIAN": cost_of_radian(self.system)}
        return self.run(FREE, {**limits, "TRIAL": TRIAL * FREE})

    def run(self, cost: float, limits: Mapping[str, float]) -> Outcome | None:
        """Its run, if that costs no more and keeps the limits (see `exact.integrate`); else None."""
        if self.whole >= cost:
            return None
        replay, decisions = Replay(self.recorder), self.system.decisions
        known = len(decisions)
        try:
            outcome = exact.integrate(
                self.system, self.start, self.monitored, {"COST": cost, **limits}, replay
            )
        except exact.CostlyError as err:
            del decisions[known:]
            begin, *_, end = self.start.times
            self.whole = err.spent * ((end - begin) / (err.t - begin) if err.t > begin else 1.0)
            return None
        except Stop:
            replay.hand_on()
            raise
        decisions.insert(known, Decision("method", "EXACT", LINEAR))
        replay.hand_on()
        return outcome


def figures(system: ReducedSystem, peaks: Peaks, replay: Replay) -> tuple[Array, Array]:
    """Peaks that are compared between runs, and what their differences are measured against."""
    laws = system.structure.laws
    contact = [i for i, s in enumerate(laws) if s.role.collides]
    force = np.array([max((c.peak for c in peaks.collisions if c.law == i), default=0.0) for i in contact])
    springs = [e for e, s in zip(peaks.deformation, laws) if not s.role.collides]
    swings: list[Extreme] = peaks.monitored or springs
    values = [(e.high, e.low) for e in swings]
    size = np.repeat([max(abs(e.high), abs(e.low)) for e in swings], 2)
    if not peaks.monitored:
        ways = np.array([d for _, d in system.dofs])
        seen = np.column_stack([np.ravel(replay.high), np.ravel(replay.low)])
        most = [np.abs(seen[ways == d]).max(initial=0.0) for d in range(3)]
        values = [*values, *map(tuple, seen.tolist())]
        size = np.append(size, np.repeat([most[d] for d in ways], 2))
    against = [np.maximum(x, share * x.max(initial=0.0)) for x, share in ((size, 1e-6), (force, 0.05))]
    return np.concatenate([np.ravel(values), force]), np.concatenate(against)


def to_tolerance(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: EnvelopeRecorder,
    rival: ExactTrial,
    series: float,
) -> Outcome:
    """Repeat the run with shorter steps until the peaks stand still, or the rival costs less, or TAYLOR,
    which costs `series`.
    """
    tol, length = options["TOL"], float(start.times[-1] - start.times[0])
    intervals = np.diff(goals(system, start.times)[0], prepend=start.times[0])
    h = min(float(np.median(intervals)), length / 1000)
    each = cost_of_step(system) * (1 if jit.numba() else PLAIN)
    aim = h  # step that is likely to do
    before: tuple[int, Array] | None = None
    runs, error, events = 0, np.inf, 0
    best, stale = np.inf, 0
    done: tuple[Outcome, Replay] | None = None  # the last run that came to its end
    while True:
        if series <= max(LOADING, each * (length / aim + EVENT * events)):
            system.decisions.append(Decision("method", "TAYLOR", LINEAR))
            return taylor.integrate(system, start, monitored, {}, recorder)
        budget = each * (min(length / aim, AHEAD * length / h) + EVENT * events)
        if (exactly := rival.run(budget, {"TRIAL": TASTE * budget})) is not None:
            return exactly
        replay = Replay(recorder)
        try:
            outcome = newmark.integrate(
                system, start, monitored, {"DT": h, "BETA": 0.25, "GAMMA": 0.5}, replay
            )
        except Stop as stop:
            # too coarse to go on says nothing of the structure; growth may, if a finer step grows too
            coarse = stop.code == "A503" or (stop.code == "A504" and before is None)
            if coarse and h > 1e-6 * length and not hopeless(stop, start, each):
                h, before = 0.25 * h, None
                aim = h
                events = max(events, stop.outcome.figures["events"] if stop.outcome else 0)
                continue
            system.decisions.append(stepped(system))
            if stop.code == "A506" and done is not None:
                outcome, replay = done
                stop = Stop("A506", float(start.times[-1]), INTERRUPTED, outcome)
                outcome.checks = judged(system, outcome, error, tol, "interrupted")
            replay.hand_on()
            raise stop from None
        runs += 1
        now, against = figures(system, outcome.peaks, replay)
        steps, events = outcome.figures["steps"], outcome.figures["events"]
        if before is not None and steps > before[0]:
            change = float(
                (np.abs(now - before[1]) / np.where(against > 0.0, against, 1.0)).max(initial=0.0)
            )
            error = change / (steps / before[0] - 1.0)
            stale = 0 if error < 0.5 * best else stale + 1
            best = min(best, error)
            if error <= tol or stale == STALE or length / h * 2.0 > MOST_STEPS:
                break
        before, done = (steps, now), (outcome, replay)
        aim = h * (float(np.sqrt(MARGIN * tol / error)) if np.isfinite(error) else 0.5)
        h = float(np.clip(aim, h / 4, h / 2))
        aim = min(aim, h)
    system.decisions.append(stepped(system))
    replay.hand_on()
    outcome.figures = {**outcome.figures, "runs": runs}
    outcome.checks = judged(system, outcome, error, tol, GIVEN_UP[stale == STALE])
    return outcome


def judged(
    system: ReducedSystem, outcome: Outcome, error: float, tol: float, ended: str
) -> list[tuple[str, str, str]]:
    """Checks that say more than those of a single run; `ended` is why no shorter steps follow."""
    steps = outcome.figures["steps"]
    verdict = "met" if error <= tol else f"look: not met with {steps} steps, {ended}"
    return [
        (f"estimated error of drifts and contact forces, TOL {tol:g}", f"{error:.1e}", verdict),
        *rounding_check(system.structure.laws, outcome.peaks),
    ]


def integrate(
    system: ReducedSystem,
    start: Start,
    monitored: MonitoredOutputs,
    options: Mapping[str, Any],
    recorder: EnvelopeRecorder,
) -> Outcome:
    """Choose a method, note why, and run it."""
    if not_linear(system):
        refuse_rigid(system, start, "AUTO")
    elif any(s.law.rigid for s in system.structure.laws):
        system.decisions.append(Decision("method", "EXACT", "rigid contacts: no other method knows them"))
        return exact.integrate(system, start, monitored, {}, recorder)
    rival = ExactTrial(system, start, monitored, recorder, options["TOL"])
    series = cost_of_series(system, start)
    return rival.first(series) or to_tolerance(system, start, monitored, options, recorder, rival, series)


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
