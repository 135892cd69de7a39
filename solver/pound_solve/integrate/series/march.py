"""Kernels of TAYLOR and LAGUERRE: steps from event to event, and from goal to goal."""

from __future__ import annotations

import numpy as np

from pound_solve.integrate.energy import runs_away
from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.kernels.consistency import make_consistent
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.products import evaluate_inputs, form_load, multiply
from pound_solve.integrate.kernels.recording import next_pause, store_sample, track_peaks
from pound_solve.integrate.kernels.state import (
    BUFFERS_FULL,
    CHATTER,
    DONE,
    RIGID_EVENT,
    RUNAWAY,
    STEP_TOO_SHORT,
    UNRESTRAINED,
    Buffers,
    Goals,
    MotionState,
    Piece,
    Run,
    Simulation,
    piece_of,
)
from pound_solve.integrate.kernels.work import load_on_nodes
from pound_solve.integrate.protocol import MAX_CHANGES, MAX_CHANGES_PER_LAW
from pound_solve.integrate.series.branches import (
    change_branches,
    count_instant,
    refresh_branches,
    settle_state,
)
from pound_solve.integrate.series.envelope_buffers import has_room, is_full, keep_step
from pound_solve.integrate.series.expansion import (
    MAX_DEGREE,
    MAX_GROWTH,
    dot,
    evaluate_motion,
    expand_series,
    law_at,
    next_term,
)
from pound_solve.integrate.series.force_events import CROSSES_LINEAR_RANGE, LIFT, POWER_CHANGES
from pound_solve.integrate.series.forces import update_branch_forces, update_largest_forces
from pound_solve.integrate.series.friction import is_sliding
from pound_solve.integrate.series.modal import advance_in_modes, from_modes
from pound_solve.integrate.series.power_contacts import change_phase
from pound_solve.integrate.series.rigid import is_closed
from pound_solve.integrate.series.single_pole import expand_laguerre, is_laguerre
from pound_solve.integrate.series.smooth import shorten_for_power_change
from pound_solve.integrate.series.state import Extent, Series, StepControl
from pound_solve.integrate.series.tracking import first_event, track_laws, track_outputs
from pound_solve.integrate.series.works import add_works
from pound_solve.integrate.tolerances import STEP_ROUNDING
from pound_solve.laws.functions import RuleFunctions

MIN_SHORTENING = 1.0 / 16.0  #: smallest factor of the length of a step that is tried again
MAX_SHORTENING = 0.9  #: largest such factor
MIN_PART = 0.5  #: smallest fraction of a trial step that is accepted
#: longest implicit step in which a contact leaves its rest, as a fraction of the time to the goal
MAX_FIRST_STEP = 1e-4


def update_displacement_scale(laws: Laws, series: Series, extent: Extent) -> None:
    """Update the largest deformations of contacts with the displacements of their two bodies over a step.
    The rounding of the deformation is a fraction of these displacements; for bodies that move alike, the
    deformation is only rounding.
    """
    definition, rows, motion = laws.definition, laws.definition.rows, series.motion
    for i in range(len(definition.rule)):
        if definition.contact[i]:
            far = 0.0
            for q in range(rows.pointers[i], rows.pointers[i + 1]):
                x, at = 0.0, rows.columns[q]
                for k in range(extent.degree, -1, -1):
                    x = x * extent.end + motion[k, at]
                far += abs(rows.values[q]) * max(abs(x), abs(motion[0, at]))
            laws.largest.deformation[i] = max(laws.largest.deformation[i], far)
            series.control.farthest = max(series.control.farthest, far)


def accept_step(laws: Laws, now: MotionState, series: Series, extent: Extent) -> None:
    """Set the present motion and the state of the laws to those at the end of a step."""
    largest, degree, h, end = laws.largest, extent.degree, extent.h, extent.end
    evaluate_motion(series.motion, degree, end, h, 0, now.displacement)
    evaluate_motion(series.motion, degree, end, h, 1, now.velocity)
    for i in range(len(laws.definition.rule)):
        d, v = law_at(series, degree, end, h, i)
        if is_closed(series.rigid, i):
            d, v = laws.state.entry_deformation[i], 0.0
        if is_sliding(series.friction, i):  # its work is accumulated separately
            laws.state.entry_deformation[i] = d
        laws.now.deformation[i], laws.now.rate[i] = d, v
        largest.deformation[i] = max(largest.deformation[i], abs(d))
        largest.rate[i] = max(largest.rate[i], abs(v))
    update_branch_forces(laws, series, degree, end, h)
    update_largest_forces(laws.tangent, series)


def begins_to_move(laws: Laws, series: Series, event: LocatedEvent) -> bool:
    """Return whether the contact of an event starts an implicit step at rest.  Its motion may then be
    smaller than the error of the polynomial, so that its direction is unreliable.
    """
    at_rest = event.law >= 0 and laws.definition.contact[event.law] and laws.now.rate[event.law] == 0.0
    return at_rest and is_laguerre(series)


def must_pause(buffers: Buffers, series: Series, run: Run, pause: int) -> bool:
    """Return whether Python must empty the buffers or may check for an interrupt."""
    log_is_full = len(buffers.log) - run.n_transitions < len(buffers.log) // 2
    crowded = log_is_full or run.n_ties > len(buffers.ties) // 2
    return crowded or run.steps >= pause or is_full(series.envelope)


def step_length(control: StepControl, t: float, goal: float) -> float:
    """Return the length of the next step, which divides the time to the goal into equal parts; 0 if it
    vanishes in the rounding of the time.
    """
    left = goal - t
    h: float = left / np.ceil(max(left / control.next_length, 1.0) * (1.0 - STEP_ROUNDING))
    if h == left:
        return h
    # the step equals the advance of the rounded clock, except at time 0, where the clock resolves any step
    return t + h - t if goal + h > goal else 0.0


def expand_step(sim: Simulation, series: Series, piece: Piece, h: float) -> tuple[int, float]:
    """Expand the series of a step of length `h`; return its degree, and the fraction of the step in which
    it holds.
    """
    if is_laguerre(series):
        return expand_laguerre(sim, series, piece, h)
    return expand_series(sim, series, piece, h)


def smallest_part(series: Series) -> float:
    """Return the smallest fraction of a step that is accepted; an implicit step is taken as a whole."""
    return 1.0 if is_laguerre(series) else MIN_PART


def choose_next_length(series: Series, extent: Extent, fit: float) -> None:
    """Choose the length of the next step after one whose series holds up to the fraction `fit`."""
    control = series.control
    # terms that were not needed make room for a longer step
    room = 1.0 if is_laguerre(series) else MAX_DEGREE / extent.degree
    # a step that an event cuts is no reason to forget a longer length, a truncated one is
    remembered = control.next_length if extent.end == 1.0 else 0.0
    control.next_length = max(extent.h * min(fit * room, MAX_GROWTH), remembered)


def shorten_step(control: StepControl, h: float, fit: float) -> None:
    """Choose a step shorter by at least a tenth after a rejected one.  With less, the equal parts of the
    remaining time would be as long as before.
    """
    control.next_length = h * (min(fit, MAX_SHORTENING) if fit > MIN_SHORTENING else MIN_SHORTENING)
    control.n_rejected += 1


def complete_step(
    sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece, extent: Extent
) -> None:
    """Accept a step: update peaks, kept motion, works, and the present motion.

    All functions that read the tangents at the start of the step are called before `add_works`, which
    leaves the tangents of its last Gauss point.  `accept_step` then sets the forces at the end, and smooth
    laws and dampers get new tangents.
    """
    laws, run = sim.laws, sim.run
    track_outputs(sim, series, extent, len(piece.coefs))
    track_laws(laws, sim.step, series, extent, len(sim.linear.monitored_constants))
    if extent.end > 0.0:
        keep_step(laws, series, extent)
        add_works(sim, rules, series, piece, extent)
        accept_step(laws, sim.step.now, series, extent)
        if len(series.smooth.laws) + len(series.power_dampers.laws):
            run.branches_changed = 1
    run.steps += 1


def answer_event(
    sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece, extent: Extent, event: LocatedEvent
) -> int:
    """Count and carry out an event at the present time; its step was searched for events up to `extent`.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    laws, run, control, kind = sim.laws, sim.run, series.control, event.event_index
    count_instant(run, extent.h)
    if run.changes_at_instant > MAX_CHANGES + MAX_CHANGES_PER_LAW * len(laws.definition.rule):
        run.changed_law = event.law
        return CHATTER
    if kind == LIFT:
        r = series.friction.index_of[event.law]
        series.friction.pressing[r] = not series.friction.pressing[r]
        return DONE
    if kind == POWER_CHANGES:
        shorten_for_power_change(laws.now, series.smooth, control, event.law)
        return DONE
    if kind == CROSSES_LINEAR_RANGE:
        run.branches_changed = 1
        return DONE
    if kind < 0:
        change_phase(laws, series.power_contacts, control, event.law, kind)
        return DONE
    if series.rigid.index_of[event.law] >= 0:
        run.changed_law = event.law
        return RIGID_EVENT
    change_branches(sim, rules, series, extent, event)
    return settle_state(sim, rules, series, piece)


def step_to_goal(
    sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece, goal: float, pause: int
) -> int:
    """Take steps on one piece of the excitation up to a goal, or until control must return to Python.

    Returns
    -------
    int
        DONE, or what is wrong.
    """
    control = series.control
    laws, run = sim.laws, sim.run
    while run.time < goal:
        if must_pause(sim.buffers, series, run, pause):
            return BUFFERS_FULL
        t = run.time
        h = step_length(control, t, goal)
        if h == 0.0:
            return STEP_TOO_SHORT
        if not refresh_branches(sim, rules, series):
            return UNRESTRAINED
        if len(series.power_dampers.on_massless):
            why = settle_state(sim, rules, series, piece)
            if why != DONE:
                return why
        degree, fit = expand_step(sim, series, piece, h)
        if not fit >= smallest_part(series):  # terms that large say nothing about the motion
            shorten_step(control, h, fit)
            pause -= 1  # or a run that shortens its steps without end could not be interrupted
            continue
        end = 1.0 if fit >= 1.0 else (t + fit * h - t) / h
        if end == 0.0:
            return STEP_TOO_SHORT
        searched = Extent(t, h, degree, end)
        choose_next_length(series, searched, fit)
        update_displacement_scale(laws, series, searched)
        event = first_event(laws, series, searched)
        at = event.time
        if h > MAX_FIRST_STEP * (goal - t) and begins_to_move(laws, series, event):
            shorten_step(control, h, MIN_SHORTENING)
            pause -= 1
            continue
        complete_step(sim, rules, series, piece, Extent(t, h, degree, at))
        if event.law < 0:
            whole = end == 1.0 and h == goal - t
            if not whole:
                control.shortest_length = min(control.shortest_length, at * h)
            run.time = goal if whole else t + at * h
            continue
        run.time = t + at * h
        why = answer_event(sim, rules, series, piece, searched, event)
        if why != DONE:
            return why
    return DONE


def reach_goal(
    sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece, goal: float, pause: int
) -> int:
    """Advance the motion to a goal, in modes or by steps; return DONE, or what is wrong."""
    step, run = sim.step, sim.run
    if not has_room(series.envelope):
        return BUFFERS_FULL
    if run.steps < pause and advance_in_modes(sim, series, piece, goal):
        return DONE
    from_modes(sim.laws, series.modal, step)
    series.modal.is_present[0] = 0
    why = step_to_goal(sim, rules, series, piece, goal, pause)
    if why == DONE:
        momentum = step.scratch[0]
        multiply(sim.linear.mass, step.now.velocity, momentum)
        kinetic = 0.5 * dot(step.now.velocity, momentum)
        if runs_away(kinetic, run.initial_energy, sim.works.gross_input):
            run.runaway_energy = kinetic
            return RUNAWAY
    return why


def store_sample_at_goal(sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece) -> None:
    """Store the present motion; if it is the first sample, include it in the peaks."""
    run = sim.run
    now = sim.step.now
    why = settle_state(sim, rules, series, piece)
    evaluate_inputs(piece.coefs, run.time - piece.begin, now.inputs, now.input_rates)
    form_load(sim.linear, now.inputs, now.load)
    multiply(sim.linear.damping, now.velocity, now.damping_force)
    make_consistent(sim)
    if why == DONE and len(series.massless.unknown):
        next_term(sim, series, 0, 1.0, len(piece.coefs))
    for i in series.massless.unknown:
        now.acceleration[i] = 2.0 * series.motion[2, i]
    if run.started == 0:
        track_peaks(sim, run.time, 0.0)
        run.started = 1
    store_sample(sim, rules, run.time)


def massless_load_work(sim: Simulation, series: Series, piece: Piece) -> float:
    """Return the sum of present load times displacement over the massless unknowns."""
    total, trial = 0.0, sim.step.trial
    evaluate_inputs(piece.coefs, sim.run.time - piece.begin, trial.inputs, trial.input_rates)
    for i in series.massless.unknown:
        total += load_on_nodes(sim.linear, trial.inputs, i) * sim.step.now.displacement[i]
    return total


def settle_after_jump(
    sim: Simulation, rules: RuleFunctions, series: Series, before: Piece, after: Piece
) -> int:
    """Settle the state at the start of another piece of the excitation.  Massless unknowns jump with the
    load; the work done is the mean load times the jump.
    """
    put = 0.0
    for sign in (-1.0, 1.0):
        if sign > 0.0:
            why = settle_state(sim, rules, series, after)
            if why != DONE:
                return why
        put += 0.5 * sign * massless_load_work(sim, series, before)
        put += 0.5 * sign * massless_load_work(sim, series, after)
    sim.works.input += put
    sim.works.gross_input += abs(put)
    return DONE


def march(sim: Simulation, rules: RuleFunctions, series: Series, goals: Goals) -> int:
    """Integrate to the last goal, or until control must return to Python (see
    `stepping.kernel.advance`).
    """
    run = sim.run
    pause = next_pause(sim.step, run)
    while run.goal < len(goals.times):
        n_goal = run.goal
        piece, before = piece_of(goals, n_goal), piece_of(goals, max(n_goal - 1, 0))
        if run.started == 0:
            store_sample_at_goal(sim, rules, series, piece)
        # the excitation may have a kink here, or jump
        why = settle_after_jump(sim, rules, series, before, piece)
        if why != DONE:
            return why
        why = reach_goal(sim, rules, series, piece, goals.times[n_goal], pause)
        if why != DONE:
            return why
        run.goal += 1
        if goals.sampled[n_goal]:
            from_modes(sim.laws, series.modal, sim.step)
            store_sample_at_goal(sim, rules, series, piece)
            if run.n_samples == len(sim.buffers.time):
                return BUFFERS_FULL
    return DONE
