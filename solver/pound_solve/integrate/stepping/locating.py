"""Steps that end on events: a step in which an event is passed is taken again, shorter, until it ends
there; then the law changes its branch, the state is made consistent, and the rest of the step follows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.events.within_step import event_value, first_event, time_of_event, value_at_start
from pound_solve.integrate.kernels.consistency import NEAR, lets_go, make_consistent, touches_massless
from pound_solve.integrate.kernels.laws import (
    couple_friction,
    hold_friction_limits,
    leave_branch,
    linear_force,
    linearise_law,
)
from pound_solve.integrate.kernels.recording import log_transition, store_motion, track_peaks
from pound_solve.integrate.kernels.state import (
    CHATTER,
    CROWD,
    DONE,
    FALL,
    NEWTON,
    PART,
    PIVOT,
    WHOLE,
    Scheme,
    Simulation,
)
from pound_solve.integrate.kernels.ties import event_before_slack, note_rests, note_ties
from pound_solve.integrate.protocol import STILL
from pound_solve.integrate.stepping.step import (
    REFRESH,
    accept_trial,
    factorise_step,
    start_again,
    try_step,
    update_factor,
)
from pound_solve.laws.functions import Tables
from pound_solve.loading.excitation import INSTANT
from pound_solve.numerics.cubic import next_trial
from pound_solve.numerics.types import Array

CLOSE = 1e-9  #: share of a step within which two events are at one instant
FIRST = 1.0 / 32.0  #: part of a step taken after a curved contact has touched; it doubles from then on
MOST_HALVINGS = 25
SHORTEST = 3e-8  #: shortest part of a step, used where laws change to and fro
GO_ON, MET, NONE = range(3)
PATIENCE = 12  #: trials by interpolation; bisection follows


def change_branch(sim: Simulation, rules: Tables, scheme: Scheme, h: float, i: int, event: int) -> None:
    """Change the branch of law `i`, and update the factor for the nominal step `h`."""
    linear, laws, run = sim.linear, sim.laws, sim.run
    before, k, c = laws.branch[i], laws.stiffness[i], laws.damping[i]
    if laws.normal[i] >= 0:
        couple_friction(laws, rules, sim.step.now.acceleration, i)
    d, v, f0 = laws.now.deformation[i], laws.now.rate[i], laws.offset[i]
    note_rests(sim, rules, i, event)
    leave_branch(laws, rules, i, event, d, v)
    if laws.normal[i] < 0 and lets_go(linear, laws, i, k, f0, d):
        run.fell = i
    if laws.curved[i]:
        linearise_law(laws, rules, i, d, v)
    change = scheme.gamma * h * (laws.damping[i] - c) + scheme.beta * h * h * (laws.stiffness[i] - k)
    if not linear.explicit and change != 0.0:
        run.updates += 1
        if run.updates > REFRESH or not update_factor(sim, i, change, WHOLE):
            run.updates = REFRESH + 1
    force = linear_force(laws, i, d, v)
    if laws.contact[i] and touches_massless(linear, laws, i):
        # the dashpot's is only known when the velocities are consistent
        force -= laws.damping[i] * v
    if before != laws.branch[i]:
        log_transition(sim, i, before, run.time, force)
    note_ties(sim, rules, i, k, f0)
    run.events += 1
    for j in laws.coupled:
        before = laws.branch[j]
        couple_friction(laws, rules, sim.step.now.acceleration, j)
        if before != laws.branch[j]:
            log_transition(sim, j, before, run.time, laws.friction_force[j])
            run.updates = REFRESH + 1
    hold_friction_limits(laws)


def mark_others(sim: Simulation, event: LocatedEvent, tried: float, h: float) -> None:
    """Mark the laws that pass an event at the instant of the one located, in `laws.saved`: 1 + its number.

    The part in which they do was tried with length `tried`, NaN where that failed, and is not accepted yet.
    Rates of unknowns without mass and the forces of friction jump there: then one law leaves at a time.
    """
    laws = sim.laws
    alone = not sim.linear.all_mass or len(laws.coupled) > 0
    for i in range(len(laws.rule)):
        laws.saved[i], first = 0, event.time + CLOSE * h
        for e in range(0 if alone or i == event.law else laws.n_events[i]):
            at = time_of_event(laws, sim.step, i, e, tried)
            if at <= first:
                laws.saved[i], first = 1 + e, at


def leaves_with(sim: Simulation, i: int) -> bool:
    """Whether a law that is marked leaves its branch whatever the others do that have left at this instant.

    A law that turns follows its acceleration, which changes where another one holds the same mass; their
    unknowns are marked in `step.product`.
    """
    laws = sim.laws
    if laws.events[i, laws.saved[i] - 1, 0] != 0.0:
        return True
    for q in range(laws.rows.pointers[i], laws.rows.pointers[i + 1]):
        if not sim.linear.diagonal or sim.step.product[laws.rows.columns[q]] != 0.0:
            return False
    return True


def change_branches(sim: Simulation, rules: Tables, scheme: Scheme, h: float, event: LocatedEvent) -> None:
    """Let a law leave its branch, and those that are marked, and make the state consistent, unless a force
    has fallen: joints must move first.
    """
    laws, step, run = sim.laws, sim.step, sim.run
    first, its_event = event_before_slack(sim, rules, event.law, event.event_index)
    event = LocatedEvent(first, its_event, event.time)
    laws.saved[event.law] = 1 + event.event_index
    for j in range(len(step.product)):
        step.product[j] = 0.0
    for k in range(-1, len(laws.rule)):
        i = event.law if k < 0 else k
        room = len(sim.buffers.log) - run.logged > len(laws.coupled)
        if laws.saved[i] == 0 or not room or (k >= 0 and not leaves_with(sim, i)):
            continue
        change_branch(sim, rules, scheme, h, i, laws.saved[i] - 1)
        if laws.curved[i] and laws.contact[i] and laws.now.rate[i] > 0.0:
            run.longest_part = FIRST * h
        for q in range(laws.rows.pointers[i], laws.rows.pointers[i + 1]):
            step.product[laws.rows.columns[q]] = 1.0
        laws.saved[i] = 0
    if run.fell < 0:
        go_on(sim, rules)


def go_on(sim: Simulation, rules: Tables) -> None:
    """Make the state consistent after a jump, and keep the motion for the envelopes.

    Where a load has jumped at that instant, the time is moved to just after it: a motion at the instant
    itself counts as one before.
    """
    run = sim.run
    make_consistent(sim)
    track_peaks(sim, run.time, 0.0)
    after = 4.0 * INSTANT * max(1.0, run.time) if run.time == run.jumped else 0.0
    store_motion(sim, rules, run.time + after)


class Bracket(NamedTuple):
    """Times of a step between which an event function rises through zero, and its values there.

    NaN stands for what is not known; `third` was tried before.
    """

    low: float
    high: float
    third: float
    g_low: float
    g_high: float
    g_third: float


def narrowed_bracket(b: Bracket, tau: float, g: float, passed: bool) -> Bracket:
    """The bracket after a trial at `tau`, where the event function is `g`, and the event passed or not."""
    if passed:
        return Bracket(b.low, tau, b.high, b.g_low, g, b.g_high)
    return Bracket(tau, b.high, b.low, g, b.g_high, b.g_low)


def next_time(b: Bracket, passed: bool, guess: float, h: float) -> float:
    """Time of the next trial: by interpolation from the end that is nearer to the event."""
    if passed and b.g_low != b.g_low:
        tau = guess
        if b.g_third == b.g_third:
            tau = next_trial(b.high, b.third, np.nan, b.g_high, b.g_third, np.nan)
    elif passed:
        tau = next_trial(b.high, b.low, b.third, b.g_high, b.g_low, b.g_third)
    else:
        tau = next_trial(b.low, b.high, b.third, b.g_low, b.g_high, b.g_third)
    tau += 0.5 * CLOSE * h  # a trial just beyond the event ends the search, one before it does not
    return tau if b.low < tau < b.high else 0.5 * (b.low + b.high)


def search_verdict(
    b: Bracket, g: float, size: float, tau: float, guess: float, passed: bool, last: bool, h: float
) -> int:
    """Result of a search at `tau`: MET at an event, NONE where there is none, or GO_ON; `size` is the
    magnitude of the event function's terms.
    """
    if abs(g) <= STILL * size or last or 0.0 <= tau - guess <= CLOSE * h:
        # no event after all: rates of massless unknowns may mislead
        return NONE if not passed and abs(g) > NEAR * size else MET
    # up to here there is no event; the rest of the step may have one
    return NONE if not passed and b.g_high <= 0.0 else GO_ON


def locate_event(
    sim: Simulation,
    rules: Tables,
    scheme: Scheme,
    coefs: Array,
    begin: float,
    length: float,
    h: float,
    event: LocatedEvent,
) -> tuple[int, LocatedEvent]:
    """Shorten a step from the local time `begin`, in which events are passed, to the first of them.

    Parameters
    ----------
    length, h : float
        Its length as it was tried, and the nominal one.
    event : LocatedEvent
        Result of `first_event`.

    Returns
    -------
    why : int
        DONE or what failed.
    event : LocatedEvent
        Law -1 where none is met after all; its time is the length that was tried last, or 0 where it is met
        at once.  Others at this instant are marked, see `mark_others`.
    """
    laws, step = sim.laws, sim.step
    law, index, tau = event.law, event.event_index, event.time
    g = event_value(laws, law, index, laws.trial.deformation[law], laws.trial.rate[law])[0]
    b = Bracket(0.0, length, np.nan, value_at_start(laws, step, law, index), g, np.nan)
    bisects, tried = False, length
    for trial in range(100):
        if tau <= CLOSE * h:
            met = LocatedEvent(law, index, 0.0)
            mark_others(sim, met, tried, h)
            return DONE, met
        last = b.high - b.low <= CLOSE * h
        if last:
            tau = b.high
        elif trial > PATIENCE or bisects:
            tau = 0.5 * (b.low + b.high)
        bad = factorise_step(sim, scheme, tau, PART)
        if bad >= 0:
            sim.run.fault = bad
            return PIVOT, event
        if not try_step(sim, rules, scheme, coefs, begin + tau, tau, PART):
            if last:
                return NEWTON, event
            start_again(laws, rules)  # at `high` there was a solution: look for the event nearer to it
            b, bisects, tried = Bracket(tau, b.high, np.nan, np.nan, b.g_high, np.nan), True, np.nan
            continue
        tried = tau
        first = first_event(laws, step, tau)
        passed = first.law >= 0
        if passed and (first.law != law or first.event_index != index):
            law, index = first.law, first.event_index
            at_start = value_at_start(laws, step, law, index) if b.low == 0.0 else np.nan
            b = Bracket(b.low, b.high, b.third, at_start, np.nan, b.g_third)
        g, size = event_value(laws, law, index, laws.trial.deformation[law], laws.trial.rate[law])
        ends = search_verdict(b, g, size, tau, first.time, passed, last, h)
        if ends != GO_ON:
            met = LocatedEvent(law if ends == MET else -1, index, tau)
            mark_others(sim, met, tried, h)
            return DONE, met
        b = narrowed_bracket(b, tau, g, passed)
        tau = next_time(b, passed, first.time, h)
    return NEWTON, event


def factorise_part(sim: Simulation, scheme: Scheme, length: float, halvings: int) -> int:
    """Factorise A for a part of a step, which Newton's iterations may have halved."""
    bad = factorise_step(sim, scheme, length, PART)
    if bad < 0:
        return DONE
    if halvings > 0:
        return NEWTON
    sim.run.fault = bad
    return PIVOT


def step_in_parts(
    sim: Simulation,
    rules: Tables,
    scheme: Scheme,
    coefs: Array,
    piece_start: float,
    length: float,
    h: float,
    tried: bool,
) -> int:
    """Advance by `length`, in parts where events cut it; the factor at hand is for the step `h`,
    and `tried` says that the first trial is made.

    A part is halved until Newton converges.  After the touch of a curved contact the parts grow from a
    short one: forces like the fourth root of time begin there.  Where a force falls that holds a joint
    without mass, the step stops, for Python to move the joint (see `integrate.release`).
    """
    laws, run = sim.laws, sim.run
    left, halvings, longest = length, 0, np.inf
    most, curved = 100 + 8 * len(laws.rule), laws.curved.any()
    at = WHOLE if abs(length - h) <= 1e-9 * h else PART
    while left > 0.0:
        if len(sim.buffers.log) - run.logged <= len(laws.coupled):
            return CROWD
        t, part = run.time, min(left, run.longest_part, longest)
        if at == PART or part < left:
            at = PART
            if curved:  # what is tried from here on moves the tangents away from the factor at hand
                run.updates = REFRESH + 1
            why = factorise_part(sim, scheme, part, halvings)
            if why != DONE:
                return why
        end = t + part - piece_start
        if not tried and not try_step(sim, rules, scheme, coefs, end, part, at):
            halvings, longest, at = halvings + 1, 0.5 * part, PART
            if halvings > MOST_HALVINGS:
                return NEWTON
            run.updates = REFRESH + 1
            start_again(laws, rules)
            continue
        tried, halvings, longest = False, 0, np.inf
        event = first_event(laws, sim.step, part)
        if event.law >= 0:
            if curved:  # likewise, at the end of a step that was tried whole
                run.updates = REFRESH + 1
            at = PART
            begin = t - piece_start
            why, event = locate_event(sim, rules, scheme, coefs, begin, part, h, event)
            if why != DONE:
                return why
            part = event.time
            if part > 1e-9 * h:
                run.same_instant = 0
            elif part == 0.0 and curved:  # else what follows takes forces and tangents of the last trial
                start_again(laws, rules)
        else:
            run.longest_part *= 2.0
        if part > 0.0:
            accept_trial(sim, rules, scheme, part, at)
            left -= part
            run.time = t + part
            track_peaks(sim, run.time, part)
            if at == PART:
                store_motion(sim, rules, run.time)
        at = PART
        law = event.law
        if law < 0:
            continue
        change_branches(sim, rules, scheme, h, event)
        run.fault = law
        run.same_instant += 1
        if run.same_instant > most:
            return CHATTER
        if run.same_instant > len(laws.rule):  # a law may turn to and fro: what follows is tried nearer by
            run.longest_part = max(0.5 * min(run.longest_part, left), SHORTEST * h)
        if run.fell >= 0:
            run.rest = left
            return FALL
    return DONE
