"""Changes of branch at an event: laws leave their branches, the factor is updated, and the state is made
consistent.
"""

from __future__ import annotations

from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.kernels.consistency import loses_force, make_consistent, touches_massless
from pound_solve.integrate.kernels.laws import (
    couple_friction,
    leave_branch,
    linear_force,
    linearise_law,
    save_friction_limits,
)
from pound_solve.integrate.kernels.recording import log_transition, store_motion, track_peaks
from pound_solve.integrate.kernels.state import WHOLE, Scheme, Simulation
from pound_solve.integrate.kernels.ties import event_before_slack, note_rests, note_ties
from pound_solve.integrate.stepping.factor import (
    invalidate_factor,
    is_valid_factor,
    tangent_change,
    update_factor,
)
from pound_solve.laws.functions import RuleFunctions
from pound_solve.loading.excitation import CLOCK_ROUNDING

FIRST_PART = 1.0 / 32.0  #: fraction of a step taken after a curved contact has touched; it then doubles


def change_branch(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, i: int, event: int
) -> None:
    """Change the branch of law `i`, and update the factor for the nominal step `h`."""
    linear, laws, run = sim.linear, sim.laws, sim.run
    definition, tangent, state, friction = laws.definition, laws.tangent, laws.state, laws.friction
    before, k, c = state.branch[i], tangent.stiffness[i], tangent.damping[i]
    if friction.normal_law[i] >= 0:
        couple_friction(laws, rules, sim.step.now.acceleration, i)
    d, v, f0 = laws.now.deformation[i], laws.now.rate[i], tangent.offset[i]
    note_rests(sim, rules, i, event)
    leave_branch(laws, rules, i, event, d, v)
    if friction.normal_law[i] < 0 and loses_force(linear, laws, i, k, f0, d):
        run.lost_force = i
    if definition.curved[i]:
        linearise_law(laws, rules, i, d, v)
    change = tangent_change(scheme, h, tangent.stiffness[i] - k, tangent.damping[i] - c)
    if not linear.explicit and change != 0.0:
        run.updates += 1
        if not is_valid_factor(run) or not update_factor(sim, i, change, WHOLE):
            invalidate_factor(run)
    force = linear_force(tangent, i, d, v)
    if definition.contact[i] and touches_massless(linear, definition.rows, i):
        # the dashpot force is known only after the velocities are made consistent
        force -= tangent.damping[i] * v
    if before != state.branch[i]:
        log_transition(sim, i, before, run.time, force)
    note_ties(sim, rules, i, k, f0)
    run.events += 1
    for j in friction.coupled:
        before = state.branch[j]
        couple_friction(laws, rules, sim.step.now.acceleration, j)
        if before != state.branch[j]:
            log_transition(sim, j, before, run.time, friction.force[j])
            invalidate_factor(run)
    save_friction_limits(laws)


def leaves_independently(sim: Simulation, i: int) -> bool:
    """Return whether a marked law leaves its branch regardless of the laws that have left at this instant.

    A law reverses according to its acceleration, which another law on the same mass changes.
    `step.marked` flags the unknowns of the laws that have left.
    """
    laws = sim.laws
    rows = laws.definition.rows
    if laws.events.coefficients[i, laws.events.pending[i], 0] != 0.0:
        return True
    for q in range(rows.pointers[i], rows.pointers[i + 1]):
        if not sim.linear.diagonal or sim.step.marked[rows.columns[q]]:
            return False
    return True


def change_branches(
    sim: Simulation, rules: RuleFunctions, scheme: Scheme, h: float, event: LocatedEvent
) -> None:
    """Change the branch of the law of an event and of the marked laws, then make the state consistent.  If
    a force is lost, the state is left as it is, because joints must move first.
    """
    laws, step, run = sim.laws, sim.step, sim.run
    definition, rows, events = laws.definition, laws.definition.rows, laws.events
    first, its_event = event_before_slack(sim, rules, event.law, event.event_index)
    event = LocatedEvent(first, its_event, event.time)
    events.pending[event.law] = event.event_index
    for j in range(len(step.marked)):
        step.marked[j] = False
    for k in range(-1, len(definition.rule)):
        i = event.law if k < 0 else k  # the law of the event comes first
        room = len(sim.buffers.log) - run.n_transitions > len(laws.friction.coupled)
        if events.pending[i] < 0 or not room or (k >= 0 and not leaves_independently(sim, i)):
            continue
        change_branch(sim, rules, scheme, h, i, events.pending[i])
        if definition.curved[i] and definition.contact[i] and laws.now.rate[i] > 0.0:
            run.longest_part = FIRST_PART * h
        for q in range(rows.pointers[i], rows.pointers[i + 1]):
            step.marked[rows.columns[q]] = True
        events.pending[i] = -1
    if run.lost_force < 0:
        resume_after_jump(sim, rules)


def resume_after_jump(sim: Simulation, rules: RuleFunctions) -> None:
    """Make the state consistent after a jump, and keep the motion for the envelopes.

    If a load has jumped at that instant, the motion is stored with a time just after it, because a motion
    at the instant itself counts as one before the jump.
    """
    run = sim.run
    make_consistent(sim)
    track_peaks(sim, run.time, 0.0)
    after = 4.0 * CLOCK_ROUNDING * max(1.0, run.time) if run.time == run.load_jump_time else 0.0
    store_motion(sim, rules, run.time + after)
