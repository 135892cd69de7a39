"""Kernels of TAYLOR that change branches of laws and make the state consistent with the new branches."""

from __future__ import annotations

from pound_solve.integrate.events.protocol import LocatedEvent
from pound_solve.integrate.kernels.laws import law_force, leave_branch
from pound_solve.integrate.kernels.recording import log_transition
from pound_solve.integrate.kernels.state import (
    CHATTER,
    DONE,
    LOST_FORCE,
    UNRESTRAINED,
    Piece,
    Run,
    Simulation,
)
from pound_solve.integrate.kernels.ties import event_before_slack, note_rests, note_ties
from pound_solve.integrate.protocol import MAX_CHANGES, MAX_CHANGES_PER_LAW
from pound_solve.integrate.series.expansion import begin_series, next_term
from pound_solve.integrate.series.forces import refresh_branch_series, update_branch_forces
from pound_solve.integrate.series.friction import touch_event
from pound_solve.integrate.series.massless import factorise_orders, first_violated, joints_jump
from pound_solve.integrate.series.modal import refresh_modes
from pound_solve.integrate.series.power_dampers import linearise_dampers, tangents_settled
from pound_solve.integrate.series.smooth import linearise_smooth
from pound_solve.integrate.series.springs import add_up, deformation_term
from pound_solve.integrate.series.state import Extent, Series
from pound_solve.integrate.series.tracking import event_of
from pound_solve.integrate.tolerances import SAME_INSTANT
from pound_solve.laws.functions import RuleFunctions

AHEAD = 1e-3  #: fraction of a step in which laws are searched for events at the instant of another event


def change_branch(
    sim: Simulation, rules: RuleFunctions, series: Series, t: float, event: LocatedEvent
) -> None:
    """Let a law leave its branch."""
    laws, run = sim.laws, sim.run
    law = event.law
    before, d, v = laws.state.branch[law], laws.now.deformation[law], laws.now.rate[law]
    note_rests(sim, rules, law, event.event_index)
    leave_branch(laws, rules, law, event.event_index, d, v)
    refresh_branch_series(laws, rules, series, law)
    # the rate of a massless unknown jumps, and the force of its dashpot with it
    force = law_force(laws, rules, law, d, 0.0 if series.massless.index_of_law[law] >= 0 else v)
    if before != laws.state.branch[law]:
        log_transition(sim, law, before, t, force)
    run.events += 1
    run.changed_law = law
    run.branches_changed = 1


def change_friction(sim: Simulation, rules: RuleFunctions, series: Series) -> None:
    """Let friction laws engage or release with the contacts that have touched or parted."""
    for r in range(len(series.friction.laws)):
        event = touch_event(sim.laws, rules, series.friction, r)
        if event >= 0:
            law = series.friction.laws[r]
            change_branch(sim, rules, series, sim.run.time, LocatedEvent(law, event, 0.0))


def change_branches(
    sim: Simulation, rules: RuleFunctions, series: Series, extent: Extent, event: LocatedEvent
) -> None:
    """Change the branch of a law, and of others whose events are at the same instant."""
    laws = sim.laws
    now, instant = sim.run.time, SAME_INSTANT * max(sim.run.time, extent.h)
    ahead = Extent(extent.begin, extent.h, extent.degree, min(event.time + AHEAD, extent.end))
    first, its_event = event_before_slack(sim, rules, event.law, event.event_index)
    event = LocatedEvent(first, its_event, event.time)
    stiffness, offset = laws.tangent.stiffness[event.law], laws.tangent.offset[event.law]
    change_branch(sim, rules, series, now, event)
    note_ties(sim, rules, event.law, stiffness, offset)
    # if there are massless unknowns, `settle_state` decides
    for i in range(len(laws.definition.rule) if len(series.massless.unknown) == 0 else 0):
        if i != event.law and series.rigid.index_of[i] < 0:
            other = event_of(laws, series, ahead, i)
            if other.law >= 0 and other.event_index >= 0 and other.time <= event.time + instant / extent.h:
                change_branch(sim, rules, series, now, other)
    change_friction(sim, rules, series)


def count_instant(run: Run, h: float) -> None:
    """Count the events at one instant."""
    same = run.time - run.last_event <= SAME_INSTANT * max(run.time, h)
    run.changes_at_instant = run.changes_at_instant + 1 if same else 0
    run.last_event = run.time


def refresh_branches(sim: Simulation, rules: RuleFunctions, series: Series) -> bool:
    """Update all that depends on the branches after a change: tangents of smooth laws and dampers, sums,
    modes, factors.  Return False if a massless unknown is unrestrained (`run.failed_unknown`).
    """
    laws, run = sim.laws, sim.run
    massless = series.massless
    if run.branches_changed:
        linearise_smooth(laws, rules, series.smooth)
        linearise_dampers(laws, rules, series.power_dampers)
        add_up(sim.linear, laws, series)
        refresh_modes(laws, series)
        fault = factorise_orders(laws, massless) if len(massless.unknown) else -1
        if fault >= 0:
            run.failed_unknown = massless.unknown[fault]
            return False
        run.branches_changed, run.factor_length = 0, -1.0
    return True


def settle_state(sim: Simulation, rules: RuleFunctions, series: Series, piece: Piece) -> int:
    """Make the velocities of massless unknowns and the forces of closed rigid contacts consistent with
    the present branches.

    These rates jump if a stiffness or a dashpot among them changes.  A law whose rate then changes its sign
    must leave its branch, too.  Of several such laws the one with the lowest number leaves, and all are
    examined again.  This least-index rule (Murty's, for linear complementarity problems) terminates if the
    laws harden.

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
    massless, now, n_powers = series.massless, sim.step.now, len(piece.coefs)
    in_series = series.rigid.n_closed[0] + len(series.power_contacts.laws) + len(series.friction.laws)
    in_series += len(series.smooth.laws) + len(series.power_dampers.laws)
    if len(massless.unknown) + in_series == 0:
        return DONE
    for _ in range(MAX_CHANGES + MAX_CHANGES_PER_LAW * len(laws.definition.rule)):
        change_friction(sim, rules, series)
        if not refresh_branches(sim, rules, series):
            return UNRESTRAINED
        begin_series(sim, series, piece, 1.0)
        if in_series:  # forces that are series need the accelerations
            next_term(sim, series, 0, 1.0, n_powers)
        # at the start no law has lost a force: a motion there is the rounding of the state of rest
        if run.changed_law >= 0 and joints_jump(laws, series, n_powers):
            return LOST_FORCE
        for i in massless.unknown:
            now.displacement[i], now.velocity[i] = series.motion[0, i], series.motion[1, i]
        for i in massless.laws:
            laws.now.deformation[i] = deformation_term(laws.definition, series, 0, n_powers, i)
            laws.now.rate[i] = deformation_term(laws.definition, series, 1, n_powers, i)
        if not tangents_settled(laws, series.power_dampers, now.velocity):
            run.branches_changed = 1
            continue
        law, event = first_violated(laws, massless.laws)
        if law < 0:
            update_branch_forces(laws, series, 2, 0.0, 1.0)
            return DONE
        change_branch(sim, rules, series, run.time, LocatedEvent(law, event, 0.0))
    return CHATTER
