"""The loop of the step-by-step methods: equal steps from goal to goal, cut at events or not.

All functions work on named arrays in the order of elimination (see `kernels.state`, `numerics.ldl`), and
`jit` compiles them.
"""

from __future__ import annotations

from pound_solve.integrate.energy import runs_away
from pound_solve.integrate.events.within_step import first_event
from pound_solve.integrate.kernels.consistency import loses_force, make_consistent
from pound_solve.integrate.kernels.law_state import Laws
from pound_solve.integrate.kernels.laws import (
    event_on_path,
    leave_branch,
    linear_force,
    linearise_law,
    restore_state,
    save_state,
)
from pound_solve.integrate.kernels.products import evaluate_inputs, form_load, multiply
from pound_solve.integrate.kernels.recording import (
    log_transition,
    next_pause,
    store_motion,
    store_sample,
    take_first_sample,
    track_peaks,
)
from pound_solve.integrate.kernels.state import (
    BUFFERS_FULL,
    DONE,
    RUNAWAY,
    SINGULAR,
    WHOLE,
    Goals,
    Piece,
    Scheme,
    Simulation,
    Step,
    piece_of,
)
from pound_solve.integrate.stepping.acceptance import accept_trial
from pound_solve.integrate.stepping.branches import resume_after_jump
from pound_solve.integrate.stepping.factor import (
    factorise_step,
    invalidate_factor,
    is_valid_factor,
    tangent_change,
    update_factor,
)
from pound_solve.integrate.stepping.parts import step_in_parts
from pound_solve.integrate.stepping.step import try_step
from pound_solve.integrate.tolerances import EVENT_TOLERANCE
from pound_solve.laws.functions import RuleFunctions
from pound_solve.numerics.types import Array, Index

#: outcomes of a step through events: solved; to be solved again with new tangents; to be cut at its events;
#: failed, because its matrix is singular
SOLVED, SOLVE_AGAIN, CUT, FAILED = range(4)
MAX_BRANCHES = 100  #: branches that a law may pass in a step that is not cut
MAX_SOLUTIONS = 50  #: of such a step, before it is cut


def drive_law(sim: Simulation, rules: RuleFunctions, i: int) -> bool:
    """Drive law `i` along a straight path from the start of the step to its end, through all branches on
    the way.  Return False if it loses a force on the way that holds a massless joint.
    """
    laws = sim.laws
    d, d1, v1 = laws.now.deformation[i], laws.trial.deformation[i], laws.trial.rate[i]
    for _ in range(MAX_BRANCHES):
        event, where = event_on_path(laws, i, d, d1, v1)
        if event < 0:
            break
        k, f0 = laws.tangent.stiffness[i], laws.tangent.offset[i]
        leave_branch(laws, rules, i, event, where, v1)
        if loses_force(sim.linear, laws, i, k, f0, where):
            return False
        sim.run.branches_passed += 1
        d = where
    if laws.definition.curved[i]:
        linearise_law(laws, rules, i, d1, v1)
    return True


def drive_laws(sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float) -> int:
    """Drive all laws that pass an event to the end of the step, and update the factor.

    Returns
    -------
    int
        SOLVED if no law has changed branch, SOLVE_AGAIN if one has, CUT if a law loses a force on the way
        that holds a massless joint, or FAILED.
    """
    laws, run = sim.laws, sim.run
    tangent = laws.tangent
    outcome = SOLVED
    for i in range(len(laws.definition.rule)):
        d, d1, v1 = laws.now.deformation[i], laws.trial.deformation[i], laws.trial.rate[i]
        if not laws.saved.in_step[i] and event_on_path(laws, i, d, d1, v1)[0] < 0:
            continue
        k, c, f0 = tangent.stiffness[i], tangent.damping[i], tangent.offset[i]
        if laws.saved.in_step[i]:
            restore_state(laws, rules, i)
        else:
            save_state(laws, i)
            laws.saved.in_step[i] = True
        run.massless_factor_stale = 1
        if not drive_law(sim, rules, i):
            return CUT
        changed = tangent.stiffness[i] != k or tangent.damping[i] != c
        if not changed and abs(tangent.offset[i] - f0) <= EVENT_TOLERANCE * abs(f0):
            continue
        outcome = SOLVE_AGAIN
        change = tangent_change(scheme, h, tangent.stiffness[i] - k, tangent.damping[i] - c)
        if change != 0.0 and not sim.linear.explicit:
            run.updates += 1
            if not update_factor(sim, i, change, WHOLE):
                bad = factorise_step(sim, scheme, h, WHOLE)
                if bad >= 0:
                    run.failed_unknown = bad
                    return FAILED
    return outcome


def step_through(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, piece: Piece, length: float, tried: bool
) -> int:
    """Advance by `length` without cutting the step at events.

    The step is solved repeatedly until it agrees with the laws at its end, each driven along a straight
    path from its start.  `tried` means that the first trial step has been made.

    Returns
    -------
    int
        SOLVED, CUT if the step must be cut at its events, or FAILED.
    """
    laws, run = sim.laws, sim.run
    definition = laws.definition
    for i in range(len(definition.rule)):
        laws.saved.in_step[i] = False
    end = run.time + length - piece.begin
    for _ in range(MAX_SOLUTIONS):
        if not tried and not try_step(sim, rules, scheme, piece.coefs, end, length, WHOLE):
            break
        tried, run.branches_passed = False, 0
        outcome = drive_laws(sim, rules, scheme, length)
        if outcome == SOLVE_AGAIN:
            continue
        if outcome == FAILED:
            return FAILED
        if outcome == CUT:
            break
        accept_trial(sim, rules, scheme, length, WHOLE)
        run.time += length
        run.events += run.branches_passed
        for i in range(len(definition.rule)):
            if laws.saved.in_step[i] and laws.saved.values[i, 0] != laws.state.branch[i]:
                force = linear_force(laws.tangent, i, laws.now.deformation[i], laws.now.rate[i])
                log_transition(sim, i, int(laws.saved.values[i, 0]), run.time, force)
        track_peaks(sim, run.time, length)
        return SOLVED
    for i in range(len(definition.rule)):
        if laws.saved.in_step[i]:
            restore_state(laws, rules, i)
    run.massless_factor_stale = 1
    invalidate_factor(run)
    return CUT


def passes_event(laws: Laws, step: Step, scheme: Scheme, h: float) -> bool:
    """Return whether a law passes an event in the trial step."""
    if scheme.locate:
        return first_event(laws, step, h).law >= 0
    for i in range(len(laws.definition.rule)):
        d, d1, v1 = laws.now.deformation[i], laws.trial.deformation[i], laws.trial.rate[i]
        if event_on_path(laws, i, d, d1, v1)[0] >= 0:
            return True
    return False


def plain_steps(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, piece: Piece, h: float, last: int
) -> bool:
    """Take steps of length `h` up to step `last` while every law stays on its branch.

    Returns
    -------
    bool
        Whether the last step was tried but not accepted, because a law leaves its branch.
    """
    run = sim.run
    while run.step < last and is_valid_factor(run) and run.longest_part >= h:
        end = run.time + h - piece.begin
        if not try_step(sim, rules, scheme, piece.coefs, end, h, WHOLE):
            return False
        if passes_event(sim.laws, sim.step, scheme, h):
            return True
        accept_trial(sim, rules, scheme, h, WHOLE)
        run.time += h
        track_peaks(sim, run.time, h)
        run.step += 1
        run.steps += 1
        store_motion(sim, rules, run.time)
    return False


def begin_goal(sim: Simulation, scheme: Scheme, piece: Piece, h: float) -> None:
    """Copy the present excitation before the first step towards a goal.  If a load jumps, make the state
    and its acceleration consistent.
    """
    run = sim.run
    if run.step > 0:
        return
    now, load = sim.step.now, sim.step.scratch[0]
    evaluate_inputs(piece.coefs, run.time - piece.begin, now.inputs, now.input_rates)
    form_load(sim.linear, now.inputs, load)
    # the acceleration of an alpha method lags behind: after much shorter steps, as during a spike of the
    # load, the lag would act for too long
    jumps = scheme.alpha_f + scheme.alpha_m != 0.0 and h > 2.0 * run.factor_length > 0.0
    for i in range(len(load)):
        if abs(load[i] - now.load[i]) > EVENT_TOLERANCE * (abs(load[i]) + abs(now.load[i])):
            jumps = True
        now.load[i] = load[i]
    if jumps:
        run.load_jump_time = run.time
        make_consistent(sim)
        track_peaks(sim, run.time, 0.0)


def refresh_factor(sim: Simulation, scheme: Scheme, h: float) -> int:
    """Factorise A for steps of length `h`, unless the present factor is valid for them."""
    run = sim.run
    if run.factor_length == h and is_valid_factor(run):
        return DONE
    bad = factorise_step(sim, scheme, h, WHOLE)
    if bad >= 0:
        run.failed_unknown = bad
        return SINGULAR
    run.factor_length, run.updates = h, 0
    return DONE


def end_goal(sim: Simulation, rules: RuleFunctions, sampled: bool) -> int:
    """Take a sample at a goal; return RUNAWAY if the kinetic energy is far above the energy put in."""
    step, run = sim.step, sim.run
    kinetic, velocity, momentum = 0.0, step.now.velocity, step.scratch[0]
    multiply(sim.linear.mass, velocity, momentum)
    for i in range(len(velocity)):
        kinetic += 0.5 * velocity[i] * momentum[i]
    if runs_away(kinetic, run.initial_energy, sim.works.gross_input):
        run.runaway_energy = kinetic
        return RUNAWAY
    run.goal += 1
    run.step = 0
    if sampled:
        store_sample(sim, rules, run.time)
        if run.n_samples == len(sim.buffers.time):
            return BUFFERS_FULL
    return DONE


def take_steps(
    sim: Simulation,
    rules: RuleFunctions,
    scheme: Scheme,
    piece: Piece,
    h: float,
    goal: float,
    count: int,
    most: int,
) -> int:
    """Take up to `most` of the `count` steps to the time `goal`.  They are plain steps, except the last,
    which may be the rest of a step after joints have moved, or a step that events cut.
    """
    run = sim.run
    outcome, tried = CUT, False
    if run.remaining_step >= 0.0:
        resume_after_jump(sim, rules)
        length, run.remaining_step = run.remaining_step, -1.0
    else:
        last = min(count - 1, run.step + most)
        first, fresh = run.step, run.updates == 0
        tried = plain_steps(sim, rules, scheme, piece, h, last)
        # iterations that fail with a new factor would fail again: the step is taken in parts
        used_up = not is_valid_factor(run) and (run.step > first or not fresh)
        if not tried and (run.step == last < count - 1 or used_up):
            return DONE
        length = h if run.step < count - 1 else goal - run.time
        run.changes_at_instant = 0
        if not scheme.locate:
            outcome = step_through(sim, rules, scheme, piece, length, tried)
            tried = False
    if outcome == FAILED:
        return SINGULAR
    why = DONE
    if outcome == CUT:  # a step that is cut at its events always has a solution
        why = step_in_parts(sim, rules, scheme, piece, length, h, tried)
    if why == DONE:
        run.step += 1
        run.steps += 1
        store_motion(sim, rules, run.time)
    return why


def advance(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, goals: Goals, steps: Index, lengths: Array
) -> int:
    """Integrate to the last goal, or until control must return to Python.

    Parameters
    ----------
    goals : Goals
    steps, lengths : ndarray, shape (n_goals,)
        Number of steps up to each goal, and their length [T].

    Returns
    -------
    int
        DONE, BUFFERS_FULL, or the reason for a stop (see `kernels.state`).
    """
    buffers, run = sim.buffers, sim.run
    # one step may log at most half the buffer (TOO_MANY_EVENTS beyond), so half is free before each step
    room, pause = len(buffers.log) // 2, next_pause(sim.step, run)
    if run.started == 0:
        take_first_sample(sim, rules)
    while run.goal < len(goals.times):
        n_goal = run.goal
        h, piece = lengths[n_goal], piece_of(goals, n_goal)
        begin_goal(sim, scheme, piece, h)
        while run.step < steps[n_goal]:
            crowded = len(buffers.log) - run.n_transitions < room or run.n_ties > len(buffers.ties) // 2
            # steps whose motion has room: one step may be cut into many parts
            more = len(buffers.motion_time) // 2 - run.n_motions
            if crowded or more <= 0 or run.steps >= pause:
                return BUFFERS_FULL
            why = refresh_factor(sim, scheme, h)
            if why != DONE:
                return why
            most = min(pause - run.steps, more)
            why = take_steps(sim, rules, scheme, piece, h, goals.times[n_goal], steps[n_goal], most)
            if why != DONE:
                return why
        run.time = goals.times[n_goal]
        why = end_goal(sim, rules, goals.sampled[n_goal])
        if why != DONE:
            return why
    return DONE
