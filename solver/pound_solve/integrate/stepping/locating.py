"""Steps that end on events: a step in which an event is passed is taken again, shorter, until it ends
there; then the law changes its branch, the state is made consistent, and the rest of the step follows.
"""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.events.within_step import event_value, first_event, value_at_start
from pound_solve.integrate.kernels.consistency import NEAR, make_consistent, touches_massless
from pound_solve.integrate.kernels.laws import couple, linear_force, linearise_law, transition
from pound_solve.integrate.kernels.recording import log_transition, track
from pound_solve.integrate.kernels.state import (
    CHATTER,
    CROWD,
    DONE,
    NEWTON,
    PART,
    PIVOT,
    WHOLE,
    Buffers,
    Energy,
    Laws,
    LinearSystem,
    Run,
    Scheme,
    Step,
)
from pound_solve.integrate.protocol import STILL
from pound_solve.integrate.stepping.step import (
    REFRESH,
    accept,
    factorise,
    start_again,
    try_step,
    update_factor,
)
from pound_solve.laws.functions import Tables
from pound_solve.numerics.cubic import next_trial
from pound_solve.numerics.types import Array

CLOSE = 1e-9  #: share of a step within which two events are at one instant
FIRST = 1.0 / 32.0  #: part of a step taken after a curved contact has touched; it doubles from then on
MOST_HALVINGS = 25
PATIENCE = 12  #: trials by interpolation; bisection follows


def change_branch(
    linear: LinearSystem, laws: Laws, step: Step, buffers: Buffers, rules: Tables, scheme: Scheme,
    run: Run, h: float, i: int, event: int,
) -> None:  # fmt: skip
    """Let law `i` leave its branch; `h` is the nominal step, whose factor follows."""
    before, k, c = laws.branch[i], laws.stiffness[i], laws.damping[i]
    if laws.normal[i] >= 0:
        couple(laws, rules, step.now.acceleration, i)
    d, v = laws.now.deformation[i], laws.now.rate[i]
    transition(laws, rules, i, event, d, v)
    if laws.curved[i]:
        linearise_law(laws, rules, i, d, v)
    change = scheme.gamma * h * (laws.damping[i] - c) + scheme.beta * h * h * (laws.stiffness[i] - k)
    if not linear.explicit and change != 0.0:
        run.updates += 1
        if run.updates > REFRESH or not update_factor(linear, laws, step, i, change, WHOLE):
            run.updates = REFRESH + 1
    force = linear_force(laws, i, d, v)
    if laws.contact[i] and touches_massless(linear, laws, i):
        # the dashpot's is only known when the velocities are consistent
        force -= laws.damping[i] * v
    if before != laws.branch[i]:
        log_transition(laws, buffers, run, i, before, run.time, force)
    run.events += 1
    for j in laws.coupled:
        before = laws.branch[j]
        couple(laws, rules, step.now.acceleration, j)
        if before != laws.branch[j]:
            log_transition(laws, buffers, run, j, before, run.time, laws.friction_force[j])
            run.updates = REFRESH + 1


def locate(
    linear: LinearSystem, laws: Laws, step: Step, scheme: Scheme, rules: Tables, coefs: Array, begin: float,
    length: float, h: float, law: int, event: int, tau: float, run: Run,
) -> tuple[int, int, int, float]:  # fmt: skip
    """Shorten a step from the local time `begin`, in which events are passed, to the first of them.

    Parameters
    ----------
    length, h : float
        Its length as it was tried, and the nominal one.
    law, event, tau : int, int, float
        What `first_event` found.

    Returns
    -------
    why, law, event, at : int, int, int, float
        DONE or what failed; the law and its event, law -1 where none is met after all; the length, which
        was tried last, or 0 where the event is met at once.
    """
    low, high, third, stuck = 0.0, length, np.nan, False
    g_low = value_at_start(laws, step, law, event)
    g_high, g_third = (
        event_value(laws, law, event, laws.trial.deformation[law], laws.trial.rate[law])[0],
        np.nan,
    )
    for trial in range(100):
        if tau <= CLOSE * h:
            return DONE, law, event, 0.0
        last = high - low <= CLOSE * h
        if last:
            tau = high
        elif trial > PATIENCE or stuck:
            tau = 0.5 * (low + high)
        bad = factorise(linear, laws, step, scheme, tau, PART)
        if bad >= 0:
            run.fault = bad
            return PIVOT, law, event, 0.0
        if not try_step(linear, laws, step, scheme, rules, coefs, begin + tau, tau, PART, run):
            if last:
                return NEWTON, law, event, 0.0
            start_again(laws, rules)  # at `high` there was a solution: look for the event nearer to it
            low, g_low, third, g_third, stuck = tau, np.nan, np.nan, np.nan, True
            continue
        passed, other, tau2 = first_event(laws, step, tau)
        if passed >= 0 and (passed != law or other != event):
            law, event, g_low, g_high = passed, other, np.nan, np.nan
            if low == 0.0:
                g_low = value_at_start(laws, step, law, event)
        g, size = event_value(laws, law, event, laws.trial.deformation[law], laws.trial.rate[law])
        if abs(g) <= STILL * size or last or 0.0 <= tau - tau2 <= CLOSE * h:
            if passed < 0 and abs(g) > NEAR * size:
                law = -1  # it was no event: rates of massless unknowns may mislead
            return DONE, law, event, tau
        if passed >= 0:
            third, g_third, high, g_high = high, g_high, tau, g
        elif g_high <= 0.0:
            return DONE, -1, event, tau  # no event up to here; the rest of the step may have one
        else:
            third, g_third, low, g_low = low, g_low, tau, g
        if passed >= 0 and g_low != g_low:
            tau = tau2 if g_third != g_third else next_trial(high, third, np.nan, g_high, g_third, np.nan)
        elif passed >= 0:
            tau = next_trial(high, low, third, g_high, g_low, g_third)
        else:
            tau = next_trial(low, high, third, g_low, g_high, g_third)
        tau += 0.5 * CLOSE * h  # a trial just beyond the event ends the search, one before it does not
        if not low < tau < high:
            tau = 0.5 * (low + high)
    return NEWTON, law, event, 0.0


def try_part(
    linear: LinearSystem, laws: Laws, step: Step, scheme: Scheme, rules: Tables, coefs: Array, begin: float,
    length: float, at: int, run: Run,
) -> float:  # fmt: skip
    """Try a step from the local time `begin`, halved until Newton converges; return its length, or 0 where
    it does not however short the step.
    """
    halvings = 0
    while not try_step(linear, laws, step, scheme, rules, coefs, begin + length, length, at, run):
        halvings += 1
        if halvings > MOST_HALVINGS:
            return 0.0
        at, length, run.updates = PART, 0.5 * length, REFRESH + 1
        start_again(laws, rules)
        if factorise(linear, laws, step, scheme, length, PART) >= 0:
            return 0.0
    return length


def step_in_parts(
    linear: LinearSystem, laws: Laws, step: Step, buffers: Buffers, rules: Tables, scheme: Scheme,
    coefs: Array, piece_start: float, energy: Energy, run: Run, length: float, h: float,
    tried: bool,
) -> int:  # fmt: skip
    """Advance by `length`, in parts where events cut it; the factor at hand is for the step `h`,
    and `tried` says that the first trial is made.

    After the touch of a curved contact the parts grow from a short one: forces like the fourth root
    of time begin there.
    """
    left, first, same = length, True, 0
    most = 100 + 8 * len(laws.rule)
    curved = laws.curved.any()
    while left > 0.0:
        if len(buffers.log) - run.logged <= len(laws.coupled):
            return CROWD
        t, part = run.time, left
        if run.longest_part < left:
            part, first = run.longest_part, False
        at = WHOLE if first else PART
        if not first:
            bad = factorise(linear, laws, step, scheme, part, PART)
            if bad >= 0:
                run.fault = bad
                return PIVOT
        elif abs(length - h) > 1e-9 * h:
            first = False
            continue
        if not tried:
            tried_length = try_part(
                linear, laws, step, scheme, rules, coefs, t - piece_start, part, at, run
            )
            if tried_length == 0.0:
                return NEWTON
            if tried_length != part:
                part, at = tried_length, PART
        tried, first = False, False
        law, event, tau = first_event(laws, step, part)
        if law < 0:
            accept(linear, laws, step, rules, scheme, part, at, energy, run)
            run.longest_part *= 2.0
            left -= part
            run.time = t + part
            track(linear, laws, step, run.time, part)
            continue
        if curved:  # what is tried from here on moves the tangents away from the factor at hand
            run.updates = REFRESH + 1
        why, law, event, tau = locate(
            linear, laws, step, scheme, rules, coefs, t - piece_start, part, h, law, event, tau, run
        )
        if why != DONE:
            return why
        if tau > 0.0:
            accept(linear, laws, step, rules, scheme, tau, PART, energy, run)
            left -= tau
            run.time = t + tau
            track(linear, laws, step, run.time, tau)
            if tau > 1e-9 * h:
                same = 0
        if law < 0:
            continue
        change_branch(linear, laws, step, buffers, rules, scheme, run, h, law, event)
        if laws.curved[law] and laws.contact[law] and laws.now.rate[law] > 0.0:
            run.longest_part = FIRST * h
        make_consistent(linear, laws, step)
        track(linear, laws, step, run.time, 0.0)
        run.fault = law
        same += 1
        if same > most:
            return CHATTER
    return DONE
