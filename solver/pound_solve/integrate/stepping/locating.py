"""Location of the first event that a trial step passes: shorter steps are tried until one ends at it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.events.within_step import event_value, first_event, time_of_event, value_at_start
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.state import (
    DONE,
    NOT_CONVERGED,
    PART,
    SINGULAR,
    Piece,
    Scheme,
    Simulation,
    Step,
)
from pound_solve.integrate.stepping.factor import factorise_step
from pound_solve.integrate.stepping.step import restore_start_tangents, try_step
from pound_solve.integrate.tolerances import EVENT_TOLERANCE, NEARLY_MET, SAME_INSTANT_OF_STEP
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.cubic import next_trial

GO_ON, MET, NONE = range(3)
MAX_TRIALS = 100  #: trials of one search
MAX_INTERPOLATIONS = 12  #: trials by interpolation; bisection follows


class Bracket(NamedTuple):
    """Times of a step between which an event function rises through zero, and its values there.

    No event occurs up to `low`; one is passed at `high`; `third` is an earlier trial.  A value is NaN
    if the function belongs to another event, or no trial was made.
    """

    low: float
    high: float
    third: float
    g_low: float
    g_high: float
    g_third: float


def narrowed_bracket(b: Bracket, tau: float, g: float, passed: bool) -> Bracket:
    """Return the bracket after a trial at `tau`, where the event function is `g`; `passed` tells whether
    the event is passed there.
    """
    if passed:
        return Bracket(b.low, tau, b.high, b.g_low, g, b.g_high)
    return Bracket(tau, b.high, b.low, g, b.g_high, b.g_low)


def bracket_for(b: Bracket, laws: Laws, step: Step, law: int, index: int) -> Bracket:
    """Return the same bracket for another event: that with `index` of `law`."""
    at_start = value_at_start(laws, step, law, index) if b.low == 0.0 else np.nan
    return Bracket(b.low, b.high, b.third, at_start, np.nan, b.g_third)


def next_time(b: Bracket, passed: bool, guess: float, h: float) -> float:
    """Return the time of the next trial, interpolated from the end that is nearer to the event."""
    if passed and np.isnan(b.g_low):
        tau = guess
        if not np.isnan(b.g_third):
            tau = next_trial(b.high, b.third, np.nan, b.g_high, b.g_third, np.nan)
    elif passed:
        tau = next_trial(b.high, b.low, b.third, b.g_high, b.g_low, b.g_third)
    else:
        tau = next_trial(b.low, b.high, b.third, b.g_low, b.g_high, b.g_third)
    # a trial just beyond the event ends the search, one before it does not
    tau += 0.5 * SAME_INSTANT_OF_STEP * h
    return tau if b.low < tau < b.high else 0.5 * (b.low + b.high)


def search_verdict(
    b: Bracket, g: float, size: float, tau: float, guess: float, passed: bool, last: bool, h: float
) -> int:
    """Return the result of a search at `tau`: MET at an event, NONE if there is none, or GO_ON.  `size` is
    the magnitude of the event function's terms.
    """
    if abs(g) <= EVENT_TOLERANCE * size or last or 0.0 <= tau - guess <= SAME_INSTANT_OF_STEP * h:
        # no event after all: rates of massless unknowns may mislead
        return NONE if not passed and abs(g) > NEARLY_MET * size else MET
    # there is no event up to here; the rest of the step may have one
    return NONE if not passed and b.g_high <= 0.0 else GO_ON


def mark_others(sim: Simulation, event: LocatedEvent, tried: float, h: float) -> None:
    """Mark in `laws.events.pending` the other laws that pass an event at the instant of the located one.

    The part of the step that ends there was tried with length `tried` (NaN if the trial failed) and is not
    accepted yet.  If rates of massless unknowns or forces of friction jump there, one law leaves at a
    time.
    """
    laws = sim.laws
    events = laws.events
    alone = not sim.linear.all_mass or len(laws.friction.coupled) > 0
    for i in range(len(laws.definition.rule)):
        events.pending[i], first = -1, event.time + SAME_INSTANT_OF_STEP * h
        for e in range(0 if alone or i == event.law else events.n_events[i]):
            at = time_of_event(laws, sim.step, i, e, tried)
            if at <= first:
                events.pending[i], first = e, at


def try_part(sim: Simulation, rules: RuleFunctions, scheme: Scheme, piece: Piece, length: float) -> int:
    """Try the part of the step that ends after `length`; return DONE, SINGULAR or NOT_CONVERGED."""
    bad = factorise_step(sim, scheme, length, PART)
    if bad >= 0:
        sim.run.failed_unknown = bad
        return SINGULAR
    end = sim.run.time - piece.begin + length
    return DONE if try_step(sim, rules, scheme, piece.coefs, end, length, PART) else NOT_CONVERGED


def locate_event(
    sim: Simulation,
    rules: RuleFunctions,
    scheme: Scheme,
    piece: Piece,
    length: float,
    h: float,
    event: LocatedEvent,
) -> tuple[int, LocatedEvent]:
    """Shorten a step that passes events so that it ends at the first.

    Parameters
    ----------
    length, h : float
        Length of the trial step, and of the nominal step [T].
    event : LocatedEvent
        Result of `first_event`.

    Returns
    -------
    why : int
        DONE or the reason for failure.
    event : LocatedEvent
        Law -1 if no event is met after all.  Its time is the length that was tried last, or 0 if the event
        is met at once.  Other events at this instant are marked, see `mark_others`.
    """
    laws, step = sim.laws, sim.step
    law, index, tau = event.law, event.event_index, event.time
    g = event_value(laws, law, index, laws.trial.deformation[law], laws.trial.rate[law])[0]
    b = Bracket(0.0, length, np.nan, value_at_start(laws, step, law, index), g, np.nan)
    bisects, tried = False, length
    for trial in range(MAX_TRIALS):
        if tau <= SAME_INSTANT_OF_STEP * h:
            met = LocatedEvent(law, index, 0.0)
            mark_others(sim, met, tried, h)
            return DONE, met
        last = b.high - b.low <= SAME_INSTANT_OF_STEP * h
        if last:
            tau = b.high
        elif trial > MAX_INTERPOLATIONS or bisects:
            tau = 0.5 * (b.low + b.high)
        why = try_part(sim, rules, scheme, piece, tau)
        if why == SINGULAR or (why == NOT_CONVERGED and last):
            return why, event
        if why == NOT_CONVERGED:
            # a solution exists at `high`: the next trial is nearer to it
            restore_start_tangents(sim, rules)
            b, bisects, tried = Bracket(tau, b.high, np.nan, np.nan, b.g_high, np.nan), True, np.nan
            continue
        tried = tau
        first = first_event(laws, step, tau)
        passed = first.law >= 0
        if passed and (first.law != law or first.event_index != index):
            law, index = first.law, first.event_index
            b = bracket_for(b, laws, step, law, index)
        g, size = event_value(laws, law, index, laws.trial.deformation[law], laws.trial.rate[law])
        ends = search_verdict(b, g, size, tau, first.time, passed, last, h)
        if ends != GO_ON:
            met = LocatedEvent(law if ends == MET else -1, index, tau)
            mark_others(sim, met, tried, h)
            return DONE, met
        b = narrowed_bracket(b, tau, g, passed)
        tau = next_time(b, passed, first.time, h)
    sim.run.failed_law = law
    return NOT_CONVERGED, event
