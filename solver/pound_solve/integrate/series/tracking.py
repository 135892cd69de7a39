"""Kernels of TAYLOR for events and peaks.  Within a step event functions, deformations, forces and outputs
are polynomials, whose first rise and extremes are isolated with proof (`events.polynomial_roots`).
"""

from __future__ import annotations

from pound_solve.integrate.events.polynomial_roots import POLYNOMIAL, first_rise, highest, rate_size, size
from pound_solve.integrate.events.protocol import LocatedEvent, earlier, no_event
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.products import row_product
from pound_solve.integrate.kernels.state import Simulation, Step
from pound_solve.integrate.series.force_events import PARTS, PRESSES_AGAIN, RELEASES, TOUCHES
from pound_solve.integrate.series.forces import copy_force, has_series
from pound_solve.integrate.series.friction import friction_event
from pound_solve.integrate.series.power_contacts import (
    APART,
    FORCE_FREE,
    NO_OVERLAP,
    PRESSED,
    PULLS,
    K,
    touch_overlap,
)
from pound_solve.integrate.series.power_dampers import turn_event
from pound_solve.integrate.series.rigid import is_closed
from pound_solve.integrate.series.smooth import bend_event
from pound_solve.integrate.series.state import Extent, Series
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.laws.automaton import GAP


def parting_event(series: Series, degree: int, end: float, i: int) -> LocatedEvent:
    """Return when closed rigid contact `i` would pull, before the place `end`, see `no_event`."""
    r, p = series.rigid.index_of[i], series.polynomial[POLYNOMIAL]
    still = EVENT_TOLERANCE * series.rigid.largest[r]
    copy_force(series, degree, i, -1.0, p)
    if p[0] > still:  # the force has jumped
        return LocatedEvent(i, 0, 0.0)
    at = first_rise(series.polynomial, degree, end, still)
    return earlier(no_event(end), i, 0, at)


def phase_event(laws: Laws, series: Series, degree: int, first: LocatedEvent, i: int) -> LocatedEvent:
    """Return the instant at which the force of power contact `i` begins or ends, or the `first` event."""
    contacts, r = series.power_contacts, series.power_contacts.index_of[i]
    phase, d, p = contacts.phase[r], series.deformation[i], series.polynomial[POLYNOMIAL]
    if contacts.constants[r, K] == 0.0:
        return first
    sign, overlap = 1.0, touch_overlap(laws, i)
    if phase == APART:  # where nothing has moved yet, the step or the other contacts tell how far
        overlap = max(overlap, NO_OVERLAP * size(series.deformation, i, degree))
        still = NO_OVERLAP * series.control.farthest
        if laws.largest.deformation[i] <= still:
            overlap = max(overlap, still)
    else:
        sign = -1.0
    for k in range(degree + 1):
        p[k] = sign * d[k]
    p[0] -= sign * (laws.definition.parameters[i, GAP] + overlap)
    at = first_rise(series.polynomial, degree, first.time, 0.0)
    first = earlier(first, i, TOUCHES if phase == APART else PARTS, at)
    if phase == FORCE_FREE or (phase == PRESSED and contacts.constants[r, PULLS] == 0.0):
        sign = 1.0 if phase == FORCE_FREE else -1.0
        copy_force(series, degree, i, sign, p)
        at = first_rise(series.polynomial, degree, first.time, EVENT_TOLERANCE * contacts.largest[r])
        first = earlier(first, i, PRESSES_AGAIN if phase == FORCE_FREE else RELEASES, at)
    return first


def event_of(laws: Laws, series: Series, extent: Extent, i: int) -> LocatedEvent:
    """Return the first event of law `i` in a step, in lengths of the step, see `no_event`."""
    coefficients = laws.events.coefficients
    degree, h, end = extent.degree, extent.h, extent.end
    if series.friction.index_of[i] >= 0:
        return friction_event(laws, series, extent, i)
    first, d, p = no_event(end), series.deformation, series.polynomial[POLYNOMIAL]
    far, faster = size(d, i, degree), rate_size(d, i, degree) / h
    for e in range(laws.events.n_events[i]):
        on_d, on_v, constant = coefficients[i, e, 0], coefficients[i, e, 1], coefficients[i, e, 2]
        if on_d == 0.0 and on_v == 0.0:
            continue
        if is_closed(series.rigid, i):
            return parting_event(series, degree, end, i)
        scale = abs(on_d) * laws.largest.deformation[i] + abs(on_v) * laws.largest.rate[i] + abs(constant)
        most = on_d * d[i, 0] + on_v * d[i, 1] / h + constant + abs(on_d) * far + abs(on_v) * faster
        if most <= EVENT_TOLERANCE * scale:  # most laws are far from all their events
            continue
        for k in range(degree + 1):
            p[k] = on_d * d[i, k]
        p[0] += constant
        if on_v != 0.0:
            for k in range(degree):
                p[k] += on_v * (k + 1) / h * d[i, k + 1]
        at = first_rise(series.polynomial, degree, first.time, EVENT_TOLERANCE * scale)
        first = earlier(first, i, e, at)
    if series.smooth.index_of[i] >= 0:
        return bend_event(series, degree, first, i)
    if series.power_dampers.index_of[i] >= 0:
        return turn_event(series, degree, h, first, i)
    return phase_event(laws, series, degree, first, i) if series.power_contacts.index_of[i] >= 0 else first


def first_event(laws: Laws, series: Series, extent: Extent) -> LocatedEvent:
    """Return the first event of any law in a step, in lengths of the step, see `no_event`.

    An event of a contact counts only if it clearly precedes that of any other law.  Otherwise bodies that
    move alike would seem to meet while a hinge of one has yielded and that of the other has not.
    """
    first = no_event(extent.end)
    for late in range(2):
        for i in range(len(laws.definition.rule)):
            if laws.definition.contact[i] == (late == 1):
                before = Extent(extent.begin, extent.h, extent.degree, first.time)
                event = event_of(laws, series, before, i)
                if event.law >= 0 and (first.law < 0 or event.time < first.time):
                    first = event
    return first


def update_peak(laws: Laws, step: Step, series: Series, extent: Extent, i: int, law: int) -> None:
    """Update peak `i` with the polynomial in the work space; `law` is not negative for the force of a
    law.
    """
    collision = laws.collision
    extremes, p = step.extremes, series.polynomial
    t, h, degree, end = extent
    known = extremes.high[i]
    contact = law >= 0 and laws.definition.contact[law]
    if contact:
        known = min(known, collision.peak_force[law])
    high, place = highest(p, degree, end, known)
    if high > extremes.high[i]:
        extremes.high[i], extremes.t_high[i] = high, t + h * place
    if contact and high > collision.peak_force[law]:
        collision.peak_force[law], collision.peak_time[law] = high, t + h * place
    for k in range(degree + 1):
        p[POLYNOMIAL, k] = -p[POLYNOMIAL, k]
    high, place = highest(p, degree, end, -extremes.low[i])
    if place >= 0.0:
        extremes.low[i], extremes.t_low[i] = -high, t + h * place


def track_outputs(sim: Simulation, series: Series, extent: Extent, n_powers: int) -> None:
    """Update the peaks with the monitored outputs over a step."""
    linear, degree = sim.linear, extent.degree
    p = series.polynomial[POLYNOMIAL]
    for i in range(len(linear.monitored_constants)):
        for k in range(degree + 1):
            p[k] = row_product(linear.monitored, i, series.motion[k])
        for k in range(min(n_powers, degree + 1)):
            for j in range(series.inputs.shape[1]):
                p[k] += linear.monitored_inputs[i, j] * series.inputs[k, j]
        p[0] += linear.monitored_constants[i]
        update_peak(sim.laws, sim.step, series, extent, i, -1)


def track_law(laws: Laws, step: Step, series: Series, extent: Extent, first: int, i: int) -> None:
    """Count the deformation and the force of law `i` over a step into the peaks, from peak `first` on."""
    definition, tangent = laws.definition, laws.tangent
    degree = extent.degree
    extremes, d, p = step.extremes, series.deformation, series.polynomial[POLYNOMIAL]
    begin, far = d[i, 0], size(d, i, degree)
    if begin + far > extremes.high[first + i] or begin - far < extremes.low[first + i]:
        for k in range(degree + 1):
            p[k] = d[i, k]
        update_peak(laws, step, series, extent, first + i, -1)
    peak = first + len(definition.rule) + i
    stiffness, damping = tangent.stiffness[i], tangent.damping[i] if definition.reports_damping[i] else 0.0
    if has_series(series, i):
        copy_force(series, degree, i, 1.0, p)
        update_peak(laws, step, series, extent, peak, i)
        return
    far *= abs(stiffness)
    high = extremes.high[peak]
    if definition.contact[i]:
        high = min(high, laws.collision.peak_force[i])
    force = tangent.offset[i] + stiffness * begin
    if damping != 0.0 or force + far > high or force - far < extremes.low[peak]:
        for k in range(degree + 1):
            p[k] = stiffness * d[i, k]
        p[0] += tangent.offset[i]
        if damping != 0.0:
            for k in range(degree):
                p[k] += damping * (k + 1) / extent.h * d[i, k + 1]
        update_peak(laws, step, series, extent, peak, i)


def track_laws(laws: Laws, step: Step, series: Series, extent: Extent, first: int) -> None:
    """Count deformations and forces of the laws over a step into the peaks, from peak `first` on."""
    for i in range(len(laws.definition.rule)):
        track_law(laws, step, series, extent, first, i)
