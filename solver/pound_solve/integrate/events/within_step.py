"""Kernels that locate an event within a step from the values and slopes of its function at both ends."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.protocol import CONTACT_SAMPLES, LocatedEvent, no_event
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.kernels.state import Step
from pound_solve.integrate.tolerances import EVENT_TOLERANCE, MOVING_ALIKE
from pound_solve.numerics.cubic import cubic_peak, cubic_rise, cubic_value

SLOPE_ROUNDING = 1e-9  #: fraction of its terms below which a slope is rounding
#: fraction of its largest rate that a law must reach in the other direction to count as reversed
REVERSE_RATE = 1e-6


def event_value(laws: Laws, i: int, e: int, d: float, v: float) -> tuple[float, float]:
    """Return event function `e` of law `i` at deformation `d` and rate `v`, and its terms' magnitude."""
    coefficients, largest = laws.events.coefficients, laws.largest
    on_d, on_v, constant = coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2]
    if on_d == 0.0 and constant == 0.0:  # a law that hardly moves would reverse repeatedly
        back = max(REVERSE_RATE * largest.rate[i], EVENT_TOLERANCE * largest.terms[i])
        constant = -abs(on_v) * back
    size = abs(on_d) * largest.deformation[i] + abs(on_v) * largest.rate[i] + abs(constant)
    return on_d * d + on_v * v + constant, size


def start_value(laws: Laws, i: int, e: int) -> float:
    """Return event function `e` of law `i` at the start of the step."""
    g = event_value(laws, i, e, laws.now.deformation[i], laws.now.rate[i])[0]
    if laws.friction.normal_law[i] < 0:
        return g
    at_start: float = g + laws.friction.limits_at_start[i, e] - laws.events.coefficients[i, e, 2]
    return at_start


def value_at_start(laws: Laws, step: Step, i: int, e: int) -> float:
    """Return the event function at the start of the step for interpolation, NaN if its slope is negative.

    Just after an event, the event function of a law that moves away from it is still close to zero.  An
    interpolation would mistake a return to that event late in the step for an event at its start.
    """
    return np.nan if all_slopes(laws, step, i, e)[0] < 0.0 else start_value(laws, i, e)


def slopes(laws: Laws, i: int, e: int) -> tuple[float, float]:
    """Return the slopes of event function `e` of law `i` at both ends of the trial step, without the terms
    of accelerations and, for events of the rate alone, without the change of their limit.
    """
    friction = laws.friction
    on_d = laws.events.coefficients[i, e, 0]
    s0, s1 = on_d * laws.now.rate[i], on_d * laws.trial.rate[i]
    if friction.normal_law[i] < 0 or on_d == 0.0:
        return s0, s1
    grows = friction.limit_rates_at_start[i, e]
    even = SLOPE_ROUNDING * (abs(s0) + abs(grows))
    s0 += grows
    return 0.0 if abs(s0) <= even else s0, s1 + friction.limit_rates[i, e]


def all_slopes(laws: Laws, step: Step, i: int, e: int) -> tuple[float, float]:
    """Return the slopes of event function `e` of law `i` at both ends of the trial step, with all terms."""
    rows = laws.definition.rows
    s0, s1 = slopes(laws, i, e)
    on_v = laws.events.coefficients[i, e, 1]
    if on_v != 0.0:
        s0 += on_v * row_product(rows, i, step.now.acceleration)
        s1 += on_v * row_product(rows, i, step.trial.acceleration)
    return s0, s1


def first_event(laws: Laws, step: Step, h: float) -> LocatedEvent:
    """Return the first event in a trial step of length `h`, with law -1 if there is none (see `no_event`).

    The time follows from the cubic through values and slopes at both ends; for an event of the rate, from
    the straight line.  If another law has an event, an event of a contact counts only if its event function
    is clearly above zero before that.  Otherwise bodies that move alike would seem to meet in a trial step
    in which a hinge of one has yielded and that of the other has not.
    """
    definition = laws.definition
    first = no_event(np.inf)
    for i in range(len(definition.rule)):
        for e in range(0 if definition.contact[i] else laws.events.n_events[i]):
            at = time_of_event(laws, step, i, e, h)
            if at < first.time:
                first = LocatedEvent(i, e, at)
    other = first
    for i in range(len(definition.rule)):
        for e in range(laws.events.n_events[i] if definition.contact[i] else 0):
            at = time_of_event(laws, step, i, e, h)
            if at < first.time and (other.law < 0 or is_there(laws, step, i, e, h, other.time)):
                first = LocatedEvent(i, e, at)
    return first


def is_there(laws: Laws, step: Step, i: int, e: int, h: float, t: float) -> bool:
    """Return whether the cubic of event function `e` of law `i` in the step of length `h` exceeds rounding
    at a point before the time `t`.
    """
    g1, size = event_value(laws, i, e, laws.trial.deformation[i], laws.trial.rate[i])
    s0, s1 = all_slopes(laws, step, i, e)
    g0 = min(start_value(laws, i, e), 0.0)
    for k in range(1, CONTACT_SAMPLES):
        if (
            cubic_value(g0, g1, s0, s1, h, t * k / (CONTACT_SAMPLES - 1))
            > MOVING_ALIKE * EVENT_TOLERANCE * size
        ):
            return True
    return False


def time_of_event(laws: Laws, step: Step, i: int, e: int, h: float) -> float:
    """Return the time of event `e` of law `i` in the trial step, infinite if there is none."""
    on_d, on_v = laws.events.coefficients[i, e, 0], laws.events.coefficients[i, e, 1]
    if on_d == 0.0 and on_v == 0.0:
        return np.inf
    g1, size = event_value(laws, i, e, laws.trial.deformation[i], laws.trial.rate[i])
    tol = EVENT_TOLERANCE * max(MOVING_ALIKE * size if laws.definition.contact[i] else size, abs(g1))
    s0, s1 = slopes(laws, i, e)
    if g1 <= tol and not (s0 > 0.0 and s1 < 0.0):
        return np.inf
    s0, s1 = all_slopes(laws, step, i, e)
    g0 = min(start_value(laws, i, e), 0.0)  # a branch is valid when it is entered
    # accelerations of massless unknowns would mislead
    if g1 > tol and g0 < 0.0 and on_d == 0.0:
        return h * g0 / (g0 - g1)
    if g1 > tol:
        return cubic_rise(g0, g1, s0, s1, h)
    at, top = cubic_peak(g0, g1, s0, s1, h)
    return cubic_rise(g0, top, s0, 0.0, at) if top > tol else np.inf
