"""Kernels of TAYLOR: the march from event to event, the works of a step, and what is kept of it."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.energy import Works, runs_away
from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.kernels.consistency import make_consistent
from pound_solve.integrate.kernels.laws import drag_force, law_force, leave_branch, linearise_law
from pound_solve.integrate.kernels.products import evaluate_inputs, form_load, multiply
from pound_solve.integrate.kernels.recording import log_transition, next_pause, store_sample, track_peaks
from pound_solve.integrate.kernels.state import (
    CHATTER,
    DONE,
    FALL,
    FULL,
    LOOSE,
    RUNAWAY,
    SHORT,
    STRIKE,
    Buffers,
    Goals,
    Laws,
    LinearSystem,
    MotionState,
    Run,
    Simulation,
    Step,
)
from pound_solve.integrate.kernels.ties import event_before_slack, note_rests, note_ties
from pound_solve.integrate.kernels.work import load_on_nodes, support_power
from pound_solve.integrate.protocol import CHANGES, CHANGES_PER_LAW, SAME_INSTANT
from pound_solve.integrate.series.curved import APART, change_phase
from pound_solve.integrate.series.expansion import (
    MAX_GROWTH,
    MAX_TERMS,
    UNCHECKED_TERMS,
    begin_series,
    dot,
    evaluate_motion,
    expand_series,
    law_at,
    next_term,
)
from pound_solve.integrate.series.forces import count_largest, take_over, update_branch_forces
from pound_solve.integrate.series.friction import is_sliding, touch_event
from pound_solve.integrate.series.massless import factorise_orders, first_violated, joints_jump
from pound_solve.integrate.series.modal import from_modes, renew_modes, take_in_modes
from pound_solve.integrate.series.own_events import BENDS, LIFT, TURNS
from pound_solve.integrate.series.rigid import is_held
from pound_solve.integrate.series.shown import has_room, is_full, keep_step
from pound_solve.integrate.series.single_pole import expand_implicit, is_implicit
from pound_solve.integrate.series.smooth import linearise_smooth, shorten_for_bend
from pound_solve.integrate.series.springs import add_up, deformation_term
from pound_solve.integrate.series.state import Lengths, Series
from pound_solve.integrate.series.strings import string_power
from pound_solve.integrate.series.tracking import event_of, first_event, track_laws, track_outputs
from pound_solve.integrate.series.viscous import linearise_dampers, tangents_settled
from pound_solve.laws.functions import Tables
from pound_solve.numerics.types import Array

MIN_SHORTENING = 1.0 / 16.0  #: factor of the length of a step that is tried again, at least
MAX_SHORTENING = 0.9  #: this factor, at most
AHEAD = 1e-3  #: part of a step in which laws are searched for events at the instant of another one's
MIN_PART = 0.5  #: smallest part of a step, as it was tried, that is taken
FROM_REST = 1e-4  #: share of the time to the goal: longest implicit step in which a contact leaves its rest


def add_law_losses(
    laws: Laws,
    series: Series,
    terms: int,
    s: float,
    h: float,
    weight: float,
    moved: bool,
    works: Works,
    rules: Tables,
) -> None:
    """Add up the losses in the laws' dashpots and the contacts' impulses at one Gauss point."""
    update_branch_forces(laws, series, terms, s, h)
    for i in range(len(laws.rule)):
        drag, curved = laws.damping[i], series.curved.number[i]
        overlaps = curved >= 0 and series.curved.phase[curved] != APART
        pressed = laws.contact[i] and (laws.stiffness[i] != 0.0 or laws.offset[i] != 0.0)
        curves = overlaps or series.viscous.number[i] >= 0
        sliding = is_sliding(series.friction, i)
        if drag != 0.0 or moved or pressed or curves or sliding:
            d, v = law_at(series, terms, s, h, i)
            laws.trial.deformation[i], laws.trial.rate[i] = d, v
            if series.smooth.number[i] >= 0 or (moved and series.viscous.number[i] >= 0):
                linearise_law(laws, rules, i, d, v)
                drag = laws.damping[i]
            if sliding:
                laws.entry_work[i] += weight * laws.offset[i] * v
                continue
            lost = weight * v * (drag_force(laws, rules, i, d, v) if curves else drag * v)
            laws.dashpot_loss[i] += lost
            if laws.contact[i]:
                works.contact += lost
                laws.impulse[i] += weight * (laws.stiffness[i] * d + drag * v + laws.offset[i])
            else:
                works.damping += lost


def work_put_in(linear: LinearSystem, series: Series, terms: int, end: float, top: int) -> float:
    """Work of the loads on the nodes over the step to `end`: their series times those of the velocities."""
    put, power = 0.0, 1.0
    for k in range(1, terms + 1):
        power *= end
        put += power * dot(linear.constant, series.motion[k])
        for j in range(series.inputs.shape[1]):
            share, integral, further = dot(linear.inputs[j], series.motion[k]), 0.0, power
            for m in range(min(top, terms)):
                integral += series.inputs[m, j] * further * k / (k + m)
                further *= end
            put += share * integral
    return put


def add_works(
    sim: Simulation,
    series: Series,
    coefs: Array,
    begin: float,
    terms: int,
    carried: int,
    h: float,
    end: float,
    rules: Tables,
) -> None:
    """Add up the works over the step to `end`, but for those of the loads by Gauss's rule."""
    linear, laws, works = sim.linear, sim.laws, sim.works
    moved, trial, damped = len(linear.support_damping) > 0, sim.step.trial, series.damped
    for k in range(1, terms + 1):
        for i in range(len(damped.unknown)):
            damped.motion[k, i] = series.motion[k, damped.unknown[i]]
    put = 0.0 if moved else work_put_in(linear, series, terms, end, len(coefs))
    rule = min(carried, MAX_TERMS) // UNCHECKED_TERMS
    for g in range(2 * (rule + 1)):
        weight, s = series.gauss[rule, 0, g] * end * h, series.gauss[rule, 1, g] * end
        evaluate_motion(damped.motion, terms, s, h, 1, damped.velocity)
        multiply(damped.damping, damped.velocity, damped.force)
        works.damping += weight * dot(damped.velocity, damped.force)
        if moved:
            evaluate_inputs(coefs, begin + s * h, trial.inputs, trial.input_rates)
        add_law_losses(laws, series, terms, s, h, weight, moved, works, rules)
        put += weight * string_power(laws, series, terms, s, h)
        if moved:
            evaluate_motion(series.motion, terms, s, h, 0, trial.displacement)
            evaluate_motion(series.motion, terms, s, h, 1, trial.velocity)
            evaluate_motion(series.motion, terms, s, h, 2, trial.acceleration)
            supplied, lost = support_power(linear, laws, trial, laws.trial, laws.members.trial)
            put += weight * supplied
            works.damping += weight * lost
            for i in range(len(trial.velocity)):
                put += weight * load_on_nodes(linear, trial.inputs, i) * trial.velocity[i]
    works.input += put
    works.gross_input += abs(put)


def count_reach(laws: Laws, series: Series, terms: int, end: float) -> None:
    """Update the largest deformations of contacts with the displacements of their two bodies up to the
    place `end`: rounding of the deformation is a share of these, and for bodies that move alike the
    deformation is nothing but rounding.
    """
    rows, motion = laws.rows, series.motion
    for i in range(len(laws.rule)):
        if laws.contact[i]:
            far = 0.0
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                x, at = 0.0, rows.columns[q]
                for k in range(terms, -1, -1):
                    x = x * end + motion[k, at]
                far += abs(rows.values[q]) * max(abs(x), abs(motion[0, at]))
            laws.largest_deformation[i] = max(laws.largest_deformation[i], far)


def accept_step(laws: Laws, now: MotionState, series: Series, terms: int, h: float, end: float) -> None:
    """Set the present motion and the state of the laws to those at the place `end` of the step."""
    evaluate_motion(series.motion, terms, end, h, 0, now.displacement)
    evaluate_motion(series.motion, terms, end, h, 1, now.velocity)
    for i in range(len(laws.rule)):
        d, v = law_at(series, terms, end, h, i)
        if is_held(series.rigid, i):
            d, v = laws.entry_deformation[i], 0.0
        if is_sliding(series.friction, i):  # its work is added up
            laws.entry_deformation[i] = d
        laws.now.deformation[i], laws.now.rate[i] = d, v
        laws.largest_deformation[i] = max(laws.largest_deformation[i], abs(d))
        laws.largest_rate[i] = max(laws.largest_rate[i], abs(v))
    update_branch_forces(laws, series, terms, end, h)
    count_largest(laws, series)


def change_branch(sim: Simulation, rules: Tables, series: Series, t: float, event: LocatedEvent) -> None:
    """Let a law leave its branch."""
    laws, run = sim.laws, sim.run
    law = event.law
    before, d, v = laws.branch[law], laws.now.deformation[law], laws.now.rate[law]
    note_rests(sim, rules, law, event.event_index)
    leave_branch(laws, rules, law, event.event_index, d, v)
    take_over(laws, rules, series, law)
    # the rate of what has no mass jumps, and with it the force of its dashpot
    force = law_force(laws, rules, law, d, 0.0 if series.massless.law_number[law] >= 0 else v)
    if before != laws.branch[law]:
        log_transition(sim, law, before, t, force)
    run.events += 1
    run.fault = law
    run.stale = 1


def change_friction(sim: Simulation, rules: Tables, series: Series) -> None:
    """Let friction laws engage or release with the contacts that have touched or parted."""
    for r in range(len(series.friction.laws)):
        event = touch_event(sim.laws, rules, series.friction, r)
        if event >= 0:
            law = series.friction.laws[r]
            change_branch(sim, rules, series, sim.run.time, LocatedEvent(law, event, 0.0))


def change_branches(
    sim: Simulation, rules: Tables, series: Series, terms: int, h: float, end: float, event: LocatedEvent
) -> None:
    """Change the branch of a law, and of others whose events are at the same instant."""
    laws = sim.laws
    now, instant = sim.run.time, SAME_INSTANT * max(sim.run.time, h)
    first, its_event = event_before_slack(sim, rules, event.law, event.event_index)
    event = LocatedEvent(first, its_event, event.time)
    stiffness, offset = laws.stiffness[event.law], laws.offset[event.law]
    change_branch(sim, rules, series, now, event)
    note_ties(sim, rules, event.law, stiffness, offset)
    # with unknowns without mass `settle_state` decides
    for i in range(len(laws.rule) if len(series.massless.unknown) == 0 else 0):
        if i != event.law and series.rigid.number[i] < 0:
            other = event_of(laws, series, terms, h, min(event.time + AHEAD, end), i)
            if other.law >= 0 and other.event_index >= 0 and other.time <= event.time + instant / h:
                change_branch(sim, rules, series, now, other)
    change_friction(sim, rules, series)


def count_instant(run: Run, h: float) -> None:
    """Count the events at one instant."""
    same = run.time - run.last_event <= SAME_INSTANT * max(run.time, h)
    run.same_instant = run.same_instant + 1 if same else 0
    run.last_event = run.time


def renew_branches(sim: Simulation, rules: Tables, series: Series) -> bool:
    """Update what depends on the branches after a change: tangents of smooth laws and dampers, sums, modes,
    factors; False where an unknown without mass is not held, which `run.fault` names.
    """
    laws, run = sim.laws, sim.run
    held = series.massless
    if run.stale:
        linearise_smooth(laws, rules, series.smooth)
        linearise_dampers(laws, rules, series.viscous)
        add_up(sim.linear, laws, series)
        renew_modes(laws, series)
        fault = factorise_orders(laws, held) if len(held.unknown) else -1
        if fault >= 0:
            run.fault = held.unknown[fault]
            return False
        run.stale, run.factor_length = 0, -1.0
    return True


def settle_state(sim: Simulation, rules: Tables, series: Series, coefs: Array, begin: float) -> int:
    """Make the velocities of unknowns without mass and the forces of closed rigid contacts consistent with
    the present branches.

    These rates jump where a stiffness or a dashpot among them changes, and a law whose rate changes its
    sign so must leave its branch, too.  Of several the first in number does, then all are looked at again:
    such a rule of least index ends where the laws harden (Murty's, for linear complementarity problems).

    Returns
    -------
    int
        DONE, or what is wrong.

    References
    ----------
    Murty KG (1974), Note on a Bard-type scheme for solving the complementarity problem, Opsearch 11:
    123-130.
    """
    laws, run = sim.laws, sim.run
    held, now = series.massless, sim.step.now
    in_series = series.rigid.n_held[0] + len(series.curved.laws) + len(series.friction.laws)
    in_series += len(series.smooth.laws) + len(series.viscous.laws)
    if len(held.unknown) + in_series == 0:
        return DONE
    for _ in range(CHANGES + CHANGES_PER_LAW * len(laws.rule)):
        change_friction(sim, rules, series)
        if not renew_branches(sim, rules, series):
            return LOOSE
        begin_series(sim, series, coefs, begin, 1.0)
        if in_series:  # forces that are series need the accelerations
            next_term(sim, series, 0, 1.0, len(coefs))
        # at the start no law has lost a force: what moves there is the rounding of the state of rest
        if run.fault >= 0 and joints_jump(laws, series, len(coefs)):
            return FALL
        for i in held.unknown:
            now.displacement[i], now.velocity[i] = series.motion[0, i], series.motion[1, i]
        for i in held.laws:
            laws.now.deformation[i] = deformation_term(laws, series, 0, len(coefs), i)
            laws.now.rate[i] = deformation_term(laws, series, 1, len(coefs), i)
        if not tangents_settled(laws, series.viscous, now.velocity):
            run.stale = 1
            continue
        law, event = first_violated(laws, held.laws)
        if law < 0:
            update_branch_forces(laws, series, 2, 0.0, 1.0)
            return DONE
        change_branch(sim, rules, series, run.time, LocatedEvent(law, event, 0.0))
    return CHATTER


def begins_to_move(laws: Laws, series: Series, event: LocatedEvent) -> bool:
    """Whether the contact of an event is at rest at the start of an implicit step: the first powers of its
    motion may be below the error of the polynomial then, so that its direction is not known.
    """
    at_rest = event.law >= 0 and laws.contact[event.law] and laws.now.rate[event.law] == 0.0
    return at_rest and is_implicit(series)


def must_pause(buffers: Buffers, series: Series, run: Run, pause: int) -> bool:
    """Whether Python must empty the buffers, or may look whether the user wants to stop."""
    crowded = len(buffers.log) - run.logged < len(buffers.log) // 2 or run.tied > len(buffers.ties) // 2
    return crowded or run.steps >= pause or is_full(series.shown)


def step_length(lengths: Lengths, t: float, goal: float) -> float:
    """Length of the next step: what is left to the goal in equal parts; 0 where it vanishes in the rounding
    of the time.
    """
    left = goal - t
    h: float = left / np.ceil(max(left / lengths.next, 1.0) * (1.0 - 1e-9))
    if h == left:
        return h
    # the motion goes as far as the clock does, which is rounded, but at 0: there any step is time enough
    return t + h - t if goal + h > goal else 0.0


def shorten_step(lengths: Lengths, h: float, fit: float) -> None:
    """Choose a shorter step after one that did not fit, shorter by a tenth at least: with less, the equal
    parts of what is left would be as long as before.
    """
    lengths.next = h * (min(fit, MAX_SHORTENING) if fit > MIN_SHORTENING else MIN_SHORTENING)
    lengths.rejected += 1


def take_step(
    sim: Simulation,
    series: Series,
    coefs: Array,
    begin: float,
    terms: int,
    h: float,
    end: float,
    rules: Tables,
) -> None:
    """Accept the step up to its place `end`: update peaks, kept motion, works, and the present motion."""
    laws, run = sim.laws, sim.run
    t = run.time
    track_outputs(sim, series, terms, h, end, t, len(coefs))
    track_laws(laws, sim.step, series, terms, h, end, t, len(sim.linear.monitored_constants))
    if end > 0.0:
        keep_step(laws, series, terms, h, end, t)
        add_works(sim, series, coefs, t - begin, terms, series.lengths.carried, h, end, rules)
        accept_step(laws, sim.step.now, series, terms, h, end)
        if len(series.smooth.laws) + len(series.viscous.laws):
            run.stale = 1
    run.steps += 1


def answer_event(
    sim: Simulation, rules: Tables, series: Series, coefs: Array, begin: float, terms: int, h: float,
    end: float, event: LocatedEvent,
) -> int:  # fmt: skip
    """Carry out an event at the present time; its step was searched for events up to the place `end`.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    laws, lengths, kind = sim.laws, series.lengths, event.event_index
    if kind == LIFT:
        r = series.friction.number[event.law]
        series.friction.pressing[r] = not series.friction.pressing[r]
        return DONE
    if kind == BENDS:
        shorten_for_bend(laws, series.smooth, lengths, event.law)
        return DONE
    if kind == TURNS:
        sim.run.stale = 1
        return DONE
    if kind < 0:
        change_phase(laws, series.curved, lengths, event.law, kind)
        return DONE
    if series.rigid.number[event.law] >= 0:
        sim.run.fault = event.law
        return STRIKE
    change_branches(sim, rules, series, terms, h, end, event)
    return settle_state(sim, rules, series, coefs, sim.run.time - begin)


def step_to_goal(
    sim: Simulation, rules: Tables, series: Series, coefs: Array, begin: float, goal: float, pause: int
) -> int:
    """Take steps on one piece of the excitation up to a goal, or until control must return to Python.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    lengths = series.lengths
    laws, run = sim.laws, sim.run
    while run.time < goal:
        if must_pause(sim.buffers, series, run, pause):
            return FULL
        t = run.time
        h = step_length(lengths, t, goal)
        if h == 0.0:
            return SHORT
        if not renew_branches(sim, rules, series):
            return LOOSE
        if len(series.viscous.light):
            why = settle_state(sim, rules, series, coefs, t - begin)
            if why != DONE:
                return why
        if is_implicit(series):
            terms, fit = expand_implicit(sim, series, coefs, t - begin, h)
            least, room = 1.0, 1.0
        else:
            terms, fit = expand_series(sim, series, coefs, t - begin, h)
            # terms that were not needed make room for a longer step
            least, room = MIN_PART, MAX_TERMS / terms
        if not fit >= least:  # terms far too large say nothing about the motion
            shorten_step(lengths, h, fit)
            pause -= 1
            continue
        end = 1.0 if fit >= 1.0 else (t + fit * h - t) / h
        if end == 0.0:
            return SHORT
        whole = end == 1.0 and h == goal - t
        lengths.next = max(h * min(fit * room, MAX_GROWTH), lengths.next if end == 1.0 else 0.0)
        count_reach(laws, series, terms, end)
        event = first_event(laws, series, terms, h, end)
        at = event.time
        if h > FROM_REST * (goal - t) and begins_to_move(laws, series, event):
            shorten_step(lengths, h, MIN_SHORTENING)
            pause -= 1
            continue
        take_step(sim, series, coefs, begin, terms, h, at, rules)
        if event.law < 0:
            if not whole:
                lengths.shortest = min(lengths.shortest, at * h)
            run.time = goal if whole else t + at * h
            continue
        run.time = t + at * h
        count_instant(run, h)
        if run.same_instant > CHANGES + CHANGES_PER_LAW * len(laws.rule):
            run.fault = event.law
            return CHATTER
        why = answer_event(sim, rules, series, coefs, begin, terms, h, end, event)
        if why != DONE:
            return why
    return DONE


def reach_goal(
    sim: Simulation, rules: Tables, series: Series, coefs: Array, begin: float, goal: float, pause: int
) -> int:
    """Advance the motion to a goal, in modes or by steps; return DONE, or what is wrong."""
    step, run = sim.step, sim.run
    if not has_room(series.shown):
        return FULL
    if run.steps < pause and take_in_modes(sim, series, coefs, begin, goal):
        return DONE
    from_modes(sim.laws, series.modal, step)
    series.modal.is_present[0] = 0
    why = step_to_goal(sim, rules, series, coefs, begin, goal, pause)
    if why == DONE:
        multiply(sim.linear.mass, step.now.velocity, step.product)
        kinetic = 0.5 * dot(step.now.velocity, step.product)
        if runs_away(kinetic, run.initial_energy, sim.works.gross_input):
            run.initial_energy = kinetic
            return RUNAWAY
    return why


def take_sample(sim: Simulation, rules: Tables, series: Series, coefs: Array, begin: float) -> None:
    """Keep the present motion; as the first sample, count it into the peaks."""
    run = sim.run
    now = sim.step.now
    why = settle_state(sim, rules, series, coefs, run.time - begin)
    evaluate_inputs(coefs, run.time - begin, now.inputs, now.input_rates)
    form_load(sim.linear, now.inputs, now.load)
    multiply(sim.linear.damping, now.velocity, now.damping_force)
    make_consistent(sim)
    if why == DONE and len(series.massless.unknown):
        next_term(sim, series, 0, 1.0, len(coefs))
    for i in series.massless.unknown:
        now.acceleration[i] = 2.0 * series.motion[2, i]
    if run.started == 0:
        track_peaks(sim, run.time, 0.0)
        run.started = 1
    store_sample(sim, rules, run.time)


def load_times_place(linear: LinearSystem, step: Step, series: Series, coefs: Array, s: float) -> float:
    """Sum over the unknowns without mass of load, at the local time `s` of a piece, times displacement."""
    total, trial = 0.0, step.trial
    evaluate_inputs(coefs, s, trial.inputs, trial.input_rates)
    for i in series.massless.unknown:
        total += load_on_nodes(linear, trial.inputs, i) * step.now.displacement[i]
    return total


def settle_after_jump(
    sim: Simulation, rules: Tables, series: Series, goals: Goals, before: int, piece: int
) -> int:
    """Settle the state at the beginning of another piece of the excitation: unknowns without mass jump with
    the loads, whose work is then that of the mean load.
    """
    old, new = sim.run.time - goals.begins[before], sim.run.time - goals.begins[piece]
    put = 0.0
    for sign in (-1.0, 1.0):
        if sign > 0.0:
            why = settle_state(sim, rules, series, goals.coefs[piece], new)
            if why != DONE:
                return why
        put += 0.5 * sign * load_times_place(sim.linear, sim.step, series, goals.coefs[before], old)
        put += 0.5 * sign * load_times_place(sim.linear, sim.step, series, goals.coefs[piece], new)
    sim.works.input += put
    sim.works.gross_input += abs(put)
    return DONE


def march(sim: Simulation, rules: Tables, series: Series, goals: Goals) -> int:
    """Integrate to the last goal, or until control must return to Python (see
    `stepping.kernel.advance`).
    """
    run = sim.run
    pause = next_pause(sim.step, run)
    while run.goal < len(goals.times):
        goal = run.goal
        piece = goals.piece[goal]
        begin, coefs = goals.begins[piece], goals.coefs[piece]
        if run.started == 0:
            take_sample(sim, rules, series, coefs, begin)
        # the excitation may have a kink here, or jump
        before = goals.piece[max(goal - 1, 0)]
        why = settle_after_jump(sim, rules, series, goals, before, piece)
        if why != DONE:
            return why
        why = reach_goal(sim, rules, series, coefs, begin, goals.times[goal], pause)
        if why != DONE:
            return why
        run.goal += 1
        if goals.sampled[goal]:
            from_modes(sim.laws, series.modal, sim.step)
            take_sample(sim, rules, series, coefs, begin)
            if run.kept == len(sim.buffers.time):
                return FULL
    return DONE
